// The item on polarised emission (nw/thesis/OwnEmission.nw).
#include "thesis/OwnEmission.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(OwnEmissionInvariant, EveryClaimHolds) {
  const CDItem item = ran("X.emission", reproduceXEmission);
  const std::set<std::string> all{
      "parallel",         "waves", "metal.60deg", "metal.hemisphere", "water.hemisphere",
      "stefan-boltzmann", "wien",  "night",       "equilibrium"};
  EXPECT_EQ(named(item, CDVerdict::reproduced), all);
  EXPECT_EQ(item.pictures().size(), 2u);
  EXPECT_TRUE(named(item, CDVerdict::differs).empty());
  const auto values = valuesOf(item);
  EXPECT_GT(std::stod(values.at("copper60")), std::stod(values.at("water60")));
  EXPECT_GT(std::stod(values.at("water60")), 0.01);  // negative control: something is polarised
}
