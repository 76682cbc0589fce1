// What rays meet (nw/render/RayTracer.nw), against a search through all triangles in double precision.
#include "malus/render/RayTracer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/DirectionSampling.hpp"

using namespace malus;

namespace {
SceneGeometry pyramids(const CDVector& at, bool ground) {
  Mesh mesh;
  mesh.name = "pyramids";
  mesh.facets = {"a", "b", "c", "d"};
  mesh.materials = {"stone"};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const CDVector c{i & 1 ? 2.0 : -2.0, i & 2 ? 2.0 : -2.0, 0};
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& [x, y] : {std::pair{-1.5, -1.5}, {1.5, -1.5}, {1.5, 1.5}, {-1.5, 1.5}})
      mesh.vertices.push_back(c + CDVector{x, y, 0});
    mesh.vertices.push_back(c + CDVector{0, 0, 1});
    for (std::uint32_t k = 0; k < 4; ++k)
      mesh.triangles.push_back({n + k, n + (k + 1) % 4, n + 4, i, 0});
  }
  GeometryBuilder builder;
  builder.addMesh(mesh, Transform::translate(at));
  if (ground) builder.addGround(at.z, "soil", "ground");
  return std::move(builder).build();
}

/// Moeller and Trumbore, every triangle, in double precision: distance, or infinity.
double search(const SceneGeometry& g, const CDVector& o, const CDVector& d, bool ground) {
  double best = std::numeric_limits<double>::infinity();
  for (const Triangle& t : g.triangles()) {
    const CDVector a = g.vertices()[t.a], e = g.vertices()[t.b] - a, f = g.vertices()[t.c] - a;
    const CDVector p = cross(d, f);
    const double det = dot(e, p);
    if (std::abs(det) < 1e-12) continue;
    const CDVector s = o - a, q = cross(s, e);
    const double u = dot(s, p) / det, v = dot(d, q) / det, distance = dot(f, q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && distance > 0) best = std::min(best, distance);
  }
  if (ground && d.z < 0) best = std::min(best, (g.ground()->z_m - o.z) / d.z);
  return best;
}

CDVector randomDirection(Random& random) {
  const double z = 2 * random.uniform() - 1, a = 2 * M_PI * random.uniform(),
               r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}
}  // namespace

// Distances agree to 1e-9 of themselves unless a ray passes an edge within single precision's reach.
TEST(RayTracerIdentity, MeetsWhatASearchMeets) {
  for (const CDVector& at : {CDVector{}, CDVector{500000, 4000000, 120}}) {
    const SceneGeometry scene = pyramids(at, true);
    const RayTracer tracer(scene);
    Random random(1);
    int apart = 0;
    for (int i = 0; i < 20000; ++i) {
      const CDVector o = at + CDVector{8 * random.uniform() - 4, 8 * random.uniform() - 4,
                                       1.2 + random.uniform()};
      const CDVector d = randomDirection(random);
      const double expected = search(scene, o, d, true);
      const Hit hit = tracer.intersect(o, d);
      ASSERT_EQ(bool(hit), std::isfinite(hit.t));
      EXPECT_EQ(bool(hit), tracer.occluded(o, d));
      if (hit) {
        EXPECT_LT(dot(hit.normal, d), 0);
      }
      apart += !(hit.t == expected || std::abs(hit.t - expected) < 1e-8 * expected);
    }
    EXPECT_LE(apart, 4);
  }
}

TEST(RayTracerIdentity, NegativeControlAScenesShiftIsSeen) {
  const SceneGeometry scene = pyramids({}, false), moved = pyramids({0.01, 0, 0}, false);
  const RayTracer tracer(scene);
  Random random(1);
  int apart = 0;
  for (int i = 0; i < 1000; ++i) {
    const CDVector o{4 * random.uniform() - 2, 4 * random.uniform() - 2, 2};
    const double expected = search(moved, o, {0, 0, -1}, false),
                 t = tracer.intersect(o, {0, 0, -1}).t;
    apart += std::isfinite(expected) && std::abs(t - expected) > 1e-8;
  }
  EXPECT_GT(apart, 200);  // only the faces that look east or west see it
}

TEST(RayTracerInvariant, BundlesAnswerAsSingleRaysDo) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    RayBundle rays{};
    rays.origin = {4 * random.uniform() - 2, 4 * random.uniform() - 2, 1.01};
    rays.active = i % 3 == 0 ? 0xffffu : static_cast<std::uint32_t>(random() & 0xffff);
    for (int k = 0; k < 16; ++k) {
      const CDVector d = randomDirection(random);
      rays.x[k] = float(d.x), rays.y[k] = float(d.y), rays.z[k] = float(d.z);
    }
    std::array<Hit, 16> hits;
    const std::uint32_t met = tracer.intersect(rays, hits), blocked = tracer.occluded(rays);
    EXPECT_EQ(met, blocked);
    EXPECT_EQ(met & ~rays.active, 0u);
    for (int k = 0; k < 16; ++k) {
      if (!(rays.active >> k & 1)) continue;
      const Hit one = tracer.intersect(rays.origin, {rays.x[k], rays.y[k], rays.z[k]});
      EXPECT_EQ(bool(one), bool(met >> k & 1));
      if (one) {
        EXPECT_EQ(one.t, hits[k].t);
      }
    }
  }
}

TEST(RayTracerInvariant, SunBundlesAnswerAsSingleRaysDo) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  Random random(3);
  int met = 0, missed = 0;
  for (int i = 0; i < 2000; ++i) {
    SunBundle rays;
    for (CDVector& direction : rays.direction) direction = randomDirection(random);
    rays.active = i % 3 == 0 ? 0xffffu : static_cast<std::uint32_t>(random() & 0xffff);
    for (CDVector& origin : rays.origin)
      origin = {4 * random.uniform() - 2, 4 * random.uniform() - 2, 2 * random.uniform() - 0.5};
    const std::uint32_t blocked = tracer.occluded(rays);
    EXPECT_EQ(blocked & ~rays.active, 0u);
    for (int k = 0; k < 16; ++k) {
      if (!(rays.active >> k & 1)) continue;
      EXPECT_EQ(tracer.occluded(rays.origin[k], rays.direction[k]), bool(blocked >> k & 1));
      ++(blocked >> k & 1 ? met : missed);
    }
  }
  EXPECT_GT(met, 1000) << "negative control: either answer is given";
  EXPECT_GT(missed, 1000);
}

// From none to sixteen rays in each of sixteen bundles: packets that are full, and the odd one at the end.
TEST(RayTracerInvariant, ManyBundlesAnswerAsSingleRaysDo) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  Random random(4);
  int met = 0, missed = 0, others = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<RayBundle> bundles(16);
    for (RayBundle& rays : bundles) {
      rays.origin = {4 * random.uniform() - 2, 4 * random.uniform() - 2,
                     1.5 * random.uniform() + 0.01};
      rays.active = static_cast<std::uint32_t>(random() & random() & 0xffff);
      for (int k = 0; k < 16; ++k) {
        const CDVector d = randomDirection(random);
        rays.x[k] = float(d.x), rays.y[k] = float(d.y), rays.z[k] = float(d.z);
      }
    }
    std::vector<std::uint32_t> blocked(16, 0xffffu);
    tracer.occluded(bundles, blocked);
    for (std::size_t b = 0; b < 16; ++b) {
      const RayBundle& rays = bundles[b];
      EXPECT_EQ(blocked[b] & ~rays.active, 0u);
      others += (blocked[b] ^ tracer.occluded(bundles[(b + 1) % 16])) & rays.active ? 1 : 0;
      for (int k = 0; k < 16; ++k) {
        if (!(rays.active >> k & 1)) continue;
        EXPECT_EQ(tracer.occluded(rays.origin, {rays.x[k], rays.y[k], rays.z[k]}),
                  bool(blocked[b] >> k & 1));
        ++(blocked[b] >> k & 1 ? met : missed);
      }
    }
  }
  EXPECT_GT(met, 1000) << "negative control: either answer is given";
  EXPECT_GT(missed, 1000);
  EXPECT_GT(others, 1000) << "negative control: the answer belongs to another bundle";
}

TEST(RayTracerInvariant, NothingLeaksBetweenTriangles) {
  const SceneGeometry scene = pyramids({}, false);
  const RayTracer tracer(scene);
  for (int i = 0; i <= 1000; ++i) {  // down on the ridges that triangles share
    const double t = 0.001 + 0.998 * i / 1000;
    EXPECT_TRUE(tracer.intersect({-3.5 + 1.5 * t, -3.5 + 1.5 * t, 5}, {0, 0, -1})) << t;
  }
}

// 2^-16 of the distance from the scene's middle, in map coordinates as well.
TEST(RayTracerIdentity, AStartIsNearItsSurface) {
  const CDVector at{500000, 4000000, 120};
  const SceneGeometry scene = pyramids(at, true);
  const RayTracer tracer(scene);
  const Hit hit = tracer.intersect(at + CDVector{1.9, 2.1, 5}, {0, 0, -1});
  ASSERT_TRUE(hit);
  const double off = dot(tracer.leave(hit) - hit.point, hit.normal);
  EXPECT_GT(off, 1e-6);
  EXPECT_LT(off, 1e-4);
  EXPECT_FALSE(tracer.occluded(tracer.leave(hit), hit.normal));
}

// Far from the edges a start lies straight above its hit. On an edge it is moved towards the centroid
// until it is two offsets from the edge: on the foot's middle that is straight up the face, and the
// offset is 2^-16 of the two metres from the scene's middle.
TEST(RayTracerIdentity, AStartMovesSidewaysNearEdgesAlone) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  const auto sideways = [&](double x, double y) {
    const Hit hit = tracer.intersect({x, y, 5}, {0, 0, -1});
    EXPECT_TRUE(hit);
    const CDVector off = tracer.leave(hit) - hit.point;
    return off - hit.normal * dot(off, hit.normal);
  };
  for (const double y : {-0.2, -0.75, -1.4})                // the foot is at -1.5, the tip at 0
    EXPECT_LT(sideways(2, 2 + y).getLength(), 1e-14) << y;  // rounding of a point near 2
  EXPECT_LT(sideways(3.9, 0.1).getLength(), 1e-14) << "the ground has no edges";
  const CDVector moved = sideways(2, 2 - 1.5 + 1e-8);
  EXPECT_GT(moved.y, 0);
  EXPECT_NEAR(moved.getLength(), 2 * 0x1p-15, 1e-6 * 0x1p-15);  // 1e-8 m off the edge
}

// Rays from where all four faces of a pyramid are seen to its tip and its ridges meet the pyramid and not the ground behind.
TEST(RayTracerInvariant, NothingLeaksAtCorners) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const double t = random.uniform();
    const CDVector tip{-2, -2, 1}, foot{-3.5, -3.5, 0}, target = tip * t + foot * (1 - t);
    const CDVector from{-4 + 4 * random.uniform(), -4 + 4 * random.uniform(),
                        4 + 5 * random.uniform()};
    const Hit hit = tracer.intersect(from, normalized(target - from));
    ASSERT_TRUE(hit);
    EXPECT_LT(hit.t, (target - from).getLength() * (1 + 1e-5) +
                         1e-5);  // not what lies behind the edge
  }
}

// However flat a ray leaves a face, its own face is not in its way.
TEST(RayTracerIdentity, GrazingRaysLeaveTheirFace) {
  const SceneGeometry scene = pyramids({}, false);
  const RayTracer tracer(scene);
  Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const Hit hit = tracer.intersect(
        {-2 + 0.5 * random.uniform(), -2 + 0.2 * random.uniform(), 3}, {0, 0, -1});
    ASSERT_TRUE(hit);
    const CDVector along = normalized(cross(hit.normal, randomDirection(random)));
    const CDVector flat = normalized(along + hit.normal * (1e-3 * random.uniform()));
    const Hit next = tracer.intersect(tracer.leave(hit), flat);
    if (next) {
      EXPECT_GT(dot(next.point - hit.point, hit.normal), 0.0);  // not behind the face
      EXPECT_NE(next.facet, hit.facet);
    }
  }
}

// A closed room with acute edges, here and far from the origin: rays that start in its edges and corners stay in it. The negative
// control moves along the normal alone, as was done once: such rays get out.
TEST(RayTracerInvariant, NothingLeaksOutOfARoom) {
  for (const CDVector& at : {CDVector{}, CDVector{500000, 4000000, 120}}) {
    Mesh mesh;
    mesh.facets = {"wall"}, mesh.materials = {"stone"};
    mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0.2, 0.1, 1}};
    mesh.triangles = {{0, 2, 1, 0, 0}, {0, 1, 3, 0, 0}, {1, 2, 3, 0, 0}, {2, 0, 3, 0, 0}};
    GeometryBuilder builder;
    builder.addMesh(mesh, Transform::translate(at));
    const SceneGeometry scene = std::move(builder).build();
    const RayTracer tracer(scene);
    const auto& v = scene.vertices();
    const CDVector middle = (v[0] + v[1] + v[2] + v[3]) * 0.25;
    Random random(6);
    int out = 0, out_along_normal = 0;
    for (int i = 0; i < 6000; ++i) {
      const std::size_t a = i % 4, b = (a + 1 + i / 4 % 3) % 4;
      const CDVector target = v[a] + (v[b] - v[a]) * (i % 5 == 0 ? 0 : random.uniform());
      const Hit hit = tracer.intersect(middle, normalized(target - middle));
      ASSERT_TRUE(hit);
      CDVector d = randomDirection(random);
      if (dot(d, hit.normal) < 0) d = -d;
      out += !tracer.occluded(tracer.leave(hit), d);
      out_along_normal += !tracer.occluded(hit.point + hit.normal * 0x1p-14, d);
    }
    EXPECT_EQ(out, 0);
    EXPECT_GT(out_along_normal, 10);
  }
}

TEST(RayTracerIdentity, AStartOffTheSurfaceDoesNotMeetIt) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const Hit hit =
        tracer.intersect({8 * random.uniform() - 4, 8 * random.uniform() - 4, 3}, {0, 0, -1});
    const CDVector start = tracer.leave(hit);
    EXPECT_FALSE(tracer.occluded(start, hit.normal));
  }
}

TEST(RayTracerIdentity, NotANumberIsRefused) {
  const SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  const double nan = std::nan("");
  EXPECT_THROW(tracer.intersect({0, 0, nan}, {0, 0, -1}), MathError);
  EXPECT_THROW(tracer.occluded({0, 0, 1}, {nan, 0, -1}), MathError);
  RayBundle rays{};
  rays.active = 2, rays.x[1] = float(nan);
  EXPECT_THROW(tracer.occluded(rays), MathError);
  rays.active = 1, rays.z[0] = 1;  // the lane that is not a number does not take part
  EXPECT_NO_THROW(tracer.occluded(rays));
}

TEST(RayTracerIdentity, AnEmptyWorldIsAllSky) {
  const SceneGeometry nothing = GeometryBuilder().build();
  const RayTracer tracer(nothing);
  EXPECT_FALSE(tracer.intersect({}, {0, 0, -1}));
}

// The caller's geometry becomes another one: a tracer that only referred to it would lose its triangles.
TEST(RayTracerInvariant, OutlivesTheGeometryThatItWasGiven) {
  SceneGeometry scene = pyramids({}, true);
  const RayTracer tracer(scene);
  const CDVector start{0.1, 0.2, 5}, down{0, 0, -1};
  const Hit before = tracer.intersect(start, down);
  ASSERT_TRUE(before);
  scene = GeometryBuilder().build();
  const Hit after = tracer.intersect(start, down);
  EXPECT_EQ(after.t, before.t);
  EXPECT_EQ(after.normal, before.normal);
  EXPECT_EQ(tracer.geometry().triangles().size(), pyramids({}, true).triangles().size());
  EXPECT_NE(tracer.geometry().triangles().size(),
            scene.triangles().size());  // negative control
}

namespace {
/// A bush of leaves in all orientations, about a metre high: no edge is shared, so that a ray
/// near an edge has a single valid intersection.
Mesh bush(int leaves) {
  Mesh mesh;
  mesh.name = "bush";
  mesh.facets = {"inner", "outer"};
  mesh.materials = {"wood", "leaf"};
  Random random(5);
  for (int i = 0; i < leaves; ++i) {
    const CDVector c = randomDirection(random) * random.uniform();
    const auto n = static_cast<std::uint32_t>(mesh.vertices.size()), outer = i % 2u;
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(c + randomDirection(random) * 0.2 + CDVector{3, 2, 1});
    mesh.triangles.push_back({n, n + 1, n + 2, outer, outer});
  }
  return mesh;
}

/// Bushes in random places, every fourth a mirror image; written out, or shared.
SceneGeometry wood(const CDVector& at, bool shared) {
  const Mesh mesh = bush(200);
  GeometryBuilder builder;
  const std::uint32_t number = builder.share(mesh);
  Random random(6);
  for (int i = 0; i < 60; ++i) {
    Transform place = Transform::scale(0.5 + random.uniform());
    if (i % 4 == 0) place.x = -place.x;
    const CDVector axis = randomDirection(random);
    place = Transform::rotate(axis, 6 * random.uniform()).after(place);
    const CDVector where{20 * random.uniform(), 20 * random.uniform(), 3 * random.uniform()};
    place = Transform::translate(at + where).after(place);
    const std::string prefix = i % 2 ? "a." : "b.";
    const std::map<std::string, std::string> names{{"leaf", i % 3 ? "green" : "red"}};
    if (shared)
      builder.addInstance(number, place, prefix, names);
    else
      builder.addMesh(mesh, place, prefix, names);
  }
  builder.addGround(at.z - 4, "soil", "ground");
  return std::move(builder).build();
}
}  // namespace

// Corners are the same to rounding, and so are hits, wherever single precision finds the same triangle: about one ray in 10^4
// passes an edge within its reach. Rounding of a corner moves a hit by so much over the sine at which the ray meets the surface; the
// factor of 1000 is for leaves that are thin.
TEST(RayTracerIdentity, SharedMeshesAreMetAsMeshesThatAreWrittenOut) {
  for (const CDVector& at : {CDVector{}, CDVector{500000, 4000000, 120}}) {
    const RayTracer flat(wood(at, false)), shared(wood(at, true));
    ASSERT_EQ(shared.geometry().triangles().size(), 0u);
    ASSERT_EQ(shared.geometry().countTriangles(), flat.geometry().countTriangles());
    Random random(7);
    int apart = 0, met = 0, red = 0;
    for (int i = 0; i < 20000; ++i) {
      const CDVector o =
          at + CDVector{24 * random.uniform(), 24 * random.uniform(), 6 * random.uniform() - 3};
      const CDVector d = randomDirection(random);
      const Hit a = flat.intersect(o, d), b = shared.intersect(o, d);
      const auto name = [](const RayTracer& tracer, const Hit& hit) {
        return hit ? tracer.geometry().facetNames()[hit.facet] + " of " +
                         tracer.geometry().materialNames()[hit.material]
                   : "nothing";
      };
      met += b.instance != Hit::nothing, red += name(shared, b).ends_with("red");
      EXPECT_EQ(bool(b), shared.occluded(o, d));
      const double slack = 1000 * 0x1p-52 * (30 + at.getLength());
      const bool same = name(flat, a) == name(shared, b) &&
                        (!a || (std::abs(a.t - b.t) * -dot(a.normal, d) < slack &&
                                dot(a.normal, b.normal) > 1 - slack));
      apart += !same;
      if (same && b.instance != Hit::nothing) {
        EXPECT_EQ(a.triangle, b.instance * 200 + b.triangle);
      }
    }
    EXPECT_LE(apart, 20);
    EXPECT_GT(met, 2000);
    EXPECT_GT(red, 300);
  }
}

TEST(RayTracerInvariant, BundlesMeetSharedMeshesAsSingleRaysDo) {
  const RayTracer tracer(wood({}, true));
  Random random(8);
  int met_shared = 0;
  for (int i = 0; i < 1000; ++i) {
    RayBundle rays{};
    SunBundle suns;
    rays.origin = {20 * random.uniform(), 20 * random.uniform(), 4 * random.uniform()};
    rays.active = suns.active = static_cast<std::uint32_t>(random() & 0xffff);
    for (int k = 0; k < 16; ++k) {
      const CDVector d = randomDirection(random);
      rays.x[k] = float(d.x), rays.y[k] = float(d.y), rays.z[k] = float(d.z);
      suns.origin[k] = rays.origin, suns.direction[k] = {rays.x[k], rays.y[k], rays.z[k]};
    }
    std::array<Hit, 16> hits;
    const std::uint32_t met = tracer.intersect(rays, hits);
    std::array<std::uint32_t, 1> packed{};
    tracer.occluded(std::span(&rays, 1), packed);
    EXPECT_EQ(met, tracer.occluded(rays));
    EXPECT_EQ(met, tracer.occluded(suns));
    EXPECT_EQ(met, packed[0]);
    for (int k = 0; k < 16; ++k) {
      if (!(met >> k & 1)) continue;
      const Hit one = tracer.intersect(rays.origin, {rays.x[k], rays.y[k], rays.z[k]});
      EXPECT_EQ(one.t, hits[k].t);
      EXPECT_EQ(one.instance, hits[k].instance);
      met_shared += one.instance != Hit::nothing;
    }
  }
  EXPECT_GT(met_shared, 1000);
}

TEST(RayTracerInvariant, ARayThatLeavesASharedMeshDoesNotMeetItsTriangle) {
  const RayTracer tracer(wood({}, true));
  Random random(9);
  int left = 0, again = 0;
  for (int i = 0; i < 20000; ++i) {
    const CDVector o{24 * random.uniform(), 24 * random.uniform(), 6 * random.uniform()};
    const Hit hit = tracer.intersect(o, randomDirection(random));
    if (hit.instance == Hit::nothing) continue;
    const CDVector start = tracer.leave(hit);
    EXPECT_GT(dot(start - hit.point, hit.normal), 0);
    CDVector d = randomDirection(random);
    if (dot(d, hit.normal) < 0) d = -d;
    const Hit next = tracer.intersect(start, d);
    ++left, again += next.instance == hit.instance && next.triangle == hit.triangle;
  }
  EXPECT_GT(left, 1000);
  EXPECT_EQ(again, 0);
}
