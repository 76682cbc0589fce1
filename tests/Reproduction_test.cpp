// The whole reproduction, once: the report that the build keeps up to date with the program and validation/
// (nw/thesis/CommandReproduce.nw). ctest brings it up to date before this test begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "Scratch.hpp"

namespace {
const std::filesystem::path report = MALUS_REPORT;

/// What a report says against a run of all items with the committed verdicts; empty if nothing.
std::string objection(const nlohmann::json& run) {
  if (run.at("whole") != true) return "not all items";
  for (const nlohmann::json& item : run.at("items"))
    if (item.at("failure") != "") return item.at("id").get<std::string>() + " failed";
  if (!run.at("changes").empty()) return "changed: " + run.at("changes").dump();
  return run.at("good") == true ? "" : "not good";
}
}  // namespace

// Regression: what the items say is what we committed after having looked at it.
TEST(ReproduceRegression, EveryVerdictIsTheCommittedOne) {
  nlohmann::json run = nlohmann::json::parse(contents(report / "report.json"));
  EXPECT_EQ(objection(run), "");
  EXPECT_NE(contents(report / "summary.txt").find("every verdict is the committed one\n"),
            std::string::npos);
  EXPECT_NE(contents(report / "values.tex"), "");
  // no item is left out: those that the inventory of the source lists
  const std::string inventory = contents(MALUS_SOURCE_DATA "/inventory.csv");
  for (const nlohmann::json& item : run.at("items"))
    EXPECT_NE(inventory.find("\n" + item.at("id").get<std::string>() + ","), std::string::npos);
  EXPECT_EQ(run.at("items").size() + 3,  // and a title, a source, the names of the columns

            static_cast<std::size_t>(std::count(inventory.begin(), inventory.end(), '\n')));

  // negative controls
  for (const char* spoilt : {R"({"whole": false})", R"({"good": false})",
                             R"({"changes": [{"item": "T3.1", "claim": "S1.positive"}]})"}) {
    nlohmann::json other = run;
    other.merge_patch(nlohmann::json::parse(spoilt));
    EXPECT_NE(objection(other), "") << spoilt;
  }
  run["items"][3]["failure"] = "the reason";
  EXPECT_NE(objection(run), "");
}

// A sentence of the thesis that does not hold for us says in a line what the lost scene could change, or what else is the cause.
TEST(ReproduceRegression, EveryDifferenceFromTheThesisSaysItsCause) {
  const auto silent = [](const nlohmann::json& claim) {
    return claim.at("verdict") == "differs" && claim.at("kind") != "own" &&
           claim.at("cause") == "";
  };
  const nlohmann::json run = nlohmann::json::parse(contents(report / "report.json"));
  std::size_t differing = 0;
  for (const nlohmann::json& item : run.at("items"))
    for (const nlohmann::json& claim : item.at("claims")) {
      EXPECT_FALSE(silent(claim)) << item.at("id") << '/' << claim.at("name");
      differing += claim.at("verdict") == "differs";
    }
  EXPECT_GT(differing, 20u);  // there is something to look at
  EXPECT_TRUE(
      silent({{"verdict", "differs"}, {"kind", "thesis"}, {"cause", ""}}));  // negative control
}

// A report that is older than the program or a file of validation/ would not test them.
TEST(ReproduceRegression, TheReportIsThatOfThisProgramAndItsData) {
  const auto written = std::filesystem::last_write_time(report / "summary.txt");
  EXPECT_GE(written, std::filesystem::last_write_time(MALUS_PROGRAM));
  for (const auto& file : std::filesystem::recursive_directory_iterator(MALUS_SOURCE_DATA))
    if (file.is_regular_file()) {
      EXPECT_GE(written, file.last_write_time()) << file.path();
    }
}
