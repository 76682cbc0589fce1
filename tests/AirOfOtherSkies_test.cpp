// The air before a camera under skies that are not made of air (nw/air/AirBetween.nw,
// nw/air/AerosolSky.nw, nw/files/SceneReader.nw).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "Program.hpp"
#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const json haze{
    {"model", "rayleigh"},
    {"albedo", 0.1},
    {"tau", 0.1},
    {"aerosol", {{"n", 1.44}, {"effective_radius_um", 0.2}, {"effective_variance", 0.07}}},
    {"aerosol_tau", 0.2},
    {"aerosol_scale_height_m", 1500}};
const json grey{{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0.05}};

json sceneWith(const json& sky, const json& atmosphere, double irradiance) {
  json scene{
      {"malus", 1},
      {"bands", {{"wavelength_nm", {550}}}},
      {"geometry", {{{"ground", {{"material", "plate"}}}}}},
      {"materials", {{"plate", {{"model", "lambertian"}, {"reflectance", 0.2}}}}},
      {"sun", {{"zenith_deg", 60}, {"azimuth_deg", 120}, {"irradiance_W_m2_nm", irradiance}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 10}}, {"look_at_m", {0, 0, 0}}}}};
  if (!atmosphere.is_null()) scene["atmosphere"] = atmosphere;
  return scene;
}
Scene read(const json& scene) { return readSceneText(scene.dump(), "s.json", "."); }
CDStokesVector through(const Scene& scene, const CDVector& from, const CDVector& to) {
  CDSpectralVector<CDStokesVector> light(scene.world.grid);
  light[0] = CDStokesVector(0.03);
  scene.world.atmosphere->apply(from, to, light);
  return std::as_const(light)[0];
}
double apart(const Scene& a, const Scene& b) {
  double most = 0;
  for (const CDVector from : {CDVector{4000, 300, 0}, CDVector{-900, 2000, 200}}) {
    const CDStokesVector x = through(a, from, {0, 0, 800}), y = through(b, from, {0, 0, 800});
    for (int k = 0; k < 4; ++k)
      most = std::max(most, std::abs(x.getStokes(k) - y.getStokes(k)) / y.getScalar());
  }
  return most;
}
std::string complaint(const json& scene) {
  try {
    read(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
}  // namespace

// Above the air the sun has the irradiance 1, on the ground what Beer's law leaves of it: 0.3 / cos 60 degrees.
TEST(AirOfOtherSkiesIdentity, TheAirIsThatOfTheSkyOfAir) {
  json sky = haze;
  sky["path_radiance"] = true;
  const Scene own = read(sceneWith(sky, nullptr, 1));
  const Scene beside = read(sceneWith(grey, haze, std::exp(-0.6)));
  ASSERT_TRUE(beside.world.atmosphere);
  EXPECT_LT(apart(beside, own), 1e-9);
  EXPECT_GT(through(own, {4000, 300, 0}, {0, 0, 800}).getDOLP(), 0.01) << "it is polarised";
  EXPECT_GT(apart(read(sceneWith(grey, haze, 1)), own), 0.1)
      << "negative control: the sun above for that on the ground";
  EXPECT_NEAR(std::as_const(beside.world.sun->irradiance)[0].getScalar(), std::exp(-0.6), 1e-15)
      << "the sun on the ground stays what it is";
  EXPECT_NE(beside.world.air.at(0).find("spheres"), std::string::npos);
  EXPECT_NE(beside.world.sky->description().find("uniform"), std::string::npos);
}

TEST(AirOfOtherSkiesIdentity, WhatDoesNotFitIsSaidAtItsPlace) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.substr(0, 9), "s.json:1:") << text;
  };
  const json fog{{"model", "haze"}, {"extinction_per_m", 1e-4}, {"radiance_W_m2_sr_nm", 0.02}};
  EXPECT_EQ(complaint(sceneWith(grey, fog, 1)), "accepted");  // control
  json sky = haze;
  has(complaint(sceneWith(sky, haze, 1)), "atmosphere = {");
  has(complaint(sceneWith(sky, haze, 1)), "conflicts with a sky that has air");
  sky["path_radiance"] = true;
  has(complaint(sceneWith(sky, haze, 1)), "conflicts with the air of the sky");
  json wrong = fog;
  wrong["aerosol_tau"] = 0.1;
  has(complaint(sceneWith(grey, wrong, 1)), "atmosphere.aerosol_tau");
  wrong = fog;
  wrong.erase("radiance_W_m2_sr_nm");
  has(complaint(sceneWith(grey, wrong, 1)), "lacks radiance_W_m2_sr_nm");
  wrong = haze;
  wrong["extinction_per_m"] = 1e-4;
  has(complaint(sceneWith(grey, wrong, 1)), "atmosphere.extinction_per_m");
  has(complaint(sceneWith(grey, {{"model", "uniform"}}, 1)), "atmosphere.model = \"uniform\"");
  has(complaint(sceneWith(grey, {{"model", "rayleigh"}, {"tau", -1}}, 1)),
      "atmosphere.tau = -1");
  json dark = sceneWith(grey, haze, 1);
  dark.erase("sun");
  has(complaint(dark), "needs a sun");
  json table = grey;
  table["path_radiance"] = true;
  has(complaint(sceneWith(table, nullptr, 1)),
      "is not available for this sky; leave it out, or give the scene an \"atmosphere\"");
}

// The lake of the README, small. Its far ridge is paler than the near one, by the air alone: seen without air both are leaves.
TEST(AirOfOtherSkiesInvariant, TheShippedLakeFadesWithDistance) {
  const auto lake =
      std::filesystem::path(MALUS_SOURCE_DATA).parent_path() / "scenes/hazy-lake.json";
  const auto ridges = [&](const std::string& patch) {
    const Scene scene = readScene(lake, patch);
    const CDVector camera{9, -28, 4};
    std::array<double, 2> dark{};  // what a black ridge would show at 550 nm
    for (const auto& [i, at] : {std::pair(0, CDVector{500, 1040, 20}), {1, {500, 4200, 100}}}) {
      CDSpectralVector<CDStokesVector> light(scene.world.grid);
      if (scene.world.atmosphere) scene.world.atmosphere->apply(at, camera, light);
      dark[i] = std::as_const(light)[0].getScalar();
    }
    return dark;
  };
  const std::string green = R"({"bands": {"wavelength_nm": [550]}, )";
  const auto hazy = ridges(green + R"("title": ""})");
  EXPECT_GT(hazy[0], 0);
  EXPECT_GT(hazy[1], 2 * hazy[0]);
  const auto clear = ridges(green + R"("sky": null})");
  EXPECT_EQ(clear[1], 0) << "negative control";
}
