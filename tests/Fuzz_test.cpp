// The doors of tests/fuzz without a fuzzer: inputs that were findings once, and a few random ones (tests/fuzz/corpus, make fuzz;
// nw/base/Error.nw).
// MALUS_FUZZ_INPUTS=100000 MALUS_FUZZ_SEED=7 build/tests/Fuzz_test throws more of them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "Scratch.hpp"

#define MALUS_SCENES "scenes"  // tests run in the project's directory
#define MALUS_DOOR(name) static int name##Door(const std::uint8_t* data, std::size_t size)
#include "fuzz/cube.cpp"
#include "fuzz/measured.cpp"
#include "fuzz/mesh.cpp"
#include "fuzz/scene.cpp"
#include "fuzz/scenes.cpp"
#include "fuzz/table.cpp"

namespace {
using Door = int (*)(const std::uint8_t*, std::size_t);
const std::vector<std::pair<std::string, Door>> doors{
    {"cube", cubeDoor},   {"measured", measuredDoor}, {"mesh", meshDoor},
    {"scene", sceneDoor}, {"scenes", scenesDoor},     {"table", tableDoor}};

int knockWith(Door door, const std::string& bytes) {
  return door(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

unsigned long numberFrom(const char* variable, unsigned long otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::strtoul(text, nullptr, 10) : otherwise;
}
}  // namespace

// Each of these once crashed the program, stopped it with an exception, hung it, or was taken though it is wrong.
TEST(FuzzRegression, FormerFindingsAreOneLineOrASoundThing) {
  std::size_t replayed = 0;
  for (const auto& [name, door] : doors) {
    const std::filesystem::path corpus = "tests/fuzz/corpus/" + name;
    ASSERT_TRUE(std::filesystem::is_directory(corpus)) << corpus;
    for (const auto& file : std::filesystem::directory_iterator(corpus)) {
      SCOPED_TRACE(file.path().string());
      EXPECT_NO_THROW(EXPECT_EQ(knockWith(door, contents(file.path())), 0));
      ++replayed;
    }
  }
  EXPECT_GE(replayed, 20u);
}

// Random bytes make random choices: scenes and files that are valid but for some of their parts.
TEST(FuzzInvariant, RandomChoicesAreOneLineOrASoundThing) {
  const unsigned long inputs = numberFrom("MALUS_FUZZ_INPUTS", 100);
  std::mt19937_64 random(numberFrom("MALUS_FUZZ_SEED", 1));
  const char* only = std::getenv("MALUS_FUZZ_DOOR");
  for (unsigned long i = 0; i < inputs; ++i)
    for (const auto& [name, door] : doors) {
      if ((name != "scenes" && name != "measured") || (only && name != only)) continue;
      std::string bytes(100, '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      if (name == "measured") bytes[0] = "kcme"[i % 4];
      if (std::getenv("MALUS_FUZZ_INPUTS"))
        put(std::filesystem::temp_directory_path() / ("fuzz-last-" + name), bytes);
      EXPECT_NO_THROW(knockWith(door, bytes)) << name << ' ' << i;
    }
}

// The control: an exception other than InputError is noticed, and so is a message of two lines.
TEST(FuzzInvariant, NegativeControlOtherExceptionsEscape) {
  EXPECT_THROW(malus::fuzzing::knock([] { throw std::out_of_range("a vector"); }),
               std::out_of_range);
  EXPECT_EQ(malus::fuzzing::knock([] { throw malus::InputError({}, "a", "b", "c"); }), 0);
}
