// The sentences that a user or a programmer meets when something is wrong (nw/light/CDError.nw).
#include "light/CDError.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

using namespace malus;

namespace {
const std::string whole =
    "plate.csv:7: sigma = -1 rad: must be positive; give a roughness such as 0.2";

std::string said(const CDInputPlace& place, const std::string& value) {
  return CDInputError(place, value, "must be positive", "give a roughness such as 0.2").what();
}
}  // namespace

TEST(CDErrorIdentity, NamesFileLineFieldValueProblemAndRemedy) {
  EXPECT_EQ(said({"plate.csv", 7, "sigma"}, "-1 rad"), whole);
}

TEST(CDErrorIdentity, NegativeControlAnotherLineIsAnotherSentence) {
  EXPECT_NE(said({"plate.csv", 8, "sigma"}, "-1 rad"), whole);
}

TEST(CDErrorIdentity, UnknownPartsLeaveNoTrace) {
  EXPECT_EQ(said({"command line", 0, "--sigma"}, "-1"),
            "command line: --sigma = -1: must be positive; give a roughness such as 0.2");
  EXPECT_EQ(said({"plate.csv", 0, ""}, ""),
            "plate.csv: must be positive; give a roughness such as 0.2");
  EXPECT_EQ(said({"", 0, "sigma"}, ""),
            "sigma: must be positive; give a roughness such as 0.2");
}

// Found by make fuzz: a field of a YAML file whose value went over several lines.
TEST(CDErrorIdentity, AnyValueMakesOneLine) {
  EXPECT_STREQ(
      CDInputError({"a.yml", 7, "type"}, "formula 5\nx\x1b[2J", "is not known", "write 1")
          .what(),
      "a.yml:7: type = formula 5\\nx\\x1b[2J: is not known; write 1");
  const std::string longer(201, 'v');
  EXPECT_STREQ(CDInputError({"a", 0, "f"}, longer, "is long", "cut it").what(),
               ("a: f = " + longer.substr(1) + "...: is long; cut it").c_str());
}

TEST(CDErrorIdentity, PlaceIsKept) {
  const CDInputError error({"a.csv", 3, "n"}, "x", "is not a number", "write digits");
  EXPECT_EQ(error.place().file, "a.csv");
  EXPECT_EQ(error.place().line, 3);
  EXPECT_EQ(error.place().field, "n");
}

TEST(CDErrorIdentity, OffersTheNearestNameOnlyWhenItIsNear) {
  const std::vector<std::string> known{"torrance-sparrow", "lambertian"};
  EXPECT_EQ(didYouMean("torrence-sparow", known),
            "did you mean torrance-sparrow? known are: torrance-sparrow, lambertian");
  EXPECT_EQ(didYouMean("phong", known), "known are: torrance-sparrow, lambertian");
}

TEST(CDErrorInvariant, ChecksBothSidesAndRefusesNaN) {
  EXPECT_NO_THROW(checkInvariant("R + T = 1", 1.0, 1.0 + 1e-16, 1e-15));
  EXPECT_THROW(checkInvariant("R + T = 1", 1.0, 1.1, 1e-15), CDInvariantError);
  EXPECT_THROW(checkInvariant("R + T = 1", std::numeric_limits<double>::quiet_NaN(), 1.0, 1e9),
               CDInvariantError);
}
