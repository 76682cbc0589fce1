// What is measured on pictures of scenes (nw/thesis/Pictures.nw).
#include "malus/thesis/Pictures.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "Items.hpp"
#include "Program.hpp"
#include "malus/files/Cube.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/render/Scene.hpp"

using namespace malus;

namespace {
/// 6 x 5 pixels: a facet "top" of 4 x 3 in a frame of "ground", S0 = 1.
StokesImage framed() {
  StokesImage image{6, 5, {}, std::vector<std::uint32_t>(30, 0), {"ground", "top"}};
  for (auto& plane : image.stokes) plane.assign(30, 0);
  image.stokes[0].assign(30, 1);
  for (int y = 1; y < 4; ++y)
    for (int x = 1; x < 5; ++x) image.facet[y * 6 + x] = 1;
  return image;
}
}  // namespace

TEST(PicturesIdentity, TheInsideOfAFacetHasNoRim) {
  StokesImage image = framed();
  EXPECT_EQ(insideOf(image, "top"), (Pixels{14, 15}));  // the middle row without its ends
  EXPECT_TRUE(insideOf(image, "ground").empty());       // nowhere two pixels thick
  EXPECT_EQ(insideOf(image, [](const std::string&) { return true; }), (Pixels{14, 15}));
  image.facet[7] = 0;  // negative control: a corner of the facet is gone
  EXPECT_EQ(insideOf(image, "top"), Pixels{15});
  image.facet.assign(30, StokesImage::nothing);
  EXPECT_TRUE(insideOf(image, [](const std::string&) { return true; }).empty());
}

TEST(PicturesIdentity, MeansAndErrorsByHand) {
  const std::vector<double> values{1, 2, 3, 9}, reference{1, 2, 3, 4};
  EXPECT_EQ(meanOver(values, {0, 1, 2}), 2);
  EXPECT_EQ(rmsDifference(values, reference, {0, 1, 2}), 0);
  EXPECT_NEAR(rmsDifference(values, reference, {0, 3}), 5 / std::sqrt(2.0), 1e-15);
  EXPECT_TRUE(std::isnan(meanOver(values, {})));
  StokesImage noisy = framed();
  EXPECT_EQ(relativeError(noisy, framed()), 0);
  noisy.stokes[0][3] = 4;  // negative control: 3 off in one pixel of 30, mean 1
  EXPECT_NEAR(relativeError(noisy, framed()), 3 / std::sqrt(30.0), 1e-15);
}

TEST(PicturesIdentity, SpecklesAndHotSpotsAreCounted) {
  const std::vector<double> reference(6, 1.0), values{1, 1.05, 1.5, 0.4, 1, 30};
  const Pixels all{0, 1, 2, 3, 4, 5}, dark{0, 1, 4};
  const Speckles speckles = specklesOf(values, reference, all, 0.1);
  EXPECT_EQ(speckles.count, 3u);
  EXPECT_NEAR(speckles.magnitude, (0.5 + 0.6 + 29) / 3, 1e-14);
  EXPECT_EQ(hotSpots(values, reference, all, 10), 1u);
  EXPECT_EQ(specklesOf(values, reference, dark, 0.1).count, 0u);  // negative control
  EXPECT_EQ(specklesOf(values, reference, dark, 0.1).magnitude, 0);
}

TEST(PicturesIdentity, ShadesAndStretch) {
  const std::vector<double> ramp{0, 1 / 255., 1 / 255. + 1e-4, 1, 7, -3};
  EXPECT_EQ(shadesOfGrey(ramp, {0, 1, 2, 3, 4, 5}, 0, 1),
            3u);  // 0, 1 and 255; outside is cut off
  EXPECT_EQ(shadesOfGrey(ramp, {0, 1, 2, 3, 4, 5}, -3, 7), 4u);
  std::vector<double> flat(1000, 0.5);
  flat[17] = 1e6;  // a hot spot does not set the stretch
  EXPECT_EQ(stretchEnd({&flat}), 0.5);
  EXPECT_EQ(stretchEnd({&flat}, 0), 1e6);
}

TEST(PicturesIdentity, DegreeOfPolarisationOfEachPixel) {
  StokesImage image = framed();
  image.stokes[1][2] = 0.3, image.stokes[2][2] = -0.4, image.stokes[0][4] = 0;
  const std::vector<double> degree = image.dolp();
  EXPECT_NEAR(degree[2], 0.5, 1e-15);
  EXPECT_EQ(degree[3], 0);
  EXPECT_EQ(degree[4], 0);  // no light
}

TEST(PicturesInvariant, PanelsBecomeTwoTablesAndAPicture) {
  Item item("F0", "nowhere", "validation");
  const StokesImage image = framed();
  drawPanels(item, "images", image.width,
             {{"a", image.stokes[0], 0, 1}, {"b", image.stokes[1], -1, 1, "signed"}}, 2, "W",
             "two panels");
  ASSERT_EQ(item.tables().size(), 2u);
  EXPECT_EQ(item.tables()[0].second.rows(), 2u);
  EXPECT_EQ(item.tables()[1].second.rows(), 30u);
  EXPECT_EQ(item.pictures().front().script, "images");
}

namespace {
/// What `malus render scenes/NAME.json` writes with the size that the figures have.
Cube renderedFromOutside(const Scratch& scratch, const std::string& name, int pixels,
                         const std::string& arguments = "") {
  std::filesystem::copy(scenesDirectory(), scratch.path,
                        std::filesystem::copy_options::recursive |
                            std::filesystem::copy_options::overwrite_existing);
  const std::string file = name + ".json";
  nlohmann::json scene = nlohmann::json::parse(contents(scratch / file), nullptr, true, true);
  scene["sensor"]["width"] = scene["sensor"]["height"] = pixels;
  scene["sensor"]["pixel_pitch_um"] = 10000.0 / pixels;
  put(scratch / file, scene.dump());
  const Outcome run = malusIn(scratch.path, "render " + file + " --out out " + arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scratch / "out")) {
    const std::string found = entry.path().filename().string();
    if (found.ends_with(".img") && found.find("truth") == std::string::npos)
      return readCube(entry.path());
  }
  throw std::runtime_error("malus render left no cube");
}

/// Values of a cube that are not, to the bit, those of the pictures in single precision.
std::size_t differentBits(const Cube& cube, const std::vector<StokesImage>& bands) {
  std::size_t different = 0;
  const std::size_t channels = 4 * bands.size();
  for (std::size_t pixel = 0; pixel < bands[0].size(); ++pixel)
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const auto ours = static_cast<float>(bands[channel / 4].stokes[channel % 4][pixel]);
      different += std::memcmp(&cube.data[pixel * channels + channel], &ours, sizeof ours) != 0;
    }
  return different;
}
}  // namespace

// The chapters draw what the user's program makes of the same file: one scene of each kind, the moving ones
// in a frame that is not the first.
TEST(PicturesInvariant, AnItemsPictureIsWhatMalusRenderMakes) {
  struct Case {
    const char* name;
    std::size_t frame;
  };
  for (const auto& [name, frame] : {Case{"chunky-bar-lambertian", 0},
                                    {"chunky-bar-copper", 0},
                                    {"chunky-bar-sky", 0},
                                    {"flight-nadir", 6},
                                    {"flight-staring", 1},
                                    {"rochester-day", 9}}) {
    const Scratch scratch;
    const Scene scene = chunkyScene(name, 48);
    const std::string frames =
        scene.platform.frames() > 1 ? fmt::format("--frames {0}:{0}", frame) : "";
    const Cube cube = renderedFromOutside(scratch, name, 48, frames);
    const std::vector<StokesImage> bands = renderBands(scene, frame);
    ASSERT_EQ(cube.data.size(), 48 * 48 * 4 * bands.size()) << name;
    EXPECT_EQ(differentBits(cube, bands), 0u) << name;
    Scene other = scene;  // negative control
    other.radiometry.seed = 2;
    EXPECT_GT(differentBits(cube, renderBands(other, frame)), 0u) << name;
  }
}

TEST(PicturesInvariant, APlateIsWhatMalusRenderMakes) {
  const Scratch scratch;
  const Outcome run =
      malusIn(scratch.path,
              "render '" + (scenesDirectory() / "flat-plate.json").string() + "' --out out");
  ASSERT_EQ(run.code, 0) << run.err;
  const Cube cube = readCube(scratch / "out/flat-plate.img");
  const Scene scene = shippedScene("flat-plate");
  ASSERT_EQ(cube.data.size(), 128 * 128 * 4u);
  EXPECT_EQ(differentBits(cube, renderBands(scene)), 0u);
  const Scene rougher =  // negative control
      shippedScene("flat-plate", R"({"materials": {"plate": {"sigma": 0.21}}})");
  EXPECT_GT(differentBits(cube, renderBands(rougher)), 0u);
}

TEST(PicturesIdentity, APatchChangesASceneAndNothingElse) {
  const Scene scene = chunkyScene("chunky-bar-copper", 32),
              patched =
                  chunkyScene("chunky-bar-copper", 32, R"({"radiometry": {"rays": [7]}})");
  EXPECT_EQ(patched.radiometry.rays, std::vector<int>{7});
  EXPECT_NE(scene.radiometry.rays, patched.radiometry.rays);
  EXPECT_EQ(patched.sensor.geometry().width, 32u);
  EXPECT_EQ(patched.radiometry.seed, scene.radiometry.seed);
  // ten metres of ground from fifteen metres, whatever the number of pixels
  for (const int pixels : {32, 128, 256})
    EXPECT_NEAR(
        pixels / chunkyScene("chunky-bar-copper", pixels).sensor.geometry().focal_length_px,
        10.0 / 15, 1e-12);
  EXPECT_THROW(chunkyScene("chunky-bar-copper", 32, R"({"sensr": {}})"), InputError);
  EXPECT_THROW(shippedScene("no-such-scene"), InputError);
}

TEST(PicturesIdentity, TopsAndSidesAreToldByName) {
  std::array<int, 3> found{};
  const Scene scene = chunkyScene("chunky-bar-copper", 16);
  for (const std::string& facet : scene.world.geometry.facetNames())
    ++found[isTop(facet) ? 0 : isSide(facet) ? 1 : 2];
  EXPECT_EQ(found, (std::array{4, 16, 1}));  // four chunks of five faces, and the ground
  EXPECT_FALSE(isOfChunks("1"));             // negative control
  for (const char* top : chunk_tops) EXPECT_TRUE(isTop(top) && !isSide(top) && isOfChunks(top));
}

namespace {
const std::vector<std::string> scenes_with_mirrors{"varnish", "copper-bowl", "canyon"};

Scene small(const std::string& name, nlohmann::json patch = {}) {
  patch["sensor"]["width"] = patch["sensor"]["height"] = 32;
  return shippedScene(name, patch.dump());
}
}  // namespace

// Sun and sky reach every surface in sight, and no light is polarised more than wholly (gathered in single precision).
TEST(PicturesInvariant, SurfacesOfScenesWithMirrorsAreLit) {
  for (const std::string& name : scenes_with_mirrors) {
    Scene scene = small(name);
    std::size_t surfaces = 0, polarized = 0;
    for (const StokesImage& band : renderBands(scene))
      for (std::size_t i = 0; i < band.size(); ++i) {
        if (band.facet[i] == StokesImage::nothing) continue;
        const double s0 = band.stokes[0][i],
                     part = std::hypot(band.stokes[1][i], band.stokes[2][i], band.stokes[3][i]);
        ASSERT_GT(s0, 0) << name << " " << i;
        ASSERT_LE(part, s0 * (1 + 1e-5)) << name << " " << i;
        ++surfaces, polarized += part > 0.05 * s0;
      }
    EXPECT_GT(surfaces, 1000u) << name;
    EXPECT_GT(polarized, surfaces / 20) << name;
    scene.world.sun.reset(), scene.world.sky = blackSky(scene.world.grid);
    const StokesImage night = renderImage(scene);
    EXPECT_EQ(*std::ranges::max_element(night.stokes[0]), 0) << "negative control, " << name;
  }
}

// What the bowl gathers on the floor: the brightest place of it against the floor as a whole. The control's bowl is matt.
TEST(PicturesInvariant, TheCausticOfTheBowlIsBrighterThanTheFloorBeside) {
  const auto contrast = [](nlohmann::json patch) {
    patch["radiometry"] = {{"rays", {513, 1}}};
    const StokesImage picture = renderImage(small("copper-bowl", patch));
    std::vector<double> floor;
    for (const std::size_t pixel : insideOf(picture, "floor"))
      floor.push_back(picture.stokes[0][pixel]);
    std::ranges::sort(floor);
    // the mean of the brightest five, against the median
    return std::accumulate(floor.end() - 5, floor.end(), 0.0) / 5 / floor[floor.size() / 2];
  };
  EXPECT_GT(contrast({}), 2);
  nlohmann::json matt{{"model", "lambertian"}, {"reflectance", 0.9}};
  for (const char* key : {"optical_constants", "sigma"}) matt[key] = nullptr;
  EXPECT_LT(contrast({{"materials", {{"copper", matt}}}}), 1.5) << "negative control";
}
