// What is measured on pictures of scenes (nw/thesis/Pictures.nw).
#include "thesis/Pictures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "Items.hpp"

using namespace malus;

namespace {
/// 6 x 5 pixels: a facet "top" of 4 x 3 in a frame of "ground", S0 = 1.
CDStokesImage framed() {
  CDStokesImage image{6, 5, {}, std::vector<std::uint32_t>(30, 0), {"ground", "top"}};
  for (auto& plane : image.stokes) plane.assign(30, 0);
  image.stokes[0].assign(30, 1);
  for (int y = 1; y < 4; ++y)
    for (int x = 1; x < 5; ++x) image.facet[y * 6 + x] = 1;
  return image;
}
}  // namespace

TEST(PicturesIdentity, TheInsideOfAFacetHasNoRim) {
  CDStokesImage image = framed();
  EXPECT_EQ(insideOf(image, "top"), (CDPixels{14, 15}));  // the middle row without its ends
  EXPECT_TRUE(insideOf(image, "ground").empty());         // nowhere two pixels thick
  EXPECT_EQ(insideOf(image, [](const std::string&) { return true; }), (CDPixels{14, 15}));
  image.facet[7] = 0;  // negative control: a corner of the facet is gone
  EXPECT_EQ(insideOf(image, "top"), CDPixels{15});
  image.facet.assign(30, CDStokesImage::nothing);
  EXPECT_TRUE(insideOf(image, [](const std::string&) { return true; }).empty());
}

TEST(PicturesIdentity, MeansAndErrorsByHand) {
  const std::vector<double> values{1, 2, 3, 9}, reference{1, 2, 3, 4};
  EXPECT_EQ(meanOver(values, {0, 1, 2}), 2);
  EXPECT_EQ(rmsDifference(values, reference, {0, 1, 2}), 0);
  EXPECT_NEAR(rmsDifference(values, reference, {0, 3}), 5 / std::sqrt(2.0), 1e-15);
  EXPECT_TRUE(std::isnan(meanOver(values, {})));
  CDStokesImage noisy = framed();
  EXPECT_EQ(relativeError(noisy, framed()), 0);
  noisy.stokes[0][3] = 4;  // negative control: 3 off in one pixel of 30, mean 1
  EXPECT_NEAR(relativeError(noisy, framed()), 3 / std::sqrt(30.0), 1e-15);
}

TEST(PicturesIdentity, SpecklesAndHotSpotsAreCounted) {
  const std::vector<double> reference(6, 1.0), values{1, 1.05, 1.5, 0.4, 1, 30};
  const CDPixels all{0, 1, 2, 3, 4, 5}, dark{0, 1, 4};
  const CDSpeckles speckles = specklesOf(values, reference, all, 0.1);
  EXPECT_EQ(speckles.count, 3u);
  EXPECT_NEAR(speckles.magnitude, (0.5 + 0.6 + 29) / 3, 1e-14);
  EXPECT_EQ(hotSpots(values, reference, all, 10), 1u);
  EXPECT_EQ(specklesOf(values, reference, dark, 0.1).count, 0u);  // negative control
  EXPECT_EQ(specklesOf(values, reference, dark, 0.1).magnitude, 0);
}

TEST(PicturesIdentity, ShadesAndStretch) {
  const std::vector<double> ramp{0, 1 / 255., 1 / 255. + 1e-4, 1, 7, -3};
  EXPECT_EQ(shadesOfGrey(ramp, {0, 1, 2, 3, 4, 5}, 0, 1),
            3u);  // 0, 1 and 255; outside is cut off
  EXPECT_EQ(shadesOfGrey(ramp, {0, 1, 2, 3, 4, 5}, -3, 7), 4u);
  std::vector<double> flat(1000, 0.5);
  flat[17] = 1e6;  // a hot spot does not set the stretch
  EXPECT_EQ(stretchEnd({&flat}), 0.5);
  EXPECT_EQ(stretchEnd({&flat}, 0), 1e6);
}

TEST(PicturesIdentity, DegreeOfPolarisationOfEachPixel) {
  CDStokesImage image = framed();
  image.stokes[1][2] = 0.3, image.stokes[2][2] = -0.4, image.stokes[0][4] = 0;
  const std::vector<double> degree = image.dolp();
  EXPECT_NEAR(degree[2], 0.5, 1e-15);
  EXPECT_EQ(degree[3], 0);
  EXPECT_EQ(degree[4], 0);  // no light
}

TEST(PicturesInvariant, PanelsBecomeTwoTablesAndAPicture) {
  CDItem item("F0", "nowhere", "validation");
  const CDStokesImage image = framed();
  drawPanels(item, "images", image.width,
             {{"a", image.stokes[0], 0, 1}, {"b", image.stokes[1], -1, 1, "signed"}}, 2, "W",
             "two panels");
  ASSERT_EQ(item.tables().size(), 2u);
  EXPECT_EQ(item.tables()[0].second.rows(), 2u);
  EXPECT_EQ(item.tables()[1].second.rows(), 30u);
  EXPECT_EQ(item.pictures().front().script, "images");
}
