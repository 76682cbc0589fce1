// The verdicts of the items of thesis chapter 5 (nw/thesis/Section5.nw).

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(Section5Invariant, TheThreeFormsOfTheOlderLobe) {
  const Item item = ran("F5.1");
  EXPECT_EQ(named(item, Verdict::reproduced),
            (std::set<std::string>{"cone", "cosine", "exponential", "height.width"}));
  EXPECT_EQ(named(item, Verdict::notTestable), (std::set<std::string>{"formulas"}));
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{});
}
