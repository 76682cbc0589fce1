// Images over surfaces, looked up and drawn from (nw/scene/SurfaceMap.nw), and the texture coordinates of meshes
// (nw/scene/SceneGeometry.nw).
#include "malus/scene/SurfaceMap.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "Scratch.hpp"
#include "malus/base/Refusal.hpp"

using namespace malus;

namespace {
// 3 x 2 pixels: 10 11 12 above 20 21 22
MapImage sixPixels() { return {"six.png", 3, 2, 1, {10, 11, 12, 20, 21, 22}, 1}; }
SurfaceMap indices(const MapPlacement& placement = {}) {
  std::map<long, std::uint32_t> named;
  for (const long index : {10, 11, 12, 20, 21, 22}) named[index] = std::uint32_t(100 + index);
  return SurfaceMap::ofIndices(sixPixels(), placement, named);
}
std::uint32_t at(const SurfaceMap& map, double u, double v) {
  double choice = 0.5;
  return map.material({u, v}, choice);
}
std::string refusal(const std::function<void()>& make) {
  try {
    make();
  } catch (const Refusal& error) {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(SurfaceMapIdentity, EachPixelCoversItsRectangle) {
  const SurfaceMap map = indices();
  const double inside = 1e-9;
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const std::uint32_t wanted = std::uint32_t(110 + 10 * row + column);
      const double left = double(column) / 3, top = 1 - double(row) / 2;
      for (const double u : {left + inside, left + 1 / 6.0, left + 1 / 3.0 - inside})
        for (const double v : {top - inside, top - 0.25, top - 0.5 + inside})
          EXPECT_EQ(at(map, u, v), wanted) << u << ' ' << v;
    }
}

TEST(SurfaceMapIdentity, BeyondItRepeatsOrKeepsItsEdge) {
  const SurfaceMap repeats = indices();
  for (const double u : {0.1, 0.5, 0.9})
    for (const double v : {0.2, 0.8})
      for (const double far : {-7.0, -1.0, 1.0, 1000.0})
        EXPECT_EQ(at(repeats, u + far, v - far), at(repeats, u, v));
  EXPECT_EQ(at(repeats, -1e-30, 0.9), 112u) << "rounds to one, which is no pixel";
  EXPECT_EQ(at(repeats, 0.1, -1e-30), 110u);
  MapPlacement edge;
  edge.repeats = false;
  EXPECT_EQ(at(indices(edge), 5, 5), 112u);
  EXPECT_EQ(at(indices(edge), -5, 0.2), 120u);
  EXPECT_EQ(at(indices(edge), 0.5, -3), 121u);
}

TEST(SurfaceMapIdentity, TheGroundBelowAPoint) {
  const MapPlacement over{MapPlacement::By::ground, 100, 200, 130, 220, true};
  const TexturePoint place = over.below({107.5, 215, 63});
  EXPECT_DOUBLE_EQ(place.u, 0.25);
  EXPECT_DOUBLE_EQ(place.v, 0.75);
}

// Every share as often as it should be; and what is left of the number is even again, or a second map would be biased.
TEST(SurfaceMapInvariant, DrawsByShares) {
  const SurfaceMap map({"mix.png", 1, 1, 3, {0.5f, 0.2f, 0.3f}, 255}, {}, MapKind::mixture,
                       {7, 8, 9});
  constexpr int draws = 10000;
  std::map<std::uint32_t, int> times;
  double sum = 0, squares = 0, control = 0;
  for (int i = 0; i < draws; ++i) {
    double choice = (i + 0.5) / draws;
    const double before = choice;
    const std::uint32_t material = map.material({0.3, 0.3}, choice);
    ++times[material];
    ASSERT_GE(choice, 0);
    ASSERT_LT(choice, 1);
    if (material != 9) continue;
    sum += choice, squares += choice * choice, control += before;
  }
  // even numbers: a share is met to one draw at each of its ends
  EXPECT_NEAR(times[7], 5000, 2);
  EXPECT_NEAR(times[8], 2000, 2);
  EXPECT_NEAR(times[9], 3000, 2);
  EXPECT_NEAR(sum / times[9], 0.5, 1e-3);
  EXPECT_NEAR(squares / times[9], 1 / 3.0, 1e-3);
  EXPECT_GT(control / times[9], 0.8) << "the number as it was is not even within its share";
}

TEST(SurfaceMapInvariant, AScaleIsDrawnBetweenItsSteps) {
  const SurfaceMap map({"scale.png", 2, 1, 1, {0, 1}, 255}, {}, MapKind::scale, {1, 2, 3});
  constexpr int draws = 10000;
  for (const double u : {0.25, 0.3, 0.5, 0.65, 0.75}) {
    double mean = 0;
    for (int i = 0; i < draws; ++i) {
      double choice = (i + 0.5) / draws;
      mean += map.material({u, 0.5}, choice) / double(draws);
    }
    // between the middles of the pixels, at 0.25 and 0.75, the value rises evenly, and with it the mean of the numbers
    EXPECT_NEAR(mean, 1 + 2 * (u - 0.25) / 0.5, 2e-4) << u;
  }
  double choice = 0.5;
  EXPECT_EQ(map.material({0, 0.5}, choice), 2u) << "half way between the last and the first";
}

TEST(SurfaceMapIdentity, RefusesWhatIsNoMap) {
  const std::map<long, std::uint32_t> ten{{10, 0}, {11, 1}, {12, 2}, {20, 3}, {21, 4}};
  EXPECT_EQ(refusal([&] { SurfaceMap::ofIndices(sixPixels(), {}, ten); }),
            "six.png: column 2, row 1 has the index 22, which names no material");
  EXPECT_EQ(refusal([&] {
              SurfaceMap({"a.png", 1, 2, 2, {0.5f, 0.5f, 0.1f, 0.5f}, 1}, {}, MapKind::mixture,
                         {0, 1});
            }),
            "a.png: the pixel in column 0, row 1 has shares that add up to 0.600");
  EXPECT_EQ(refusal([&] {
              SurfaceMap({"a.png", 2, 1, 1, {0.5f, 1.5f}, 1}, {}, MapKind::scale, {0, 1});
            }),
            "a.png: the pixel in column 1, row 0 has the value 1.5, and 0 to 1 are allowed");
  EXPECT_EQ(refusal([&] {
              SurfaceMap({"a.png", 1, 1, 3, {0, 0, 0}, 1}, {}, MapKind::scale, {0, 1});
            }),
            "a.png has 1 x 1 pixels of 3 channels, and the map needs 1");
  EXPECT_EQ(refusal([&] {
              SurfaceMap({"a.png", 0, 0, 1, {}, 1}, {}, MapKind::scale, {0, 1});
            }),
            "a.png has no pixels");
  EXPECT_EQ(refusal([&] {
              SurfaceMap({"a.png", 1, 1, 1, {0}, 1}, {MapPlacement::By::ground, 1, 0, 1, 2},
                         MapKind::scale, {0, 1});
            }),
            "the rectangle of a map has no area");
}

// A quadrilateral whose texture is turned by a quarter, and one without.
TEST(SceneGeometryIdentity, TextureCoordinatesStayWithTheirCorners) {
  const Scratch scratch;
  put(scratch / "t.obj",
      "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0 0\n"
      "f 1 2 3 4\nf 1/1 2/2 3/3 4/4\nf 1/-4 2/-3 3/-2\nf 1/1 2/9 3/3\n");
  const Mesh mesh = readOBJ(scratch / "t.obj");
  ASSERT_EQ(mesh.texture.size(), mesh.triangles.size());
  GeometryBuilder plain;
  plain.addMesh(mesh, {});
  EXPECT_FALSE(std::move(plain).build().texture(2, {1, 1, 0}).given()) << "not asked for";
  for (const bool mirrored : {false, true}) {
    GeometryBuilder builder;
    builder.keepTexture();
    Transform place = Transform::translate({10, 0, 0});
    if (mirrored) place = Transform{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {10, 0, 0}};
    builder.addMesh(mesh, place);
    const SceneGeometry geometry = std::move(builder).build();
    EXPECT_FALSE(geometry.texture(0, {11, 1, 0}).given());
    for (const std::uint32_t triangle : {2u, 3u, 4u})
      for (const double x : {0.1, 0.7, 1.5})
        for (const double y : {0.2, 1.1}) {
          const CDVector point{10 + x, mirrored ? -y : y, 0};
          // corner (x, y) -> (u, v): u = 1 - y/2, v = x/2; an affine function holds outside as well
          EXPECT_NEAR(geometry.texture(triangle, point).u, 1 - y / 2, 1e-14);
          EXPECT_NEAR(geometry.texture(triangle, point).v, x / 2, 1e-14);
        }
    EXPECT_FALSE(geometry.texture(5, {10.2, 0.1, 0}).given()) << "one corner names no vt";
  }
}

// By hand: values 0 and 1 in two pixels, factors 0.5 and 1.5, and a second channel that is twice the first.
TEST(SurfaceMapIdentity, FactorsBetweenPixelsAndChannels) {
  const MapImage image{"f.exr", 2, 1, 2, {0, 0, 0.5f, 1}, 1};
  const MapFactors three{0.5, 1.5, {{0, 0}, {0, 0.25}, {1, 0}}};
  const SurfaceMap map = SurfaceMap::ofFactors(image, {}, 7, three);
  std::array<double, 3> bands{};
  map.factors({0.75, 0.5}, bands);
  EXPECT_DOUBLE_EQ(bands[0], 1.0);
  EXPECT_DOUBLE_EQ(bands[1], 1.125);
  EXPECT_DOUBLE_EQ(bands[2], 1.5);
  map.factors({0.5, 0.5}, bands);
  EXPECT_DOUBLE_EQ(bands[0], 0.75) << "half way between the pixels";
  EXPECT_DOUBLE_EQ(map.largestFactor(), 1.5);
  double choice = 0.3;
  EXPECT_EQ(map.material({0.1, 0.1}, choice), 7u);
  EXPECT_EQ(choice, 0.3);
  EXPECT_EQ(refusal([&] {
              SurfaceMap::ofFactors(image, {}, 7, {-0.5, 1, {{0, 0}}});
            }),
            "f.exr makes the factor -0.5, and a reflectance is not negative");
  EXPECT_EQ(refusal([&] {
              SurfaceMap::ofFactors(image, {}, 7, {0, 1, {{1, 0.5}}});
            }),
            "f.exr has 2 channels, too few for the factors");
}
