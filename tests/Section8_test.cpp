// The experiment that chapter 8 of the thesis proposes (nw/thesis/Section8.nw).

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

TEST(Section8Invariant, TheExperimentHasItsVerdicts) {
  const Item item = ran("C7");
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{"polarizer"});
  EXPECT_EQ(
      named(item, Verdict::reproduced),
      (std::set<std::string>{"exact", "reflectivities", "roughness", "errors", "normal"}));
  EXPECT_EQ(item.tables().size(), 3u);
  EXPECT_EQ(item.pictures().size(), 1u);
  // negative control: noise makes a mistake at all
  EXPECT_GT(std::stod(valuesOf(item).at("reflectivity")), 0.01);
}
