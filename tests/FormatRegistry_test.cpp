// Formats of a render by name (nw/files/FormatRegistry.nw).
#include "malus/files/FormatRegistry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
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
  for (const std::string chosen : {"", "exr", "png", "envi", "png,exr"}) {
    const std::string flag = chosen.empty() ? "" : " --formats " + chosen;
    const Outcome outcome = malusIn(scratch.path, "render s.json --out o" + flag);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::set<std::string> wanted{"s.run.json", "s.truth.img", "s.truth.img.hdr"};
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
  EXPECT_EQ(chosenFormats("", {}).size(), outputFormats().size());
  EXPECT_EQ(chosenFormats("exr", {}).size(), 2u);  // and the cube
}

TEST(FormatRegistryIdentity, AnUnknownFormatIsRefusedBeforeAnythingIsWritten) {
  const Scratch scratch;
  put(scratch / "s.json", small_scene);
  const Outcome unknown = malusIn(scratch.path, "render s.json --out o --formats exr,pgn");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(
      unknown.err,
      "command line: --formats = pgn: is not a format of malus; did you mean png? known are: "
      "envi, exr, png\n");
  const Outcome twice = malusIn(scratch.path, "render s.json --out o --formats exr,exr");
  EXPECT_EQ(twice.code, 2);
  EXPECT_NE(twice.err.find("names exr twice"), std::string::npos) << twice.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "o"));
}

TEST(FormatRegistryInvariant, EachFormatIsInTheHelp) {
  const std::string help = malusIn(".", "render --help").out;
  for (const OutputFormat& format : outputFormats())
    if (!format.always) {
      EXPECT_NE(help.find(format.name + " ("), std::string::npos) << format.name;
    }
}
