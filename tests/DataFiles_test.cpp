// Where the library finds its data (nw/base/DataFiles.nw); installed and moved: Install_test.cpp.
#include "malus/base/DataFiles.hpp"

#include <gtest/gtest.h>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

TEST(DataFilesIdentity, ABuildFindsTheDataOfItsSource) {
  for (const char* name : {"scenes", "validation"}) {
    const std::filesystem::path found = dataFolder(name);
    EXPECT_EQ(found, std::filesystem::canonical(found)) << "the source's own, without links";
    EXPECT_EQ(found.filename(), name);
  }
  EXPECT_TRUE(std::filesystem::exists(dataFolder("scenes") / "chunky-bar-copper.json"));
  EXPECT_TRUE(std::filesystem::exists(dataFolder("validation") / "claims.csv"));
}

TEST(DataFilesIdentity, WhatIsNotThereIsRefusedByItsName) {  // negative control
  try {
    FAIL() << dataFolder("no such folder");
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("share/malus/no such folder"), std::string::npos);
  }
}

TEST(DataFilesIdentity, AnotherFolderMayBeNamed) {
  const std::filesystem::path before = dataFolder("scenes");
  const Scratch scratch;
  setDataDirectory(scratch.path);
  EXPECT_EQ(dataFolder("scenes"), scratch / "scenes");
  setDataDirectory("");
  EXPECT_EQ(dataFolder("scenes"), before) << "beside the library again";
}
