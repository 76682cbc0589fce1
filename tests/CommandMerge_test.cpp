// malus merge, from outside (nw/program/CommandMerge.nw).
#include <gtest/gtest.h>

#include "Program.hpp"

namespace {
const std::string scene = std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/chunky-bar-copper.json";
}

TEST(CommandMergeInvariant, PartsMakeTheBitsOfTheWhole) {
  const Scratch scratch;
  for (const char* part : {"", " --tile 0,0,256,100", " --tile 0,100,90,256", " --tile 90,100,256,256"}) {
    const std::string out = *part ? " --out parts" : " --out whole";
    ASSERT_EQ(malusIn(scratch.path, "render '" + scene + "'" + out + part).code, 0);
  }
  const Outcome outcome = malusIn(scratch.path, "merge parts");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* name : {"chunky-bar-copper.img", "chunky-bar-copper.truth.img"}) {
    ASSERT_FALSE(contents(scratch.path / "whole" / name).empty());
    EXPECT_EQ(contents(scratch.path / "whole" / name), contents(scratch.path / "parts" / name));
  }
  std::filesystem::remove(scratch / "parts/chunky-bar-copper.0-100-90-256.img");  // the negative control: a hole
  const Outcome hole = malusIn(scratch.path, "merge parts");
  EXPECT_EQ(hole.code, 2);
  EXPECT_NE(hole.err.find("render the missing tiles"), std::string::npos) << hole.err;
  std::filesystem::create_directory(scratch / "empty");
  EXPECT_EQ(malusIn(scratch.path, "merge empty").code, 2);
}
