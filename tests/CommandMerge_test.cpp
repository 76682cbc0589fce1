// malus merge, from outside (nw/app/CommandMerge.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "Program.hpp"

namespace fs = std::filesystem;

namespace {
const std::string scene =
    fs::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/chunky-bar-copper.json";
const std::string upper = "chunky-bar-copper.0-0-256-100";

void render(const fs::path& directory, const std::string& flags) {
  const Outcome outcome = malusIn(directory, "render '" + scene + "' " + flags);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
}

nlohmann::json record(const fs::path& path) { return nlohmann::json::parse(contents(path)); }
}  // namespace

TEST(CommandMergeInvariant, PartsMakeTheBitsOfTheWhole) {
  const Scratch scratch;
  render(scratch.path, "--out whole");
  render(scratch.path, "--out parts --part 0,0,256,100");
  render(scratch.path, "--out parts --part 0,100,90,256");
  render(scratch.path, "--out parts --part 90,100,256,256");
  const Outcome outcome = malusIn(scratch.path, "merge parts");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* ending :
       {".img", ".truth.img", ".img.hdr", ".exr", ".S0.png", ".AoLP.png"}) {
    const std::string name = std::string("chunky-bar-copper") + ending;
    ASSERT_FALSE(contents(scratch.path / "whole" / name).empty()) << name;
    EXPECT_EQ(contents(scratch.path / "whole" / name), contents(scratch.path / "parts" / name))
        << name;
  }
  const auto whole = record(scratch / "whole/chunky-bar-copper.run.json");
  const auto merged = record(scratch / "parts/chunky-bar-copper.run.json");
  const auto part = record(scratch / ("parts/" + upper + ".run.json"));
  EXPECT_EQ(merged["rays_followed"], whole["rays_followed"]);
  EXPECT_NE(merged["rays_followed"], part["rays_followed"]);  // the negative control
  EXPECT_EQ(merged["tile"], whole["tile"]);
  EXPECT_EQ(merged["merged_from"].size(), 3u);
}

// Every way to spoil a directory of parts, and a word of the sentence it must lead to.
TEST(CommandMergeInvariant, WhatDoesNotBelongTogetherIsRefused) {
  const Scratch scratch;
  render(scratch.path, "--out good --write cube,truth --part 0,0,256,4");
  render(scratch.path, "--out good --write cube,truth --part 0,4,9,256");
  render(scratch.path, "--out good --write cube,truth --part 9,4,256,256");
  render(scratch.path, "--out twice --write cube,truth --part 0,0,256,128");
  render(scratch.path, "--out twice --write cube,truth --part 0,64,256,192");
  render(scratch.path, "--out other --write cube,truth --seed 77 --part 0,4,9,256");
  const std::string first = "chunky-bar-copper.0-0-256-4",
                    second = "chunky-bar-copper.0-4-9-256",
                    third = "chunky-bar-copper.9-4-256-256";
  const auto complaint = [&](const std::function<void(const fs::path&)>& spoil) {
    const fs::path spoilt = scratch / "spoilt";
    fs::remove_all(spoilt);
    fs::copy(scratch / "good", spoilt);
    spoil(spoilt);
    const std::size_t before = filesBelow(spoilt);
    const Outcome outcome = malusIn(scratch.path, "merge spoilt");
    if (outcome.code == 0) return std::string("none");
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(filesBelow(spoilt), before) << outcome.err;
    return outcome.err;
  };
  const auto without = [&](const std::string& part) {
    return [part](const fs::path& in) {
      for (const auto& entry : fs::directory_iterator(in))
        if (entry.path().filename().string().starts_with(part)) fs::remove(entry.path());
    };
  };
  const auto says = [&](const std::string& part,
                        const std::function<void(const fs::path&)>& spoil) {
    const std::string sentence = complaint(spoil);
    EXPECT_NE(sentence.find(part), std::string::npos) << part << " in: " << sentence;
  };
  EXPECT_EQ(complaint([](const fs::path&) {}), "none");  // the negative control
  says("render the missing tiles", without(second));
  // along the lower edge: the tile that is left is a rectangle without a seam
  says("1024 pixels: do not make 256 x 256",
       [&](const fs::path& in) { without(second)(in), without(third)(in); });
  // as many pixels as the picture has, but the upper half of the second tile is there twice and as
  // many rows at the lower edge are missing
  says("65536 pixels: do not make 256 x 256", [&](const fs::path& in) {
    without("chunky-bar-copper.")(in);
    fs::copy(scratch / "twice", in, fs::copy_options::recursive);
  });
  says("has no finished tiles", without("chunky-bar-copper."));
  says("seed = 77", [&](const fs::path& in) {
    fs::copy(scratch / "other", in,
             fs::copy_options::overwrite_existing | fs::copy_options::recursive);
  });
  says(second + ".run.json",
       [&](const fs::path& in) { fs::remove(in / (second + ".run.json")); });
  says("does not record how its tile was made", [&](const fs::path& in) {
    fs::copy_file(in / (first + ".run.json"), in / (second + ".run.json"),
                  fs::copy_options::overwrite_existing);
  });
  says("does not record", [&](const fs::path& in) { put(in / (third + ".run.json"), "[]"); });
  says("is not the size of its tile", [&](const fs::path& in) {
    for (const char* ending : {".img", ".img.hdr"})
      fs::copy_file(in / (first + ending), in / (third + ending),
                    fs::copy_options::overwrite_existing);
  });
  says("bytes", [&](const fs::path& in) { fs::resize_file(in / (third + ".img"), 100); });
  says("record that malus render did not write", [&](const fs::path& in) {
    for (const std::string& part : {first, second, third}) {
      auto word = record(in / (part + ".run.json"));
      word["width"] = "wide";
      put(in / (part + ".run.json"), word.dump());
    }
  });
  // truth comes after light: what the light has become by then must go as well
  says("bytes",
       [&](const fs::path& in) { fs::resize_file(in / (second + ".truth.img"), 100); });
  says("differs from its record", [&](const fs::path& in) {
    std::fstream file(in / (third + ".truth.img"),
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4711);
    file.put('x');
  });
  // a refused merge leaves the result of a former one alone
  ASSERT_EQ(malusIn(scratch.path, "merge good").code, 0);
  const std::string before = contents(scratch / "good/chunky-bar-copper.img");
  fs::remove(scratch / ("good/" + second + ".truth.img"));
  EXPECT_EQ(malusIn(scratch.path, "merge good").code, 2);
  EXPECT_EQ(contents(scratch / "good/chunky-bar-copper.img"), before);
  EXPECT_EQ(malusIn(scratch.path, "merge nowhere").code, 2);
}

// ---------------------------------------------------------------- equal parts of a film

namespace {
/// A flight of three frames of 40 x 33 pixels behind a mosaic of polarisers with noise, which looks straight down: 9
/// tiles a frame, five of them smaller than the others.
struct Flight {
  Scratch scratch;
  Flight() {
    const fs::path scenes = fs::path(scene).parent_path();
    std::ifstream file(scenes / "flight-nadir.json");
    auto flight = nlohmann::json::parse(file, nullptr, true, true);
    flight["geometry"][0]["obj"] = (scenes / "chunky-bar.obj").string();
    flight["sensor"] = {{"kind", "framing"},
                        {"width", 40},
                        {"height", 33},
                        {"field_of_view_deg", 36.87},
                        {"polarimeter",
                         {{"mosaic", nlohmann::json::parse(R"([
                            [{"polarizer_deg": 90}, {"polarizer_deg": 45}],
                            [{"polarizer_deg": 135}, {"polarizer_deg": 0}]])")},
                          {"recover", {"S0", "S1", "S2"}},
                          {"noise", {{"electrons_per_unit", 1e4}}}}}};
    flight["platform"]["frames"] = 3, flight["platform"]["interval_s"] = 4;
    flight["radiometry"]["rays"] = {9, 1};
    put(scratch / "s.json", flight.dump(1));
  }
  void render(const std::string& flags) const {
    const Outcome outcome = malusIn(scratch.path, "render s.json " + flags);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  Outcome merge(const std::string& directory) const {
    return malusIn(scratch.path, "merge " + directory);
  }
};

/// A record without the entries that distinguish a merge from a single run.
nlohmann::json bare(const fs::path& path) {
  nlohmann::json made = record(path);
  for (const char* key : {"command", "seconds", "merged_from"}) made.erase(key);
  return made;
}

/// Names of files in `whole` that are not the same bytes in `parts`.
std::vector<std::string> different(const fs::path& whole, const fs::path& parts) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(whole)) {
    const std::string name = entry.path().filename().string();
    const bool same = name.ends_with(".run.json")
                          ? fs::exists(parts / name) && bare(entry) == bare(parts / name)
                          : contents(entry) == contents(parts / name);
    if (!same) names.push_back(name);
  }
  return names;
}
}  // namespace

TEST(CommandMergeInvariant, EqualPartsMakeTheBitsOfAllFilesOfAFilm) {
  const Flight flight;
  flight.render("--out whole");
  for (int k = 1; k <= 5; ++k) flight.render(fmt::format("--out parts --part {}/5", k));
  // three frames of ENVI and EXR, of cubes behind filters and without, of pictures of each
  ASSERT_GT(filesBelow(flight.scratch / "whole"), 60u);
  EXPECT_EQ(different(flight.scratch / "whole", flight.scratch / "parts").size(),
            filesBelow(flight.scratch / "whole"));  // no final file before the merge
  const Outcome merged = flight.merge("parts");
  ASSERT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(different(flight.scratch / "whole", flight.scratch / "parts"),
            std::vector<std::string>{});
  flight.render("--out other --seed 7");  // the negative control
  EXPECT_GT(different(flight.scratch / "whole", flight.scratch / "other").size(), 30u);
}

TEST(CommandMergeInvariant, AsManyPartsAsTilesAndChosenFormatsMakeTheSameBits) {
  const Flight flight;
  flight.render("--out whole --frames 1 --write cube,truth,exr --interleave bsq");
  for (int k = 1; k <= 9; ++k)
    flight.render(fmt::format(
        "--out parts --frames 1 --write cube,truth,exr --interleave bsq --part {}/9", k));
  const Outcome merged = flight.merge("parts");
  ASSERT_EQ(merged.code, 0) << merged.err;
  EXPECT_TRUE(fs::exists(flight.scratch / "parts/s.0001.exr"));
  EXPECT_FALSE(fs::exists(flight.scratch / "parts/s.0001.S0.png"));
  EXPECT_EQ(different(flight.scratch / "whole", flight.scratch / "parts"),
            std::vector<std::string>{});
}

TEST(CommandMergeInvariant, TheCommandForMissingPartsMakesThem) {
  const Flight flight;
  flight.render("--out whole --write cube,truth,exr");
  for (int k : {1, 2, 4, 5, 6, 7})
    flight.render(fmt::format("--out p --write cube,truth,exr --part {}/7", k));
  // a node's files are lost, and another one has lost a single cube
  fs::remove(flight.scratch / "p/s.0002.part-6-of-7.truth.img");
  fs::rename(flight.scratch / "p", flight.scratch / "q");  // and all was copied elsewhere
  const std::size_t before = filesBelow(flight.scratch / "q");
  const Outcome refused = flight.merge("q");
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(filesBelow(flight.scratch / "q"), before);
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
  // 27 tiles in 7 parts: the first six have four. By hand: part 3 has places 8 to 11 of the row, part 6 places 20 to
  // 23; so one tile of frame 0, three of frame 1 and four of frame 2
  for (const char* word : {"lacks 8 of 27 tiles", "1 of frame 0", "3 of frame 1",
                           "4 of frame 2", "part 3,6 of 7 does not exist"})
    EXPECT_NE(refused.err.find(word), std::string::npos) << word << " in " << refused.err;
  const std::string command = refused.err.substr(refused.err.find("; run ") + 6);
  EXPECT_EQ(command,
            "for k in 3 6; do malus render s.json --part $k/7 --write cube,truth,exr --out q "
            "--resume; "
            "done\n");
  const Outcome remedy =
      runIn(flight.scratch.path, "{ malus() { '" MALUS_PROGRAM "' \"$@\"; }; " +
                                     command.substr(0, command.size() - 1) + "; }");
  ASSERT_EQ(remedy.code, 0) << remedy.err;
  ASSERT_EQ(flight.merge("q").code, 0);
  EXPECT_EQ(different(flight.scratch / "whole", flight.scratch / "q"),
            std::vector<std::string>{});
}

// mpirun's processes get their number from the environment: the first merges, the others leave
// it to that one.
TEST(CommandMergeInvariant, OneOfSeveralProcessesMerges) {
  const Flight flight;
  for (int k : {1, 2})
    flight.render(fmt::format("--out p --frames 0 --write cube,truth --part {}/2", k));
  const std::size_t before = filesBelow(flight.scratch / "p");
  const auto rank = [&](int number) {
    return malusIn(flight.scratch.path, "merge p",
                   fmt::format("OMPI_COMM_WORLD_SIZE=2 PMIX_RANK={}", number));
  };
  const Outcome second = rank(1);
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.out + second.err, "");
  EXPECT_EQ(filesBelow(flight.scratch / "p"), before);
  EXPECT_EQ(rank(0).code, 0);
  EXPECT_TRUE(fs::exists(flight.scratch / "p/s.0000.img"));
}

// The line is for where the merge is typed, though the parts were rendered elsewhere, among names with blanks.
TEST(CommandMergeInvariant, TheCommandForMissingPartsRunsWhereTheMergeIsTyped) {
  const Flight flight;
  const fs::path work = flight.scratch / "a scene", merge_from = flight.scratch / "b c";
  fs::create_directory(work), fs::create_directory(merge_from);
  fs::rename(flight.scratch / "s.json", work / "my film's.json");
  const std::string words = "render \"my film's.json\" --write cube,truth --out ";
  ASSERT_EQ(malusIn(work, words + "../whole").code, 0);
  for (int k : {1, 3})
    ASSERT_EQ(malusIn(work, words + fmt::format("'../b c/my parts' --part {}/4", k)).code, 0);
  const Outcome refused = malusIn(merge_from, "merge 'my parts'");
  EXPECT_EQ(refused.code, 2);
  const std::string command = refused.err.substr(refused.err.find("; run ") + 6);
  EXPECT_EQ(command,
            fmt::format("cd '{}/a scene' && for k in 2 4; do malus render 'my "
                        "film'\\''s.json' --part $k/4 --write cube,truth --out '{}/my parts' "
                        "--resume; done\n",
                        fs::canonical(flight.scratch.path).string(),
                        fs::canonical(merge_from).string()));
  const Outcome remedy = runIn(merge_from, "{ malus() { '" MALUS_PROGRAM "' \"$@\"; }; " +
                                               command.substr(0, command.size() - 1) + "; }");
  ASSERT_EQ(remedy.code, 0) << remedy.err;
  ASSERT_EQ(malusIn(merge_from, "merge 'my parts'").code, 0);
  for (const char* name : {"my film's.0000.img", "my film's.0002.truth.img"})
    EXPECT_EQ(contents(merge_from / "my parts" / name),
              contents(flight.scratch / "whole" / name));
}

TEST(CommandMergeInvariant, PartsOfAnotherRunAreRefused) {
  const Flight flight;
  for (int k = 1; k <= 3; ++k)
    flight.render(fmt::format("--out good --write cube,truth --part {}/3", k));
  // each part has its own frame, so that only the whole film shows it
  flight.render("--out seed --write cube,truth --seed 7 --part 2/3");
  flight.render("--out exr --write cube,truth,exr --part 2/3");
  flight.render("--out four --write cube,truth --part 2/4");
  flight.render("--out rectangle --write cube,truth --frames 1 --part 0,0,40,30");
  flight.render("--out rectangle --write cube,truth --frames 1 --part 0,30,40,33");
  const auto complaint = [&](const std::function<void(const fs::path&)>& spoil) {
    const fs::path spoilt = flight.scratch / "spoilt";
    fs::remove_all(spoilt);
    fs::copy(flight.scratch / "good", spoilt);
    spoil(spoilt);
    const std::size_t before = filesBelow(spoilt);
    const Outcome outcome = flight.merge("spoilt");
    if (outcome.code == 0) return std::string("none");
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(filesBelow(spoilt), before) << outcome.err;
    return outcome.err;
  };
  const auto with = [&](const std::string& other) {
    return [from = flight.scratch / other](const fs::path& in) {
      fs::copy(from, in, fs::copy_options::overwrite_existing | fs::copy_options::recursive);
    };
  };
  const auto rewritten = [](const std::string& name, const std::string& key,
                            const auto& value) {
    return [=](const fs::path& in) {
      auto changed = record(in / name);
      changed[key] = value;
      put(in / name, changed.dump());
    };
  };
  const std::string second = "s.0001.part-2-of-3.run.json";
  const auto says = [&](const std::string& word,
                        const std::function<void(const fs::path&)>& spoil) {
    const std::string sentence = complaint(spoil);
    EXPECT_NE(sentence.find(word), std::string::npos) << word << " in: " << sentence;
  };
  EXPECT_EQ(complaint([](const fs::path&) {}), "none");  // the negative control
  says("seed = 7", with("seed"));
  says("formats = ", with("exr"));
  says("dealt[\"parts\"] = 4: is not that of spoilt/s.0000.part-1-of-3.run.json: 3",
       with("four"));
  const auto mesh = [&](const nlohmann::json& sum) {
    return [&, sum](const fs::path& in) {
      auto changed = record(in / second);
      const auto of = [](const auto& item) { return item.key().ends_with("chunky-bar.obj"); };
      const auto items = changed["files"].items();
      const auto found = std::find_if(items.begin(), items.end(), of);
      changed["files"][found.key()] = sum;
      put(in / second, changed.dump());
    };
  };
  says("chunky-bar.obj\"] = \"00000000\": is not that of ", mesh("00000000"));
  says("s.0001: exists both in rectangles and in equal parts", with("rectangle"));
  says("scene_crc32 = ", rewritten(second, "scene_crc32", "00000000"));
  says("program = \"malus 0.0.1\"", rewritten(second, "program", "malus 0.0.1"));
  says("sources = \"0123456789ab\": is not that of ",
       rewritten(second, "sources", "0123456789ab"));
  says(
      "sources = \"0123456789ab\": is not the program that merges, malus 0.1.0 of the "
      "sources " +
          record(flight.scratch / "good" / second)["sources"].get<std::string>(),
      [&](const fs::path& in) {
        for (int k : {1, 2, 3})
          rewritten(fmt::format("s.{:04}.part-{}-of-3.run.json", k - 1, k), "sources",
                    "0123456789ab")(in);
      });
  says("does not record how its tiles were distributed", rewritten(second, "part", 3));
  says("is not a frame of part 2 of 3", rewritten(second, "frame", 2));
  says("record that malus render did not write", rewritten(second, "frame", "x"));
  // a cube is looked at when its frame is put together: the frames before it are whole, of this one there is nothing
  fs::remove_all(flight.scratch / "spoilt");
  fs::copy(flight.scratch / "good", flight.scratch / "spoilt");
  put(flight.scratch / "spoilt/s.0001.part-2-of-3.truth.img",
      std::string(contents(flight.scratch / "good/s.0001.part-2-of-3.truth.img").size(), 'x'));
  const Outcome damaged = flight.merge("spoilt");
  EXPECT_EQ(damaged.err,
            "spoilt/s.0001.part-2-of-3.truth.img: differs from its record; render this part "
            "again\n");
  EXPECT_TRUE(fs::exists(flight.scratch / "spoilt/s.0000.run.json"));
  for (const char* name : {"s.0001.run.json", "s.0001.img", "s.0001.img.part", "s.0002.img"})
    EXPECT_FALSE(fs::exists(flight.scratch / "spoilt" / name)) << name;
}

TEST(CommandMergeIdentity, NumbersOfPartsThatCannotBeAreRefused) {
  const Flight flight;
  for (const auto& [part, word] :
       {std::pair{"4/3", "is not one of 3 parts"},
        {"0/3", "is not one of 3 parts"},
        {"0/0", "is not one of 0 parts"},
        {"1/28", "makes more parts than 3 frames have tiles, 27"},
        {"1/18446744073709551615", "makes more parts than 3 frames have tiles, 27"},
        {"1/18446744073709551616", "is too large"},
        {"1/2/3", "must have 2 numbers"},
        {"/3", "does not consist of whole numbers"},
        {"-1/3", "does not consist of whole numbers"}}) {
    const Outcome outcome =
        malusIn(flight.scratch.path, std::string("render s.json --out o --part ") + part);
    EXPECT_EQ(outcome.code, 2) << part;
    EXPECT_EQ(outcome.err, "command line: --part = " + std::string(part) + ": " + word +
                               "; give K/N with K from 1 to N, and N from 1 to 27\n");
  }
  EXPECT_FALSE(fs::exists(flight.scratch / "o"));
  const Outcome former = malusIn(flight.scratch.path, "render s.json --out o --tile 0,0,4,4");
  EXPECT_EQ(former.code, 2);
  EXPECT_EQ(former.err, "command line: --tile: is now called --part; write --part\n");
}
