// Weather over a scene (nw/files/SceneHeat.nw): the keys heat and thermal.
#include "malus/files/SceneHeat.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "Program.hpp"
#include "Scratch.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using nlohmann::json;

namespace {
/// Eight days of hours from the fourth of June, which begin as the string says.
std::string weatherFrom(const std::string& first_day = "2001-06-04", int missing_row = -1) {
  std::string text =
      "time,air_C,wind_m_s,direct_normal_W_m2,diffuse_horizontal_W_m2,sky_longwave_W_m2\n";
  const Moment begin = readMoment(first_day + "T00:00:00Z", {"test", 0, "time"});
  for (int hour = 0; hour <= 8 * 24; ++hour) {
    const double sun = std::max(0.0, -std::cos((hour - 5) * 3.14159265358979 / 12));
    if (hour != missing_row)
      text += toString(begin.later(hour * 3600.0)) + ",20,2," + std::to_string(700 * sun) +
              "," + std::to_string(80 * sun) + ",320\n";
  }
  return text;
}
json plates() {
  const json wood{{"conductivity_W_m_K", 0.12},
                  {"density_kg_m3", 500},
                  {"specific_heat_J_kg_K", 1600},
                  {"thickness_m", 0.02},
                  {"solar_absorptance", 0.6}};
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {10000}}}},
      {"geometry",
       {{{"obj", "tilted.obj"}, {"material", "paint"}}, {{"ground", {{"material", "cold"}}}}}},
      {"materials",
       {{"paint", {{"model", "lambertian"}, {"reflectance", 0.1}, {"thermal", wood}}},
        {"cold", {{"model", "lambertian"}, {"reflectance", 0.05}, {"temperature_K", 280}}}}},
      {"sky", {{"model", "uniform"}, {"temperature_K", 270}}},
      {"heat",
       {{"weather", "june.csv"},
        {"latitude_deg", 43},
        {"longitude_deg", -77},
        {"time", "2001-06-09T14:00:00Z"},
        {"days_before", 2}}},
      {"sensor", {{"kind", "framing"}, {"width", 8}, {"height", 4}, {"field_of_view_deg", 40}}},
      {"platform",
       {{"path", "fixed"},
        {"position_m", {0, 0, 8}},
        {"look_at_m", {0, 0, 0}},
        {"frames", 3},
        {"interval_s", 14400}}},
      {"radiometry", {{"rays", {3, 2}}}}};
}
/// Two facets, one towards the east and one towards the west, and the weather.
struct Folder : Scratch {
  Folder() {
    put(path / "tilted.obj",
        "v 0 -1 1\nv 1 -1 0.2\nv 1 1 0.2\nv 0 1 1\nv -1 -1 0.2\nv -1 1 0.2\n"
        "g east\nf 1 2 3 4\ng west\nf 5 1 4 6\n");
    put(path / "june.csv", weatherFrom());
    put(path / "land.pgm", "P2 2 1 255\n 0 1\n");
  }
  Scene read(const json& scene) const { return readSceneText(scene.dump(), "s.json", path); }
  std::string complaint(const json& patch) const {
    json scene = plates();
    scene.merge_patch(patch);
    try {
      read(scene);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
};
void has(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}
}  // namespace

TEST(SceneHeatIdentity, EachFrameHasTheTemperaturesOfItsMoment) {
  const Folder folder;
  const Scene scene = folder.read(plates());
  ASSERT_TRUE(scene.heat);
  EXPECT_EQ(toString(*scene.begins), "2001-06-09T14:00:00Z");
  HeatingOptions by_hand{
      Weather::read(folder.path / "june.csv"), 43, -77, *scene.begins, 2, {}};
  by_hand.materials = {ThermalMaterial{{0.12, 500, 1600, 0.02}, 0.6, 0.9}, {}};
  const FacetTemperatures want(scene.world, *scene.tracer, by_hand, 8 * 3600);
  std::vector<double> east;
  for (std::size_t frame : {0, 1, 2}) {
    const Renderer renderer(scene, frame);
    for (std::uint32_t facet : {0, 1})
      EXPECT_NEAR(renderer.world().materials[0].glow(facet)->temperature_K(),
                  want.at(facet, 14400.0 * double(frame)), 1e-3);
    east.push_back(want.at(0, 14400.0 * double(frame)));
    EXPECT_EQ(renderer.world().materials[1].glow(2)->temperature_K(), 280);
    // the truth says the same
    const RenderedImage image = renderScene(scene, frame);
    for (const Radiometry::Truth& pixel : image.truth)
      if (pixel.material == 0)
        EXPECT_EQ(pixel.temperature_K, float(want.at(pixel.facet, 14400.0 * double(frame))));
      else
        EXPECT_EQ(pixel.temperature_K, 280);
  }
  EXPECT_GT(std::abs(east[0] - east[2]), 1);              // control: time passes
  EXPECT_GT(std::abs(want.at(0, 0) - want.at(1, 0)), 3);  // and sides differ
}

TEST(SceneHeatIdentity, TheSunsPlaceAndTimeServeTheWeather) {
  const Folder folder;
  json scene = plates();
  scene["sun"] = {{"latitude_deg", 43},
                  {"longitude_deg", -77},
                  {"time", "2001-06-09T14:00:00Z"},
                  {"irradiance_W_m2_nm", 0}};
  for (const char* key : {"latitude_deg", "longitude_deg", "time"}) scene["heat"].erase(key);
  const Scene sunny = folder.read(scene), other = folder.read(plates());
  EXPECT_EQ(sunny.heat->at(0, 3600), other.heat->at(0, 3600));
  // the sun moves and the facets are warmed in one frame
  const Renderer renderer(sunny, 2);
  EXPECT_EQ(renderer.world().materials[0].glow(0)->temperature_K(), sunny.heat->at(0, 28800));
  EXPECT_NE(renderer.world().sun->to_sun.x, sunny.world.sun->to_sun.x);
}

TEST(SceneHeatIdentity, WhatIsLeftOutFollowsFromTheBRDF) {
  const Folder folder;
  json scene = plates();
  EXPECT_NEAR(folder.read(scene).heating->materials[0]->longwave_emissivity, 0.9, 1e-9);
  scene["bands"]["wavelength_nm"] = {550, 10000};
  scene["materials"]["paint"]["reflectance"] = {{"wavelength_nm", {500, 600, 9000, 11000}},
                                                {"values", {0.3, 0.3, 0.2, 0.2}}};
  scene["materials"]["paint"]["thermal"].erase("solar_absorptance");
  const auto material = folder.read(scene).heating->materials[0];
  EXPECT_NEAR(material->solar_absorptance, 0.7, 1e-9);
  EXPECT_NEAR(material->longwave_emissivity, 0.8, 1e-9);
  scene["materials"]["paint"]["thermal"]["longwave_emissivity"] = 0.5;  // what is said counts
  EXPECT_EQ(folder.read(scene).heating->materials[0]->longwave_emissivity, 0.5);
}

TEST(SceneHeatIdentity, TheTruthCubeHasTheTemperature) {
  const Folder folder;
  put(folder.path / "s.json", plates().dump());
  const Outcome made = malusIn(folder.path, "render s.json --out out --write cube,truth");
  ASSERT_EQ(made.code, 0) << made.err;
  const Cube truth = readCube(folder.path / "out" / "s.0002.truth.img");
  ASSERT_EQ(truth.header.channels,
            (std::vector<std::string>{"facet", "material", "range m", "sun hidden",
                                      "temperature K", "rays"}));
  const Scene scene = readScene(folder.path / "s.json");
  int warm = 0;
  for (std::size_t pixel = 0; pixel < 32; ++pixel) {
    const float* numbers = &truth.data[pixel * 6];
    if (numbers[1] != 0) continue;
    EXPECT_EQ(numbers[4], float(scene.heat->at(std::size_t(numbers[0]), 28800)));
    ++warm;
  }
  EXPECT_GT(warm, 4);
  // control: a scene without weather has the five channels of before
  json cold = plates();
  cold.erase("heat");
  cold["materials"]["paint"].erase("thermal");
  put(folder.path / "c.json", cold.dump());
  ASSERT_EQ(malusIn(folder.path, "render c.json --out out --write cube,truth").code, 0);
  EXPECT_EQ(readCube(folder.path / "out" / "c.0000.truth.img").header.channels.size(), 5u);
}

TEST(SceneHeatRefusal, SaysWhatIsWrongAndWhatToDo) {
  const Folder folder;
  EXPECT_EQ(folder.complaint(json::object()), "accepted");  // control
  const auto paint = [](const json& patch) {
    return json{{"materials", {{"paint", {{"thermal", patch}}}}}};
  };
  has(folder.complaint({{"heat", nullptr}}), "materials.paint.thermal = {");
  has(folder.complaint({{"heat", nullptr}}),
      "needs weather to be heated; give the scene a \"heat\" with a weather file, or the "
      "material a temperature_K instead");
  has(folder.complaint({{"materials", {{"paint", {{"thermal", nullptr}}}}}}),
      "heats no material; give a material of a surface its \"thermal\"");
  has(folder.complaint({{"heat", {{"weather", "july.csv"}}}}), "july.csv");
  has(folder.complaint({{"heat", {{"time", nullptr}}}}),
      "lacks time; give latitude_deg, longitude_deg and time here or in the sun");
  has(folder.complaint({{"heat", {{"days_before", 30}}}}),
      "heat.weather = \"june.csv\": the weather goes from 2001-06-04T00:00:00Z to "
      "2001-06-12T00:00:00Z and has no 2001-05-10T14:00:00Z; give the weather from "
      "2001-05-10T14:00:00Z to 2001-06-09T22:00:00Z, or fewer days_before");
  has(folder.complaint({{"heat", {{"days_before", 0.5}}}}), "days_before = 0.5");
  has(folder.complaint({{"platform", {{"interval_s", 200000}}}}), "and has no 2001-06-14T");
  has(folder.complaint(paint({{"density_kg_m3", nullptr}})), "density_kg_m3");
  has(folder.complaint(paint({{"conductivity_W_m_K", -1}})), "conductivity_W_m_K = -1");
  has(folder.complaint(paint({{"thickness_m", nullptr}, {"back_temperature_K", 290}})),
      "is that of a back, which a half space does not have; give a thickness_m, or leave the "
      "temperature out");
  has(folder.complaint(paint({{"solar_absorptance", nullptr}})),
      "lacks solar_absorptance, and the scene's light (10000 nm) has no wavelength from 300 to "
      "2500 nm from which it would follow; give solar_absorptance, 0 to 1, or a grid_nm that "
      "reaches there");
  has(folder.complaint({{"materials", {{"paint", {{"temperature_K", 300}}}}}}),
      "conflicts with \"thermal\"; leave it out: the weather gives the temperature");
  has(folder.complaint({{"sun",
                         {{"latitude_deg", 43},
                          {"longitude_deg", -77},
                          {"time", "2001-06-09T14:00:00Z"},
                          {"irradiance_W_m2_nm", 0}}}}),
      "heat.latitude_deg = 43: is already given by the sun; leave it out here");
  // a map gives places and not facets their materials
  const auto mapped = [](const char* second) {
    return json{{"geometry",
                 {{{"obj", "tilted.obj"}, {"material", "paint"}},
                  {{"ground", {{"material", "land"}}}}}},
                {"maps",
                 {{"land",
                   {{"image", "land.pgm"},
                    {"over_m", {0, 0, 2, 1}},
                    {"materials", {{"0", "cold"}, {"1", second}}}}}}}};
  };
  EXPECT_EQ(folder.complaint(mapped("cold")), "accepted");
  has(folder.complaint(mapped("paint")),
      "is of a material that the map \"land\" selects, and the weather heats whole facets; "
      "give "
      "the material a temperature_K instead");
  // a gap in the file, which is named with the line that follows it
  put(folder.path / "june.csv", weatherFrom("2001-06-04", 30));
  has(folder.complaint(json::object()),
      "june.csv:32: time = 2001-06-05T07:00:00Z: comes 7200 s after");
  has(folder.complaint(json::object()), "fill in the missing rows, or cut the file at the gap");
}
