// The town of scenes/town.py, a small one: noon and night, in visible light and at 10 um, of one scene (nw/thesis/XWorlds.nw,
// nw/air/DayAndNightSky.nw).
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "Program.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/FacetTemperatures.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using nlohmann::json;

namespace {
constexpr int blue = 0, red = 2, infrared = 3;
constexpr double night_s = 12 * 3600;

Scene makeSmallTown() {
  const Scratch scratch;
  const std::filesystem::path& folder = scratch.path;
  const std::string script =
      std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/town.py";
  EXPECT_EQ(runIn(folder, "'" + script + "' --triangles 2e7 --out .").code, 0);
  json scene = json::parse(contents(folder / "town.json"), nullptr, true, true);
  scene["sensor"]["width"] = 24, scene["sensor"]["height"] = 16;
  scene["heat"]["days_before"] = 1;
  put(folder / "small.json", scene.dump());
  return readScene(folder / "small.json");
}
const Scene& smallTown() {
  static const Scene scene = makeSmallTown();
  return scene;
}
/// S0 of the row's mean.
double rowMean(const RenderedImage& image, std::size_t row, std::size_t band) {
  double sum = 0;
  for (std::size_t x = 0; x < image.width; ++x) sum += image.at(x, row)[4 * band];
  return sum / static_cast<double>(image.width);
}
}  // namespace

TEST(TownInvariant, NoonAndNightOfOneScene) {
  const Scene& scene = smallTown();
  EXPECT_GT(scene.world.geometry.instances().size(), 1000u);
  const std::array<RenderedImage, 2> pictures{renderScene(scene, 0), renderScene(scene, 1)};
  const std::size_t bottom = pictures[0].height - 1;
  for (const std::size_t row : {std::size_t{0}, bottom}) {
    EXPECT_GT(rowMean(pictures[0], row, red), 1e-3) << row;
    EXPECT_LT(rowMean(pictures[1], row, red), 1e-20) << row;  // what 290 K emit at 650 nm
    EXPECT_GT(rowMean(pictures[1], row, infrared), 1e-3) << row;
  }
  EXPECT_GT(rowMean(pictures[0], 0, blue), 2 * rowMean(pictures[0], 0, red));        // the sky
  EXPECT_LT(rowMean(pictures[0], bottom, blue), rowMean(pictures[0], bottom, red));  // a wall
  // the sky at 10 um is the same day and night, but for the sun's millionth; the surfaces below
  // are not
  EXPECT_NEAR(rowMean(pictures[1], 0, infrared) / rowMean(pictures[0], 0, infrared), 1, 1e-3);
  EXPECT_LT(rowMean(pictures[1], bottom, infrared),
            0.95 * rowMean(pictures[0], bottom, infrared));
}

TEST(TownInvariant, TheWeatherHeatsIt) {
  const Scene& scene = smallTown();
  ASSERT_TRUE(scene.heat);
  std::map<std::string, std::array<double, 2>> kelvin;  // noon, night
  for (std::size_t i = 0; i < scene.heat->parts().size(); ++i) {
    const std::string& facet = scene.world.geometry.facetNames()[scene.heat->parts()[i].facet];
    kelvin[facet] = {scene.heat->at(i, 0), scene.heat->at(i, night_s)};
  }
  const double noon_K = scene.heating->weather.at(*scene.begins).air_K,
               night_K = scene.heating->weather.at(scene.begins->later(night_s)).air_K;
  for (const char* facet : {"house.roof", "car-black-lacquer.body", "streets"}) {
    ASSERT_TRUE(kelvin.contains(facet)) << facet;
    EXPECT_GT(kelvin[facet][0], noon_K + 5) << facet;
    EXPECT_GT(kelvin[facet][0], kelvin[facet][1] + 15) << facet;
  }
  EXPECT_LT(kelvin["house.roof"][1], night_K);  // it radiates into the sky, and
  EXPECT_GT(kelvin["streets"][1], night_K);     // this stores the day's heat
  EXPECT_GT(kelvin["car-black-lacquer.body"][0], kelvin["car-white-lacquer.body"][0] + 3);
  for (const auto& [facet, at] : kelvin)
    for (const double K : at) EXPECT_TRUE(K > 270 && K < 350) << facet << ' ' << K;
}
