// Which material a ray meets under a map, and the footprint of a pixel (nw/render/MappedHits.nw).
#include "malus/render/MappedHits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "Worlds.hpp"
#include "malus/base/Error.hpp"
#include "malus/render/Sensor.hpp"
#include "malus/surface/Emission.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi, dark = 0.2, bright = 0.8, cell_m = 1;

// A ground without end in squares of a metre; light from the zenith, so that radiance is reflectance.
World checkerboard() {
  World world;
  world.grid = oneBand();
  GeometryBuilder builder;
  builder.addGround(0, "checkers", "ground");
  builder.material("dark"), builder.material("bright");
  world.geometry = std::move(builder).build();
  const MapPlacement over{MapPlacement::By::ground, 0, 0, 2 * cell_m, 2 * cell_m, true};
  const auto map = std::make_shared<const SurfaceMap>(
      SurfaceMap::ofIndices({"checkers", 2, 2, 1, {0, 1, 1, 0}, 1}, over, {{0, 1}, {1, 2}}));
  world.materials = {{"checkers", nullptr, nullptr, nullptr, map},
                     {"dark", matt(dark)},
                     {"bright", matt(bright)}};
  world.sun.emplace(Sun{{0, 0, 1}, spectrumOf(pi), 0});
  world.sky = blackSky(oneBand());
  return world;
}

constexpr std::size_t width = 64, height = 20;
constexpr double eye_m = 9, focal_px = 1000;  // a pixel is a milliradian

// Mean of each row of a picture whose middle is the horizon. `middles`: maps are read by the middle ray of a pixel alone.
std::vector<double> rowMeans(std::size_t samples, bool middles, bool jitter,
                             double* rms = nullptr) {
  const World world = checkerboard();
  RadiometryOptions options;
  options.rays = {1};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  SensorGeometry view;
  view.width = width, view.height = height, view.samples = samples, view.jitter = jitter;
  view.focal_length_px = focal_px, view.principal_x = width / 2.0,
  view.principal_y = height / 2.0;
  const Sensor sensor(view, oneBand(), oneBand());
  const Platform platform =
      Platform::fixed(Pose::looking({0.3, 0.1, eye_m}, {0, 1, 0}, {0, 0, 1}), 1, 1);
  std::vector<double> rows;
  double squares = 0;
  for (std::size_t y = 0; y < height; ++y) {
    double row = 0;
    for (std::size_t x = 0; x < width; ++x) {
      double pixel = 0;
      for (std::size_t sample = 0; sample < samples; ++sample) {
        Radiometry::Ray ray = sensor.ray(x, y, sample, platform, 0, 1);
        if (middles) ray.cell_x = ray.cell_y = {};
        std::array<double, 4> out{};
        radiometry.radiance({&ray, 1}, out);
        pixel += out[0] / double(samples);
      }
      row += pixel / double(width);
      if (y > height / 2) squares += (pixel - 0.5) * (pixel - 0.5);
    }
    rows.push_back(row);
  }
  if (rms) *rms = std::sqrt(squares / double(width * (height / 2 - 1)));
  return rows;
}

constexpr double deviation = (bright - dark) / 2;  // of one ray
constexpr double mean = (bright + dark) / 2;
}  // namespace

// A pixel r rows below the horizon reaches from 9 m / (r + 1) mrad to 9 m / r mrad. In the tenth row that is 90 m: the mean of
// whole squares is off by less than one part in ninety of the deviation, far below the noise that is allowed.
TEST(MappedHitsInvariant, RowsAtTheHorizonHaveTheMeanOfBothColours) {
  for (const bool jitter : {false, true}) {
    double rms = 0;
    const std::vector<double> rows = rowMeans(16, false, jitter, &rms);
    const double allowed = 4 * deviation / std::sqrt(16.0 * width);  // ten rows
    for (std::size_t y = height / 2 + 1; y < height; ++y)
      EXPECT_NEAR(rows[y], mean, allowed) << y << " jitter " << jitter;
    // independent rays leave the deviation over the root of 16; those of a lattice no more
    EXPECT_LT(rms, 1.1 * deviation / 4);
    for (std::size_t y = 0; y < height / 2; ++y) EXPECT_EQ(rows[y], 0) << "the sky";
  }
}

// Four and a half pixels below the horizon, two kilometres away, neighbouring pixels are two metres apart: their middles lie on
// one colour, and a picture of middles shows a line of it.
TEST(MappedHitsInvariant, MiddlesOfPixelsBeatWithThePattern) {
  const std::vector<double> middles = rowMeans(1, true, false),
                            drawn = rowMeans(1, false, false);
  EXPECT_NEAR(std::abs(middles[height / 2 + 4] - mean), deviation, 1e-9);
  EXPECT_NEAR(drawn[height / 2 + 4], mean, 4 * deviation / std::sqrt(double(width)));
}

// Near the camera a pixel is smaller than a square, and shows it sharply.
TEST(MappedHitsIdentity, ASquareShowsItsColour) {
  const World world = checkerboard();
  RadiometryOptions options;
  options.rays = {1};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  for (int x = -3; x < 3; ++x)
    for (int y = -3; y < 3; ++y) {
      const Radiometry::Ray ray{{x + 0.5, y + 0.5, 5}, {0, 0, -1},  {1, 0, 0}, 0, 0, 0,
                                {0.01, 0, 0},          {0, 0.01, 0}};
      std::array<double, 4> out{};
      Radiometry::Truth truth;
      radiometry.radiance({&ray, 1}, out, {&truth, 1});
      // the image's upper row, 0 1, lies over y from 1 to 2
      const bool light = (x + y) % 2 == 0;
      EXPECT_NEAR(out[0], light ? bright : dark, 1e-12) << x << ' ' << y;
      EXPECT_EQ(truth.material, light ? 2u : 1u);
      EXPECT_EQ(truth.facet, 0u);
    }
}

TEST(MappedHitsIdentity, PointsOfAFootprint) {
  Hit hit;
  hit.point = {0, 573, 0}, hit.normal = {0, 0, 1};
  const CDVector eye{0, 0, 10}, direction = normalized(hit.point - eye);
  const CDVector down{0, 0, -0.1 * pi / 180}, across{0.001, 0, 0};
  const auto point = [&](double a, double b) {
    return pointInFootprint(eye, direction, across, down, hit, a, b);
  };
  EXPECT_NEAR((point(0.5, 0.5) - hit.point).getLength(), 0, 1e-9);
  EXPECT_NEAR(point(0.5, 0).y, 603, 1) << "as in the chapter";
  EXPECT_NEAR(point(0.5, 1).y, 546, 1);
  EXPECT_NEAR(point(1, 0.5).x, 0.287, 1e-3);
  // a cell that reaches above the horizon
  const CDVector tall{0, 0, -0.1};
  for (const double b : {0.0, 0.1, 0.3, 0.7, 1.0})
    EXPECT_LT(std::abs(pointInFootprint(eye, direction, across, tall, hit, 0.5, b).y), 1e6);
  EXPECT_EQ(pointInFootprint(eye, direction, across, tall, hit, 0.5, 0.0).y,
            pointInFootprint(eye, direction, across, tall, hit, 0.5, 1.0).y)
      << "what misses the plane is mirrored";
}

TEST(MappedHitsIdentity, MapsOverMaps) {
  World world = checkerboard();
  // an index of two: the checkerboard as it was, and a mixture of both colours
  world.materials.push_back({"all", nullptr, nullptr, nullptr, nullptr});
  world.materials.push_back({"half", nullptr, nullptr, nullptr,
                             std::make_shared<const SurfaceMap>(
                                 MapImage{"half", 1, 1, 2, {0.5f, 0.5f}, 1},
                                 MapPlacement{MapPlacement::By::ground, 0, 0, 1, 1, true},
                                 MapKind::mixture, std::vector<std::uint32_t>{1, 2})});
  world.materials[3].map = std::make_shared<const SurfaceMap>(
      SurfaceMap::ofIndices({"all", 2, 1, 1, {5, 6}, 1},
                            {MapPlacement::By::ground, 0, 0, 20, 20, true}, {{5, 0}, {6, 4}}));
  Hit hit;
  const auto meets = [&](const CDVector& at, double choice) {
    hit.material = 3;
    finishHit(world, {0, 0, 1}, at, choice, hit);
    return hit.material;
  };
  EXPECT_EQ(meets({0.5, 0.5, 0}, 0.1), 2u);
  EXPECT_EQ(meets({1.5, 0.5, 0}, 0.1), 1u);
  EXPECT_EQ(meets({15, 0.5, 0}, 0.1), 1u);
  EXPECT_EQ(meets({15, 0.5, 0}, 0.9), 2u);
  // texture coordinates that are not there
  world.materials[3].map =
      std::make_shared<const SurfaceMap>(MapImage{"t", 1, 1, 1, {0.f}, 1}, MapPlacement{},
                                         MapKind::scale, std::vector<std::uint32_t>{1});
  EXPECT_THROW(meets({0, 0, 0}, 0.5), MathError);
}

namespace {
// A plate of a model under a map of one factor.
World factorPlate(const Model& model, double factor, std::shared_ptr<const Sky> sky) {
  World world = worldOf({floorOf(model)}, std::move(sky));
  MapFactors factors{factor, factor, {{0, 0}}};
  const MapPlacement over{MapPlacement::By::ground, 0, 0, 1, 1, true};
  const auto map = std::make_shared<const SurfaceMap>(
      SurfaceMap::ofFactors({"factor", 1, 1, 1, {0.3f}, 1}, over, 1, factors));
  GeometryBuilder builder;
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.facets = {"plate"}, mesh.materials = {"map"};
  mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
  builder.addMesh(mesh, {});
  builder.material("model");
  world.geometry = std::move(builder).build();
  world.materials = {{"map", nullptr, nullptr, nullptr, map}, {"model", model}};
  return world;
}
std::array<double, 4> seen(const World& world, Sampling sampling) {
  RadiometryOptions options;
  options.sampling = sampling;
  options.rays = sampling == Sampling::twoAndAHalf ? std::vector{33, 1} : std::vector{33, 3};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  const Radiometry::Ray ray{
      {0.3, -2, 1.5}, normalized(CDVector{0, 2, -1.5}), {1, 0, 0}, 5, 0, 0};
  std::array<double, 4> out{};
  radiometry.radiance({&ray, 1}, out);
  return out;
}
}  // namespace

// Whatever is reflected is multiplied, with its polarisation, by every sampling; the random numbers are the same.
TEST(MappedHitsIdentity, AFactorMultipliesAllComponents) {
  const Model glass = facets(1.5, 0, 0.1);
  for (const Sampling sampling : {Sampling::importance, Sampling::gridRotated, Sampling::random,
                                  Sampling::adaptive, Sampling::twoAndAHalf}) {
    const auto lit = [&](double factor) {
      World world = factorPlate(glass, factor, uniformSky(0.1));
      world.sun.emplace(Sun{normalized(CDVector{0.1, 1, 0.8}), spectrumOf(2.0), 0});
      return seen(world, sampling);
    };
    const auto one = lit(1), part = lit(0.3);
    EXPECT_GT(std::abs(one[1]), 0.01 * one[0]) << "polarised";
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(part[c], 0.3 * one[c], 1e-14);
  }
}

// A plate in a room at its temperature cannot be distinguished from the room, whatever the
// factor: Kirchhoff's law. In cold surroundings it can.
TEST(MappedHitsInvariant, AWarmPlateUnderFactorsKeepsKirchhoffsLaw) {
  constexpr double kelvin = 6000, single_precision = 1e-6;  // of the directions' weights
  const double black = planckRadiance(550, kelvin);
  for (const double factor : {0.0, 0.4, 1.0, 1.6}) {
    World world = factorPlate(matt(0.5), factor, uniformSky(black));
    world.materials[1].emission = std::make_shared<Emission>(*world.materials[1].brdf, kelvin);
    EXPECT_NEAR(seen(world, Sampling::importance)[0] / black, 1, single_precision) << factor;
    world.sky = blackSky(oneBand());
    EXPECT_NEAR(seen(world, Sampling::importance)[0] / black, 1 - 0.5 * factor,
                single_precision)
        << factor;
  }
}
