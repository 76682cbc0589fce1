// The verdicts of the items of thesis chapter 6 and appendix A (nw/thesis/Section6.nw, AppendixA.nw).

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
const std::set<std::string> none;
}  // namespace

TEST(Section6Published, TheWorkedExampleHasTwoMisprintedNumbersAndFiveSlips) {
  const Item item = ran("E6.1");
  EXPECT_EQ(named(item, Verdict::differs), none);
  EXPECT_EQ(
      named(item, Verdict::erratum),
      (std::set<std::string>{"eq6.11.S0", "eq6.11.S2", "eq6.8.type", "eq6.5.realizable"}));
  EXPECT_EQ(named(item, Verdict::reproduced).size(), 14u);
}

TEST(Section6Published, NegativeControlAChangedFactorOfTheExampleIsSeen) {
  const Corrupted brdf("E6.1-brdf.csv", "6.6,550,1.6,", "6.6,550,1.7,");
  const auto differs = named(ran("E6.1", brdf.data), Verdict::differs);
  EXPECT_TRUE(differs.contains("eq6.12.S0"));
  EXPECT_FALSE(differs.contains("eq6.13.S0"));
}

TEST(Section6Published, TenClassesHaveTheirChaptersAndTests) {
  const Item item = ran("T6.1");
  EXPECT_EQ(named(item, Verdict::reproduced).size(), item.claims().size());
  EXPECT_EQ(item.claims().size(), 15u);  // ten classes and five sentences of section 6.2.2
}

TEST(Section6Published, NegativeControlAClassThatDoesNotExistIsSeen) {
  const Corrupted classes("T6.1.csv", "\nCDVector\n", "\nCDTensor\n");
  EXPECT_THROW(ran("T6.1", classes.data), InvariantError);  // it has no row
  std::string rows = contents(classes.data / "claims.csv");
  rows.replace(rows.find("\nT6.1,CDVector,"), 15, "\nT6.1,CDTensor,");
  put(classes.data / "claims.csv", rows);
  EXPECT_EQ(named(ran("T6.1", classes.data), Verdict::differs),
            (std::set<std::string>{"CDTensor"}));
}

TEST(Section6Published, TheAdaptiveGridIsAsFigure63Says) {
  const Item item = ran("F6.3");
  EXPECT_EQ(named(item, Verdict::reproduced),
            (std::set<std::string>{"best", "first", "eight", "solid-angles"}));
  EXPECT_EQ(item.claims().size(), 4u);
}

TEST(Section6Published, EqualSolidAnglesFailInTheReadingThatTheThesisSuggests) {
  const Item item = ran("C6");
  EXPECT_EQ(named(item, Verdict::notTestable), (std::set<std::string>{"fades"}));
  EXPECT_TRUE(named(item, Verdict::reproduced).contains("equal"));
  EXPECT_EQ(named(item, Verdict::differs), (std::set<std::string>{"normalised"}));
}

TEST(Section6Published, TheMathTesterTestsWhatAppendixAListsAndSaysWhatIsLost) {
  const Item item = ran("A.2");
  EXPECT_EQ(named(item, Verdict::differs), none);
  EXPECT_EQ(named(item, Verdict::notTestable),
            (std::set<std::string>{"matrices", "additions"}));
}

TEST(Section6Published, NegativeControlAnotherDataSetOrOperationIsSeen) {
  const Corrupted data("A.2.csv", "psv1,8.7,", "psv1,8.8,");
  EXPECT_EQ(named(ran("A.2", data.data), Verdict::differs), (std::set<std::string>{"data"}));
  const Corrupted operations("A.2-operations.csv", "upsv1 / f1", "upsv1 / upsv2");
  EXPECT_EQ(named(ran("A.2", operations.data), Verdict::differs),
            (std::set<std::string>{"operations"}));
  const Corrupted functions("A.2-operations.csv", "A.2.6,demote", "A.2.6,promoted");
  EXPECT_EQ(named(ran("A.2", functions.data), Verdict::differs),
            (std::set<std::string>{"functions"}));
  const Corrupted zeros("A.2.csv", "upsv1,5.7,0,0,", "upsv1,5.7,0,1,");
  EXPECT_THROW(ran("A.2", zeros.data), InputError);
}
