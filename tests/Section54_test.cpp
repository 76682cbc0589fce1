// The NEF's scan and grid (nw/thesis/Section54.nw): the two items, and a fit to another scan.
#include "thesis/Section54.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(Section54Published, Figure55) {
  const CDItem item = ran("F5.5", reproduceF55);
  EXPECT_TRUE(named(item, CDVerdict::reproduced).contains("place"));
  EXPECT_TRUE(named(item, CDVerdict::reproduced).contains("specific"));
  EXPECT_EQ(named(item, CDVerdict::differs), std::set<std::string>{"dhr"});
  EXPECT_EQ(named(item, CDVerdict::notTestable), std::set<std::string>{"sample"});
  const double until = std::stod(valuesOf(item).at("until"));
  EXPECT_GT(until,
            std::stod(valuesOf(item).at("sigma")));  // the thesis's sample is on the safe side
  EXPECT_LT(until, 0.3);  // negative control: not so for every roughness
}

TEST(Section54Published, Figure56) {
  const CDItem item = ran("F5.6", reproduceF56);
  EXPECT_EQ(named(item, CDVerdict::reproduced), (std::set<std::string>{"better", "half"}));
  EXPECT_EQ(named(item, CDVerdict::notTestable), std::set<std::string>{"values"});
  EXPECT_GT(std::stod(valuesOf(item).at("all")), 1000);
}
