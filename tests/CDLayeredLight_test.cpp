// Adding and doubling against the exact Rayleigh solution and elementary limits (nw/world/CDLayeredLight.nw).
#include "world/CDLayeredLight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "light/CDError.hpp"
#include "world/CDRayleighLight.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi, degree = pi / 180;
double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a.getStokes(i) - b.getStokes(i)));
  return most;
}
const std::vector<double> views{0.3, 0.6, 0.95};
}  // namespace

// Two methods without a common equation. Sixteen streams integrate functions like exp(-tau/mu) over mu to
// about 1e-7 here.
TEST(CDLayeredLightInvariant, AgreesWithTheCoherencyTensor) {
  const double depth = 0.5, rho = 0.03, sun = 0.6, albedo = 0.25;
  const CDRayleighLight exact(CDRayleighAtmosphere(depth, rho), sun, albedo, pi);
  const CDScatterer air = rayleighScatterer(rho);
  const CDLayeredLight whole({{{air, depth}}}, sun, albedo, pi, views, {});
  const CDLayeredLight cut({{{air, 0.2}}, {{air, 0.1}, {air, 0.2}}}, sun, albedo, pi, views,
                           {});
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double phi : {0.0, 40.0, 90.0, 200.0}) {
      const auto azimuth = CDRayleighLight::Azimuth::fromRadians(phi * degree);
      EXPECT_LT(apart(whole.down(v, phi * degree), exact.down(views[v], azimuth)), 1e-7)
          << v << ' ' << phi;
      EXPECT_LT(apart(whole.up(v, phi * degree), exact.up(views[v], azimuth)), 1e-7)
          << v << ' ' << phi;
      EXPECT_LT(apart(cut.down(v, phi * degree), whole.down(v, phi * degree)), 1e-9);
      if (phi == 0) continue;
      EXPECT_GT(apart(whole.down(v, -phi * degree), exact.down(views[v], azimuth)),
                1e-4);  // control
    }
}

// Natraj, Li and Yung 2009: tau 0.5, albedo 0.25, mu0 0.6, mu 0.4, 90 deg.
TEST(CDLayeredLightPublished, APrintedValue) {
  const CDLayeredLight light({{{rayleighScatterer(0), 0.5}}}, 0.6, 0.25, pi, {0.4}, {});
  const CDStokesVector value = light.down(0, 90 * degree);
  EXPECT_NEAR(value.getStokes(0), 0.22239883, 1e-7);
  EXPECT_NEAR(value.getStokes(1), -0.05505941, 1e-7);
  EXPECT_NEAR(value.getStokes(2), 0.11112462, 1e-7);
}

// A thin aerosol, to first order in its depth: P(Theta) F0 / (4 pi) tau / mu.
TEST(CDLayeredLightIdentity, AThinAerosolScattersOnce) {
  const double depth = 1e-5, g = 0.5, sun = 0.5, mu = 0.6;
  const CDLayeredLight light({{{henyeyGreensteinScatterer(g), depth}}}, sun, 0, 1, {mu},
                             {8, 20});
  for (const double phi : {0.0, 60.0, 180.0}) {
    const double c =
        sun * mu + std::sqrt((1 - sun * sun) * (1 - mu * mu)) * std::cos(phi * degree);
    const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5);
    EXPECT_NEAR(light.down(0, phi * degree).getScalar() / (phase * depth / (4 * pi * mu)), 1,
                1e-3)
        << phi;
    EXPECT_EQ(light.down(0, phi * degree).getDOLP(), 0);
  }
}

// What an absorbing layer takes away is missing; what a conserving one takes away comes back up.
TEST(CDLayeredLightInvariant, AbsorptionDarkens) {
  const auto sky = [](double kept) {
    return CDLayeredLight({{{rayleighScatterer(0), 0.3, kept}}}, 0.6, 0.2, 1, {0.7}, {8, 2});
  };
  EXPECT_LT(sky(0.9).down(0, 1).getScalar(), sky(1).down(0, 1).getScalar());
  EXPECT_NEAR(sky(0).down(0, 1).getScalar(), 0, 1e-15);
  // with nothing scattered the ground is seen through the air twice
  EXPECT_NEAR(sky(0).up(0, 1).getScalar(),
              0.2 / pi * 0.6 * std::exp(-0.3 / 0.6) * std::exp(-0.3 / 0.7), 1e-9);
}

// Matter with b2 turns linear polarisation into circular: V appears at the second scattering.
TEST(CDLayeredLightInvariant, CircularPolarisationNeedsB2) {
  const CDScatterer plain = rayleighScatterer(0);
  const CDScatterer twisting = [plain](double c) {
    CDScatteringMatrix f = plain(c);
    f.b2 = 0.3 * (1 - c * c);
    return f;
  };
  const CDLayeredLight without({{{plain, 0.5}}}, 0.6, 0, 1, {0.5}, {8, 4});
  const CDLayeredLight with({{{twisting, 0.5}}}, 0.6, 0, 1, {0.5}, {8, 4});
  EXPECT_LT(std::abs(without.down(0, 1).getStokes(3)), 1e-12);
  EXPECT_GT(std::abs(with.down(0, 1).getStokes(3)), 1e-5);
  EXPECT_NEAR(with.down(0, 1).getStokes(3), -with.down(0, -1).getStokes(3),
              1e-12);  // mirror images
}

TEST(CDLayeredLightInvariant, RefusesTheImpossible) {
  const CDScatterer air = rayleighScatterer(0);
  EXPECT_THROW(CDLayeredLight({}, 0.5, 0, 1, {0.5}, {}), CDMathError);
  EXPECT_THROW(CDLayeredLight({{{air, -1}}}, 0.5, 0, 1, {0.5}, {}), CDMathError);
  EXPECT_THROW(CDLayeredLight({{{air, 0.1}}}, 0, 0, 1, {0.5}, {}), CDMathError);
  EXPECT_THROW(CDLayeredLight({{{air, 0.1}}}, 0.5, 0, 1, {0.0}, {}), CDMathError);
  EXPECT_THROW(CDLayeredLight({{{air, 0.1}}}, 0.5, 1.1, 1, {0.5}, {}), CDMathError);
  EXPECT_THROW(CDLayeredLight({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {10, 2}), CDMathError);
  EXPECT_THROW(henyeyGreensteinScatterer(1), CDMathError);
}
