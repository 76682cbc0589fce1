// Adding and doubling against the exact Rayleigh solution, printed aerosol, and brute force
// (nw/air/AddingDoubling.nw).
#include "malus/air/AddingDoubling.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "ScatteredOnce.hpp"
#include "malus/air/RayleighLight.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/CDVector.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Table.hpp"

using namespace malus;
using malus::testing::apart;
using malus::testing::scattered;

namespace {
constexpr double pi = std::numbers::pi;
const std::vector<double> views{0.3, 0.6, 0.95, 1.0};

// Travel direction: u upwards, azimuth clockwise from the sunbeam's.
CDVector travel(double u, double phi) {
  const double r = std::sqrt(1 - u * u);
  return {r * std::cos(phi), -r * std::sin(phi), u};
}

Scatterer spheroids() {
  return Scatterer::read(Table::read("scenes/data/aerosol-spheroids.csv"));
}
}  // namespace

// Two methods without a common equation. What 32 streams resolve from mu = 0.02 on is 1e-8 for an irradiance of pi;
// two cuts of one layer differ by rounding and by what the first layers leave.
TEST(AddingDoublingInvariant, AgreesWithTheCoherencyTensor) {
  const double depth = 0.5, rho = 0.03, sun = 0.6, albedo = 0.25;
  const RayleighLight exact(RayleighAtmosphere(depth, rho), sun, albedo, pi);
  const Scatterer air = rayleighScatterer(rho);
  const std::vector<double> depths{0.2, 0.1, 0.5};
  const AddingDoubling whole({{{air, depth}}}, sun, albedo, pi, views, {}, depths);
  const AddingDoubling cut({{{air, 0.2}}, {{air, 0.1}, {air, 0.2}}}, sun, albedo, pi, views);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double phi : {0.0, 40.0, 90.0, 200.0}) {
      const auto azimuth = RayleighLight::Azimuth::fromRadians(phi * degree);
      EXPECT_LT(apart(whole.down(v, phi * degree), exact.down(views[v], azimuth)), 1e-8)
          << v << ' ' << phi;
      EXPECT_LT(apart(whole.up(v, phi * degree), exact.up(views[v], azimuth)), 1e-8)
          << v << ' ' << phi;
      for (std::size_t k = 0; k < depths.size(); ++k) {
        EXPECT_LT(
            apart(whole.down(v, phi * degree, k), exact.down(views[v], azimuth, depths[k])),
            1e-8);
        EXPECT_LT(apart(whole.up(v, phi * degree, k), exact.up(views[v], azimuth, depths[k])),
                  1e-8);
      }
      EXPECT_LT(apart(cut.down(v, phi * degree), whole.down(v, phi * degree)), 1e-9);
      if (phi == 0 || views[v] == 1) continue;
      EXPECT_GT(apart(whole.down(v, -phi * degree), exact.down(views[v], azimuth)),
                1e-4);  // control
    }
  EXPECT_NEAR(whole.diffuseDown(), exact.diffuseDown(), 1e-8);
  EXPECT_NEAR(whole.diffuseUp(), exact.diffuseUp(), 1e-8);
  EXPECT_NEAR(whole.directFlux(), exact.directFlux(), 1e-13);
}

namespace {
// The grid was chosen before anything was measured on it: from air that hardly scatters to air that hardly lets a beam
// through, suns from the horizon's neighbourhood to the zenith, black and white ground, the flattest line of sight first.
const std::vector<double> flat_and_steep{0.02, 0.03, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0};
double largestDeviation(const std::vector<AirLayer>& layers, double depth, double sun,
                        double albedo, const std::vector<double>& inside,
                        AddingDoublingAccuracy accuracy = {}) {
  const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, albedo, pi);
  const AddingDoubling light(layers, sun, albedo, pi, flat_and_steep, accuracy, inside);
  double most = 0;
  for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
    for (const double phi : {0.0, 1.0, 2.5}) {
      const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
      const double mu = flat_and_steep[v];
      most = std::max({most, apart(light.down(v, phi), exact.down(mu, azimuth)),
                       apart(light.up(v, phi), exact.up(mu, azimuth))});
      for (std::size_t k = 0; k < inside.size(); ++k)
        most = std::max({most, apart(light.down(v, phi, k), exact.down(mu, azimuth, inside[k])),
                         apart(light.up(v, phi, k), exact.up(mu, azimuth, inside[k]))});
    }
  return most;
}
}  // namespace

// The chapter promises 1e-8.
TEST(AddingDoublingInvariant, FlatLinesOfSightAgreeOverTheGrid) {
  const auto air = [](double depth) {
    return std::vector<AirLayer>{{{rayleighScatterer(0.03), depth}}};
  };
  for (const double depth : {0.001, 0.003, 0.01, 0.05, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0})
    for (const double sun : {0.02, 0.2, 1.0})
      for (const double albedo : {0.0, 1.0})
        EXPECT_LT(largestDeviation(air(depth), depth, sun, albedo, {}), 1e-8)
            << "tau " << depth << " mu0 " << sun << " albedo " << albedo;
  for (const double depth : {0.003, 0.2, 5.0})  // and inside, near top and ground too
    EXPECT_LT(largestDeviation(air(depth), depth, 0.5, 0.3,
                               {0.02 * depth, 0.5 * depth, 0.95 * depth}),
              1e-8)
        << "tau " << depth;
  // control: sixteen streams do not resolve it
  EXPECT_GT(largestDeviation(air(0.01), 0.01, 0.5, 0, {}, {16, -1}), 1e-8);
}

// A grazing sun: the balance over white ground, against what comes in; and the exact solution, in the same unit, to 1e-5 at
// mu = 0.02, which is what that solution keeps of reciprocity there.
TEST(AddingDoublingInvariant, AGrazingSunKeepsTheBalance) {
  const Scatterer air = rayleighScatterer(0.03);
  for (const double sun : {1e-3, 1e-5, 1e-9})
    for (const double depth : {0.05, 0.5}) {
      const AddingDoubling light({{{air, depth}}}, sun, 1, pi, flat_and_steep);
      const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, 1, pi);
      EXPECT_NEAR(light.diffuseUp() / (pi * sun), 1, 1e-8) << sun << ' ' << depth;
      EXPECT_GT(std::abs(light.diffuseUp() / (pi * sun * 1.001) - 1), 1e-8);  // control
      for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
        for (const double phi : {0.0, 1.0, 3.0}) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          EXPECT_GT(light.up(v, phi).getScalar(), 0);
          EXPECT_LT(apart(light.up(v, phi), exact.up(flat_and_steep[v], azimuth)),
                    1e-5 * pi * sun);
        }
    }
}

// A trace of aerosol changes almost nothing: single scattering in a depth t adds a_1 t / (4 mu)
// to the radiance, for 1e-10
// and mu = 0.02 some 1e-9 (1e-9 of aerosol would itself add more than is allowed). Only the harmonics that air has.
TEST(AddingDoublingInvariant, ATraceOfAerosolAnywhereChangesNothing) {
  const Scatterer air = rayleighScatterer(0.03);
  const double trace = 1e-10, depth = 0.2;
  const Particles dust{spheroids(), trace, 0.97};
  for (const std::vector<AirLayer>& layers : std::vector<std::vector<AirLayer>>{
           {{{air, depth}, dust}}, {{dust}, {{air, depth}}}, {{{air, depth}}, {dust}}})
    EXPECT_LT(largestDeviation(layers, depth, 0.5, 0.3, {}, {0, 2}), 1e-8);
  // control: a millionth is seen
  EXPECT_GT(largestDeviation({{{air, depth}, {spheroids(), 1e-6, 0.97}}}, depth, 0.5, 0.3, {},
                             {0, 2}),
            1e-8);
}

// Half a unit of the printed digit, and the chapter's 1e-8. Natraj, Li and Yung 2009: tau 0.5, albedo 0.25, mu0 0.6, mu 0.4, 90 deg.
TEST(AddingDoublingPublished, APrintedValue) {
  const AddingDoubling light({{{rayleighScatterer(0), 0.5}}}, 0.6, 0.25, pi, {0.4});
  const CDStokesVector value = light.down(0, 90 * degree);
  EXPECT_NEAR(value.getStokes(0), 0.22239883, 1.5e-8);
  EXPECT_NEAR(value.getStokes(1), -0.05505941, 1.5e-8);
  EXPECT_NEAR(value.getStokes(2), 0.11112462, 1.5e-8);
}

// Siewert 2000, problem IIA: spheroids, tau 1, single-scattering albedo 0.973527, mu0 0.6, black ground;
// tables 2 to 9, printed to six digits. Irradiance pi. Half a unit of the sixth digit is at most 5e-6 here.
TEST(AddingDoublingPublished, SpheroidsInFourStokesComponentsAndInside) {
  const Table printed = Table::read("validation/printed/siewert2000.csv");
  const std::vector<double> mu{0.1, 0.2, 0.3, 0.4, 0.5,
                               0.6, 0.7, 0.8, 0.9, std::cos(1e-4 * degree)};
  const std::vector<double> depths{0.0, 0.125, 0.25, 0.5, 0.75, 0.875, 1.0};
  const char* const names[]{"tau_0",    "tau_0.125", "tau_0.25", "tau_0.5",
                            "tau_0.75", "tau_0.875", "tau_1"};
  const AddingDoubling light({{{spheroids(), 1.0, 0.973527}}}, 0.6, 0, pi, mu, {32, -1},
                             depths);
  // his Q is ll - rr, and his azimuth goes the other way round: a mirror changes the signs of U and V
  const double signs[]{1, -1, -1, -1};
  int compared = 0, seen = 0;
  double worst[4]{};
  for (std::size_t row = 0; row < printed.rows(); ++row) {
    const double signed_mu = printed.number(row, "mu"), phi = printed.number(row, "phi_deg");
    const auto component =
        static_cast<int>(std::string("IQUV").find(printed.cell(row, "component")));
    const auto view = static_cast<std::size_t>(std::lround(std::abs(signed_mu) * 10)) - 1;
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const CDStokesVector value =
          signed_mu < 0 ? light.up(view, phi * degree, k) : light.down(view, phi * degree, k);
      const double theirs = printed.number(row, names[k]);
      const double off = value.getStokes(component) * signs[component] - theirs;
      const double half =
          theirs == 0 ? 1e-9
                      : 0.51 * std::pow(10, std::floor(std::log10(std::abs(theirs))) - 5);
      worst[component] = std::max(worst[component], std::abs(off));
      // the printed digits, and what the streams leave of ours and of theirs
      EXPECT_LT(std::abs(off), half + 3e-8)
          << printed.cell(row, "component") << " mu " << signed_mu << " phi " << phi << " tau "
          << depths[k] << " printed " << theirs;
      ++compared, seen += component == 3 && std::abs(theirs) > 1e-6;
    }
  }
  EXPECT_EQ(compared, 8 * 20 * 7);
  EXPECT_GT(seen, 100);
  RecordProperty("worst_V", std::to_string(worst[3]));
  // control: without b2 there is no V
  auto terms = spheroids().terms();
  for (auto& term : terms) term.beta2 = 0;
  const AddingDoubling without({{{Scatterer(terms), 1.0, 0.973527}}}, 0.6, 0, pi, mu, {20, -1});
  EXPECT_EQ(without.up(0, 1).getStokes(3), 0);
  EXPECT_NE(light.up(0, 1).getStokes(3), 0);
  // and the other sign of b1 is the other polarisation
  for (auto& term : terms) term.beta1 = -term.beta1;
  const AddingDoubling other({{{Scatterer(terms), 1.0, 0.973527}}}, 0.6, 0, pi, mu, {20, -1});
  EXPECT_GT(std::abs(other.up(0, 0).getStokes(1) - light.up(0, 0).getStokes(1)), 1e-3);
}

// A thin layer to first order: the scattering matrix between beam and view, rotated by vectors. Of the light scattered
// once, half of 1 + ln(1 / depth) times the depth is scattered again on its way out, mostly where it is flat; six times that
// leaves room for the phase function, and a wrong sign of the azimuth must be beyond it.
TEST(AddingDoublingIdentity, AThinLayerScattersOnce) {
  const double depth = 1e-6, sun = 0.5, again = 3 * depth * (1 - std::log(depth));
  const AddingDoubling light({{{spheroids(), depth}}}, sun, 0, 1, views);
  for (std::size_t v = 0; v + 1 < views.size(); ++v)
    for (const double phi : {0.3, 1.5, 2.8, 4.0})
      for (const int way : {-1, 1}) {
        const CDStokesVector once = scattered(spheroids(), CDStokesVector(1, 0, 0, 0),
                                              travel(-sun, 0), travel(way * views[v], phi)) *
                                    (depth / (4 * pi * views[v]));
        const CDStokesVector ours = way < 0 ? light.down(v, phi) : light.up(v, phi);
        EXPECT_LT(apart(ours, once), again * once.getScalar());
        const CDStokesVector mirrored = way < 0 ? light.down(v, -phi) : light.up(v, -phi);
        EXPECT_GT(apart(mirrored, once), 2 * again * once.getScalar());  // control
      }
}

// Circular polarisation needs two scatterings. Particles that absorb nearly all leave these alone; the
// reference is an integral over the direction and the depth in between, by midpoints (1e-3), and the third
// order is smaller by the albedo.
TEST(AddingDoublingInvariant, TwoScatteringsMakeCircularPolarisation) {
  const double depth = 0.5, kept = 1e-4, sun = 0.6, view = 0.5, phi = 1.0;
  const Scatterer matter = spheroids();
  const AddingDoubling light({{{matter, depth, kept}}}, sun, 0, 1, {view});
  const int zones = 120, sectors = 96, slices = 40;
  CDStokesVector sum(0, 0, 0, 0);
  for (int i = 0; i < zones; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double u = 2 * (i + 0.5) / zones - 1;
      const CDVector between = travel(u, 2 * pi * (j + 0.5) / sectors);
      double path = 0;  // beam to t1, along u to t2, up to the top
      for (int k = 0; k < slices; ++k) {
        const double t2 = depth * (k + 0.5) / slices;
        // the integral over t1 of exp(-t1/sun - |t2-t1|/|u|) / |u|, on the side the light comes from
        const double a = 1 / sun, b = 1 / std::abs(u);
        const double inner =
            u < 0 ? (std::exp(-a * t2) - std::exp(-b * t2)) * b / (b - a)
                  : (std::exp(-a * t2) - std::exp(-a * depth - b * (depth - t2))) * b / (a + b);
        path += inner * std::exp(-t2 / view) / view * depth / slices;
      }
      const CDStokesVector once =
          scattered(matter, CDStokesVector(1, 0, 0, 0), travel(-sun, 0), between);
      sum += scattered(matter, once, between, travel(view, phi)) *
             (path * 4 * pi / (zones * sectors) / (16 * pi * pi));
    }
  const double ours = light.up(0, phi).getStokes(3) / (kept * kept), theirs = sum.getStokes(3);
  EXPECT_GT(std::abs(theirs), 1e-6);
  EXPECT_NEAR(ours / theirs, 1, 5e-3);  // control: a wrong sign gives -1
  EXPECT_NEAR(light.up(0, -phi).getStokes(3), -light.up(0, phi).getStokes(3), 1e-15);
}

// What an absorbing layer takes away is missing; what a conserving one takes away comes back up.
TEST(AddingDoublingInvariant, AbsorptionDarkens) {
  const auto sky = [](double kept) {
    return AddingDoubling({{{rayleighScatterer(0), 0.3, kept}}}, 0.6, 0.2, 1, {0.7}, {8, 2});
  };
  EXPECT_LT(sky(0.9).down(0, 1).getScalar(), sky(1).down(0, 1).getScalar());
  EXPECT_NEAR(sky(0).down(0, 1).getScalar(), 0, 1e-15);
  // with nothing scattered the ground is seen through the air twice
  EXPECT_NEAR(sky(0).up(0, 1).getScalar(),
              0.2 / pi * 0.6 * std::exp(-0.3 / 0.6) * std::exp(-0.3 / 0.7), 1e-9);
}

// Air above a forward-scattering haze, over grey ground: 1e-8 is what the thin layer's step leaves.
TEST(AddingDoublingInvariant, EnergyIsBalanced) {
  for (const double albedo : {0.0, 0.3, 1.0}) {
    const AddingDoubling light(
        {{{rayleighScatterer(0.03), 0.2}},
         {{rayleighScatterer(0.03), 0.05}, {henyeyGreensteinScatterer(0.4), 0.3}}},
        0.4, albedo, 1, {0.5}, {24, 0});
    const double absorbed = (1 - albedo) * (light.directFlux() + light.diffuseDown());
    EXPECT_NEAR(light.diffuseUp() + absorbed, 0.4, 1e-8) << albedo;
    EXPECT_GT(std::abs(light.diffuseUp() * 1.0001 + absorbed - 0.4), 1e-6);  // control
  }
}

// Helmholtz: sun and viewer exchanged. The reflected radiance is the sun's cosine times a symmetric function.
TEST(AddingDoublingInvariant, SunAndViewerMayBeExchanged) {
  const std::vector<AirLayer> air{{{rayleighScatterer(0.03), 0.2}}, {{spheroids(), 0.4, 0.9}}};
  const AddingDoubling there(air, 0.8, 0.3, 1, {0.35}), back(air, 0.35, 0.3, 1, {0.8});
  for (const double phi : {0.2, 1.3, 2.9}) {
    EXPECT_NEAR(there.up(0, phi).getScalar() / 0.8, back.up(0, phi).getScalar() / 0.35, 1e-7)
        << phi;
    EXPECT_GT(
        std::abs(there.up(0, phi).getScalar() / 0.8 - back.up(0, phi + 0.1).getScalar() / 0.35),
        1e-4);  // control
  }
}

// A layer so thin that rounding cannot distinguish it from a boundary is ignored, wherever it
// is; a thicker one counts.
TEST(AddingDoublingInvariant, ALayerThinnerThanRoundingIsLeftOut) {
  const Scatterer air = rayleighScatterer(0.03);
  const Particles sky{air, 0.3, 1}, trace{air, 1e-18, 1}, soot{air, 1e-3, 0};
  const AddingDoublingAccuracy few{8, -1};
  const auto up = [&](const std::vector<AirLayer>& layers) {
    const AddingDoubling light(layers, 0.6, 0.2, pi, {0.7}, few, {0.1, 0.3});
    EXPECT_LT(apart(light.down(0, 1), light.down(0, 1, 1)), 1e-15);  // the ground
    return light.up(0, 1).getScalar();
  };
  const double alone = up({{sky}});
  EXPECT_NEAR(up({{trace}, {sky}}), alone, 1e-13);
  EXPECT_NEAR(up({{sky}, {trace}}), alone, 1e-13);
  EXPECT_NEAR(up({{trace}, {sky}, {trace}, {trace}}), alone, 1e-13);
  const AddingDoubling dark({{sky}, {soot}}, 0.6, 0.2, pi, {0.7}, few);
  EXPECT_LT(dark.up(0, 1).getScalar(), alone - 1e-5);  // control
}

TEST(AddingDoublingInvariant, RefusesTheImpossible) {
  const Scatterer air = rayleighScatterer(0);
  EXPECT_THROW(AddingDoubling({}, 0.5, 0, 1, {0.5}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, -1}}}, 0.5, 0, 1, {0.5}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 1e3}}}, 0.5, 0, 1, {0.5}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0, 0, 1, {0.5}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.0}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 1.1, 1, {0.5}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {2, 2}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {3}), MathError);
  EXPECT_NO_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {4}));
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {201}), MathError);
  EXPECT_THROW(AddingDoubling({{{air, 0.1}}}, 0.5, 0, 1, {0.5}, {}, {0.2}), MathError);
}
