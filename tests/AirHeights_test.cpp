// What is at which height (nw/air/AirHeights.nw).
#include "malus/air/AirHeights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "malus/air/LayeredLight.hpp"
#include "malus/base/Refusal.hpp"

using namespace malus;

namespace {
AirPart part(double depth, const HeightSpread& spread) {
  return {{rayleighScatterer(0), depth}, spread};
}
// Density of a spread by a difference of its shares.
double density(const HeightSpread& s, double z) {
  return (s.above(z - 0.01) - s.above(z + 0.01)) / 0.02;
}
// Simpson's rule along a straight way.
double integral(const HeightSpread& s, double from, double to, double length) {
  constexpr int pieces = 4000;
  double sum = 0;
  for (int i = 0; i <= pieces; ++i) {
    const double weight = i == 0 || i == pieces ? 1 : i % 2 ? 4 : 2;
    sum += weight * density(s, from + (to - from) * i / pieces);
  }
  return sum * length / (3 * pieces);
}
}  // namespace

// The example of the chapter.
TEST(AirHeightsIdentity, HazeUnderClearAir) {
  const AirHeights air({part(0.1, {.scale_m = 8434.5}), part(0.3, {.scale_m = 2000})});
  EXPECT_NEAR(air.depth(2000), 0.189, 5e-4);
  EXPECT_NEAR(std::exp(-(air.whole() - air.depth(2000))), 0.81, 5e-3);
  EXPECT_DOUBLE_EQ(air.whole(), 0.4);
  EXPECT_EQ(air.depth(-50), air.whole());
}

// The difference of shares has 1e-16 / 0.02 of rounding, and even parts have a jump that Simpson's rule smears over a piece.
TEST(AirHeightsIdentity, WaysMeetTheIntegralOfTheDensity) {
  const HeightSpread haze{.scale_m = 1500}, cloud{.from_m = 800, .to_m = 1700};
  const struct {
    double from, to, length;
  } ways[]{{100, 3000, 2900},    {3000, 100, 9000}, {500, 500, 2000},
           {900, 900.001, 5000}, {1000, 1600, 700}, {2000, 2500, 1000}};
  for (const auto& [from, to, length] : ways)
    for (const HeightSpread& s : {haze, cloud}) {
      const double wanted = integral(s, from, to, length);
      EXPECT_NEAR(s.along(from, to, length), wanted, 2e-4 * length / 900 + 1e-9)
          << from << ' ' << to << ' ' << s.scale_m;
      EXPECT_EQ(s.along(from, to, length), s.along(to, from, length));
    }
  EXPECT_GT(std::abs(haze.along(100, 3000, 2900) - integral(haze, 100, 2000, 2900)), 0.01)
      << "negative control";
  EXPECT_EQ(cloud.along(2000, 2500, 1000), 0);
}

TEST(AirHeightsInvariant, LayersAddUpToTheirParts) {
  const AirHeights air({part(0.2, {.scale_m = 8000}), part(0.4, {.from_m = 500, .to_m = 2500}),
                        part(3, {.from_m = 2000, .to_m = 2200}),
                        part(0, {.from_m = 5000, .to_m = 6000})});
  double sum = 0;
  ASSERT_EQ(air.layers().size() + 1, air.borders().size());
  for (std::size_t i = 0; i < air.layers().size(); ++i) {
    double depth = 0;
    for (const Particles& p : air.layers()[i]) depth += p.optical_depth;
    sum += depth;
    EXPECT_NEAR(air.borders()[i + 1].depth, sum, 1e-12);
    EXPECT_GT(depth, 0);
  }
  EXPECT_NEAR(sum, 3.6, 1e-12);
  EXPECT_EQ(air.borders().back().depth, air.whole());
  int jumps = 0;
  for (const AirHeights::Border& border : air.borders()) jumps += border.jump;
  EXPECT_EQ(jumps,
            8);  // top, ground, and two for each even part, also for the one that is empty
}

// A gap in which nothing is, and parts that are spread alike.
TEST(AirHeightsIdentity, GapsAndOneLayer) {
  const AirHeights two(
      {part(1, {.from_m = 100, .to_m = 200}), part(2, {.from_m = 700, .to_m = 900})});
  ASSERT_EQ(two.layers().size(), 2u);
  EXPECT_NEAR(two.layers()[0][0].optical_depth, 2, 1e-12);
  const AirHeights one({part(0.1, {.scale_m = 8000}), part(0.3, {.scale_m = 8000})});
  EXPECT_EQ(one.layers().size(), 1u);
  EXPECT_EQ(one.layers()[0].size(), 2u);
  EXPECT_THROW(AirHeights({}), Refusal);
  EXPECT_THROW(AirHeights({part(0, {.scale_m = 8000})}), Refusal);
}

// Steps of the mixture: sixteen against sixty, of the sky's light, for a haze that has none of the colour of the air.
TEST(AirHeightsInvariant, SixteenStepsAreEnough) {
  const std::vector<double> views{0.05, 0.3, 0.9};
  const auto sky = [&](int steps) {
    const AirHeights air({{{henyeyGreensteinScatterer(0.7), 0.3, 0.9}, {.scale_m = 1500}},
                          part(0.24, {.scale_m = 8434.5})},
                         steps);
    return LayeredLight(air.layers(), 0.5, AirGround{0.2}, 3, views, {air.whole(), 0});
  };
  const LayeredLight fine = sky(60), usual = sky(16), coarse = sky(2);
  double most = 0, most_coarse = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double phi : {0.0, 1.0, 3.1}) {
      const double down = fine.down(v, phi, 0).getScalar(), up = fine.up(v, phi, 1).getScalar();
      most = std::max({most, std::abs(usual.down(v, phi, 0).getScalar() / down - 1),
                       std::abs(usual.up(v, phi, 1).getScalar() / up - 1)});
      most_coarse =
          std::max({most_coarse, std::abs(coarse.down(v, phi, 0).getScalar() / down - 1),
                    std::abs(coarse.up(v, phi, 1).getScalar() / up - 1)});
    }
  EXPECT_LT(most, 3e-3);
  EXPECT_GT(most_coarse, 3e-3) << "negative control";
  RecordProperty("most", std::to_string(most));
}
