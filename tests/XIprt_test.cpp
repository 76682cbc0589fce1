// Phase A of the IPRT (nw/thesis/XIprt.nw).

#include <gtest/gtest.h>

#include <string>

#include "Items.hpp"

using namespace malus;

TEST(XIprtInvariant, AsCommitted) {
  const Item item = ran("X.iprt");
  auto verdicts = verdictsOf(item);
  for (const char* name : {"A1", "A2", "A3", "A4", "B1", "B2", "B3"}) {
    EXPECT_EQ(verdicts[std::string("rms.") + name], Verdict::reproduced) << name;
    EXPECT_EQ(verdicts[std::string("worst.") + name], Verdict::reproduced) << name;
  }
  EXPECT_EQ(verdicts["neutral"], Verdict::reproduced);
  EXPECT_EQ(verdicts["snow"], Verdict::reproduced);
  // where MYSTIC breaks the symmetry of the atmosphere by more than five of its deviations
  auto values = valuesOf(item);
  EXPECT_GT(std::stod(values["zeros.A6"]), 5);
  EXPECT_GT(std::stod(values["zeros.B4"]), 5);
  EXPECT_LT(std::stod(values["zeros.A1"]), 5);
  // haze lifts Arago's point, and the sea lowers it
  EXPECT_GT(std::stod(values["arago.haze"]), std::stod(values["arago.clear"]) + 3);
  EXPECT_LT(std::stod(values["arago.sea"]), std::stod(values["arago.clear"]) - 2);
}

// Negative control: one number of A2 off by six of its deviations of 1.2e-5.
TEST(XIprtInvariant, AChangedNumberDiffers) {
  const Corrupted changed("iprt-mystic.csv", "5.79935e-02", "5.80735e-02");
  auto verdicts = verdictsOf(ran("X.iprt", changed.data));
  EXPECT_EQ(verdicts["worst.A2"], Verdict::differs);
  EXPECT_EQ(verdicts["worst.A1"], Verdict::reproduced);
}
