// The item on polarised emission (nw/thesis/XEmission.nw).

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(XEmissionInvariant, EveryClaimHolds) {
  const Item item = ran("X.emission");
  const std::set<std::string> all{
      "parallel",         "waves", "metal.60deg", "metal.hemisphere", "water.hemisphere",
      "stefan-boltzmann", "wien",  "night",       "equilibrium"};
  EXPECT_EQ(named(item, Verdict::reproduced), all);
  EXPECT_EQ(item.pictures().size(), 2u);
  EXPECT_TRUE(named(item, Verdict::differs).empty());
  const auto values = valuesOf(item);
  EXPECT_GT(std::stod(values.at("copper60")), std::stod(values.at("water60")));
  EXPECT_GT(std::stod(values.at("water60")), 0.01);  // negative control: something is polarised
}
