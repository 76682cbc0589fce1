// A scene may mix any of the models by name (nw/surface/ModelRegistry.nw, SceneMaterials.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "Program.hpp"
#include "malus/base/Angles.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const std::string scenes =
    std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";

/// The chunky bar, small, two bounces, with other materials; a spectrum in two of them.
json mixedScene() {
  std::ifstream file(scenes + "chunky-bar-copper.json");
  json scene = json::parse(file, nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  scene["bands"] = {{"wavelength_nm", {450, 550, 650}}};
  scene["sensor"] = {
      {"kind", "framing"}, {"width", 32}, {"height", 32}, {"field_of_view_deg", 36.87}};
  scene["radiometry"] = {{"rays", {20, 3}}, {"seed", 5}};
  scene["materials"] = {
      {"copper-010",
       {{"model", "dirsig"},
        {"reflectance", 0.2},
        {"height", 1},
        {"width_deg", 30},
        {"shape", "cone"}}},
      {"copper-015",
       {{"model", "glossy-coating"}, {"n", 1.5}, {"reflectance", 0.4}, {"sigma", 0.1}}},
      {"copper-020", {{"model", "rough-water"}, {"wind_m_s", 5}, {"reflectance", 0.03}}},
      {"copper-030",
       {{"model", "robertson-sandford"},
        {"emissivity", 0.5},
        {"diffuse", 0.3},
        {"b", 0.2},
        {"e", 0.3}}},
      {"ground", {{"model", "nadal-breon"}, {"reflectance", 0.1}, {"rho", 0.03}, {"beta", 8}}}};
  return scene;
}
}  // namespace

TEST(ModelsInScenesInvariant, AMixOfModelsMakesAPhysicalPicture) {
  const Scratch scratch;
  put(scratch / "s.json", mixedScene().dump(1));
  const RenderedImage frame = renderScene(readScene(scratch / "s.json"));
  int polarized = 0;
  for (std::size_t y = 0; y < frame.height; ++y)
    for (std::size_t x = 0; x < frame.width; ++x)
      for (std::size_t band = 0; band < 3; ++band) {
        const double* s = frame.at(x, y, band);
        const double part = std::sqrt(s[1] * s[1] + s[2] * s[2] + s[3] * s[3]);
        ASSERT_TRUE(std::isfinite(s[0]));
        ASSERT_GT(s[0], 0);
        ASSERT_LE(part, s[0] * (1 + 1e-6));  // gathered in single precision
        polarized += part > 0.01 * s[0];
      }
  EXPECT_GT(polarized, 500);  // of 3072: ground, coating and water polarise
}

// Two models have a parameter "diffuse"; it is a word in one of them and a number in the other.
TEST(ModelsInScenesIdentity, OneNameMayBeAWordAndANumber) {
  const Scratch scratch;
  json scene = mixedScene();
  json& copper = scene["materials"]["copper-010"];
  copper = {{"model", "torrance-sparrow"},
            {"n", 0.405},
            {"k", 2.95},
            {"sigma", 0.2},
            {"diffuse", "reciprocal"}};
  put(scratch / "s.json", scene.dump(1));
  EXPECT_NO_THROW(readScene(scratch / "s.json"));
  for (const auto& [value, expected] :
       {std::pair<json, std::string>{"recipocal", "did you mean reciprocal?"},
        {0.3, "is not one of the words allowed here"},
        {json::array(), "a word or a spectrum"}}) {
    copper["diffuse"] = value;
    put(scratch / "s.json", scene.dump(1));
    const Outcome outcome = malusIn(scratch.path, "render s.json --dry-run");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << outcome.err;
  }
}

// A paint is solved when the scene is read; a spectrum serves for its pigment as for any other parameter.
TEST(ModelsInScenesInvariant, APaintFromItsRecipe) {
  const Scratch scratch;
  json scene = mixedScene();
  scene["materials"]["copper-015"] = {{"model", "layered-paint"}, {"pigment_n", 2.75},
                                      {"radius_nm", 110},         {"pvc", 0.1},
                                      {"thickness_um", 20},       {"sigma", 0.1}};
  put(scratch / "s.json", scene.dump(1));
  const RenderedImage frame = renderScene(readScene(scratch / "s.json"));
  for (std::size_t y = 0; y < frame.height; ++y)
    for (std::size_t x = 0; x < frame.width; ++x) {
      const double* s = frame.at(x, y, 1);
      ASSERT_GT(s[0], 0);
      ASSERT_LE(std::sqrt(s[1] * s[1] + s[2] * s[2] + s[3] * s[3]), s[0] * (1 + 1e-6));
    }
  scene["materials"]["copper-015"]["radius_nm"] =
      50000;  // negative control: too large for the series
  put(scratch / "s.json", scene.dump(1));
  const Outcome outcome = malusIn(scratch.path, "render s.json --out a");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("exceed the largest for which Mie's series"), std::string::npos)
      << outcome.err;
}

TEST(ModelsInScenesInvariant, NegativeControlImpossibleMaterialsAreRefused) {
  const Scratch scratch;
  json scene = mixedScene();
  scene["materials"]["copper-010"]["height"] = 100;  // would reflect more than all light
  put(scratch / "s.json", scene.dump(1));
  const Outcome outcome = malusIn(scratch.path, "render s.json --out a");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("more than all light"), std::string::npos) << outcome.err;
}

// The file of a material counts from the scene's directory, whatever directory the program runs in.
TEST(ModelsInScenesIdentity, AFileCountsFromTheScene) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "there");
  json scene = mixedScene();
  scene["materials"]["copper-010"] = {
      {"model", "nefds"},
      {"file", "nef.csv"},
      {"dhr", {{"wavelength_nm", {400, 700}}, {"values", {0.3, 0.5}}}},
      {"dhr_zenith_deg", 10}};
  put(scratch / "there/s.json", scene.dump(1));
  const std::string table =
      "wavelength_nm,n,k,bias,sigma\n440,1.5,0,0.03,0.2\n660,1.49,0,0.04,0.3\n";
  put(scratch / "nef.csv", table);  // not this one
  const std::string dry = "render there/s.json --dry-run --out a";
  const Outcome missing = malusIn(scratch.path, dry);
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(missing.err.starts_with("there/s.json:")) << missing.err;
  EXPECT_NE(missing.err.find("materials.copper-010.file = \"nef.csv\": does not exist; "
                             "give the name of a file; relative paths begin in there"),
            std::string::npos)
      << missing.err;
  put(scratch / "there/nef.csv", table);
  EXPECT_EQ(malusIn(scratch.path, dry).code, 0);
  scene["materials"]["copper-010"]["file"] = 7;
  put(scratch / "there/s.json", scene.dump(1));
  EXPECT_NE(malusIn(scratch.path, dry).err.find("(the name of a file)"), std::string::npos);
}

// A scene has a measured surface beside computed ones.
TEST(ModelsInScenesInvariant, AMeasuredSurfaceLooksLikeItsModel) {
  const Scratch scratch;
  json scene = mixedScene();
  scene["bands"] = {{"wavelength_nm", {550}}};
  scene["sensor"]["width"] = scene["sensor"]["height"] = 16;
  const json metal = {{"model", "torrance-sparrow"}, {"n", 0.4}, {"k", 2.9}, {"sigma", 0.3}};
  for (const auto& [name, material] : scene["materials"].items())
    scene["materials"][name] = metal;
  put(scratch / "s.json", scene.dump(1));
  const RenderedImage computed = renderScene(readScene(scratch / "s.json"));
  EXPECT_EQ(
      malusIn(scratch.path,
              "brdf --model torrance-sparrow --param n=0.4 --param k=2.9 --param sigma=0.3 "
              "--steps 24 --table m.pbsdf")
          .code,
      0);
  for (const auto& [name, material] : scene["materials"].items())
    scene["materials"][name] = {{"model", "measured"}, {"file", "m.pbsdf"}};
  put(scratch / "s.json", scene.dump(1));
  const RenderedImage measured = renderScene(readScene(scratch / "s.json"));
  double difference = 0, sum = 0;
  for (std::size_t y = 0; y < 16; ++y)
    for (std::size_t x = 0; x < 16; ++x)
      for (int k = 0; k < 4; ++k) {
        difference += std::abs(measured.at(x, y, 0)[k] - computed.at(x, y, 0)[k]);
        sum += std::abs(computed.at(x, y, 0)[k]);
      }
  EXPECT_LT(difference, 0.1 * sum);  // interpolation, and other directions drawn
  EXPECT_GT(difference, 0);
}

// A smooth coating over black mirrors sun and sky: one camera looks at the sun's image, one beside it. Fresnel's
// reflectance for n = 1.5 at 50 degrees; the half vector of a slope of 1e-6 has one digit in single precision, and the
// 400 rays of the importance sampling make a per cent of it.
TEST(ModelsInScenesPublished, ASmoothCoatingIsAMirror) {
  const double c = std::cos(50 * degree),
               t = std::sqrt(1 - std::pow(std::sin(50 * degree) / 1.5, 2));
  const double rs = (c - 1.5 * t) / (c + 1.5 * t), rp = (1.5 * c - t) / (1.5 * c + t);
  const double reflectance = (rs * rs + rp * rp) / 2;
  const double disk = 1 / (std::numbers::pi * std::pow(std::sin(0.2665 * degree), 2));
  const auto seen = [&](double sun_zenith_deg, double sigma) {
    json scene = mixedScene();
    scene["bands"] = {{"wavelength_nm", {550}}};
    scene["geometry"] = json::array({{{"ground", {{"z_m", 0}, {"material", "lacquer"}}}}});
    scene["materials"] = {
        {"lacquer",
         {{"model", "glossy-coating"}, {"n", 1.5}, {"reflectance", 0}, {"sigma", sigma}}}};
    scene["sun"] = {{"zenith_deg", sun_zenith_deg},
                    {"azimuth_deg", 0},
                    {"irradiance_W_m2_nm", 1},
                    {"half_angle_deg", 0.2665}};
    scene["sky"] = {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0.1}};
    scene["sensor"] = {
        {"kind", "framing"}, {"width", 1}, {"height", 1}, {"field_of_view_deg", 0.001}};
    scene["platform"] = {
        {"position_m", {0, -10 * std::sin(50 * degree), 10 * std::cos(50 * degree)}},
        {"look_at_m", {0, 0, 0}},
        {"up", {0, 0, 1}}};
    scene["radiometry"] = {{"sampling", "importance"}, {"rays", {401}}};
    const Scratch scratch;
    put(scratch / "s.json", scene.dump(1));
    return renderScene(readScene(scratch / "s.json")).at(0, 0)[0];
  };
  EXPECT_NEAR(seen(50.1, 0), reflectance * (disk + 0.1), 0.02 * reflectance * disk);
  EXPECT_NEAR(seen(51, 0), 0.1 * reflectance, 0.002 * reflectance);
  EXPECT_GT(seen(51, 0.003), 10 * reflectance) << "negative control: a rougher one";
}
