// The table of the models (nw/thesis/XChooser.nw).

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "Items.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

TEST(XChooserInvariant, ThePromisesAreKeptAndTheTableIsWhole) {
  const Item item = ran("X.chooser");
  EXPECT_EQ(named(item, Verdict::reproduced),
            (std::set<std::string>{"polarised", "diffuse", "reciprocal", "energy"}));
  const std::string rows = valuesOf(item).at("rows");
  std::size_t ends = 0, cells = 0;
  for (std::size_t at = 0; at < rows.size(); ++at) {
    ends += rows.compare(at, 2, "\\\\") == 0;
    cells += rows[at] == '&';
    EXPECT_NE(rows[at], '\n');
    if (rows[at] == '_') {
      EXPECT_EQ(rows[at - 1], '\\');
    }
  }
  EXPECT_EQ(ends, modelEntries().size());
  EXPECT_EQ(cells, 6 * modelEntries().size());
  for (const ModelEntry& entry : modelEntries())
    EXPECT_TRUE(std::filesystem::exists("nw/surface/" + entry.traits.chapter + ".nw"))
        << entry.name;
  EXPECT_FALSE(std::filesystem::exists("nw/surface/BRDFNoSuch.nw"));  // negative control
}
