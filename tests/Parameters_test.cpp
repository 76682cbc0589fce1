// Parameters and their values (nw/light/Parameters.nw).
#include "malus/light/Parameters.hpp"

#include <gtest/gtest.h>

using namespace malus;

namespace {
const Parameters& someParameters() {
  using namespace parameter;
  static const Parameters all{
      spectrum(number("share", "", "what is kept", {0, 1})),
      number("width_deg", "deg", "a width", {0, 90, true}, "5"),
      optional(number("depth", "", "a depth", {0, 10})),
      optional(choice("place", "where", {"below", "above"}, "")),
      formerly("colour", choice("kind", "which", {"red", "blue"}, "red"))};
  return all;
}
const InputPlace scene{"s.json", 7, "sky", 3};

Settings checked(const Arguments& arguments, const ParameterOwner& owner = {"a thing", scene}) {
  return checkedSettings(owner, someParameters(), arguments, SpectralGrid::make({500, 600}));
}
std::string complaint(const Arguments& arguments,
                      const ParameterOwner& owner = {"a thing", scene}) {
  try {
    checked(arguments, owner);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
Argument written(const std::string& text) { return {text, {"command line", 0, "--x"}}; }
}  // namespace

TEST(ParametersIdentity, SettingsWithoutAPlaceAreTheModels) {
  EXPECT_EQ(Settings{}.place.file, "model");
  EXPECT_EQ(Settings{}.place.line, 0);
}

TEST(ParametersIdentity, ValuesDefaultsAndWhatIsAbsent) {
  const Settings s = checked({{"share", written("0.25")}, {"depth", written("2")}});
  EXPECT_EQ(s.numbers.at("share"), 0.25);
  EXPECT_EQ(s.numbers.at("width_deg"), 5);
  EXPECT_EQ(s.words.at("kind"), "red");
  EXPECT_TRUE(s.has("depth"));
  EXPECT_FALSE(s.has("place"));
  EXPECT_EQ(s.spectrum("share")[1], 0.25);
  EXPECT_EQ(s.placeOf("depth").field, "--x");
  EXPECT_EQ(s.placeOf("width_deg").line, 7);  // of the whole: it was not given
}

TEST(ParametersIdentity, AScenesNumbersAndSpectraAreNotReadFromTheirText) {
  Argument number = written("none of this is read");
  number.number = 0.5;
  EXPECT_EQ(checked({{"share", number}}).numbers.at("share"), 0.5);
  Argument spectrum = written("{..}");
  CDSpectralVector<double> values(SpectralGrid::make({500, 600}));
  values[0] = 0.1, values[1] = 0.9;
  spectrum.spectrum = std::make_shared<const CDSpectralVector<double>>(values);
  EXPECT_EQ(checked({{"share", spectrum}}).spectrum("share")[1], 0.9);
  values[1] = 1.5;  // each band is looked at, and not the first alone
  spectrum.spectrum = std::make_shared<const CDSpectralVector<double>>(values);
  spectrum.place = {"s.json", 9, "materials.tin.share", 4};
  EXPECT_EQ(
      complaint({{"share", spectrum}}),
      "s.json:9:4: materials.tin.share = {..}: gives share 1.5 at 600 nm; it must be 0 to 1; "
      "give what is kept (0 to 1)");
}

TEST(ParametersIdentity, TheEndsOfAnIntervalBelongToItButForAnOpenOne) {
  for (const char* share : {"0", "1"})
    EXPECT_EQ(complaint({{"share", written(share)}, {"width_deg", written("90")}}), "accepted");
  for (const char* share : {"-1e-9", "1.000000001"})
    EXPECT_NE(complaint({{"share", written(share)}}), "accepted") << share;
  EXPECT_EQ(complaint({{"share", written("1")}, {"depth", written("10")}}), "accepted");
  EXPECT_NE(complaint({{"share", written("1")}, {"depth", written("10.1")}}), "accepted");
}

TEST(ParametersIdentity, EachRefusalSaysWhereWhatAndWhatWouldBeRight) {
  const Argument half = written("0.5");
  EXPECT_EQ(complaint({{"share", half}}), "accepted");  // control
  EXPECT_EQ(complaint({{"share", half}, {"widht_deg", written("3")}}),
            "command line: --x = 3: is not a parameter of a thing; did you mean width_deg? "
            "choose from: share, width_deg, depth, place, kind");
  EXPECT_EQ(complaint({{"share", half}, {"colour", written("red")}}),
            "command line: --x = red: is now called kind; write kind");
  EXPECT_EQ(
      complaint({{"share", half}, {"width_deg", written("0")}}),
      "command line: --x = 0 deg: must be above 0, up to 90; give a width (above 0, up to 90)");
  EXPECT_EQ(
      complaint({{"share", half}, {"place", written("beside")}}),
      "command line: --x = beside: is not one of the words allowed here; choose from: below, "
      "above");
  EXPECT_EQ(complaint({{"share", written("nan")}}).substr(0, 23), "command line: --x = nan");
}

TEST(ParametersIdentity, WhatIsMissingIsReportedWhereItBelongs) {
  EXPECT_EQ(complaint({}), "s.json:7:3: sky: lacks \"share\"; give what is kept (0 to 1)");
  EXPECT_EQ(complaint({}, {"a thing"}),
            "command line: --param share: is missing for a thing; give what is kept (0 to 1)");
  EXPECT_EQ(complaint({}, {"a thing", {"command line", 0, ""}, true}),
            "command line: --share: is missing for a thing; give what is kept (0 to 1)");
}

TEST(ParametersIdentity, FlagsAreNamedAsTheirParameters) {
  EXPECT_EQ(flagOf("pressure_hPa"), "--pressure-hPa");
  EXPECT_EQ(helpFor(someParameters()[1]), "a width; 5 if not given [deg]");
  EXPECT_NE(describe(someParameters()).find("depth        a depth: 0 to 10; may be left out\n"),
            std::string::npos);
}
