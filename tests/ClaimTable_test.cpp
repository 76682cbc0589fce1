// The table of claims and what it refuses (nw/thesis/ClaimTable.nw).
#include "malus/thesis/ClaimTable.hpp"

#include <gtest/gtest.h>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
/// Why a table with these rows is refused; "" if it is not.
std::string complaint(const std::string& rows) {
  const Scratch scratch;
  put(scratch / "claims.csv",
      "item,claim,kind,source,verdict,repeats,fit,limit,sentence,quantity,criterion\n" + rows);
  try {
    ClaimTable::read(scratch.path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool refuses(const std::string& rows, const std::string& words) {
  return complaint(rows).find(words) != std::string::npos;
}

const std::string first = "T1,a,thesis,sentence,reproduced,,,,it falls (page 9),error,falls\n";
}  // namespace

TEST(ClaimTableIdentity, ASoundTableIsRead) {
  EXPECT_EQ(complaint(first), "");
  EXPECT_EQ(
      complaint(first + "T2,b,thesis,sentence,reproduced,T1/a,,,it falls (page 9),,falls\n" +
                "T2,c,fitted,digits,,,sun:2,,dark (page 10),,below 1\n" +
                "T2,d,input,digits,input,,,,table 7.5,,the digits\n"),
      "");
}

// Each row has one fault.
TEST(ClaimTableIdentity, NegativeControlFaultyRowsAreRefused) {
  EXPECT_TRUE(refuses("T1,a,thesis,sentence,reproduced,,,,it falls,error,\n", "is empty"));
  EXPECT_TRUE(refuses("T1,a,thesis,sentence,reproduced,,,,,error,falls\n", "is empty"));
  EXPECT_TRUE(refuses(first + first, "T1/a: occurs twice"));
  EXPECT_TRUE(refuses("T1,a,theses,sentence,,,,,it falls,,falls\n", "not one of the words"));
  EXPECT_TRUE(refuses("T1,a,thesis,hunch,,,,,it falls,,falls\n", "not one of the words"));
  EXPECT_TRUE(
      refuses("T1,a,thesis,choice,,,,,it falls,,below 1\n", "gives a bound without a reason"));
  EXPECT_EQ(complaint("T1,a,thesis,choice,,,,,it falls,,below 1: it was above\n"), "");
  EXPECT_TRUE(refuses("T1,a,input,digits,reproduced,,,,sigma .2,,same\n",
                      "not one of the "
                      "words"));
  EXPECT_TRUE(refuses("T1,a,fitted,sentence,,,,,it falls,,falls\n", "does not fit"));
  EXPECT_TRUE(refuses("T1,a,thesis,sentence,,,sun:2,,it falls,,falls\n", "does not fit"));
}

TEST(ClaimTableIdentity, NegativeControlOneSentenceHasOneVerdict) {
  const auto second = [](const std::string& verdict, const std::string& repeats,
                         const std::string& sentence) {
    return first + "T2,b,thesis,sentence," + verdict + "," + repeats + ",,," + sentence +
           ",,falls\n";
  };
  EXPECT_TRUE(
      refuses(second("differs", "T1/a", "it falls (page 9)"), "one sentence one verdict"));
  EXPECT_TRUE(refuses(second("reproduced", "", "it falls (page 9)"), "is already in T1/a"));
  EXPECT_TRUE(refuses(second("reproduced", "T1/x", "it rises"), "is not a row"));
  EXPECT_TRUE(refuses(second("reproduced", "T2/b", "it rises"), "repeats a row itself"));
}

TEST(ClaimTableIdentity, NegativeControlAFitHasOneNumberOfUnknowns) {
  EXPECT_TRUE(
      refuses("T1,a,fitted,digits,,,sun:2,,one,,x\nT1,b,fitted,digits,,,sun:3,,two,,x\n",
              "has 2 unknowns"));
}

TEST(ClaimTableIdentity, LimitsAreIntervals) {
  ClaimRow row;
  const auto limit = [&](const char* words) { return row.limit = words, readLimit(row); };
  EXPECT_EQ(limit("<= 1.1").second, 1.1);
  EXPECT_EQ(limit(">= 3").first, 3);
  EXPECT_EQ(limit("10 .. 20"), std::pair(10.0, 20.0));
  EXPECT_THROW(limit("about 3"), InputError);
  EXPECT_THROW(limit(""), InputError);
}

TEST(ClaimTableIdentity, TheCommittedTableIsReadAndWrittenUnchanged) {
  const Scratch scratch;
  ClaimTable::read("validation").save(scratch.path);
  EXPECT_EQ(contents(scratch / "claims.csv"), contents("validation/claims.csv"));
}
