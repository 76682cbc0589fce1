// Light in layers by successive orders: against two other methods, printed values, balances and brute force
// (nw/air/LayeredLight.nw).
#include "malus/air/LayeredLight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ScatteredOnce.hpp"
#include "malus/air/RayleighLight.hpp"
#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/base/Table.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using malus::testing::apart;

namespace {
constexpr double pi = std::numbers::pi;
Scatterer spheroids() {
  return Scatterer::read(Table::read("scenes/data/aerosol-spheroids.csv"));
}
Scatterer droplets() {
  return Scatterer::read(Table::read("validation/printed/iprt-droplets.csv"));
}
AirGround copper() {
  return {0, std::make_shared<BRDFTorranceSparrow>(
                 0.405, 2.95, 0.3,
                 TorranceSparrowOptions{Shadowing::vGroove, DiffuseTerm::reciprocal})};
}
const std::vector<double> flat_and_steep{0.02, 0.05, 0.2, 0.7, 1.0};
constexpr std::array names{"0", "0.125", "0.25", "0.5", "0.75", "0.875", "1"};
}  // namespace

// 1e-8 of an irradiance of pi, over the grid of depths, suns and grounds that adding and doubling is held to.
TEST(LayeredLightInvariant, AgreesWithTheCoherencyTensor) {
  const auto largest = [](double depth, double sun, double albedo,
                          const LayeredLightAccuracy& accuracy) {
    const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, albedo, pi);
    const std::vector<double> inside{0, 0.02 * depth, 0.5 * depth, depth};
    const LayeredLight light({{{rayleighScatterer(0.03), depth}}}, sun, {albedo}, pi,
                             flat_and_steep, inside, accuracy);
    double most = std::abs(light.diffuseDown(3) - exact.diffuseDown());
    for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
      for (const double phi : {0.0, 1.0, 2.5})
        for (std::size_t k = 0; k < inside.size(); ++k) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          const double mu = flat_and_steep[v];
          most =
              std::max({most, apart(light.down(v, phi, k), exact.down(mu, azimuth, inside[k])),
                        apart(light.up(v, phi, k), exact.up(mu, azimuth, inside[k]))});
        }
    return most;
  };
  for (const double depth : {0.001, 0.01, 0.2, 1.0, 10.0})
    for (const double sun : {0.02, 0.2, 1.0})
      for (const double albedo : {0.0, 1.0})
        EXPECT_LT(largest(depth, sun, albedo, {}), 1e-8)
            << "tau " << depth << " mu0 " << sun << " albedo " << albedo;
  EXPECT_GT(largest(0.2, 0.2, 0, {.streams = 8}), 1e-8);  // control
  EXPECT_GT(largest(0.2, 0.2, 0, {.remainder = 1e-3}), 1e-8);
}

// Haze under air, with absorption, over matt ground: adding and doubling shares streams and rotations, and nothing else. At
// cosines from 0.2 on both promise 1e-8.
TEST(LayeredLightInvariant, AgreesWithAddingAndDoubling) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.1}},
                                     {{spheroids(), 0.5, 0.9}, {rayleighScatterer(0.03), 0.2}},
                                     {{rayleighScatterer(0.03), 0.05, 0}}};
  const std::vector<double> views{0.2, 0.5, 0.95}, depths{0, 0.3, 0.85};
  const LayeredLight light(layers, 0.6, {0.3}, pi, views, depths);
  const AddingDoubling doubled(layers, 0.6, 0.3, pi, views, {}, depths);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double phi : {0.0, 1.0, 4.0})
      for (std::size_t k = 0; k < depths.size(); ++k) {
        EXPECT_LT(apart(light.down(v, phi, k), doubled.down(v, phi, k)), 1e-8) << v << phi << k;
        EXPECT_LT(apart(light.up(v, phi, k), doubled.up(v, phi, k)), 1e-8) << v << phi << k;
      }
  EXPECT_GT(light.up(1, 1, 0).getStokes(3) * light.up(1, 1, 0).getStokes(3), 1e-14);
  const std::vector<AirLayer> swapped{layers[1], layers[0], layers[2]};  // control
  const LayeredLight other(swapped, 0.6, {0.3}, pi, views, {0});
  EXPECT_GT(apart(other.up(0, 1, 0), light.up(0, 1, 0)), 1e-4);
}

// Siewert's layer of spheroids, all four components at seven depths: half a unit of the sixth digit of the largest values.
TEST(LayeredLightPrinted, SiewertsSpheroids) {
  const Table printed = Table::read("validation/printed/siewert2000.csv");
  const std::vector<double> mu{0.1, 0.2, 0.3, 0.4, 0.5,
                               0.6, 0.7, 0.8, 0.9, std::cos(1e-4 * degree)};
  const std::vector<double> depths{0, 0.125, 0.25, 0.5, 0.75, 0.875, 1};
  const LayeredLight light({{{spheroids(), 1.0, 0.973527}}}, 0.6, {}, pi, mu, depths);
  double worst = 0;
  for (std::size_t row = 0; row < printed.rows(); ++row) {
    const double signed_mu = printed.number(row, "mu"),
                 phi = -printed.number(row, "phi_deg") * degree;
    const auto view = static_cast<std::size_t>(std::lround(std::abs(signed_mu) * 10)) - 1;
    const auto component =
        static_cast<int>(std::string("IQUV").find(printed.cell(row, "component")));
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const CDStokesVector ours =
          convertSky(signed_mu < 0 ? light.up(view, phi, k) : light.down(view, phi, k),
                     SkyConvention::malus, SkyConvention::iprt);
      worst = std::max(worst, std::abs(ours.getStokes(component) -
                                       printed.number(row, "tau_" + std::string(names[k]))));
    }
  }
  EXPECT_LT(worst, 5.5e-6);
  EXPECT_GT(worst, 1e-9);  // digits were compared
}

// What the sun brings comes back from a white ground, at every height, through a cloud that absorbs nothing and air: 1e-7.
TEST(LayeredLightInvariant, EnergyIsConserved) {
  const std::vector<AirLayer> layers{
      {{rayleighScatterer(0.03), 0.2}}, {{droplets(), 8}}, {{spheroids(), 0.4}}};
  const std::vector<double> depths{0, 0.1, 0.2, 3, 8.2, 8.6};
  for (const double sun : {0.2, 0.9}) {
    const LayeredLight light(layers, sun, {1}, pi, {0.5}, depths);
    for (std::size_t k = 0; k < depths.size(); ++k)
      EXPECT_NEAR(
          (light.directFlux(k) + light.diffuseDown(k) - light.diffuseUp(k)) / (pi * sun), 0,
          1e-7)
          << sun << ' ' << depths[k];
    EXPECT_NEAR(light.diffuseUp(0), pi * sun, 1e-7);
    const LayeredLight darker(layers, sun, {0.999}, pi, {0.5}, {0}, {});  // control
    EXPECT_GT(pi * sun - darker.diffuseUp(0), 1e-5);
  }
}

// Sun and viewer may be exchanged: L / mu0 is a symmetric function, in S0, over a surface that is reciprocal too.
TEST(LayeredLightInvariant, SunAndViewerMayBeExchanged) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.2}},
                                     {{spheroids(), 0.4, 0.95}}};
  for (const auto& [a, b] : {std::pair{0.9, 0.3}, {0.5, 0.15}})
    for (const double phi : {0.3, 1.5, 3.0}) {
      const LayeredLight one(layers, a, copper(), 1, {b}, {0}),
          other(layers, b, copper(), 1, {a}, {0});
      const double forth = one.up(0, phi, 0).getScalar() / a,
                   back = other.up(0, phi, 0).getScalar() / b;
      EXPECT_NEAR(forth / back, 1, 2e-6) << a << b << phi;
      EXPECT_GT(std::abs(forth / other.up(0, phi + 1, 0).getScalar() * b - 1), 1e-4);
    }
}

// A sun at the horizon lights the top alone: the balance over white ground against what comes in, and the exact solution to
// what that keeps of reciprocity there (ch. AddingDoubling, whose test this is).
TEST(LayeredLightInvariant, AGrazingSunKeepsTheBalance) {
  for (const double sun : {1e-3, 1e-5, 1e-9})
    for (const double depth : {0.05, 0.5}) {
      const LayeredLight light({{{rayleighScatterer(0.03), depth}}}, sun, {1}, pi,
                               flat_and_steep, {0, depth});
      const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, 1, pi);
      EXPECT_NEAR(light.diffuseUp(0) / (pi * sun), 1, 1e-8) << sun << ' ' << depth;
      EXPECT_GT(std::abs(light.diffuseUp(0) / (pi * sun * 1.001) - 1), 1e-8);  // control
      for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
        for (const double phi : {0.0, 1.0, 3.0}) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          EXPECT_LT(apart(light.up(v, phi, 0), exact.up(flat_and_steep[v], azimuth)),
                    1e-5 * pi * sun)
              << sun << ' ' << v;
        }
    }
}

// A layer in two is the same layer; absorption darkens; a mirror image has the other S2 and S3.
TEST(LayeredLightInvariant, CutsAndMirrors) {
  const Scatterer haze = spheroids();
  const std::vector<double> views{0.3, 0.8};
  const LayeredLight whole({{{haze, 0.6}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6}),
      cut({{{haze, 0.25}}, {{haze, 0.35}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6}),
      dark({{{haze, 0.6, 0.9}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6});
  for (std::size_t v = 0; v < 2; ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(apart(whole.up(v, 1, k), cut.up(v, 1, k)), 1e-9);
      EXPECT_LT(apart(whole.down(v, 1, k), cut.down(v, 1, k)), 1e-9);
      EXPECT_GT(whole.up(v, 1, k).getScalar(), dark.up(v, 1, k).getScalar());
      const CDStokesVector left = whole.up(v, 1, k), right = whole.up(v, -1, k);
      EXPECT_LT(apart(left, {right.getStokes(0), right.getStokes(1), -right.getStokes(2),
                             -right.getStokes(3)}),
                1e-14);
      EXPECT_GT(std::abs(left.getStokes(2)), 1e-5);
    }
}

// Thin air scatters once: a1 tau / 4 mu of the irradiance, and the ground its glint. Deep air keeps the balance.
TEST(LayeredLightInvariant, ThinAndDeep) {
  const Scatterer air = rayleighScatterer(0);
  const double tau = 1e-8, mu = 0.4, sun = 0.7, phi = 1.1;
  const LayeredLight thin({{{air, tau}}}, sun, {}, 1, {mu}, {0, tau});
  const double cosine = -sun * mu + std::sqrt((1 - sun * sun) * (1 - mu * mu)) * std::cos(phi);
  EXPECT_NEAR(thin.up(0, phi, 0).getScalar() / (air.matrix(cosine).a1 * tau / (4 * pi * mu)), 1,
              1e-6);
  const LayeredLight glint({{{air, tau}}}, sun, copper(), 1, {mu}, {0});
  const auto f = groundMatrix(copper(), sun, mu, -phi);
  EXPECT_LT(apart(glint.up(0, phi, 0), sun * CDStokesVector(f[0], f[4], f[8], f[12])), 1e-7);
  const LayeredLight deep({{{air, 300}}}, sun, {1}, 1, {mu}, {0, 150, 300});
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(deep.directFlux(k) + deep.diffuseDown(k) - deep.diffuseUp(k), 0, 1e-7);
}

// The cloud of IPRT A5: 64 terms are as good as 128, beside the sun and elsewhere, to a thousandth; 24 terms are not.
TEST(LayeredLightInvariant, WhatIsCutOffIsPutBack) {
  const std::vector<AirLayer> cloud{{{droplets(), 5, 0.999979}}};
  const double sun = std::cos(50 * degree);
  const std::vector<double> views{sun, 0.9};
  const LayeredLight usual(cloud, sun, {}, 1, views, {5}, {.thinnest = 1e-3}),
      more(cloud, sun, {}, 1, views, {5}, {.streams = 128, .terms = 128, .thinnest = 1e-3}),
      few(cloud, sun, {}, 1, views, {5}, {.terms = 24, .thinnest = 1e-3});
  double worst = 0;
  for (std::size_t v = 0; v < 2; ++v)
    for (const double phi_deg : {0.0, 1.0, 3.0, 6.0, 15.0, 40.0, 90.0, 180.0}) {
      const double exact = more.down(v, phi_deg * degree, 0).getScalar();
      EXPECT_NEAR(usual.down(v, phi_deg * degree, 0).getScalar() / exact, 1, 1e-3)
          << v << ' ' << phi_deg;
      worst =
          std::max(worst, std::abs(few.down(v, phi_deg * degree, 0).getScalar() / exact - 1));
    }
  EXPECT_GT(worst, 1e-3);  // control
}

TEST(LayeredLightRefusal, WhatCannotBe) {
  const AirLayer air{{rayleighScatterer(0), 0.1}};
  const auto make = [&](std::vector<AirLayer> layers, double sun, double albedo, double view,
                        double depth) {
    return LayeredLight(std::move(layers), sun, {albedo}, 1, {view}, {depth});
  };
  EXPECT_NO_THROW(make({air}, 0.5, 0, 0.5, 0.1));
  EXPECT_THROW(make({}, 0.5, 0, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0, 0, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 1.1, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 0, 1.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 0, 0.5, 0.2), Refusal);
  EXPECT_THROW(make({{{rayleighScatterer(0), 301}}}, 0.5, 0, 0.5, 0), Refusal);
  EXPECT_THROW(LayeredLight({air}, 0.5, {}, 1, {0.5}, {0}, {.streams = 3}), Refusal);
}
