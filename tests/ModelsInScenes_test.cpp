// A scene may mix any of the models by name (nw/program/Models.nw, SceneMaterials.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "Program.hpp"
#include "program/Render.hpp"
#include "program/Scene.hpp"

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
        {"width", 30},
        {"shape", "cone"}}},
      {"copper-015",
       {{"model", "glossy-coating"}, {"n", 1.5}, {"reflectance", 0.4}, {"sigma", 0.1}}},
      {"copper-020", {{"model", "rough-water"}, {"wind", 5}, {"reflectance", 0.03}}},
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
  const CDFrame frame = renderScene(readScene(scratch / "s.json"));
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
  copper = {{"model", "torrance-sparrow"}, {"n", 0.405}, {"k", 2.95}, {"sigma", 0.2},
            {"diffuse", "reciprocal"}};
  put(scratch / "s.json", scene.dump(1));
  EXPECT_NO_THROW(readScene(scratch / "s.json"));
  for (const auto& [value, expected] :
       {std::pair<json, std::string>{"recipocal", "did you mean reciprocal?"},
        {0.3, "is none of the words allowed here"},
        {json::array(), "a word or a spectrum"}}) {
    copper["diffuse"] = value;
    put(scratch / "s.json", scene.dump(1));
    const Outcome outcome = malusIn(scratch.path, "render s.json --dry-run");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << outcome.err;
  }
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
