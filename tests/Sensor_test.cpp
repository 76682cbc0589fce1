// Poses, pixels and bands (nw/render/Platform.nw, nw/render/Sensor.nw).
#include "malus/render/Sensor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi, rounding = 1e-13;
const Pose nadir = Pose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0});
const SpectralGridPtr light = SpectralGrid::make({400, 500, 600, 700});

Sensor camera(SensorKind kind, double focal = 100) {
  SensorGeometry g;
  g.kind = kind, g.width = 10, g.height = 6, g.focal_length_px = focal, g.principal_x = 5,
  g.principal_y = 3;
  g.row_time_s = kind == SensorKind::framing ? 0 : 1;
  return Sensor(g, SpectralGrid::make({550}), light);
}
void near(const CDVector& a, const CDVector& b) { EXPECT_LT((a - b).getLength(), rounding); }
}  // namespace

TEST(PlatformIdentity, LookingDownEastIsRightAndNorthIsUp) {
  near(nadir.right, {1, 0, 0});
  near(nadir.up, {0, 1, 0});
  near(nadir.back, {0, 0, 1});
  const Pose rolled = Pose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0}, pi / 2);
  near(rolled.right, {0, -1, 0});  // clockwise as seen from behind: the right side goes down
  near(rolled.up, {1, 0, 0});
  EXPECT_THROW(Pose::looking({}, {0, 0, -1}, {0, 0, 1}), MathError);
}

TEST(PlatformIdentity, PathsMoveStareAndTurn) {
  const Platform straight = Platform::straight(nadir, {2, 0, 0}, 9, 0.5);
  near(straight.at(4).position, {4, 0, 15});
  EXPECT_EQ(straight.time_s(8), 4);
  EXPECT_THROW(straight.at(9), std::out_of_range);
  const Platform staring =
      Platform::staring({-4, 0, 3}, {2, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0}, 5, 1);
  near(staring.at(0).back, {-0.8, 0, 0.6});
  near(staring.at(4).back, {0.8, 0, 0.6});
  Pose later = Pose::looking({2, 0, 15}, {0, 0, -1}, {1, 0, 0});
  later.time_s = 2;
  const Platform list = Platform::poses({nadir, later});
  near(list.at(0, 1).position, {1, 0, 15});
  near(list.at(0, 1).up, {std::sqrt(0.5), std::sqrt(0.5), 0});
  EXPECT_THROW(Platform::poses({later, nadir}), MathError);
  EXPECT_THROW(Platform::staring({0, 0, 3}, {}, {0, 0, 0}, {0, 0, 1}, {0}, 1, 0), MathError);
}

// By hand in the chapter: about its up axis by a quarter, and back in the world after a whole turn.
TEST(PlatformIdentity, ATurningCameraLooksWestAfterAQuarter) {
  const Platform yaw = Platform::fixed(nadir, 1, 0).turning({0, pi / 2, 0});
  near(yaw.at(0, 1).right, {0, 0, -1});
  near(yaw.at(0, 1).back, {1, 0, 0});
  near(yaw.at(0, 1).up, nadir.up);
  near(yaw.at(0, 4).right, nadir.right);
  const Platform pitch = Platform::fixed(nadir).turning({pi / 2, 0, 0});
  near(pitch.at(0, 1).back, {0, -1, 0});  // its up, which was north, now points up
  near(pitch.at(0, 1).up, {0, 0, 1});
  const Platform roll = Platform::straight(nadir, {1, 0, 0}, 3, 1).turning({0, 0, pi / 2});
  near(roll.at(2).right, {-1, 0, 0});
  near(roll.at(2).position, {2, 0, 15});
  EXPECT_THROW(
      Platform::staring({0, 0, 3}, {}, {0, 0, 0}, {0, 1, 0}, {0}, 1, 0).turning({1, 0, 0}),
      MathError);
}

// From above, x to the right and y up: seen from behind, the camera turns clockwise, its top to
// the right.
TEST(PlatformIdentity, AStaringCameraRollsByFrame) {
  const auto staring = [](std::vector<double> roll_rad) {
    return Platform::staring({0, 0, 3}, {}, {0, 0, 0}, {0, 1, 0}, std::move(roll_rad), 3, 1);
  };
  const Platform each = staring({0, pi / 2, pi}), all = staring({pi / 2});
  near(each.at(0).up, {0, 1, 0});
  near(each.at(1).up, {1, 0, 0});
  near(each.at(2).up, {0, -1, 0});
  for (std::size_t frame = 0; frame < 3; ++frame) near(all.at(frame).up, {1, 0, 0});
  EXPECT_THROW(all.at(3), std::out_of_range);
  EXPECT_THROW(staring({0, 1}), MathError);
  EXPECT_THROW(staring({0, 1, 2, 3}), MathError);
}

// Cells of a pixel are the fewest columns and rows that hold all samples, nearly a square; without jitter rays go through
// the middles of the first ones, row by row.
TEST(SensorIdentity, SamplesStandInCells) {
  const Platform platform = Platform::fixed(nadir);
  for (const auto& [samples, columns, rows] : std::vector<std::array<int, 3>>{
           {1, 1, 1}, {2, 2, 1}, {3, 2, 2}, {5, 3, 2}, {7, 3, 3}, {10, 4, 3}}) {
    SensorGeometry g = camera(SensorKind::framing).geometry();
    g.samples = std::size_t(samples);
    const Sensor sensor(g, SpectralGrid::make({550}), light);
    for (int sample = 0; sample < samples; ++sample) {
      const double across = (sample % columns + 0.5) / columns,
                   down = (sample / columns + 0.5) / rows;
      near(sensor.ray(0, 0, std::size_t(sample), platform, 0, 1).direction,
           normalized({across - 5, 3 - down, -100}));
    }
  }
}

TEST(SensorIdentity, PixelsLookWhereThePinholeSays) {
  const Platform platform = Platform::fixed(nadir);
  const auto upper_left = camera(SensorKind::framing).ray(0, 0, 0, platform, 0, 1);
  near(upper_left.direction, normalized({-4.5, 2.5, -100}));
  near(upper_left.horizontal, {1, 0, 0});
  EXPECT_EQ(camera(SensorKind::framing).ray(3, 2, 0, platform, 0, 1).pixel, 23u);
  const Platform flight = Platform::straight(nadir, {0, -1, 0}, 1, 0);
  const auto third_row = camera(SensorKind::pushbroom).ray(9, 2, 0, flight, 0, 1);
  near(third_row.direction, normalized({4.5, 0, -100}));
  near(third_row.origin, {0, -2, 15});
  const double focal = focalLengthFromView(SensorKind::lineScanner, 10, 1);
  near(camera(SensorKind::lineScanner, focal).ray(9, 0, 0, flight, 0, 1).direction,
       {std::sin(0.45), 0, -std::cos(0.45)});
  EXPECT_NEAR(focalLengthFromView(SensorKind::framing, 128, 14.3 * pi / 180), 510.2, 0.05);
}

TEST(SensorInvariant, JitterStaysInItsPixelAndIsRepeatable) {
  SensorGeometry g = camera(SensorKind::framing).geometry();
  g.samples = 9, g.jitter = true;
  const Sensor sensor(g, SpectralGrid::make({550}), light);
  const Platform platform = Platform::fixed(nadir);
  for (std::size_t sample = 0; sample < 9; ++sample) {
    const CDVector d = sensor.ray(5, 3, sample, platform, 0, 7).direction;
    const double u = -d.x / d.z * 100, v = d.y / d.z * 100;
    EXPECT_TRUE(u >= double(sample % 3) / 3 && u <= double(sample % 3 + 1) / 3) << u;
    EXPECT_TRUE(v >= double(sample / 3) / 3 && v <= double(sample / 3 + 1) / 3) << v;
    near(sensor.ray(5, 3, sample, platform, 0, 7).direction, d);
    EXPECT_GT((sensor.ray(5, 3, sample, platform, 0, 8).direction - d).getLength(), 1e-6);
  }
}

TEST(SensorIdentity, BandsAreAverages) {
  std::array<double, 16> in{};
  for (std::size_t i = 0; i < 4; ++i) in[i] = double(i), in[4 + i] = 10 * double(i);
  std::array<double, 4> out{};
  camera(SensorKind::framing).integrate(in, out);
  EXPECT_NEAR(out[0], 1.5, rounding);
  EXPECT_NEAR(out[1], 15, rounding * 10);
  EXPECT_EQ(out[2], 0);
}

TEST(SensorIdentity, BadSensorsAreRefused) {
  SensorGeometry g = camera(SensorKind::framing).geometry();
  const auto make = [](const SensorGeometry& made) {
    Sensor(made, SpectralGrid::make({550}), light);
  };
  EXPECT_NO_THROW(make(g));
  for (auto spoil : {+[](SensorGeometry& s) { s.width = 0; },
                     +[](SensorGeometry& s) { s.focal_length_px = 0; },
                     +[](SensorGeometry& s) { s.samples = 0; }}) {
    SensorGeometry bad = g;
    spoil(bad);
    EXPECT_THROW(make(bad), MathError);
  }
  EXPECT_THROW(Sensor(g, SpectralGrid::make({800}), light), GridError);
  EXPECT_THROW(focalLengthFromView(SensorKind::framing, 10, 3.2), MathError);
}
