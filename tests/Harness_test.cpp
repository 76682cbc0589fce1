// Items, claims, verdicts and what changed (nw/program/Harness.nw).
#include "program/Harness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "Scratch.hpp"

using namespace malus;

namespace {
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

CDItem freshItem() { return CDItem("T0", "nowhere", "nowhere"); }

CDVerdict last(const CDItem& item) { return item.claims().back().verdict; }

// what the items of a small inventory do; each states claims of its own kind
void everyVerdict(CDItem& item) {
  item.printed("good", "rounds", "1.25", 1.2512);
  item.erratum("misprint", "a digit is wrong", "104.07", "102.07", 102.068, "its error column");
  item.statement("bad", "does not hold", false, "seen");
  item.notTestable("lost", "measured points", "the scan");
  item.table("curve", {"x_deg", "y"}).row({0, 1.0}).row({10, 2.0});
  item.picture("curve", "A curve");
  item.value("answer", "42");
}
void throwing(CDItem& item) {
  item.statement("first", "holds", true, "seen");
  item.table("half", {"x"}).row({1});
  throw std::runtime_error("the second half is missing");
}
void silent(CDItem&) {}

const std::vector<CDRegisteredItem> functions{
    {"T1", everyVerdict}, {"T2", throwing}, {"T3", silent}};

/// A data directory with an inventory of four items (T4 is not built) and T1's verdicts committed.
struct Data : Scratch {
  explicit Data(
      const std::string& verdicts =
          "T1,good,reproduced\nT1,misprint,erratum\nT1,bad,differs\nT1,lost,not testable\n") {
    put(path / "inventory.csv",
        "id,kind,title,place\nT1,table,One,page "
        "1\nT2,table,Two,\nT3,table,Three,\nT4,table,Four,\n");
    put(path / "verdicts.csv", "item,claim,verdict\n" + verdicts);
    put(path / "plots" / "curve.gp",
        "if (term eq 'svg') set terminal svg; else set terminal pngcairo\nset output out\n"
        "set datafile separator ','\nplot 'curve.csv' using 1:2 with lines\n");
  }
  CDRun run(std::vector<std::string> ids) const {
    return reproduce({std::move(ids), path / "out", path}, readInventory(path), functions);
  }
};

std::string complaint(const Data& data, const std::string& id) {
  try {
    data.run({id});
  } catch (const CDInputError& error) {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(HarnessIdentity, HalfAUnitOfTheLastPrintedDigitDecides) {
  EXPECT_TRUE(CDPrinted("-66.60").meets(-66.604));
  EXPECT_FALSE(CDPrinted("-66.60").meets(-66.606));
  EXPECT_TRUE(CDPrinted(".0056").meets(0.00564));
  EXPECT_FALSE(CDPrinted(".0056").meets(0.00566));
  EXPECT_TRUE(CDPrinted("1.5e-3").meets(0.00154));
  EXPECT_FALSE(CDPrinted("1.5e-3").meets(0.00156));
  EXPECT_TRUE(CDPrinted("12E2").meets(1249));
  EXPECT_FALSE(CDPrinted("12E2").meets(1251));
  EXPECT_TRUE(
      CDPrinted("1.25").meets(1.255));  // on the boundary: either side is a rounding of ours
  EXPECT_FALSE(CDPrinted("1.25").meets(not_a_number));
  EXPECT_THROW((void)CDPrinted("1,25"), CDInputError);
}

TEST(HarnessIdentity, PrintedAndWithin) {
  CDItem item = freshItem();
  item.printed("a", "t", "102.2", 102.249);
  EXPECT_EQ(last(item), CDVerdict::reproduced);
  EXPECT_EQ(item.claims().back().ours, "102.24900");
  EXPECT_NEAR(item.claims().back().residual, 0.049, 1e-12);  // rounding
  item.printed("b", "t", "102.2", 102.251);
  EXPECT_EQ(last(item), CDVerdict::differs);
  item.within("c", "t", 1, 1 + 1e-13, 1e-12, "rounding");
  EXPECT_EQ(last(item), CDVerdict::reproduced);
  item.within("d", "t", 1, 1 + 1e-11, 1e-12, "rounding");
  EXPECT_EQ(last(item), CDVerdict::differs);
  item.within("e", "t", 1, not_a_number, 1e9, "NaN is near nothing");
  EXPECT_EQ(last(item), CDVerdict::differs);
}

TEST(HarnessIdentity, AnErratumNeedsBothHalves) {
  CDItem item = freshItem();
  item.erratum("a", "t", "104.07", "102.07", 102.07, "e");
  EXPECT_EQ(last(item), CDVerdict::erratum);
  item.erratum("b", "t", "104.07", "102.07", 104.07, "the print is met after all");
  EXPECT_EQ(last(item), CDVerdict::reproduced);
  item.erratum("c", "t", "104.07", "102.07", 103.0, "neither is met");
  EXPECT_EQ(last(item), CDVerdict::differs);
  item.erratumStatement("d", "t", true, true, "e");
  EXPECT_EQ(last(item), CDVerdict::erratum);
  item.erratumStatement("e", "t", false, true, "e");
  EXPECT_EQ(last(item), CDVerdict::reproduced);
  item.erratumStatement("f", "t", true, false, "e");
  EXPECT_EQ(last(item), CDVerdict::differs);
}

TEST(HarnessIdentity, AClaimIsStatedOnce) {
  CDItem item = freshItem();
  item.statement("a", "t", true, "e");
  EXPECT_THROW(item.statement("a", "t", true, "e"), CDInvariantError);
}

TEST(HarnessInvariant, ARunLeavesDataPicturesAndNoComplaint) {
  const Data data;
  const CDRun run = data.run({"T1"});
  ASSERT_EQ(run.items.size(), 1u);
  EXPECT_EQ(run.items[0].failure, "");
  EXPECT_TRUE(run.changes.empty());
  EXPECT_TRUE(run.good());
  EXPECT_FALSE(run.whole);
  EXPECT_EQ(contents(data / "out" / "T1" / "curve.csv"), "x_deg,y\n0,1\n10,2\n");
  if (run.gnuplot_missing) GTEST_LOG_(INFO) << "gnuplot is not installed";
  for (const char* file : {"curve.svg", "curve.png"})
    EXPECT_EQ(std::filesystem::exists(data / "out" / "T1" / file), !run.gnuplot_missing);
}

TEST(HarnessInvariant, AFailureNamesItsItemAndSavesNothing) {
  const Data data;
  const CDRun run = data.run({});
  ASSERT_EQ(run.items.size(), 3u);  // T4 is not built
  EXPECT_EQ(run.items[1].failure, "the second half is missing");
  EXPECT_EQ(run.items[2].failure, "the item states no claim");
  EXPECT_FALSE(run.good());
  EXPECT_EQ(filesBelow(data / "out" / "T2"), 0u);
}

TEST(HarnessInvariant, APictureThatCannotBeDrawnIsAFailure) {
  const Data data;
  put(data / "plots" / "curve.gp", "plot 'no_such_file.csv'\n");
  const CDRun run = data.run({"T1"});
  EXPECT_EQ(run.gnuplot_missing, run.items[0].failure.empty());
  std::filesystem::remove(data / "plots" / "curve.gp");
  EXPECT_NE(data.run({"T1"}).items[0].failure.find("curve.gp"), std::string::npos);
}

TEST(HarnessIdentity, AnUnknownIdIsRefusedBeforeAnythingIsWritten) {
  const Data data;
  EXPECT_EQ(complaint(data, "T1x"),
            "command line: ID = T1x: is not in the inventory; did you mean T1? malus reproduce "
            "--list shows all");
  EXPECT_EQ(complaint(data, "T4"),
            "command line: ID = T4: is not yet built; malus reproduce --list shows what is");
  EXPECT_FALSE(std::filesystem::exists(data / "out"));
}

TEST(HarnessInvariant, NegativeControlEveryAlterationOfTheCommittedVerdictsIsNoticed) {
  const auto changes = [](const std::string& verdicts) {
    return Data(verdicts).run({"T1"}).changes;
  };
  const auto altered =
      changes("T1,good,differs\nT1,misprint,erratum\nT1,bad,differs\nT1,lost,not testable\n");
  ASSERT_EQ(altered.size(), 1u);
  EXPECT_EQ(altered[0].claim, "good");
  EXPECT_EQ(altered[0].committed, "differs");
  EXPECT_EQ(altered[0].now, "reproduced");
  const auto missing = changes("T1,good,reproduced\nT1,bad,differs\nT1,lost,not testable\n");
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0].committed, "");
  const auto invented = changes(
      "T1,good,reproduced\nT1,misprint,erratum\nT1,bad,differs\nT1,lost,not "
      "testable\nT1,new,erratum\n");
  ASSERT_EQ(invented.size(), 1u);
  EXPECT_EQ(invented[0].now, "");
}

TEST(HarnessInvariant, APartialRunLooksOnlyAtItsItemsAndAWholeRunAtAll) {
  const Data data(
      "T9,gone,reproduced\nT1,good,reproduced\nT1,misprint,erratum\nT1,bad,differs\nT1,lost,"
      "not testable\n");
  EXPECT_TRUE(data.run({"T1"}).changes.empty());
  const CDRun whole = data.run({});
  ASSERT_EQ(whole.changes.size(), 1u);
  EXPECT_EQ(whole.changes[0].item, "T9");
}

TEST(HarnessInvariant, AcceptingMakesTheVerdictsCommittedAndKeepsOthers) {
  const Data data("T1,good,differs\nT2,first,reproduced\n");
  const CDRun run = data.run({"T1", "T2"});
  acceptVerdicts(run, readInventory(data.path), data.path);
  const auto rows = readVerdicts(data.path);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0], (CDVerdictRow{"T1", "good", "reproduced"}));
  EXPECT_EQ(rows[4],
            (CDVerdictRow{"T2", "first", "reproduced"}));  // it failed, and keeps what it had
  EXPECT_TRUE(data.run({"T1"}).changes.empty());
}

TEST(HarnessInvariant, AFunctionWithoutARowOfTheInventoryIsADefect) {
  const Data data;
  const std::vector<CDRegisteredItem> stray{{"T7", everyVerdict}};
  EXPECT_THROW(reproduce({{}, data / "out", data.path}, readInventory(data.path), stray),
               CDInvariantError);
}
