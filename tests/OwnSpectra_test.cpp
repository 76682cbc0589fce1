// The item that draws what spectra do (nw/thesis/OwnSpectra.nw).
#include "thesis/OwnSpectra.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "Items.hpp"

using namespace malus;

namespace {
const CDItem& measured() {
  static const CDItem item = ran("X.spectra", reproduceXSpectra);
  return item;
}
}  // namespace

TEST(OwnSpectraInvariant, AllClaimsHoldAndAllPicturesAreDrawn) {
  const std::map<std::string, CDVerdict> expected{{"integral", CDVerdict::reproduced},
                                                  {"peaks", CDVerdict::reproduced},
                                                  {"bands", CDVerdict::reproduced},
                                                  {"policies", CDVerdict::reproduced}};
  EXPECT_EQ(verdictsOf(measured()), expected);
  EXPECT_EQ(measured().pictures().size(), 3u);
}

TEST(OwnSpectraRegression, ValuesThatTheProseRestsOn) {
  auto values = valuesOf(measured());
  EXPECT_EQ(values["narrow"], "1.0000");
  EXPECT_EQ(values["rectangular"], "0.9500");
  EXPECT_EQ(values["peak.nm"], "500");                 // between blue and green
  EXPECT_GT(std::stod(values["peak.eV"]), 780);        // beyond what an eye sees
  EXPECT_NE(values["gaussian"], values["tabulated"]);  // negative control
}
