// What the tests notice of planted faults (nw/thesis/OwnTests.nw), on reports made up here.
#include "thesis/OwnTests.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "Items.hpp"
#include "light/CDError.hpp"

using namespace malus;

namespace {
/// A folder like validation/ with a report of so many faults.
struct Report : Scratch {
  Report(int noticed, int survived, const std::string& more = "") {
    std::string text = "# title: made up\n# date: 2002-05-01\nchapter,place,line,change,outcome\n";
    for (int i = 0; i < noticed; ++i) text += "light/CDVector,x:1,a + b,+ -> -,noticed\n";
    for (int i = 0; i < survived; ++i) text += "matter/Fresnel,x:2,a < b,< -> <=,survived\n";
    text += "matter/Fresnel,x:3,a < b,< -> <=,excused\n" + more;
    put(path / "mutants.csv", text);
    std::filesystem::copy("validation/claims.csv", path / "claims.csv");
  }
};
}  // namespace

TEST(OwnTestsInvariant, TheShareIsThatOfTheCountedFaults) {
  const Report report(380, 20);
  const CDItem item = ran("X.tests", reproduceXTests, report.path);
  auto verdicts = verdictsOf(item);
  EXPECT_EQ(verdicts["enough"], CDVerdict::reproduced);
  EXPECT_EQ(verdicts["noticed"], CDVerdict::reproduced);
  auto values = valuesOf(item);
  EXPECT_EQ(values["percent"], "95.0");
  EXPECT_EQ(values["excused"], "1");
  EXPECT_EQ(values["date"], "2002-05-01");
  EXPECT_NE(values["rows"].find("CDVector & 380 & 380"), std::string::npos);
  EXPECT_NE(values["rows"].find("Fresnel & 20 & 0"), std::string::npos);
}

TEST(OwnTestsInvariant, OneFaultLessDiffers) {  // negative control
  const Report few(379, 20), unseen(379, 21);
  EXPECT_EQ(verdictsOf(ran("X.tests", reproduceXTests, few.path))["enough"], CDVerdict::differs);
  EXPECT_EQ(verdictsOf(ran("X.tests", reproduceXTests, unseen.path))["noticed"],
            CDVerdict::differs);
}

TEST(OwnTestsInvariant, ADamagedReportIsRefused) {
  const Report damaged(1, 1, "light/CDVector,x:1,a,b,perhaps\n");
  EXPECT_THROW(ran("X.tests", reproduceXTests, damaged.path), CDInputError);
}
