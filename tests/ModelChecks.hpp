// What every model of reflectance must pass, whatever it is (nw/surface/BRDF*.nw). Include this in one file of a
// test program: it counts allocations by its own operator new.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numbers>
#include <vector>

#include "DrawnDirections.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/CDBRDFModel.hpp"
#include "malus/surface/DirectionSampling.hpp"

namespace malus::testing {
inline std::size_t allocations = 0;
}

// Not inlined: g++ 12 would take free() for the wrong partner of new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++malus::testing::allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++malus::testing::allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace malus::testing {
constexpr double false_alarm = 1e-6;  // of one chi-squared test; a suite makes about ten

/// 150 bands, more than two blocks of 64 and no multiple of a vector's length.
inline SpectralGridPtr manyBands() {
  std::vector<double> nm;
  for (int i = 0; i < 150; ++i) nm.push_back(400 + 2.0 * i);
  return SpectralGrid::make(nm);
}
/// From low in the first band evenly to high in the last.
inline CDSpectralVector<double> ramp(const SpectralGridPtr& grid, double low, double high) {
  CDSpectralVector<double> v(grid);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = low + (high - low) * static_cast<double>(i) / std::max(1.0, double(v.size()) - 1);
  return v;
}

struct Angles {
  double theta_i, theta_r, phi;  // [rad]
  BRDFGeometry there() const { return BRDFGeometry::fromAngles(theta_i, theta_r, phi); }
  BRDFGeometry back() const { return BRDFGeometry::fromAngles(theta_r, theta_i, -phi); }
};
/// So many geometries at random, zenith angles up to most [rad].
inline std::vector<Angles> someAngles(int count, double most = 1.55) {
  Random random(1815);
  std::vector<Angles> all;
  for (int i = 0; i < count; ++i) {
    const double a = most * random.uniform(), b = most * random.uniform();
    all.push_back({a, b, 2 * std::numbers::pi * random.uniform()});
  }
  return all;
}

/// Largest violation of f(i,r) = Q f(r,i)^T Q, Q = diag(q), over f00, some geometries and all bands.
inline double reciprocityError(const CDBRDFModel& model,
                               const std::array<double, 4>& q = {1, 1, -1, 1}) {
  double worst = 0;
  for (const Angles& angles : someAngles(60)) {
    const auto there = model.getBRDF(angles.there()), back = model.getBRDF(angles.back());
    for (std::size_t band = 0; band < there.size(); ++band) {
      const CDMuellerMatrix f = there.at(band), b = back.at(band);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const double apart = std::abs(f.getMueller(i, j) - q[i] * q[j] * b.getMueller(j, i));
          if (apart > 0) worst = std::max(worst, apart / f.getMueller(0, 0));
        }
    }
  }
  return worst;
}

/// Every band of some geometries is a mixture of elements that exist.
inline void expectRealizable(const CDBRDFModel& model, double tolerance) {
  for (const Angles& angles : someAngles(60)) {
    const auto f = model.getBRDF(angles.there());
    for (std::size_t band = 0; band < f.size(); band += 7)
      ASSERT_TRUE(isRealizable(f.at(band), tolerance))
          << angles.theta_i << ' ' << angles.theta_r << ' ' << angles.phi << ' ' << band;
  }
}

/// scatter() against the matrix times the vector, for light polarised in every third band, in none, in all.
inline void expectScatterIsTheMatrix(const CDBRDFModel& model, double tolerance) {
  for (const std::size_t every : {1u, 3u, 1000000u})
    for (const Angles& angles : someAngles(20)) {
      CDSpectralVector<CDStokesVector> in(model.grid()), fast(model.grid()),
          plain(model.grid());
      for (std::size_t band = 0; band < in.size(); ++band) {
        const double s0 = 0.5 + 0.001 * static_cast<double>(band);
        if ((band + 1) % every == 0)
          in[band] = CDStokesVector(s0, 0.3 * s0, -0.2 * s0, 0.4 * s0);
        else
          in[band] = CDStokesVector(s0);
      }
      fast[0] = plain[0] = CDStokesVector(1, 0.5, 0.25, -0.5);
      model.scatter(angles.there(), 0.7, in, fast);
      model.CDBRDFModel::scatter(angles.there(), 0.7, in, plain);
      const auto f = model.getBRDF(angles.there());
      for (std::size_t band = 0; band < in.size(); ++band)
        for (int i = 0; i < 4; ++i)
          ASSERT_NEAR(fast.at(band).getStokes(i), plain.at(band).getStokes(i),
                      tolerance * (1 + f.at(band).getScalar()))
              << band << ' ' << i;
    }
}

/// One geometry and all its bands allocate nothing, once the sums are polarised.
inline void expectNoAllocation(const CDBRDFModel& model) {
  CDSpectralVector<CDStokesVector> in(model.grid(), CDStokesVector(1, 0.3, 0.2, 0.1)),
      plain(model.grid(), CDStokesVector(1)), sum(model.grid());
  CDSpectralVector<CDMuellerMatrix> f(model.grid());
  sum.polarize(), f.polarize();
  const auto g = BRDFGeometry::fromDegrees(30, 40, 170);
  const CDVector given = CDVector::fromAngles(0.5, 0);
  const auto ask = [&] {
    model.scatter(g, 0.1, in, sum), model.scatter(g, 0.1, plain, sum);
    model.evaluate(g, f), f.polarize();
    return model.getScore(g) + model.sample(given, 0.3, 0.4, 0.5).density_per_sr;
  };
  ask();  // what is computed on first use
  const std::size_t before = allocations;
  ask();
  EXPECT_EQ(allocations, before);
  std::vector<double> control(3);  // negative control
  EXPECT_GT(allocations, before);
}

/// Score and the horizon; a NaN shows.
inline void expectScoreAndHorizon(const CDBRDFModel& model) {
  for (const Angles& angles : someAngles(10))
    EXPECT_NEAR(model.getScore(angles.there()), model.CDBRDFModel::getScore(angles.there()),
                1e-12 * (1 + model.getScore(angles.there())));  // sums in another order
  const auto below = BRDFGeometry::fromDegrees(20, 91, 0);
  EXPECT_EQ(model.getScore(below), 0);
  EXPECT_EQ(model.getBRDF(below).at(0), CDMuellerMatrix(0.0));
  const auto nothing = BRDFGeometry::fromAngles(0.3, std::nan(""), 0);
  EXPECT_TRUE(std::isnan(model.getBRDF(nothing).at(0).getScalar()));
}

/// getDHR() against the plain product rule over directions.
inline void expectDHRIsTheIntegral(const CDBRDFModel& model, double tolerance) {
  for (const double zenith : {0.0, 0.3, 0.9, 1.3}) {
    const auto fine = model.getDHR(zenith), plain = model.CDBRDFModel::getDHR(zenith);
    for (std::size_t band = 0; band < fine.size(); ++band)
      ASSERT_NEAR(fine[band], plain[band], tolerance) << zenith << ' ' << band;
  }
}

/// The most that is reflected of light from any of these zenith angles.
inline double largestDHR(const CDBRDFModel& model) {
  double most = 0;
  for (const double degrees : {0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9}) {
    const auto dhr = model.getDHR(degrees * std::numbers::pi / 180);
    for (std::size_t band = 0; band < dhr.size(); ++band) most = std::max(most, dhr[band]);
  }
  return most;
}

/// The sampler's chi-squared test at several zenith angles.
inline void expectSamplesFollowDensity(const CDBRDFModel& model) {
  for (const double zenith : {0.0, 0.6, 1.2, 1.45}) {
    const Drawn d = draw(model, model, zenith);
    EXPECT_GT(d.p_value, false_alarm) << zenith;
    // five standard errors of a fraction of 200,000, and 2e-3 for the midpoint rule
    EXPECT_NEAR(d.rejected + d.density_integral, 1, 5 * std::sqrt(0.25 / 200000) + 2e-3)
        << zenith;
  }
}

/// Density and matrix belong together: a sum over the sampler's directions is the DHR of a reciprocal
/// model. Returns the largest ratio of the standard error to the DHR.
inline double expectSamplerGivesDHR(const CDBRDFModel& model) {
  double noise = 0;
  for (const double zenith : {0.2, 1.0}) {
    const CDVector given = CDVector::fromAngles(zenith, 0.0);
    Random random(5);
    double sum = 0, squares = 0;
    constexpr int draws = 100000;
    CDSpectralVector<CDMuellerMatrix> f(model.grid());
    for (int i = 0; i < draws; ++i) {
      const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
      const BRDFSample s = model.sample(given, u1, u2, u3);
      if (s.rejected()) continue;
      EXPECT_NEAR(s.density_per_sr / model.density(given, s.direction), 1, 1e-9);
      model.evaluate(BRDFGeometry::fromDirections(given, s.direction), f);
      const double x = CDMuellerMatrix(f[0]).getScalar() * s.direction.z / s.density_per_sr;
      sum += x, squares += x * x;
    }
    const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
    const double dhr = model.getDHR(zenith)[0];
    EXPECT_NEAR(mean, dhr, 5 * error + 1e-6) << zenith;  // five standard errors; quadrature
    noise = std::max(noise, error / dhr);
  }
  return noise;
}
}  // namespace malus::testing
