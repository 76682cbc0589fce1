// Lobes to draw from (nw/surface/RingLobe.nw).
#include "malus/surface/RingLobe.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;

/// A lobe uniform in solid angle within a cone.
RingLobe uniformCone(double reach) {
  return RingLobe([=](double x) { return (1 - std::cos(x)) / (1 - std::cos(reach)); }, reach);
}
}  // namespace

// All rings of a uniform lobe have the density 1/(2 pi (1 - cos reach)).
TEST(RingLobeIdentity, AUniformLobeIsUniform) {
  for (const double reach : {0.01, 1.0, pi}) {
    const RingLobe lobe = uniformCone(reach);
    const double expected = 1 / (4 * pi * std::pow(std::sin(reach / 2), 2));
    const CDVector axis = CDVector::fromAngles(0.7, 2.0);
    for (const double u1 : {0.0, 0.3, 0.999}) {
      const CDVector v = lobe.sample(axis, u1, 0.37);
      EXPECT_NEAR(v.getLength(), 1, 1e-14);
      EXPECT_LE(std::acos(std::min(dot(v, axis), 1.0)), reach * (1 + 1e-6));
      // the edges are found to the rounding of 1 - cos, 1e-16 of reach^2/2, in 64 rings
      EXPECT_NEAR(lobe.density(axis, v) / expected, 1, reach < 0.1 ? 1e-9 : 1e-12);
    }
    if (reach < pi) {
      EXPECT_EQ(lobe.density(axis, -axis), 0);
    }
    EXPECT_GT(std::abs(uniformCone(0.9 * reach).density(axis, axis) / expected - 1),
              0.02);  // control
  }
}

TEST(RingLobeInvariant, ADensityIntegratesToOne) {
  const RingLobe lobe([](double x) { return std::pow(std::sin(x / 2), 4); }, pi);
  const CDVector axis{0, 0, 1};
  double sum = 0;
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const double z = -1 + 2 * (i + 0.5) / steps;
    sum += lobe.density(axis, {std::sqrt(1 - z * z), 0, z}) * 2 * pi * 2 / steps;
  }
  EXPECT_NEAR(sum, 1, 1e-3);  // 63 jumps, each off by up to half a step
}

TEST(RingLobeIdentity, TheChoiceReusesItsRandomNumber) {
  const auto other = [](double, double, double v3) {
    EXPECT_GE(v3, 0);
    EXPECT_LT(v3, 1);
    return CDVector{v3, 0, 0};
  };
  EXPECT_GT(drawMixed(0.25, 0.5, 0.5, 0.2, other).z, 0);  // cosine lobe
  EXPECT_NEAR(drawMixed(0.25, 0.5, 0.5, 0.25, other).x, 0, 1e-15);
  EXPECT_NEAR(drawMixed(0.25, 0.5, 0.5, 0.625, other).x, 0.5, 1e-15);
  drawMixed(0.3, 0.5, 0.5, std::nextafter(1.0, 0.0), other);
  EXPECT_THROW(requireAboveSurface({0, 1, 0}), MathError);
  EXPECT_THROW(requireAboveSurface({0, 1, std::nan("")}), MathError);
}
