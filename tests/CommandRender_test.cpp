// malus render from outside (nw/app/CommandRender.nw), and what it says of bad scenes (nw/files/SceneReader.nw,
// SceneSchema.nw, SceneMaterials.nw); its tiles (nw/render/Tile.nw,
// nw/render/Renderer.nw, nw/render/Scene.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "Memory.hpp"
#include "Program.hpp"
#include "malus/app/RenderNeeds.hpp"
#include "malus/app/RenderPlan.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/files/SceneSchema.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/render/Scene.hpp"
#include "malus/render/Tile.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const std::string scenes =
    std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";

/// A small chunky bar, cheap and yet with two bounces.
json smallScene(int side = 40, int rays = 9) {
  std::ifstream file(scenes + "chunky-bar-copper.json");
  json scene = json::parse(file, nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  scene["sensor"] = {
      {"kind", "framing"}, {"width", side}, {"height", side - 7}, {"field_of_view_deg", 36.87}};
  scene["radiometry"] = {{"rays", {rays, 2}}, {"seed", 5}};
  return scene;
}

struct Workplace {
  Scratch scratch;
  explicit Workplace(const json& scene) { put(scratch / "s.json", scene.dump(1)); }
  Outcome render(const std::string& arguments) const {
    return malusIn(scratch.path, "render s.json " + arguments);
  }
  std::string file(const std::string& name) const { return contents(scratch / name); }
};

/// Starts a render in one thread, waits until some tiles are in its journal, sends a signal; returns waitpid's status.
int interrupt(const Workplace& place, int signal, const std::string& picture = "s") {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chdir(place.scratch.path.c_str()) != 0) ::_exit(3);
    (void)!::freopen("err", "w", stderr);
    ::execl(MALUS_PROGRAM, MALUS_PROGRAM, "render", "s.json", "--threads", "1", "--out", "b",
            nullptr);
    ::_exit(3);
  }
  const auto tiles = [&] {
    const std::string journal = place.file("b/" + picture + ".truth.img.tiles");
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
  const Outcome three = place.render("--threads 3 --out b");
  ASSERT_EQ(three.code, 0);
  EXPECT_EQ(std::count(three.err.begin(), three.err.end(), '\n'), 2)
      << three.err;  // no warning
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
  ASSERT_EQ(place.render("--out a --part 5,3,29,20").code, 0);
  const Cube whole = readCube(place.scratch / "a/s.img"),
             part = readCube(place.scratch / "a/s.5-3-29-20.img");
  ASSERT_EQ(part.header.width, 24u);
  ASSERT_EQ(part.header.height, 17u);
  for (std::size_t y = 0; y < 17; ++y)
    for (std::size_t x = 0; x < 24; ++x)
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_EQ(part.at(x, y, c), whole.at(x + 5, y + 3, c));
}

TEST(CommandRenderInvariant, InMemoryAndOnDiskAreTheSamePicture) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  const Cube cube = readCube(place.scratch / "a/s.img");
  const RenderedImage frame = renderScene(readScene(place.scratch / "s.json"));
  for (std::size_t y = 0; y < frame.height; ++y)
    for (std::size_t x = 0; x < frame.width; ++x)
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_EQ(cube.at(x, y, c), static_cast<float>(frame.at(x, y)[c]));
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
  EXPECT_NE(said.find("malus render s.json --out b --resume continues from here"),
            std::string::npos)
      << said;
  ASSERT_EQ(place.render("--out b --resume").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
}

// A bar that drives through the second picture: killed there, resumed, in parts, by other threads.
TEST(MovingThingsInvariant, FramesAreTheSameBitsForThreadsPartsAndResumes) {
  json scene = smallScene(120, 30);
  json bar = scene["geometry"][0];
  bar["facet_prefix"] = "bus.", bar["shared"] = true, bar["path"] = "bus.csv";
  scene["geometry"].push_back(bar);
  const auto poses = [](double second_s) {
    json pose{{"position_m", {0, 0, 15}}, {"look_at_m", {0, 0, 0}}, {"up", {0, 1, 0}}};
    json later = pose;
    pose["time_s"] = 0, later["time_s"] = second_s;
    return json{{"poses", {pose, later}}};
  };
  scene["platform"] = poses(1);
  const Workplace place(scene);
  const std::string path = "time_s,x_m,y_m,z_m,heading_deg\n0,4,-3,0,0\n2,4,3,0,90\n";
  put(place.scratch / "bus.csv", path);
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  ASSERT_TRUE(WIFSIGNALED(interrupt(place, SIGKILL, "s.0001")));
  put(place.scratch / "bus.csv", path + "3,5,3,0,90\n");
  EXPECT_EQ(place.render("--out b --resume").code, 2) << "along another path";
  put(place.scratch / "bus.csv", path);
  ASSERT_EQ(place.render("--out b --resume --threads 3").code, 0);
  for (const char* part : {"0,0,37,113", "37,0,120,80", "37,80,120,113"})
    ASSERT_EQ(place.render(std::string("--out c --part ") + part).code, 0);
  ASSERT_EQ(malusIn(place.scratch.path, "merge c").code, 0);
  for (const char* name :
       {"s.0000.img", "s.0000.truth.img", "s.0001.img", "s.0001.truth.img"}) {
    const std::string whole = place.file(std::string("a/") + name);
    ASSERT_FALSE(whole.empty());
    EXPECT_EQ(whole, place.file(std::string("b/") + name)) << name;
    EXPECT_EQ(whole, place.file(std::string("c/") + name)) << name;
  }
  EXPECT_NE(place.file("a/s.0000.truth.img"), place.file("a/s.0001.truth.img"));  // it moved
  scene["platform"] = poses(1.1);                                                 // control
  put(place.scratch / "s.json", scene.dump(1));
  ASSERT_EQ(place.render("--out d").code, 0);
  EXPECT_EQ(place.file("a/s.0000.img"), place.file("d/s.0000.img"));
  EXPECT_NE(place.file("a/s.0001.img"), place.file("d/s.0001.img"));
}

TEST(CommandRenderIdentity, AResumeUnderAnotherSeedIsRefused) {
  const Workplace place(smallScene(160, 60));
  ASSERT_TRUE(WIFSIGNALED(interrupt(place, SIGKILL)));
  const Outcome other = place.render("--out b --resume --seed 77");
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("belongs to a cube other than"), std::string::npos) << other.err;
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
  std::string patch;     // of the small scene
  std::string expected;  // what the message must contain
};

const std::vector<BadScene> bad_scenes{
    {R"({"skyy": 1})", "skyy: is not a known key here; did you mean sky?"},
    {R"({"sensor": {"widht": 3}})",
     "sensor.widht: is not a known key here; did you mean width?"},
    {R"({"radiometry": {"sampling": "gird"}})",
     "radiometry.sampling = \"gird\": is not allowed here; did you mean grid?"},
    {R"({"platform": null})", "lacks \"platform\"; give the position of the sensor"},
    {R"({"geometry": [{"obj": "missing.obj"}]})",
     "geometry[0].obj = \"missing.obj\": does not exist; give the name of a file; relative "
     "paths begin "
     "in "},
    {R"({"geometry": [{"obj": "nan.obj"}]})", "nan.obj"},
    {R"({"geometry": []})", "geometry = []: is not allowed here"},
    {R"({"sensor": {"width": 0}})",
     "sensor.width = 0: is not allowed here; give a whole number, 1 to 2147483648"},
    {R"({"sensor": {"height": -4}})", "sensor.height = -4: is not allowed here"},
    {R"({"sensor": {"field_of_view_deg": 180}})",
     "sensor.field_of_view_deg = 180 deg: is not allowed here"},
    {R"({"sensor": {"pixel_pitch_um": 5}})", "does not specify its field of view exactly once"},
    {R"({"platform": {"position_m": [-2, 2, 0.5]}})",
     "the camera of frame 0 is inside a solid"},
    {R"({"platform": {"position_m": [0, 9, -1]}})",
     "the camera of frame 0 is at z = -1 m, on or below the ground"},
    {R"({"platform": {"position_m": [0, 9, 0], "up": [0, 0, 1]}})",
     "the camera of frame 0 is at z = 0 m, on or below"},
    {R"({"platform": {"look_at_m": [0, 0, 30]}, "sky": null})",
     "the camera looks at nothing but a black sky"},
    {R"({"platform": {"look_at_m": [0, 0, 15]}})", "platform = "},
    {R"({"materials": {"ground": {"reflectance": {"wavelength_nm": [400, 500], "values": [0.1, 0.2]}}}})",
     "550"},
    {R"({"materials": {"ground": {"reflectance": {"file": "missing.csv", "column": "r"}}}})",
     "missing.csv"},
    {R"({"materials": {"ground": {"reflectance": 1.2}}})",
     "materials.ground.reflectance = 1.2: must be 0 to 1"},
    {R"({"materials": {"ground": {"sigma": 0.2}}})", "is not a parameter of lambertian"},
    {R"({"materials": {"copper-010": {"sigma": null}}})", "lacks \"sigma\"; give roughness"},
    {R"({"materials": {"copper-010": {"model": "torrence-sparow"}}})",
     "did you mean torrance-sparrow?"},
    {R"({"materials": {"ground": null}})", "lacks the material \"ground\" of a surface"},
    {R"({"sky": {"radiance_W_m2_sr_nm": -0.05}})",
     "sky.radiance_W_m2_sr_nm = -0.05 W/(m^2 sr nm): must be 0 to 1e+12; give radiance"},
    {R"({"sun": {"irradiance_W_m2_nm": -1}})",
     "sun.irradiance_W_m2_nm = -1 W/(m^2 nm): is not allowed here"},
    {R"({"sun": null, "sky": null})", "has no light"},
    {R"({"sun": null, "sky": null, "materials": {"ground": {"temperature_K": 0}}})",
     "has no light"},
    {R"({"materials": {"ground": {"temperature_K": -1}}})",
     "materials.ground.temperature_K = -1 K: is not allowed here; give a temperature in K, 0 "
     "to "
     "100000"},
    {R"({"materials": {"ground": {"temperature_K": "hot"}}})", "give a temperature in K"},
    {R"({"materials": {"ground": {"model": "beard-maxwell", "reflectance": null, "n": 1.304, "k": 7.479,
         "bias": 0.03, "sigma": 0.17, "temperature_K": 300}}})",
     "which leaves no emissivity; leave it out"},
    {R"({"sky": {"temperature_K": 230}})", "does not specify its radiance exactly once"},
    {R"({"sun": {"irradiance_W_m2_nm": 0}, "sky": {"radiance_W_m2_sr_nm": 0}})",
     "has no light"},
    {R"({"sun": {"time": "2001-06-10T17:06:00Z"}})",
     "does not specify the sun's position exactly once"},
    {R"({"bands": {"wavelength_nm": [450, 550, 450]}})",
     "bands = {\"wavelength_nm\":[450,550,450]}: has the same band at 450 nm twice"},
    {R"({"bands": {"wavelength_nm": [-550]}})",
     "bands.wavelength_nm[0] = -550 nm: is not allowed here; give"},
    {R"({"malus": 2})",
     "malus = 2: is not allowed here; give the version of the scene format, 1"},
    {R"({"radiometry": {"rays": [0]}})", "radiometry.rays[0] = 0: is not allowed here"},
    {R"({"radiometry": {"rays": [100000000000]}})",
     "radiometry.rays[0] = 100000000000: is not allowed here; give a whole number, 1 to "
     "2147483648"},
    {R"({"radiometry": {"rays": [1000001]}})",
     "radiometry.rays[0] = 1000001: are too many rays from one hit; give at most 1000000"},
    {R"({"radiometry": {"rays": [5000, 2]}})",
     "radiometry.rays[0] = 5000: are too many rays from one hit that lead to more; give at "
     "most 4096"},
    {R"({"radiometry": {"sampling": "two-and-a-half", "rays": [91]}})",
     "radiometry.rays = [91]: does not fit two and a half bounces; give two numbers, 3 or more "
     "rays "
     "from "
     "the first hit and 1 from the second: \"rays\": [91, 1]"},
    {R"({"platform": {"frames": 1000000000}})",
     "platform.frames = 1000000000: are too many frames; give at most 1000000"},
    {R"({"platform": {"velocity_m_s": [1, 0, 0]}})",
     "platform.velocity_m_s: does not belong to a platform of the kind \"fixed\"; leave it "
     "out, or"},
    {R"({"sky": {"model": "rayleigh"}})",
     "sky.radiance_W_m2_sr_nm = 0.05: is not a parameter of rayleigh; choose from: tau, "},
    {R"({"geometry": [{"ground": {"z_m": 0, "material": "ground"}, "scale": 2}]})",
     "geometry[0].scale: does not belong to a ground"},
    {R"({"bands": {"wavelength_nm": [0.55]}})",
     "begins at 0.55 nm; give nanometres, 10 or more; 0.55 um is 550"},
    {R"({"radiometry": {"mis": 1}})",
     "radiometry.mis = 1: is not allowed here; give true or false"},
    {R"({"sensor": {"polarimeter": {}}})",
     "does not specify the place of its filters exactly once"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"polarizer_deg": 0}, {"polarizer_deg": 45}, {"polarizer_deg": 90}]}}})",
     "has filters that do not measure S3; add filters that depend on it (a retarder before a "
     "polarizer, for S3), or write "
     "\"recover\": [\"S0\", \"S1\", \"S2\"]"},
    {R"({"sensor": {"polarimeter": {"mosaic": [[{"polarizer_deg": 0}, {"polarizer_deg": 45}]], "recover": ["S0"]}}})",
     "has filters that do not measure S0"},
    {R"({"sensor": {"polarimeter": {"mosaic": [[{}, {}], [{}]], "recover": []}}})",
     "mosaic[1]"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"name": "a"}, {"name": "a"}], "recover": []}}})",
     "has the name a, which another camera has"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"retarder_deg": 0}], "recover": []}}})",
     "has an incomplete retarder"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"polariser_deg": 0}], "recover": []}}})",
     "polariser_deg: is not a known key here; did you mean polarizer_deg?"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"transmittance": 1.5}], "recover": []}}})",
     "at most 1"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"mueller": [[1, 0, 0, 0]]}], "recover": []}}})",
     "is not a Mueller matrix"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"mueller": [[0.5, 0.6, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]}],
         "recover": []}}})",
     "has a negative reading for some light"},
    {R"({"sensor": {"polarimeter": {"cameras": [{"calibration": "missing.img"}], "recover": []}}})",
     "missing.img"},
    {R"({"sensor": {"polarimeter": {"cameras": [{}], "recover": ["S4"]}}})",
     "recover[0] = \"S4\": is not allowed here"},
    {R"({"sensor": {"polarimeter": {"cameras": [{}], "recover": ["S0"], "window_px": [99, 1]}}})",
     "the window of a polarimeter must fit into its image"},
    {R"({"sensor": {"polarimeter": {"cameras": [{}], "recover": ["S0"],
         "noise": {"electrons_per_unit": 10, "full_well_electrons": -5}}}})",
     "full_well_electrons = -5: is not allowed here; give a number of electrons, 1 to 1e15"},
    {R"({"sensor": {"polarimeter": {"cameras": [{}], "recover": ["S0"], "noise": {"read_noise_electrons": 3}}}})",
     "lacks \"electrons_per_unit\""},
};
}  // namespace

TEST(SceneIdentity, EveryBadSceneIsAnsweredByOneLine) {
  for (const BadScene& bad : bad_scenes) {
    json scene = smallScene();
    scene.merge_patch(json::parse(bad.patch));
    const Workplace place(scene);
    put(place.scratch / "nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    std::string answer = "none";
    try {
      readScene(place.scratch / "s.json");
    } catch (const InputError& error) {
      answer = error.what();
    }
    EXPECT_EQ(std::count(answer.begin(), answer.end(), '\n'), 0) << answer;
    EXPECT_NE(answer.find(bad.expected), std::string::npos) << bad.patch << '\n' << answer;
    EXPECT_NE(answer.find("; "), std::string::npos) << "no remedy: " << answer;
  }
}

// The program treats each of these cases alike; a few of them show how.
TEST(CommandRenderIdentity, BadScenesAreAnsweredByOneLineAndNoFile) {
  for (std::size_t i = 0; i < bad_scenes.size(); i += 6) {
    json scene = smallScene();
    scene.merge_patch(json::parse(bad_scenes[i].patch));
    const Workplace place(scene);
    const Outcome outcome = place.render("--out a");
    EXPECT_EQ(outcome.code, 2) << bad_scenes[i].patch << '\n' << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(filesBelow(place.scratch.path), 1u) << bad_scenes[i].patch;
  }
}

TEST(CommandRenderIdentity, NegativeControlTheGoodSceneIsNotRefused) {
  const Outcome outcome = Workplace(smallScene()).render("--dry-run");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
}

TEST(CommandRenderIdentity, ADirectoryIsNoScene) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "d.json");
  for (const char* command : {"render d.json", "info d.json", "info .", "products ."}) {
    const Outcome outcome = malusIn(scratch.path, command);
    EXPECT_EQ(outcome.code, 2) << command;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_NE(malusIn(scratch.path, "render d.json").err.find("is a directory"),
            std::string::npos);
}

TEST(CommandRenderIdentity, AMistakeIsToldWithLineAndColumn) {
  const Scratch scratch;
  json scene = smallScene();
  scene["sensor"]["samples_per_pixel"] = 0;
  put(scratch / "s.json", scene.dump(1));
  const std::string text = contents(scratch / "s.json");
  const std::size_t at = text.find("\"samples_per_pixel\": ") + 21;
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t column = at - text.rfind('\n', at);
  const Outcome outcome = malusIn(scratch.path, "render s.json");
  EXPECT_TRUE(outcome.err.starts_with("s.json:" + std::to_string(line) + ':' +
                                      std::to_string(column) + ": "))
      << outcome.err;
}

TEST(CommandRenderIdentity, BadFlagsAreAnsweredByOneLineAndNoFile) {
  const Workplace place(smallScene());
  for (const char* flags :
       {"--part 0,0,41,10", "--part 5,5,5,9", "--part 1,2,3", "--frames 1:2", "--frames x",
        "--seed -1", "--threads -2", "--out /proc/nowhere", "--part 0,0,16,16,",
        "--part 0,0,16,", "--part ''", "--frames 0:", "--frames ''",
        "--seed 99999999999999999999", "--seed ''", "--out ''", "--threads 1000000"}) {
    const Outcome outcome = place.render(flags);
    EXPECT_EQ(outcome.code, 2) << flags << '\n' << outcome.err;
    EXPECT_EQ(filesBelow(place.scratch.path), 1u) << flags;
  }
}

// A file of limited size imitates a full disk: the same system call fails.
TEST(CommandRenderIdentity, AFullDiskIsToldBeforeTheFirstRayAndLeavesNothing) {
  const Workplace place(smallScene(400));
  const Outcome outcome =
      runIn(place.scratch.path,
            "ulimit -f 20; trap '' XFSZ; '" MALUS_PROGRAM "' render s.json --out a");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("raise the limit (ulimit -f)"), std::string::npos) << outcome.err;
  EXPECT_EQ(filesBelow(place.scratch.path), 1u);
}

TEST(CommandRenderIdentity, ACameraMayLookAtTheSkyAlone) {
  json scene = smallScene();
  scene["platform"]["look_at_m"] = {0, 0, 30};
  const Outcome outcome = Workplace(scene).render("--dry-run");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(CommandRenderIdentity, AResumeAfterAnInputHasChangedIsRefused) {
  for (const char* changed : {"bar.obj", "s.json"}) {
    json scene = smallScene(160, 60);
    scene["geometry"][0]["obj"] = "bar.obj";
    const Workplace place(scene);
    put(place.scratch / "bar.obj", contents(scenes + "chunky-bar.obj"));
    ASSERT_TRUE(WIFSIGNALED(interrupt(place, SIGKILL)));
    const std::string before = place.file(changed);
    put(place.scratch / changed, before + "\n");
    const Outcome refused = place.render("--out b --resume");
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find(std::string(changed) +
                               ": is not the file that this frame was made with"),
              std::string::npos)
        << refused.err;
    put(place.scratch / changed, before);
    EXPECT_EQ(place.render("--out b --resume").code, 0);
    put(place.scratch / changed, before + "\n");  // and when the frame is done
    EXPECT_EQ(place.render("--out b --resume").code, 2);
  }
}

TEST(CommandRenderInvariant, TheRecordOfAResumedRenderCountsTheWholeFrame) {
  const Workplace place(smallScene(160, 60));
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  ASSERT_TRUE(WIFEXITED(interrupt(place, SIGINT)));
  const double before = json::parse(place.file("b/s.run.json.part"))["seconds"];
  ASSERT_EQ(place.render("--out b --resume").code, 0);
  const json whole = json::parse(place.file("a/s.run.json")),
             resumed = json::parse(place.file("b/s.run.json"));
  EXPECT_EQ(whole["rays_followed"], resumed["rays_followed"]);
  EXPECT_EQ(whole["files"], resumed["files"]);
  EXPECT_GT(before, 0);
  EXPECT_GT(resumed["seconds"], before);
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "b/s.run.json.part"));
}

// The record holds the checksums of the cubes; without it nothing vouches for them.
TEST(CommandRenderInvariant, AFrameWithoutItsRecordIsRenderedAgainToTheSameBits) {
  const Workplace place(smallScene());
  ASSERT_EQ(place.render("--out a").code, 0);
  const std::string record = place.file("a/s.run.json"), picture = place.file("a/s.img");
  std::filesystem::remove(place.scratch / "a/s.run.json");
  const Outcome outcome = place.render("--out a --resume");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find(": 0 of "), std::string::npos) << outcome.err;
  EXPECT_EQ(json::parse(place.file("a/s.run.json"))["rays_followed"],
            json::parse(record)["rays_followed"]);
  EXPECT_EQ(place.file("a/s.img"), picture);
}

namespace {
json fourCameras() {
  return json::parse(
      R"([{"name": "P0", "polarizer_deg": 0}, {"name": "P45", "polarizer_deg": 45},
      {"name": "P90", "polarizer_deg": 90},
      {"name": "right", "retarder_deg": 45, "retardance_deg": 90, "polarizer_deg": 0}])");
}
const json mosaic = json::parse(R"([[{"polarizer_deg": 90}, {"polarizer_deg": 45}],
                                    [{"polarizer_deg": 135}, {"polarizer_deg": 0}]])");

double farthest(const Cube& a, const Cube& b) {
  double most = a.data.size() == b.data.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(a.data.size(), b.data.size()); ++i)
    most = std::max(most, std::abs(double(a.data[i]) - double(b.data[i])));
  return most;
}
Cube withoutS3(const Cube& cube) {
  Cube made{cube.header, {}};
  for (std::size_t i = 0; i < cube.data.size(); ++i)
    if (i % 4 < 3) made.data.push_back(cube.data[i]);
  return made;
}
double brightest(const Cube& cube) {
  return *std::max_element(cube.data.begin(), cube.data.end());
}
// Numbers are rounded to float three times on the way, and the condition numbers here are below 5.
constexpr double float_rounding = 3 * 5 * 0x1p-24;
}  // namespace

TEST(PolarimeterIdentity, FourIdealCamerasRecoverTheRenderedStokesVectors) {
  json scene = smallScene();
  scene["bands"]["wavelength_nm"] = {500, 600};
  scene["sensor"]["polarimeter"]["cameras"] = fourCameras();
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube light = readCube(place.scratch / "a/s.img"),
             back = readCube(place.scratch / "a/s.recovered.img");
  const Cube readings = readCube(place.scratch / "a/s.readings.img");
  EXPECT_EQ(readings.header.channels,
            (std::vector<std::string>{"P0 500", "P45 500", "P90 500", "right 500", "P0 600",
                                      "P45 600", "P90 600", "right 600"}));
  EXPECT_EQ(readings.header.unit, light.header.unit);
  EXPECT_LT(farthest(light, back), float_rounding * brightest(light));
  // S3 is there to be recovered, and by the right-handed camera: its reading is (S0 + S3) / 2
  double s3 = 0;
  for (std::size_t i = 0; i < light.data.size() / 4; ++i) {
    s3 = std::max(s3, std::abs(double(light.data[4 * i + 3])));
    EXPECT_NEAR(readings.data[4 * i + 3], (light.data[4 * i] + light.data[4 * i + 3]) / 2,
                float_rounding * brightest(light));
  }
  EXPECT_GT(s3, 1e3 * float_rounding * brightest(light));
  const json info = json::parse(place.file("a/s.run.json"))["polarimeter"];
  EXPECT_EQ(info["measures"], (json{"S0", "S1", "S2", "S3"}));
  EXPECT_EQ(malusIn(place.scratch.path, "products a/s.recovered.img").code, 0);
  EXPECT_EQ(malusIn(place.scratch.path, "info a/s.readings.img").code, 0);
}

TEST(PolarimeterIdentity, NegativeControlATurnedPolarizerIsNoticed) {
  json scene = smallScene();
  scene["sensor"]["polarimeter"]["cameras"] = fourCameras();
  const Workplace place(scene);
  ASSERT_EQ(place.render("--out a").code, 0);
  scene["sensor"]["polarimeter"]["cameras"][1]["polarizer_deg"] = 44.9;
  const Workplace other(scene);
  ASSERT_EQ(other.render("--out a").code, 0);
  EXPECT_EQ(place.file("a/s.img"), other.file("a/s.img"));
  const Cube a = readCube(place.scratch / "a/s.readings.img"),
             b = readCube(other.scratch / "a/s.readings.img");
  EXPECT_GT(farthest(a, b), 10 * float_rounding * brightest(a));
}

TEST(PolarimeterIdentity, AMosaicIsRightWhereTheSceneIsEvenAndWrongAtItsEdges) {
  json scene = smallScene(40, 1);  // the sun alone: no noise, and the plate is even
  scene["radiometry"]["rays"] = {1};
  scene["sensor"]["polarimeter"] = {{"mosaic", mosaic}, {"recover", {"S0", "S1", "S2"}}};
  scene["geometry"] = json::parse(R"([{"ground": {"material": "copper-030"}}])");
  scene["sensor"]["field_of_view_deg"] = 1e-4;  // one direction
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube light = readCube(place.scratch / "a/s.img"),
             back = readCube(place.scratch / "a/s.recovered.img");
  // over 1e-4 degrees the copper's lobe changes by 2e-6 / sigma of itself
  const double even = 1e-5 * brightest(light);
  EXPECT_LT(farthest(withoutS3(light), back), even);
  EXPECT_GT(
      std::abs(light.data[2]),
      100 *
          even);  // the sun is in the diagonal of the linear polarisers: S3 is neither in the cube nor in the pictures
  EXPECT_EQ(back.header.channels.size(), 3u);
  EXPECT_NE(back.header.description.find("which measure S0, S1, S2"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "a/s.recovered.S3.png"));
  EXPECT_TRUE(std::filesystem::exists(place.scratch / "a/s.recovered.S2.png"));
  scene["geometry"] = smallScene()["geometry"];
  scene["sensor"]["field_of_view_deg"] = 36.87;
  const Workplace edges(scene);
  ASSERT_EQ(edges.render("--out a").code, 0);
  const Cube seen = readCube(edges.scratch / "a/s.img");
  EXPECT_GT(farthest(withoutS3(seen), readCube(edges.scratch / "a/s.recovered.img")),
            0.1 * brightest(seen));
}

TEST(PolarimeterIdentity, ACalibrationFromAFileIsWhatTheSameMatricesAre) {
  constexpr std::size_t width = 40, height = 33;
  json scene = smallScene();
  json cameras = fourCameras();
  scene["sensor"]["polarimeter"]["cameras"] = cameras;
  const Workplace ideal(scene);
  ASSERT_EQ(ideal.render("--out a").code, 0);
  const std::array<std::string, 4> files{"first.img", "second.img", "third.img", "fourth.img"};
  for (std::size_t i = 0; i < 4; ++i)
    cameras[i] = {{"name", cameras[i]["name"]}, {"calibration", files[i]}};
  scene["sensor"]["polarimeter"]["cameras"] = cameras;
  const Workplace place(scene);
  const std::array<CDMuellerMatrix, 4> filters{
      linearPolarizer(0), linearPolarizer(std::numbers::pi / 4),
      linearPolarizer(std::numbers::pi / 2), circularPolarizer(1)};
  for (std::size_t i = 0; i < 4; ++i) {
    CubeHeader header;
    header.width = width, header.height = height;
    for (int j = 0; j < 16; ++j) header.channels.push_back(std::to_string(j));
    CubeWriter writer(place.scratch / files[i], header);
    std::vector<float> numbers;
    for (std::size_t pixel = 0; pixel < width * height; ++pixel)
      numbers.insert(numbers.end(), filters[i].data(), filters[i].data() + 16);
    writer.write({0, 0, width, height}, numbers);
    writer.finish();
  }
  const Outcome outcome = place.render("--out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube a = readCube(ideal.scratch / "a/s.readings.img"),
             b = readCube(place.scratch / "a/s.readings.img");
  EXPECT_LT(farthest(a, b), float_rounding * brightest(a));
  EXPECT_LT(farthest(readCube(place.scratch / "a/s.img"),
                     readCube(place.scratch / "a/s.recovered.img")),
            float_rounding * brightest(a));
  scene["sensor"]["width"] = 41;
  put(place.scratch / "s.json", scene.dump(1));
  const Outcome wrong = place.render("--out c");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(
      wrong.err.find(
          "has 40 x 33 pixels and the sensor 41 x 33; give a calibration of the sensor's size"),
      std::string::npos)
      << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "c"));
}

TEST(PolarimeterInvariant, NoiseHasTheMeanAndTheVarianceOfItsElectrons) {
  constexpr double gain = 2e4, read = 30;
  json scene = smallScene(128);
  scene["sensor"]["polarimeter"] = {{"cameras", fourCameras()}};
  const Workplace clean(scene);
  ASSERT_EQ(clean.render("--out a").code, 0);
  scene["sensor"]["polarimeter"]["noise"] = {{"electrons_per_unit", gain},
                                             {"read_noise_electrons", read}};
  const Workplace noisy(scene);
  ASSERT_EQ(noisy.render("--out a").code, 0);
  EXPECT_EQ(clean.file("a/s.img"), noisy.file("a/s.img"));
  const Cube mean = readCube(clean.scratch / "a/s.readings.img"),
             drawn = readCube(noisy.scratch / "a/s.readings.img");
  double sum = 0, squares = 0;
  const auto n = double(mean.data.size());
  for (std::size_t i = 0; i < mean.data.size(); ++i) {
    const double sigma = std::sqrt(gain * double(mean.data[i]) + read * read) / gain;
    const double deviate = (double(drawn.data[i]) - double(mean.data[i])) / sigma;
    sum += deviate, squares += deviate * deviate;
  }
  // five standard errors of a standard deviate's mean and variance: 1 in 3e5 that a good program fails; the
  // kurtosis of Poisson's distribution adds less than 1 in 400 to the 2
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2.0025 / n));
  EXPECT_GT(0.05, 5 * std::sqrt(2.0025 / n));  // a read noise of 32 for 30 would be seen
}

TEST(PolarimeterInvariant, ReadingsAreTheSameBitsForThreadsPartsAndResumes) {
  json scene = smallScene(160, 60);
  scene["sensor"]["polarimeter"] = {
      {"mosaic", mosaic},
      {"recover", {"S0", "S1", "S2"}},
      {"noise", {{"electrons_per_unit", 1e4}, {"full_well_electrons", 3000}}}};
  const Workplace place(scene);
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  ASSERT_TRUE(WIFSIGNALED(interrupt(place, SIGKILL)));
  ASSERT_EQ(place.render("--out b --resume --threads 3").code, 0);
  for (const char* part : {"0,0,37,153", "37,0,160,80", "37,80,160,153"})
    ASSERT_EQ(place.render(std::string("--out c --part ") + part).code, 0);
  ASSERT_EQ(malusIn(place.scratch.path, "merge c").code, 0);
  for (const char* name : {"s.img", "s.readings.img", "s.recovered.img"}) {
    const std::string whole = place.file(std::string("a/") + name);
    ASSERT_FALSE(whole.empty());
    EXPECT_EQ(whole, place.file(std::string("b/") + name)) << name;
    EXPECT_EQ(whole, place.file(std::string("c/") + name)) << name;
  }
  const json a = json::parse(place.file("a/s.run.json"))["polarimeter"],
             b = json::parse(place.file("b/s.run.json"))["polarimeter"];
  EXPECT_EQ(a["full_wells"], b["full_wells"]);
  EXPECT_GT(a["full_wells"], 0);
  ASSERT_EQ(place.render("--out d --seed 6").code, 0);
  EXPECT_NE(place.file("a/s.readings.img"), place.file("d/s.readings.img"));
}

TEST(PolarimeterIdentity, AFilterMayDependOnTheBand) {
  json scene = smallScene();
  scene["bands"]["wavelength_nm"] = {500, 600};
  scene["radiometry"]["rays"] = {1};
  scene["sensor"]["polarimeter"] = {
      {"cameras",
       json::parse(R"([{"transmittance": {"wavelength_nm": [400, 700], "values": [0.4, 0.7]}},
                                  {"mueller": [[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]],
                                               [[0.5,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]]}])")},
      {"recover", {"S0"}}};
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube light = readCube(place.scratch / "a/s.img"),
             readings = readCube(place.scratch / "a/s.readings.img");
  const std::array<double, 4> passes{0.5, 1, 0.6, 0.5};
  for (std::size_t pixel = 0; pixel < 40 * 33; ++pixel)
    for (std::size_t i = 0; i < 4; ++i)
      ASSERT_NEAR(readings.data[4 * pixel + i], passes[i] * light.data[8 * pixel + 4 * (i / 2)],
                  float_rounding * brightest(light));
}

TEST(SceneIdentity, SobolAndTheSkysShareAreChosenInTheScene) {
  json scene = smallScene(16, 8);
  scene["radiometry"]["sampling"] = "importance";
  const auto option = [&](const char* key, bool value) {
    scene["radiometry"][key] = value;
    return readSceneText(scene.dump(), "s.json", ".").radiometry;
  };
  EXPECT_TRUE(option("sobol", true).sobol);
  EXPECT_FALSE(option("sobol", false).sobol);
  EXPECT_TRUE(option("mis", true).mis);
  EXPECT_FALSE(option("mis", false).mis);
  EXPECT_EQ(option("mis", true).sampling, Sampling::importance);
}

TEST(SceneIdentity, AllScenesThatShipWithMalusAreGood) {
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() != ".json" || entry.path().stem() == "parking-lot")
      continue;  // its mesh is generated
    ++found;
    EXPECT_NO_THROW(readScene(entry.path())) << entry.path();
  }
  EXPECT_GE(found, 6u);
}

TEST(SceneIdentity, ASunWithATimeMovesWithTheFrames) {
  const Scene day = readScene(scenes + "rochester-day.json");
  ASSERT_TRUE(day.move_sun);
  World moved = day.world;
  day.move_sun(moved, 6 * 3600);
  EXPECT_LT(moved.sun->to_sun.getZenith(), day.world.sun->to_sun.getZenith());
  EXPECT_LT(moved.sun->to_sun.y, 0);  // in the south at one o'clock of summer time
}

TEST(SceneIdentity, EveryPartOfTheSchemaIsDescribedForTheMessages) {
  const std::function<void(const json&, const std::string&)> visit =
      [&](const json& schema, const std::string& path) {
        if (schema.contains("$ref")) return;
        if (path != "") {
          EXPECT_TRUE(schema.contains("description")) << path;
        }
        if (schema.contains("properties"))
          for (const auto& [key, value] : schema["properties"].items())
            visit(value, path + '/' + key);
        if (schema.contains("properties")) {
          EXPECT_EQ(schema.value("additionalProperties", json(true)), false) << path;
        }
      };
  visit(sceneSchema(), "");
  for (const auto& [key, value] : sceneSchema()["definitions"].items()) visit(value, key);
}

namespace {
/// What reading a scene complains of.
std::string refusal(const json& scene, const std::filesystem::path& directory = ".") {
  try {
    readSceneText(scene.dump(1), "s.json", directory);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
}  // namespace

TEST(SceneIdentity, BandsComeInAnyOrderAndUnderTheirNames) {
  json scene = smallScene(16, 4);
  scene["materials"]["ground"] = json::parse(R"({"model": "lambertian",
      "reflectance": {"wavelength_nm": [380, 720], "values": [0.1, 0.5]}})");
  scene["geometry"] = json::parse(R"([{"ground": {"material": "ground"}}])");
  scene["bands"] = json::parse(R"([{"center_nm": 650, "name": "red"}, {"center_nm": 550},
      {"center_nm": 550, "fwhm_nm": 100, "name": "pan"}, {"center_nm": 450}])");
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube cube = readCube(place.scratch / "a/s.img");
  EXPECT_EQ(cube.header.channels[0], "S0 red");
  EXPECT_EQ(cube.header.channels[8], "S0 pan");
  EXPECT_EQ(cube.header.channels[12], "S0 450");
  EXPECT_EQ(cube.header.wavelength_nm[8], 550);
  EXPECT_EQ(cube.header.fwhm_nm[8], 100);
  const json told = json::parse(place.file("a/s.run.json"))["bands"];
  EXPECT_EQ(told[0]["name"], "red");
  EXPECT_EQ(told[2]["name"], "pan");
  EXPECT_EQ(told[2]["response"], "gaussian");
  EXPECT_NEAR(told[2]["from_nm"], 550 - 157.843, 1e-3);
  EXPECT_TRUE(has(malusIn(place.scratch.path, "info s.json").out, "pan at 550 nm"));
  EXPECT_TRUE(has(malusIn(place.scratch.path, "info a/s.img").out, "S1 red"));
  ASSERT_EQ(malusIn(place.scratch.path, "products a/s.img --all").code, 0);
  EXPECT_TRUE(std::filesystem::exists(place.scratch / "a/s.pan.DoLP.png"));
  // the same light in another order
  scene["bands"] = json::parse(R"([{"center_nm": 450}, {"center_nm": 550},
      {"center_nm": 550, "fwhm_nm": 100}, {"center_nm": 650}])");
  const Workplace sorted(scene);
  ASSERT_EQ(sorted.render("--out a").code, 0);
  const Cube other = readCube(sorted.scratch / "a/s.img");
  EXPECT_EQ(other.header.channels[8], "S0 550-2");
  for (std::size_t i = 0; i < cube.data.size(); i += 16)
    for (const auto& [a, b] : {std::pair{0, 12}, {4, 4}, {8, 8}, {12, 0}})
      ASSERT_EQ(cube.data[i + std::size_t(a)], other.data[i + std::size_t(b)]);
  EXPECT_NE(cube.data[0], cube.data[4]);  // the bands differ
}

TEST(SceneIdentity, BandsThatCannotBeToldApartAreRefused) {
  json scene = smallScene();
  const auto with = [&](const char* bands) {
    scene["bands"] = json::parse(bands);
    return refusal(scene);
  };
  EXPECT_EQ(with(R"({"wavelength_nm": [650, 550, 450]})"), "none");
  EXPECT_TRUE(
      has(with(R"({"wavelength_nm": [650, 550, 650]})"),
          "has the same band at 650 nm twice; leave one of them out, or give both a name"));
  EXPECT_TRUE(has(with(R"([{"center_nm": 650, "name": "a"}, {"center_nm": 550, "name": "a"}])"),
                  "bands[1].name = \"a\": is also the name of another band"));
  EXPECT_EQ(with(R"([{"center_nm": 650, "name": "a"}, {"center_nm": 650, "name": "b"}])"),
            "none");
  for (const char* bad : {"a,b", "a}", "a/b", " a"})
    EXPECT_TRUE(
        has(with((R"([{"center_nm": 650, "name": ")" + std::string(bad) + "\"}]").c_str()),
            std::string("bands[0].name = \"") + bad + "\": "))
        << bad;
  EXPECT_TRUE(
      has(with(R"([{"center_nm": 650}, {"center_nm": 100, "fwhm_nm": 90}])"), "bands[1]"));
}

// 600 nm in steps of 5 pm: the grid of light is refused before it is made.
TEST(SceneIdentity, AGridOfTooManyWavelengthsIsRefused) {
  json scene = smallScene();
  scene["bands"] = json::parse(
      R"([{"center_nm": 550, "fwhm_nm": 0.01}, {"center_nm": 700, "fwhm_nm": 200}])");
  EXPECT_TRUE(has(refusal(scene), "needs light at more than 10000 wavelengths"))
      << refusal(scene);
  EXPECT_TRUE(has(refusal(scene), "grid_nm"));
  scene["grid_nm"] = {{"from", 380}, {"to", 1020}, {"step", 10}};
  EXPECT_EQ(refusal(scene), "none");
  scene["grid_nm"]["to"] = 1000;
  EXPECT_TRUE(
      has(refusal(scene),
          "reaches from 380 to 1000 nm, and the band \"700\" from 384.314 to 1015.69; let "
          "it reach from 384 to 1016 nm, or leave it out"))
      << refusal(scene);
}

TEST(SceneIdentity, AMissingCoverIsToldWithSceneMaterialFileAndRange) {
  json scene = smallScene();
  const Scratch scratch;
  put(scratch / "tin.csv", "wavelength_nm,n,k\n400,1,2\n760,1,2\n");
  put(scratch / "sand.csv", "wavelength_nm,reflectance\n755,.1\n900,.2\n");
  scene["geometry"] = json::parse(R"([{"ground": {"material": "tin"}}])");
  scene["materials"] = {
      {"tin",
       {{"model", "torrance-sparrow"}, {"sigma", 0.2}, {"optical_constants", "tin.csv"}}}};
  scene["sun"]["irradiance_W_m2_nm"] = 1;
  scene["bands"] = json::parse(R"([{"center_nm": 780, "fwhm_nm": 20}])");
  const std::string tin = refusal(scene, scratch.path);
  EXPECT_TRUE(
      has(tin, "materials.tin.optical_constants = \"tin.csv\": lacks 760 to 811.569 nm ("))
      << tin;
  EXPECT_TRUE(has(tin, "tin.csv covers 400 to 760 nm), which the bands need; give a spectrum"))
      << tin;
  EXPECT_EQ(tin.rfind("s.json:", 0), 0u) << tin;
  scene["materials"]["tin"] = {{"model", "lambertian"},
                               {"reflectance", {{"file", "sand.csv"}}}};
  EXPECT_TRUE(has(refusal(scene, scratch.path), "lacks 748.431 to 755 nm"));
  scene["materials"]["tin"]["reflectance"] = {{"wavelength_nm", {755, 800}},
                                              {"values", {0, 1}}};
  EXPECT_TRUE(has(refusal(scene, scratch.path),
                  "lacks 748.431 to 755 nm and 800 to 811.569 nm (it covers 755 to 800 nm)"))
      << refusal(scene, scratch.path);
}

namespace {
using Vector = std::array<double, 3>;
/// Where a pixel's ray meets z = 0, by the words of the record alone.
struct Geolocated {
  Vector point;
  double range;
};
Geolocated geolocate(const json& record, double x, double y) {
  const json& camera = record["camera"];
  const std::string kind = camera["kind"];
  const json pose = kind == "framing" ? record["pose"] : record["row_poses"][std::size_t(y)];
  const double u = x + 0.5 - double(camera["principal_point_px"][0]),
               v = y + 0.5 - double(camera["principal_point_px"][1]),
               f = camera["focal_length_px"];
  const std::array<double, 3> along = kind == "framing" ? std::array{u, -v, -f}
                                      : kind == "pushbroom"
                                          ? std::array{u, 0.0, -f}
                                          : std::array{std::sin(u / f), 0.0, -std::cos(u / f)};
  Vector direction{}, point{};
  for (std::size_t i = 0; i < 3; ++i)
    direction[i] = along[0] * double(pose["right"][i]) + along[1] * double(pose["up"][i]) +
                   along[2] * double(pose["back"][i]);
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  Vector origin{};
  for (std::size_t i = 0; i < 3; ++i) {
    origin[i] = double(pose["position_m"][i]);
    if (kind != "framing")
      origin[i] += x * double(camera["column_time_s"]) * double(pose["velocity_m_s"][i]);
  }
  const double range = -origin[2] / direction[2] * length;
  for (std::size_t i = 0; i < 3; ++i) point[i] = origin[i] + range * direction[i] / length;
  return {point, range};
}
json flatScene(const char* kind) {
  json scene = smallScene(24, 2);
  scene["geometry"] = json::parse(R"([{"ground": {"material": "copper-030"}}])");
  scene["sensor"]["kind"] = kind;
  if (kind != std::string("framing"))
    scene["sensor"]["row_time_s"] = 0.1, scene["sensor"]["column_time_s"] = 0.002;
  scene["platform"] = json::parse(R"({"path": "straight", "start_m": [3, -2, 15],
      "velocity_m_s": [2, 1, 0.5], "look": [0.3, 0.2, -1], "up": [2, 1, 0], "frames": 2,
      "interval_s": 3})");
  return scene;
}
}  // namespace

TEST(CommandRenderIdentity, EveryPixelIsFoundOnTheGroundFromTheRecordAlone) {
  for (const char* kind : {"framing", "pushbroom", "line-scanner"}) {
    const Workplace place(flatScene(kind));
    const Outcome outcome = place.render("--out a");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* frame : {"0000", "0001"}) {
      const std::string stem = std::string("a/s.") + frame;
      const json record = json::parse(place.file(stem + ".run.json"));
      const Cube truth = readCube(place.scratch / (stem + ".truth.img"));
      double worst = 0, spoilt = 0;
      json wrong = record;
      wrong["camera"]["focal_length_px"] = 1.001 * double(record["camera"]["focal_length_px"]);
      for (std::size_t y = 0; y < truth.header.height; ++y)
        for (std::size_t x = 0; x < truth.header.width; ++x) {
          const double range = truth.at(x, y, 2);
          worst =
              std::max(worst, std::abs(geolocate(record, double(x), double(y)).range - range));
          spoilt =
              std::max(spoilt, std::abs(geolocate(wrong, double(x), double(y)).range - range));
        }
      // ranges of 20 m are stored as floats, and Embree traced them in single precision: 20 * 2^-22
      EXPECT_LT(worst, 20 * 0x1p-22) << kind;
      EXPECT_GT(spoilt, 20 * 0x1p-22) << kind;  // negative control
      EXPECT_EQ(record["velocity_m_s"], (json{2.0, 1.0, 0.5}));
      EXPECT_EQ(record["time_s"], frame[3] == '0' ? 0.0 : 3.0);
      EXPECT_TRUE(record["sun"].contains("azimuth_deg"));
    }
  }
}

TEST(CommandRenderIdentity, ACameraThatLooksStraightDownMakesAMapForGdal) {
  json scene = flatScene("framing");
  scene["sensor"]["samples_per_pixel"] = 3;
  for (const auto& [up, heading] : {std::pair{json{0, 1, 0}, "north"},
                                    {json{1, 0, 0}, "east"},
                                    {json{1, 2, 0}, "askew"},
                                    {json{0, -1, 0}, "south"}}) {
    scene["platform"] = {{"position_m", {3, -2, 15}}, {"look", {0, 0, -1}}, {"up", up}};
    const Workplace place(scene);
    for (const char* part : {"", "--part 5,3,20,11"}) {
      const std::string stem = *part ? "s.5-3-20-11" : "s";
      ASSERT_EQ(place.render(std::string("--out a ") + part).code, 0);
      const json record = json::parse(place.file("a/" + stem + ".run.json"));
      const std::size_t x0 = record["tile"][0], y0 = record["tile"][1];
      // where GDAL puts the middles of two pixels, and where they are
      std::string program =
          "import sys\nfrom osgeo import gdal\ng = "
          "gdal.Open(sys.argv[1]).GetGeoTransform()\n";
      for (const auto& [x, y] : {std::pair{0, 0}, {11, 4}}) {
        const Vector p =
            geolocate(record, double(x) + double(x0), double(y) + double(y0)).point;
        for (const int i : {0, 1})
          program += "assert abs(g[" + std::to_string(3 * i) + "] + " +
                     std::to_string(x + 0.5) + " * g[" + std::to_string(3 * i + 1) + "] + " +
                     std::to_string(y + 0.5) + " * g[" + std::to_string(3 * i + 2) + "] - (" +
                     std::to_string(p[std::size_t(i)]) + ")) < 2e-6, (g, " +
                     std::to_string(p[std::size_t(i)]) + ")\n";
      }
      // 2e-6: six decimals of the points above, twice
      EXPECT_EQ(std::system(("/usr/bin/python3 -c '" + program + "' " +
                             (place.scratch / ("a/" + stem + ".img")).string())
                                .c_str()),
                0)
          << heading;
    }
  }
  // aslant there is no map
  scene["platform"]["look"] = {0.01, 0, -1};
  const Workplace aslant(scene);
  ASSERT_EQ(aslant.render("--out a").code, 0);
  EXPECT_EQ(readCube(aslant.scratch / "a/s.img").header.map_info, "");
}

TEST(CommandRenderIdentity, TheSkyHasNoRangeAndADatedSceneATime) {
  json scene = smallScene(16, 2);
  scene["platform"] = {{"position_m", {0, 0, 5}}, {"look", {0, 1, 0}}};
  scene["sky"] = {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0.1}};
  scene["sun"] = {
      {"latitude_deg", 43.1}, {"longitude_deg", -77.6}, {"time", "2001-06-10T17:06:00Z"}};
  scene["platform"]["frames"] = 2, scene["platform"]["interval_s"] = 90;
  scene["platform"]["path"] = "fixed";
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a --interleave bsq");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube truth = readCube(place.scratch / "a/s.0001.truth.img");
  EXPECT_TRUE(std::isnan(truth.at(3, 0, 2)));
  EXPECT_EQ(truth.at(3, 0, 0), -1);
  EXPECT_TRUE(std::isfinite(truth.at(3, truth.header.height - 1, 2)));
  EXPECT_EQ(truth.header.ignore_value, "nan");
  EXPECT_EQ(truth.header.acquisition_time, "2001-06-10T17:07:30Z");
  EXPECT_EQ(truth.header.interleave, Interleave::bsq);
  const json record = json::parse(place.file("a/s.0001.run.json"));
  EXPECT_EQ(record["time"], "2001-06-10T17:07:30Z");
  EXPECT_TRUE(has(std::string(record["command"]), "--interleave bsq"));
  EXPECT_TRUE(has(malusIn(place.scratch.path, "info a/s.0001.img").out,
                  "acquired 2001-06-10T17:07:30Z"));
  // the same numbers as by pixel
  ASSERT_EQ(place.render("--out b").code, 0);
  EXPECT_EQ(readCube(place.scratch / "b/s.0001.img").data,
            readCube(place.scratch / "a/s.0001.img").data);
  EXPECT_NE(place.file("b/s.0001.img"), place.file("a/s.0001.img"));
  EXPECT_EQ(place.render("--out c --interleave big").code, 2);
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "c"));
}

TEST(CommandRenderInvariant, TheSpectralPictureIsTheSameBitsAtAnotherTime) {
  const Workplace place(smallScene(16, 2));
  ASSERT_EQ(place.render("--out a").code, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a clock in it would differ
  ASSERT_EQ(place.render("--out b").code, 0);
  ASSERT_FALSE(place.file("a/s.exr").empty());
  EXPECT_EQ(place.file("a/s.exr"), place.file("b/s.exr"));
}

TEST(CommandRenderIdentity, ARadianceThatNoFloatHoldsIsRefused) {
  json scene = smallScene(16, 2);
  scene["sky"] = {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 1e39}};
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "sky.radiance_W_m2_sr_nm = 1e+39")) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "0 to 1e+12")) << outcome.err;
  EXPECT_EQ(filesBelow(place.scratch / "a"), 0u);
}

/// The objects of a render's error stream; a line that is none fails the test.
std::vector<json> objects(const std::string& text) {
  std::vector<json> made;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    made.push_back(json::parse(line, nullptr, false));
    EXPECT_TRUE(made.back().is_object()) << line;
  }
  return made;
}

TEST(CommandRenderIdentity, ProgressAsJSONCountsTheTilesAndEndsWithTheRun) {
  json scene = smallScene();
  scene["platform"] = {
      {"path", "straight"}, {"start_m", {0, 0, 15}}, {"velocity_m_s", {1, 0, 0}},
      {"frames", 2},        {"interval_s", 1},       {"look", {0, 0, -1}},
      {"up", {0, 1, 0}}};
  const Workplace place(scene);
  const Outcome outcome = place.render("--out a --progress json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<json> told = objects(outcome.err);
  std::size_t frame = 0, tile = 0;
  for (std::size_t i = 0; i + 1 < told.size(); ++i) {
    if (told[i].contains("note")) continue;
    EXPECT_EQ(told[i]["tiles"], 9);  // 40 x 33 pixels
    EXPECT_GE(told[i]["seconds"], 0.0);
    if (told[i]["frame"] != frame) frame = told[i]["frame"], tile = 0;
    EXPECT_GE(told[i]["tile"], tile);
    tile = told[i]["tile"];
    EXPECT_EQ(told[i]["state"] == "done",
              tile == 9 && (i + 2 == told.size() || told[i + 1]["frame"] != frame));
  }
  EXPECT_EQ(frame, 1u);
  EXPECT_EQ(told.back()["state"], "done");
  EXPECT_EQ(told.back()["frames"], 2);
  // a scheduler must distinguish text from objects: text is the default
  EXPECT_TRUE(json::parse(place.render("--out b").err, nullptr, false).is_discarded());
  const Outcome unknown = place.render("--out c --progress xml");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err,
            "command line: --progress = xml: is not a style of progress; give text or json\n");
}

TEST(CommandRenderIdentity, ProgressAsJSONTellsHowToGoOnAfterAStop) {
  const Workplace place(smallScene(160, 60));
  const Outcome stopped =
      runIn(place.scratch.path,
            "{ '" MALUS_PROGRAM
            "' render s.json --threads 1 --out b --progress json & p=$!; "
            "while ! grep -q '^16 ' b/s.truth.img.tiles; do sleep 0.01; done 2>/dev/null; "
            "kill -TERM $p; wait $p; }");
  ASSERT_EQ(stopped.code, 128 + SIGTERM) << stopped.err;
  const json last = objects(stopped.err).back();
  EXPECT_EQ(last["state"], "stopped");
  EXPECT_EQ(last["resume"], "malus render s.json --out b --resume");
  EXPECT_EQ(place.render("--out b --resume --progress json").code, 0);
}

TEST(CommandRenderIdentity, ASceneMayBeCalledAnything) {
  const json scene = smallScene(16, 2);
  const Scratch scratch;
  put(scratch / "a}\nbands = 1{.json", scene.dump());
  const Outcome outcome = malusIn(scratch.path, "render 'a}\nbands = 1{.json' --out a");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(readCube(scratch / "a/a}\nbands = 1{.img").header.channels.size(), 4u);
}

TEST(SceneIdentity, BroadBandsAreMixedFromTheGridOfLight) {
  json scene = smallScene();
  scene["bands"] = json::parse(R"([{"center_nm": 500, "fwhm_nm": 20, "response": "gaussian"},
      {"center_nm": 600, "response": {"wavelength_nm": [590, 600, 610], "values": [0, 1, 0]}}])");
  // A light that rises evenly over wavelength has at each symmetric band's centre the mean over the band.
  scene["sky"]["radiance_W_m2_sr_nm"] =
      json::parse(R"({"wavelength_nm": [400, 700], "values": [0.4, 0.7]})");
  scene["sun"] = nullptr;
  scene["materials"]["ground"]["reflectance"] = 0.5;
  scene["geometry"] = json::parse(R"([{"ground": {"material": "ground"}}])");
  scene["radiometry"]["rays"] = {40};
  scene.erase("sun");
  const Scene read = readSceneText(scene.dump(), "s.json", ".");
  const RenderedImage frame = renderScene(read, 0, {1, Tile{3, 3, 4, 4}, nullptr});
  ASSERT_EQ(frame.bands, 2u);
  // The forty rays see cos(theta) summed a few per cent off; a narrow band at a known radiance says by how much.
  scene["bands"] = {{"wavelength_nm", {500}}};
  const RenderedImage narrow = renderScene(readSceneText(scene.dump(), "s.json", "."), 0,
                                           {1, Tile{3, 3, 4, 4}, nullptr});
  const double per_radiance = narrow.at(0, 0)[0] / 0.5,
               rounding = 1e-12;  // of averages over a dozen wavelengths
  EXPECT_NEAR(frame.at(0, 0, 0)[0] / per_radiance, 0.5, rounding);
  EXPECT_NEAR(frame.at(0, 0, 1)[0] / per_radiance, 0.6, rounding);
  EXPECT_GT(std::abs(frame.at(0, 0, 1)[0] / per_radiance - 0.5),
            rounding);  // the other band's value would be seen
}

// ---------------------------------------------------------------- memory

namespace {
/// A picture that costs little for its size.
json largeScene(int side, int bands) {
  json scene = smallScene(side);
  scene["sensor"]["height"] = side;
  scene["radiometry"] = {{"sampling", "grid"}, {"rays", {1}}, {"seed", 5}};
  scene["bands"] = {{"wavelength_nm", json::array()}};
  for (int i = 0; i < bands; ++i) scene["bands"]["wavelength_nm"].push_back(450 + i);
  return scene;
}

/// The reported memory of a run, in bytes.
double memoryIn(const std::string& told) {
  std::smatch m;
  if (!std::regex_search(told, m, std::regex("memory    about ([0-9]+) MB"))) return -1;
  return 1e6 * std::stod(m[1]);
}

/// The same, whatever room the disk has.
double memoryToldOf(const Workplace& place, const std::string& write, int threads) {
  RenderFlags flags;
  flags.scene = (place.scratch / "s.json").string(), flags.write = write;
  return memoryIn(describeNeeds(planOf(flags), {}, threads));
}
}  // namespace

TEST(CommandRenderInvariant, LargePicturesNeedLessThanFourGibibytes) {
  constexpr double most = 4.0 * (1 << 30);
  for (const auto& [side, bands] : {std::pair{20000, 8}, {4096, 400}}) {
    const Workplace place(largeScene(side, bands));
    for (const char* write : {"", "cube,truth,pictures,exr,netcdf"})
      for (const int threads : {1, 8}) {
        const double told = memoryToldOf(place, write, threads);
        EXPECT_GT(told, 20e6) << side;
        EXPECT_LT(told, most) << side << ' ' << write << ' ' << threads;
        EXPECT_GT(double(side) * side * bands * 16, most);  // the cube itself does not fit
      }
  }
}

TEST(CommandRenderInvariant, RowsThatOpenEXRCannotWriteAreKnownBeforeTheFirstRay) {
  json scene = largeScene(4096, 0);
  scene["sensor"]["height"] = 16;
  scene["materials"] = json::object();
  for (const char* name : {"copper-010", "copper-015", "copper-020", "copper-030", "ground"})
    scene["materials"][name] = {{"model", "lambertian"}, {"reflectance", 0.3}};
  for (int i = 0; i < 2000; ++i) scene["bands"]["wavelength_nm"].push_back(400 + 0.25 * i);
  const Workplace wide(scene);
  const Outcome named = wide.render("--write exr --dry-run");
  EXPECT_EQ(named.code, 2);
  EXPECT_NE(named.err.find("exr: allows rows of at most 31250000 numbers"), std::string::npos)
      << named.err;
  const Outcome usual = wide.render("--dry-run");
  EXPECT_EQ(usual.code, 0) << usual.err;
  EXPECT_NE(usual.out.find("it is left out"), std::string::npos) << usual.out;
  scene["sensor"]["width"] = 3000;  // the negative control
  const Outcome narrow = Workplace(scene).render("--write exr --dry-run");
  EXPECT_EQ(narrow.code, 0) << narrow.err;
}

TEST(CommandRenderInvariant, TilesInTheFarCornersOfALargePictureTakeLittleMemory) {
  if (!memory_can_be_limited) GTEST_SKIP() << "a sanitizer holds more memory than the limit";
  const Workplace place(largeScene(20000, 8));
  for (const std::string part :
       {"0,0,16,16", "19984,0,20000,16", "0,19984,16,20000", "19984,19984,20000,20000"}) {
    const Outcome outcome =
        runIn(place.scratch.path, "ulimit -d 400000; '" MALUS_PROGRAM
                                  "' render s.json --threads 2 --out a --part " +
                                      part);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::string name = part;
    std::ranges::replace(name, ',', '-');
    const Cube cube = readCube(place.scratch / ("a/s." + name + ".img"));
    EXPECT_EQ(cube.data.size(), 16u * 16 * 32);
    EXPECT_GT(cube.at(15, 15, 0), 0);
  }
}

// The memory that the dry run reports is enough for a picture whose cube is larger, in all
// formats. The system also counts what
// libraries reserve and never touch: Embree 128 MiB, each thread its stack of 8 MiB, some of them buffers.
TEST(CommandRenderInvariant, TheMemoryThatIsToldIsEnough) {
  if (!memory_can_be_limited) GTEST_SKIP() << "a sanitizer holds more memory than the limit";
  constexpr double reserved = 180e6, cube_bytes = 512.0 * 512 * 72 * 16;
  const Workplace place(largeScene(512, 72));
  for (const auto& [order, write] :
       {std::pair<std::string, std::string>{"bip", "cube,truth,pictures,exr"},
        {"bsq", "cube,truth,pictures,netcdf"}}) {
    const std::string flags =
        "render s.json --threads 1 --out a --interleave " + order + " --write " + write;
    const double told = memoryIn(malusIn(place.scratch.path, flags + " --dry-run").out),
                 most = told + reserved;
    ASSERT_GT(told, 0);
    ASSERT_LT(most, cube_bytes);
    const Outcome outcome =
        runIn(place.scratch.path,
              fmt::format("ulimit -d {:.0f}; '{}' {}", most / 1024, MALUS_PROGRAM, flags));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto cube = place.scratch / "a/s.img";
    ASSERT_EQ(double(std::filesystem::file_size(cube)), cube_bytes);
    for (const char* made : {"a/s.DoLP.png", "a/s.run.json"})
      EXPECT_TRUE(std::filesystem::exists(place.scratch / made)) << made;
    EXPECT_EQ(std::filesystem::exists(place.scratch / "a/s.exr"), order == "bip");
    EXPECT_EQ(std::filesystem::exists(place.scratch / "a/s.nc"), order == "bsq");
    const auto read = [&] { return readCube(cube).data.size() > 0; };
    EXPECT_EQ(endingWithin(rlim_t(most), read), Ending::out_of_memory);  // negative control
    if (order == "bsq") {  // another one: netCDF is read by its own library, whole
      const Outcome info =
          runIn(place.scratch.path,
                fmt::format("ulimit -d {:.0f}; '{}' info a/s.nc", most / 1024, MALUS_PROGRAM));
      EXPECT_EQ(info.code, 2);
      EXPECT_NE(info.err.find("not enough memory"), std::string::npos) << info.err;
    }
    std::filesystem::remove_all(place.scratch / "a");
  }
}
