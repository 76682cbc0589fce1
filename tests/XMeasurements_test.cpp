// The item that measures the table of the DHR (nw/thesis/XMeasurements.nw).

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "Items.hpp"

using namespace malus;

namespace {
const Item& measured() {
  static const Item item = ran("X.DHR");
  return item;
}
}  // namespace

TEST(XMeasurementsInvariant, BothClaimsHoldAndBothPicturesAreDrawn) {
  const std::map<std::string, Verdict> expected{{"table", Verdict::reproduced},
                                                {"sum", Verdict::reproduced}};
  EXPECT_EQ(verdictsOf(measured()), expected);
  EXPECT_EQ(measured().pictures().size(), 2u);
}

TEST(XMeasurementsRegression, ValuesThatTheProseRestsOn) {
  auto values = valuesOf(measured());
  EXPECT_EQ(values["diffuse40"], "0.0085");
  EXPECT_EQ(values["diffuse30"], "0.0044");
  // the factor two of the table's coordinate is the best of those shown
  EXPECT_LT(std::stod(values["curvature2"]), std::stod(values["curvature1"]));
  EXPECT_LT(std::stod(values["curvature2"]), std::stod(values["curvature4"]));
  // the sum misses the lobe of the smoothest surface at the horizon: an error near one
  EXPECT_GT(std::stod(values["sum"].substr(1)), 5);
  EXPECT_NE(values["diffuse40"], values["diffuse30"]);  // negative control
}
