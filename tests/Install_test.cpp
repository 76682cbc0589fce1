// The installed tree, as its users meet it: moved to another place, its programs find their libraries and data, and the
// programs of examples/ are built against it and run. Where a build finds its data: DataFiles_test.cpp (nw/base/DataFiles.nw).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "Program.hpp"
#include "Scratch.hpp"

namespace {
namespace fs = std::filesystem;

/// The exit code of a shell command; what it prints goes to `log` in the scratch directory.
int run(const Scratch& scratch, const std::string& command) {
  const std::string log = (scratch.path / "log").string();
  return std::system(("(" + command + ") > " + log + " 2>&1").c_str());
}

TEST(InstallInvariant, AMovedTreeWorksAndLinks) {
  const Scratch scratch;
  const std::string first = (scratch.path / "first").string();
  const std::string moved = (scratch.path / "moved" / "elsewhere").string();
  ASSERT_EQ(run(scratch, "cmake --install " MALUS_BUILD " --prefix " + first), 0);
  fs::create_directories(scratch.path / "moved");
  fs::rename(first, moved);
  // the data: the sun's spectrum, a scene, the printed values
  EXPECT_EQ(
      run(scratch, moved + "/bin/malus sky --wavelength-nm 550 --mu0 0.5 --mu 0.5 --phi-deg "
                           "0 --irradiance astm-e490"),
      0);
  EXPECT_EQ(run(scratch, moved + "/bin/malus reproduce --list"), 0);
  EXPECT_EQ(run(scratch, moved + "/bin/malus render " + moved +
                             "/share/malus/scenes/flat-plate.json --part 0,0,4,4 --out " +
                             (scratch.path / "out").string()),
            0);
  EXPECT_TRUE(fs::exists(scratch.path / "out"));
  // the control: without its data the same program reports it, and ends as for bad input
  fs::rename(moved + "/share", scratch.path / "hidden");
  EXPECT_NE(
      run(scratch, moved + "/bin/malus sky --wavelength-nm 550 --mu0 0.5 --mu 0.5 --phi-deg "
                           "0 --irradiance astm-e490"),
      0);
  fs::rename(scratch.path / "hidden", moved + "/share");
  // the examples
  const std::string build = (scratch.path / "examples").string();
  ASSERT_EQ(run(scratch, "cmake -S examples -B " + build + " -DCMAKE_PREFIX_PATH=" + moved +
                             " && cmake --build " + build),
            0);
  EXPECT_EQ(run(scratch, build + "/reflectance | grep -q '^60,0'"), 0);
  EXPECT_EQ(run(scratch, build + "/polarized_sky | grep -q '^20,0.67'"), 0);
  EXPECT_EQ(run(scratch, build + "/rendered_scene " + moved +
                             "/share/malus/scenes/flat-plate.json | grep -q '^[0-9]'"),
            0);
  // and pkg-config, where it is there
  if (run(scratch, "pkg-config --version") == 0) {
    EXPECT_EQ(
        run(scratch, "cd " + build +
                         " && c++ -o one " MALUS_SOURCE
                         "/examples/polarized_sky.cpp $(PKG_CONFIG_PATH=$(dirname $(find " +
                         moved +
                         " -name malus.pc)) pkg-config --cflags --libs malus) "
                         "-Wl,-rpath,$(dirname $(find " +
                         moved + " -name libmalus.so))"),
        0);
    EXPECT_EQ(run(scratch, build + "/one"), 0);
  }
}
// In a project of one's own: malus is a folder of it, and its targets have the names of the installed ones.
TEST(InstallInvariant, ItIsAFolderOfAnotherProject) {
  const Scratch scratch;
  put(scratch / "mine/CMakeLists.txt",
      "cmake_minimum_required(VERSION 3.21)\nproject(mine CXX)\n"
      "add_subdirectory(" MALUS_SOURCE
      " malus EXCLUDE_FROM_ALL)\n"
      "add_executable(sky " MALUS_SOURCE
      "/examples/polarized_sky.cpp)\n"
      "target_link_libraries(sky PRIVATE malus::malus)\n"
      "get_target_property(options malus::malus INTERFACE_COMPILE_OPTIONS)\n"
      "if(options MATCHES \"Werror|march\")\n  message(FATAL_ERROR \"${options}\")\nendif()\n");
  EXPECT_EQ(run(scratch,
                "cmake -S " + (scratch / "mine").string() + " -B " + (scratch / "b").string()),
            0);
  // the control: a target that malus does not have
  put(scratch / "none/CMakeLists.txt",
      "cmake_minimum_required(VERSION 3.21)\nproject(mine CXX)\n"
      "add_subdirectory(" MALUS_SOURCE
      " malus EXCLUDE_FROM_ALL)\n"
      "add_executable(sky " MALUS_SOURCE
      "/examples/polarized_sky.cpp)\n"
      "target_link_libraries(sky PRIVATE malus::none)\n");
  EXPECT_NE(run(scratch,
                "cmake -S " + (scratch / "none").string() + " -B " + (scratch / "c").string()),
            0);
}

/// Whether a library takes a function or stream from outside that only a program may use; one may be excused.
bool usesWhatIsTheProgramsOwn(const Scratch& scratch, const std::string& library,
                              const std::string& excused = "none") {
  EXPECT_EQ(run(scratch, "nm -D " MALUS_BUILD "/lib/" + library + ".so"), 0) << library;
  return run(scratch,
             "nm -D " MALUS_BUILD "/lib/" + library +
                 ".so | grep -E ' U ((secure_)?getenv|(_|quick_)?exit|abort|stderr|stdout|"
                 "_ZSt4(cerr|cout|clog)|v?f?printf|f?puts|putchar|perror)(@|$)'"
                 " | grep -qvE ' (" +
                 excused + ")(@|$)'") == 0;
}

// A library neither prints nor ends the program that has called it, and the environment is the program's.
TEST(InstallInvariant, LibrariesLeaveTheProgramAlone) {
  const Scratch scratch;
  if (run(scratch, "nm " MALUS_BUILD "/lib/libmalus.so | grep -q __gcov_dump") == 0)
    GTEST_SKIP() << "what counts lines writes files of its own";
  EXPECT_FALSE(usesWhatIsTheProgramsOwn(scratch, "libmalus"));
  // valijson would print in its destructor if a destructor of its parts threw, and none of them
  // does
  EXPECT_FALSE(usesWhatIsTheProgramsOwn(scratch, "libmalus_scenes", "stderr|fprintf"));
  EXPECT_TRUE(
      usesWhatIsTheProgramsOwn(scratch, "libmalus_app"));  // control: this one is a program's
}
}  // namespace
