// What an error bar is worth (nw/thesis/XErrorBars.nw).
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

// The limits are in validation/claims.csv; the claim of the DoLP without correlations is the
// negative control of the one with them.
TEST(XErrorBarsInvariant, WhatIsClaimedIsWhatIsObserved) {
  const Item item = ran("X.error");
  EXPECT_EQ(named(item, Verdict::reproduced),
            (std::set<std::string>{"spread", "dolp", "uncorrelated", "aim", "debias"}));
}
