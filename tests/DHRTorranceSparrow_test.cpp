// The light that single reflections lose: against an integral in other coordinates, a sum over
// the hemisphere, drawn facets, and the printed table 7.1 (nw/surface/DHRTorranceSparrow.nw).
#include "malus/surface/DHRTorranceSparrow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"

using namespace malus;
using std::numbers::pi;
using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;

namespace {
const DHRTorranceSparrow dhr;

// Mean over psi of max(0, 1 + a cos(psi) - from).
double meanHinge(double a, double from) {
  const double k = from - 1;
  if (k >= a) return 0;
  if (k <= -a) return -k;
  const double psi = std::acos(k / a);
  return (a * std::sin(psi) - k * psi) / pi;
}

// The remainder over polar slopes (rho, psi), where the book uses (p, q). For fixed rho the
// integrand is piecewise linear in u = 1 + rho t cos(psi), so the inner integral is elementary.
double polarRemainder(double theta, double sigma) {
  const double t = std::tan(theta);
  const auto missing = [&](double x) {
    const double rho = sigma * x, A = 4 / (1 + rho * rho), a = rho * t;
    const double mean =
        A >= 2 ? meanHinge(a, 0) - A * meanHinge(a, 2 / A) + (A - 1) * meanHinge(a, 2 / (A - 1))
               : meanHinge(a, 0) - meanHinge(a, 2) - A * meanHinge(a, 2 / A) +
                     A * meanHinge(a, 4 / A);
    return x * std::exp(-x * x / 2) * mean;
  };
  std::vector<double> bends{0.,
                            1 / t,
                            t,
                            1.,
                            std::sqrt(3.),
                            std::abs(std::tan((theta - pi / 2) / 3)),
                            std::tan((theta + pi / 2) / 3),
                            std::cos(theta) / (1 + std::sin(theta)),
                            (1 + std::sin(theta)) / std::cos(theta)};
  for (double& bend : bends) bend = std::clamp(bend / sigma, 0., 9.);
  bends.push_back(9.);
  std::sort(bends.begin(), bends.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
    const double middle = (bends[i] + bends[i + 1]) / 2, half = (bends[i + 1] - bends[i]) / 2;
    const auto smooth = [&](double psi) {  // square roots at the ends become smooth
      return missing(middle - half * std::cos(psi)) * half * std::sin(psi);
    };
    if (half > 0) sum += Quadrature::integrate(smooth, 0., pi, 4, 1e-12);
  }
  return sum;
}

// As in 2002: a sum over a grid of directions in the hemisphere.
double hemisphericalSum(double theta, double sigma, Shadowing kind, int zeniths, int azimuths) {
  double sum = 0;
  for (int z = 0; z < zeniths; ++z)
    for (int a = 0; a < azimuths; ++a) {
      const double from = z * pi / 2 / zeniths, to = (z + 1) * pi / 2 / zeniths;
      const auto g =
          BRDFGeometry::fromAngles(theta, (from + to) / 2, (a + 0.5) * 2 * pi / azimuths);
      const double solid_angle = (std::cos(from) - std::cos(to)) * 2 * pi / azimuths;
      sum += facetFactor(kind, g, facetGeometry(g), sigma) * g.cos_r * solid_angle;
    }
  return sum;
}
}  // namespace

TEST(DHRTorranceSparrowIdentity, QuadratureEqualsTheIntegralOverPolarSlopes) {
  for (const double sigma : {0.01, 0.05, 0.2, 0.4, 0.6, 1.0})
    for (const double theta_deg :
         {1.0, 20.0, 40.0, 44.9, 45.1, 60.0, 75.0, 85.0, 88.0, 89.0, 89.9})
      EXPECT_NEAR(DHRTorranceSparrow::integrateRemainder(theta_deg * degree, sigma),
                  polarRemainder(theta_deg * degree, sigma), 1e-12)  // both claim that much
          << sigma << " " << theta_deg;
}

TEST(DHRTorranceSparrowIdentity, NegativeControlAnotherRoughnessIsAnotherRemainder) {
  EXPECT_GT(
      std::abs(DHRTorranceSparrow::integrateRemainder(0.7, 0.2) - polarRemainder(0.7, 0.2001)),
      1e-6);
}

TEST(DHRTorranceSparrowIdentity, QuadratureEqualsASumOverTheHemisphere) {
  // The grid's own error, seen by halving it, is below 3e-4 in the worst of these cases.
  for (const auto kind :
       {Shadowing::none, Shadowing::vGroove, Shadowing::smith, Shadowing::smithCorrelated})
    for (const double theta_deg : {0.0, 40.0, 75.0}) {
      const double sum = hemisphericalSum(theta_deg * degree, 0.3, kind, 300, 300);
      const double exact = DHRTorranceSparrow::integrate(theta_deg * degree, 0.3, kind);
      EXPECT_NEAR(sum, exact, 1e-4) << int(kind) << " " << theta_deg;
    }
}

TEST(DHRTorranceSparrowIdentity, LimitsOfAngleAndRoughness) {
  EXPECT_EQ(DHRTorranceSparrow::integrate(0.7, 0), 1);
  EXPECT_EQ(DHRTorranceSparrow::integrate(0.7, 0, Shadowing::smith), 1);
  EXPECT_EQ(dhr.getDHR(0.7, 0), 1);
  EXPECT_EQ(dhr.getAverage(0), 1);
  EXPECT_NEAR(DHRTorranceSparrow::integrate(0.7, 1e-9), 1, 1e-15);
  EXPECT_NEAR(DHRTorranceSparrow::integrate(pi / 2, 0.3), 1, 1e-15);
  EXPECT_EQ(dhr.getRemainder(0., 1., 0.3), 0);
  // normal incidence: only tilts beyond 30 deg lose light
  EXPECT_LT(DHRTorranceSparrow::integrateRemainder(0, 0.1), 1e-7);
  EXPECT_GT(DHRTorranceSparrow::integrateRemainder(0, 0.1), 0);
}

TEST(DHRTorranceSparrowIdentity, RefusesWhatIsNoAngleAndNoRoughness) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(dhr.getDHR(-0.1, 0.2), MathError);
  EXPECT_THROW(dhr.getDHR(1.6, 0.2), MathError);
  EXPECT_THROW(dhr.getDHR(nan, 0.2), MathError);
  EXPECT_THROW(dhr.getDHR(0.1, -0.2), MathError);
  EXPECT_THROW(dhr.getDHR(0.1, nan), MathError);
  EXPECT_THROW(dhr.getRemainder(-0.1, 1, 0.2), MathError);
  EXPECT_THROW(dhr.getRemainder(nan, 1, 0.2), MathError);
  EXPECT_THROW(dhr.getAverage(-1), MathError);
  EXPECT_THROW(DHRTorranceSparrow::integrate(2, 0.2, Shadowing::none), MathError);
}

TEST(DHRTorranceSparrowInvariant, TableErrsByLessThanItPromises) {
  // Rows between nodes, where linear interpolation is worst; the class promises 1e-5.
  double worst = 0;
  for (const double sigma : {0.0103, 0.0249, 0.0511, 0.1003, 0.2009, 0.3011, 0.4511, 0.5991})
    for (double theta_deg = 0.05; theta_deg < 90; theta_deg += 0.61)
      worst =
          std::max(worst, std::abs(dhr.getDHR(theta_deg * degree, sigma) -
                                   DHRTorranceSparrow::integrate(theta_deg * degree, sigma)));
  EXPECT_LT(worst, 1e-5);
  EXPECT_GT(worst, 1e-7);  // negative control: it is a table that is measured
}

TEST(DHRTorranceSparrowInvariant, BetweenZeroAndOneEverywhere) {
  for (double sigma : {1e-6, 1e-3, 0.01, 0.2, 0.6, 0.7, 3.0})
    for (double theta_deg = 0; theta_deg <= 90; theta_deg += 7.5) {
      const double remainder = dhr.getRemainder(theta_deg * degree, sigma);
      EXPECT_GE(remainder, 0) << sigma << " " << theta_deg;
      EXPECT_LE(remainder, 1) << sigma << " " << theta_deg;
    }
}

TEST(DHRTorranceSparrowInvariant, WithoutShadowingItExceedsOneAndWithItNever) {
  const double grazing = 85 * degree;
  EXPECT_GT(DHRTorranceSparrow::integrate(grazing, 0.3, Shadowing::none), 1);
  for (const auto kind : {Shadowing::vGroove, Shadowing::smith, Shadowing::smithCorrelated})
    EXPECT_LE(DHRTorranceSparrow::integrate(grazing, 0.3, kind), 1);
}

TEST(DHRTorranceSparrowInvariant, DrawnFacetsReflectTheSameShare) {
  // Visible normals weighed by G / G1 above the horizon: their mean is the DHR. 2e5 draws; five
  // standard deviations of the mean, whose false alarm level is 6e-7. Fixed seed.
  const double theta = 65 * degree, sigma = 0.3;
  const CDVector i = CDVector::fromAngles(theta, 0);
  std::mt19937_64 random(314159);
  std::uniform_real_distribution<double> uniform(0, 1);
  double sum = 0, squares = 0;
  constexpr int draws = 200000;
  for (int n = 0; n < draws; ++n) {
    const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
    const CDVector m = sampleVGrooveNormal(i, sigma, u1, u2, u3);
    const CDVector r = 2 * dot(i, m) * m - i;
    if (r.z <= 0) continue;
    const auto g = BRDFGeometry::fromDirections(i, r);
    const auto facet = facetGeometry(g);
    const double weight = facetFactor(Shadowing::vGroove, g, facet, sigma) * g.cos_r /
                          vGrooveReflectionDensity(g, facet, sigma);
    ASSERT_LE(weight, 1 + 1e-12);
    sum += weight;
    squares += weight * weight;
  }
  const double mean = sum / draws,
               deviation = std::sqrt((squares / draws - mean * mean) / draws);
  EXPECT_NEAR(mean, DHRTorranceSparrow::integrate(theta, sigma), 5 * deviation);
  EXPECT_GT(std::abs(mean - DHRTorranceSparrow::integrate(theta, 0.25)),
            5 * deviation);  // control
}

TEST(DHRTorranceSparrowInvariant, AverageIsThatOfTheTableItself) {
  for (const double sigma : {0.0131, 0.2, 0.5551, 0.9}) {
    const auto weighed = [&](double mu) { return 2 * dhr.getDHR(std::acos(mu), sigma) * mu; };
    // adaptive Gauss-Kronrod over a polygon's corners leaves 1e-8; above 0.6 the polygon itself
    // 1e-5
    const double tolerance = sigma <= 0.6 ? 1e-7 : 1e-5;
    EXPECT_NEAR(dhr.getAverage(sigma), Quadrature::integrate(weighed, 0., 1., 7, 1e-9),
                tolerance)
        << sigma;
  }
}

TEST(DHRTorranceSparrowInvariant, EveryThreadReadsTheSameBits) {
  std::vector<std::vector<double>> read(4);
  std::vector<std::thread> threads;
  for (auto& values : read)
    threads.emplace_back([&values] {
      for (int i = 0; i < 90; ++i) values.push_back(dhr.getDHR(i * degree, 0.4717));
    });
  for (auto& thread : threads) thread.join();
  for (const auto& values : read) EXPECT_EQ(values, read[0]);
  EXPECT_NE(read[0][10], read[0][80]);
}

TEST(DHRTorranceSparrowPublished, DiffuseTermThatTable71Needs) {
  // Table 7.1: irradiance 100 at 30 deg gives L0 = 102.2. With f00 = 1.17187 of the facets the
  // diffuse term that fills it up is the one at the view zenith; the one at 30 deg does not.
  const auto radiance = [](double diffuse) {
    return (1.17187 + diffuse) * 100 * std::cos(30 * degree);
  };
  const double at_40 = dhr.getRemainder(40 * degree, 0.2) / pi;
  const double at_30 = dhr.getRemainder(30 * degree, 0.2) / pi;
  EXPECT_NEAR(at_40, 0.0085, 5e-5);
  EXPECT_NEAR(at_30, 0.0044, 5e-5);
  EXPECT_NEAR(radiance(at_40), 102.2, 0.05);  // half a unit of the last printed digit
  EXPECT_GT(std::abs(radiance(at_30) - 102.2), 0.05);
  EXPECT_GT(std::abs(radiance(0) - 102.2), 0.05);
}

TEST(DHRTorranceSparrowRegression, FormerValues) {
  EXPECT_NEAR(DHRTorranceSparrow::integrateRemainder(40 * degree, 0.2) / pi, 0.008526, 5e-7);
  EXPECT_NEAR(DHRTorranceSparrow::integrateRemainder(30 * degree, 0.2) / pi, 0.004385, 5e-7);
  EXPECT_GT(
      std::abs(DHRTorranceSparrow::integrateRemainder(40.01 * degree, 0.2) / pi - 0.008526),
      5e-7);  // negative control
}
