// What may happen at a door for users' files: it opens, or it says in one line what is wrong. All else is a finding.
#pragma once
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "malus/base/Error.hpp"
#include "malus/base/InputFiles.hpp"

// A door is a function of bytes. For libFuzzer it has the one name that libFuzzer calls; the test that replays former findings
// (tests/Fuzz_test.cpp) includes all doors, each under its own name.
#ifndef MALUS_DOOR
#define MALUS_DOOR(name) \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#endif

namespace malus::fuzzing {
/// Any exception but InputError escapes, and stops the fuzzer; so does a message of no or many lines, or of no UTF-8.
template <class Open>
int knock(const Open& open) {
  try {
    open();
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    if (message.empty() || message.find('\n') != message.npos || message.size() > 6000 ||
        endOfUTF8(message) != message.npos) {
      std::fprintf(stderr, "not one line of UTF-8: %s\n", error.what());
      std::abort();
    }
  }
  return 0;
}

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return std::string(reinterpret_cast<const char*>(data), size);
}

/// A file of this process with the given end of its name and content.
inline std::filesystem::path fileWith(const std::string& text, const std::string& extension) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("malus-fuzz-" + std::to_string(getpid()) + extension);
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  return path;
}
}  // namespace malus::fuzzing
