// Kinds of scatterers, what they send straight ahead, and the aureole (nw/air/LayerMix.nw).
#include "malus/air/LayerMix.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace malus;

namespace {
/// Henyey and Greenstein's: alpha1 = (2 l + 1) g^l, so that the share straight ahead is g^L.
constexpr double g = 0.9;
Scatterer peaked() { return henyeyGreensteinScatterer(g); }
}  // namespace

TEST(LayerMixByHand, TheShareStraightAheadIsNotScattered) {
  const std::size_t terms = 20;
  const double f = std::pow(g, 20), depth = 2, albedo = 0.8;
  const LayerMix mix({{{peaked(), depth, albedo}}}, terms);
  EXPECT_NEAR(mix.peaks.at(0), f, 1e-12);
  EXPECT_NEAR(mix.bottoms.at(0), depth * (1 - albedo * f), 1e-12);
  EXPECT_NEAR(mix.true_bottoms.at(0), depth, 1e-15);
  const auto greek = mix.greek(0, terms);
  const double share = albedo / (1 - albedo * f) / 2;
  for (const int l : {0, 1, 7, 19}) {
    EXPECT_NEAR(greek(l, 0), share * (2 * l + 1) * (std::pow(g, l) - f), 1e-12);
    EXPECT_NEAR(greek(l, 1), l < 2 ? 0 : -share * (2 * l + 1) * f, 1e-12);
  }
  EXPECT_NEAR(mix.depthOf(depth / 4), mix.bottoms[0] / 4, 1e-12);
  EXPECT_EQ(LayerMix({{{peaked(), depth, albedo}}}, 1000).peaks.at(0),
            0);  // all terms: no peak
}

TEST(LayerMixInvariant, KindsAreToldApartAndMixed) {
  const Scatterer air = rayleighScatterer(0.03), haze = peaked();
  const LayerMix mix({{{air, 0.3}}, {{air, 0.1}, {haze, 0.4, 0.9}, {air, 0.05, 0}}}, 2000);
  ASSERT_EQ(mix.kinds.size(), 2u);
  EXPECT_NEAR(mix.scattered(0, 0), 1, 1e-15);
  EXPECT_NEAR(mix.scattered(1, 0), 0.1 / 0.55, 1e-15);
  EXPECT_NEAR(mix.scattered(1, 1), 0.36 / 0.55, 1e-15);
  EXPECT_NEAR(mix.depthOf(0.5), 0.5, 1e-15);
  EXPECT_NEAR(mix.depthOf(9), 0.85, 1e-15);
  EXPECT_FALSE(mix.circular);
}

// The sum over n scatterings, each known by its terms, done without the exponential.
TEST(LayerMixInvariant, TheAureoleIsPoissonsSum) {
  const std::size_t terms = 10;
  const double depth = 0.7, sun = 0.6, mu = 0.5;
  const LayerMix mix({{{peaked(), 3, 1}}}, terms);
  const double path = (1 / sun + 1 / mu) / 2, passed = depth * path * mix.scattered(0, 0);
  const auto aureole = mix.aureole(sun, mu, depth);
  for (const std::size_t l : {0u, 5u, 10u, 30u, 80u}) {
    double sum = 0, power = 1;
    const double peak = l < terms ? 0 : std::pow(g, l) - mix.peaks[0];
    for (int n = 1; n < 40; ++n) {
      power *= passed / n;
      if (n > 1) sum += power * (std::pow(peak, n) - std::pow(-mix.peaks[0], n));
    }
    EXPECT_NEAR(aureole.at(l),
                (2 * double(l) + 1) * sum * std::exp(-depth * path) / (4 * std::numbers::pi),
                1e-12)
        << l;
  }
  EXPECT_TRUE(LayerMix({{{peaked(), 3, 1}}}, 2000).aureole(sun, mu, depth).empty());
}

// Through deep air the sum of Poisson has terms beyond all numbers, and nothing comes through.
TEST(LayerMixInvariant, NoAureoleThroughDeepAir) {
  for (const double depth : {1e3, 1e4})
    for (const double term : LayerMix({{{peaked(), depth}}}, 20).aureole(0.5, 0.5, depth / 2))
      EXPECT_LT(std::abs(term), 1e-9);
  EXPECT_GT(std::abs(LayerMix({{{peaked(), 5}}}, 20).aureole(0.5, 0.5, 1)[0]), 1e-6);
}
