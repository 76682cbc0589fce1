// The item of the layered paint (nw/thesis/OwnPaint.nw).
#include "thesis/OwnPaint.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(OwnPaintInvariant, EveryClaimHolds) {
  const CDItem item = ran("X.paint", reproduceXPaint);
  EXPECT_EQ(named(item, CDVerdict::differs), std::set<std::string>{});
  for (const char* claim :
       {"energy", "reciprocity", "realizable", "white", "coats", "body", "lossless"})
    EXPECT_TRUE(named(item, CDVerdict::reproduced).contains(claim)) << claim;
  EXPECT_EQ(item.tables().size(), 3u);
  // negative control: the thin coat is not as white as the thick one
  EXPECT_LT(std::stod(valuesOf(item).at("thin")), std::stod(valuesOf(item).at("white")) - 0.05);
}
