// Normals that are not the surface's: of corners (vn) and of bumps (nw/render/MappedHits.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "Worlds.hpp"
#include "malus/render/MappedHits.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

// A ball of radius 1, with the ball's own normals at its corners.
World ball(std::uint32_t rows, const Model& model, bool smooth,
           std::shared_ptr<const Sky> sky = nullptr) {
  const std::uint32_t columns = 2 * rows;
  Mesh mesh;
  mesh.facets = mesh.materials = {"ball"};
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j)
      mesh.vertices.push_back(CDVector::fromAngles(pi * i / rows, 2 * pi * j / columns));
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({a, b, c, 0, 0});
    mesh.normals.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  };
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t next = (j + 1) % columns, up = i * columns, down = up + columns;
      if (i > 0) add(up + j, down + j, up + next);
      if (i + 1 < rows) add(up + next, down + j, down + next);
    }
  GeometryBuilder builder;
  builder.addMesh(mesh, {}, "", {}, smooth);
  World world;
  world.grid = oneBand();
  world.geometry = std::move(builder).build();
  world.materials = {{"ball", model}};
  world.sky = sky ? std::move(sky) : blackSky(oneBand());
  return world;
}

double seenAt(const Radiometry& radiometry, const CDVector& eye, const CDVector& direction,
              std::uint64_t pixel = 0) {
  const Radiometry::Ray ray{eye, direction, {1, 0, 0}, pixel, 0, 0};
  std::array<double, 4> out{};
  radiometry.radiance({&ray, 1}, out);
  return out[0];
}
// Whether a viewer in this direction would see another normal, as at the rim.
bool moved(const World& world, Hit hit, const CDVector& to_viewer, const CDVector& normal) {
  return (finishHit(world, to_viewer, hit.point, 0.5, hit).normal - normal).getLength() > 1e-9;
}

// The root mean square of the difference from a round, matt ball in the sun, over a lattice of
// parallel rays that meet it where the sun is more than 20 degrees high.
double roughness(std::uint32_t rows, bool smooth) {
  World world = ball(rows, matt(1), smooth);
  const CDVector to_sun = normalized(CDVector{0.3, -1, 0.4});
  world.sun.emplace(Sun{to_sun, spectrumOf(pi), 0});
  RadiometryOptions options;
  options.rays = {1};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  double squares = 0;
  int count = 0;
  for (double x = -0.8; x <= 0.8; x += 0.0371)
    for (double z = -0.8; z <= 0.8; z += 0.0371) {
      if (x * x + z * z > 0.64) continue;
      const CDVector point{x, -std::sqrt(1 - x * x - z * z), z};
      const double wanted = dot(point, to_sun);
      if (wanted < std::sin(20 * pi / 180)) continue;
      const double seen = seenAt(radiometry, {x, -5, z}, {0, 1, 0});
      squares += (seen - wanted) * (seen - wanted), ++count;
    }
  return std::sqrt(squares / count);
}
}  // namespace

// Flat triangles are off by their tilt, smooth ones by its square.
TEST(SmoothNormalsInvariant, ABallLooksRound) {
  const double flat = roughness(20, false), smooth = roughness(20, true);
  EXPECT_GT(flat, 0.02) << "the control";
  EXPECT_LT(smooth, flat / 10);
  EXPECT_LT(roughness(40, true), smooth / 3) << "of second order: a quarter";
  EXPECT_GT(roughness(40, false), flat / 3) << "of first order";
}

// Under a sky of one radiance a white ball looks like the sky. Smooth normals lose what leaks and add nothing.
TEST(SmoothNormalsInvariant, NoLightIsMade) {
  for (const Model& model : {matt(1), facets(0.4, 2.9, 0.05)}) {
    const World world = ball(10, model, true, uniformSky(1));
    RadiometryOptions options;
    options.rays = {257};
    const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
    double mean = 0, most = 0;
    int count = 0;
    for (double x = -0.97; x < 1; x += 0.1)
      for (double z = -0.97; z < 1; z += 0.1) {
        if (x * x + z * z > 0.97 * 0.97) continue;
        const double seen = seenAt(radiometry, {x, -5, z}, {0, 1, 0}, std::uint64_t(count));
        mean += seen, most = std::max(most, seen), ++count;
      }
    EXPECT_LT(most, 1 + 1e-3);
    // a white surface, and a metal that reflects 0.85 of perpendicular light
    EXPECT_GT(mean / count, model->name() == matt(1)->name() ? 0.9 : 0.7);
  }
}

// The sun behind a ball: what looks at us is dark, to the rim.
TEST(SmoothNormalsIdentity, NoLightLeaksThroughTheBody) {
  for (const bool sharp : {false, true}) {
    World world = ball(8, sharp ? facets(0.4, 2.9, 0.3) : matt(1), true);
    world.sun.emplace(Sun{normalized(CDVector{0.02, 1, 0.1}), spectrumOf(pi), 0});
    const auto tracer = std::make_shared<RayTracer>(world.geometry);
    const Radiometry radiometry(world, tracer, {});
    for (double x = -0.99; x < 1; x += 0.06)
      for (double z = -0.99; z < 1; z += 0.06) {
        const Hit hit = tracer->intersect({x, -5, z}, {0, 1, 0});
        if (!hit || dot(hit.normal, world.sun->to_sun) > 0) continue;
        EXPECT_EQ(seenAt(radiometry, {x, -5, z}, {0, 1, 0}), 0) << x << ' ' << z;
      }
  }
}

// For any given normal, the viewer is above it, and the mirror direction above the triangle.
TEST(SmoothNormalsInvariant, TheNormalIsSeenAndItsMirrorDirectionIsOutside) {
  const World world = ball(5, matt(1), true);
  const RayTracer tracer(world.geometry);
  int moved = 0;
  for (double x = -0.99; x < 1; x += 0.03)
    for (double z = -0.99; z < 1; z += 0.03) {
      Hit hit = tracer.intersect({x, -5, z}, {0, 1, 0});
      if (!hit) continue;
      const CDVector to_viewer{0, -1, 0};
      const MappedHit said = finishHit(world, to_viewer, hit.point, 0.5, hit);
      ASSERT_TRUE(said.bent);
      EXPECT_NEAR(said.normal.getLength(), 1, 1e-12);
      EXPECT_GT(dot(said.normal, to_viewer), 0);
      const CDVector mirror = said.normal * (2 * dot(said.normal, to_viewer)) - to_viewer;
      EXPECT_GE(dot(mirror, hit.normal), 0.49 * dot(to_viewer, hit.normal));
      const CDVector round = world.geometry.smoothNormal(hit.triangle, hit.point);
      moved += (said.normal - round).getLength() > 1e-9;
    }
  EXPECT_GT(moved, 10) << "the test has met the rim";
}

// Equation (reciprocity) of the chapter, measured: exchanged directions differ by c(i) / c(o), and by less with smaller triangles.
TEST(SmoothNormalsInvariant, ReciprocityIsBrokenByTheTiltOnly) {
  double before = 1;
  for (const std::uint32_t rows : {10u, 20u, 40u}) {
    World world = ball(rows, matt(1), true);
    const auto tracer = std::make_shared<RayTracer>(world.geometry);
    const CDVector one = normalized(CDVector{0.5, -1, 0.3}),
                   two = normalized(CDVector{-0.6, -1, 0});
    const auto there = [&](const CDVector& to_sun, const CDVector& to_eye, const CDVector& at,
                           CDVector& flat) {
      world.sun.emplace(Sun{to_sun, spectrumOf(pi), 0});
      RadiometryOptions options;
      options.rays = {1};
      flat = tracer->intersect(at + to_eye * 5, -to_eye).normal;
      return seenAt(Radiometry(world, tracer, options), at + to_eye * 5, -to_eye) /
             dot(flat, to_sun);
    };
    double worst = 0;
    for (double x = -0.5; x < 0.5; x += 0.043)
      for (double z = -0.5; z < 0.5; z += 0.043) {
        const Hit hit = tracer->intersect({x, -5, z}, {0, 1, 0});
        const CDVector round = world.geometry.smoothNormal(hit.triangle, hit.point);
        if (moved(world, hit, one, round) || moved(world, hit, two, round)) continue;
        CDVector flat, other;
        const double a = there(one, two, hit.point, flat),
                     b = there(two, one, hit.point, other);
        if ((flat - other).getLength() > 1e-9 || dot(flat, one) < 0.3 || dot(flat, two) < 0.3)
          continue;
        const double c1 = dot(round, one) / dot(flat, one),
                     c2 = dot(round, two) / dot(flat, two);
        EXPECT_NEAR(a / b, c1 / c2, 1e-6);
        worst = std::max(worst, std::abs(a / b - 1));
      }
    EXPECT_GT(worst, 0.01) << "it is broken";
    EXPECT_LT(worst, 0.7 * before) << rows;
    before = worst;
  }
}

// By hand in the chapter: a metre in ten. The map shades the plane as a ramp of that slope.
TEST(BumpsIdentity, ARampOfHeights) {
  // heights 0, 1, 2, 3 over 4 x 10 m, read in the middle of the second pixel and beside it
  const MapPlacement over{MapPlacement::By::ground, 0, 0, 40, 40, false};
  const auto map = std::make_shared<const SurfaceMap>(
      SurfaceMap::ofHeights({"ramp", 4, 1, 1, {0, 1 / 3.0f, 2 / 3.0f, 1}, 255}, over, 1, 0, 3));
  World world;
  world.grid = oneBand();
  GeometryBuilder builder;
  builder.addGround(0, "bumps", "ground");
  builder.material("matt");
  world.geometry = std::move(builder).build();
  world.materials = {{"bumps", nullptr, nullptr, nullptr, map}, {"matt", matt(1)}};
  world.sky = blackSky(oneBand());
  world.sun.emplace(Sun{normalized(CDVector{-1, 0, 1}), spectrumOf(pi), 0});
  Hit hit;
  hit.facet = 0, hit.material = 0, hit.point = {20, 5, 0}, hit.normal = {0, 0, 1};
  const MappedHit said = finishHit(world, {0, 0, 1}, hit.point, 0.5, hit);
  const CDVector ramp = normalized(CDVector{-0.1, 0, 1});
  EXPECT_NEAR((said.normal - ramp).getLength(), 0, 1e-7);
  EXPECT_EQ(hit.material, 1u);
  RadiometryOptions options;
  options.rays = {1};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  EXPECT_NEAR(seenAt(radiometry, {20, 5, 9}, {0, 0, -1}), dot(ramp, world.sun->to_sun), 1e-6);
}

// The same heights by texture coordinates, on a wall whose texture is turned by a quarter, from both sides.
TEST(BumpsIdentity, HeightsByTextureCoordinates) {
  const auto map = std::make_shared<const SurfaceMap>(
      SurfaceMap::ofHeights({"ramp", 4, 1, 1, {0, 1 / 3.0f, 2 / 3.0f, 1}, 255},
                            {MapPlacement::By::texture, 0, 0, 1, 1, false}, 1, 0, 3));
  Mesh mesh;  // x = 0, seen from +x; u rises with z, 40 m for the image
  mesh.vertices = {{0, 0, 0}, {0, 40, 0}, {0, 0, 40}};
  mesh.facets = {"wall"}, mesh.materials = {"bumps"};
  mesh.triangles = {{0, 1, 2, 0, 0}};
  mesh.texture = {{TexturePoint{0, 0}, TexturePoint{0, 1}, TexturePoint{1, 0}}};
  GeometryBuilder builder;
  builder.keepTexture();
  builder.addMesh(mesh, {});
  builder.material("matt");
  World world;
  world.grid = oneBand();
  world.geometry = std::move(builder).build();
  world.materials = {{"bumps", nullptr, nullptr, nullptr, map}, {"matt", matt(1)}};
  const RayTracer tracer(world.geometry);
  for (const double side : {1.0, -1.0}) {
    Hit hit = tracer.intersect({side * 5, 10, 20}, {-side, 0, 0});
    ASSERT_TRUE(hit);
    const MappedHit said = finishHit(world, {side, 0, 0}, hit.point, 0.5, hit);
    EXPECT_NEAR((said.normal - normalized(CDVector{1, 0, -0.1}) * side).getLength(), 0, 1e-7);
  }
}
