// Items, claims, verdicts and what changed (nw/thesis/Harness.nw).
#include "malus/thesis/Harness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "Scratch.hpp"

using namespace malus;

namespace {
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

const std::string columns =
    "item,claim,kind,source,verdict,repeats,fit,limit,sentence,quantity,criterion\n";

/// An item T0 with rows for the claims a to f, all of one kind; x to z have a limit.
Item freshItem(const std::string& kind = "thesis") {
  const Scratch scratch;
  std::string rows = columns;
  for (const char name : std::string("abcdefxyz"))
    rows += std::string("T0,") + name + "," + kind + ",choice,,,," +
            (name < 'x' ? "" : "10 .. 20") + ",sentence " + name + ",q," +
            (name == 'c' ? "within 1e-12: rounding" : "a bound: a reason") + "\n";
  put(scratch / "claims.csv", rows);
  return Item("T0", "nowhere", scratch.path);
}

Verdict last(const Item& item) { return item.claims().back().verdict; }

// what the items of a small inventory do; each states claims of one kind
void everyVerdict(Item& item) {
  item.printed("good", "1.25", 1.2512);
  item.erratum("misprint", "104.07", "102.07", 102.068, "its error column");
  item.statement("bad", false, "seen");
  item.notTestable("lost");
  item.table("curve", {"x_deg", "y"}).row({0, 1.0}).row({10, 2.0});
  item.picture("curve", "A curve");
  item.value("answer", "42");
}
void throwing(Item& item) {
  item.statement("first", true, "seen");
  item.table("half", {"x"}).row({1});
  throw std::runtime_error("the second half is missing");
}
void silent(Item&) {}

const std::vector<RegisteredItem> functions{
    {"T1", everyVerdict}, {"T2", throwing}, {"T3", silent}};

/// "T1,good,reproduced" and the like as rows of the table of claims.
std::string asRows(const std::string& verdicts) {
  std::istringstream lines(verdicts);
  std::string rows = columns;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t verdict = line.rfind(',');
    rows += line.substr(0, verdict) + ",thesis,choice" + line.substr(verdict) +
            ",,,,sentence of " + std::to_string(rows.size()) + ",,it is so: a reason\n";
  }
  return rows;
}

const std::string all_committed =
    "T1,good,reproduced\nT1,misprint,erratum\nT1,bad,differs\nT1,lost,not testable\n"
    "T2,first,reproduced\n";

/// A data directory with an inventory of four items (T4 is not built) and T1's verdicts committed.
struct Data : Scratch {
  explicit Data(const std::string& verdicts = all_committed) {
    put(path / "inventory.csv",
        "id,kind,title,place\nT1,table,One,page "
        "1\nT2,table,Two,\nT3,table,Three,\nT4,table,Four,\n");
    put(path / "claims.csv", asRows(verdicts));
    put(path / "plots" / "curve.gp",
        "if (term eq 'svg') set terminal svg; else set terminal pngcairo\nset output out\n"
        "set datafile separator ','\nplot 'curve.csv' using 1:2 with lines\n");
  }
  Reproduction run(std::vector<std::string> ids) const {
    return reproduce({std::move(ids), path / "out", path}, readInventory(path), functions);
  }
};

std::string complaint(const Data& data, const std::string& id) {
  try {
    data.run({id});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(HarnessIdentity, HalfAUnitOfTheLastPrintedDigitDecides) {
  EXPECT_TRUE(Printed("-66.60").meets(-66.604));
  EXPECT_FALSE(Printed("-66.60").meets(-66.606));
  EXPECT_TRUE(Printed(".0056").meets(0.00564));
  EXPECT_FALSE(Printed(".0056").meets(0.00566));
  EXPECT_TRUE(Printed("1.5e-3").meets(0.00154));
  EXPECT_FALSE(Printed("1.5e-3").meets(0.00156));
  EXPECT_TRUE(Printed("12E2").meets(1249));
  EXPECT_FALSE(Printed("12E2").meets(1251));
  EXPECT_TRUE(
      Printed("1.25").meets(1.255));  // on the boundary: either side is a rounding of ours
  EXPECT_FALSE(Printed("1.25").meets(not_a_number));
  EXPECT_THROW((void)Printed("1,25"), InputError);
}

TEST(HarnessIdentity, PrintedAndWithin) {
  Item item = freshItem();
  item.printed("a", "102.2", 102.249, "the scene is lost");
  EXPECT_EQ(last(item), Verdict::reproduced);
  EXPECT_EQ(item.claims().back().cause, "");
  EXPECT_EQ(item.claims().back().ours, "102.24900");
  EXPECT_NEAR(item.claims().back().residual, 0.049, 1e-12);  // rounding
  item.printed("b", "102.2", 102.251, "the scene is lost");
  EXPECT_EQ(last(item), Verdict::differs);
  EXPECT_EQ(item.claims().back().cause, "the scene is lost");
  item.within("c", 1, 1 + 1e-13, 1e-12);
  EXPECT_EQ(last(item), Verdict::reproduced);
  item.within("d", 1, 1 + 1e-11, 1e-12);
  EXPECT_EQ(last(item), Verdict::differs);
  item.within("e", 1, not_a_number, 1e9) /* NaN is near nothing */;
  EXPECT_EQ(last(item), Verdict::differs);
}

TEST(HarnessIdentity, AnErratumNeedsBothHalves) {
  Item item = freshItem();
  item.erratum("a", "104.07", "102.07", 102.07, "e");
  EXPECT_EQ(last(item), Verdict::erratum);
  item.erratum("b", "104.07", "102.07", 104.07, "the print is met after all");
  EXPECT_EQ(last(item), Verdict::reproduced);
  item.erratum("c", "104.07", "102.07", 103.0, "neither is met");
  EXPECT_EQ(last(item), Verdict::differs);
  item.erratumStatement("d", true, true, "e");
  EXPECT_EQ(last(item), Verdict::erratum);
  item.erratumStatement("e", false, true, "e");
  EXPECT_EQ(last(item), Verdict::reproduced);
  item.erratumStatement("f", true, false, "e");
  EXPECT_EQ(last(item), Verdict::differs);
}

TEST(HarnessIdentity, AClaimIsStatedOnce) {
  Item item = freshItem();
  item.statement("a", true, "e");
  EXPECT_THROW(item.statement("a", true, "e"), InvariantError);
}

TEST(HarnessInvariant, ARunLeavesDataPicturesAndNoComplaint) {
  const Data data;
  const Reproduction run = data.run({"T1"});
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
  const Reproduction run = data.run({});
  ASSERT_EQ(run.items.size(), 3u);  // T4 is not built
  EXPECT_EQ(run.items[1].failure, "the second half is missing");
  EXPECT_EQ(run.items[2].failure, "the item states no claim");
  EXPECT_FALSE(run.good());
  EXPECT_EQ(filesBelow(data / "out" / "T2"), 0u);
}

TEST(HarnessInvariant, APictureThatCannotBeDrawnIsAFailure) {
  const Data data;
  put(data / "plots" / "curve.gp", "plot 'no_such_file.csv'\n");
  const Reproduction run = data.run({"T1"});
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

TEST(HarnessIdentity, AClaimWithoutARowIsRefusedBeforeItsNumberIsSeen) {
  Item item = freshItem();
  try {
    item.statement("unheard-of", true, "e");
    FAIL() << "not refused";
  } catch (const InvariantError& error) {
    EXPECT_NE(std::string(error.what()).find("T0/unheard-of has no row"), std::string::npos);
  }
  EXPECT_THROW(item.measured("unheard-of", 15), InvariantError);
}

TEST(HarnessIdentity, TheToleranceOfTheCodeIsThatOfTheTable) {
  Item item = freshItem();
  EXPECT_THROW(item.within("c", 1, 1, 1e-11), InvariantError);
  EXPECT_NO_THROW(item.within("d", 1, 1, 1e-11));  // its criterion is in other words
}

TEST(HarnessIdentity, ALimitOfTheTableJudges) {
  Item item = freshItem();
  item.measured("x", 10);
  EXPECT_EQ(last(item), Verdict::reproduced);
  item.measured("y", 20.000001);
  EXPECT_EQ(last(item), Verdict::differs);
  item.measured("z", not_a_number);
  EXPECT_EQ(last(item), Verdict::differs);
}

TEST(HarnessIdentity, TheWorstOfSeveralCasesForgetsNoNaN) {
  EXPECT_EQ(leastOf({3, 1, 2}), 1);
  EXPECT_EQ(mostOf({1, 3, 2}), 3);
  const std::vector<std::vector<double>> cases_without{
      {1, not_a_number}, {not_a_number, 1}, {}};
  for (const std::vector<double>& cases : cases_without) {
    EXPECT_TRUE(std::isnan(leastOf(cases)));
    EXPECT_TRUE(std::isnan(mostOf(cases)));
  }
}

TEST(HarnessIdentity, ALimitOfTheTableMustBeRead) {
  Item item = freshItem();
  EXPECT_THROW(item.statement("x", true, "e"), InvariantError);
  EXPECT_TRUE(item.meets("x", 20));
  EXPECT_FALSE(item.meets("y", not_a_number));
  EXPECT_NO_THROW(item.statement("x", true, "e"));
}

TEST(HarnessIdentity, InputsAndPropertiesOfTheProgramHaveNoVerdict) {
  Item input = freshItem("input"), implementation = freshItem("implementation");
  input.statement("a", true, "e");
  EXPECT_EQ(last(input), Verdict::input);
  implementation.statement("a", true, "e");
  EXPECT_EQ(last(implementation), Verdict::implementation);
  implementation.statement("b", false, "e");
  EXPECT_EQ(last(implementation), Verdict::differs);
}

TEST(HarnessInvariant, NegativeControlEveryAlterationOfTheCommittedVerdictsIsNoticed) {
  const auto changes = [](const std::string& from, const std::string& to) {
    std::string verdicts = all_committed;
    verdicts.replace(verdicts.find(from), from.size(), to);
    return Data(verdicts).run({"T1"}).changes;
  };
  const auto altered = changes("good,reproduced", "good,differs");
  ASSERT_EQ(altered.size(), 1u);
  EXPECT_EQ(altered[0].claim, "good");
  EXPECT_EQ(altered[0].committed, "differs");
  EXPECT_EQ(altered[0].now, "reproduced");
  const auto unseen = changes("misprint,erratum", "misprint,");
  ASSERT_EQ(unseen.size(), 1u);
  EXPECT_EQ(unseen[0].committed, "");
  const auto invented = changes("T1,lost", "T1,new,erratum\nT1,lost");
  ASSERT_EQ(invented.size(), 1u);
  EXPECT_EQ(invented[0].now, "");
  EXPECT_EQ(changes("T1,lost", "T1,new,\nT1,lost").size(),
            1u);  // without a verdict, because nothing ran
}

TEST(HarnessInvariant, APartialRunLooksOnlyAtItsItemsAndAWholeRunAtAll) {
  const Data data("T9,gone,reproduced\n" + all_committed);
  EXPECT_TRUE(data.run({"T1"}).changes.empty());
  const Reproduction whole = data.run({});
  ASSERT_EQ(whole.changes.size(), 1u);
  EXPECT_EQ(whole.changes[0].item, "T9");
}

TEST(HarnessInvariant, AcceptingMakesTheVerdictsCommittedAndKeepsOthers) {
  std::string verdicts = all_committed;
  verdicts.replace(verdicts.find("good,reproduced"), 15, "good,differs");
  const Data data(verdicts);
  acceptVerdicts(data.run({"T1", "T2"}), data.path);
  const ClaimTable rows = ClaimTable::read(data.path);
  ASSERT_EQ(rows.rows().size(), 5u);
  EXPECT_EQ(rows.find("T1", "good")->verdict, "reproduced");
  EXPECT_EQ(rows.find("T1", "good")->criterion, "it is so: a reason");
  EXPECT_EQ(rows.find("T2", "first")->verdict,
            "reproduced");  // it failed, and keeps what it had
  EXPECT_TRUE(data.run({"T1"}).changes.empty());
}

TEST(HarnessInvariant, AFunctionWithoutARowOfTheInventoryOrBesideAnotherIsADefect) {
  const Data data;
  const std::vector<RegisteredItem> stray{{"T7", everyVerdict}};
  EXPECT_THROW(reproduce({{}, data / "out", data.path}, readInventory(data.path), stray),
               InvariantError);
  const std::vector<RegisteredItem> twice{{"T1", everyVerdict}, {"T1", silent}};
  EXPECT_THROW(reproduce({{}, data / "out", data.path}, readInventory(data.path), twice),
               InvariantError);
}
