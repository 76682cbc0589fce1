// Ruffled water (nw/surface/BRDFRoughWater.nw) against published numbers and the formula of Cox and Munk.
#include "malus/surface/BRDFRoughWater.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ModelChecks.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

BRDFRoughWater sea(double wind, bool foam = true, double body = 0) {
  const auto grid = SpectralGrid::make({550.0});
  return BRDFRoughWater(CDSpectralVector<double>(grid, body), {wind, 15, 35, foam});
}
BRDFRoughWater varied(double wind, bool foam = true) {
  return BRDFRoughWater(ramp(manyBands(), 0.05, 0.0), {wind, 15, 35, foam});
}
}  // namespace

// Fresh water at 589.3 nm and 20 C: 1.3330 (every handbook); sea water of 35 per mille: 1.3394 (Austin and Halikas 1976).
TEST(BRDFRoughWaterPublished, IndexOfWater) {
  EXPECT_NEAR(waterIndex(589.3, 20, 0), 1.3330, 5e-5);
  EXPECT_NEAR(waterIndex(589.3, 20, 35), 1.3394, 5e-5);
  EXPECT_GT(std::abs(waterIndex(589.3, 30, 0) - 1.3330), 5e-5);  // negative control
  EXPECT_GT(waterIndex(400, 20, 0), waterIndex(700, 20, 0));     // dispersion
}

// The mixed difference of the formula as Quan and Fry print it, in a temperature twice and in the salinity once: 2 * 1.6e-8
// times the square of 15 degrees, times 40. All other terms drop out, whatever the wavelength; the rest is rounding.
TEST(BRDFRoughWaterPublished, SaltMattersTheMoreTheWarmerTheWater) {
  const auto bend = [](double salinity) {
    return waterIndex(550, 30, salinity) - 2 * waterIndex(550, 15, salinity) +
           waterIndex(550, 0, salinity);
  };
  EXPECT_NEAR(bend(40) - bend(0), 2 * 1.6e-8 * 15 * 15 * 40, 1e-14);
  EXPECT_NEAR(bend(0), -2 * 2.02e-6 * 15 * 15, 1e-14);
}

// A viewer in the plane of the surface still counts as above it, by both ways of adding light; 1e-5: single precision.
TEST(BRDFRoughWaterIdentity, GatherAlongTheSurfaceIsScatter) {
  const auto grid = SpectralGrid::make({550.0});
  const BRDFRoughWater model = sea(12, true);
  const CDVector along{1, 0, 0}, source = CDVector::fromAngles(0.7, 2);
  const CDSpectralVector<CDStokesVector> light(grid, CDStokesVector(3.0));
  const float x = float(source.x), y = float(source.y), z = float(source.z), weight = 0.25f;
  CDSpectralVector<CDStokesVector> gathered(grid), scattered(grid);
  model.gather(along, {1, &x, &y, &z, &weight}, light, gathered);
  model.scatter(BRDFGeometry::fromDirections(source, along), 0.25, light, scattered);
  const double expected = CDStokesVector(scattered.at(0)).getScalar();
  EXPECT_GT(expected, 0) << "negative control: there is something to see";
  EXPECT_NEAR(CDStokesVector(gathered.at(0)).getScalar(), expected, 1e-5 * expected);
}

// Diffuse light on flat water: 0.066 outside for n = 4/3, 0.48 inside for n = 1.341 (Mobley 1994).
TEST(BRDFRoughWaterPublished, DiffuseLightOnFlatWater) {
  const auto grid = SpectralGrid::make({550.0});
  const auto inside = [&](double n) {
    return BRDFGlossyCoating(CDSpectralVector<double>(grid, n),
                             CDSpectralVector<double>(grid, 0.5), 0)
        .getInnerReflectance(0);
  };
  EXPECT_NEAR(inside(1.341), 0.48, 5e-3);
  EXPECT_NEAR(1 - 16. / 9 * (1 - inside(4. / 3)), 0.066, 5e-4);
  EXPECT_GT(std::abs(inside(1.5) - 0.48), 5e-3);  // negative control
}

// Mean square slopes of the clean surface at 10 m/s, 0.0542, and the share of whitecaps, about one per cent.
TEST(BRDFRoughWaterPublished, WavesAndWhitecaps) {
  EXPECT_NEAR(2 * std::pow(waveSlope(10), 2), 0.0542, 1e-12);
  EXPECT_NEAR(foamShare(10), 0.00977, 5e-6);  // 2.95e-6 * 3311
  EXPECT_EQ(foamShare(0), 0);
}

// Cox and Munk's glint: R(omega) P(slopes) / (4 cos i cos r cos^4 tilt), slopes from the two directions.
TEST(BRDFRoughWaterPublished, GlintOfCoxAndMunk) {
  for (const double wind : {1.0, 5.0, 12.0}) {
    const BRDFRoughWater water = sea(wind, false);
    for (const Angles& a : someAngles(60, 0.9)) {  // no wave hides another yet
      const CDVector i = CDVector::fromAngles(a.theta_i, 0),
                     r = CDVector::fromAngles(a.theta_r, a.phi);
      const double zx = -(i.x + r.x) / (i.z + r.z), zy = -(i.y + r.y) / (i.z + r.z);
      const double mss = 0.003 + 0.00512 * wind, cos2 = 1 / (1 + zx * zx + zy * zy);
      const double P = std::exp(-(zx * zx + zy * zy) / mss) / (pi * mss);
      const double omega = std::acos(dot(i, r)) / 2;
      const double inside = std::asin(std::sin(omega) / waterIndex(550, 15, 35));
      const double s = std::sin(omega - inside) / std::sin(omega + inside);
      const double p = std::tan(omega - inside) / std::tan(omega + inside);
      const double expected = (s * s + p * p) / 2 * P / (4 * i.z * r.z * cos2 * cos2);
      const double ours = water.getBRDF(a.there()).at(0).getScalar();
      if (expected > 1e-30) {
        EXPECT_NEAR(ours / expected, 1, 1e-9);  // exponents of up to 70
        EXPECT_GT(
            std::abs(sea(wind + 0.1, false).getBRDF(a.there()).at(0).getScalar() / expected -
                     1),
            1e-6);  // negative control
      }
    }
  }
}

// The sun reflected at Brewster's angle is fully polarised, across to the plane of incidence.
TEST(BRDFRoughWaterIdentity, BrewstersGlint) {
  const double brewster = std::atan(waterIndex(550, 15, 35)) / degree;
  const auto f =
      sea(5, false).getBRDF(BRDFGeometry::fromDegrees(brewster, brewster, 180)).at(0);
  EXPECT_NEAR(f.getMueller(1, 0) / f.getScalar(), 1, 1e-12);
  const auto foamy =
      sea(15, true).getBRDF(BRDFGeometry::fromDegrees(brewster, brewster, 180)).at(0);
  EXPECT_LT(foamy.getMueller(1, 0) / foamy.getScalar(), 0.99);  // foam depolarises
}

TEST(BRDFRoughWaterInvariant, ReciprocalRealizableAndFast) {
  for (const double wind : {0.0, 5.0, 20.0}) {
    const BRDFRoughWater model = varied(wind);
    EXPECT_LT(reciprocityError(model), 1e-10);  // rotations near the normal
    expectRealizable(model, 1e-9);
    expectScatterIsTheMatrix(model, 1e-13);
    expectNoAllocation(model);
    expectScoreAndHorizon(model);
    EXPECT_LE(largestDHR(model), 1);
  }
}

TEST(BRDFRoughWaterIdentity, DHRAndGatherAreTheSums) {
  expectDHRIsTheIntegral(varied(15), 3e-4);  // kinks of the grooves between 60 points
  const BRDFRoughWater model = varied(15);
  std::array<float, 3> x{0.1f, -0.5f, 0.3f}, y{0.2f, 0.4f, 0}, z{0.9f, 0.7f, -0.5f},
      w{0.3f, 0.2f, 0.1f};
  for (std::size_t i = 0; i < 3; ++i) {
    const float length = std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    x[i] /= length, y[i] /= length, z[i] /= length;
  }
  CDSpectralVector<CDStokesVector> light(model.grid(), CDStokesVector(2.0)), fast(model.grid()),
      plain(model.grid());
  fast.polarize(), plain.polarize();
  const CDVector viewer = CDVector::fromAngles(0.8, 1.0);
  model.gather(viewer, {3, x.data(), y.data(), z.data(), w.data()}, light, fast);
  model.CDBRDFModel::gather(viewer, {3, x.data(), y.data(), z.data(), w.data()}, light, plain);
  for (std::size_t band = 0; band < light.size(); ++band)
    for (int k = 0; k < 4; ++k)  // single precision of directions and facets
      EXPECT_NEAR(fast.at(band).getStokes(k), plain.at(band).getStokes(k),
                  2e-5 * plain.at(band).getScalar());
}

TEST(BRDFRoughWaterInvariant, TheSampler) {
  expectSamplesFollowDensity(varied(15));
  EXPECT_LT(draw(varied(15), varied(14), 0.6).p_value, false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(sea(5, true, 0.02)), 0.02);
  EXPECT_LT(expectSamplerGivesDHR(sea(0, false)), 0.02);
}

TEST(BRDFRoughWaterIdentity, ImpossibleWaterIsRefused) {
  for (const double bad : {-0.1, 20.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(sea(bad), MathError);
    EXPECT_THROW(waveSlope(bad), MathError);
    EXPECT_THROW(foamShare(bad), MathError);
  }
  EXPECT_THROW(sea(5, true, 1.1), MathError);
  EXPECT_THROW(waterIndex(199, 15, 35), MathError);
  EXPECT_THROW(waterIndex(1101, 15, 35), MathError);
  EXPECT_THROW(waterIndex(550, -1, 35), MathError);
  EXPECT_THROW(waterIndex(550, 15, 41), MathError);
}
