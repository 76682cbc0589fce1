// What the tests of the thesis chapters ask of an item: run it, sort its claims, spoil a print.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "Scratch.hpp"
#include "light/CDTable.hpp"
#include "program/Harness.hpp"

/// The item after its function ran, on the committed printed values unless `data` says otherwise.
inline malus::CDItem ran(const std::string& id, malus::CDItemFunction function,
                         const std::filesystem::path& data = "validation") {
  const Scratch scratch;  // an item may write files of its own
  malus::CDItem item(id, scratch.path, data);
  function(item);
  return item;
}

/// The verdict, where a label says only that the claim holds.
inline malus::CDVerdict heldOr(malus::CDVerdict verdict) {
  return verdict == malus::CDVerdict::input || verdict == malus::CDVerdict::implementation
             ? malus::CDVerdict::reproduced
             : verdict;
}

/// Names of the claims with this verdict; inputs and properties of the program hold if reproduced.
inline std::set<std::string> named(const malus::CDItem& item, malus::CDVerdict verdict) {
  std::set<std::string> names;
  for (const malus::CDClaim& claim : item.claims())
    if (heldOr(claim.verdict) == verdict) names.insert(claim.name);
  return names;
}

inline std::map<std::string, malus::CDVerdict> verdictsOf(const malus::CDItem& item) {
  std::map<std::string, malus::CDVerdict> verdicts;
  for (const malus::CDClaim& claim : item.claims())
    verdicts[claim.name] = heldOr(claim.verdict);
  return verdicts;
}

/// The numbers that an item leaves for the book's prose.
inline std::map<std::string, std::string> valuesOf(const malus::CDItem& item) {
  std::map<std::string, std::string> values;
  for (const auto& [name, text] : item.values()) values[name] = text;
  return values;
}

/// The project with one text of validation/printed replaced by another, and that file sealed again.
struct Corrupted : Scratch {
  std::filesystem::path data = path / "validation";
  Corrupted(const std::string& file, const std::string& from, const std::string& to) {
    for (const char* folder : {"nw", "tests"})
      std::filesystem::create_directory_symlink(std::filesystem::absolute(folder),
                                                path / folder);
    std::filesystem::create_directory(data);
    std::filesystem::copy("validation/claims.csv", data / "claims.csv");
    std::filesystem::copy("validation/printed", data / "printed",
                          std::filesystem::copy_options::recursive);
    std::string text = contents(data / "printed" / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from << " in " << file;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    put(data / "printed" / file, malus::sealTable(text, file));
  }
};
