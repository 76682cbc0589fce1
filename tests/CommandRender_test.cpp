// malus render from outside (nw/program/CommandRender.nw), and what it says of bad scenes (nw/program/Scene.nw,
// SceneSchema.nw, SceneMaterials.nw).
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "Program.hpp"
#include "imaging/CDImage.hpp"
#include "program/Render.hpp"
#include "program/SceneSchema.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const std::string scenes = std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";

/// A small chunky bar, cheap and yet with two bounces.
json smallScene(int side = 40, int rays = 9) {
  std::ifstream file(scenes + "chunky-bar-copper.json");
  json scene = json::parse(file, nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  scene["sensor"] = {{"kind", "framing"}, {"width", side}, {"height", side - 7}, {"field_of_view_deg", 36.87}};
  scene["radiometry"] = {{"rays", {rays, 2}}, {"seed", 5}};
  return scene;
}

struct Workplace {
  Scratch scratch;
  explicit Workplace(const json& scene) { put(scratch / "s.json", scene.dump(1)); }
  Outcome render(const std::string& arguments) const { return malusIn(scratch.path, "render s.json " + arguments); }
  std::string file(const std::string& name) const { return contents(scratch / name); }
};

/// Starts a render in one thread, waits until some tiles are in its journal, sends a signal; returns waitpid's status.
int interrupt(const Workplace& place, int signal) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chdir(place.scratch.path.c_str()) != 0) ::_exit(3);
    (void)!::freopen("err", "w", stderr);
    ::execl(MALUS_PROGRAM, MALUS_PROGRAM, "render", "s.json", "--threads", "1", "--out", "b", nullptr);
    ::_exit(3);
  }
  const auto tiles = [&] {
    const std::string journal = place.file("b/s.truth.img.tiles");
    return std::count(journal.begin(), journal.end(), '\n');
  };
  int status = 0;
  while (tiles() < 4) {
    if (::waitpid(child, &status, WNOHANG) != 0) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, signal);
  ::waitpid(child, &status, 0);
  return status;
}
}  // namespace

TEST(CommandRenderInvariant, ThePictureIsTheSameBitsForOneThreadAndForThree) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  ASSERT_EQ(place.render("--threads 3 --out b").code, 0);
  ASSERT_FALSE(place.file("a/s.img").empty());
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
  EXPECT_EQ(place.file("a/s.img.hdr"), place.file("b/s.img.hdr"));
}

TEST(CommandRenderInvariant, NegativeControlAnotherSeedIsAnotherPicture) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  ASSERT_EQ(place.render("--out b --seed 6").code, 0);
  EXPECT_NE(place.file("a/s.img"), place.file("b/s.img"));
}

TEST(CommandRenderInvariant, PartsAreTheVeryPixelsOfTheWhole) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  ASSERT_EQ(place.render("--out a --tile 5,3,29,20").code, 0);
  const CDCube whole = readCube(place.scratch / "a/s.img"), part = readCube(place.scratch / "a/s.5-3-29-20.img");
  ASSERT_EQ(part.header.width, 24u);
  ASSERT_EQ(part.header.height, 17u);
  for (std::size_t y = 0; y < 17; ++y)
    for (std::size_t x = 0; x < 24; ++x)
      for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(part.at(x, y, c), whole.at(x + 5, y + 3, c));
}

TEST(CommandRenderInvariant, InMemoryAndOnDiskAreTheSamePicture) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  const CDCube cube = readCube(place.scratch / "a/s.img");
  const CDFrame frame = renderScene(readScene(place.scratch / "s.json"));
  for (std::size_t y = 0; y < frame.height; ++y)
    for (std::size_t x = 0; x < frame.width; ++x)
      for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(cube.at(x, y, c), static_cast<float>(frame.at(x, y)[c]));
}

TEST(CommandRenderInvariant, AKilledRenderIsResumedToTheSameBits) {
  const Workplace place(smallScene(160, 60));
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  const int status = interrupt(place, SIGKILL);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the render ended before it could be killed";
  ASSERT_FALSE(std::filesystem::exists(place.scratch / "b/s.img"));
  const Outcome resumed = place.render("--out b --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "b/s.img.tiles"));
}

TEST(CommandRenderIdentity, CtrlCSaysHowToGoOnAndTheRestGivesTheSameBits) {
  const Workplace place(smallScene(160, 60));
  ASSERT_EQ(place.render("--out a").code, 0);
  const int status = interrupt(place, SIGINT);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string said = place.file("err");
  EXPECT_NE(said.find("stopped at"), std::string::npos) << said;
  EXPECT_NE(said.find("malus render s.json --out b --resume goes on from here"), std::string::npos) << said;
  ASSERT_EQ(place.render("--out b --resume").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
}

TEST(CommandRenderIdentity, AResumeUnderAnotherSeedIsRefused) {
  const Workplace place(smallScene(160, 60));
  ASSERT_TRUE(WIFSIGNALED(interrupt(place, SIGKILL)));
  const Outcome other = place.render("--out b --resume --seed 77");
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("belongs to another cube"), std::string::npos) << other.err;
}

TEST(CommandRenderIdentity, ADryRunWritesNothing) {
  const Workplace place(smallScene());
  const Outcome outcome = place.render("--dry-run --out a");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("picture   40 x 33 pixels"), std::string::npos) << outcome.out;
  EXPECT_EQ(filesBelow(place.scratch.path), 1u);
}

TEST(CommandRenderIdentity, TheRunIsWrittenDown) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  const json info = json::parse(place.file("a/s.run.json"));
  EXPECT_EQ(info["command"], "malus render s.json --out a");
  EXPECT_EQ(info["seed"], 5);
  EXPECT_EQ(info["unphysical_values"], 0);
  EXPECT_GT(info["rays_followed"], 40 * 33);
  for (const char* name : {"a/s.exr", "a/s.S0.png", "a/s.DoLP.png", "a/s.truth.img.hdr"})
    EXPECT_TRUE(std::filesystem::exists(place.scratch / name)) << name;
}

namespace {
struct BadScene {
  std::string patch;    // of the small scene
  std::string expected;  // what the message must contain
};

const std::vector<BadScene> bad_scenes{
    {R"({"skyy": 1})", "skyy: is not a known key here; did you mean sky?"},
    {R"({"sensor": {"widht": 3}})", "sensor.widht: is not a known key here; did you mean width?"},
    {R"({"radiometry": {"sampling": "gird"}})", "radiometry.sampling = \"gird\": is not allowed here; did you mean grid?"},
    {R"({"platform": null})", "lacks \"platform\"; give where the sensor stands"},
    {R"({"geometry": [{"obj": "missing.obj"}]})", "missing.obj"},
    {R"({"geometry": [{"obj": "nan.obj"}]})", "nan.obj"},
    {R"({"geometry": []})", "geometry = []: is not allowed here"},
    {R"({"sensor": {"width": 0}})", "sensor.width = 0: is not allowed here; give a whole number, 1 or more"},
    {R"({"sensor": {"height": -4}})", "sensor.height = -4: is not allowed here"},
    {R"({"sensor": {"field_of_view_deg": 180}})", "sensor.field_of_view_deg = 180: is not allowed here"},
    {R"({"sensor": {"pixel_pitch_um": 5}})", "does not say in one way what it sees"},
    {R"({"platform": {"position_m": [-2, 2, 0.5]}})", "the camera of frame 0 stands inside of a solid"},
    {R"({"platform": {"look_at_m": [0, 0, 30]}})", "the camera looks at nothing"},
    {R"({"platform": {"look_at_m": [0, 0, 15]}})", "platform = "},
    {R"({"materials": {"ground": {"reflectance": {"wavelength_nm": [400, 500], "values": [0.1, 0.2]}}}})", "550"},
    {R"({"materials": {"ground": {"reflectance": {"file": "missing.csv", "column": "r"}}}})", "missing.csv"},
    {R"({"materials": {"ground": {"reflectance": 1.2}}})", "materials.ground.reflectance = 1.2: must be 0 to 1"},
    {R"({"materials": {"ground": {"sigma": 0.2}}})", "is no parameter of lambertian"},
    {R"({"materials": {"copper-010": {"sigma": null}}})", "lacks \"sigma\"; give roughness"},
    {R"({"materials": {"copper-010": {"model": "torrence-sparow"}}})", "did you mean torrance-sparrow?"},
    {R"({"materials": {"ground": null}})", "lacks the material \"ground\" of a surface"},
    {R"({"sky": {"radiance_W_m2_sr_nm": -0.05}})", "sky.radiance_W_m2_sr_nm = -0.05: is not allowed here; give a number that is not negative"},
    {R"({"sun": {"irradiance_W_m2_nm": -1}})", "sun.irradiance_W_m2_nm = -1: is not allowed here"},
    {R"({"sun": null, "sky": null})", "has no light"},
    {R"({"sun": {"irradiance_W_m2_nm": 0}, "sky": {"radiance_W_m2_sr_nm": 0}})", "has no light"},
    {R"({"sun": {"time": "2001-06-10T17:06:00Z"}})", "does not say in one way where the sun stands"},
    {R"({"bands": {"wavelength_nm": [550, 450]}})", "bands"},
    {R"({"bands": {"wavelength_nm": [-550]}})", "bands.wavelength_nm[0] = -550: is not allowed here; give"},
    {R"({"malus": 2})", "malus = 2: is not allowed here; give the version of the scene format, 1"},
    {R"({"radiometry": {"rays": [0]}})", "radiometry.rays[0] = 0: is not allowed here"},
};
}  // namespace

TEST(CommandRenderIdentity, EveryBadSceneIsAnsweredByOneLineAndNoFile) {
  for (const BadScene& bad : bad_scenes) {
    json scene = smallScene();
    scene.merge_patch(json::parse(bad.patch));
    const Workplace place(scene);
    put(place.scratch / "nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    const Outcome outcome = place.render("--out a");
    EXPECT_EQ(outcome.code, 2) << bad.patch << '\n' << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(bad.expected), std::string::npos) << bad.patch << '\n' << outcome.err;
    EXPECT_NE(outcome.err.find("; "), std::string::npos) << "no remedy: " << outcome.err;
    EXPECT_EQ(filesBelow(place.scratch.path), 2u) << bad.patch;
  }
}

TEST(CommandRenderIdentity, NegativeControlTheGoodSceneIsNotRefused) {
  const Outcome outcome = Workplace(smallScene()).render("--dry-run");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
}

TEST(CommandRenderIdentity, AMistakeIsToldWithLineAndColumn) {
  const Scratch scratch;
  json scene = smallScene();
  scene["sensor"]["samples_per_pixel"] = 0;
  put(scratch / "s.json", scene.dump(1));
  const std::string text = contents(scratch / "s.json");
  const std::size_t at = text.find("\"samples_per_pixel\": ") + 21;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t column = at - text.rfind('\n', at);
  const Outcome outcome = malusIn(scratch.path, "render s.json");
  EXPECT_TRUE(outcome.err.starts_with("s.json:" + std::to_string(line) + ':' + std::to_string(column) + ": "))
      << outcome.err;
}

TEST(CommandRenderIdentity, BadFlagsAreAnsweredByOneLineAndNoFile) {
  const Workplace place(smallScene());
  for (const char* flags : {"--tile 0,0,41,10", "--tile 5,5,5,9", "--tile 1,2,3", "--frames 1:2", "--frames x",
                            "--seed -1", "--threads -2", "--out /proc/nowhere"}) {
    const Outcome outcome = place.render(flags);
    EXPECT_EQ(outcome.code, 2) << flags << '\n' << outcome.err;
    EXPECT_EQ(filesBelow(place.scratch.path), 1u) << flags;
  }
}

// A file of limited size stands for a full disk: the same system call fails.
TEST(CommandRenderIdentity, AFullDiskIsToldBeforeTheFirstRayAndLeavesNothing) {
  const Workplace place(smallScene(400));
  const Outcome outcome =
      runIn(place.scratch.path, "ulimit -f 20; trap '' XFSZ; '" MALUS_PROGRAM "' render s.json --out a");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("cannot be written"), std::string::npos) << outcome.err;
  EXPECT_EQ(filesBelow(place.scratch.path), 1u);
}

TEST(SceneIdentity, AllScenesThatShipWithMalusAreGood) {
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json" || entry.path().stem() == "parking-lot") continue;  // its mesh is generated
    ++found;
    EXPECT_NO_THROW(readScene(entry.path())) << entry.path();
  }
  EXPECT_GE(found, 6u);
}

TEST(SceneIdentity, ASunWithATimeMovesWithTheFrames) {
  const CDScene day = readScene(scenes + "rochester-day.json");
  ASSERT_TRUE(day.move_sun);
  CDWorld moved = day.world;
  day.move_sun(moved, 6 * 3600);
  EXPECT_LT(moved.sun->to_sun.getZenith(), day.world.sun->to_sun.getZenith());
  EXPECT_LT(moved.sun->to_sun.y, 0);  // in the south at one o'clock of summer time
}

TEST(SceneIdentity, EveryPartOfTheSchemaIsDescribedForTheMessages) {
  const std::function<void(const json&, const std::string&)> visit = [&](const json& schema, const std::string& path) {
    if (schema.contains("$ref")) return;
    if (path != "") {
      EXPECT_TRUE(schema.contains("description")) << path;
    }
    if (schema.contains("properties"))
      for (const auto& [key, value] : schema["properties"].items()) visit(value, path + '/' + key);
    if (schema.contains("properties")) {
      EXPECT_EQ(schema.value("additionalProperties", json(true)), false) << path;
    }
  };
  visit(sceneSchema(), "");
  for (const auto& [key, value] : sceneSchema()["definitions"].items()) visit(value, key);
}

TEST(SceneIdentity, BroadBandsAreMixedFromTheGridOfLight) {
  json scene = smallScene();
  scene["bands"] = json::parse(R"([{"center_nm": 500, "fwhm_nm": 20, "response": "gaussian"},
      {"center_nm": 600, "response": {"wavelength_nm": [590, 600, 610], "values": [0, 1, 0]}}])");
  // A light that rises evenly over wavelength has at each symmetric band's centre the mean over the band.
  scene["sky"]["radiance_W_m2_sr_nm"] = json::parse(R"({"wavelength_nm": [400, 700], "values": [0.4, 0.7]})");
  scene["sun"] = nullptr;
  scene["materials"]["ground"]["reflectance"] = 0.5;
  scene["geometry"] = json::parse(R"([{"ground": {"material": "ground"}}])");
  scene["radiometry"]["rays"] = {40};
  scene.erase("sun");
  const CDScene read = readSceneText(scene.dump(), "s.json", ".");
  const CDFrame frame = renderScene(read, 0, {1, CDTile{3, 3, 4, 4}, nullptr});
  ASSERT_EQ(frame.bands, 2u);
  // The forty rays see cos(theta) summed a few per cent off; a narrow band at a known radiance says by how much.
  scene["bands"] = {{"wavelength_nm", {500}}};
  const CDFrame narrow =
      renderScene(readSceneText(scene.dump(), "s.json", "."), 0, {1, CDTile{3, 3, 4, 4}, nullptr});
  const double per_radiance = narrow.at(0, 0)[0] / 0.5, rounding = 1e-12;  // of averages over a dozen wavelengths
  EXPECT_NEAR(frame.at(0, 0, 0)[0] / per_radiance, 0.5, rounding);
  EXPECT_NEAR(frame.at(0, 0, 1)[0] / per_radiance, 0.6, rounding);
  EXPECT_GT(std::abs(frame.at(0, 0, 1)[0] / per_radiance - 0.5), rounding);  // the other band's value would be seen
}
