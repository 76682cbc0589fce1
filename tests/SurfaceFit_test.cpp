// Fitting n, k, sigma and the diffuse term to samples (nw/surface/SurfaceFit.nw).
#include "malus/surface/SurfaceFit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/DHRTorranceSparrow.hpp"
#include "malus/surface/DirectionSampling.hpp"
#include "malus/surface/Fresnel.hpp"

using namespace malus;

namespace {
/// What a laboratory sees of a surface: fs and fp about the mirror direction, and DHR. The truth is
/// the class itself with its own diffuse term, not the fit's prediction.
std::vector<FitSample> laboratory(const BRDFTorranceSparrow& truth, double relative) {
  std::vector<FitSample> samples;
  for (const double i : {15., 35., 55., 70.}) {
    for (double r = i - 30; r <= std::min(i + 30, 80.); r += 7.5) {
      if (r < 0) continue;
      const CDMuellerMatrix f = truth.at(BRDFGeometry::fromDegrees(i, r, 180));
      for (const double sign : {1., -1.}) {
        const double value = (f.getScalar() + sign * f.getMueller(1, 0)) / 2;
        samples.push_back({sign > 0 ? FitQuantity::seenS : FitQuantity::seenP, 0, i * degree,
                           r * degree, std::numbers::pi, value, relative * value});
      }
    }
  }
  const double dhr = truth.getDHR(15 * degree)[0];
  samples.push_back({FitQuantity::dhr, 0, 15 * degree, 0, 0, dhr, relative * dhr});
  return samples;
}

double normal(Random& random) {
  return std::sqrt(-2 * std::log(1 - random.uniform())) *
         std::cos(2 * std::numbers::pi * random.uniform());
}

std::vector<FitSample> polished(const std::vector<double>& angles_deg, double n, double k) {
  std::vector<FitSample> samples;
  for (const double angle : angles_deg) {
    const Reflectances R = fresnelReflectances(angle * degree, n, k);
    samples.push_back({FitQuantity::reflectanceS, 0, angle * degree, 0, 0, R.Rs, 1e-3});
    samples.push_back({FitQuantity::reflectanceP, 0, angle * degree, 0, 0, R.Rp, 1e-3});
  }
  return samples;
}
}  // namespace

// The fit takes the diffuse term's mean from the table (1e-5 absolute), the truth may sum it again.
TEST(SurfaceFitIdentity, SamplesWithoutNoiseGiveTheParametersBack) {
  const double surfaces[][3] = {
      {0.405, 2.950, 0.2}, {1.5, 0.3, 0.1}, {2.9, 3.1, 0.35}, {0.2, 5, 0.15}};
  for (const auto& [n, k, sigma] : surfaces) {
    const SurfaceFit fit = fitSurface(laboratory(BRDFTorranceSparrow(n, k, sigma), 0.01));
    EXPECT_NEAR(fit.values[0], n, 2e-3 * n);
    EXPECT_NEAR(fit.values[1], k, 2e-3 * k);
    EXPECT_NEAR(fit.values[2], sigma, 2e-4 * sigma);
    EXPECT_NEAR(fit.values[3], 1, 2e-2);
    EXPECT_LT(fit.chi2, 0.01);
  }
}

// The diffuse term is d (1 - E(theta_r)) / pi in the corner of the matrix and nowhere else, and so
// half of it in each polarisation. A sphere sees its integral, here summed by the midpoint rule, at
// any angle of incidence. The facets come from the class without a diffuse term.
TEST(SurfaceFitIdentity, TheDiffuseTermIsInTheCornerAlone) {
  constexpr double sigma = 0.3, theta_i = 40 * degree, theta_r = 25 * degree, phi = 2.5;
  TorranceSparrowOptions options;
  options.diffuse = DiffuseTerm::none;
  const BRDFTorranceSparrow facets(1.5, 0.2, sigma, options);
  const CDMuellerMatrix f = facets.at(BRDFGeometry::fromAngles(theta_i, theta_r, phi));
  const DHRTorranceSparrow table;
  const auto remainder = [&](double zenith) {
    return table.getRemainder(zenith, sigma) / std::numbers::pi;
  };
  double sphere = 0;
  constexpr int nodes = 2000;
  for (int i = 0; i < nodes; ++i) {
    const double zenith = (i + 0.5) / nodes * std::numbers::pi / 2;
    sphere += remainder(zenith) * std::cos(zenith) * std::sin(zenith) * std::numbers::pi *
              std::numbers::pi / nodes;
  }
  std::vector<FitSample> samples;
  for (int element = 0; element < 16; ++element)
    samples.push_back({FitQuantity::element, element, theta_i, theta_r, phi, 0, 1});
  samples.push_back({FitQuantity::seenS, 0, theta_i, theta_r, phi, 0, 1});
  samples.push_back({FitQuantity::seenP, 0, theta_i, theta_r, phi, 0, 1});
  for (const double at : {0.0, theta_i, 1.2})
    samples.push_back({FitQuantity::dhr, 0, at, 0, 0, 0, 1});
  for (const double d : {0.0, 1.0, 2.5}) {
    const Eigen::VectorXd y = predictSurface(samples, {1.5, 0.2, sigma, d});
    const double own = d * remainder(theta_r);
    for (int element = 0; element < 16; ++element)
      EXPECT_NEAR(y[element], f.getMueller(element / 4, element % 4) + (element == 0 ? own : 0),
                  1e-15)
          << element;
    EXPECT_NEAR(y[16], (f.getScalar() + own + f.getMueller(1, 0)) / 2, 1e-15);
    EXPECT_NEAR(y[17], (f.getScalar() + own - f.getMueller(1, 0)) / 2, 1e-15);
    Eigen::Index next = 18;
    for (const double at : {0.0, theta_i, 1.2})  // 1e-4: the table's mean and its interpolation
      EXPECT_NEAR(y[next++], facets.getDHR(at)[0] + d * sphere, 1e-4 * (1 + d)) << at;
  }
  EXPECT_GT(sphere, 0.05) << "negative control: the term is seen";
}

TEST(SurfaceFitIdentity, APolishedSampleGivesItsIndex) {
  const SurfaceFit fit =
      fitSurface(polished({20, 45, 60, 75}, 0.405, 2.95), {{{}, {}, 0.1, 0.0}});
  EXPECT_NEAR(fit.values[0], 0.405, 1e-6);  // differences of 1e-8 only steer, they do not bias
  EXPECT_NEAR(fit.values[1], 2.95, 1e-6);
  EXPECT_EQ(fit.values[2], 0.1);  // fixed
  EXPECT_EQ(fit.errors[2], 0);
  EXPECT_GT(fit.errors[0], 0);
  const SurfaceFit other =
      fitSurface(polished({20, 45, 60, 75}, 0.41, 2.95), {{{}, {}, 0.1, 0.0}});
  EXPECT_GT(std::abs(other.values[0] - 0.405), 1e-3);  // negative control
}

// Each parameter that is not fixed is found wherever the others are held. A diffuse term of zero is not a roughness of zero.
TEST(SurfaceFitIdentity, OneParameterMayBeHeld) {
  TorranceSparrowOptions alone;
  alone.diffuse = DiffuseTerm::none;
  const auto samples = laboratory(BRDFTorranceSparrow(0.405, 2.95, 0.2, alone), 0.01);
  const std::array<double, 4> truth{0.405, 2.95, 0.2, 0};
  const SurfaceFit fit = fitSurface(samples, {{{}, {}, {}, 0.0}});
  for (std::size_t j = 0; j < 4; ++j)
    EXPECT_NEAR(fit.values[j], truth[j], 1e-6) << surface_parameter_names[j];
  EXPECT_GT(std::abs(fitSurface(samples, {{{}, {}, {}, 1.0}}).values[2] - 0.2), 1e-4)
      << "negative control: another diffuse term bends the others";
}

// 60 runs: the ratio of scatter and stated error is known to 1/sqrt(120) = 9 %; four of these.
TEST(SurfaceFitInvariant, ParametersScatterAsTheirErrorsSay) {
  const auto exact = laboratory(BRDFTorranceSparrow(0.405, 2.95, 0.2), 0.01);
  Random random(8);
  std::array<double, 4> squares{}, halves{};
  constexpr int runs = 60;
  for (int run = 0; run < runs; ++run) {
    auto noisy = exact;
    for (FitSample& s : noisy) s.value += s.error * normal(random);
    const SurfaceFit fit = fitSurface(noisy);
    const std::array<double, 4> truth{0.405, 2.95, 0.2, 1};
    for (std::size_t j = 0; j < 4; ++j) {
      const double pull = (fit.values[j] - truth[j]) / fit.errors[j];
      squares[j] += pull * pull / runs;
      halves[j] += 4 * pull * pull / runs;
    }
  }
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_NEAR(std::sqrt(squares[j]), 1, 0.36) << surface_parameter_names[j];
    EXPECT_GT(std::abs(std::sqrt(halves[j]) - 1),
              0.36);  // negative control: errors half as large
  }
}

TEST(SurfaceFitInvariant, AWrongModelIsToldByChiSquared) {
  TorranceSparrowOptions smith;
  smith.shadowing = Shadowing::none;
  smith.diffuse = DiffuseTerm::none;
  const SurfaceFit fit =
      fitSurface(laboratory(BRDFTorranceSparrow(1.5, 0.3, 0.35, smith), 0.001));
  EXPECT_GT(fit.chi2, 10.0 * static_cast<double>(fit.samples));
  const auto told = [](const SurfaceFit& of) {
    return std::any_of(of.remarks.begin(), of.remarks.end(),
                       [](const std::string& r) { return r.starts_with("chi2 is "); });
  };
  EXPECT_TRUE(told(fit));
  EXPECT_FALSE(told(fitSurface(laboratory(BRDFTorranceSparrow(1.5, 0.3, 0.35), 0.01))));
}

TEST(SurfaceFitInvariant, WhatCannotBeToldIsRefused) {
  const FixedParameters smooth{{{}, {}, 0.1, 0.0}};
  // Rs = Rp at normal incidence: one number for n and k
  EXPECT_THROW(fitSurface(polished({0}, 0.405, 2.95), smooth), MathError);
  EXPECT_NO_THROW(fitSurface(polished({0, 70}, 0.405, 2.95), smooth));  // negative control
  EXPECT_THROW(fitSurface({}), MathError);
  EXPECT_THROW(fitSurface(polished({30}, 1.5, 0.1), {{1.5, 0.1, 0.1, 1.0}}), MathError);
  // a polished sample does not determine sigma
  EXPECT_THROW(fitSurface(polished({20, 45, 60}, 1.5, 1)), MathError);
}
