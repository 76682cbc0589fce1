// What a billion triangles cost (nw/thesis/XWorlds.nw), on measurements made up here.

#include <gtest/gtest.h>

#include <string>

#include "Items.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
/// A folder like validation/ with a record of these rows.
struct WorldsReport : Scratch {
  explicit WorldsReport(const std::string& rows) {
    put(path / "worlds.csv",
        "# title: made up\n# date: 2002-05-01\n"
        "kind,triangles,instances,begin_s,memory_bytes,rays,ns_per_ray\n" +
            rows);
    std::filesystem::copy("validation/claims.csv", path / "claims.csv");
  }
};
const std::string shared = "shared,1000,10,0.1,1048576,5,300\n",
                  flat = "written out,1000,0,0.5,2072576,5,200\n",
                  large = "shared,2000000000,99,2,10485760,5,400\n";
}  // namespace

TEST(XWorldsInvariant, CostsWithinTheLimitsAreReproduced) {
  const Item item = ran("X.worlds", WorldsReport(shared + flat + large).path);
  EXPECT_EQ(verdictsOf(item)["memory"], Verdict::reproduced);
  EXPECT_EQ(verdictsOf(item)["ray"], Verdict::reproduced);
  auto values = valuesOf(item);
  EXPECT_EQ(values["ratio"], "1.50");
  EXPECT_EQ(values["memory"], "10");
  EXPECT_EQ(values["flat"], "1907");  // 1024 bytes a triangle
  EXPECT_NE(values["rows"].find("written out & 1000 & 2 & 0.50 & 200 \\\\ "),
            std::string::npos);
}

TEST(XWorldsInvariant, DearRaysAndLargeMemoryDiffer) {  // negative control
  const std::string dear = "shared,1000,10,0.1,1048576,5,400\n",
                    fat = "shared,2000000000,99,2,9000000000,5,400\n";
  EXPECT_EQ(verdictsOf(ran("X.worlds", WorldsReport(dear + flat + large).path))["ray"],
            Verdict::differs);
  EXPECT_EQ(verdictsOf(ran("X.worlds", WorldsReport(shared + flat + fat).path))["memory"],
            Verdict::differs);
}

TEST(XWorldsInvariant, ARecordOfOtherTownsIsRefused) {
  EXPECT_THROW(ran("X.worlds", WorldsReport(shared + large).path), InputError);
  EXPECT_THROW(ran("X.worlds", WorldsReport(shared + flat + shared).path), InputError);
}
