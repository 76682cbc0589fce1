// malus merge, from outside (nw/app/CommandMerge.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

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
  render(scratch.path, "--out parts --tile 0,0,256,100");
  render(scratch.path, "--out parts --tile 0,100,90,256");
  render(scratch.path, "--out parts --tile 90,100,256,256");
  const Outcome outcome = malusIn(scratch.path, "merge parts");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"chunky-bar-copper.img", "chunky-bar-copper.truth.img"}) {
    ASSERT_FALSE(contents(scratch.path / "whole" / name).empty());
    EXPECT_EQ(contents(scratch.path / "whole" / name), contents(scratch.path / "parts" / name));
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
  render(scratch.path, "--out good --tile 0,0,256,4");
  render(scratch.path, "--out good --tile 0,4,9,256");
  render(scratch.path, "--out good --tile 9,4,256,256");
  render(scratch.path, "--out twice --tile 0,0,256,128");
  render(scratch.path, "--out twice --tile 0,64,256,192");
  render(scratch.path, "--out other --seed 77 --tile 0,4,9,256");
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
  says("holds no tiles", without("chunky-bar-copper."));
  says("seed = 77", [&](const fs::path& in) {
    fs::copy(scratch / "other", in,
             fs::copy_options::overwrite_existing | fs::copy_options::recursive);
  });
  says(second + ".run.json",
       [&](const fs::path& in) { fs::remove(in / (second + ".run.json")); });
  says("does not tell how its tile was made", [&](const fs::path& in) {
    fs::copy_file(in / (first + ".run.json"), in / (second + ".run.json"),
                  fs::copy_options::overwrite_existing);
  });
  says("does not tell", [&](const fs::path& in) { put(in / (third + ".run.json"), "[]"); });
  says("is not the size of its tile", [&](const fs::path& in) {
    for (const char* ending : {".img", ".img.hdr"})
      fs::copy_file(in / (first + ending), in / (third + ending),
                    fs::copy_options::overwrite_existing);
  });
  says("bytes", [&](const fs::path& in) { fs::resize_file(in / (third + ".img"), 100); });
  says("record that is not ours", [&](const fs::path& in) {
    for (const std::string& part : {first, second, third}) {
      auto word = record(in / (part + ".run.json"));
      word["width"] = "wide";
      put(in / (part + ".run.json"), word.dump());
    }
  });
  // truth comes after light: what the light has become by then must go as well
  says("bytes",
       [&](const fs::path& in) { fs::resize_file(in / (second + ".truth.img"), 100); });
  says("is not what its record says", [&](const fs::path& in) {
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
