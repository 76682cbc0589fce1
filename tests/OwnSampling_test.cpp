// The item that weighs samplings against each other (nw/thesis/OwnSampling.nw).
#include "thesis/OwnSampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "Items.hpp"

using namespace malus;

namespace {
const CDItem& measured() {
  static const CDItem item = ran("X.sampling", reproduceXSampling);
  return item;
}
}  // namespace

TEST(OwnSamplingInvariant, AllClaimsHoldAndThePictureIsDrawn) {
  const std::map<std::string, CDVerdict> expected{{"random", CDVerdict::reproduced},
                                                  {"sobol", CDVerdict::reproduced},
                                                  {"rotated", CDVerdict::reproduced},
                                                  {"mixture", CDVerdict::reproduced}};
  EXPECT_EQ(verdictsOf(measured()), expected);
  EXPECT_EQ(measured().pictures().size(), 1u);
}

// The order of the samplings at 64 rays, in every component, is what the chapter's prose rests on.
TEST(OwnSamplingRegression, OrderOfTheSamplings) {
  auto values = valuesOf(measured());
  for (const std::string s : {"S0", "S1", "S2", "S3"}) {
    const auto error = [&](const std::string& sampler) {
      return std::stod(values[sampler + "." + s]);
    };
    EXPECT_LT(error("sobol"), error("importance")) << s;
    EXPECT_LT(error("importance"), error("gridRotated")) << s;
    EXPECT_LT(error("gridRotated"), error("random")) << s;
    EXPECT_GT(error("sobol"), 0) << "negative control: a picture compared with itself";
  }
}

// The same seed makes the same picture, so errors are equal to the last bit; time is not asked.
TEST(OwnSamplingInvariant, MeasurementIsRepeatable) {
  const auto once = measureSamplings(8, {16}, 1, 32, CDSamplingSky::uniform);
  const auto again = measureSamplings(8, {16}, 1, 32, CDSamplingSky::uniform, "sobol");
  ASSERT_EQ(once.size(), 5u);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(once.back().sampler, "sobol");
  EXPECT_EQ(once.back().errors, again[0].errors);
  EXPECT_NE(once[0].errors, again[0].errors) << "negative control: random directions";
}
