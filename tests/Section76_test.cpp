// The two flights over the chunky bar (nw/thesis/Section76.nw).

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "Items.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Scene.hpp"
#include "malus/thesis/Pictures.hpp"

using namespace malus;

namespace {
/// Where the axis of a frame's camera meets the height of a point, from that point.
double missOf(const Scene& scene, std::size_t frame, const CDVector& point) {
  const Pose pose = scene.platform.at(frame);
  const CDVector down = -pose.back;
  const CDVector met = pose.position + down * ((point.z - pose.position.z) / down.z);
  return (met - point).getLength();
}

/// How far the image is turned clockwise from having its x axis horizontal.
double rollOf_deg(const Pose& pose) {
  const CDVector level = normalized(cross(CDVector{0, 1, 0}, pose.back));
  return std::atan2(dot(cross(pose.right, level), pose.back), dot(pose.right, level)) / degree;
}
}  // namespace

TEST(Section76Identity, TheNadirCameraLooksStraightDownNineTimes) {
  const Scene scene = chunkyScene("flight-nadir", 16);
  ASSERT_EQ(scene.platform.frames(), 9u);
  for (std::size_t frame = 0; frame < 9; ++frame) {
    const Pose pose = scene.platform.at(frame);
    EXPECT_NEAR(pose.back.z, 1, 1e-15);
    EXPECT_EQ(pose.position.z, 15);
    EXPECT_NEAR(pose.position.x, -8 + 2.0 * static_cast<double>(frame), 1e-12);
    EXPECT_NEAR(pose.right.x, 1, 1e-15) << "north is up in the image";
  }
}

TEST(Section76Identity, TheStaringCameraIsPointedAtTheCentreFiveTimes) {
  const Scene scene = chunkyScene("flight-staring", 16);
  ASSERT_EQ(scene.platform.frames(), 5u);
  for (std::size_t frame = 0; frame < 5; ++frame)
    EXPECT_LT(missOf(scene, frame, {0, 0, 0.5}), 1e-12) << frame;
  const Scene other = chunkyScene("flight-staring", 16,  // negative control
                                  R"({"platform": {"target_m": [0.1, 0, 0.5]}})");
  EXPECT_GT(missOf(other, 1, {0, 0, 0.5}), 0.09);
}

// "The camera positions were the same as the previous simulation" (section 7.6.2): every second one.
TEST(Section76Published, BothFlightsHaveTheSamePositions) {
  const Platform nadir = chunkyScene("flight-nadir", 16).platform,
                 staring = chunkyScene("flight-staring", 16).platform;
  for (std::size_t frame = 0; frame < 5; ++frame) {
    const CDVector here = staring.at(frame).position, there = nadir.at(2 * frame).position;
    EXPECT_LT((here - there).getLength(), 1e-12) << frame;
    if (frame > 0) {  // negative control
      EXPECT_GT((here - nadir.at(2 * frame - 1).position).getLength(), 1) << frame;
    }
  }
}

// "... and rotated clockwise about the optical axis" (section 7.6.2)
TEST(Section76Published, TheStaringCameraIsTurnedMoreFromFrameToFrame) {
  const Platform staring = chunkyScene("flight-staring", 16).platform,
                 level = chunkyScene("flight-staring", 16,
                                     R"({"platform": {"roll_deg": [0, 0, 0, 0, 0]}})")
                             .platform;
  for (std::size_t frame = 1; frame < 5; ++frame) {
    EXPECT_GT(std::abs(rollOf_deg(staring.at(frame))),
              std::abs(rollOf_deg(staring.at(frame - 1))) + 5);
    EXPECT_NEAR(rollOf_deg(level.at(frame)), 0, 1e-9);  // negative control
  }
}

// Under one sun and one sky a Lambertian top is as bright from any of the places.
TEST(Section76Invariant, AMattTopDoesNotFollowTheCamera) {
  const char* const matt =
      R"({"materials": {"copper-020": {"model": "lambertian", "reflectance": 0.2, "n": null, "k": null, "sigma": null}},
          "radiometry": {"rays": [401]}})";
  const Scene scene = chunkyScene("flight-staring", 48, matt);
  const double expected =
      0.2 / std::numbers::pi * (std::cos(60 * degree) + 0.05 * std::numbers::pi);
  double copper_low = 1e9, copper_high = 0;
  for (std::size_t frame = 0; frame < 5; ++frame) {
    const StokesImage image = renderImage(scene, frame);
    // the grid sums the cosine to a few parts in a thousand (chapter Radiometry)
    EXPECT_NEAR(meanOver(image.stokes[0], insideOf(image, "4.top")), expected, 3e-3 * expected);
    const double copper = meanOver(image.stokes[0], insideOf(image, "3.top"));
    copper_low = std::min(copper_low, copper), copper_high = std::max(copper_high, copper);
  }
  EXPECT_GT(copper_high, 1.1 * copper_low);  // negative control: the copper top beside it does
}

TEST(Section76Published, FlightsAreDrawnWithTheirFrames) {
  const Item item = ran("F7.25");
  EXPECT_EQ(named(item, Verdict::reproduced), std::set<std::string>{"frames"});
  EXPECT_EQ(named(item, Verdict::notTestable), std::set<std::string>{"profiles"});
}
