// Whole commands on input that is wrong or hostile: each is answered by one line that names the place and the remedy, with exit code 2, and
// no file is left. The cases are former findings of attacks on the program (nw/files/SceneChecks.nw,
// nw/app/CommandLine.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Program.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/InputFiles.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/files/SceneSchema.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/render/Scene.hpp"
#include "malus/render/Tile.hpp"

using namespace malus;
using nlohmann::json;

namespace {
/// A ground and a triangle under a sun, by a camera with a filter: sound, and small.
json soundScene() {
  return json::parse(R"({
    "malus": 1, "title": "sound", "bands": {"wavelength_nm": [550]},
    "georeference": {"latitude_deg": 43, "longitude_deg": -77, "height_m": 168},
    "geometry": [{"obj": "t.obj", "material": "paint", "scale": 1, "rotate_deg": [0, 0, 0], "translate_m": [0, 0, 1]},
                 {"ground": {"z_m": 0, "material": "paint"}}],
    "materials": {"paint": {"model": "lambertian", "reflectance": 0.3}},
    "sun": {"zenith_deg": 30, "azimuth_deg": 90, "irradiance_W_m2_nm": 1, "half_angle_deg": 0.2665},
    "sky": {"model": "uniform", "radiance_W_m2_sr_nm": 0.05},
    "sensor": {"kind": "framing", "width": 8, "height": 8, "focal_length_mm": 15, "pixel_pitch_um": 400,
      "distortion": {"k1": -0.01, "k2": 0.001, "k3": 0.0001, "p1": 0.001, "p2": -0.001}, "detector_size_px": [0.9, 0.8],
      "point_spread": {"kind": "gaussian", "fwhm_px": 1}, "exposure_time_s": 0.01,
      "polarimeter": {"cameras": [{"name": "P0", "polarizer_deg": 0}], "recover": [], "bad_pixels": [[1, 2]],
        "noise": {"electrons_per_unit": 1e5, "dark_electrons": 10,
          "converter": {"bits": 12, "electrons_per_count": 10, "offset_counts": 64}}}},
    "platform": {"path": "straight", "start_m": [0, 0, 15], "look_at_m": [0, 0, 0], "up": [0, 1, 0],
      "velocity_m_s": [1, 0, 0], "rotation_deg_s": [0, 0, 1], "frames": 2, "interval_s": 1},
    "radiometry": {"sampling": "importance", "rays": [4], "seed": 1}
  })");
}

constexpr const char* triangle = "g one\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct Workplace {
  Scratch scratch;
  explicit Workplace(const json& scene, const std::string& mesh = triangle) {
    put(scratch / "s.json", scene.dump(1));
    put(scratch / "t.obj", mesh);
  }
};

/// One line with a remedy, exit code 2, and as many files as before.
void expectRefusal(const Workplace& place, const std::string& arguments,
                   const std::string& fragment) {
  SCOPED_TRACE(arguments.substr(0, 200));
  const std::size_t before = filesBelow(place.scratch.path);
  const Outcome outcome = malusIn(place.scratch.path, arguments);
  EXPECT_EQ(outcome.code, 2) << outcome.err.substr(0, 500);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1)
      << outcome.err.substr(0, 500);
  EXPECT_NE(outcome.err.find(fragment), std::string::npos) << outcome.err.substr(0, 900);
  EXPECT_NE(outcome.err.find("; "), std::string::npos) << "no remedy";
  EXPECT_LT(outcome.err.size(), 3000u);
  EXPECT_EQ(endOfUTF8(outcome.err), std::string::npos);
  EXPECT_EQ(filesBelow(place.scratch.path), before);
}

json with(const std::string& pointer, const json& value) {
  json scene = soundScene();
  scene[json::json_pointer(pointer)] = value;
  return scene;
}

struct BadScene {
  std::string pointer;
  json value;
  std::string fragment;
};
}  // namespace

// The negative control: what all cases begin with is taken.
TEST(RefusalsIdentity, NegativeControlTheSoundSceneRenders) {
  const Workplace place(soundScene());
  const Outcome outcome = malusIn(place.scratch.path, "render s.json --out a");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(place.scratch / "a"));
}

TEST(RefusalsIdentity, HostileScenesAreRefusedAtTheirPlace) {
  const std::string name = "/sensor/polarimeter/cameras/0/name";
  const std::string file_name = "give a name for files and headers";
  const std::vector<BadScene> cases{
      {name, std::string(30'000, 'a'), "has a text of 30000 bytes, more than 1000"},
      {name, std::string(101, 'a'), file_name},
      {name, "../../../ESCAPED",
       "cameras[0].name = \"../../../ESCAPED\": is not allowed here; " + file_name},
      {name, "a/b", file_name},
      {name, "a\\b", file_name},
      {name, "a\"b", file_name},
      {name, ".hidden", file_name},
      {name, "", file_name},
      {name, "a\nb", "has a control character in a text"},
      {"/title", "a\nb", "has a control character in a text"},
      {"/title", "an } in the header",
       "title = \"an } in the header\": is not allowed here; give a text"},
      {"/geometry/0/facet_prefix", "a\tb", "has a control character in a text"},
      {"/bands", json::parse(R"([{"name": "a,b", "center_nm": 550}])"),
       "bands[0].name = \"a,b\""},
      {"/bands", json::array({{{"name", std::string(65, 'a')}, {"center_nm", 550}}}),
       "give a name of 1 to 64 letters"},
      {"/bands", json::parse(R"([{"name": "red ", "center_nm": 550}])"),
       "bands[0].name = \"red \""},
      {"/geometry/1/ground/z_m", -1e300,
       "geometry[1].ground.z_m = -1e+300 m: is not allowed here; give the height of the plane "
       "in m, -1e9 to 1e9"},
      {"/sensor/pixel_pitch_um", 1e38,
       "sensor.pixel_pitch_um = 1e+38 um: is not allowed here; give the width of a pixel in "
       "um, 0.01 to 1e6"},
      {"/sensor/focal_length_mm", 1e-300,
       "sensor.focal_length_mm = 1e-300 mm: is not allowed here; give a focal length in mm, "
       "0.001 to 1e6"},
      {"/platform/velocity_m_s/0", 1e19,
       "platform.velocity_m_s[0] = 1e+19 m/s: is not allowed here; give a component of a "
       "velocity"},
      {"/platform/interval_s", 1e19,
       "platform.interval_s = 1e+19 s: is not allowed here; give a time in s, 1e-9 to 1e9"},
      {"/platform/start_m/2", 2e18,
       "platform.start_m[2] = 2e+18 m: is not allowed here; give a coordinate in m, -1e9 to "
       "1e9"},
      {"/geometry/0/translate_m/1", 2e18, "geometry[0].translate_m[1] = 2e+18 m"},
      {"/geometry/0/scale", 1e9, "lies beyond 1e+09 m once it is put in its place"},
      {"/sun",
       json::parse(
           R"({"latitude_deg": 18446744073709551615, "longitude_deg": 0, "time": "2001-06-10T17:06:00Z"})"),
       "sun.latitude_deg = 18446744073709551615: is not allowed here; give a latitude in "
       "degrees"},
      {"/radiometry/rays", json::array({1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}),
       "has 17 entries, and 16 are allowed"},
      {"/materials/paint/sigmaa", 1,
       "materials.paint.sigmaa: is not a known key here; choose from: reflectance, "
       "polarization_kept, model, "
       "temperature_K, thermal\n"},
      {"/materials/paint/reflectancee", 1,
       "did you mean reflectance? choose from: reflectance, polarization_kept, model, "
       "temperature_K, thermal\n"},
      {"/materials/paint",
       json::parse(
           R"({"model": "dirsig", "reflectance": 0.5, "height": 1e6, "width_deg": 40})"),
       "s.json:"},
  };
  for (const BadScene& bad : cases)
    expectRefusal(Workplace(with(bad.pointer, bad.value)), "render s.json --out a",
                  bad.fragment);
}

// 1000 frames of a day each at a million m/s: each number is allowed, and the camera beyond the world.
TEST(RefusalsIdentity, ACameraThatMovesOutOfTheWorldIsRefused) {
  json scene = with("/platform/frames", 1000);
  scene["sensor"].erase("exposure_time_s");  // which would end after 1e9 s by itself
  scene["platform"]["interval_s"] = 86400;
  scene["platform"]["velocity_m_s"] = {1e5, 0, 0};
  expectRefusal(Workplace(scene), "render s.json --dry-run",
                "the camera of frame 1 is at (8.64e+09, 0, 15) m");
  scene["platform"]["velocity_m_s"] = {0, 0, 0};
  scene["platform"]["interval_s"] = 1e9;
  expectRefusal(Workplace(scene), "render s.json --dry-run",
                "frame 2 is at 2e+09 s; stay within 1e9 s");
}

TEST(RefusalsIdentity, AModelsOwnComplaintNamesTheMaterialOfTheScene) {
  const json material =
      json::parse(R"({"model": "dirsig", "reflectance": 0.5, "height": 1e6, "width_deg": 40})");
  expectRefusal(Workplace(with("/materials/paint", material)), "render s.json --dry-run",
                "materials.paint: dirsig: ");
}

TEST(RefusalsIdentity, AnOpenBodyOfGlassIsRefusedAtItsMaterial) {
  json scene = soundScene();
  scene["materials"]["glass"] = {{"model", "dielectric"}, {"n", 1.5}};
  scene["geometry"][0]["material"] = "glass";
  expectRefusal(
      Workplace(scene), "render s.json --out a",
      "materials.glass = {\"model\":\"dielectric\",\"n\":1.5}: bounds no closed body: 3 of its "
      "edges do not belong to two facets "
      "with fronts on one side, one of them at (0, 0, 1) m; close the mesh, or use the model "
      "pane for a sheet");
  scene["materials"]["glass"]["temperature_K"] = 300;
  scene["materials"]["glass"]["model"] = "pane";
  expectRefusal(Workplace(scene), "render s.json --out a",
                "belongs to a transmitting material");
  scene["materials"]["glass"].erase("temperature_K");
  scene["radiometry"] = {{"sampling", "two-and-a-half"}, {"rays", {9, 1}}};
  expectRefusal(Workplace(scene), "render s.json --out a",
                "sees nothing through the material glass");
}

TEST(RefusalsIdentity, AMistakeInAFileNamesTheFileAndTheSceneThatNamesIt) {
  const Workplace place(
      with("/materials/paint/reflectance", json::parse(R"({"file": "r.csv", "column": "r"})")));
  put(place.scratch / "r.csv", "wavelength_nm,r\n400,0.1\n700,0.2,0.3\n");
  expectRefusal(place, "render s.json --dry-run",
                "r.csv:3: 3 cells: but line 1 names 2 columns; give one cell for each column; "
                "the file is named at s.json:");
  put(place.scratch / "r.csv", "wavelength_nm,r\n400,0.1\n500,0.2\n");
  expectRefusal(place, "render s.json --dry-run", "lacks 550 nm (r.csv covers 400 to 500 nm)");
  const Workplace mesh(soundScene(), "v 0 0 0\nv 1 x 0\n");
  expectRefusal(mesh, "render s.json --dry-run", "t.obj:2: vertex y = x: is not a number;");
}

TEST(RefusalsIdentity, MeshesWithWrongIndicesAndNamesAreRefused) {
  for (const std::string corner : {"4294967299", "1,5", "3x"})
    expectRefusal(Workplace(soundScene(), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + corner + "\n"),
                  "render s.json --out a",
                  "t.obj:4: f = " + corner + ": is not a corner of a face");
  expectRefusal(Workplace(soundScene(), std::string("g Stra\xdf") + "e\n" + triangle + "\n"),
                "render s.json --out a", "t.obj:1: g = Stra\\xdfe: is not UTF-8");
  expectRefusal(Workplace(soundScene(), "v 2e18 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                "render s.json --out a", "is beyond 1e18 in any unit");
  expectRefusal(Workplace(soundScene(), "v 1e10 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                "render s.json --out a", "lies beyond 1e+09 m");
}

TEST(RefusalsIdentity, PipesAndDevicesAreNoFiles) {
  const std::string pipe = "is a pipe, a device or a socket, and not a regular file";
  const Workplace place(soundScene());
  ASSERT_EQ(::mkfifo((place.scratch / "pipe").c_str(), 0600), 0);
  for (const std::string arguments :
       {"render pipe --dry-run", "render /dev/zero --dry-run", "table pipe",
        "table --write-checksum pipe",
        "brdf --model measured --param file=pipe --theta-i-deg 0 --theta-r-deg 0 --phi-deg 0",
        "brdf --model merl --param file=/dev/zero --param blue_nm=450 --param green_nm=550 "
        "--param red_nm=650 "
        "--theta-i-deg 0 --theta-r-deg 0 --phi-deg 0"})
    expectRefusal(place, arguments, pipe);
  const Workplace piped(with("/geometry/0/obj", "pipe"));
  ASSERT_EQ(::mkfifo((piped.scratch / "pipe").c_str(), 0600), 0);
  expectRefusal(piped, "render s.json --dry-run", "geometry[0].obj = \"pipe\": " + pipe);
  const Workplace record(with(
      "/materials/paint",
      json::parse(
          R"({"model": "torrance-sparrow", "sigma": 0.2, "optical_constants": "/dev/zero"})")));
  expectRefusal(record, "render s.json --dry-run",
                "optical_constants = \"/dev/zero\": " + pipe);
}

TEST(RefusalsIdentity, NumbersAndKeysOfTenMegabytesAreNotRepeated) {
  const Workplace place(soundScene());
  const std::string digits(10'000'000, '7');
  put(place.scratch / "n.json", "{\"malus\": " + digits + "}");
  expectRefusal(place, "render n.json --dry-run", "n.json:1:");
  put(place.scratch / "k.json", "{\"" + digits + "\": 1}");
  expectRefusal(place, "render k.json --dry-run", "k.json:1:2: has a text of 10000000 bytes");
  put(place.scratch / "t.csv", "a,b\n1," + digits + ",3\n");
  expectRefusal(place, "table t.csv", "t.csv:2: 3 cells");
  put(place.scratch / "u.csv", "# rows: " + digits + "\na\n1\n");
  expectRefusal(place, "table u.csv", "rows = 7777");
}

TEST(RefusalsIdentity, NumbersOfTheCommandLineAreDecimal) {
  const Workplace place(soundScene());
  for (const std::string flag : {"--threads 0x10", "--threads 010"})
    expectRefusal(place, "render s.json --out a " + flag,
                  "is not decimal: write a number such as 16");
  expectRefusal(place, "render s.json --out a --seed 0x1",
                "--seed = 0x1: does not consist of whole numbers");
}

TEST(RefusalsIdentity, ATensorWhoseSizesOverflowIsRefused) {
  const Workplace place(soundScene());
  std::string head("tensor_file\0\1\0", 14), data;
  const auto append = [](std::string& to, auto number) {
    to.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  constexpr std::uint64_t many = 1 << 19, bands = 1 << 7;
  append(head, std::uint32_t{5});
  const auto field = [&](const std::string& name, char type,
                         const std::vector<std::uint64_t>& shape) {
    append(head, static_cast<std::uint16_t>(name.size()));
    head += name;
    append(head, static_cast<std::uint16_t>(shape.size()));
    head += type;
    append(head, std::uint64_t{4096 + (type == 3 ? 4 * many : 0)});
    for (const std::uint64_t size : shape) append(head, size);
  };
  for (const char* name : {"phi_d", "theta_d", "theta_h"}) field(name, 10, {1, many});
  field("wvls", 3, {bands});
  field("M", 10, {many, many, many, bands, 4, 4});
  head.resize(4096, '\0');
  for (std::uint64_t i = 0; i < many; ++i)
    append(data, static_cast<float>(i) * 6.2f * 0x1p-19f);
  for (std::uint64_t i = 0; i < bands; ++i) append(data, static_cast<std::uint16_t>(400 + i));
  put(place.scratch / "k.pbsdf", head + data);
  expectRefusal(
      place,
      "brdf --model measured --param file=k.pbsdf --theta-i-deg 0 --theta-r-deg 0 --phi-deg 0 "
      "--wavelength-nm 450",
      "k.pbsdf: has a field M whose shape is not that of its axes");
}

TEST(RefusalsIdentity, ADamagedMERLFileIsRefused) {
  const Workplace place(soundScene());
  std::string bytes;
  for (const std::int32_t size : {3, 3, 4})
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  for (int i = 0; i < 3 * 36; ++i) {
    const double f = i == 50 ? 1e10 : 100;
    bytes.append(reinterpret_cast<const char*>(&f), sizeof f);
  }
  put(place.scratch / "m.binary", bytes);
  const std::string ask =
      "brdf --model merl --param file=m.binary --param blue_nm=450 --param green_nm=550 "
      "--param red_nm=650 "
      "--theta-i-deg 0 --theta-r-deg 0 --phi-deg 0 --wavelength-nm 550";
  expectRefusal(place, ask, "of the light; give a file in 1/sr that is not damaged");
  const double infinite = std::numeric_limits<double>::infinity();
  std::memcpy(&bytes[12 + 8 * 60], &infinite, 8);
  put(place.scratch / "m.binary", bytes);
  expectRefusal(place, ask, "beyond any reflection");
}

namespace {
/// All numbers of a scene, by their pointers.
void numbersOf(const json& value, const std::string& at, std::vector<std::string>& all) {
  if (value.is_number()) all.push_back(at);
  if (value.is_object())
    for (const auto& [key, part] : value.items()) numbersOf(part, at + '/' + key, all);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i)
      numbersOf(value[i], at + '/' + std::to_string(i), all);
}

/// "refused", with the number's own path in the message; "rendered" to a pixel of numbers; anything else is wrong.
std::string fateOf(const json& scene, const std::filesystem::path& directory) {
  try {
    const Scene read = readSceneText(scene.dump(), "s.json", directory);
    if (read.platform.frames() > 1000 || read.sensor.geometry().samples > 100)
      return "rendered";
    const RenderedImage picture =
        renderScene(read, read.platform.frames() - 1, {1, Tile{1, 1, 2, 2}, nullptr});
    for (const double number : picture.stokes)
      if (!std::isfinite(number)) return "a pixel that is no number";
    return "rendered";
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.starts_with("s.json:") || what.find("named at s.json:") != what.npos
               ? "refused"
               : "refused elsewhere: " + what;
  } catch (const std::exception& error) {
    return std::string("escaped: ") + error.what();
  }
}
}  // namespace

// Every number of a scene has an interval: any other value is refused there, or gives a picture.
TEST(RefusalsInvariant, NoNumberOfASceneReachesTheTracerFromOutsideItsInterval) {
  const Workplace place(soundScene());
  std::vector<std::string> numbers;
  numbersOf(soundScene(), "", numbers);
  ASSERT_GT(numbers.size(), 30u);
  std::size_t refused = 0, rendered = 0;
  for (const std::string& pointer : numbers)
    for (const json& hostile : {json(1e300), json(-1e300), json(2e18), json(1e19), json(1e38),
                                json(1e-300), json(5e-324), json(1e10), json(-1), json(0),
                                json(~std::uint64_t{0}), json(9007199254740993)}) {
      const std::string fate = fateOf(with(pointer, hostile), place.scratch.path);
      EXPECT_TRUE(fate == "refused" || fate == "rendered")
          << pointer << " = " << hostile << ": " << fate;
      ++(fate == "refused" ? refused : rendered);
    }
  EXPECT_GT(refused, 100u);
  EXPECT_GT(rendered, 50u);
}

// The schema itself: a number without both ends of an interval is a hole in it.
TEST(RefusalsIdentity, EveryNumberOfTheSchemaHasAnInterval) {
  std::size_t numbers = 0;
  const std::function<void(const json&, const std::string&)> look =
      [&](const json& schema, const std::string& path) {
        if (!schema.is_structured()) return;
        const json type = schema.is_object() ? schema.value("type", json()) : json();
        const bool number =
            type == "number" || type == "integer" ||
            (type.is_array() && std::find(type.begin(), type.end(), "number") != type.end());
        // spectra and mapped ranges have the interval of their parameter (Models, ScenePolarimeter, SceneMaps)
        if (number && path.find("/definitions/spectrum") != 0 &&
            path.find("/parameter/properties/range/") == path.npos &&
            path.find("/materials/") == path.npos) {
          ++numbers;
          EXPECT_TRUE(schema.contains("minimum") || schema.contains("exclusiveMinimum"))
              << path;
          EXPECT_TRUE(schema.contains("maximum") || schema.contains("exclusiveMaximum") ||
                      schema.contains("const") || path.ends_with("/seed"))
              << path;
        }
        for (const auto& [key, part] : schema.items()) look(part, path + '/' + key);
      };
  look(sceneSchema(), "");
  EXPECT_GT(numbers, 25u);
}

// The script that makes a fresh machine removes files below a directory: never below one that it has not made.
TEST(RefusalsIdentity, TheFreshMachineIsNotMadeOfThisOne) {
  const Scratch scratch;
  put(scratch / "etc/apt/sources.list", "mine");
  const std::string script =
      "'" + (std::filesystem::current_path() / "tests/fresh-machine.sh").string() + "' ";
  const Outcome outcome = runIn(scratch.path, "sh " + script + scratch.path.string());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("fresh-machine.sh"), std::string::npos) << outcome.err;
  EXPECT_EQ(contents(scratch / "etc/apt/sources.list"), "mine");
}
