// Meshes, their places and their door (nw/scene/SceneGeometry.nw).
#include "malus/scene/SceneGeometry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double rounding = 1e-14;  // a few operations on numbers of size one

const std::string square =
    "# a square and a triangle\n"
    "o box\ng top\nusemtl red\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 3 4\n"
    "g side\nusemtl blue\nf -4/1/1 -3/2/1 -1/3/1\n";

Mesh parsed(const std::string& text) {
  const Scratch scratch;
  put(scratch / "m.obj", text);
  return readOBJ(scratch / "m.obj");
}

std::string complaint(const std::string& text) {
  try {
    parsed(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("m.obj"));
  }
  return "none";
}

SceneGeometry placed(const Mesh& mesh, const Transform& place) {
  GeometryBuilder builder;
  builder.addMesh(mesh, place);
  return std::move(builder).build();
}
}  // namespace

TEST(SceneGeometryIdentity, ReadsNamesFacesAndRelativeIndices) {
  const Mesh mesh = parsed(square);
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.facets, (std::vector<std::string>{"box.top", "box.side"}));
  EXPECT_EQ(mesh.materials, (std::vector<std::string>{"red", "blue"}));
  EXPECT_EQ(mesh.triangles[1].c, 3u);
  EXPECT_EQ(mesh.triangles[2].a, 0u);
  EXPECT_EQ(mesh.triangles[2].facet, 1u);
}

TEST(SceneGeometryIdentity, BadMeshesNameTheLine) {
  EXPECT_EQ(complaint("v 0 0 0\nv 1 nan 0\n").substr(0, 9), "m.obj:2: ");
  EXPECT_NE(complaint("v 0 0 0\nv 1 x 0\n").find("vertex y"), std::string::npos);
  EXPECT_NE(complaint("v 0 0\n").find("vertex z"), std::string::npos);
  EXPECT_NE(complaint("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").find("9: names no vertex"),
            std::string::npos);
  EXPECT_NE(complaint("v 0 0 0\nv 1 0 0\nf 1 2\n").find("fewer than three"), std::string::npos);
  EXPECT_NE(complaint("v 0 0 0\n").find("no faces"), std::string::npos);
  EXPECT_EQ(complaint(square), "none");  // the negative control: a good mesh is not refused
}

namespace {
struct Shape {
  double area = 0,
         least_z = 1;  // of all triangles together; the normal's z that points most downwards
};
Shape shapeOf(const Mesh& mesh) {
  Shape shape;
  const SceneGeometry scene = placed(mesh, {});
  for (const Triangle& t : scene.triangles()) {
    const CDVector ab = scene.vertices()[t.b] - scene.vertices()[t.a];
    shape.area += 0.5 * cross(ab, scene.vertices()[t.c] - scene.vertices()[t.a]).getLength();
    shape.least_z = std::min(shape.least_z, scene.normal(t).z);
  }
  return shape;
}
const std::string arrow =
    "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\n";  // the last corner points inwards; area 6
}  // namespace

TEST(SceneGeometryInvariant, PolygonsThatAreNotConvexKeepTheirAreaAndTheirSide) {
  for (const std::string face : {"f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 1 2 3"}) {
    const Shape shape = shapeOf(parsed(arrow + face + "\n"));
    EXPECT_NEAR(shape.area, 6, rounding * 10) << face;
    EXPECT_NEAR(shape.least_z, 1, rounding) << face;
  }
  // the negative control: the fan from the first corner, cut by hand
  const Shape naive = shapeOf(parsed(arrow + "f 1 2 3\nf 1 3 4\n"));
  EXPECT_GT(naive.area, 7);
  EXPECT_LT(naive.least_z, 0);
  EXPECT_NEAR(
      shapeOf(parsed("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv -1 1 0\nf 1 2 3 4 5\n")).area, 7,
      rounding * 10);
}

TEST(SceneGeometryIdentity, PolygonsThatNoFanFillsAreRefused) {
  std::string star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 ? 0.3 : 1, phi = std::numbers::pi * i / 5;
    star += fmt::format("v {} {} 0\n", r * std::cos(phi), r * std::sin(phi));
  }
  EXPECT_EQ(complaint(star + "f 1 2 3 4 5 6 7 8 9 10\n"),
            "m.obj:11: f = f 1 2 3 4 5 6 7 8 9 10: is a polygon that no fan of triangles from "
            "one corner fills; triangulate the mesh in the program that made it");
}

TEST(SceneGeometryIdentity, DirectoriesAndVerticesBeyondTheWorldAreRefused) {
  const Scratch scratch;
  EXPECT_THROW(readOBJ(scratch.path), InputError);
  const Mesh mesh = parsed(square);
  EXPECT_THROW(placed(mesh, Transform::scale(1e12)), InputError);
  EXPECT_THROW(placed(mesh, Transform::scale(1e308 * 10)), InputError);
  EXPECT_NO_THROW(placed(mesh, Transform::scale(1e6)));
}

// The library behind the door takes 3x for 3, 1,5 for 1, and 4294967299 for 3.
TEST(SceneGeometryIdentity, CornersAreWholeNumbersOf32BitsAndNothingElse) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const std::string bad : {"4294967299", "1,5", "3x", "2147483648", "-9999999999", "1.5",
                                "3/", "/3", "3//", "3/1/1/1", "0x3", "+3", "3/x", "nan"})
    EXPECT_EQ(
        complaint(corners + "f 1 2 " + bad + "\n"),
        "m.obj:4: f = " + bad +
            ": is not a corner of a face; write whole numbers below 2147483648: 7, 7/1, 7//3 "
            "or "
            "7/1/3");
  for (const std::string good : {"3", "-1", "3/7", "3//9", "3/7/9", "-1/-1/-1"})
    EXPECT_EQ(complaint(corners + "f 1 2 " + good + "\n"), "none") << good;
}

TEST(SceneGeometryIdentity, NamesThatNoRecordCouldHoldAreRefusedWithTheirLine) {
  const std::string rest = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const std::string keyword : {"g", "o", "usemtl"}) {
    EXPECT_EQ(complaint("# saved as Latin-1\n" + keyword + " Stra\xdf\x65\n" + rest),
              "m.obj:2: " + keyword +
                  " = Stra\\xdfe: is not UTF-8 at byte 5 (0xdf); save it as UTF-8, or use "
                  "ASCII letters");
    EXPECT_NE(complaint(keyword + " " + std::string(1001, 'n') + "\n" + rest).find("is longer"),
              std::string::npos);
    EXPECT_EQ(complaint(keyword + " Stra\u00dfe\n" + rest), "none");
  }
}

TEST(SceneGeometryIdentity, CoordinatesThatNobodyCouldSquareAreRefusedWithTheirLine) {
  for (const std::string bad : {"1e19", "-2e18", "1e300", "-1e308"})
    EXPECT_NE(complaint("v 0 0 0\nv 1 " + bad + " 0\nv 0 1 0\nf 1 2 3\n")
                  .find("m.obj:2: vertex y = " + bad + ": is beyond 1e18 in any unit"),
              std::string::npos)
        << bad;
}

// Each face has its own group and material, and each name its own number.
TEST(SceneGeometryIdentity, AHundredThousandNamesKeepTheirOrder) {
  constexpr std::uint32_t count = 100'000;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (std::uint32_t i = 0; i < count; ++i)
    text += fmt::format("g part-{0}\nusemtl paint-{0}\nf 1 2 3\n", i);
  const Mesh mesh = parsed(text + "g part-7\nf 1 2 3\n");
  ASSERT_EQ(mesh.facets.size(), count);
  ASSERT_EQ(mesh.triangles.size(), count + 1);
  for (std::uint32_t i = 0; i < count; i += 997) {
    EXPECT_EQ(mesh.triangles[i].facet, i);
    EXPECT_EQ(mesh.materials[mesh.triangles[i].material], fmt::format("paint-{}", i));
  }
  EXPECT_EQ(mesh.triangles.back().facet, 7u);
}

TEST(SceneGeometryIdentity, TransformsComposeInOrder) {
  const Transform turn = Transform::rotate({0, 0, 1}, std::numbers::pi / 2);
  const Transform move = Transform::translate({10, 0, 0});
  const CDVector p = move.after(turn).apply({1, 0, 0}), q = turn.after(move).apply({1, 0, 0});
  EXPECT_NEAR(p.x, 10, rounding * 10);
  EXPECT_NEAR(p.y, 1, rounding * 10);
  EXPECT_NEAR(q.x, 0, rounding * 20);
  EXPECT_NEAR(q.y, 11, rounding * 20);
}

TEST(SceneGeometryInvariant, MirroredMeshesKeepTheirOutside) {
  const Mesh mesh = parsed(square);
  for (const double sx : {1.0, -1.0}) {
    const SceneGeometry scene = placed(mesh, {{sx, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}});
    for (const Triangle& t : scene.triangles()) EXPECT_NEAR(scene.normal(t).z, 1, rounding);
  }
}

TEST(SceneGeometryIdentity, TrianglesWithoutAreaAreCountedAndKeptOut) {
  const Mesh mesh = parsed("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\nf 1 1 4\n");
  const SceneGeometry scene = placed(mesh, {});
  EXPECT_EQ(scene.triangles().size(), 1u);
  EXPECT_EQ(scene.degenerateTriangles(), 2u);
}

TEST(SceneGeometryIdentity, MaterialsAreRenamedByNameOrAllTogether) {
  GeometryBuilder builder;
  builder.addMesh(parsed(square), {}, "a.", {{"red", "copper"}});
  builder.addMesh(parsed(square), Transform::translate({5, 0, 0}), "b.", {{"*", "soil"}});
  builder.addGround(0, "soil", "ground");
  EXPECT_THROW(builder.addGround(1, "soil", "ground"), MathError);
  const SceneGeometry scene = std::move(builder).build();
  EXPECT_EQ(scene.materialNames(), (std::vector<std::string>{"copper", "blue", "soil"}));
  EXPECT_EQ(scene.facetNames().back(), "ground");
  EXPECT_EQ(scene.facetNames()[2], "b.box.top");
  EXPECT_EQ(scene.triangles()[3].a, 4u);
}

// Rodrigues by what defines it: the axis stays, what is perpendicular to it turns by the angle to the
// left, and volumes stay. The axis need not be a unit vector.
TEST(SceneGeometryIdentity, ARotationTurnsAboutItsAxis) {
  const CDVector axis{1, -2, 2}, across{2, 2, 1};  // 3 long, and perpendicular
  for (const double angle : {0.3, 2.0, -1.1}) {
    const Transform turn = Transform::rotate(axis, angle);
    EXPECT_LT((turn.apply(axis) - axis).getLength(), rounding);
    const CDVector turned = turn.apply(across);
    EXPECT_NEAR(dot(turned, across), 9 * std::cos(angle), 9 * rounding);
    EXPECT_NEAR(dot(cross(across, turned), axis), 27 * std::sin(angle), 27 * rounding);
    EXPECT_NEAR(turn.determinant(), 1, rounding);
  }
  EXPECT_THROW(Transform::rotate({}, 1), MathError);
}

TEST(SceneGeometryIdentity, AScaleIsOfAllAxes) {
  const CDVector p = Transform::scale(3).apply({1, 2, -5});
  EXPECT_EQ(p.x, 3);
  EXPECT_EQ(p.y, 6);
  EXPECT_EQ(p.z, -15);
  EXPECT_EQ(Transform::scale(-2).determinant(), -8);
  const Transform both =
      Transform::translate({1, 1, 1}).after(Transform::translate({0, 4, -2}));
  EXPECT_EQ(both.apply({}).y, 5);
  EXPECT_EQ(both.apply({}).z, -1);
}

// A mirror image by any scale below zero, and a turned one that is none.
TEST(SceneGeometryInvariant, OnlyMirrorImagesExchangeCorners) {
  const Mesh mesh = parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(placed(mesh, Transform::scale(-1)).triangles()[0].b, 2u);
  EXPECT_EQ(placed(mesh, Transform::rotate({1, 0, 0}, 3)).triangles()[0].b, 1u);
}

// The world ends at 1e9 m on each axis and side, and not before.
TEST(SceneGeometryIdentity, TheWorldEndsAtAThousandMillionMetres) {
  const Mesh mesh = parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const double far : {0.999999e9, -0.999999e9})
    for (const CDVector& to : {CDVector{far, 0, 0}, CDVector{0, far, 0}, CDVector{0, 0, far}})
      EXPECT_NO_THROW(placed(mesh, Transform::translate(to)));
  for (const double far : {1e9, -1.000001e9})
    for (const CDVector& to : {CDVector{far, 0, 0}, CDVector{0, far, 0}, CDVector{0, 0, far}})
      EXPECT_THROW(placed(mesh, Transform::translate(to)), InputError);
  EXPECT_EQ(complaint("v 0 0 0\nv 1e18 0 0\nv 0 -1e18 0\nf 1 2 3\n"), "none");
}

// A triangle as flat as 1e-12 of its longest side, whichever side that is and whatever the unit.
TEST(SceneGeometryIdentity, WithoutAreaMeansFlatAgainstTheLongestSide) {
  const auto kept = [](double height, int first, double unit) {
    Mesh mesh;
    mesh.facets = {"a"}, mesh.materials = {"b"};
    const std::array<CDVector, 3> corner{CDVector{}, {1, 0, 0}, {0.5, height, 0}};
    for (int i = 0; i < 3; ++i)
      mesh.vertices.push_back(corner[std::size_t(first + i) % 3] * unit);
    mesh.triangles = {{0, 1, 2, 0, 0}};
    const SceneGeometry scene = placed(mesh, {});
    EXPECT_EQ(scene.triangles().size() + scene.degenerateTriangles(), 1u);
    return scene.triangles().size() == 1;
  };
  for (int first = 0; first < 3; ++first)
    for (const double unit : {1.0, 1024.0, 1 / 1024.0}) {
      EXPECT_TRUE(kept(1.005e-12, first, unit));
      EXPECT_FALSE(kept(0.995e-12, first, unit));
    }
}

TEST(SceneGeometryIdentity, FacetsAndMaterialsWithoutANameHaveOne) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Mesh mesh =
      parsed(corners + "f 1 2 3\ng side\nf 1 2 3\no box\nf 1 2 3\ng top\nf 1 2 3\n");
  EXPECT_EQ(mesh.facets, (std::vector<std::string>{"mesh", "side", "box", "box.top"}));
  EXPECT_EQ(mesh.materials, (std::vector<std::string>{"default"}));
  EXPECT_NE(complaint(corners + "f 1 2 -4\n").find("-4: names no vertex; there are 3"),
            std::string::npos);
  EXPECT_NE(complaint(corners + "f 1 2 0\n").find("0"), std::string::npos);
  EXPECT_NE(complaint(corners + "f 1 2 4\n").find("4: names no vertex"), std::string::npos);
  EXPECT_EQ(parsed(corners + "f -3 -2 -1\n").triangles[0].a, 0u);
}

// Normals of corners count if they are more than a degree off, whatever their length; those of no
// length or that are not there do not. The square is not a triangle, so that its normal is a sum.
TEST(SceneGeometryIdentity, NormalsMoreThanADegreeOffAreCounted) {
  const auto ignored = [](double degrees, const std::string& corners) {
    const double angle = degrees * std::numbers::pi / 180;
    return parsed(fmt::format("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvn 0 0 0\nvn {} 0 {}\n",
                              3 * std::sin(angle), 3 * std::cos(angle)) +
                  "f " + corners + "\n")
        .ignored_normals;
  };
  EXPECT_EQ(ignored(1.005, "1//2 2//2 3//2 4//2"), 4u);
  EXPECT_EQ(ignored(0.995, "1//2 2//2 3//2 4//2"), 0u);
  EXPECT_EQ(ignored(180, "1//-1 2//1 3 4//9"), 1u)
      << "one of none, one that is absent, one of no length";
  EXPECT_EQ(ignored(180, "1//-2 2//-1 3//-3 4"), 1u);
}

// The normal of an arrowhead is that of its area, 1/2, though most of it lies on the other side of its first edge.
TEST(SceneGeometryIdentity, NormalsOfAnArrowheadAreComparedWithThatOfItsArea) {
  const auto ignored = [](int z) {
    return parsed(fmt::format("v 0 2 0\nv 1.5 1 0\nv 0 0 0\nv 2 1 0\nvn 0 0 {}\n"
                              "f 1//1 2//1 3//1 4//1\n",
                              z))
        .ignored_normals;
  };
  EXPECT_EQ(ignored(1), 0u);
  EXPECT_EQ(ignored(-1), 4u) << "negative control: the other side";
}

// A corner that is a hair inside is one within rounding, and the first corner stays the tip.
TEST(SceneGeometryIdentity, AConvexPolygonIsCutFromItsFirstCorner) {
  const Mesh mesh = parsed("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv -1 1 0\nf 1 2 3 4 5\n");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(mesh.triangles[i].a, 0u);
    EXPECT_EQ(mesh.triangles[i].b, i + 1);
    EXPECT_EQ(mesh.triangles[i].c, i + 2);
  }
  // corners on one line with the first make triangles without area, which do not disagree
  EXPECT_EQ(parsed("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3 4\n").triangles[0].a, 0u);
}

// The same arithmetic: to rounding of coordinates up to 400 m.
TEST(SceneGeometryIdentity, SharedMeshesAreWhatWouldBeWrittenOut) {
  const Mesh mesh = parsed(square);
  GeometryBuilder flat, shared;
  const std::uint32_t number = shared.share(mesh);
  for (int i = 0; i < 40; ++i) {
    Transform place = Transform::scale(0.3 + 0.1 * i);
    if (i % 3 == 0) place.y = -place.y;  // a mirror image
    place = Transform::rotate({1, 0.1 * i, -0.5}, 0.7 * i).after(place);
    place = Transform::translate({1.7 * i, -300.1, 0.01 * i}).after(place);
    const std::map<std::string, std::string> names{{"red", i % 2 ? "green" : "red"}};
    flat.addMesh(mesh, place, i % 5 ? "" : "fifth.", names);
    shared.addInstance(number, place, i % 5 ? "" : "fifth.", names);
  }
  const SceneGeometry a = std::move(flat).build(), b = std::move(shared).build();
  ASSERT_EQ(b.instances().size(), 40u);
  EXPECT_EQ(b.instanceNames().size(), 4u) << "places with the same names share them";
  EXPECT_EQ(b.triangles().size(), 0u);
  ASSERT_EQ(b.countTriangles(), a.triangles().size());
  EXPECT_EQ(a.facetNames(), b.facetNames());
  EXPECT_EQ(a.materialNames(), b.materialNames());
  for (std::uint32_t t = 0; t < a.triangles().size(); ++t) {
    const PlacedTriangle one = a.placed(t), other = b.placed(t % 3, t / 3);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT((one.corners[k] - other.corners[k]).getLength(), 1e-12);
    EXPECT_EQ(one.facet, other.facet);
    EXPECT_EQ(one.material, other.material);
    EXPECT_GT(dot(a.normal(a.triangles()[t]), other.normal()), 1 - 1e-9);
    const auto [low, high] = b.boxAround(b.instances()[t / 3]);
    for (const CDVector& corner : other.corners) {
      EXPECT_TRUE(corner.x >= low.x - 1e-12 && corner.x <= high.x + 1e-12);
      EXPECT_TRUE(corner.z >= low.z - 1e-12 && corner.z <= high.z + 1e-12);
    }
  }
  EXPECT_NE(b.placed(0, 3).corners, b.placed(0, 4).corners);  // negative control
}

TEST(SceneGeometryIdentity, SharedMeshesStayInTheWorldAndKeepTheirVolume) {
  const Mesh mesh = parsed(square + "f 1 1 2\n");
  GeometryBuilder builder;
  const std::uint32_t number = builder.share(mesh);
  EXPECT_THROW(builder.addInstance(number, Transform::scale(0)), MathError);
  EXPECT_THROW(builder.addInstance(number, Transform::translate({2e9, 0, 0})), InputError);
  builder.addInstance(number, Transform::translate({1e8, 0, 0}));
  const SceneGeometry made = std::move(builder).build();
  EXPECT_EQ(made.instances().size(), 1u);
  EXPECT_EQ(made.countTriangles(), 3u);
  EXPECT_EQ(made.degenerateTriangles(), 1u);
}
