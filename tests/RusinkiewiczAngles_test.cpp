// Half-way and difference angles (nw/surface/RusinkiewiczAngles.nw) against vectors that are turned in space.
#include "malus/surface/RusinkiewiczAngles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "malus/base/Angles.hpp"
#include "malus/base/CDVector.hpp"
#include "malus/light/CDSpectralVector.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;

struct Drawn3 {
  double theta_i, theta_r, phi;
};
std::vector<Drawn3> drawn(int count, double most) {
  std::mt19937 generator(1998);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Drawn3> all;
  for (int i = 0; i < count; ++i) {
    const double a = most * uniform(generator), b = most * uniform(generator);
    all.push_back({a, b, 2 * pi * uniform(generator)});
  }
  return all;
}

// Rodrigues' rotation
CDVector turned(const CDVector& v, const CDVector& axis, double angle) {
  return v * std::cos(angle) + cross(axis, v) * std::sin(angle) +
         axis * (dot(axis, v) * (1 - std::cos(angle)));
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

CDMuellerMatrix facets(const BRDFGeometry& g) {
  const auto grid = SpectralGrid::make({550.0});
  const BRDFTorranceSparrow model({grid, 0.405}, {grid, 2.95}, {grid, 0.4},
                                  {Shadowing::none, DiffuseTerm::none});
  return model.getBRDF(g)[0];
}

double largestOutsideBlocks(const CDMuellerMatrix& f) {
  double most = 0;
  for (int i = 0; i < 2; ++i)
    for (int j = 2; j < 4; ++j)
      most = std::max({most, std::abs(f.getMueller(i, j)), std::abs(f.getMueller(j, i))});
  return most / f.getScalar();
}

double largestDifference(const CDMuellerMatrix& a, const CDMuellerMatrix& b) {
  double most = 0;
  for (int k = 0; k < 16; ++k) most = std::max(most, std::abs(a.data()[k] - b.data()[k]));
  return most / std::abs(a.getScalar());
}
}  // namespace

// The definition: the source turned by -phi_h about z, then by -theta_h about the binormal.
TEST(RusinkiewiczAnglesPublished, TheDefinition) {
  for (const Drawn3& a : drawn(1000, 1.57)) {
    const double phi_i = 1.234;
    const CDVector i = CDVector::fromAngles(a.theta_i, phi_i),
                   r = CDVector::fromAngles(a.theta_r, phi_i + a.phi), h = normalized(i + r);
    const double theta_h = h.getZenith();
    const CDVector d = turned(turned(i, {0, 0, 1}, -h.getAzimuth()), {0, 1, 0}, -theta_h);
    const RusinkiewiczAngles ours =
        halfDifference(BRDFGeometry::fromAngles(a.theta_i, a.theta_r, a.phi));
    // the turned vectors have errors of 1e-16, which an azimuth sees divided by the sines
    const double rounding = 1e-14 / (ours.sin_d * ours.sin_h);
    EXPECT_NEAR(ours.getThetaH(), theta_h, 1e-13);
    EXPECT_NEAR(ours.getThetaD(), d.getZenith(), 1e-13);
    EXPECT_LT(apart(ours.getPhiD(), d.getAzimuth()), rounding);
    EXPECT_GT(apart(ours.getPhiD(), d.getAzimuth() + 1e-3), rounding);  // negative control
  }
}

TEST(RusinkiewiczAnglesIdentity, ThePlateOfSection71) {
  const auto a = halfDifference(BRDFGeometry::fromDegrees(30, 40, 180));
  EXPECT_NEAR(a.getThetaH(), 5 * degree, 1e-15);
  EXPECT_NEAR(a.getThetaD(), 35 * degree, 1e-15);
  EXPECT_NEAR(a.getPhiD(), pi, 1e-15);
  const auto mirror = halfDifference(BRDFGeometry::fromDegrees(50, 50, 180));
  EXPECT_NEAR(mirror.getThetaH(), 0, 1e-15);
  EXPECT_NEAR(mirror.getThetaD(), 50 * degree, 1e-15);
  EXPECT_EQ(mirror.getPhiD(), 0);
}

TEST(RusinkiewiczAnglesIdentity, ThereAndBack) {
  for (const Drawn3& a : drawn(1000, 1.5707)) {
    const auto g = BRDFGeometry::fromAngles(a.theta_i, a.theta_r, a.phi);
    const auto back = brdfGeometry(halfDifference(g));
    EXPECT_NEAR(back.cos_i, g.cos_i, 1e-14);
    EXPECT_NEAR(back.cos_r, g.cos_r, 1e-14);
    // angles between directions near each other or near the zenith
    const double rounding = 1e-14 / (g.sin_i * g.sin_r);
    EXPECT_NEAR(back.cos_phi, g.cos_phi, rounding);
    EXPECT_NEAR(back.sin_phi, g.sin_phi, rounding);
  }
}

TEST(RusinkiewiczAnglesIdentity, ExchangeAddsHalfATurn) {
  for (const Drawn3& a : drawn(200, 1.5)) {
    const auto there = halfDifference(BRDFGeometry::fromAngles(a.theta_i, a.theta_r, a.phi));
    const auto back = halfDifference(BRDFGeometry::fromAngles(a.theta_r, a.theta_i, -a.phi));
    EXPECT_NEAR(there.cos_h, back.cos_h, 1e-15);
    EXPECT_NEAR(there.cos_d, back.cos_d, 1e-15);
    EXPECT_LT(apart(there.getPhiD() + pi, back.getPhiD()), 1e-12);
  }
}

TEST(RusinkiewiczAnglesIdentity, FacetsAreBlocksInTheirOwnAxes) {
  double macroscopic = 0;
  for (const Drawn3& a : drawn(200, 1.5)) {
    const auto g = BRDFGeometry::fromAngles(a.theta_i, a.theta_r, a.phi);
    const CDMuellerMatrix f = facets(g), m = intoFacetFrames(f, facetGeometry(g));
    EXPECT_LT(largestOutsideBlocks(m), 1e-13);
    EXPECT_LT(largestDifference(outOfFacetFrames(m, facetGeometry(g)), f), 1e-14);
    macroscopic = std::max(macroscopic, largestOutsideBlocks(f));
    // all bands at once: the same numbers in two bands
    std::array<double, 32> planes;
    for (int k = 0; k < 32; ++k) planes[k] = m.data()[k / 2];
    turnOutOfFacetFrames(facetGeometry(g), planes);
    for (int k = 0; k < 32; ++k) EXPECT_NEAR(planes[k], f.data()[k / 2], 1e-14 * f.getScalar());
  }
  EXPECT_GT(macroscopic, 0.1);  // negative control
}

// A neutral surface, f = 1, shows the axes themselves: at theta_d = 0 they go on turning with phi_d.
TEST(RusinkiewiczAnglesIdentity, AxesWhereSourceAndViewerMeet) {
  const CDMuellerMatrix neutral(1.0);
  for (double phi_d = 0; phi_d < 6.2; phi_d += 0.3) {
    const auto at = RusinkiewiczAngles::fromAngles(0.7, 0, phi_d),
               near = RusinkiewiczAngles::fromAngles(0.7, 1e-6, phi_d);
    const auto m = intoFacetFrames(neutral, facetGeometry(at));
    EXPECT_LT(largestDifference(m, intoFacetFrames(neutral, facetGeometry(near))), 1e-5);
    if (std::abs(std::sin(2 * phi_d)) > 0.1) {  // negative control: phi_d forgotten
      const auto forgotten = facetGeometry(brdfGeometry(at));
      EXPECT_GT(largestDifference(m, intoFacetFrames(neutral, forgotten)), 0.1);
    }
  }
}

// f(phi_d + pi) = Q f^T Q and f(-phi_d) = P f P in the facet's axes, for light that is neutrally scattered.
TEST(RusinkiewiczAnglesInvariant, SymmetriesOfATable) {
  const std::array<double, 4> Q{1, 1, -1, 1}, P{1, 1, -1, -1}, wrong{1, 1, 1, 1};
  const CDMuellerMatrix neutral(1.0);
  double control = 0;
  for (const double phi_d : {0.2, 1.0, 2.5})
    for (const double theta_d : {0.0, 0.3, 0.8}) {
      const auto matrix = [&](double phi) {
        return intoFacetFrames(
            neutral, facetGeometry(RusinkiewiczAngles::fromAngles(0.6, theta_d, phi)));
      };
      const auto m = matrix(phi_d), half_turn = matrix(phi_d + pi), mirrored = matrix(-phi_d);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          EXPECT_NEAR(half_turn.getMueller(i, j), Q[i] * Q[j] * m.getMueller(j, i), 1e-13);
          EXPECT_NEAR(mirrored.getMueller(i, j), P[i] * P[j] * m.getMueller(i, j), 1e-13);
          control = std::max(control, std::abs(mirrored.getMueller(i, j) -
                                               wrong[i] * wrong[j] * m.getMueller(i, j)));
        }
    }
  EXPECT_GT(control, 0.1);
}
