// Air that the sun lights and that glows (nw/air/DayAndNightSky.nw).
#include "malus/air/DayAndNightSky.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "malus/air/Sun.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;
using nlohmann::json;

namespace {
constexpr int infrared = 2;
// Two visible bands and one at 10 um, seen from 9 km.
json sceneUnder(json sky) {
  sky["path_radiance"] = true;
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {450, 650, 10000}}}},
      {"geometry", {{{"ground", {{"material", "soil"}}}}}},
      {"materials",
       {{"soil", {{"model", "lambertian"}, {"reflectance", 0.3}, {"temperature_K", 300}}}}},
      {"sun",
       {{"latitude_deg", 43.16},
        {"longitude_deg", -77.61},
        {"time", "2001-06-10T10:00:00-04:00"},
        {"irradiance_W_m2_nm",
         {{"wavelength_nm", {450, 650, 10000}}, {"values", {2.0, 1.6, 2.5e-4}}}}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform",
       {{"position_m", {0, 0, 9000}},
        {"look_at_m", {0, 0, 0}},
        {"path", "fixed"},
        {"frames", 2},
        {"interval_s", 12 * 3600}}}};
}
World worldUnder(const json& sky, double hours = 0) {
  Scene scene = readSceneText(sceneUnder(sky).dump(), "s.json", ".");
  if (hours > 0) scene.move_sun(scene.world, hours * 3600);
  return std::move(scene.world);
}
std::string complaint(const json& sky) {
  try {
    worldUnder(sky);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
json gasAt10um(double depth) {
  return {{"wavelength_nm", {450, 650, 10000}}, {"values", {0, 0, depth}}};
}
const json rayleigh{{"model", "rayleigh"}, {"albedo", 0.2}},
    thermal{
        {"model", "thermal-air"}, {"optical_depth", gasAt10um(0.4)}, {"temperature_K", 285}};
json dayAndNight(double depth = 0.4, double kelvin = 285) {
  return {{"model", "day-and-night"},
          {"albedo", 0.2},
          {"glow_optical_depth", gasAt10um(depth)},
          {"glow_temperature_K", kelvin}};
}
using Values = std::vector<double>;
/// All Stokes numbers of a band, of sky, drawn directions, and air before the camera.
Values lightOf(const World& world, std::size_t band) {
  Values all;
  CDSpectralVector<CDStokesVector> light(world.grid);
  const auto take = [&](const auto& from) {
    for (int k = 0; k < 4; ++k) all.push_back(std::as_const(from)[band].getStokes(k));
  };
  std::vector<float> x, y, z;
  for (const double zenith : {0.0, 20.0, 60.0, 89.0, 120.0})
    for (const double azimuth : {0.0, 77.0, 200.0}) {
      const CDVector to_sky = compassDirection(zenith * degree, azimuth * degree);
      world.sky->radiance(to_sky, light), take(light);
      x.push_back(static_cast<float>(to_sky.x)), y.push_back(static_cast<float>(to_sky.y));
      z.push_back(static_cast<float>(to_sky.z));
    }
  const std::size_t bands = world.grid->size();
  std::vector<float> many(x.size() * 4 * bands);
  world.sky->radiances({x.size(), x.data(), y.data(), z.data()}, many);
  for (std::size_t i = band; i < many.size(); i += bands) all.push_back(many[i]);
  for (const double to_m : {9000.0, 0.0}) {
    CDSpectralVector<CDStokesVector> surface(world.grid);
    for (std::size_t i = 0; i < bands; ++i) surface[i] = {0.1, 0.02, -0.01, 0};
    world.atmosphere->apply({3000, 0, 0}, {0, 10, to_m}, surface), take(surface);
  }
  return all;
}
double largestDifference(const Values& a, const Values& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(a[i] - b[i])), size = std::max(size, std::abs(b[i]));
  return most / size;
}
double sunOf(const World& world, std::size_t band) {
  return std::as_const(world.sun->irradiance)[band].getScalar();
}
}  // namespace

TEST(DayAndNightSkyIdentity, VisibleLightIsRayleighsToTheBit) {
  const World both = worldUnder(dayAndNight()), blue = worldUnder(rayleigh);
  for (const int band : {0, 1}) {
    EXPECT_EQ(lightOf(both, band), lightOf(blue, band));
    EXPECT_EQ(sunOf(both, band), sunOf(blue, band));
  }
  EXPECT_NE(lightOf(both, infrared), lightOf(blue, infrared));  // control
  for (const double u : {0.1, 0.5, 0.9}) {
    const Sky::Sample ours = both.sky->sample(u, 0.3), theirs = blue.sky->sample(u, 0.3);
    EXPECT_EQ(ours.density, theirs.density);
    EXPECT_EQ(ours.to_sky.z, theirs.to_sky.z);
    EXPECT_EQ(both.sky->density(ours.to_sky), blue.sky->density(ours.to_sky));
  }
  EXPECT_TRUE(both.sky->polarized() && both.atmosphere->polarizes());
}

// 1e-3 hPa of air have 1e-12 at 10 um; single precision of radiances() is 6e-8.
TEST(DayAndNightSkyIdentity, InfraredLightWithoutMoleculesIsThermalAirs) {
  json thin = dayAndNight(), warmer = dayAndNight(0.4, 286);
  thin["pressure_hPa"] = warmer["pressure_hPa"] = 1e-3;
  thin["albedo"] = warmer["albedo"] = 0;  // or the ground below the horizon mirrors the sun
  const World both = worldUnder(thin), glow = worldUnder(thermal);
  EXPECT_LT(largestDifference(lightOf(both, infrared), lightOf(glow, infrared)), 1e-7);
  EXPECT_NEAR(sunOf(both, infrared) / sunOf(glow, infrared), 1, 1e-9);
  EXPECT_GT(largestDifference(lightOf(worldUnder(warmer), infrared), lightOf(glow, infrared)),
            1e-3);  // control
}

TEST(DayAndNightSkyIdentity, TheSunPassesBothAirs) {
  const json gas{{"model", "thermal-air"}, {"optical_depth", 0.01}, {"temperature_K", 285}};
  json thin = dayAndNight();
  thin["glow_optical_depth"] = 0.01;
  const World both = worldUnder(thin), blue = worldUnder(rayleigh), glow = worldUnder(gas);
  const double above = 2.0;
  EXPECT_NEAR(sunOf(both, 0), sunOf(blue, 0) * sunOf(glow, 0) / above, 1e-12);
  EXPECT_LT(sunOf(both, 0), 0.99 * sunOf(blue, 0));  // control
}

TEST(DayAndNightSkyIdentity, AtNightOnlyTheGlowRemains) {
  const World night = worldUnder(dayAndNight(), 12), noon = worldUnder(dayAndNight());
  ASSERT_LT(night.sun->to_sun.z, 0);
  CDSpectralVector<CDStokesVector> dark(night.grid), day(night.grid);
  night.sky->radiance({0, 0, 1}, dark), noon.sky->radiance({0, 0, 1}, day);
  for (const int band : {0, 1}) {
    EXPECT_EQ(std::as_const(dark)[band].getScalar(), 0);
    EXPECT_GT(std::as_const(day)[band].getScalar(), 0.005);  // control
  }
  EXPECT_NEAR(
      std::as_const(dark)[infrared].getScalar() / std::as_const(day)[infrared].getScalar(), 1,
      1e-5);
  EXPECT_GT(std::as_const(dark)[infrared].getScalar(), 1e-3);
}

// A gas in layers absorbs exactly, and what the sum neglects of the scattered light is within the stated bound. The layers' table is good to 1 %.
TEST(DayAndNightSkyInvariant, TheBoundHoldsAgainstAGasInLayers) {
  json added = dayAndNight(), exact = rayleigh;
  added["glow_optical_depth"] = 0.02, added["glow_temperature_K"] = 0;
  exact["layers"] = {{{"tau", 0.02}, {"scale_height_m", 2000}}};
  const World ours = worldUnder(added), theirs = worldUnder(exact);
  CDSpectralVector<CDStokesVector> sum(ours.grid), whole(ours.grid);
  ours.sky->radiance({0, 0, 1}, sum), theirs.sky->radiance({0, 0, 1}, whole);
  const double mu0 = ours.sun->to_sun.z, bound = -std::expm1(-0.02 * (1 + 1 / mu0));
  for (const int band : {0, 1}) {
    const double lost =
        1 - std::as_const(whole)[band].getScalar() / std::as_const(sum)[band].getScalar();
    EXPECT_GT(lost, 0.001) << band;  // control: something is neglected
    EXPECT_LT(lost, bound) << band;
  }
}

TEST(DayAndNightSkyRefusal, SaysWhatIsWrong) {
  EXPECT_EQ(complaint(dayAndNight()), "accepted");  // control
  const auto has = [](const json& sky, const std::string& part) {
    EXPECT_NE(complaint(sky).find(part), std::string::npos) << complaint(sky);
  };
  json sky = dayAndNight();
  sky["glow_optical_depth"] = 0.4;
  has(sky,
      "sky.glow_optical_depth = 0.4: absorbs scattered light at 450 nm, and the sum of both "
      "lights would neglect up to 6");
  has(sky, "% of the sky; give 0 in this band, and the gas to layers; or less aerosol there");
  sky = dayAndNight(), sky["glow_atmosphere"] = "us-standard";
  has(sky, "give glow_temperature_K or glow_atmosphere");
  sky = dayAndNight(), sky.erase("glow_optical_depth");
  has(sky, "lacks \"glow_optical_depth\"");
  sky = dayAndNight(), sky["aerosol_tau"] = 0.2;
  has(sky, "sky.aerosol_tau: needs an aerosol");
}

TEST(DayAndNightSkyIdentity, TheRecordStatesWhatIsNeglected) {
  const World world = worldUnder(dayAndNight());
  ASSERT_EQ(world.air.size(), 3u);
  EXPECT_NE(world.air[0].find("a gas of 0.0000 that glows, 0.0e+00 neglected"),
            std::string::npos)
      << world.air[0];
  EXPECT_NE(world.air[infrared].find("a gas of 0.4000 that glows"), std::string::npos)
      << world.air[infrared];
}
