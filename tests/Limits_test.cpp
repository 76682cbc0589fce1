// Limits of a number (nw/base/Limits.nw).
#include "malus/base/Limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "malus/base/Refusal.hpp"
#include "malus/surface/BRDFDIRSIG.hpp"
#include "malus/surface/BRDFGlossyCoating.hpp"
#include "malus/surface/BRDFMinnaert.hpp"
#include "malus/surface/BRDFNadalBreon.hpp"
#include "malus/surface/BRDFRoughWater.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();

std::string sentence(double value, const Limits& limits, std::string_view unit = "") {
  try {
    requireWithin("it", value, limits, unit);
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}
}  // namespace

TEST(LimitsIdentity, TheEndsAreWithinUnlessOpen) {
  const Limits closed{0, 90}, open{0, 90, true}, none;
  for (const double value : {0.0, -0.0, 1.0, 90.0}) EXPECT_TRUE(closed.contain(value)) << value;
  EXPECT_FALSE(open.contain(0));
  EXPECT_FALSE(open.contain(-0.0));
  EXPECT_TRUE(open.contain(5e-324));
  EXPECT_TRUE(open.contain(90));
  EXPECT_TRUE(none.contain(infinity));
  for (const Limits& limits : {closed, open, none})
    for (const double value : {-5e-324, -infinity, std::nan("")})
      EXPECT_FALSE(limits.contain(value)) << value;
  EXPECT_FALSE(closed.contain(std::nextafter(90.0, 91.0)));
}

TEST(LimitsIdentity, TheSentenceNamesValueAndRange) {
  EXPECT_EQ(sentence(0.5, fractions), "");
  EXPECT_EQ(sentence(2, fractions), "it must be 0 to 1, not 2");
  EXPECT_EQ(sentence(0, {0, 90, true}, "deg"), "it must be above 0, up to 90 deg, not 0");
}

// One home: what the descriptor shows are the limits of the class.
TEST(LimitsIdentity, DescriptorsShowTheLimitsOfTheirClasses) {
  const auto shown = [](std::string_view model, std::string_view name) {
    for (const Parameter& parameter : modelEntry(model, {}).parameters)
      if (parameter.name == name) return rangeOf(parameter.limits);
    return std::string("no such parameter");
  };
  EXPECT_EQ(shown("minnaert", "exponent"), rangeOf(BRDFMinnaert::exponents));
  EXPECT_EQ(shown("dirsig", "width_deg"), rangeOf(BRDFDIRSIG::widths_deg));
  EXPECT_EQ(shown("glossy-coating", "n"), rangeOf(BRDFGlossyCoating::indices));
  EXPECT_EQ(shown("nadal-breon", "beta"), rangeOf(BRDFNadalBreon::slopes));
  EXPECT_EQ(shown("rough-water", "temperature_C"), rangeOf(WaterState::temperatures_C));
  EXPECT_NE(shown("rough-water", "temperature_C"), rangeOf(WaterState::salinities));  // control
}
