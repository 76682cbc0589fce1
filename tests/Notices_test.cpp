// Messages about a scene before it is rendered: defaults, notices and refusals of sensors and
// samplings
// (nw/files/SceneReader.nw, nw/app/CommandRender.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "Program.hpp"
#include "malus/app/CommandRender.hpp"
#include "malus/app/SceneDescription.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/render/Scene.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const std::string scenes =
    std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";

json pushbroomScene() {
  std::ifstream file(scenes + "flight-pushbroom.json");
  json scene = json::parse(file, nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  return scene;
}
json plate(const json& material, const json& radiometry) {
  json scene = {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {550}}}},
      {"geometry", {{{"ground", {{"z_m", 0}, {"material", "plate"}}}}}},
      {"materials", {{"plate", material}}},
      {"sky", {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 1}}},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 2}}},
      {"platform", {{"position_m", {0, -5, 10}}, {"look_at_m", {0, 0, 0}}}}};
  if (!radiometry.is_null()) scene["radiometry"] = radiometry;
  return scene;
}
const json card = {{"model", "lambertian"}, {"reflectance", 1}};
json glass(double sigma) {
  return {{"model", "torrance-sparrow"},
          {"n", 1.5},
          {"k", 0},
          {"sigma", sigma},
          {"diffuse", "none"}};
}
Scene sceneOf(const json& scene) { return readSceneText(scene.dump(), "s.json", "."); }
std::string complaint(const json& scene) {
  try {
    sceneOf(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
void expectIn(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

// Mean pixel of each chunk in a picture, rightwards and upwards from its middle.
std::map<char, std::pair<double, double>> chunksOf(const Scene& scene) {
  const RenderedImage frame = renderScene(scene);
  std::map<char, std::pair<double, double>> middle;
  std::map<char, int> pixels;
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const std::uint32_t facet = frame.truth[i].facet;
    if (facet == Hit::nothing) continue;
    const std::string& name = scene.world.geometry.facetNames()[facet];
    if (name.find('.') == std::string::npos) continue;
    auto& [right, up] = middle[name[0]];
    right += double(i % frame.width) - double(frame.width) / 2;
    up += double(frame.height) / 2 - double(i / frame.width);
    ++pixels[name[0]];
  }
  for (auto& [chunk, at] : middle) at.first /= pixels[chunk], at.second /= pixels[chunk];
  return middle;
}
}  // namespace

// The same chunks in the same corners as a camera sees them that hangs over the middle of the flight.
TEST(NoticesIdentity, ThePushbroomSceneIsAMap) {
  json scan = pushbroomScene();
  scan["radiometry"] = {{"rays", {2}}};
  json still = scan;
  still["sensor"]["kind"] = "framing", still["sensor"].erase("row_time_s");
  for (const json& up : {json{1, 1, 0}, json{-1, -1, 0}}) {
    scan["platform"]["up"] = up;
    still["platform"] = {{"position_m", {0, 0, 60}}, {"look", {0, 0, -1}}, {"up", up}};
    const auto seen = chunksOf(sceneOf(scan)), map = chunksOf(sceneOf(still));
    ASSERT_EQ(map.size(), 4u);
    ASSERT_EQ(seen.size(), 4u);
    double mirrored = 0;
    for (const auto& [chunk, at] : map) {
      // the framing camera sees the north of a chunk's side from 60 m, the pushbroom sees it from above: a pixel
      EXPECT_NEAR(seen.at(chunk).first, at.first, 2) << chunk;
      EXPECT_NEAR(seen.at(chunk).second, at.second, 2) << chunk;
      mirrored = std::max(mirrored, std::abs(seen.at(chunk).second + at.second));
    }
    EXPECT_GT(mirrored, 10) << "negative control: rows in the other order";
  }
  scan["platform"].erase("up");
  const Pose pose = sceneOf(scan).platform.at(0);
  EXPECT_NEAR(pose.up.x, std::sqrt(0.5), 1e-4) << "without an up, the flight's direction";
  EXPECT_NEAR(pose.up.y, std::sqrt(0.5), 1e-4);
}

TEST(NoticesIdentity, AnUpThatSmearsIsRefusedWithTheRemedy) {
  json scene = pushbroomScene();
  scene["platform"]["up"] = {1, -1, 0};
  expectIn("platform = ", complaint(scene));
  expectIn("moves 90.0 deg off the image's vertical, along the rows", complaint(scene));
  expectIn("give \"up\": [0.707", complaint(scene));
  scene["platform"]["up"] = {0, 1, 0.2};
  EXPECT_EQ(complaint(scene), "") << "45 degrees lean and do not smear";
  expectIn("the flight is 45.0 deg off the picture's vertical", sceneOf(scene).notices.at(0));
  scene["platform"]["up"] = {1, 1, 0};
  EXPECT_TRUE(sceneOf(scene).notices.empty());
  scene["platform"] = {{"position_m", {0, 0, 60}}, {"look", {0, 0, -1}}};
  expectIn("does not move across the view", complaint(scene));
  scene["platform"] = {{"path", "staring"},
                       {"start_m", {-4, 0, 60}},
                       {"velocity_m_s", {7, 0, 0}},
                       {"target_m", {0, 0, 0}},
                       {"up", {1, 0, 0}}};
  expectIn("platform.path = \"staring\": keeps a sensor", complaint(scene));
}

// A list of poses is one flight; the rows must not outlast it.
TEST(NoticesIdentity, PosesMakeOnePictureOfAScanner) {
  json scene = pushbroomScene();
  const auto pose = [](double x, double t) -> json {
    return {{"position_m", {x, 0, 60}}, {"look", {0, 0, -1}}, {"up", {1, 0, 0}}, {"time_s", t}};
  };
  scene["platform"] = {{"poses", {pose(-6, 0), pose(6, 1.2)}}};
  EXPECT_EQ(sceneOf(scene).platform.frames(), 1u);
  EXPECT_NEAR(sceneOf(scene).sensor.rowMotion(sceneOf(scene).platform, 0).up, 11.9, 1e-9);
  scene["platform"] = {{"poses", {pose(-6, 0), pose(6, 1)}}};
  expectIn("platform.poses = ", complaint(scene));
  expectIn("last 1 s, and 120 rows of 0.01 s each take 1.19 s", complaint(scene));
}

TEST(NoticesIdentity, ASceneThatNamesNoSamplingHasImportance) {
  const Scene scene = sceneOf(plate(card, {}));
  EXPECT_EQ(scene.radiometry.sampling, Sampling::importance);
  EXPECT_EQ(scene.radiometry.rays, (std::vector{33, 3, 2}));
  EXPECT_TRUE(scene.notices.empty());
  EXPECT_NEAR(renderScene(scene).at(1, 1)[0], 1, 1e-6) << "a white card under a sky of one";
  expectIn(
      "rays      importance, seed 1; 3 reflections are followed: 32, 2, 1 from each hit in "
      "turn\n",
      describeScene(scene));
  json sunny = plate(card, {{"rays", {16}}});
  sunny["sun"] = {{"zenith_deg", 30}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}};
  expectIn("1 reflection is followed: 15 and the sun from a hit\n",
           describeScene(sceneOf(sunny)));
}

// The thesis's grid with 91 rays has five zeniths: pi / cos(9 deg), 1.2 % too much; one zenith is 41 %.
TEST(NoticesIdentity, ABiasedGridIsReportedOnce) {
  const auto notices = [](const json& material, const json& radiometry) {
    return sceneOf(plate(material, radiometry)).notices;
  };
  const auto rotated = [](const json& rays) -> json {
    return {{"sampling", "grid-rotated"}, {"rays", rays}};
  };
  ASSERT_EQ(notices(card, rotated({91})).size(), 1u);
  expectIn(
      "grid-rotated with 90 directions from hit 1 shows 1.2 % too much of \"plate\" under an "
      "even sky",
      notices(card, rotated({91}))[0]);
  expectIn("choose \"sampling\": \"importance\" or more rays", notices(card, rotated({91}))[0]);
  expectIn("1 directions from hit 2 shows 41.4 % too much",
           notices(card, rotated({91, 2})).at(0));
  expectIn("all reflections together may be off by 43.2 %",
           notices(card, rotated({91, 2})).at(0));
  EXPECT_TRUE(notices(card, rotated({129})).empty()) << "six zeniths: 0.9 %";
  EXPECT_TRUE(notices(card, rotated({91, 1})).size() == 1);
  EXPECT_TRUE(notices(card, {{"sampling", "random"}, {"rays", {2}}}).empty());
  EXPECT_TRUE(notices(glass(0.001), {{"sampling", "importance"}, {"rays", {2}}}).empty());
}

TEST(NoticesIdentity, SettingsOfAGridBelongToAGrid) {
  const auto said = [](const json& radiometry) { return complaint(plate(card, radiometry)); };
  const json grid = {{"sampling", "grid"},
                     {"rays", {91}},
                     {"max_zenith_deg", 80},
                     {"zeniths", 6},
                     {"deviation", 0.5}};
  EXPECT_EQ(said(grid), "");
  const RadiometryOptions options = sceneOf(plate(card, grid)).radiometry;
  EXPECT_DOUBLE_EQ(options.max_zenith_rad, 80 * std::numbers::pi / 180);
  EXPECT_EQ(options.zeniths, 6u);
  EXPECT_EQ(options.deviation, 0.5);
  expectIn(
      "radiometry.zeniths = 6: has no effect with this sampling; leave it out, or name a grid",
      said({{"sampling", "random"}, {"zeniths", 6}}));
  expectIn("radiometry.deviation = 1: has no effect",
           said({{"sampling", "adaptive"}, {"deviation", 1}}));
  expectIn(
      "radiometry.max_zenith_deg = 80: has no effect with this sampling; leave it out, or "
      "name another sampling",
      said({{"max_zenith_deg", 80}}));
  expectIn(
      "radiometry.rays[1] = 4: leaves 3 directions beside the one to the sun, too few for 6 "
      "zeniths; give more rays",
      said({{"sampling", "grid"}, {"rays", {91, 4}}, {"zeniths", 6}}));
  expectIn("radiometry.max_zenith_deg = 91",
           said({{"sampling", "grid"}, {"max_zenith_deg", 91}}));
  expectIn("radiometry.deviation = 2", said({{"sampling", "grid"}, {"deviation", 2}}));
  ASSERT_EQ(sceneOf(plate(card, grid)).notices.size(), 1u) << "sin^2 80 deg: 3 % are lost";
}

TEST(NoticesIdentity, ALobeThatCannotBeSeenIsRefused) {
  for (const char* sampling : {"random", "grid", "grid-rotated", "adaptive"}) {
    const std::string said = complaint(plate(glass(1e-3), {{"sampling", sampling}}));
    expectIn("radiometry.sampling = \"" + std::string(sampling) +
                 "\": cannot see the narrow lobe of \"plate\" with 32 directions; choose "
                 "\"sampling\": \"importance\"",
             said);
    EXPECT_EQ(complaint(plate(glass(0.2), {{"sampling", sampling}})), "");
  }
  EXPECT_EQ(complaint(plate(glass(1e-6), {{"sampling", "importance"}})), "");
}

TEST(NoticesIdentity, TooManyReflectionsAreToldHowManyThereMayBe) {
  const std::string said = complaint(plate(card, {{"rays", std::vector<int>(17, 2)}}));
  expectIn(
      "has 17 entries, and 16 are allowed; give a list of 1 to 16 numbers, one for each "
      "reflection that is followed",
      said);
  EXPECT_EQ(complaint(plate(card, {{"rays", std::vector<int>(16, 2)}})), "");
}

// Normals equal to the facets' normals change nothing and give no notice.
TEST(NoticesIdentity, NormalsThatAreNotUsedAreReported) {
  const Scratch scratch;
  const auto mesh = [&](const std::string& normals) {
    put(scratch / "tent.obj", "usemtl plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\n" + normals);
    json scene = plate(card, {});
    scene["geometry"] = {{{"obj", (scratch / "tent.obj").string()}}};
    scene["platform"]["look_at_m"] = {0.6, 0.3, 0};
    return sceneOf(scene).notices;
  };
  const auto smooth = mesh("vn 0 0 2\nvn 0.3 0 1\nvn 0 0.3 1\nf 1//1 2//2 -1//-1\n");
  ASSERT_EQ(smooth.size(), 1u);
  expectIn("tent.obj: 2 corners have a normal other than their facet's", smooth[0]);
  EXPECT_TRUE(mesh("vn 0 0 2\nf 1//1 2//1 3//1\n").empty());
  EXPECT_TRUE(mesh("vn 0.3 0 1\nf 1 2 3\n").empty()) << "named by no corner";
}

// On the error stream once, in the dry run, and in the record.
TEST(NoticesIdentity, ARunSaysItAndRecordsIt) {
  const Scratch scratch;
  put(scratch / "s.json", plate(card, {{"sampling", "grid"}, {"rays", {9, 1}}}).dump());
  const std::string note = "grid with 8 directions from hit 1 shows 41.4 % too much";
  const Outcome dry = malusIn(scratch.path, "render s.json --dry-run");
  expectIn("note      " + note, dry.out);
  expectIn("sky       uniform", dry.out);
  const Outcome run = malusIn(scratch.path, "render s.json --out a");
  EXPECT_EQ(run.code, 0) << run.err;
  expectIn("malus: note: " + note, run.err);
  EXPECT_EQ(run.err.find(note), run.err.rfind(note)) << "once";
  const json record = json::parse(contents(scratch / "a/s.run.json"));
  expectIn(note, record.at("notices").at(0).get<std::string>());
  EXPECT_EQ(record.at("reflections_followed"), 2);
  json lit = plate(card, {});
  lit.erase("sky");
  lit["sun"] = {{"zenith_deg", 30}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}};
  put(scratch / "s.json", lit.dump());
  expectIn("sky       black sky\n", malusIn(scratch.path, "render s.json --dry-run").out);
}
