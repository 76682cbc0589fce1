// Findings about the thesis, and the list of errata against the committed verdicts (nw/thesis/Errata.nw, PlateDigits.nw).

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "Items.hpp"
#include "malus/base/Table.hpp"
#include "malus/thesis/PlateDigits.hpp"

using namespace malus;

namespace {
/// "item/claim" of every erratum in the committed verdicts.
std::set<std::string> committedErrata() {
  const Table table = Table::read("validation/claims.csv");
  std::set<std::string> errata;
  for (std::size_t row = 0; row < table.rows(); ++row)
    if (table.cell(row, "verdict") == "erratum")
      errata.insert(table.cell(row, "item") + "/" + table.cell(row, "claim"));
  return errata;
}

/// Every item/claim in the chapter's list of errata: the words of the last braces of each line \erratum{..}..{..}.
std::set<std::string> listedErrata(const std::string& text) {
  std::set<std::string> errata;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("\\erratum{") || !line.ends_with("}")) continue;
    const std::size_t begin = line.rfind('{') + 1;
    std::istringstream claims(line.substr(begin, line.size() - 1 - begin));
    for (std::string claim; claims >> claim;) errata.insert(claim);
  }
  return errata;
}

std::string chapter() {
  std::ifstream file("nw/thesis/Errata.nw");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
}  // namespace

TEST(ErrataPublished, EveryFindingIsVerified) {
  const std::vector<std::string> findings{"N1", "N2", "N3", "N4",  "N5",
                                          "N6", "N7", "N9", "N10", "N11"};
  for (const std::string& id : findings) {
    // the reading nearest to the digits misses two of them (finding 3)
    const std::set<std::string> known =
        id == "N3" ? std::set<std::string>{"digits"} : std::set<std::string>{};
    EXPECT_EQ(named(ran(id), Verdict::differs), known) << id;
  }
}

// A digit that the nearest reading misses, printed as that reading has it, must change the account of finding 3.
TEST(ErrataPublished, NegativeControlTheJointFitFollowsTheDigits) {
  const auto asPrinted = valuesOf(ran("N3"));
  EXPECT_EQ(asPrinted.at("missed"), "2");
  const Corrupted table("T7.1.csv", "33.91,-39.18,-10.48,51.2,50.2,10.2,103.2",
                        "33.91,-39.18,-10.48,51.2,50.2,10.2,103.3");
  const auto mended = valuesOf(ran("N3", table.data));
  EXPECT_EQ(mended.at("missed"), "1");
}

TEST(ErrataPublished, TheListHoldsAllCommittedErrataAndNoOthers) {
  const std::set<std::string> committed = committedErrata(), listed = listedErrata(chapter());
  for (const std::string& erratum : committed)
    EXPECT_TRUE(listed.contains(erratum)) << erratum << " is not listed";
  for (const std::string& erratum : listed)
    EXPECT_TRUE(committed.contains(erratum)) << erratum << " has no proof";
}

TEST(ErrataPublished, NegativeControlAnInventedErratumIsSeen) {
  const auto listed = listedErrata(chapter() + "\n\\erratum{a}{b}{c}{d}{T7.1/invented}");
  EXPECT_TRUE(listed.contains("T7.1/invented"));
  EXPECT_FALSE(committedErrata().contains("T7.1/invented"));
}

TEST(ErrataPublished, NegativeControlAChangedNumberOfTheTracedColumnIsSeen) {
  const Corrupted table("T7.1.csv", "34.07", "34.17");
  EXPECT_FALSE(named(ran("N7", table.data), Verdict::differs).empty());
}
