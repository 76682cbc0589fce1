// Meshes of PLY and glTF (nw/files/MeshFiles.nw).
#include "malus/files/MeshFiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 1\n2 0 1\n2 3 1\n0 3 1\n4 0 1 2 3\n";

std::string base64(const std::string& bytes) {
  const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63];
  }
  return text;
}

/// The square of the PLY: in the file's axes (x, z, -y), mirrored in x by a node and shifted back by its parent.
std::string gltf() {
  std::string bytes;
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float f : {0.f, 1.f, 0.f, -2.f, 1.f, 0.f, -2.f, 1.f, -3.f, 0.f, 1.f, -3.f}) put(f);
  for (const int i : {0, 2, 1, 0, 3, 2}) put(static_cast<std::uint16_t>(i));
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"name": "house", "children": [1], "translation": [10, 0, 0]},
           {"name": "roof", "mesh": 0, "scale": [-1, 1, 1], "translation": [-10, 0, 0]}],
 "materials": [{"name": "tiles"}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-2, 1, -3], "max": [0, 1, 0]},
               {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
 "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,)" +
         base64(bytes) + "\"}]}";
}

/// A slope from (0, 0, 0) up to (2, 0, 1), 3 m wide, in the file's axes, by a node that mirrors x and doubles the height, with its
/// normal at each corner; the last corner's leans by `lean`.
std::string slope(float lean) {
  std::string bytes;
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float f : {0.f, 0.f, 0.f, 2.f, 1.f, 0.f, 2.f, 1.f, -3.f, 0.f, 0.f, -3.f}) put(f);
  const float s = 1 / std::sqrt(5.f);
  for (int corner = 0; corner < 4; ++corner)
    for (const float f : {-s, 2 * s, corner == 3 ? lean : 0.f}) put(f);
  for (const int i : {0, 1, 2, 0, 2, 3}) put(static_cast<std::uint16_t>(i));
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"name": "slope", "mesh": 0, "scale": [-1, 2, 1]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, -3], "max": [2, 1, 0]},
               {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
               {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48},
                 {"buffer": 0, "byteOffset": 96, "byteLength": 12}],
 "buffers": [{"byteLength": 108, "uri": "data:application/octet-stream;base64,)" +
         base64(bytes) + "\"}]}";
}

SceneGeometry built(const std::filesystem::path& path) {
  GeometryBuilder builder;
  builder.addMesh(readMesh(path), Transform());
  return std::move(builder).build();
}

std::string complaint(const std::string& name, const std::string& text) {
  const Scratch scratch;
  put(scratch / name, text);
  try {
    readMesh(scratch / name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}
}  // namespace

// The same square of 2 by 3 metres, looking up, by three formats.
TEST(MeshFilesIdentity, ThreeFormatsSayTheSame) {
  const Scratch scratch;
  put(scratch / "s.ply", ply);
  put(scratch / "s.gltf", gltf());
  put(scratch / "s.obj", "v 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 2 3 4\n");
  for (const std::string name : {"s.ply", "s.gltf", "s.obj"}) {
    const SceneGeometry square = built(scratch / name);
    ASSERT_EQ(square.triangles().size(), 2u) << name;
    EXPECT_EQ(square.vertices().size(), 4u) << name;
    double area = 0;
    CDVector middle;
    for (std::uint32_t i = 0; i < 2; ++i) {
      const auto [a, b, c] = square.placed(i).corners;
      EXPECT_NEAR(square.placed(i).normal().z, 1, 1e-6) << name;
      area += cross(b - a, c - a).getLength() / 2;
      middle = middle + (a + b + c) * (1 / 6.0);
    }
    EXPECT_NEAR(area, 6, 1e-5) << name;
    EXPECT_NEAR((middle - CDVector{1, 1.5, 1}).getLength(), 0, 1e-5) << name;
  }
  EXPECT_EQ(built(scratch / "s.ply").facetNames()[0], "mesh");
  EXPECT_EQ(built(scratch / "s.ply").materialNames()[0], "default");
  EXPECT_EQ(built(scratch / "s.gltf").facetNames()[0], "roof");
  EXPECT_EQ(built(scratch / "s.gltf").materialNames()[0], "tiles");
}

// Single precision of the file: 1e-6.
TEST(MeshFilesIdentity, NormalsOfCornersStayPerpendicular) {
  const Scratch scratch;
  put(scratch / "slope.gltf", slope(0)), put(scratch / "leans.gltf", slope(0.2f));
  put(scratch / "s.ply", ply);
  const Mesh mesh = readMesh(scratch / "slope.gltf"), leans = readMesh(scratch / "leans.gltf");
  ASSERT_EQ(mesh.normals.size(), 2u);
  const CDVector expected =
      normalized(CDVector{1, 0, 1});  // of a slope from (0,0,0) to (-2,0,2)
  for (const NormalCorners& corners : mesh.normals)
    for (const CDVector& n : corners)
      EXPECT_NEAR((n - expected).getLength(), 0, 1e-6) << n.x << ' ' << n.y << ' ' << n.z;
  EXPECT_EQ(mesh.ignored_normals, 0u);
  EXPECT_EQ(leans.ignored_normals, 1u);  // control
  EXPECT_TRUE(readMesh(scratch / "s.ply").normals.empty());
  GeometryBuilder builder;
  builder.addMesh(leans, Transform(), "", {}, true);
  const SceneGeometry smooth = std::move(builder).build();
  ASSERT_TRUE(smooth.hasSmoothNormals());
  for (std::uint32_t i = 0; i < 2; ++i) {
    const PlacedTriangle t = smooth.placed(i);
    EXPECT_NEAR((t.normal() - expected).getLength(), 0, 1e-6);
    for (const CDVector& corner : t.corners) {
      const double off = (smooth.smoothNormal(i, corner) - expected).getLength();
      const bool leaning = (corner - CDVector{0, 3, 0}).getLength() < 1e-6;
      EXPECT_EQ(off > 0.05, leaning);
      if (!leaning) {
        EXPECT_NEAR(off, 0, 1e-6);
      }
    }
  }
}

// The normals of the slope, as a PLY that is used unchanged.
TEST(MeshFilesIdentity, NormalsOfAPLY) {
  const Scratch scratch;
  put(scratch / "n.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 1 0 0 2\n2 0 1 0 0 2\n2 3 1 0 1 2\n3 0 1 2\n");
  const Mesh mesh = readMesh(scratch / "n.ply");
  ASSERT_EQ(mesh.normals.size(), 1u);
  EXPECT_NEAR((mesh.normals[0][0] - CDVector{0, 0, 1}).getLength(), 0, 1e-6);
  EXPECT_NEAR((mesh.normals[0][2] - normalized(CDVector{0, 1, 2})).getLength(), 0, 1e-6);
  EXPECT_EQ(mesh.ignored_normals, 1u);
}

TEST(MeshFilesIdentity, BrokenFilesAreRefusedByName) {
  const auto says = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  EXPECT_EQ(complaint("good.ply", ply), "none");
  says(complaint("short.ply", ply.substr(0, ply.find("2 3 1"))), "short.ply: cannot be read");
  says(complaint("cut.gltf", gltf().substr(0, 300)), "cut.gltf: cannot be read");
  std::string index = ply;
  index.replace(index.rfind("3"), 1, "9");
  says(complaint("index.ply", index), "index.ply: cannot be read");
  says(complaint("none.ply", ""), "none.ply");
  says(complaint("mesh.stl", "solid"), "is not the suffix of a mesh file");
  EXPECT_THROW(readMesh("missing.ply"), InputError);
}
