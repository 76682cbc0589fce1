// The axes of the pictures that framing, pushbroom and line-scanning cameras take (nw/render/Sensor.nw).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Sensor.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
constexpr std::size_t side = 24;  // pixels of a picture
constexpr double height_m =
    200;  // of the camera, far away: the three sensors see nearly the same
constexpr double pixel_m = 2.4 / side;  // on the ground
constexpr std::array kinds{SensorKind::framing, SensorKind::pushbroom, SensorKind::lineScanner};

Sensor sensorOf(SensorKind kind) {
  SensorGeometry g;
  g.kind = kind, g.width = g.height = side, g.principal_x = g.principal_y = side / 2.0;
  g.focal_length_px = height_m / pixel_m, g.row_time_s = 0.5;
  return Sensor(g, oneBand(), oneBand());
}

// A flight over the origin that is there in the middle of the rows, at one pixel for each row.
Platform flightTowards(double heading_rad, const CDVector& up) {
  const CDVector way{std::cos(heading_rad), std::sin(heading_rad), 0};
  const CDVector start = CDVector{0, 0, height_m} - way * (pixel_m * (side - 1) / 2.0);
  return Platform::straight(Pose::looking(start, {0, 0, -1}, up), way * (pixel_m / 0.5), 1, 0);
}
// A framing camera is there already.
Platform above(const CDVector& up) {
  return Platform::fixed(Pose::looking({0, 0, height_m}, {0, 0, -1}, up));
}
Platform platformOf(SensorKind kind, double heading_rad, const CDVector& up) {
  return kind == SensorKind::framing ? above(up) : flightTowards(heading_rad, up);
}

struct Picture {
  std::vector<std::array<double, 4>> stokes;
  std::vector<Radiometry::Truth> truth;
};
Picture taken(const World& world, SensorKind kind, const Platform& platform) {
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              {.sampling = Sampling::importance, .rays = {129}});
  const Sensor sensor = sensorOf(kind);
  std::vector<Radiometry::Ray> rays;
  for (std::size_t i = 0; i < side * side; ++i)
    rays.push_back(sensor.ray(i % side, i / side, 0, platform, 0, 1));
  std::vector<double> out(4 * rays.size());
  Picture made{{}, std::vector<Radiometry::Truth>(rays.size())};
  radiometry.radiance(rays, out, made.truth);
  for (std::size_t i = 0; i < rays.size(); ++i)
    made.stokes.push_back({out[4 * i], out[4 * i + 1], out[4 * i + 2], out[4 * i + 3]});
  return made;
}

// A glossy opaque ball, of facets two degrees wide, radius 1, in a sky that is even all around.
const World& ball() {
  static const World world = [] {
    const auto all = [](double value) { return CDSpectralVector<double>(oneBand(), value); };
    const auto gloss = std::make_shared<BRDFTorranceSparrow>(
        all(1.5), all(0), all(0.05), TorranceSparrowOptions{.diffuse = DiffuseTerm::none});
    Mesh mesh;
    mesh.facets = mesh.materials = {"ball"};
    constexpr std::uint32_t rows = 90, columns = 180;
    for (std::uint32_t i = 0; i <= rows; ++i)
      for (std::uint32_t j = 0; j < columns; ++j)
        mesh.vertices.push_back(CDVector::fromAngles(pi * i / rows, 2 * pi * j / columns));
    for (std::uint32_t i = 0; i < rows; ++i)
      for (std::uint32_t j = 0; j < columns; ++j) {
        const std::uint32_t a = i * columns + j, b = i * columns + (j + 1) % columns;
        mesh.triangles.push_back({a, a + columns, b + columns, 0, 0});
        mesh.triangles.push_back({a, b + columns, b, 0, 0});
      }
    GeometryBuilder builder;
    builder.addMesh(mesh, {});
    World made;
    made.grid = oneBand();
    made.geometry = std::move(builder).build();
    made.materials = {{"ball", gloss}};
    made.sky = uniformSky(1);
    return made;
  }();
  return world;
}

// The largest angle by which the polarisation is not across the radius of the ball's image, over the pixels between a
// half and nine tenths of the radius; sign -1 mirrors S2.
double offTheRadius(const Picture& picture, double sign = 1) {
  double largest = 0;
  for (std::size_t i = 0; i < side * side; ++i) {
    const double x = (double(i % side) + 0.5 - side / 2.0) * pixel_m,
                 y = (side / 2.0 - double(i / side) - 0.5) * pixel_m, r = std::hypot(x, y);
    if (r < 0.5 || r > 0.9) continue;
    const auto& s = picture.stokes[i];
    const double angle = std::atan2(sign * s[2], s[1]) / 2, radius = std::atan2(y, x);
    largest = std::max(largest, std::abs(std::remainder(angle - radius - pi / 2, pi)));
  }
  return largest / degree;
}

const CDVector ahead(double heading_rad, double turned_rad = 0) {
  return {std::cos(heading_rad + turned_rad), std::sin(heading_rad + turned_rad), 0};
}
constexpr std::array headings{0.0, 90.0, 30.0, 117.0, 211.0, 333.0};
}  // namespace

// By the mirror symmetry of ball and sky, polarisation is across the radius. What remains: facets are two degrees wide,
// so their normals are off by one; the chance of 128 directions, which is another degree (one of a thousand pixels may be off by
// three of them).
constexpr double facets_and_chance_deg = 3;

TEST(ScannersIdentity, ABallIsPolarisedAcrossItsRadiusInEveryPicture) {
  for (const SensorKind kind : kinds)
    for (const double heading : headings)
      for (const double turned : {0.0, pi}) {
        const CDVector up = ahead(heading * degree, turned);
        const Picture picture = taken(ball(), kind, platformOf(kind, heading * degree, up));
        EXPECT_LT(offTheRadius(picture), facets_and_chance_deg) << heading << " " << turned;
        EXPECT_GT(offTheRadius(picture, -1), 60)
            << "negative control: a mirrored picture; at some pixel it is off by a right angle";
      }
}

// Three plates on the ground, whose order around the middle is that of a map and not of its mirror image.
TEST(ScannersIdentity, NoPictureIsMirrored) {
  const auto matt = [](double r) {
    return std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(oneBand(), r));
  };
  const auto plate = [&](double x, double y) {
    const double h = 0.35;
    return Quad{
        {x - h, y - h, 0}, {x + h, y - h, 0}, {x + h, y + h, 0}, {x - h, y + h, 0}, matt(0.5)};
  };
  const World world =
      worldOf({plate(0.52, 0.13), plate(-0.28, 0.61), plate(-0.23, -0.47)}, uniformSky(1));
  for (const double heading : headings)
    for (const double turned : {0.0, pi}) {
      const CDVector up = ahead(heading * degree, turned);
      const Picture map = taken(world, SensorKind::framing, above(up));
      for (const SensorKind kind : {SensorKind::pushbroom, SensorKind::lineScanner}) {
        const Picture scan = taken(world, kind, flightTowards(heading * degree, up));
        std::size_t differ = 0, mirrored = 0;
        for (std::size_t i = 0; i < side * side; ++i) {
          const std::size_t below = (side - 1 - i / side) * side + i % side;
          differ += scan.truth[i].facet != map.truth[i].facet;
          mirrored += scan.truth[below].facet != map.truth[i].facet;
        }
        EXPECT_LE(differ, 2u) << "edges, by rounding; " << heading;
        EXPECT_GT(mirrored, 40u) << "negative control: rows in the other order";
      }
    }
}

// The first row of the flight is the lowest if up is ahead, the uppermost if up is behind.
TEST(ScannersIdentity, RowsFollowTheFlight) {
  const Sensor sensor = sensorOf(SensorKind::pushbroom);
  for (const double turned : {0.0, pi}) {
    const Platform flight = flightTowards(0.4, ahead(0.4, turned));
    const CDVector top = sensor.ray(0, 0, 0, flight, 0, 1).origin,
                   bottom = sensor.ray(0, side - 1, 0, flight, 0, 1).origin;
    EXPECT_GT(dot(top - bottom, ahead(0.4, turned)), 2);
    const RowMotion motion = sensor.rowMotion(flight, 0);
    EXPECT_NEAR(motion.up, (turned > 0 ? -1 : 1) * pixel_m * (side - 1), 1e-12);
    EXPECT_NEAR(motion.lean_rad(), 0, 1e-12);
  }
}

TEST(ScannersIdentity, TheMotionSaysHowThePictureLeans) {
  const Sensor sensor = sensorOf(SensorKind::lineScanner);
  EXPECT_NEAR(sensor.rowMotion(flightTowards(0.4, ahead(0.4, 0.3)), 0).lean_rad(), 0.3, 1e-12);
  EXPECT_NEAR(sensor.rowMotion(flightTowards(0.4, ahead(0.4, pi / 2)), 0).lean_rad(), pi / 2,
              1e-9);
  EXPECT_FALSE(sensor.rowMotion(above({0, 1, 0}), 0).moves()) << "a camera that hovers";
  EXPECT_EQ(sensor.rowMotion(above({0, 1, 0}), 0).lean_rad(), pi / 2);
  EXPECT_FALSE(sensorOf(SensorKind::framing).rowMotion(flightTowards(0, {1, 0, 0}), 0).moves());
  // straight down: nothing moves across the view
  const Platform falling =
      Platform::straight(Pose::looking({0, 0, 200}, {0, 0, -1}, {0, 1, 0}), {0, 0, -1}, 1, 0);
  EXPECT_FALSE(sensor.rowMotion(falling, 0).moves());
  // a camera for panoramas keeps its place and tilts upwards
  Pose later = Pose::looking({0, 0, 2}, {0, 1, 1}, {0, 0, 1});
  later.time_s = 100;
  const Platform tilting =
      Platform::flight({Pose::looking({0, 0, 2}, {0, 1, 0}, {0, 0, 1}), later});
  EXPECT_EQ(tilting.frames(), 1u);
  EXPECT_GT(sensor.rowMotion(tilting, 0).up, 0);
  EXPECT_NEAR(sensor.rowMotion(tilting, 0).right, 0, 1e-12);
}

// A pixel's axes keep the image's horizontal; other programs keep the vertical. The angle between the two conventions has
// the tangent u v / (f sqrt(f^2 + u^2 + v^2)): in the corner of a square field of 22.6 degrees 2.2 degrees, which
// is what a picture of another program was off by. By hand: u = v = f/5, 0.04/sqrt(1.08) = 0.0385.
TEST(ScannersPublished, KeepingTheVerticalTurnsTheCornersBy2Point2Degrees) {
  SensorGeometry g;
  g.width = g.height = 2, g.principal_x = g.principal_y = 1;
  g.focal_length_px = 0.5 * 5;  // the centre of the corner pixel is at u = v = f/5
  const Sensor sensor(g, oneBand(), oneBand());
  const Pose pose = Pose::looking({0, 0, 15}, {0.3, 0.2, -1}, {0, 1, 0});
  const Radiometry::Ray ray = sensor.ray(1, 0, 0, Platform::fixed(pose), 0, 1);
  const CDVector k = -ray.direction;
  const CDVector s = normalized(ray.horizontal - k * dot(ray.horizontal, k));
  const CDVector upright = normalized(pose.up - k * dot(pose.up, k)), other = cross(upright, k);
  const double turned = std::acos(dot(s, other));
  EXPECT_NEAR(2 * std::atan(0.2) / degree, 22.6, 0.05) << "the field, printed with one digit";
  EXPECT_NEAR(turned / degree, 2.2, 0.05) << "printed with one digit";
  EXPECT_NEAR(std::tan(turned), 0.04 / std::sqrt(1.08), 1e-12);
}
