// The item of the sun's disk (nw/thesis/XSun.nw).

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "Items.hpp"

using namespace malus;

// The criteria are in validation/claims.csv.
TEST(XSunInvariant, AllClaimsHoldAndThePicturesAreDrawn) {
  const Item item = ran("X.sun");
  const std::map<std::string, Verdict> expected{{"edge", Verdict::reproduced},
                                                {"glint", Verdict::reproduced},
                                                {"sum", Verdict::reproduced}};
  EXPECT_EQ(verdictsOf(item), expected);
  EXPECT_EQ(item.pictures().size(), 2u);
  auto values = valuesOf(item);
  EXPECT_GT(std::stod(values["edge"]), 0) << "negative control: a table compared with itself";
  EXPECT_GT(std::stod(values["difference"]), 0) << "negative control";
  EXPECT_GT(std::stod(values["largest"]), 0.98) << "smooth glass is a mirror";
}
