// What facets see of sky, sun and each other (nw/render/FacetExchange.nw).
#include "malus/render/FacetExchange.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Worlds.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
// Zeros and ones at 1024 Sobol points: an independent draw would scatter by sqrt(.2 * .8 /
// 1024) = .0125; the points are placed more evenly, and a third of that is required.
constexpr double even = 0.004;
const Model any = matt(0.5);

double share(const FacetExchange& exchange, std::size_t from, std::size_t to) {
  for (const auto& seen : exchange.seen(from))
    if (seen.part == to) return seen.share;
  return 0;
}
double total(const FacetExchange& exchange, std::size_t part) {
  double sum = exchange.sky(part);
  for (const auto& seen : exchange.seen(part)) sum += seen.share;
  return sum;
}
}  // namespace

// Siegel and Howell, configurations of equal squares: opposed at the distance of their side, and with a common edge.
TEST(FacetExchangePublished, TwoSquares) {
  const Quad low{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, any};
  const World opposed = worldOf({low, {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}, any}});
  const RayTracer a(opposed.geometry);
  EXPECT_NEAR(share(FacetExchange(a), 0, 1), 0.19982, even);
  const World edge = worldOf({low, {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, any}});
  const RayTracer b(edge.geometry);
  EXPECT_NEAR(share(FacetExchange(b), 0, 1), 0.20004, even);
  EXPECT_NEAR(share(FacetExchange(b), 1, 0), 0.20004, even);
  EXPECT_NEAR(FacetExchange(b).sky(0), 1 - 0.20004, even);
}

TEST(FacetExchangeInvariant, SharesSumToOneAndAreReciprocal) {
  const World world = worldOf({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, any},
                               {{-1, -1, 1}, {-1, 2, 1}, {2, 2, 1}, {2, -1, 1}, any}});
  const RayTracer tracer(world.geometry);
  const FacetExchange exchange(tracer);
  EXPECT_NEAR(exchange.parts()[0].area_m2, 1, 1e-12);
  EXPECT_NEAR(exchange.parts()[1].area_m2, 9, 1e-12);
  EXPECT_NEAR(share(exchange, 0, 1), 9 * share(exchange, 1, 0), 9 * even);
  EXPECT_GT(share(exchange, 0, 1), 0.5);
  for (std::size_t part : {0, 1}) EXPECT_NEAR(total(exchange, part), 1, 1e-12);
}

TEST(FacetExchangeInvariant, AClosedRoomSeesNoSky) {
  const World world = worldOf({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, any},
                               {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}, any},
                               {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, any},
                               {{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}, any},
                               {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, any},
                               {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}, any}});
  const RayTracer tracer(world.geometry);
  const FacetExchange exchange(tracer);
  ASSERT_EQ(exchange.parts().size(), 6U);
  for (std::size_t part = 0; part < 6; ++part) {
    EXPECT_EQ(exchange.sky(part), 0);
    EXPECT_NEAR(total(exchange, part), 1, 1e-12);
    EXPECT_EQ(share(exchange, part, part), 0);
  }
}

TEST(FacetExchangeIdentity, AWallOnTheGroundSeesHalfOfEach) {
  GeometryBuilder builder;
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  mesh.facets = {"wall"}, mesh.materials = {"wall"};
  mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
  builder.addMesh(mesh, {});
  builder.addGround(0, "soil", "ground");
  const RayTracer tracer(std::move(builder).build());
  const FacetExchange exchange(tracer);
  ASSERT_EQ(exchange.parts().size(), 2U);
  EXPECT_NEAR(exchange.sky(0), 0.5, even);
  EXPECT_NEAR(share(exchange, 0, 1), 0.5, even);
  EXPECT_EQ(exchange.sky(1), 1);
  EXPECT_TRUE(std::isinf(exchange.parts()[1].area_m2));
  const CDVector sun = CDVector::fromAngles(1, 0);  // above +x, where the wall looks
  EXPECT_NEAR(exchange.sunlit(0, sun), std::sin(1), 1e-12);
  EXPECT_NEAR(exchange.sunlit(1, sun), std::cos(1), 1e-12);
  EXPECT_EQ(exchange.sunlit(0, CDVector{-sun.x, 0, sun.z}), 0);  // behind it
  EXPECT_EQ(exchange.sunlit(0, CDVector{sun.x, 0, -sun.z}), 0);  // night
}

// A roof over half of a floor, at noon: the floor's other half is lit. Negative control: without the roof all of it.
TEST(FacetExchangeIdentity, ARoofShadesHalf) {
  const Quad low{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, any};
  const World world = worldOf({low, {{0, 0, 1}, {0.5, 0, 1}, {0.5, 1, 1}, {0, 1, 1}, any}});
  const RayTracer tracer(world.geometry);
  const FacetExchange exchange(tracer);
  EXPECT_NEAR(exchange.sunlit(0, {0, 0, 1}), 0.5, 3.0 / 64);  // of 64 places
  EXPECT_EQ(exchange.sunlit(1, {0, 0, 1}), 1);
  const RayTracer bare(worldOf({low}).geometry);
  EXPECT_EQ(FacetExchange(bare).sunlit(0, {0, 0, 1}), 1);
}

// Two unit squares face each other at the distance of their side: each an instance, one of half its size and one turned over.
TEST(FacetExchangePublished, TwoSquaresOfSharedMeshes) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  mesh.facets = {"square"}, mesh.materials = {"any"};
  mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
  GeometryBuilder builder;
  const std::uint32_t number = builder.share(mesh);
  const Transform half = Transform::scale(0.5);
  const Transform over = Transform::rotate({1, 0, 0}, std::numbers::pi).after(half);
  builder.addInstance(number, half, "low.");
  builder.addInstance(number, Transform::translate({0, 1, 1}).after(over), "high.");
  // another pair far away, with the same names: the same two parts
  const Transform away = Transform::translate({20, 0, 0});
  builder.addInstance(number, away.after(half), "low.");
  builder.addInstance(number, away.after(Transform::translate({0, 1, 1}).after(over)), "high.");
  const RayTracer tracer(std::move(builder).build());
  const FacetExchange exchange(tracer);
  ASSERT_EQ(exchange.parts().size(), 2U);
  EXPECT_NEAR(exchange.parts()[0].area_m2, 2, 1e-12);
  EXPECT_NEAR(share(exchange, 0, 1), 0.19982, even);
  EXPECT_NEAR(share(exchange, 1, 0), 0.19982, even);
  EXPECT_NEAR(exchange.sky(0), 1 - 0.19982, even);
  EXPECT_EQ(exchange.sunlit(0, {0, 0, 1}), 0) << "the other square is above it";
  EXPECT_NEAR(exchange.sunlit(1, {0, 0, 1}), 0, 1e-12);
}
