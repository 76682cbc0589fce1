// The items that show each model in one style (nw/thesis/XModels.nw).
#include "malus/thesis/XModels.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "Items.hpp"

using namespace malus;

namespace {
const std::vector<std::string> items{
    "X.lambert", "X.torrance-sparrow", "X.dirsig",     "X.glossy",
    "X.water",   "X.beard-maxwell",    "X.vegetation", "X.sandford"};
}  // namespace

TEST(XModelsInvariant, EveryModelAnswersTheThreeQuestionsAsItsChapterSays) {
  for (const std::string& id : items) {
    const Item item = ran(id);
    EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{}) << id;
    for (const char* question : {"energy", "reciprocity", "realizable"})
      EXPECT_TRUE(named(item, Verdict::reproduced).contains(question)) << id;
    const std::size_t maps = id == "X.torrance-sparrow" ? 1 : 0;  // of all sixteen elements
    EXPECT_EQ(item.pictures().size(), 1 + maps) << id;
    EXPECT_EQ(item.tables().size(), 3 + maps) << id;
    EXPECT_GT(std::stod(valuesOf(item).at("dhr")),
              0.01);  // negative control: something is reflected
  }
}

// The claims about tables hold, and their numbers are of a size that could have failed them.
TEST(XModelsInvariant, TablesComeNearerWithTheSquareOfTheStep) {
  const Item item = ran("X.measured");
  EXPECT_EQ(named(item, Verdict::reproduced),
            (std::set<std::string>{"order", "narrow", "wide"}));
  const auto values = valuesOf(item);
  EXPECT_GT(std::stod(values.at("plain")), std::stod(values.at("half")));
  EXPECT_GT(std::stod(values.at("half")), 0.01);  // negative control: there is an error
}
