// What surfaces emit (nw/surface/Emission.nw).
#include "malus/surface/Emission.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>

#include "ModelChecks.hpp"
#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/light/CDSpectralUnits.hpp"
#include "malus/render/Radiometry.hpp"
#include "malus/surface/BRDFBeardMaxwell.hpp"
#include "malus/surface/BRDFDIRSIG.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFGlossyCoating.hpp"
#include "malus/surface/BRDFNadalBreon.hpp"
#include "malus/surface/BRDFRobertsonSandford.hpp"
#include "malus/surface/BRDFRoughWater.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/Fresnel.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
constexpr TorranceSparrowOptions bare{Shadowing::none, DiffuseTerm::none};

std::shared_ptr<const CDBRDFModel> lambert(double reflectance) {
  return std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(oneBand(), reflectance));
}
CDSpectralVector<double> value(double x) { return {oneBand(), x}; }

/// Emissivity of facets with a tilt of hardly a ten-thousandth: Fresnel's mirror.
CDStokesVector mirrorEmissivity(double n, double k, double zenith_rad) {
  return emissivityOf(BRDFTorranceSparrow(n, k, 1e-4, bare), zenith_rad).at(0);
}

double integral(const auto& f, double low, double high) {
  return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(f, low, high, 15, 1e-13);
}
}  // namespace

// CODATA 2018: sigma = 5.670374419...e-8 W m^-2 K^-4, b = 2.897771955...e-3 m K, both exact and cut after ten digits.
TEST(EmissionPublished, StefanBoltzmannAndWien) {
  for (const double T : {77.0, 300.0, 5800.0}) {
    // over the logarithm of the wavelength; outside of these bounds lies less than 1e-12 of the light
    const double exitance = pi * integral(
                                     [T](double log_nm) {
                                       const double nm = std::exp(log_nm);
                                       return nm * planckRadiance(nm, T);
                                     },
                                     std::log(2.9e6 / T / 15), std::log(2.9e6 / T * 1e5));
    EXPECT_NEAR(exitance / std::pow(T, 4) / 5.670374419e-8, 1, 1e-9);  // the printed digits
    const double peak = 2.897771955e6 / T;                             // nm
    // the maximum is flat: the slope between two points beside it changes sign within 1e-6 of it
    const auto rise = [T](double nm) {
      return planckRadiance(nm * (1 + 1e-4), T) - planckRadiance(nm * (1 - 1e-4), T);
    };
    EXPECT_GT(rise(peak * (1 - 1e-6)), 0);
    EXPECT_LT(rise(peak * (1 + 1e-6)), 0);
    EXPECT_GT(rise(peak * 0.999), 0);  // negative control: a peak elsewhere would show
  }
  EXPECT_GT(std::abs(5.6704e-8 / 5.670374419e-8 - 1), 1e-9);  // negative control
}

TEST(EmissionIdentity, PlanckAtItsEnds) {
  // Rayleigh and Jeans: 2ckT/lambda^4 far out, where hc/(lambda k T) = 5e-8 is the relative error, halved
  const double nm = 1e15, T = 300, m = nm * 1e-9;
  const double jeans = 2 * speed_of_light_m_s * boltzmann_J_K * T / std::pow(m, 4) * 1e-9;
  EXPECT_NEAR(planckRadiance(nm, T) / jeans, 1, 5e-8);
  EXPECT_EQ(planckRadiance(550, 0), 0);
  EXPECT_EQ(planckRadiance(1, 1), 0);  // e^-14000000
  // by hand as in the chapter, with hc/k = 14387.77 um K, whose last digit is worth 4e-7 of the result
  EXPECT_NEAR(planckRadiance(1e4, 300) / 9.92403e-3, 1, 1e-6);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const auto& [bad_nm, bad_K] : {std::pair{0.0, 300.0},
                                      {-1.0, 300.0},
                                      {nan, 300.0},
                                      {inf, 300.0},
                                      {500.0, -1.0},
                                      {500.0, nan},
                                      {500.0, inf}})
    EXPECT_THROW(planckRadiance(bad_nm, bad_K), MathError) << bad_nm << ' ' << bad_K;
}

// Facets of 1e-4: the Fresnel factors of a tenth of a milliradian around are averaged, which changes them by less than
// 1e-4 up to 85 deg; shadowing is left out, and a facet seen edge-on is not evaluated.
TEST(EmissionIdentity, MirrorsEmitWhatFresnelLeaves) {
  for (const auto& [n, k] : {std::pair{1.5, 0.0}, {1.218, 0.0508}, {8.31, 63.0}, {0.405, 2.95}})
    for (const double deg : {0.0, 20.0, 45.0, 60.0, 75.0, 85.0}) {
      const double cosine = std::cos(deg * degree);
      const auto r = fresnelReflection(cosine, 1 - cosine * cosine, n * n - k * k, 2 * n * k);
      const CDStokesVector e = mirrorEmissivity(n, k, deg * degree);
      EXPECT_NEAR(e.getStokes(0), 1 - r.sum, 2e-4) << n << ' ' << deg;
      EXPECT_NEAR(e.getStokes(1), -r.diff, 2e-4) << n << ' ' << deg;
      EXPECT_EQ(e.getStokes(2), 0);
      EXPECT_EQ(e.getStokes(3), 0);
      if (deg > 0) {
        EXPECT_GT(std::abs(e.getStokes(1) - r.diff), 4e-4);  // negative control: the sign
      }
    }
}

// Good conductors, Strozzi and McDonald 2000: e_s = e_n cos, e_p = e_n/cos while |N| cos >> 1.
TEST(EmissionPublished, ConductorsGlowByTheCosine) {
  const auto split = [](double deg) {
    const CDStokesVector e = mirrorEmissivity(8.31, 63.0, deg * degree);
    return std::pair{e.getStokes(0) + e.getStokes(1), e.getStokes(0) - e.getStokes(1)};
  };
  const double normal = split(0).first;
  for (const double deg : {20.0, 40.0, 60.0, 75.0}) {
    const double cosine = std::cos(deg * degree);
    // terms of the order |Re 1/N| / cos = 0.002 / cos; facets of 1e-4
    EXPECT_NEAR(split(deg).first / normal, cosine, 0.02) << deg;
    EXPECT_NEAR(split(deg).second / normal, 1 / cosine, 0.02 / cosine / cosine) << deg;
  }
  EXPECT_GT(split(60).second / normal, 1.9);  // negative control: not the same in both
}

TEST(EmissionIdentity, MattSurfacesEmitTheRest) {
  for (const double reflectance : {0.0, 0.05, 0.5, 1.0})
    for (const double zenith : {0.0, 0.7, 1.5}) {
      const auto e = emissivityOf(*lambert(reflectance), zenith);
      EXPECT_NEAR(e.at(0).getScalar(), 1 - reflectance, 1e-12);  // sums of 8192 equal terms
      EXPECT_FALSE(e.anyPolarized());
    }
}

namespace {
struct Named {
  const char* name;
  std::shared_ptr<const CDBRDFModel> model;
};
const std::vector<Named>& reciprocalModels() {
  static const std::vector<Named> models{
      {"facets", std::make_shared<BRDFTorranceSparrow>(
                     value(1.5), value(0), value(0.2),
                     TorranceSparrowOptions{Shadowing::smith, DiffuseTerm::none})},
      {"v-grooves", std::make_shared<BRDFTorranceSparrow>(
                        value(8.31), value(63), value(0.1),
                        TorranceSparrowOptions{Shadowing::vGroove, DiffuseTerm::reciprocal})},
      {"copper", std::make_shared<BRDFTorranceSparrow>(
                     value(8.31), value(63), value(0.1),
                     TorranceSparrowOptions{Shadowing::smith, DiffuseTerm::none})},
      {"copper grooves", std::make_shared<BRDFTorranceSparrow>(
                             value(8.31), value(63), value(0.1),
                             TorranceSparrowOptions{Shadowing::vGroove, DiffuseTerm::none})},
      {"cosine lobe",
       std::make_shared<BRDFDIRSIG>(value(0.1), value(2), value(0.35), LobeShape::cosine)},
      {"coating", std::make_shared<BRDFGlossyCoating>(value(1.5), value(0.5), 0.1)},
      {"water", std::make_shared<BRDFRoughWater>(value(0.02), WaterState{})},
      {"leaves", std::make_shared<BRDFNadalBreon>(value(0.2), 0.03, 8)}};
  return models;
}
}  // namespace

// The DHR is integrated by other means, over the other end of the path. Where they differ is the error of the points.
TEST(EmissionInvariant, ReciprocalModelsEmitOneLessTheirDHR) {
  double worst = 0;
  for (const auto& [name, model] : reciprocalModels())
    for (const double zenith : {0.0, 0.4, 0.9, 1.2, 1.45}) {
      const double difference =
          emissivityOf(*model, zenith).at(0).getScalar() - (1 - model->getDHR(zenith)[0]);
      EXPECT_LT(std::abs(difference), 1e-3)
          << name << ' ' << zenith;  // half of integration_error
      worst = std::max(worst, std::abs(difference));
    }
  EXPECT_GT(std::abs(emissivityOf(*reciprocalModels()[0].model, 1.2).at(0).getScalar() -
                     (1 - reciprocalModels()[0].model->getDHR(1.1)[0])),
            1e-3);  // negative control: another angle
}

// The plane of emission is a plane of symmetry: f20 and f30 are odd in the azimuth, f00 and f10 even.
TEST(EmissionInvariant, NoModelIsHanded) {
  for (const auto& [name, model] : reciprocalModels())
    for (const Angles& a : someAngles(30)) {
      const auto
          one = model->getBRDF(BRDFGeometry::fromAngles(a.theta_i, a.theta_r, a.phi)).at(0),
          other = model->getBRDF(BRDFGeometry::fromAngles(a.theta_i, a.theta_r, -a.phi)).at(0);
      for (int j = 0; j < 4; ++j)
        EXPECT_NEAR(one.getMueller(j, 0), (j < 2 ? 1 : -1) * other.getMueller(j, 0),
                    1e-9 * one.getScalar())  // rounding of facets near grazing
            << name << ' ' << j;
    }
}

// Water and glass glow with p-polarised light at all angles; rougher surfaces less so.
TEST(EmissionInvariant, GlowIsParallelAndRoughnessBlursIt) {
  double before = 1;
  for (const double sigma : {0.01, 0.1, 0.2, 0.3}) {
    const BRDFTorranceSparrow glass(1.5, 0, sigma, {Shadowing::smith, DiffuseTerm::none});
    const CDStokesVector e = emissivityOf(glass, 70 * degree).at(0);
    EXPECT_LT(e.getStokes(1), 0);
    EXPECT_LT(e.getDOLP(), before);
    before = e.getDOLP();
  }
}

TEST(EmissionIdentity, RefusesWhatCannotEmit) {
  const auto zero = value(0);
  const BRDFBeardMaxwell metal(
      {value(1.304), value(7.479), value(0.03), value(0.17), zero, zero});
  EXPECT_GT(metal.getDHR(1.55)[0], 1);  // as its chapter says
  EXPECT_NO_THROW(emissivityOf(metal, 0.3));
  try {
    Emission emission(metal, 300);
    FAIL() << "no error";
  } catch (const MathError& error) {
    EXPECT_NE(std::string(error.what()).find("which leaves no emissivity"), std::string::npos);
  }
  for (const double zenith : {-0.1, pi / 2, std::nan("")})
    EXPECT_THROW(emissivityOf(*lambert(0.5), zenith), MathError);
  EXPECT_THROW(Emission(*lambert(0.5), -1), MathError);
}

// The table against the integral between its nodes, copper's narrow peak above the horizon
// included; linear interpolation on 128 nodes has an error of an eighth of the second
// difference.
TEST(EmissionIdentity, TheTableIsTheIntegral) {
  const BRDFTorranceSparrow copper(8.31, 63.0, 1e-4, {Shadowing::smith, DiffuseTerm::none});
  const Emission emission(copper, 300);
  const double black = planckRadiance(copper.grid()->nm(0), 300);
  double most = 0;
  for (const double deg : {0.0, 10.3, 33.3, 55.1, 70.7, 80.9, 87.3, 89.05}) {
    CDSpectralVector<CDStokesVector> sum(copper.grid(), CDStokesVector(black, 0.0, 0.0, 0.0));
    emission.add(std::cos(deg * degree), sum);
    const CDStokesVector e = emissivityOf(copper, deg * degree).at(0);
    EXPECT_NEAR(sum.at(0).getStokes(0) / black - 1, e.getStokes(0), 0.01 * e.getStokes(0))
        << deg;
    EXPECT_NEAR(sum.at(0).getStokes(1) / black, e.getStokes(1), 0.01 * e.getStokes(0)) << deg;
    most = std::max(most, e.getStokes(0));
  }
  EXPECT_GT(most,
            0.11);  // the peak was there: e_p is 0.23 where R_p = (|n| - Re n)/(|n| + Re n)
}

TEST(EmissionIdentity, NothingAtTheHorizonAndBelow) {
  const Emission emission(*lambert(0.2), 6000);
  CDSpectralVector<CDStokesVector> sum(oneBand(), CDStokesVector(0.0));
  for (const double cosine : {0.0, -0.5, std::nan("")}) emission.add(cosine, sum);
  EXPECT_EQ(sum.at(0), CDStokesVector(0.0));
  emission.add(1e-9, sum);
  emission.add(1, sum);
  EXPECT_NEAR(sum.at(0).getScalar() / (1.6 * planckRadiance(550, 6000)), 1, 1e-12);
  EXPECT_FALSE(sum.anyPolarized());  // Lambert's surface polarises nothing
}

TEST(EmissionInvariant, LookingUpAllocatesNothing) {
  const auto grid = manyBands();
  const BRDFTorranceSparrow glass(ramp(grid, 1.4, 1.6), ramp(grid, 0, 0.1),
                                  ramp(grid, 0.2, 0.2), {Shadowing::smith, DiffuseTerm::none});
  const Emission emission(glass, 500);
  CDSpectralVector<CDStokesVector> sum(grid);
  sum.polarize();
  const std::size_t before = allocations;
  for (int i = 0; i <= 100; ++i) emission.add(i / 100.0, sum);
  EXPECT_EQ(allocations, before);
  std::vector<double> control(3);  // negative control
  EXPECT_GT(allocations, before);
}

// A closed room of one temperature, whatever its walls are made of, is a black body and unpolarised. Six reflections
// are followed; the contribution of the seventh is below the product of the walls' reflectances.
namespace {
constexpr double room_K = 6000;  // hot enough to glow in the room's one band of 550 nm

World roomOf(double warmer_K) {
  const auto& models = reciprocalModels();
  // facets, lobe, water, leaves, matt, facets
  World world = worldOf(boxOf({models[0].model, models[4].model, models[6].model,
                               models[7].model, lambert(0.3), models[0].model}));
  for (Material& wall : world.materials)
    wall.emission = std::make_shared<Emission>(*wall.brdf, room_K);
  world.materials[1].emission =
      std::make_shared<Emission>(*world.materials[1].brdf, room_K + warmer_K);
  return world;
}
const RadiometryOptions deep{.sampling = Sampling::importance, .rays = {33, 2, 2, 2, 2, 2}};
}  // namespace

TEST(EmissionInvariant, ARoomOfOneTemperatureIsBlackAndUnpolarised) {
  const World room = roomOf(0);
  const double black = planckRadiance(550, room_K);
  for (const CDVector& from : {CDVector{0.3, 0.2, 0.9}, CDVector{0.8, -0.1, 0.3},
                               CDVector{0.2, 0.6, -0.5}, CDVector{-0.7, 0.4, -0.4}}) {
    const CDVector to = CDVector{0.1, -0.05, 0} + from * (from.z > 0 ? -1.0 : 1.0);
    Radiometry::Ray ray{{0.1, 0.05, 0}, normalized(to), {0.3, 0.9, 0.1}, 0, 0, 0};
    const Estimate seen = estimate(room, deep, ray, 500);
    // five standard errors of 16 numbers; what six reflections leave out; the points of the integral
    const double slack = 2e-3 * black;
    EXPECT_NEAR(seen.mean[0], black, 5 * seen.error[0] + slack);
    for (std::size_t c = 1; c < 4; ++c)
      EXPECT_NEAR(seen.mean[c], 0, 5 * seen.error[c] + slack) << c;
    EXPECT_LT(seen.error[0], 4e-3 * black);  // the comparison means something
  }
}

// Negative controls: a wall that is warmer, and a wall alone, show.
TEST(EmissionInvariant, AWarmerWallAndAWallAloneShow) {
  const double black = planckRadiance(550, room_K);
  const Radiometry::Ray up{{0.1, 0.05, 0}, normalized({0.2, 0.1, 1}), {1, 0, 0}, 0, 0, 0};
  EXPECT_GT(estimate(roomOf(100), deep, up, 100).mean[0], 1.02 * black);
  RadiometryOptions alone;
  alone.rays = {1};
  const Radiometry::Ray down{{-0.8, 0.05, 0}, normalized({1.6, 0.1, -1}), {0, 1, 0}, 0, 0, 0};
  const Estimate seen = estimate(roomOf(0), alone, down, 1);
  EXPECT_LT(seen.mean[0], 0.97 * black);
  EXPECT_GT(std::hypot(seen.mean[1], seen.mean[2]), 0.01 * black);
}

// Cold materials and no emission at all are the same picture, bit by bit.
TEST(EmissionInvariant, ZeroKelvinChangesNoBit) {
  World cold = roomOf(0), none = cold;
  for (World* world : {&cold, &none}) {
    world->sun.emplace(Sun{normalized({0.3, 0.2, 0.9}), spectrumOf(CDStokesVector(2.0))});
    for (Material& wall : world->materials) wall.emission = nullptr;
  }
  for (Material& wall : cold.materials)
    wall.emission = std::make_shared<Emission>(*wall.brdf, 0);
  cold.sky = none.sky = uniformSky(1);
  RadiometryOptions options;
  options.rays = {40, 3};
  const auto look = [&](const World& world) {
    const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
    const Radiometry::Ray ray = looking({0, 0, -1}, {1, 0.5, 2}, {1, 0, 0});
    std::array<double, 4> out{};
    radiometry.radiance({&ray, 1}, out);
    return out;
  };
  EXPECT_EQ(look(cold), look(none));
}
