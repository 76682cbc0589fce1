// One run, reported in three ways (nw/thesis/Report.nw).
#include "malus/thesis/Report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "Scratch.hpp"

using namespace malus;

namespace {
Reproduction sampleRun() {
  ItemResult one{{"T1", "table", "One & only", "page 1"},
                 {},
                 {{"curve", "A <curve>", true}},
                 {"curve"},
                 {{"a", "1.5"}},
                 ""};
  one.claims = {{"r", "1.25", "1.2512", "half a unit", Verdict::reproduced, 0.0012},
                {"e", "104.07", "102.07", "digits", Verdict::erratum, -2.0},
                {"d", "", "seen \"so\"", "", Verdict::differs},
                {"n", "", "", "the scan", Verdict::notTestable}};
  one.claims[0].row.sentence = "a < b";
  one.claims[2].row.sentence = "sentence";
  ItemResult two{{"T2", "table", "Two", ""}, {}, {}, {}, {}, "it broke"};
  Reproduction run;
  run.items = {one, two};
  run.changes = {{"T1", "r", "differs", "reproduced"}, {"T1", "x", "erratum", ""}};
  return run;
}

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t number = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++number;
  return number;
}
}  // namespace

TEST(ReportIdentity, TheSummaryTellsCountsFailuresAndChanges) {
  EXPECT_EQ(
      summaryText(sampleRun(), "out"),
      "r reproduced   e erratum   d differs   n not testable   i input or implementation\n"
      "T1      1 r   1 e   1 d   1 n T2     FAILED\n"
      "2 items\n"
      "the thesis: 4 sentences and printed numbers: 1 reproduced, 1 erratum, 1 differs, 1 "
      "not testable\n"
      "ours:       0 reproduced, 0 erratum, 0 differs, 0 not testable; 0 inputs and 0 "
      "properties of the program hold\n"
      "differs T1 d: sentence\n"
      "FAILED T2: it broke\n"
      "CHANGED T1 r: committed differs, now reproduced\n"
      "CHANGED T1 x: committed erratum, now gone\n"
      "every claim: out/report.json\n");
}

// Of eleven claims that are reproduced, one repeats, three are fitted with two unknowns, two are ours, and two have labels.
TEST(ReportIdentity, RepeatsLabelsAndUnknownsAreNotCounted) {
  Reproduction run = sampleRun();
  auto& claims = run.items[0].claims;
  const Claim holds = claims[0];
  claims.assign(11, holds);
  claims[1].row.repeats = "T1/r";
  for (const int i : {2, 3, 4})
    claims[i].row.kind = ClaimKind::fitted, claims[i].row.fit = "sun",
    claims[i].row.unknowns = 2;
  for (const int i : {5, 6}) claims[i].row.kind = ClaimKind::own;
  claims[7].row.kind = ClaimKind::input, claims[7].verdict = Verdict::input;
  claims[8].row.kind = ClaimKind::implementation, claims[8].verdict = Verdict::implementation;
  const std::string text = summaryText(run, "out");
  EXPECT_NE(text.find("the thesis: 4 sentences and printed numbers: 4 reproduced, 0 erratum"),
            std::string::npos)
      << text;  // three others and one of the fit
  EXPECT_NE(text.find("3 fitted rows count as 1\n"), std::string::npos);
  EXPECT_NE(text.find("1 rows repeat others"), std::string::npos);
  EXPECT_NE(text.find("ours:       2 reproduced"), std::string::npos);
  EXPECT_NE(text.find("1 inputs and 1 properties"), std::string::npos);
  EXPECT_NE(text.find("T1      8 r   2 i"), std::string::npos);
}

TEST(ReportIdentity, OneScreenHoldsManyItemsAndManyChanges) {
  Reproduction run = sampleRun();
  run.items.resize(60, run.items[0]);
  run.changes.resize(100, run.changes[0]);
  EXPECT_LE(occurrences(summaryText(run, "out"), "\n"), 50u);
  EXPECT_NE(summaryText(run, "out").find("... and 90 more\n"), std::string::npos);
}

TEST(ReportIdentity, TheJsonHoldsTheRun) {
  const auto json = nlohmann::json::parse(reportJson(sampleRun()));
  EXPECT_EQ(json["good"], false);
  EXPECT_EQ(json["counts"]["erratum"], 1);
  EXPECT_EQ(json["changes"][1]["now"], "");
  const auto& claims = json["items"][0]["claims"];
  ASSERT_EQ(claims.size(), 4u);
  EXPECT_EQ(claims[0]["residual"], 0.0012);
  EXPECT_TRUE(claims[2]["residual"].is_null());
  EXPECT_EQ(claims[3]["verdict"], "not testable");
  EXPECT_EQ(json["items"][0]["pictures"][0]["file"], "T1/curve.svg");
  EXPECT_EQ(json["items"][0]["values"]["a"], "1.5");
  EXPECT_EQ(json["items"][1]["failure"], "it broke");
}

TEST(ReportIdentity, ValuesBecomeCommands) {
  EXPECT_NE(valuesTex(sampleRun()).find("\n\\malusval{T1.a}{1.5}\n"), std::string::npos);
}

TEST(ReportInvariant, APartialRunLeavesTheWholeReportAlone) {
  const Scratch scratch;
  Reproduction run = sampleRun();
  writeReport(run, scratch / "out");
  const std::string whole = contents(scratch / "out/report.json"),
                    values = contents(scratch / "out/values.tex");
  run.whole = false;
  run.items.pop_back();
  writeReport(run, scratch / "out");
  EXPECT_EQ(contents(scratch / "out/report.json"), whole);
  EXPECT_EQ(contents(scratch / "out/values.tex"), values);
  EXPECT_NE(contents(scratch / "out/partial.json"), "");
  EXPECT_EQ(filesBelow(scratch / "out"), 5u);
}

TEST(ReportInvariant, TwoReportsOfOneRunAreTheSameBytes) {
  EXPECT_EQ(summaryText(sampleRun(), "out"), summaryText(sampleRun(), "out"));
  EXPECT_EQ(reportJson(sampleRun()), reportJson(sampleRun()));
}
