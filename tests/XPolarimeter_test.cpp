// The item that looks through four cameras and a mosaic (nw/thesis/XPolarimeter.nw).

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "Items.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Polarimeter.hpp"

using namespace malus;

namespace {
const Item& measured() {
  static const Item item = ran("X.polarimeter");
  return item;
}
}  // namespace

TEST(XPolarimeterInvariant, AllClaimsHoldAndThePictureIsDrawn) {
  const std::map<std::string, Verdict> expected{{"recovered", Verdict::reproduced},
                                                {"noise", Verdict::reproduced},
                                                {"edges", Verdict::reproduced}};
  EXPECT_EQ(verdictsOf(measured()), expected);
  EXPECT_EQ(measured().pictures().size(), 1u);
}

// sqrt(3) where all readings are equal; here they differ by a tenth or so, and 16384 pixels leave one per cent.
TEST(XPolarimeterIdentity, TheNoiseOfS2IsAboutRootThreeTimesThatOfS1) {
  auto values = valuesOf(measured());
  EXPECT_NEAR(std::stod(values["noisier"]), std::sqrt(3.0), 0.1);
  EXPECT_GT(std::stod(values["outer"]), std::stod(values["inner"]));
}

TEST(XPolarimeterIdentity, NegativeControlAFilterThatIsTurnedIsSeen) {
  const auto cameras = [&](double second_deg) {
    return Polarimeter(camerasBehind({linearPolarizer(0), linearPolarizer(second_deg * degree),
                                      linearPolarizer(90 * degree), circularPolarizer(1)}),
                       1, 1, 1, 1, 1);
  };
  const std::vector<double> light{1, 0.3, 0.2, 0.1};
  const auto back = [&](double turned_deg) {
    const Polarimeter p = cameras(45);
    return p.recover(cameras(turned_deg).read(light, p.whole()), p.whole());
  };
  EXPECT_NEAR(back(45)[2], light[2], 1e-13);
  EXPECT_GT(std::abs(back(46)[2] - light[2]), 1e-3);
}
