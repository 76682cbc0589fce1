// Formats of a render by name (nw/files/FormatRegistry.nw).
#include "malus/files/FormatRegistry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "Program.hpp"

using namespace malus;

namespace {
constexpr const char* small_scene = R"({"malus": 1, "bands": {"wavelength_nm": [450, 550, 650]},
  "geometry": [{"ground": {"material": "plate"}}],
  "materials": {"plate": {"model": "lambertian", "reflectance": 0.2}},
  "sky": {"model": "uniform", "radiance_W_m2_sr_nm": 1},
  "sensor": {"kind": "framing", "width": 8, "height": 6, "field_of_view_deg": 10},
  "platform": {"position_m": [0, 0, 10], "look_at_m": [0, 0, 0]},
  "radiometry": {"rays": [4]}})";
std::set<std::string> namesIn(const std::filesystem::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    names.insert(entry.path().filename().string());
  return names;
}
}  // namespace

TEST(FormatRegistryIdentity, ARenderLeavesTheFilesOfItsFormatsAndNoOthers) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  const FrameShape shape{8, 6, 3, {0, 1, 2, 3}};
  for (const std::string chosen : {"", "exr", "pictures", "cube", "truth", "netcdf", "geotiff",
                                   "ground", "pictures,exr"}) {
    const std::string flag = chosen.empty() ? "" : " --write " + chosen;
    const Outcome outcome = malusIn(scratch.path, "render s.json --out o" + flag);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::set<std::string> wanted{"s.run.json"};
    for (const OutputFormat* format : chosenFormats(chosen, {}))
      for (const OutputFile& file : format->files(shape)) {
        wanted.insert("s" + file.ending);
        EXPECT_LE(double(std::filesystem::file_size(scratch / ("o/s" + file.ending))),
                  file.bytes)
            << file.ending;
      }
    EXPECT_EQ(namesIn(scratch / "o"), wanted) << chosen;
    std::filesystem::remove_all(scratch / "o");
  }
  // several batches have errors, in a separate cube and in other formats
  FrameShape with_errors = shape;
  with_errors.errors = true;
  const std::string chosen = "error,netcdf,pictures";
  ASSERT_EQ(malusIn(scratch.path, "render s.json --out o --batches 2 --write " + chosen).code,
            0);
  std::set<std::string> wanted{"s.run.json"};
  for (const OutputFormat* format : chosenFormats(chosen, {}))
    for (const OutputFile& file : format->files(with_errors)) {
      wanted.insert("s" + file.ending);
      EXPECT_LE(double(std::filesystem::file_size(scratch / ("o/s" + file.ending))), file.bytes)
          << file.ending;
    }
  EXPECT_EQ(namesIn(scratch / "o"), wanted);
  EXPECT_TRUE(wanted.contains("s.error.png") && wanted.contains("s.rays.png"));
  EXPECT_EQ(usualFormats(), "cube,exr,pictures,truth");
  EXPECT_EQ(chosenFormats("exr", {}).size(), 1u);
}

// What is left out changes no bit of what is written, of the record's totals no number, and a frame is not made twice.
TEST(FormatRegistryInvariant, WhatIsWrittenDoesNotDependOnWhatIsNot) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  ASSERT_EQ(malusIn(scratch.path, "render s.json --out all").code, 0);
  const auto record = [&](const std::string& in) {
    return nlohmann::json::parse(contents(scratch / (in + "/s.run.json")));
  };
  for (const std::string output : {"cube", "truth", "pictures", "exr"}) {
    const std::string arguments = "render s.json --out one --write " + output;
    const Outcome outcome = malusIn(scratch.path, arguments);
    EXPECT_EQ(outcome.out, output == "cube" ? "one/s.img\n" : "one/s.run.json\n");
    std::size_t files = 0;
    for (const std::string& name : namesIn(scratch / "one"))
      if (name != "s.run.json") {
        ++files;
        EXPECT_EQ(contents(scratch / ("one/" + name)), contents(scratch / ("all/" + name)))
            << name;
      }
    EXPECT_GT(files, 0u);
    EXPECT_EQ(record("one")["formats"], nlohmann::json::array({output}));
    EXPECT_EQ(record("one")["cubes"].size(),
              std::size_t(output == "cube" || output == "truth"));
    for (const char* key : {"rays_followed", "unphysical_values", "scene_crc32"})
      EXPECT_EQ(record("one")[key], record("all")[key]) << key;
    EXPECT_NE(malusIn(scratch.path, arguments + " --resume").err.find("exists already"),
              std::string::npos);
    // more is requested: the frame is rendered again, and the older outputs stay
    EXPECT_NE(
        malusIn(scratch.path, "render s.json --out one --resume").err.find("has no record of "),
        std::string::npos);
    EXPECT_EQ(namesIn(scratch / "one"), namesIn(scratch / "all")) << output;
    std::filesystem::remove_all(scratch / "one");
  }
}

TEST(FormatRegistryInvariant, TheDryRunCountsWhatIsChosen) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  const auto says = [&](const std::string& flag, const std::string& text) {
    const Outcome outcome = malusIn(scratch.path, "render s.json --out o --dry-run" + flag);
    EXPECT_NE(outcome.out.find(text), std::string::npos) << flag << '\n' << outcome.out;
    EXPECT_EQ(outcome.out.find("while a frame is made") == std::string::npos,
              flag.empty() || flag.find("cube,truth") != std::string::npos)
        << outcome.out;
  };
  says("",
       "1 frames of 14 files");  // light and truth with headers, eight pictures, EXR, record
  says(" --write cube,truth", "1 frames of 5 files");
  says(" --write exr", "1 frames of 2 files");
  EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
}

// A result that is there already is not touched by a run that does not write its kind.
TEST(FormatRegistryInvariant, FormerResultsStay) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  ASSERT_EQ(malusIn(scratch.path, "render s.json --out o --write cube").code, 0);
  const std::string before = contents(scratch / "o/s.img");
  ASSERT_EQ(malusIn(scratch.path, "render s.json --out o --write pictures --seed 9").code, 0);
  EXPECT_EQ(contents(scratch / "o/s.img"), before);
  EXPECT_NE(contents(scratch / "o/s.img.hdr").find("seed 1"), std::string::npos);
}

// A sun that climbs makes the second frame brighter. On separate scales the frames look alike;
// on the film's they do not, and a film that was
// interrupted before it was drawn is drawn by --resume, in the same bits.
TEST(FormatRegistryIdentity, AFilmHasOneScaleAndTheRecordsTellIt) {
  const Scratch scratch;
  std::string scene = small_scene;
  for (const auto& [from, to] :
       {std::pair{R"("look_at_m": [0, 0, 0]})",
                  R"("look_at_m": [0, 0, 0], "frames": 2, "interval_s": 7200})"},
        {R"("sky")", R"("sun": {"time": "2001-06-10T11:00:00Z", "latitude_deg": 43,
  "longitude_deg": -77.61, "irradiance_W_m2_nm": 1}, "sky")"}})
    scene.replace(scene.find(from), std::string(from).size(), to);
  put(scratch / "s.json", scene);
  const auto run = [&](const std::string& flags) {
    const Outcome outcome = malusIn(scratch.path, "render s.json " + flags);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  };
  const auto record = [&](const std::string& file) {
    return nlohmann::json::parse(contents(scratch / file));
  };
  run("--out own --write cube,pictures"), run("--out film --write cube,pictures --scale film");
  const auto ends = record("film/s.0000.run.json")["picture_scales"];
  EXPECT_EQ(ends, record("film/s.0001.run.json")["picture_scales"]);
  EXPECT_EQ(ends["of"], "film");
  const double first = record("own/s.0000.run.json")["picture_scales"]["ends"]["S0"],
               second = record("own/s.0001.run.json")["picture_scales"]["ends"]["S0"];
  EXPECT_GT(second, first);  // or the film would be no test
  EXPECT_EQ(ends["ends"]["S0"], second);
  const auto picture = [&](const std::string& of) {
    return contents(scratch / (of + ".S0.png"));
  };
  EXPECT_NE(picture("film/s.0000"), picture("own/s.0000"));
  EXPECT_EQ(picture("film/s.0001"), picture("own/s.0001"));
  // as if the run had been killed before the film was drawn
  const std::string drawn = picture("film/s.0000");
  std::filesystem::remove(scratch / "film/s.0000.S0.png");
  run("--out film --write cube,pictures --scale film --resume");
  EXPECT_EQ(picture("film/s.0000"), drawn);
  run(fmt::format("--out given --write pictures --frames 0 --scale S0={}", second));
  EXPECT_EQ(picture("given/s.0000"), drawn);
  EXPECT_NE(
      malusIn(scratch.path, "render s.json --out given --write pictures --frames 0 --resume")
          .err.find("other scales"),
      std::string::npos);
}

TEST(FormatRegistryIdentity, AScaleThatCannotBeIsRefused) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  for (const auto& [flags, words] :
       {std::pair{"--scale film --write pictures",
                  "--scale = film: needs the cubes of all frames"},
        {"--scale S0=1 --write exr",
         "--scale = S0=1: has no effect without pictures; add pictures"},
        {"--scale S0=x", "--scale = x: is not a number"},
        {"--scale flim",
         "--scale = flim: is not the end of a picture's scale; write film, or NAME=END"}}) {
    const Outcome outcome =
        malusIn(scratch.path, std::string("render s.json --out o ") + flags);
    EXPECT_EQ(outcome.code, 2) << flags;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
  }
}

TEST(FormatRegistryIdentity, AnUnknownFormatIsRefusedBeforeAnythingIsWritten) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  const Outcome unknown = malusIn(scratch.path, "render s.json --out o --write exr,pictues");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(
      unknown.err,
      "command line: --write = pictues: is not an output of malus; did you mean "
      "pictures? choose from: cube, error, exr, geotiff, ground, netcdf, pictures, truth\n");
  EXPECT_EQ(
      malusIn(scratch.path, "render s.json --out o --write cube,zarr").err,
      "command line: --write = zarr: is not an output of malus; write netcdf, and turn it "
      "into Zarr from Python with malus.open(\"NAME.nc\").to_zarr(\"NAME.zarr\")\n");
  EXPECT_EQ(malusIn(scratch.path, "render s.json --out o --formats exr").err,
            "command line: --formats: is now called --write; write --write\n");
  const Outcome twice = malusIn(scratch.path, "render s.json --out o --write exr,exr");
  EXPECT_EQ(twice.code, 2);
  EXPECT_NE(twice.err.find("gives exr twice"), std::string::npos) << twice.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
}

// OpenEXR is for 4096 bands at most: beyond, it is left out with a word, or refused if it was named.
TEST(FormatRegistryIdentity, AFormatThatIsNotForSoManyBandsIsLeftOutOrRefused) {
  const Scratch scratch;
  const auto scene = [&](int bands) {
    std::string text = small_scene, list = "400";
    for (int i = 1; i < bands; ++i) list += fmt::format(", {}", 400 + i * 0.05);
    text.replace(text.find("450, 550, 650"), 13, list);
    text.replace(text.find("\"width\": 8, \"height\": 6"), 23, "\"width\": 1, \"height\": 1");
    put(scratch / "s.json", text);
  };
  scene(4097);
  const Outcome named = malusIn(scratch.path, "render s.json --out o --write cube,exr");
  EXPECT_EQ(named.code, 2);
  EXPECT_EQ(named.err,
            "command line: --write = exr: allows at most 4096 bands, but the scene has "
            "4097; leave it out\n");
  EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
  const Outcome usual = malusIn(scratch.path, "render s.json --out o");
  EXPECT_EQ(usual.code, 0) << usual.err;
  EXPECT_NE(
      usual.err.find("the output exr allows at most 4096 bands, but the scene has 4097; it is "
                     "left out"),
      std::string::npos)
      << usual.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "o/s.exr"));
  scene(4096);
  const Outcome most = malusIn(scratch.path, "render s.json --out o");
  EXPECT_EQ(most.code, 0) << most.err;
  EXPECT_TRUE(std::filesystem::exists(scratch / "o/s.exr"));
}

TEST(FormatRegistryInvariant, EachFormatIsInTheHelp) {
  const std::string help = malusIn(".", "render --help").out;
  for (const OutputFormat& format : outputFormats())
    EXPECT_NE(help.find(format.name + " ("), std::string::npos) << format.name;
}
