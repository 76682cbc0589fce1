// The ground that closes the sky of a scene (nw/files/SceneGround.nw, nw/air/AerosolSky.nw).
#include "malus/files/SceneGround.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>

#include "Program.hpp"
#include "malus/base/Angles.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const json plane{{{"ground", {{"material", "plate"}}}}};
const json plate{{"model", "lambertian"}, {"reflectance", 0.2}};
const json water{{"model", "torrance-sparrow"},
                 {"n", 1.333},
                 {"k", 0},
                 {"sigma", 0.01},
                 {"diffuse", "none"}};

json sceneOf(const json& geometry, const json& materials, const json& sky) {
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {550}}}},
      {"geometry", geometry},
      {"materials", materials},
      {"sun", {{"zenith_deg", 60}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 10}}, {"look_at_m", {0, 0, 0}}}}};
}
Scene read(const json& geometry, const json& materials, json sky,
           const std::filesystem::path& at = ".") {
  sky["model"] = "rayleigh";
  return readSceneText(sceneOf(geometry, materials, sky).dump(), "s.json", at);
}
CDStokesVector seen(const Scene& scene, double zenith_deg, double azimuth_deg) {
  CDSpectralVector<CDStokesVector> light(scene.world.grid);
  scene.world.sky->radiance(compassDirection(zenith_deg * degree, azimuth_deg * degree), light);
  return std::as_const(light)[0];
}
double apart(const Scene& a, const Scene& b) {
  double most = 0;
  for (const double zenith : {10.0, 50.0, 80.0})
    for (const double azimuth : {20.0, 100.0, 300.0}) {
      const CDStokesVector x = seen(a, zenith, azimuth), y = seen(b, zenith, azimuth);
      for (int k = 0; k < 4; ++k)
        most = std::max(most, std::abs(x.getStokes(k) - y.getStokes(k)) / y.getScalar());
    }
  return most;
}
// The albedo in the record of the run.
double toldAlbedo(const Scene& scene) {
  const std::string words = scene.world.air.at(0);
  return std::stod(words.substr(words.find("albedo ") + 7));
}
std::string complaint(const json& sky) {
  try {
    read(plane, {{"plate", plate}}, sky);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
}  // namespace

// The mean over the sampler's draws is the reflectance itself, up to rounding.
TEST(SceneGroundIdentity, WithoutAWordTheGroundIsTheScenesOwn) {
  const Scene own = read(plane, {{"plate", plate}}, json::object());
  EXPECT_LT(apart(own, read(plane, {{"plate", plate}}, {{"albedo", 0.2}})), 1e-9);
  EXPECT_LT(apart(own, read(plane, {{"plate", plate}}, {{"ground", "scene"}})), 1e-12);
  EXPECT_GT(apart(own, read(plane, {{"plate", plate}}, {{"albedo", 0.3}})), 1e-3)
      << "negative control";
  EXPECT_NEAR(toldAlbedo(own), 0.2, 1e-4);
}

// A level square metre of 0.5, and one of 0.1 that is tilted by 60 degrees: (0.5 + 0.5 * 0.1) / 1.5.
TEST(SceneGroundIdentity, MeshesCountWithTheirAreaInPlanView) {
  const Scratch scratch;
  put(scratch / "roofs.obj", fmt::format("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                         "v 2 0 0\nv 3 0 0\nv 3 0.5 {0}\nv 2 0.5 {0}\n"
                                         "usemtl level\nf 1 2 3 4\nusemtl steep\nf 5 8 7 6\n",
                                         std::sqrt(0.75)));
  const json materials{{"level", {{"model", "lambertian"}, {"reflectance", 0.5}}},
                       {"steep", {{"model", "lambertian"}, {"reflectance", 0.1}}}};
  const json roofs{{{"obj", "roofs.obj"}}};
  EXPECT_NEAR(toldAlbedo(read(roofs, materials, json::object(), scratch.path)), 0.55 / 1.5,
              1e-4);
}

// A quarter of the image is bright, and a factor of one half lies over all of it.
TEST(SceneGroundIdentity, OfAMapTheMeanOfItsImageCounts) {
  const Scratch scratch;
  put(scratch / "kinds.pgm", "P2 2 2 255\n1 2 2 2\n");
  put(scratch / "half.pgm", "P2 1 1 255\n255\n");
  json scene = sceneOf(plane, {{"bright", plate}, {"dark", plate}}, {{"model", "rayleigh"}});
  scene["materials"]["bright"]["reflectance"] = 0.6;
  scene["maps"] = {{"kinds",
                    {{"image", "kinds.pgm"},
                     {"over_m", {0, 0, 2, 2}},
                     {"materials", {{"1", "bright"}, {"2", "dark"}}}}},
                   {"shade",
                    {{"image", "half.pgm"},
                     {"over_m", {0, 0, 2, 2}},
                     {"reflectance_factor", {{"material", "kinds"}, {"range", {0, 0.5}}}}}}};
  const auto albedoUnder = [&](const char* material) {
    scene["geometry"][0]["ground"]["material"] = material;
    return toldAlbedo(readSceneText(scene.dump(), "s.json", scratch.path));
  };
  EXPECT_NEAR(albedoUnder("kinds"), 0.25 * 0.6 + 0.75 * 0.2, 1e-4);
  EXPECT_NEAR(albedoUnder("shade"), (0.25 * 0.6 + 0.75 * 0.2) / 2, 1e-4);
  EXPECT_NEAR(albedoUnder("dark"), 0.2, 1e-4) << "negative control";
}

// Over calm water the albedo is between Fresnel's reflectance at 60 degrees and its mean, which is 0.0664 for n = 1.333 by the
// integral below; facets that hide one another at the horizon take a little.
TEST(SceneGroundIdentity, CalmWaterReturnsWhatFresnelSays) {
  const auto fresnel = [](double mu) {
    const double n = 1.333, inside = std::sqrt(1 - (1 - mu * mu) / (n * n));
    const double s = (mu - n * inside) / (mu + n * inside),
                 p = (n * mu - inside) / (n * mu + inside);
    return (s * s + p * p) / 2;
  };
  double mean = 0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) {
    const double mu = (i + 0.5) / steps;
    mean += 2 * mu * fresnel(mu) / steps;
  }
  EXPECT_NEAR(mean, 0.0664, 1e-4);
  const double passes = std::exp(-0.3 / 0.5),
               by_hand = passes * fresnel(0.5) + (1 - passes) * mean;
  const Scene scene = read(plane, {{"plate", water}}, {{"tau", 0.3}});
  EXPECT_NEAR(toldAlbedo(scene), by_hand, 0.02 * by_hand);
  EXPECT_GT(std::abs(fresnel(1) / by_hand - 1), 0.5) << "control";
}

// A Lambertian material by its name is its albedo, in haze to the solver's rounding, in clear air to the sky's table.
TEST(SceneGroundIdentity, ALambertianMaterialIsItsAlbedo) {
  const json spheres{{"n", 1.44}, {"effective_radius_um", 0.2}, {"effective_variance", 0.07}};
  const json haze{{"aerosol", spheres}, {"aerosol_tau", 0.2}};
  const auto with = [&](json sky, const json& more) {
    sky.update(more);
    return read(plane, {{"plate", plate}}, sky);
  };
  EXPECT_LT(apart(with(haze, {{"ground", "plate"}}), with(haze, {{"albedo", 0.2}})), 1e-6);
  EXPECT_LT(apart(with({}, {{"ground", "plate"}}), with({}, {{"albedo", 0.2}})), 1e-4);
}

// Water by its name sends its glint up, and polarised light: another sky than that of its albedo.
TEST(SceneGroundInvariant, ASurfaceIsMoreThanItsAlbedo) {
  const json sea{{"model", "rough-water"}, {"wind_m_s", 5}};
  json sky{{"tau", 0.3}, {"ground", "sea"}};
  const json materials{{"plate", plate}, {"sea", sea}};
  const Scene over_sea = read(plane, materials, sky);
  EXPECT_NE(over_sea.world.air.at(0).find("; over sea"), std::string::npos);
  const Scene over_mean =
      read({{{"ground", {{"material", "sea"}}}}}, materials, {{"tau", 0.3}});
  EXPECT_LT(apart(over_sea, over_mean), 0.05);
  EXPECT_GT(apart(over_sea, over_mean), 1e-3);
}

TEST(SceneGroundIdentity, AWrongGroundIsSaidAtItsPlace) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(complaint({{"ground", "plate"}}), "accepted");  // control
  has(complaint({{"ground", "plte"}}),
      "sky.ground = plte: is not a material of the scene; did you mean plate?");
  has(complaint({{"ground", "plate"}, {"albedo", 0.2}}), "conflicts with an albedo");
  has(complaint({{"ground", 0.2}}), "sky.ground = 0.2");
  const Outcome outcome = malusIn(".", "sky --tau 0.1 --mu0 0.5 --mu 0.5 --ground plate");
  EXPECT_EQ(outcome.code, 2);
  has(outcome.err, "--ground = plate: needs a scene");
}
