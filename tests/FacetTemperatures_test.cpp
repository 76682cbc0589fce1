// The temperatures of facets (nw/render/FacetTemperatures.nw).
#include "malus/render/FacetTemperatures.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/surface/Fresnel.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
const InputPlace here{"test", 1, "time"};
const Moment noon =
    readMoment("2001-06-10T17:10:00Z", here);  // of the sun at 77.61 degrees west
const ThermalMaterial soil{{1, 1600, 1250}, 0.7, 0.95},
    copper{{390, 8960, 385, 0.01}, 0.3, 0.02}, paint{{0.2, 1200, 1500, 0.02}, 0.7, 0.9};

/// Hourly rows from six days before noon to one day after it; hours count from noon.
Weather weatherOf(const std::function<WeatherMoment(double hour)>& row) {
  std::vector<WeatherMoment> rows;
  for (int hour = -144; hour <= 24; ++hour) rows.push_back(row(hour));
  return {noon.later(-144 * 3600), 3600, rows};
}
WeatherMoment clearDay(double hour) {
  const double sun = std::max(0.0, std::cos(2 * pi * hour / 24) + 0.2);
  return {290 + 6 * std::cos(2 * pi * (hour - 3) / 24), 2, 700 * sun, 80 * sun, 320};
}
HeatingOptions options(std::vector<std::optional<ThermalMaterial>> materials,
                       const std::function<WeatherMoment(double)>& row = clearDay) {
  HeatingOptions made{weatherOf(row), 43.16, -77.61, noon, 3, {}};
  made.materials = std::move(materials);
  return made;
}

/// Four walls of a box of 1 m, outwards: 0 east, 1 north, 2 west, 3 south; 4 its roof; 5 a wide floor around it.
World box() {
  const Model m = matt(0.5);
  World world = worldOf({{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}, m},
                         {{1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {1, 1, 1}, m},
                         {{0, 1, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 1}, m},
                         {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, m},
                         {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, m},
                         {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}, m}});
  return world;
}
}  // namespace

TEST(FacetTemperaturesInvariant, OneTemperatureStays) {
  constexpr double K = 285;
  const double black = stefan_boltzmann_W_m2_K4 * std::pow(K, 4);
  World world = box();
  world.materials[1].emission = nullptr;  // the north wall is not heated: as the air
  const RayTracer tracer(world.geometry);
  const std::vector<std::optional<ThermalMaterial>> materials{copper, {},   paint,
                                                              copper, soil, {}};
  const FacetTemperatures still(world, tracer,
                                options(materials,
                                        [&](double) {
                                          return WeatherMoment{K, 3, 0, 0, black};
                                        }),
                                86400);
  for (std::size_t part : {0, 2, 3, 4})
    for (double time_s : {0.0, 40000.0, 86400.0}) EXPECT_NEAR(still.at(part, time_s), K, 1e-6);
  EXPECT_THROW(still.at(1, 0), std::out_of_range);
  EXPECT_THROW(still.at(0, 90000), std::out_of_range);
  // control: a colder sky; paint, which emits, falls by more than copper
  const FacetTemperatures cold(world, tracer,
                               options(materials,
                                       [&](double) {
                                         return WeatherMoment{K, 3, 0, 0, 0.7 * black};
                                       }),
                               0);
  EXPECT_LT(cold.at(2, 0), K - 1);
  EXPECT_GT(cold.at(0, 0), K - 0.2);
}

TEST(FacetTemperaturesIdentity, OpenGroundIsASlab) {
  GeometryBuilder builder;
  builder.addGround(0, "soil", "ground");
  World world = worldOf({});
  world.geometry = std::move(builder).build();
  world.materials = {{"soil", matt(0.3)}};
  const RayTracer tracer(world.geometry);
  HeatingOptions how = options({soil});
  how.days_before = 6;
  const double end_s = 6 * 3600;
  const FacetTemperatures got(world, tracer, how, end_s);
  const auto flow = [&](double t) {
    const WeatherMoment w = how.weather.at(noon.later(t));
    const double up = std::max(0.0, solarPosition(43.16, -77.61, noon.later(t)).toSun().z);
    return SurfaceHeat{0.7 * (w.direct_W_m2 * up + w.diffuse_W_m2) + 0.95 * w.longwave_W_m2,
                       0.95, 5.7 + 3.8 * w.wind_m_s, w.air_K};
  };
  // The initial state of a half space decays with the root of time, so the rest under the first
  // day is made here as well.
  SurfaceHeat mean{0, 0.95, 0, 0};
  for (int i = 0; i < 144; ++i) {
    const SurfaceHeat f = flow(-6 * day_s + (i + 0.5) * 600);
    mean.absorbed_W_m2 += f.absorbed_W_m2 / 144,
        mean.convection_W_m2_K += f.convection_W_m2_K / 144;
    mean.air_K += f.air_K / 144;
  }
  HeatedSlab slab(soil.slab, mean);
  for (double t = -6 * day_s; t < end_s - 1; t += 600)
    slab.step(600, {flow(t), flow(t + HeatedSlab::inner * 600), flow(t + 600)});
  EXPECT_NEAR(got.at(0, end_s), slab.surface_K(),
              0.02);  // other steps, and other moments of the first day
  EXPECT_GT(got.at(0, 3600), 300);
}

TEST(FacetTemperaturesInvariant, WallsFollowTheSun) {
  World world = box();
  const RayTracer tracer(world.geometry);
  HeatingOptions how = options({paint, paint, paint, paint, paint, {}});
  const FacetTemperatures got(world, tracer, how, 20 * 3600);
  const double evening = 5 * 3600, morning = 20 * 3600;
  EXPECT_GT(got.at(2, evening), got.at(0, evening) + 5);
  EXPECT_GT(got.at(0, morning), got.at(2, morning) + 5);
  EXPECT_GT(got.at(3, 3600), got.at(1, 3600) + 2);        // south and north after noon
  EXPECT_GT(got.at(4, 0), got.at(1, 0) + 5);              // the roof at noon
  EXPECT_LT(got.at(4, 12 * 3600), got.at(1, 12 * 3600));  // at night it sees more sky
  // steps
  how.longest_step_s = 450;
  const FacetTemperatures fine(world, tracer, how, 20 * 3600);
  for (std::size_t part = 0; part < 5; ++part)
    for (double t : {0.0, evening, 12.0 * 3600, morning})
      EXPECT_NEAR(got.at(part, t), fine.at(part, t), 0.05) << part << ' ' << t;
}

TEST(FacetTemperaturesInvariant, AShadedFloorIsColderByDayAndFallsLessByNight) {
  const Model m = matt(0.5);
  const auto floorUnder = [&](bool roof) {
    std::vector<Quad> quads{floorOf(m, 1)};
    if (roof) quads.push_back({{-3, -3, 1}, {-3, 3, 1}, {3, 3, 1}, {3, -3, 1}, m});
    return worldOf(quads);
  };
  World open = floorUnder(false), under = floorUnder(true);
  const RayTracer a(open.geometry), b(under.geometry);
  const FacetTemperatures lit(open, a, options({soil}), 14 * 3600),
      dark(under, b, options({soil, paint}), 14 * 3600);
  EXPECT_LT(dark.at(0, 3600), lit.at(0, 3600) - 8);
  const auto fall = [](const FacetTemperatures& of) {
    return of.at(0, 9 * 3600) - of.at(0, 14 * 3600);
  };
  EXPECT_GT(fall(lit), fall(dark) + 0.5);
  EXPECT_GT(fall(dark), 0);
}

TEST(FacetTemperaturesIdentity, AWarmedWorldGlowsByFacets) {
  World world = box();
  const auto grid = SpectralGrid::make({10000.0});
  for (Material& material : world.materials)
    material.brdf = std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(grid, 0.1));
  world.grid = grid;
  // one material for all facets
  GeometryBuilder builder;
  Mesh mesh;
  mesh.vertices = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0}, {0, 0, 1}, {0, 1, 1},
                   {-1, 0, 0}, {-1, 1, 0}, {0, 0, 0}, {0, 1, 0}};
  mesh.facets = {"flat", "steep"}, mesh.materials = {"m"};
  mesh.triangles = {{0, 1, 2, 0, 0}, {3, 4, 5, 1, 0}};
  builder.addMesh(mesh, {});
  world.geometry = std::move(builder).build();
  world.materials.resize(1);
  world.materials[0].emission = std::make_shared<const Emission>(*world.materials[0].brdf, 300);
  const RayTracer tracer(world.geometry);
  const FacetTemperatures got(world, tracer, options({paint}), 3600);
  got.warm(world, 1800);
  for (std::uint32_t facet : {0, 1}) {
    const Emission* glow = world.materials[0].glow(facet);
    ASSERT_NE(glow, nullptr);
    EXPECT_EQ(glow->temperature_K(), got.at(facet, 1800));
    CDSpectralVector<CDStokesVector> light(grid);
    glow->add(0.7, light);
    EXPECT_NEAR(light.at(0).getStokes(0), 0.9 * planckRadiance(10000, got.at(facet, 1800)),
                1e-12);
  }
  EXPECT_GT(std::abs(got.at(0, 1800) - got.at(1, 1800)), 1);
  EXPECT_NEAR(world.materials[0].emission->temperature_K(),
              (got.at(0, 1800) + got.at(1, 1800)) / 2, 1e-9);
}

TEST(FacetTemperaturesIdentity, WhatModelsAbsorb) {
  EXPECT_NEAR(hemisphericalAbsorptance(*matt(0.3)).at(0), 0.7, 1e-9);
  // two bands, of which one is in the sun's range and one in that of heat
  const auto grid = SpectralGrid::make({550.0, 10000.0});
  CDSpectralVector<double> grey(grid, 0.3);
  grey[1] = 0.1;
  const BRDFDiffuse painted(grey);
  EXPECT_NEAR(meanAbsorptance(painted, 300, 2500, 5772).value(), 0.7, 1e-9);
  EXPECT_NEAR(meanAbsorptance(painted, 4000, 50000, 300).value(), 0.9, 1e-9);
  const double sun = planckRadiance(550, 5772), far = planckRadiance(10000, 5772);
  EXPECT_NEAR(meanAbsorptance(painted, 300, 50000, 5772).value(),
              (0.7 * sun + 0.9 * far) / (sun + far), 1e-9);
  EXPECT_FALSE(meanAbsorptance(painted, 1000, 2000, 5772));
  // a mirror of glass: 1 - integral of (Rs + Rp)/2 over u = sin^2; 2e-3 are the integral of emissivityOf and sixteen steps
  double absorbed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double u = (i + 0.5) / 20000, c = std::sqrt(1 - u), t = std::sqrt(1 - u / 2.25);
    const double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
    absorbed += (1 - (s * s + p * p) / 2) / 20000;
  }
  const auto value = [](double x) { return CDSpectralVector<double>(oneBand(), x); };
  const BRDFTorranceSparrow glass(value(1.5), value(0), value(1e-3),
                                  {Shadowing::none, DiffuseTerm::none});
  EXPECT_NEAR(hemisphericalAbsorptance(glass).at(0), absorbed, 5e-3);
}

TEST(FacetTemperaturesRefusal, SaysWhatIsWrong) {
  World world = box();
  const RayTracer tracer(world.geometry);
  const auto refused = [&](HeatingOptions how, double until_s = 0) -> std::string {
    try {
      FacetTemperatures(world, tracer, how, until_s);
    } catch (const MathError& error) {
      return error.what();
    }
    return "";
  };
  HeatingOptions how = options({paint, paint, paint, paint, paint, {}});
  EXPECT_EQ(refused(how), "");
  EXPECT_EQ(refused(how, 2 * 86400),
            "the weather goes from 2001-06-04T17:10:00Z to 2001-06-11T17:10:00Z and has no "
            "2001-06-12T17:10:00Z");
  how.days_before = 7;
  EXPECT_EQ(refused(how),
            "the weather goes from 2001-06-04T17:10:00Z to 2001-06-11T17:10:00Z and has no "
            "2001-06-03T17:10:00Z");
  how.days_before = 0;
  EXPECT_EQ(refused(how), "days_before must be 1 to 3650, not 0");
  how.days_before = 3;
  how.materials[0]->longwave_emissivity = 1.5;
  EXPECT_EQ(refused(how), "a long-wave emissivity must be 0 to 1, not 1.5");
  how.materials.pop_back();
  EXPECT_NE(refused(how), "");
}
