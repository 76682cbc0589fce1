// The NEF's scan and grid (nw/thesis/Section54.nw): the two items, and a fit to another scan.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(Section54Published, Figure55) {
  const Item item = ran("F5.5");
  EXPECT_TRUE(named(item, Verdict::reproduced).contains("place"));
  EXPECT_TRUE(named(item, Verdict::reproduced).contains("specific"));
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{"dhr"});
  EXPECT_EQ(named(item, Verdict::notTestable), std::set<std::string>{"sample"});
  const double until = std::stod(valuesOf(item).at("until"));
  EXPECT_GT(until,
            std::stod(valuesOf(item).at("sigma")));  // the thesis's sample is on the safe side
  EXPECT_LT(until, 0.3);  // negative control: not so for every roughness
}

TEST(Section54Published, Figure56) {
  const Item item = ran("F5.6");
  EXPECT_EQ(named(item, Verdict::reproduced), (std::set<std::string>{"better", "half"}));
  EXPECT_EQ(named(item, Verdict::notTestable), std::set<std::string>{"values"});
  EXPECT_GT(std::stod(valuesOf(item).at("all")), 1000);
}
