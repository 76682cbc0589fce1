// A ground's matrices by harmonics of the azimuth (nw/air/GroundHarmonics.nw).
#include "malus/air/GroundHarmonics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "malus/surface/BRDFRoughWater.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
AirGround copper() {
  return {0, std::make_shared<BRDFTorranceSparrow>(
                 0.405, 2.95, 0.3,
                 TorranceSparrowOptions{Shadowing::smith, DiffuseTerm::reciprocal})};
}
AirGround water() {
  const SpectralGridPtr grid = SpectralGrid::make({550.0});
  return {0, std::make_shared<BRDFRoughWater>(CDSpectralVector<double>(grid, 0.02),
                                              WaterState{8, 15, 35, true})};
}
bool isOdd(int k, int l) { return (k < 2) != (l < 2); }
/// One element at an azimuth, from the harmonics.
double summed(const GroundHarmonics& harmonics, int highest, std::size_t k, std::size_t l,
              double azimuth) {
  double sum = 0;
  for (int m = 0; m <= highest; ++m) {
    const double share = (m == 0 ? 1 : 2) / (2 * pi), c = harmonics.at(m, k, l)(0, 0);
    if (!isOdd(int(k), int(l)))
      sum += share * c * std::cos(m * azimuth);
    else
      sum += share * (k < 2 ? -c : c) * std::sin(m * azimuth);
  }
  return sum;
}
}  // namespace

TEST(GroundHarmonicsByHand, LambertHasOneHarmonic) {
  const GroundHarmonics harmonics({0.3}, {0.2, 0.9}, {0.5}, 3);
  for (int m = 0; m <= 3; ++m)
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t l = 0; l < 4; ++l)
        EXPECT_DOUBLE_EQ(harmonics.at(m, k, l)(1, 0), m + k + l == 0 ? 0.6 : 0);
  EXPECT_DOUBLE_EQ(groundMatrix({0.3}, 0.5, 0.2, 1)[0], 0.3 / pi);
}

// Sixty harmonics of facets this rough, with a shadowing that has no kink, leave a millionth at
// these angles; the azimuths are not nodes of the rule.
TEST(GroundHarmonicsInvariant, TheirSumIsTheMatrix) {
  constexpr int highest = 60;
  for (const AirGround& ground : {copper(), water()}) {
    const double in = 0.8, out = 0.6;
    const GroundHarmonics harmonics(ground, {out}, {in}, highest);
    for (const double azimuth : {0.1, 0.77, 1.9, 3.0, 4.4}) {
      const auto f = groundMatrix(ground, in, out, azimuth);
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t l = 0; l < 4; ++l)
          EXPECT_NEAR(summed(harmonics, highest, k, l, azimuth), f[4 * k + l],
                      1e-6 * f[0] + 1e-9)
              << k << l << ' ' << azimuth;
    }
    const auto f = groundMatrix(ground, in, out, 0.77);
    EXPECT_GT(std::abs(summed(harmonics, highest, 0, 2, -0.77) - f[2]),
              1e-3 * f[0]);  // control
  }
}

// The glint of a calm sea at grazing angles is a tenth of a degree wide: the zeroth harmonic against an integral by brute
// force; even steps of two degrees (the control) miss it.
TEST(GroundHarmonicsInvariant, FlatGlintsAreNotMissed) {
  const AirGround sea{
      0, std::make_shared<BRDFTorranceSparrow>(
             1.33, 0.0, 0.08,
             TorranceSparrowOptions{Shadowing::smithCorrelated, DiffuseTerm::none})};
  const double in = 0.01, out = 0.012;
  const auto integral = [&](int steps) {
    double sum = 0;
    for (int i = 0; i < steps; ++i)
      sum += groundMatrix(sea, in, out, 2 * pi * (i + 0.5) / steps)[0] * 2 * pi / steps;
    return sum;
  };
  const double exact = integral(200000);
  EXPECT_NEAR(GroundHarmonics(sea, {out}, {in}, 0).at(0, 0, 0)(0, 0) / exact, 1, 1e-6);
  EXPECT_GT(std::abs(integral(180) / exact - 1), 0.01);  // control
}

// Light of three harmonics in all four components, reflected by harmonics and by brute force.
TEST(GroundHarmonicsInvariant, ReflectedLightIsTheIntegral) {
  const AirGround ground = copper();
  const double in = 0.7, out = 0.4;
  const int steps = 4000;
  const GroundHarmonics harmonics(ground, {out}, {in}, 3);
  for (const int m : {1, 2, 3})
    for (const double azimuth : {0.4, 2.2}) {
      std::array<double, 4> brute{}, ours{};
      const std::array<double, 4> light{1, 0.3, -0.2, 0.1};
      for (int i = 0; i < steps; ++i) {
        const double from = 2 * pi * i / steps;
        const auto f = groundMatrix(ground, in, out, azimuth - from);
        for (std::size_t k = 0; k < 4; ++k)
          for (std::size_t l = 0; l < 4; ++l)
            brute[k] += f[4 * k + l] * light[l] *
                        (l < 2 ? std::cos(m * from) : std::sin(m * from)) * 2 * pi / steps;
      }
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t l = 0; l < 4; ++l)
          ours[k] += harmonics.at(m, k, l)(0, 0) * light[l] *
                     (k < 2 ? std::cos(m * azimuth) : std::sin(m * azimuth));
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(ours[k], brute[k], 1e-8) << m << ' ' << k;
    }
}
