// What the tests notice of planted faults (nw/thesis/XTests.nw), on reports made up here.

#include <gtest/gtest.h>

#include "Items.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
/// A folder like validation/ with a report of so many faults.
struct FaultReport : Scratch {
  FaultReport(int noticed, int survived, const std::string& more = "") {
    std::string text =
        "# title: made up\n# date: 2002-05-01\n# commit: abc\n# seed: 1\n"
        "chapter,place,line,change,at_first,outcome\n";
    for (int i = 0; i < noticed; ++i)
      text += std::string("base/CDVector,x:1,a + b,+ -> -,") +
              (i % 2 ? "noticed" : "survived") + ",noticed\n";
    for (int i = 0; i < survived; ++i)
      text += "surface/Fresnel,x:2,{a_ < b; ~c},< -> <=,survived,survived\n";
    text += "air/Sky,x:3,a < b,< -> <=,survived,excused\n" + more;
    put(path / "mutants.csv", text);
    std::filesystem::copy("validation/claims.csv", path / "claims.csv");
  }
};
}  // namespace

TEST(XTestsInvariant, TheShareIsThatOfTheCountedFaults) {
  const FaultReport report(380, 20);
  const Item item = ran("X.tests", report.path);
  auto verdicts = verdictsOf(item);
  EXPECT_EQ(verdicts["enough"], Verdict::reproduced);
  EXPECT_EQ(verdicts["noticed"], Verdict::reproduced);
  auto values = valuesOf(item);
  EXPECT_EQ(values["percent"], "95.0");
  EXPECT_EQ(values["first"], "47.5");
  EXPECT_EQ(values["excused"], "1");
  EXPECT_EQ(values["error"], "1.1");  // p = 382/404: sqrt(.9455 .0545 / 404)
  EXPECT_EQ(values["chapters"], "3");
  EXPECT_EQ(values["date"], "2002-05-01");
  EXPECT_EQ(values["rows"], "Sky & 0 & 0 & CDVector & 380 & 380 & Fresnel & 0 & 20 \\\\ ");
  EXPECT_EQ(values["survivors"].find("Fresnel & \\texttt{< -> <=} & "
                                     "\\texttt{\\{a\\_ < b; \\char126 c\\}} \\\\ "),
            0u);
}

TEST(XTestsInvariant, OneFaultLessDiffers) {  // negative control
  const FaultReport few(379, 20), unseen(379, 21);
  EXPECT_EQ(verdictsOf(ran("X.tests", few.path))["enough"], Verdict::differs);
  EXPECT_EQ(verdictsOf(ran("X.tests", unseen.path))["noticed"], Verdict::differs);
}

TEST(XTestsInvariant, ADamagedReportIsRefused) {
  const FaultReport damaged(1, 1, "base/CDVector,x:1,a,b,noticed,perhaps\n");
  EXPECT_THROW(ran("X.tests", damaged.path), InputError);
}
