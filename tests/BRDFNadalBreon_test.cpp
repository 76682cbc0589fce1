// Vegetation and soil (nw/surface/BRDFNadalBreon.nw) against the published formula with Snell's angles.
#include "malus/surface/BRDFNadalBreon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ModelChecks.hpp"
#include "malus/base/Error.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

BRDFNadalBreon land(double body, double rho, double beta, double n = 1.5) {
  const auto grid = SpectralGrid::make({670.0});
  return BRDFNadalBreon(CDSpectralVector<double>(grid, body), rho, beta, n);
}
BRDFNadalBreon varied() { return BRDFNadalBreon(ramp(manyBands(), 0.0, 0.4), 0.03, 10); }

/// Half the difference of the reflectances at an angle of incidence, by Snell's angle.
double polarizedFresnel(double angle, double n) {
  const double inside = std::asin(std::sin(angle) / n);
  const double s = std::sin(angle - inside) / std::sin(angle + inside);
  const double p = std::tan(angle - inside) / std::tan(angle + inside);
  return (s * s - p * p) / 2;
}
/// Polarised reflectance of unpolarised light, and the angle of the plane of polarisation against s.
struct Polarized {
  double reflectance, angle;
};
Polarized polarized(const CDMuellerMatrix& f) {
  return {pi * std::hypot(f.getMueller(1, 0), f.getMueller(2, 0)),
          std::atan2(f.getMueller(2, 0), f.getMueller(1, 0)) / 2};
}
double halfAngle(const Angles& a) {
  return std::acos(
             dot(CDVector::fromAngles(a.theta_i, 0), CDVector::fromAngles(a.theta_r, a.phi))) /
         2;
}
}  // namespace

TEST(BRDFNadalBreonPublished, PolarizedReflectance) {
  for (const auto& [rho, beta] : {std::pair{0.03, 8.0}, {0.015, 40.0}, {0.04, 1.0}})
    for (const Angles& a : someAngles(60, 1.4)) {
      const double Fp = polarizedFresnel(halfAngle(a), 1.5);
      const double expected =
          rho * (1 - std::exp(-beta * Fp / (std::cos(a.theta_i) + std::cos(a.theta_r))));
      const double ours = polarized(land(0.04, rho, beta).getBRDF(a.there()).at(0)).reflectance;
      EXPECT_NEAR(ours, expected, 1e-13);  // rounding of the reference near beta = 0
      const double other =
          polarized(land(0.04, rho, 1.1 * beta).getBRDF(a.there()).at(0)).reflectance;
      if (Fp > 1e-3) {
        EXPECT_GT(other, expected * (1 + 1e-6));  // negative control
      }
    }
}

// Far from saturation rho beta = 1/4 is the wood of Rondeaux and Herman: Fp / 4(mu_i + mu_r).
TEST(BRDFNadalBreonPublished, LeavesInAllDirections) {
  for (const Angles& a : someAngles(30, 1.2)) {
    const double expected =
        polarizedFresnel(halfAngle(a), 1.5) / 4 / (std::cos(a.theta_i) + std::cos(a.theta_r));
    const double ours = polarized(land(0, 1, 0.25).getBRDF(a.there()).at(0)).reflectance;
    EXPECT_NEAR(ours / expected, 1, 0.06);  // saturation: half of beta Fp / (mu_i + mu_r)
    EXPECT_LT(ours, expected);
  }
}

TEST(BRDFNadalBreonIdentity, TheExampleOfTheChapter) {
  const auto f =
      land(0.04, 0.03, 0.25 / 0.03).getBRDF(BRDFGeometry::fromDegrees(60, 60, 180)).at(0);
  EXPECT_NEAR(polarized(f).reflectance, 0.0155, 5e-5);
}

// The electric field is across to the plane that holds sun, surface point and viewer.
TEST(BRDFNadalBreonIdentity, PolarizedAcrossToThePlaneOfScattering) {
  for (const Angles& a : someAngles(40, 1.4)) {
    const CDVector i = CDVector::fromAngles(a.theta_i, 0),
                   r = CDVector::fromAngles(a.theta_r, a.phi);
    const CDVector s = normalized(cross({0, 0, 1}, r)), p = cross(r, s);
    const double angle = polarized(land(0.04, 0.03, 8).getBRDF(a.there()).at(0)).angle;
    const CDVector field = std::cos(angle) * s + std::sin(angle) * p;
    EXPECT_NEAR(dot(field, i), 0, 1e-9);  // and dot(field, r) = 0 by its making
    EXPECT_GT(std::abs(dot(std::cos(angle) * s - std::sin(angle) * p, i)) +
                  std::abs(std::sin(2 * angle)),
              1e-12);
  }
}

TEST(BRDFNadalBreonInvariant, ReciprocalRealizableAndFast) {
  const BRDFNadalBreon model = varied();
  EXPECT_LT(reciprocityError(model), 1e-10);                // rotations near the normal
  EXPECT_GT(reciprocityError(model, {1, 1, 1, -1}), 1e-3);  // negative control
  expectRealizable(model, 1e-9);
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
  EXPECT_LE(largestDHR(model), 1);
  const auto back = model.getBRDF(BRDFGeometry::fromDegrees(30, 30, 0)).at(0);
  EXPECT_NEAR(back.getMueller(1, 0), 0, 1e-15);  // the sun behind the viewer
  EXPECT_TRUE(std::isfinite(back.getScalar()));
}

TEST(BRDFNadalBreonInvariant, EnergyIsDemanded) {
  EXPECT_GT(largestDHR(land(0, 0.03, 8)), 0.01);
  EXPECT_THROW(land(0.99, 0.03, 30), MathError);
  EXPECT_THROW(land(0.5, 1, 100), MathError);
}

TEST(BRDFNadalBreonIdentity, DHRAgreesWithThePlainIntegration) {
  expectDHRIsTheIntegral(varied(), 1e-5);  // the rise towards grazing, seen by 60 points
}

TEST(BRDFNadalBreonInvariant, TheSampler) {
  expectSamplesFollowDensity(varied());
  EXPECT_LT(draw(varied(), land(0.01, 0.03, 10), 0.6).p_value,
            false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(land(0.05, 0.03, 8)), 0.01);
  EXPECT_LT(expectSamplerGivesDHR(land(0, 0.03, 8)), 0.01);
}

TEST(BRDFNadalBreonIdentity, ImpossibleLandIsRefused) {
  for (const double bad : {-0.1, 0.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(land(0.1, bad, 8), MathError);
    EXPECT_THROW(land(0.1, 0.03, bad), MathError);
    EXPECT_THROW(land(0.1, 0.03, 8, bad), MathError);
    if (bad != 0) {
      EXPECT_THROW(land(bad, 0.03, 8), MathError);
    }
  }
  EXPECT_THROW(land(0.1, 0.03, 8).getDHR(pi / 2), MathError);
}
