// Maps of scene files (nw/files/SceneMaps.nw) and their images (nw/files/ImageFiles.nw), from the text to the truth of a picture.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/ImageFiles.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using nlohmann::json;

namespace {
// four columns and three rows of codes, as a land-cover map has them
constexpr const char* codes = "P2 4 3 255\n 11 11 41 41\n 11 90 90 41\n 255 90 90 255\n";
constexpr int code_at[3][4] = {{11, 11, 41, 41}, {11, 90, 90, 41}, {255, 90, 90, 255}};

// A camera above the ground that sees a square metre in each of 4 x 3 pixels.
json landScene() {
  return json::parse(R"({
    "malus": 1, "bands": {"wavelength_nm": [550]},
    "geometry": [{"ground": {"material": "land"}}],
    "maps": {"land": {"image": "land.pgm", "pixels": [4, 3], "over_m": [0, 0, 4, 3],
             "materials": {"11": "water", "41": "wood", "90": "marsh", "255": "rock"}}},
    "materials": {"water": {"model": "lambertian", "reflectance": 0.1}, "wood": {"model": "lambertian", "reflectance": 0.2},
                  "marsh": {"model": "lambertian", "reflectance": 0.3}, "rock": {"model": "lambertian", "reflectance": 0.4}},
    "sun": {"to_sun": [0, 0, 1], "irradiance_W_m2_nm": 3.141592653589793, "half_angle_deg": 0},
    "sensor": {"kind": "framing", "width": 4, "height": 3, "focal_length_mm": 10, "pixel_pitch_um": 100},
    "platform": {"position_m": [2, 1.5, 100], "look": [0, 0, -1], "up": [0, 1, 0]},
    "radiometry": {"rays": [1]}})");
}

// A square metre in the plane x = 0 with texture coordinates, and one without, beside each other.
constexpr const char* squares =
    "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "o good\nusemtl picture\nf 1/1 2/2 3/3 4/4\no bare\nusemtl plain\nf 1 2 3\n";

struct Workplace {
  Scratch scratch;
  Workplace() {
    put(scratch / "land.pgm", codes);
    put(scratch / "squares.obj", squares);
  }
  Scene read(const json& scene) const {
    return readSceneText(scene.dump(), "s.json", scratch.path);
  }
  /// What the reader says, with the directory left out.
  std::string complaint(const json& scene) const {
    try {
      read(scene);
    } catch (const InputError& error) {
      std::string text = error.what();
      const std::string directory = scratch.path.string() + "/";
      for (std::size_t at = text.find(directory); at != text.npos; at = text.find(directory))
        text.erase(at, directory.size());
      return text;
    }
    return "";
  }
  std::string without(const json& scene, const std::string& pointer) const {
    json less = scene;
    const json::json_pointer at(pointer);
    less[at.parent_pointer()].erase(at.back());
    return complaint(less);
  }
  std::string with(json scene, const std::string& pointer, const json& value) const {
    scene[json::json_pointer(pointer)] = value;
    return complaint(scene);
  }
};

void expectIn(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

void expectLand(const Scene& scene) {
  const RenderedImage frame = renderScene(scene);
  const std::map<int, std::pair<std::string, double>> of{
      {11, {"water", 0.1}}, {41, {"wood", 0.2}}, {90, {"marsh", 0.3}}, {255, {"rock", 0.4}}};
  for (std::size_t y = 0; y < 3; ++y)
    for (std::size_t x = 0; x < 4; ++x) {
      const auto& [name, reflectance] = of.at(code_at[y][x]);
      const std::uint32_t material = frame.truth[y * 4 + x].material;
      EXPECT_EQ(scene.world.geometry.materialNames()[material], name) << x << ' ' << y;
      EXPECT_NEAR(frame.at(x, y)[0], reflectance, 1e-6);  // the cosine over the picture
    }
}

void write(const std::filesystem::path& path, const OIIO::ImageSpec& spec, const void* data,
           OIIO::TypeDesc type) {
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out && out->open(path.string(), spec) && out->write_image(type, data) &&
              out->close());
}
}  // namespace

TEST(MapsInScenesIdentity, TheTruthIsTheMaterialOfThePixel) {
  const Workplace place;
  const Scene scene = place.read(landScene());
  expectLand(scene);
  EXPECT_EQ(scene.files.size(), 1u) << "the image is one of the scene's files";
}

TEST(MapsInScenesIdentity, ByTextureCoordinatesAsWell) {
  const Workplace place;
  json scene = landScene();
  scene["geometry"] = {{{"obj", "squares.obj"}, {"materials", {{"picture", "land"}}}}};
  scene["materials"]["plain"] = scene["materials"]["rock"];
  scene["maps"]["land"].erase("over_m");
  // the bare triangle lies in the same plane: put it away
  put(place.scratch / "squares.obj",
      std::string(squares).substr(0, std::string(squares).find("o bare")));
  expectLand(place.read(scene));
}

// Half water, a quarter wood and marsh each: the mean over many rays.
TEST(MapsInScenesInvariant, AMixtureHasTheMeanOfItsParts) {
  const Workplace place;
  put(place.scratch / "mix.ppm", "P3 1 1 200\n100 50 50\n");
  json scene = landScene();
  scene["maps"]["land"] = {
      {"image", "mix.ppm"}, {"over_m", {0, 0, 1, 1}}, {"mixture", {"water", "wood", "marsh"}}};
  scene["sensor"]["samples_per_pixel"] = 256;
  const RenderedImage frame = renderScene(place.read(scene));
  double mean = 0;
  for (std::size_t i = 0; i < 12; ++i) mean += frame.at(i % 4, i / 4)[0] / 12;
  const double variance = 0.5 * 0.01 + 0.25 * 0.04 + 0.25 * 0.09 - 0.175 * 0.175;
  EXPECT_NEAR(mean, 0.175, 4 * std::sqrt(variance / (12 * 256)));
}

TEST(MapsInScenesIdentity, WhatIsWrongIsNamedWithItsRemedy) {
  const Workplace place;
  const json scene = landScene();
  ASSERT_EQ(place.complaint(scene), "");
  const auto expect = [&](const std::string& pointer, const json& value,
                          const std::string& part) {
    SCOPED_TRACE(pointer);
    expectIn(part, place.with(scene, pointer, value));
  };
  expect("/maps/land/image", "sea.pgm",
         "maps.land.image = \"sea.pgm\": does not exist; give the name of a file");
  expect("/maps/land/image", ".", "is a directory");
  expect("/maps/land/pixels", {64, 64},
         "maps.land.pixels = [64,64]: is not the size of land.pgm, which has 4 x 3 pixels; "
         "give the right image, or its real size");
  expect("/maps/land/over_m", {4, 0, 0, 3}, "has no area; give [west, south, east, north]");
  expect("/maps/land/beyond", "mirror", "beyond");
  expect("/maps/land/materials/x", "rock", "is not an index of an image; give whole numbers");
  expect("/maps/land/materials/90", "mash",
         "maps.land.materials.90 = \"mash\": is neither a material nor a map of the scene; did "
         "you mean");
  expect("/maps/land/mixture", {"water", "rock"},
         "does not specify the meaning of the image's values exactly once; give one of "
         "materials, "
         "mixture");
  expect("/maps/rock", scene["maps"]["land"], "is also the name of a material; give the map");
  expect("/maps/land/materials/90", "land", "refers back to itself");
  expectIn(
      "land.pgm: column 1, row 1 has the index 90, which names no material; give the material "
      "of each index that the image contains",
      place.without(scene, "/maps/land/materials/90"));
  expect("/materials/rock", {{"model", "pane"}, {"n", 1.5}},
         "selects \"rock\", which is clear; give clear materials their own surfaces");
  expectIn("lacks \"image\"", place.without(scene, "/maps/land/image"));
  expectIn(
      "lies over the facet \"ground\", which has no texture coordinates; write the mesh with",
      place.without(scene, "/maps/land/over_m"));
}

TEST(MapsInScenesIdentity, FactorsOfAGreyImageAndOfColours) {
  const Workplace place;
  put(place.scratch / "grey.pgm", "P2 1 1 255\n51\n");
  put(place.scratch / "rgb.ppm", "P3 1 1 255\n255 102 0\n");
  json scene = landScene();
  scene["bands"]["wavelength_nm"] = {500, 600};
  scene["maps"]["land"] = {
      {"image", "grey.pgm"},
      {"over_m", {0, 0, 1, 1}},
      {"reflectance_factor", {{"material", "rock"}, {"range", {0.5, 1.5}}}}};
  RenderedImage frame = renderScene(place.read(scene));
  EXPECT_NEAR(frame.at(2, 1, 0)[0], 0.4 * 0.7, 1e-6);
  EXPECT_NEAR(frame.at(2, 1, 1)[0], 0.4 * 0.7, 1e-6);
  scene["maps"]["land"]["image"] = "rgb.ppm";
  scene["maps"]["land"]["reflectance_factor"] = {{"material", "rock"},
                                                 {"wavelength_nm", {700, 550, 450}}};
  frame = renderScene(place.read(scene));
  EXPECT_NEAR(frame.at(2, 1, 0)[0], 0.4 * 0.2, 1e-6)
      << "half way from 0.4 at 550 nm to 0 at 450";
  EXPECT_NEAR(frame.at(2, 1, 1)[0], 0.4 * (0.4 + 0.6 / 3), 1e-6);
}

TEST(MapsInScenesIdentity, FactorsThatNoSurfaceCanHave) {
  const Workplace place;
  put(place.scratch / "one.pgm", "P2 1 1 1\n1\n");
  put(place.scratch / "rgb.ppm", "P3 1 1 255\n255 102 0\n");
  json scene = landScene();
  scene["maps"]["land"] = {{"image", "one.pgm"},
                           {"over_m", {0, 0, 1, 1}},
                           {"reflectance_factor", {{"material", "rock"}, {"range", {0, 2.4}}}}};
  EXPECT_EQ(place.complaint(scene), "") << "0.96 of the light";
  const std::string factor = "/maps/land/reflectance_factor";
  expectIn(
      "reaches the factor 3, with which \"rock\" reflects 1.200 of light at 0 deg and 550 nm; "
      "give a range that ends lower",
      place.with(scene, factor + "/range", {0, 3}));
  expectIn("reflectance_factor.range[1] = -1: is not allowed here; give a factor, 0 to 1e9",
           place.with(scene, factor + "/range", {0, -1}));
  json colours = scene;
  colours["maps"]["land"]["image"] = "rgb.ppm";
  expectIn("has 0 wavelengths, and rgb.ppm has 3 channels; give", place.complaint(colours));
  expectIn("does not reach 550 nm, which the bands need",
           place.with(colours, factor + "/wavelength_nm", {500, 450, 400}));
  json twice = scene;
  twice["maps"]["top"] = scene["maps"]["land"];
  twice["maps"]["top"]["reflectance_factor"]["material"] = "land";
  twice["geometry"][0]["ground"]["material"] = "top";
  expectIn("lies over another map of factors, land", place.complaint(twice));
  // glossy surfaces reflect nearly all light at grazing angles
  scene["materials"]["rock"] = {
      {"model", "torrance-sparrow"}, {"n", 1.5}, {"k", 0}, {"sigma", 0.1}};
  expectIn("with which \"rock\" reflects", place.complaint(scene));
}

// A quarter of the way from 0.1 to 0.3 with three levels: half of the rays see 0.1, half 0.2.
TEST(MapsInScenesInvariant, AParameterIsDrawnBetweenItsLevels) {
  const Workplace place;
  put(place.scratch / "quarter.pgm", "P2 1 1 4\n1\n");
  json scene = landScene();
  scene["maps"]["land"] = {
      {"image", "quarter.pgm"},
      {"over_m", {0, 0, 1, 1}},
      {"parameter",
       {{"material", "rock"}, {"name", "reflectance"}, {"range", {0.1, 0.3}}, {"levels", 3}}}};
  scene["sensor"]["samples_per_pixel"] = 256;
  const Scene read = place.read(scene);
  const RenderedImage frame = renderScene(read);
  double mean = 0;
  for (std::size_t i = 0; i < 12; ++i) mean += frame.at(i % 4, i / 4)[0] / 12;
  EXPECT_NEAR(mean, 0.15, 4 * 0.05 / std::sqrt(12 * 256.0));
  const std::string& name = read.world.geometry.materialNames()[frame.truth[0].material];
  EXPECT_TRUE(name == "land[reflectance=0.1]" || name == "land[reflectance=0.2]") << name;
  const std::string parameter = "/maps/land/parameter";
  expectIn("is not a parameter of lambertian",
           place.with(scene, parameter + "/name", "roughness"));
  expectIn("is a single value; give two that differ",
           place.with(scene, parameter + "/range", {1, 1}));
  expectIn("is a map and has no parameters",
           place.with(scene, parameter + "/material", "land"));
}

TEST(MapsInScenesIdentity, ATemperatureOfAnImage) {
  const Workplace place;
  put(place.scratch / "warm.pgm", "P2 2 1 1\n0 1\n");
  json scene = landScene();
  scene.erase("sun");
  scene["bands"]["wavelength_nm"] = {10000};
  scene["maps"]["land"] = {{"image", "warm.pgm"},
                           {"over_m", {0, 0, 2, 1}},
                           {"parameter",
                            {{"material", "rock"},
                             {"name", "temperature_K"},
                             {"range", {280, 320}},
                             {"levels", 5}}}};
  const Scene read = place.read(scene);
  ASSERT_EQ(read.world.materials.size(), 6u);
  for (std::size_t level = 0; level < 5; ++level) {
    EXPECT_EQ(read.world.materials[1 + level].emission->temperature_K(),
              280 + 10.0 * double(level));
    EXPECT_EQ(read.world.materials[1 + level].brdf, read.world.materials[1].brdf) << "shared";
  }
}

// What the chapter says about sixteen levels: facets of copper between sigma = 0.1 and 0.4, in the brightest direction.
TEST(MapsInScenesInvariant, SixteenLevelsOfRoughnessAreEnough) {
  const SpectralGridPtr grid = SpectralGrid::make({600.0});
  const auto f = [&](double sigma) {
    const auto all = [&](double value) { return CDSpectralVector<double>(grid, value); };
    const BRDFTorranceSparrow copper(all(0.405), all(2.95), all(sigma), {});
    return copper.getBRDF(BRDFGeometry::fromDegrees(30, 30, 180))[0].getScalar();
  };
  const auto error = [&](std::size_t levels) {
    const double step = 0.3 / double(levels - 1);
    double worst = 0;
    for (std::size_t i = 0; i + 1 < levels; ++i) {
      const double low = 0.1 + step * double(i), between = 0.5 * (f(low) + f(low + step));
      worst = std::max(worst, std::abs(between - f(low + 0.5 * step)) / f(0.1));
    }
    return worst;
  };
  EXPECT_LT(error(16), 0.03);
  EXPECT_GT(error(4), 0.1);
}

TEST(MapsInScenesIdentity, HeightsAndSmoothMeshes) {
  const Workplace place;
  put(place.scratch / "ramp.pgm", "P2 4 1 255\n0 85 170 255\n");
  json scene = landScene();
  scene["maps"]["land"] = {{"image", "ramp.pgm"},
                           {"over_m", {0, 0, 4, 3}},
                           {"beyond", "edge"},
                           {"height", {{"material", "rock"}, {"range_m", {0, 0.3}}}}};
  scene["sun"]["to_sun"] = {-1, 0, 1};
  const RenderedImage frame = renderScene(place.read(scene));
  // a rise of 0.1 m in a metre towards the east, lit from the west
  const double ramp = (0.1 + 1) / std::sqrt(1.01 * 2), flat = std::sqrt(0.5);
  EXPECT_NEAR(frame.at(1, 1)[0], 0.4 * ramp, 1e-4);
  EXPECT_GT(ramp, 1.05 * flat) << "the control";
  EXPECT_NE(place.without(scene, "/maps/land/height/range_m"), "");

  const std::string leaning =
      "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nvn -0.1 0 1\nf 1//1 2//1 3//1 4//1\n";
  put(place.scratch / "leaning.obj", leaning);
  json mesh = landScene();
  mesh.erase("maps");
  mesh["sun"] = scene["sun"];
  mesh["geometry"] = {{{"obj", "leaning.obj"}, {"material", "rock"}}};
  const Scene flat_one = place.read(mesh);
  ASSERT_EQ(flat_one.notices.size(), 1u);
  expectIn("write \"smooth\": true", flat_one.notices[0]);
  EXPECT_NEAR(renderScene(flat_one).at(1, 1)[0], 0.4 * flat, 1e-4);
  mesh["geometry"][0]["smooth"] = true;
  const Scene smooth = place.read(mesh);
  EXPECT_TRUE(smooth.notices.empty());
  EXPECT_NEAR(renderScene(smooth).at(1, 1)[0], 0.4 * ramp, 1e-4);
  mesh["geometry"][0]["obj"] = "squares.obj";
  expectIn("has no normals of corners; write the mesh with normals", place.complaint(mesh));
}

TEST(MapsInScenesIdentity, AMeshWithoutTextureCoordinates) {
  const Workplace place;
  json scene = landScene();
  scene["geometry"] = {{{"obj", "squares.obj"}, {"material", "land"}}};
  scene["maps"]["land"].erase("over_m");
  expectIn("maps.land = ", place.complaint(scene));
  expectIn("lies over the facet \"bare\", which has no texture coordinates",
           place.complaint(scene));
}

TEST(MapsInScenesIdentity, ImagesThatAreNone) {
  const Workplace place;
  json scene = landScene();
  put(place.scratch / "text.png", "no picture");
  put(place.scratch / "cut.pgm", "P5 400 300 255\nxxxx");
  put(place.scratch / "rgb.ppm", "P3 1 1 255\n1 2 3\n");
  scene["maps"]["land"].erase("pixels");
  for (const char* name : {"text.png", "cut.pgm"})
    expectIn(fmt::format("{}: cannot be read as an image: ", name),
             place.with(scene, "/maps/land/image", name));
  expectIn("rgb.ppm has 1 x 1 pixels of 3 channels, and the map needs 1",
           place.with(scene, "/maps/land/image", "rgb.ppm"));
}

TEST(ImageFilesIdentity, NumbersComeAsTheyWereWritten) {
  const Scratch scratch;
  const std::vector<unsigned char> bytes{0, 1, 127, 128, 254, 255};
  const std::vector<std::uint16_t> words{0, 1, 255, 256, 65534, 65535};
  const std::vector<float> floats{-1, 0, 1e-6f, 0.5f, 300, 1e20f};
  write(scratch / "b.png", {3, 2, 1, OIIO::TypeDesc::UINT8}, bytes.data(),
        OIIO::TypeDesc::UINT8);
  write(scratch / "w.tif", {3, 2, 1, OIIO::TypeDesc::UINT16}, words.data(),
        OIIO::TypeDesc::UINT16);
  write(scratch / "f.exr", {3, 2, 1, OIIO::TypeDesc::FLOAT}, floats.data(),
        OIIO::TypeDesc::FLOAT);
  const MapImage b = readImage(scratch / "b.png"), w = readImage(scratch / "w.tif"),
                 f = readImage(scratch / "f.exr");
  EXPECT_EQ(b.stored_one, 255);
  EXPECT_EQ(w.stored_one, 65535);
  EXPECT_EQ(f.stored_one, 1);
  ASSERT_EQ(b.width * b.height * b.channels, 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(b.values[i] * b.stored_one, bytes[i], 1e-4);
    EXPECT_NEAR(w.values[i] * w.stored_one, words[i], 1e-2);
    EXPECT_EQ(f.values[i], floats[i]);
  }
  put(scratch / "bits.pbm", "P1 3 1\n1 0 1\n");
  const MapImage bits = readImage(scratch / "bits.pbm");
  EXPECT_EQ(bits.width, 3u);
  // transparency is a channel like any other
  const std::vector<unsigned char> clear{200, 100, 50, 0};
  write(scratch / "a.png", {1, 1, 4, OIIO::TypeDesc::UINT8}, clear.data(),
        OIIO::TypeDesc::UINT8);
  EXPECT_NEAR(readImage(scratch / "a.png").values[0] * 255, 200, 1e-4);
}
