// The item that weighs what polarisation costs (nw/thesis/XSpeed.nw).

#include <gtest/gtest.h>

#include "Items.hpp"

using namespace malus;

// What is counted and drawn must hold. Nothing is timed.
TEST(XSpeedInvariant, TheSameWorkAndTheSamePicture) {
  const Item item = ran("C5");
  auto verdicts = verdictsOf(item);
  EXPECT_EQ(verdicts.size(), 3u);
  EXPECT_EQ(verdicts["picture"], Verdict::reproduced);
  EXPECT_EQ(verdicts["numbers"], Verdict::reproduced);
  EXPECT_EQ(verdicts.count("time"), 1u);
  auto values = valuesOf(item);
  EXPECT_GT(std::stod(values["polarized"]), 2)
      << "negative control: polarised light is more numbers";
  EXPECT_EQ(values.count("ratio"), 0u) << "a clock would make every copy of the book another";
}
