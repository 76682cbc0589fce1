// The item of the sky with dust (nw/thesis/XAerosol.nw).

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(XAerosolInvariant, EveryClaimHolds) {
  const Item item = ran("X.aerosol");
  EXPECT_EQ(
      named(item, Verdict::reproduced),
      (std::set<std::string>{"arago", "babinet", "camera", "circular", "converged", "curves",
                             "dome", "downwards", "lists", "maximum", "reflected"}));
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{});
  EXPECT_EQ(item.tables().size(), 2u);
  // negative control: the thick haze is not as polarised as clear air
  EXPECT_LT(std::stod(valuesOf(item).at("thick")), std::stod(valuesOf(item).at("clear")) - 20);
}

// A wrong digit of one printed table and a wrong sign of the other are seen, by the claims whose prints they are and by no other.
TEST(XAerosolPublished, NegativeControlAChangedDigitAndAChangedSignAreSeen) {
  Corrupted tables("evans1991-series.csv", "1.45529318", "1.45529328");
  tables.also("evans1991-light.csv", "0.611213e-4", "-0.611213e-4");
  EXPECT_EQ(named(ran("X.aerosol", tables.data), Verdict::differs),
            (std::set<std::string>{"lists", "reflected"}));
}
