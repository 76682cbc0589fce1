// Section 7.7 of the thesis under a rural haze (nw/thesis/XModtran.nw).

#include <gtest/gtest.h>

#include <string>

#include "Items.hpp"

using namespace malus;

TEST(XModtranInvariant, AsCommitted) {
  const Item item = ran("X.modtran");
  auto verdicts = verdictsOf(item);
  for (const char* name :
       {"extinction", "absorption", "asymmetry", "each", "tops-650", "order", "S3"})
    EXPECT_EQ(verdicts[name], Verdict::reproduced) << name;
  for (const char* name : {"slight", "reason", "haze", "dolp-450", "tops-450", "most"})
    EXPECT_EQ(verdicts[name], Verdict::differs) << name;
  // what the chapter says of the tops: less at 450 nm, more at 650 nm
  auto values = valuesOf(item);
  EXPECT_LT(std::stod(values["tops450"]), std::stod(values["clear450"]));
  EXPECT_GT(std::stod(values["tops650"]), std::stod(values["clear650"]));
  EXPECT_EQ(verdicts["coulson"], Verdict::notTestable);
}

// Negative control: LOWTRAN's mean cosine of another humidity, 99 %.
TEST(XModtranInvariant, AnotherHumidityDiffers) {
  const Corrupted changed("lowtran-rural.csv", "0.6638", "0.7717");
  auto verdicts = verdictsOf(ran("X.modtran", changed.data));
  EXPECT_EQ(verdicts["asymmetry"], Verdict::differs);
  EXPECT_EQ(verdicts["extinction"], Verdict::reproduced);
}
