// Terrain from height maps (nw/files/Terrain.nw).
#include "malus/files/Terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/render/RayTracer.hpp"

using namespace malus;

namespace {
/// A GeoTIFF of floats, written byte by byte (TIFF 6.0, GeoTIFF 1.0): pixels of 10 m, the north-west corner at 500000, 4800000.
struct TIFF {
  std::uint16_t width = 5, height = 4, model = 1, system = 32618;  // 1: projected, UTM 18 N
  bool placed = true;
  std::vector<float> heights;

  std::string bytes() const {
    struct Entry {
      std::uint16_t tag, type;
      std::uint32_t count;
      std::string value;
    };
    const auto shorts = [](std::initializer_list<std::uint16_t> all) {
      return std::string(reinterpret_cast<const char*>(all.begin()), 2 * all.size());
    };
    const auto longs = [](std::uint32_t one) {
      return std::string(reinterpret_cast<const char*>(&one), 4);
    };
    const auto doubles = [](std::initializer_list<double> all) {
      return std::string(reinterpret_cast<const char*>(all.begin()), 8 * all.size());
    };
    const std::uint16_t key = model == 1 ? 3072 : 2048;
    std::vector<Entry> entries{{256, 3, 1, shorts({width, 0})},
                               {257, 3, 1, shorts({height, 0})},
                               {258, 3, 1, shorts({32, 0})},
                               {259, 3, 1, shorts({1, 0})},
                               {262, 3, 1, shorts({1, 0})},
                               {273, 4, 1, longs(8)},
                               {277, 3, 1, shorts({1, 0})},
                               {278, 3, 1, shorts({height, 0})},
                               {279, 4, 1, longs(4u * width * height)},
                               {339, 3, 1, shorts({3, 0})}};
    const auto add = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t count,
                         const std::string& value) {
      Entry& entry = entries.emplace_back();
      entry.tag = tag, entry.type = type, entry.count = count, entry.value = value;
    };
    if (placed) {
      add(33550, 12, 3, doubles({10, 10, 0}));
      add(33922, 12, 6, doubles({0, 0, 0, 500000, 4800000, 0}));
      add(34735, 3, 16,
          shorts({1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1, key, 0, 1, system}));
    }
    add(42113, 2, 6, std::string("-9999", 6));
    const auto data = static_cast<std::uint32_t>(4 * heights.size());
    const std::uint32_t directory = 8 + data;
    auto extra = static_cast<std::uint32_t>(directory + 2 + 12 * entries.size() + 4);
    std::string text = "II" + shorts({42}) + longs(directory);
    text.append(reinterpret_cast<const char*>(heights.data()), data);
    text += shorts({static_cast<std::uint16_t>(entries.size())});
    std::string values;
    for (const Entry& entry : entries) {
      text += shorts({entry.tag, entry.type}) + longs(entry.count);
      if (entry.value.size() <= 4) {
        text += entry.value;
      } else {
        text += longs(extra);
        values += entry.value, extra += static_cast<std::uint32_t>(entry.value.size());
      }
    }
    return text + longs(0) + values;
  }
};

/// A slope of 0.2 to the east and -0.1 to the north: h = 100 + 0.2 (x - 500000) - 0.1 (y - 4800000).
TIFF slope() {
  TIFF tiff;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 5; ++c)
      tiff.heights.push_back(float(100 + 0.2 * (10 * c + 5) + 0.1 * (10 * r + 5)));
  return tiff;
}

HeightMap read(const TIFF& tiff) {
  const Scratch scratch;
  put(scratch / "h.tif", tiff.bytes());
  return readHeightMap(scratch / "h.tif", 1);
}

std::string complaint(const std::string& bytes, int band = 1) {
  const Scratch scratch;
  put(scratch / "h.tif", bytes);
  try {
    readHeightMap(scratch / "h.tif", band);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

SceneGeometry built(const Mesh& mesh) {
  GeometryBuilder builder;
  builder.addMesh(mesh, Transform());
  return std::move(builder).build();
}
}  // namespace

TEST(TerrainIdentity, ASlopeIsWhereItsEquationSays) {
  const HeightMap map = read(slope());
  EXPECT_EQ(map.width, 5u);
  EXPECT_EQ(map.height, 4u);
  EXPECT_EQ(map.to_map[0], 500000);
  EXPECT_EQ(map.to_map[5], -10);
  const CDVector anchor{500000, 4799900, 90};
  const SceneGeometry terrain = built(terrainOf(map, anchor, 1));
  EXPECT_EQ(terrain.triangles().size(), 2u * 4 * 3);
  // by hand: the post of column 2 and row 1 is 25 m east and 15 m south of the corner, at 100 + 5 + 1.5 m
  EXPECT_NEAR((terrain.vertices()[7] - CDVector{25, 85, 16.5}).getLength(), 0, 1e-5);
  const RayTracer tracer(terrain);
  for (const double x : {6.0, 17.3, 44.0})
    for (const double y : {66.0, 78.2, 94.0}) {
      const Hit hit = tracer.intersect({x, y, 500}, {0, 0, -1});
      ASSERT_TRUE(hit) << x << ' ' << y;
      EXPECT_NEAR(hit.point.z, 10 + 0.2 * x - 0.1 * (y - 100), 1e-4);
      EXPECT_GT(terrain.placed(hit.triangle).normal().z, 0.9);
    }
  EXPECT_FALSE(tracer.intersect({4, 80, 500}, {0, 0, -1})) << "beyond the middle of a pixel";
  // every second post: three by two, the same plane
  EXPECT_EQ(built(terrainOf(map, anchor, 2)).triangles().size(), 4u);
  EXPECT_THROW(terrainOf(map, anchor, 4), MathError);
}

TEST(TerrainIdentity, APostWithoutHeightLeavesAHole) {
  TIFF tiff = slope();
  tiff.heights[6] = -9999;
  const HeightMap map = read(tiff);
  EXPECT_FALSE(std::isfinite(map.heights_m[6]));
  // six triangles meet at a post
  EXPECT_EQ(terrainOf(map, {}, 1).triangles.size(), 24u - 6);
  tiff.heights[6] = -9998;  // negative control
  EXPECT_EQ(terrainOf(read(tiff), {}, 1).triangles.size(), 24u);
}

TEST(TerrainIdentity, RastersThatAreNoMapInMetresAreRefused) {
  const auto says = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_NE(said.find("h.tif"), std::string::npos) << said;
  };
  const std::string good = slope().bytes();
  EXPECT_EQ(complaint(good), "none");
  says(complaint(good, 2), "band 2 is requested");
  TIFF degrees = slope();
  degrees.model = 2, degrees.system = 4326;
  says(complaint(degrees.bytes()), "in degrees; project it: gdalwarp");
  TIFF lost = slope();
  lost.placed = false;
  says(complaint(lost.bytes()), "no map coordinates");
  says(complaint(good.substr(0, 60)), "cannot be read as a height map");
  says(complaint("heights"), "cannot be read as a height map");
  EXPECT_THROW(readHeightMap("missing.tif", 1), InputError);
}
