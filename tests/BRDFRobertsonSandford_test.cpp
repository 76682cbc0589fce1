// Robertson and Sandford's paint (nw/surface/BRDFRobertsonSandford.nw) against the integrals of
// its norms.
#include "malus/surface/BRDFRobertsonSandford.hpp"

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

BRDFRobertsonSandford paint(double emissivity, double diffuse, double b, double e) {
  const auto grid = SpectralGrid::make({10000.0});
  const auto of = [&](double x) { return CDSpectralVector<double>(grid, x); };
  return BRDFRobertsonSandford(of(emissivity), of(diffuse), of(b), of(e));
}
BRDFRobertsonSandford varied(double narrow = 0.4) {
  const auto grid = manyBands();
  auto e = ramp(grid, narrow, narrow);
  for (std::size_t i = 70; i < e.size(); ++i) e[i] = 0.7;
  return BRDFRobertsonSandford(ramp(grid, 0.5, 0.2), ramp(grid, 0.1, 0.5), ramp(grid, 0, 0.3),
                               e);
}
}  // namespace

TEST(BRDFRobertsonSandfordIdentity, TheMeanFallIsItsIntegral) {
  for (const double b : {0.0, 0.01, 0.2, 0.7, 0.99, 0.995, 0.999999, 1.0}) {
    constexpr int steps = 200000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double mu = (i + 0.5) / steps, tan2 = 1 / (mu * mu) - 1;
      sum += 2 * mu / (1 + b * b * tan2) / steps;
    }
    EXPECT_NEAR(BRDFRobertsonSandford::meanFall(b), sum, 1e-9) << b;  // midpoints
    EXPECT_GT(std::abs(BRDFRobertsonSandford::meanFall(0.99 * b + 0.005) - sum),
              1e-6);  // control
  }
}

// The norm against the lobe summed over the viewer's hemisphere, half vectors as vectors.
TEST(BRDFRobertsonSandfordIdentity, TheNormOfTheLobeIsItsIntegral) {
  for (const double zenith : {0.0, 0.6, 1.2, 1.5})
    for (const double e : {0.2, 0.5, 1.0}) {
      constexpr int steps = 700;
      const CDVector source = CDVector::fromAngles(zenith, 0);
      double sum = 0;
      for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
          const double mu = (i + 0.5) / steps, phi = 2 * pi * (j + 0.5) / steps;
          const CDVector m = normalized(source + CDVector::fromAngles(std::acos(mu), phi));
          sum += std::pow(e * e * m.z * m.z + 1 - m.z * m.z, -2);
        }
      const double expected = sum / (2. * steps * steps);
      EXPECT_NEAR(BRDFRobertsonSandford::lobeNorm(std::cos(zenith), e) / expected, 1, 2e-4);
      if (e < 1) {  // negative control; at e = 1 all zeniths are alike
        EXPECT_GT(
            std::abs(BRDFRobertsonSandford::lobeNorm(std::cos(zenith), 1.01 * e) / expected -
                     1),
            1e-3);
      }
    }
}

// The formulas as they are handed down, in angles.
TEST(BRDFRobertsonSandfordPublished, TheFormulas) {
  const double eps = 0.5, rho = 0.3, b = 0.25, e = 0.35;
  const auto g = [&](double theta) { return 1 / (1 + b * b * std::pow(std::tan(theta), 2)); };
  const double G = 1 / (1 - b * b) * (1 + b * b / (1 - b * b) * std::log(b * b));
  for (const Angles& a : someAngles(60, 1.5)) {
    const CDVector m =
        normalized(CDVector::fromAngles(a.theta_i, 0) + CDVector::fromAngles(a.theta_r, a.phi));
    const double c = std::cos(a.theta_i), q = (1 - e * e) * (1 - e * e) * c * c;
    const double H =
        ((1 - e * e) * c + (2 * e * e + q) / std::sqrt(q + 4 * e * e)) / (2 * e * e);
    const double h = std::pow(e * e * m.z * m.z + (1 - m.z * m.z), -2);
    const double rho_s = 1 - (eps + rho) * g(a.theta_i) / G;
    const double expected = rho / pi * g(a.theta_i) * g(a.theta_r) / (G * G) +
                            rho_s / (4 * pi) * h / (H * std::cos(a.theta_r));
    EXPECT_NEAR(paint(eps, rho, b, e).getBRDF(a.there()).at(0).getScalar() / expected, 1,
                1e-11);
    EXPECT_GT(
        std::abs(paint(eps, rho, b, 1.01 * e).getBRDF(a.there()).at(0).getScalar() / expected -
                 1),
        1e-9);  // negative control
  }
}

TEST(BRDFRobertsonSandfordInvariant, EnergyIsSharedOutWhole) {
  expectDHRIsTheIntegral(varied(), 2e-5);  // 60 points over a lobe
  EXPECT_LE(largestDHR(varied()), 1 + 1e-12);
  EXPECT_NEAR(paint(0, 0.9, 0, 0.3).getDHR(1.0)[0], 1, 1e-15);  // nothing is absorbed
  EXPECT_NEAR(paint(0.7, 0.2, 0, 0.3).getDHR(1.0)[0], 0.3, 1e-15);
}

TEST(BRDFRobertsonSandfordInvariant, RealizableFastAndNotReciprocal) {
  const BRDFRobertsonSandford model = varied();
  EXPECT_GT(reciprocityError(model), 0.05);
  expectRealizable(model, 1e-12);
  expectScatterIsTheMatrix(model, 1e-14);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
}

TEST(BRDFRobertsonSandfordInvariant, TheSampler) {
  expectSamplesFollowDensity(varied());
  EXPECT_LT(draw(varied(), varied(0.45), 0.6).p_value, false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(paint(0.3, 0.3, 0.2, 0.3)), 0.01);
  EXPECT_LT(expectSamplerGivesDHR(paint(0.1, 0, 0.2, 0.02)), 0.01);
}

// Paint that emits all and scatters nothing still has a sampler, of densities that are numbers; along the horizon it is zero.
TEST(BRDFRobertsonSandfordInvariant, BlackPaintIsSampledToo) {
  const CDVector given = CDVector::fromAngles(0.5, 1);
  const BRDFRobertsonSandford black = paint(1, 0, 0, 0.3), grey = paint(0.3, 0.2, 0, 0.3);
  for (const BRDFRobertsonSandford* model : {&black, &grey})
    for (const double u : {0.1, 0.5, 0.9}) {
      const BRDFSample drawn = model->sample(given, u, u, u);
      EXPECT_NEAR(drawn.direction.getLength(), 1, 1e-12);
      EXPECT_EQ(drawn.density_per_sr, model->density(given, drawn.direction));
      EXPECT_TRUE(drawn.direction.z > 0 ? drawn.density_per_sr > 0 : drawn.density_per_sr == 0);
    }
  EXPECT_EQ(grey.density(given, {1, 0, 0}), 0);
  EXPECT_GT(grey.density(given, normalized({1, 0, 1e-6})), 0) << "negative control";
}

TEST(BRDFRobertsonSandfordIdentity, ImpossiblePaintsAreRefused) {
  for (const double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(paint(bad, 0.1, 0.2, 0.3), MathError);
    EXPECT_THROW(paint(0.1, bad, 0.2, 0.3), MathError);
    EXPECT_THROW(paint(0.1, 0.1, bad, 0.3), MathError);
    EXPECT_THROW(paint(0.1, 0.1, 0.2, bad), MathError);
  }
  EXPECT_THROW(paint(0.1, 0.1, 0.2, 0), MathError);
  EXPECT_THROW(paint(0.5, 0.5, 0.2, 0.3), MathError);  // G(.2) is below one
  EXPECT_NO_THROW(paint(0.5, 0.5, 0, 0.3));
  EXPECT_THROW(paint(0.1, 0.1, 0.2, 0.3).getDHR(pi / 2), MathError);
}
