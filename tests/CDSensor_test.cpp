// Poses, pixels and bands (nw/imaging/CDPlatform.nw, nw/imaging/CDSensor.nw).
#include "imaging/CDSensor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "light/CDError.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi, rounding = 1e-13;
const CDPose nadir = CDPose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0});
const CDSpectralGridPtr light = CDSpectralGrid::make({400, 500, 600, 700});

CDSensor camera(CDSensorKind kind, double focal = 100) {
  CDSensorGeometry g;
  g.kind = kind, g.width = 10, g.height = 6, g.focal_length_px = focal, g.principal_x = 5,
  g.principal_y = 3;
  g.row_time_s = kind == CDSensorKind::framing ? 0 : 1;
  return CDSensor(g, CDSpectralGrid::make({550}), light);
}
void near(const CDVector& a, const CDVector& b) { EXPECT_LT((a - b).getLength(), rounding); }
}  // namespace

TEST(CDPlatformIdentity, LookingDownEastIsRightAndNorthIsUp) {
  near(nadir.right, {1, 0, 0});
  near(nadir.up, {0, 1, 0});
  near(nadir.back, {0, 0, 1});
  const CDPose rolled = CDPose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0}, pi / 2);
  near(rolled.right, {0, -1, 0});  // clockwise for who stands behind: the right hand goes down
  near(rolled.up, {1, 0, 0});
  EXPECT_THROW(CDPose::looking({}, {0, 0, -1}, {0, 0, 1}), CDMathError);
}

TEST(CDPlatformIdentity, PathsMoveStareAndTurn) {
  const CDPlatform straight = CDPlatform::straight(nadir, {2, 0, 0}, 9, 0.5);
  near(straight.at(4).position, {4, 0, 15});
  EXPECT_EQ(straight.time_s(8), 4);
  EXPECT_THROW(straight.at(9), std::out_of_range);
  const CDPlatform staring =
      CDPlatform::staring({-4, 0, 3}, {2, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0}, 5, 1);
  near(staring.at(0).back, {-0.8, 0, 0.6});
  near(staring.at(4).back, {0.8, 0, 0.6});
  CDPose later = CDPose::looking({2, 0, 15}, {0, 0, -1}, {1, 0, 0});
  later.time_s = 2;
  const CDPlatform list = CDPlatform::poses({nadir, later});
  near(list.at(0, 1).position, {1, 0, 15});
  near(list.at(0, 1).up, {std::sqrt(0.5), std::sqrt(0.5), 0});
  EXPECT_THROW(CDPlatform::poses({later, nadir}), CDMathError);
  EXPECT_THROW(CDPlatform::staring({0, 0, 3}, {}, {0, 0, 0}, {0, 0, 1}, {0}, 1, 0),
               CDMathError);
}

TEST(CDSensorIdentity, PixelsLookWhereThePinholeSays) {
  const CDPlatform platform = CDPlatform::fixed(nadir);
  const auto upper_left = camera(CDSensorKind::framing).ray(0, 0, 0, platform, 0, 1);
  near(upper_left.direction, normalized({-4.5, 2.5, -100}));
  near(upper_left.horizontal, {1, 0, 0});
  EXPECT_EQ(camera(CDSensorKind::framing).ray(3, 2, 0, platform, 0, 1).pixel, 23u);
  const CDPlatform flight = CDPlatform::straight(nadir, {0, -1, 0}, 1, 0);
  const auto third_row = camera(CDSensorKind::pushbroom).ray(9, 2, 0, flight, 0, 1);
  near(third_row.direction, normalized({4.5, 0, -100}));
  near(third_row.origin, {0, -2, 15});
  const double focal = focalLengthFromView(CDSensorKind::lineScanner, 10, 1);
  near(camera(CDSensorKind::lineScanner, focal).ray(9, 0, 0, flight, 0, 1).direction,
       {std::sin(0.45), 0, -std::cos(0.45)});
  EXPECT_NEAR(focalLengthFromView(CDSensorKind::framing, 128, 14.3 * pi / 180), 510.2, 0.05);
}

TEST(CDSensorInvariant, JitterStaysInItsPixelAndIsRepeatable) {
  CDSensorGeometry g = camera(CDSensorKind::framing).geometry();
  g.samples = 9, g.jitter = true;
  const CDSensor sensor(g, CDSpectralGrid::make({550}), light);
  const CDPlatform platform = CDPlatform::fixed(nadir);
  for (std::size_t sample = 0; sample < 9; ++sample) {
    const CDVector d = sensor.ray(5, 3, sample, platform, 0, 7).direction;
    const double u = -d.x / d.z * 100, v = d.y / d.z * 100;
    EXPECT_TRUE(u >= double(sample % 3) / 3 && u <= double(sample % 3 + 1) / 3) << u;
    EXPECT_TRUE(v >= double(sample / 3) / 3 && v <= double(sample / 3 + 1) / 3) << v;
    near(sensor.ray(5, 3, sample, platform, 0, 7).direction, d);
    EXPECT_GT((sensor.ray(5, 3, sample, platform, 0, 8).direction - d).getLength(), 1e-6);
  }
}

TEST(CDSensorIdentity, BandsAreAverages) {
  std::array<double, 16> in{};
  for (std::size_t i = 0; i < 4; ++i) in[i] = double(i), in[4 + i] = 10 * double(i);
  std::array<double, 4> out{};
  camera(CDSensorKind::framing).integrate(in, out);
  EXPECT_NEAR(out[0], 1.5, rounding);
  EXPECT_NEAR(out[1], 15, rounding * 10);
  EXPECT_EQ(out[2], 0);
}

TEST(CDSensorIdentity, BadSensorsAreRefused) {
  CDSensorGeometry g = camera(CDSensorKind::framing).geometry();
  const auto make = [](const CDSensorGeometry& made) {
    CDSensor(made, CDSpectralGrid::make({550}), light);
  };
  EXPECT_NO_THROW(make(g));
  for (auto spoil : {+[](CDSensorGeometry& s) { s.width = 0; },
                     +[](CDSensorGeometry& s) { s.focal_length_px = 0; },
                     +[](CDSensorGeometry& s) { s.samples = 0; }}) {
    CDSensorGeometry bad = g;
    spoil(bad);
    EXPECT_THROW(make(bad), CDMathError);
  }
  EXPECT_THROW(CDSensor(g, CDSpectralGrid::make({800}), light), CDGridError);
  EXPECT_THROW(focalLengthFromView(CDSensorKind::framing, 10, 3.2), CDMathError);
}
