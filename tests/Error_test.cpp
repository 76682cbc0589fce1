// The sentences that a user or a programmer meets when something is wrong (nw/base/Error.nw).
#include "malus/base/Error.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

using namespace malus;

namespace {
const std::string whole =
    "plate.csv:7: sigma = -1 rad: must be positive; give a roughness such as 0.2";

std::string said(const InputPlace& place, const std::string& value) {
  return InputError(place, value, "must be positive", "give a roughness such as 0.2").what();
}
}  // namespace

TEST(ErrorIdentity, NamesFileLineFieldValueProblemAndRemedy) {
  EXPECT_EQ(said({"plate.csv", 7, "sigma"}, "-1 rad"), whole);
}

TEST(ErrorIdentity, NegativeControlAnotherLineIsAnotherSentence) {
  EXPECT_NE(said({"plate.csv", 8, "sigma"}, "-1 rad"), whole);
}

TEST(ErrorIdentity, UnknownPartsLeaveNoTrace) {
  EXPECT_EQ(said({"command line", 0, "--sigma"}, "-1"),
            "command line: --sigma = -1: must be positive; give a roughness such as 0.2");
  EXPECT_EQ(said({"plate.csv", 0, ""}, ""),
            "plate.csv: must be positive; give a roughness such as 0.2");
  EXPECT_EQ(said({"", 0, "sigma"}, ""),
            "sigma: must be positive; give a roughness such as 0.2");
}

// Found by make fuzz: a field of a YAML file whose value went over several lines.
TEST(ErrorIdentity, AnyValueMakesOneLine) {
  EXPECT_STREQ(
      InputError({"a.yml", 7, "type"}, "formula 5\nx\x1b[2J", "is not known", "write 1").what(),
      "a.yml:7: type = formula 5\\nx\\x1b[2J: is not known; write 1");
  const std::string longer(201, 'v');
  EXPECT_STREQ(InputError({"a", 0, "f"}, longer, "is long", "cut it").what(),
               ("a: f = " + longer.substr(1) + "...: is long; cut it").c_str());
}

TEST(ErrorIdentity, PlaceIsKept) {
  const InputError error({"a.csv", 3, "n"}, "x", "is not a number", "write digits");
  EXPECT_EQ(error.place().file, "a.csv");
  EXPECT_EQ(error.place().line, 3);
  EXPECT_EQ(error.place().field, "n");
}

TEST(ErrorIdentity, OffersTheNearestNameOnlyWhenItIsNear) {
  const std::vector<std::string> known{"torrance-sparrow", "lambertian"};
  EXPECT_EQ(didYouMean("torrence-sparow", known),
            "did you mean torrance-sparrow? choose from: torrance-sparrow, lambertian");
  EXPECT_EQ(didYouMean("phong", known), "choose from: torrance-sparrow, lambertian");
}

// A third of the letters and one more may be wrong: three of six, two of three, one of two, and no
// more than that. Of two names that are equally near the first is offered, of others the nearer.
TEST(ErrorIdentity, ANearNameHasAThirdOfItsLettersAndOneMoreWrong) {
  const std::vector<std::string> six{"abcdef"}, three{"abc"}, two{"ab"};
  EXPECT_EQ(nearestName("abcxyz", six), "did you mean abcdef? ");
  EXPECT_EQ(nearestName("abwxyz", six), "");
  EXPECT_EQ(nearestName("axy", three), "did you mean abc? ");
  EXPECT_EQ(nearestName("xyz", three), "");
  EXPECT_EQ(nearestName("ax", two), "did you mean ab? ");
  EXPECT_EQ(nearestName("xy", two), "");
  const std::vector<std::string> several{"abcdxy", "abcdez", "abcdew", "abcdef"};
  EXPECT_EQ(nearestName("abcdeq", several), "did you mean abcdez? ");
  EXPECT_EQ(nearestName("abcdef", several), "did you mean abcdef? ");
}

// Insertions, deletions and exchanges count one each: kitten to sitting is three, and no name of
// more letters than the limit of three reaches is near.
TEST(ErrorPublished, KittenIsThreeEditsFromSitting) {
  const std::vector<std::string> sitting{"sitting"}, longer{"sittings"};
  EXPECT_EQ(nearestName("kitten", sitting), "did you mean sitting? ");
  EXPECT_EQ(nearestName("kitten", longer), "");
  EXPECT_EQ(nearestName("itting", sitting), "did you mean sitting? ");
  EXPECT_EQ(nearestName("sittingxyz", sitting), "did you mean sitting? ");
  EXPECT_EQ(nearestName("xyzsitting", sitting), "did you mean sitting? ");
  EXPECT_EQ(nearestName("sittingwxyz", sitting), "did you mean sitting? ") << "four of four";
  EXPECT_EQ(nearestName("sittinguvwxyz", sitting), "") << "six letters too many, five may be";
}

// Names of up to two hundred bytes are compared, a list of up to a hundred is printed whole.
TEST(ErrorIdentity, TheSearchAndTheListHaveLimits) {
  const std::string longest(200, 'n');
  const std::vector<std::string> fits{longest}, exceeds{longest + "n"};
  EXPECT_EQ(nearestName(longest, fits), "did you mean " + longest + "? ");
  EXPECT_EQ(nearestName(longest, exceeds), "");
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) names.push_back("name" + std::to_string(i));
  EXPECT_TRUE(didYouMean("?", names).ends_with("name98, name99"));
  names.push_back("name100");
  EXPECT_TRUE(didYouMean("?", names).ends_with("name98, name99, ... (101 in all)"));
}

// A value of 200 bytes is whole, and a cut falls before a letter of several bytes and not in it.
TEST(ErrorIdentity, ALongTextIsCutBetweenLetters) {
  const auto shown = [](const std::string& value) {
    return std::string(InputError({"a", 0, "f"}, value, "is long", "cut it").what());
  };
  const std::string whole_value(200, 'v');
  EXPECT_EQ(shown(whole_value), "a: f = " + whole_value + ": is long; cut it");
  const std::string before(198, 'v');
  EXPECT_EQ(shown(before + "\u20ac"), "a: f = " + before + "...: is long; cut it");
  EXPECT_EQ(shown(before + "\u00e4x"), "a: f = " + before + "\u00e4...: is long; cut it");
  const std::string part(2000, 'p');
  EXPECT_EQ(std::string(InputError({}, "", part, part).what()), part + "; " + part);
  EXPECT_EQ(std::string(InputError({}, "", part + "p", part).what()), part + "...; " + part);
}

// The limits hold for what is printed: three letters of a line that are written out as twelve.
TEST(ErrorIdentity, ATextThatGrowsWhenItIsWrittenOutIsCutToo) {
  const std::string zeros(1500, '\0');
  const std::string message = InputError({zeros, 0, zeros}, zeros, zeros, zeros).what();
  EXPECT_LT(message.size(), 6000u + 2 * 200 + 2 * 2000 + 30);  // the name of the file is whole
  const std::string remedy = InputError({}, "", "", zeros).what();
  EXPECT_EQ(remedy.substr(0, 6), "; \\x00");
  EXPECT_EQ(remedy.size(), 2 + 2000 + 3u);
}

// Control characters are all below 32, and 127; bytes that are not UTF-8 are written like them,
// one by one, wherever they are.
TEST(ErrorIdentity, ControlCharactersAndBrokenBytesAreSpelt) {
  const auto shown = [](const std::string& problem) {
    return std::string(InputError({}, "", problem, "").what());
  };
  EXPECT_EQ(shown("a\x1f \x7f~"), "a\\x1f \\x7f~; ");
  EXPECT_EQ(shown("\xff\xfe"), "\\xff\\xfe; ");
  EXPECT_EQ(shown("a\xff\u00e4\xfe\u00e4z"), "a\\xff\u00e4\\xfe\u00e4z; ");
}

TEST(ErrorIdentity, ALetterInTheLineIsNamed) {
  EXPECT_EQ(std::string(InputError({"s.json", 1, "", 1}, "", "p", "r").what()),
            "s.json:1:1: p; r");
  EXPECT_EQ(std::string(InputError({"s.json", 1, "", 0}, "", "p", "r").what()),
            "s.json:1: p; r");
}

TEST(ErrorInvariant, ChecksBothSidesAndRefusesNaN) {
  EXPECT_NO_THROW(checkInvariant("R + T = 1", 1.0, 1.0 + 1e-16, 1e-15));
  EXPECT_NO_THROW(checkInvariant("at the tolerance", 1.0, 1.5, 0.5));
  EXPECT_THROW(checkInvariant("R + T = 1", 1.0, 1.1, 1e-15), InvariantError);
  EXPECT_THROW(checkInvariant("R + T = 1", std::numeric_limits<double>::quiet_NaN(), 1.0, 1e9),
               InvariantError);
}
