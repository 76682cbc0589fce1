// What it costs to hand tiles to other ranks (nw/thesis/XRanks.nw), on measurements made up here.

#include <gtest/gtest.h>

#include <string>

#include "Items.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
/// A folder like validation/ with the rows of so many measurements.
struct RanksReport : Scratch {
  explicit RanksReport(const std::string& rows) {
    put(path / "ranks.csv",
        "# title: made up\n# date: 2002-05-01\n"
        "ranks,processors,tiles,work_s,film_tile_s,dear_clock_s,dear_threads_s\n" +
            rows);
    std::filesystem::copy("validation/claims.csv", path / "claims.csv");
  }
};
// 100 tiles, 1 s alone and 10 ms for each tile of another rank
const std::string alone = "1,2,100,1,.5,10,10\n", two = "2,2,100,1.5,.5,5.04,5\n",
                  four = "4,2,100,1.75,.5,6,8\n";
}  // namespace

TEST(XRanksInvariant, WorkThatFollowsTheModelIsReproduced) {
  const RanksReport report(alone + two + four);
  const Item item = ran("X.ranks", report.path);
  EXPECT_EQ(verdictsOf(item)["model"], Verdict::reproduced);
  auto values = valuesOf(item);
  EXPECT_EQ(values["least"], "10000");  // us
  EXPECT_EQ(values["most"], "10000");
  EXPECT_EQ(values["film"], "500.0");  // ms
  EXPECT_EQ(values["threads"], "50 to 50");
  EXPECT_EQ(values["needed"], "100000 to 100000");  // ms
  EXPECT_EQ(values["date"], "2002-05-01");
  EXPECT_EQ(verdictsOf(item)["clock"], Verdict::reproduced);
  EXPECT_NE(
      values["clocks"].find("2 & 5.0 & 1.98 & 1.98 & 2.00 \\\\ 4 & 6.0 & 1.67 & 1.98 & 1.25"),
      std::string::npos);
  EXPECT_NE(values["rows"].find("2 & 50 & 1.50 & 1.50 & 0.0 & 10000 \\\\ "), std::string::npos);
}

TEST(XRanksInvariant, AFifthMoreWorkDiffers) {  // negative control
  const RanksReport report(alone + "2,2,100,1.8,.5,5,5\n" + four);
  EXPECT_EQ(verdictsOf(ran("X.ranks", report.path))["model"], Verdict::differs);
}

TEST(XRanksInvariant, ASecondRankThatMakesNothingFasterDiffers) {  // negative control
  const RanksReport report(alone + "2,2,100,1.5,.5,10,5\n" + four);
  EXPECT_EQ(verdictsOf(ran("X.ranks", report.path))["clock"], Verdict::differs);
}

TEST(XRanksInvariant, WithoutTheRowOfOneRankItIsRefused) {
  EXPECT_THROW(ran("X.ranks", RanksReport(two + four).path), InputError);
  EXPECT_THROW(ran("X.ranks", RanksReport(alone + four).path), InputError);
}
