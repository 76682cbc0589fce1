// Common code for the tests of the thesis chapters: run an item, sort its claims, falsify a printed
// number.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "Scratch.hpp"
#include "malus/base/Table.hpp"
#include "malus/thesis/Inventory.hpp"

/// The item after its function ran, on the committed printed values unless `data` says otherwise.
inline malus::Item ran(const std::string& id,
                       const std::filesystem::path& data = "validation") {
  const Scratch scratch;  // an item may write its own files
  malus::Item item(id, scratch.path, data);
  malus::functionOf(id, malus::registeredItems())(item);
  return item;
}

/// The verdict, where a label says only that the claim holds.
inline malus::Verdict heldOr(malus::Verdict verdict) {
  return verdict == malus::Verdict::input || verdict == malus::Verdict::implementation
             ? malus::Verdict::reproduced
             : verdict;
}

/// Names of the claims with this verdict; inputs and properties of the program hold if reproduced.
inline std::set<std::string> named(const malus::Item& item, malus::Verdict verdict) {
  std::set<std::string> names;
  for (const malus::Claim& claim : item.claims())
    if (heldOr(claim.verdict) == verdict) names.insert(claim.name);
  return names;
}

inline std::map<std::string, malus::Verdict> verdictsOf(const malus::Item& item) {
  std::map<std::string, malus::Verdict> verdicts;
  for (const malus::Claim& claim : item.claims()) verdicts[claim.name] = heldOr(claim.verdict);
  return verdicts;
}

/// The numbers that an item leaves for the book's prose.
inline std::map<std::string, std::string> valuesOf(const malus::Item& item) {
  std::map<std::string, std::string> values;
  for (const auto& [name, text] : item.values()) values[name] = text;
  return values;
}

/// The project with a text of validation/printed replaced by another, and that file sealed again.
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
    also(file, from, to);
  }
  void also(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = contents(data / "printed" / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from << " in " << file;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    put(data / "printed" / file, malus::sealTable(text, file));
  }
};
