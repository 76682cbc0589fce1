// The item that draws what spectra do (nw/thesis/XSpectra.nw).

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "Items.hpp"

using namespace malus;

namespace {
const Item& measured() {
  static const Item item = ran("X.spectra");
  return item;
}
}  // namespace

TEST(XSpectraInvariant, AllClaimsHoldAndAllPicturesAreDrawn) {
  const std::map<std::string, Verdict> expected{{"integral", Verdict::reproduced},
                                                {"peaks", Verdict::reproduced},
                                                {"bands", Verdict::reproduced},
                                                {"policies", Verdict::reproduced}};
  EXPECT_EQ(verdictsOf(measured()), expected);
  EXPECT_EQ(measured().pictures().size(), 3u);
}

TEST(XSpectraRegression, ValuesThatTheProseRestsOn) {
  auto values = valuesOf(measured());
  EXPECT_EQ(values["narrow"], "1.0000");
  EXPECT_EQ(values["rectangular"], "0.9500");
  EXPECT_EQ(values["peak.nm"], "500");                 // between blue and green
  EXPECT_GT(std::stod(values["peak.eV"]), 780);        // beyond what an eye sees
  EXPECT_NE(values["gaussian"], values["tabulated"]);  // negative control
}
