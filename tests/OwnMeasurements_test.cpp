// The item that measures the table of the DHR (nw/thesis/OwnMeasurements.nw).
#include "thesis/OwnMeasurements.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "program/Harness.hpp"

using namespace malus;

namespace {
const CDItem& measured() {
  static const CDItem item = [] {
    CDItem run("X.DHR", "nowhere", "validation");
    reproduceXDHR(run);
    return run;
  }();
  return item;
}
}  // namespace

TEST(OwnMeasurementsInvariant, BothClaimsHoldAndBothPicturesAreDrawn) {
  std::map<std::string, CDVerdict> verdicts;
  for (const CDClaim& claim : measured().claims()) verdicts[claim.name] = claim.verdict;
  const std::map<std::string, CDVerdict> expected{{"table", CDVerdict::reproduced},
                                                  {"sum", CDVerdict::reproduced}};
  EXPECT_EQ(verdicts, expected);
  EXPECT_EQ(measured().pictures().size(), 2u);
}

TEST(OwnMeasurementsRegression, ValuesThatTheProseRestsOn) {
  std::map<std::string, std::string> values;
  for (const auto& [name, text] : measured().values()) values[name] = text;
  EXPECT_EQ(values["diffuse40"], "0.0085");
  EXPECT_EQ(values["diffuse30"], "0.0044");
  // the factor two of the table's coordinate is the best of those shown
  EXPECT_LT(std::stod(values["curvature2"]), std::stod(values["curvature1"]));
  EXPECT_LT(std::stod(values["curvature2"]), std::stod(values["curvature4"]));
  // the sum misses the lobe of the smoothest surface at the horizon: an error near one
  EXPECT_GT(std::stod(values["sum"].substr(1)), 5);
  EXPECT_NE(values["diffuse40"], values["diffuse30"]);  // negative control
}
