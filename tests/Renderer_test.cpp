// Frames of a scene that is made by hand, in memory (nw/render/Renderer.nw), and their tiles (nw/render/Tile.nw).
#include "malus/render/Renderer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "malus/render/Scene.hpp"
#include "malus/render/Tile.hpp"
#include "malus/surface/BRDFDiffuse.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
constexpr std::size_t width = 20, height = 18,
                      quarters = 4;  // more than a tile in each direction
constexpr double rounding = 1e-12;   // a few dozen operations of 1e-16 each
const SpectralGridPtr two_bands =
    SpectralGrid::make({CDSpectralLocation(500.0), CDSpectralLocation(600.0)});

double reflectance(std::size_t quarter, std::size_t band) {
  return 0.1 + 0.2 * double(quarter) + 0.05 * double(band);
}

CDSpectralVector<double> spectrum(double first, double second) {
  CDSpectralVector<double> v(two_bands, first);
  v[1] = second;
  return v;
}

/// A square metre for each pixel; the quarters of the ground have different paints and are lit
/// from the zenith.
Scene fourQuarters(std::size_t samples = 1) {
  World world;
  world.grid = two_bands;
  GeometryBuilder builder;
  for (std::size_t q = 0; q < quarters; ++q) {
    const double x = q % 2 ? 0 : -10, y = q < 2 ? 0 : -9;  // the upper left one first
    Mesh mesh;
    mesh.vertices = {{x, y, 0}, {x + 10, y, 0}, {x + 10, y + 9, 0}, {x, y + 9, 0}};
    mesh.facets = mesh.materials = {std::to_string(q)};
    mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
    builder.addMesh(mesh, {});
    world.materials.push_back({std::to_string(q), std::make_shared<BRDFDiffuse>(spectrum(
                                                      reflectance(q, 0), reflectance(q, 1)))});
  }
  world.geometry = std::move(builder).build();
  world.sky = blackSky(two_bands);
  world.sun.emplace(
      Sun{{0, 0, 1}, CDSpectralVector<CDStokesVector>(two_bands, CDStokesVector(pi)), 0});
  SensorGeometry view;
  view.width = width, view.height = height, view.samples = samples;
  view.focal_length_px = 100, view.principal_x = width / 2.0, view.principal_y = height / 2.0;
  RadiometryOptions options;
  options.rays = {1};
  const auto tracer = std::make_shared<const RayTracer>(world.geometry);
  const Pose above = Pose::looking({0, 0, 100}, {0, 0, -1}, {0, 1, 0});
  return {"",
          "",
          std::move(world),
          Sensor(view, two_bands, two_bands),
          Platform::fixed(above, 2, 10),
          options,
          tracer,
          {},
          {},
          {},
          {},
          {},
          {}};
}

std::size_t quarterAt(std::size_t x, std::size_t y) {
  return (x >= width / 2) + 2 * (y >= height / 2);
}
}  // namespace

// By hand in the chapter: six tiles of the part from (10, 6) to (44, 30).
TEST(TileIdentity, TheSixTilesOfTheChapter) {
  const std::vector<Tile> six{{10, 6, 16, 16},  {16, 6, 32, 16},  {32, 6, 44, 16},
                              {10, 16, 16, 30}, {16, 16, 32, 30}, {32, 16, 44, 30}};
  EXPECT_EQ(tilesOf({10, 6, 44, 30}), six);
  EXPECT_EQ(tilesOf({0, 0, 16, 32}).size(), 2u) << "a part that ends on the lattice";
  EXPECT_TRUE(tilesOf({5, 5, 5, 9}).empty());
}

TEST(TileInvariant, WorkEndsWhenATileSaysSo) {
  const std::vector<Tile> tiles = tilesOf({0, 0, 160, 16});
  std::atomic<int> worked = 0;
  EXPECT_TRUE(eachTile(tiles, 1, [&](const Tile&) { return ++worked, true; }));
  EXPECT_EQ(worked, 10);
  worked = 0;
  EXPECT_FALSE(eachTile(tiles, 1, [&](const Tile&) { return ++worked < 3; }));
  EXPECT_EQ(worked, 3);
}

// A matt surface under a sun of irradiance pi in the zenith has its reflectance as radiance.
TEST(RendererIdentity, EachPixelIsThePaintBelowIt) {
  for (const std::size_t samples : {1u, 4u}) {
    const Scene scene = fourQuarters(samples);
    const RenderedImage frame = renderScene(scene);
    ASSERT_EQ(frame.stokes.size(), width * height * 2 * 4);
    const std::vector<std::string>& names = scene.world.geometry.materialNames();
    std::uint64_t rays = 0;
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t q = quarterAt(x, y);
        for (std::size_t band = 0; band < 2; ++band) {
          const double* s = frame.at(x, y, band);
          EXPECT_NEAR(s[0], reflectance(q, band), rounding) << x << ' ' << y << ' ' << band;
          EXPECT_EQ(std::abs(s[1]) + std::abs(s[2]) + std::abs(s[3]), 0);
        }
        const Radiometry::Truth& truth = frame.truth[y * width + x];
        EXPECT_EQ(names.at(truth.material), std::to_string(q));
        EXPECT_EQ(truth.rays % samples, 0u) << "each sample follows as many";
        EXPECT_GT(truth.rays, 0u);
        rays += truth.rays;
      }
    EXPECT_EQ(frame.rays, rays);
  }
}

TEST(RendererInvariant, SamplesFollowTheirOwnRays) {
  const RenderedImage one = renderScene(fourQuarters(1)), four = renderScene(fourQuarters(4));
  EXPECT_EQ(four.rays, 4 * one.rays);
}

TEST(RendererInvariant, APartIsThePixelsOfTheWhole) {
  const Scene scene = fourQuarters();
  const RenderedImage whole = renderScene(scene);
  RenderOptions options;
  options.tile = Tile{7, 3, 19, 17};
  const RenderedImage part = renderScene(scene, 0, options);
  ASSERT_EQ(part.width, 12u);
  ASSERT_EQ(part.height, 14u);
  for (std::size_t y = 0; y < part.height; ++y)
    for (std::size_t x = 0; x < part.width; ++x)
      for (std::size_t i = 0; i < 8; ++i)
        EXPECT_EQ(part.at(x, y)[i], whole.at(x + 7, y + 3)[i]) << x << ' ' << y << ' ' << i;
  EXPECT_NE(part.at(0, 0)[0], whole.at(width - 1, 0)[0]);  // negative control: another quarter
}

TEST(RendererInvariant, EachFrameHasItsOwnSun) {
  Scene scene = fourQuarters();
  scene.move_sun = [](World& world, double time_s) {
    world.sun->irradiance[0] = CDStokesVector(pi * time_s);
  };
  const RenderedImage first = renderScene(scene, 0), second = renderScene(scene, 1);
  EXPECT_NEAR(first.at(0, 0)[0], reflectance(0, 0), rounding);
  EXPECT_NEAR(second.at(0, 0)[0], 10 * reflectance(0, 0), 10 * rounding);
  EXPECT_NEAR(second.at(0, 0, 1)[0], reflectance(0, 1), rounding);
  EXPECT_THROW(renderScene(scene, 2), std::out_of_range);
}

TEST(RendererInvariant, AStoppedRenderingBeginsNoTile) {
  const Scene scene = fourQuarters();
  const std::atomic<bool> stop = true;
  RenderOptions options;
  options.stop = &stop;
  int sunk = 0;
  EXPECT_FALSE(renderTiles(Renderer(scene, 0), scene, tilesOf({0, 0, width, height}), options,
                           [&](const Tile&, auto, auto) { ++sunk; }));
  EXPECT_EQ(sunk, 0);
  EXPECT_EQ(renderScene(scene, 0, options).rays, 0u);
}
