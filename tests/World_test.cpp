// The parts of a world, and what must hold between them (nw/scene/World.nw).
#include "malus/scene/World.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "malus/air/RayleighSky.hpp"
#include "malus/base/Error.hpp"
#include "malus/render/Radiometry.hpp"
#include "malus/surface/BRDFDiffuse.hpp"

using namespace malus;
using std::numbers::pi;

namespace {
constexpr double rounding = 1e-14;  // a dozen operations on numbers below one

// the listing of the chapter
World smallWorld() {
  World world;
  world.grid = SpectralGrid::make({550.0});
  GeometryBuilder builder;
  builder.addGround(0, "soil", "ground");
  world.geometry = std::move(builder).build();
  const CDSpectralVector<double> reflectance(world.grid, 0.5);
  world.materials = {{"soil", std::make_shared<BRDFDiffuse>(reflectance)}};
  world.sun = Sun{compassDirection(pi / 3, pi), {world.grid, CDStokesVector(2.0)}, 0};
  world.sky = blackSky(world.grid);
  return world;
}

double seenAlong(const World& world, const CDVector& direction,
                 const CDVector& eye = {0, 0, 1}) {
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), {});
  const Radiometry::Ray ray{eye, normalized(direction), {0, 1, 0}, 0, 0, 0};
  std::array<double, 4> out{};
  radiometry.radiance({&ray, 1}, out);
  return out[0];
}
double seenFrom(const World& world, const CDVector& eye) { return seenAlong(world, -eye, eye); }

// What check() says about a small world with one part spoiled; "" if nothing.
std::string complaint(const std::function<void(World&)>& spoil) {
  World world = smallWorld();
  world.check();
  spoil(world);
  try {
    world.check();
  } catch (const MathError& error) {
    return error.what();  // a GridError is one, too
  }
  return "";
}
bool names(const std::string& sentence, const std::string& part) {
  return sentence.find(part) != std::string::npos;
}
struct BlackSkyWithDisk final : Sky {
  explicit BlackSkyWithDisk(Sun sun) : Sky(SpectralGrid::make({550.0})), sun_(std::move(sun)) {}
  void radiance(const CDVector&, CDSpectralVector<CDStokesVector>& out) const override {
    out = CDSpectralVector<CDStokesVector>(grid(), CDStokesVector(0.0));
  }
  bool polarized() const override { return false; }
  std::string description() const override { return "black sky with a disk"; }
  const Sun* disk() const override { return &sun_; }
  Sun sun_;
};

SpectralGridPtr otherGrid() { return SpectralGrid::make({650.0}); }
}  // namespace

TEST(WorldIdentity, TheSmallWorldLooksAsTheChapterSays) {
  World world = smallWorld();
  for (const CDVector& eye :
       {CDVector{0, 0, 1}, CDVector{300, 0, 1000}, CDVector{-0.2, 0.7, 0.1}})
    EXPECT_NEAR(seenFrom(world, eye), 1 / (2 * pi), rounding);
  world.sun->to_sun = compassDirection(pi / 3 + 1e-6, pi);  // the control: a sun a little lower
  EXPECT_GT(std::abs(seenFrom(world, {0, 0, 1}) - 1 / (2 * pi)), rounding);
}

TEST(WorldIdentity, PartsThatAreMissingAreNamed) {
  EXPECT_EQ(complaint([](World&) {}), "");  // the control
  EXPECT_EQ(complaint([](World& world) { world.sun.reset(); }), "");
  EXPECT_TRUE(names(complaint([](World& world) { world.grid = nullptr; }), "spectral grid"));
  EXPECT_TRUE(names(complaint([](World& world) { world.sky = nullptr; }), "a black one"));
  EXPECT_TRUE(names(complaint([](World& world) { world.materials.clear(); }),
                    "names 1 materials, the world has 0"));
  EXPECT_TRUE(
      names(complaint([](World& world) { world.materials.push_back(world.materials[0]); }),
            "names 1 materials, the world has 2"));
  EXPECT_TRUE(names(complaint([](World& world) { world.materials[0].brdf = nullptr; }),
                    "no BRDF for the material soil"));
}

TEST(WorldIdentity, PartsOnAnotherGridAreRefused) {
  const std::string grids = "different grids";
  EXPECT_TRUE(names(complaint([](World& world) { world.grid = otherGrid(); }), grids));
  EXPECT_TRUE(names(complaint([](World& world) { world.sky = blackSky(otherGrid()); }), grids));
  EXPECT_TRUE(names(complaint([](World& world) {
                      world.sun->irradiance = {otherGrid(), CDStokesVector(2.0)};
                    }),
                    grids));
  EXPECT_TRUE(names(complaint([](World& world) {
                      world.materials[0].brdf = std::make_shared<BRDFDiffuse>(
                          CDSpectralVector<double>(otherGrid(), 0.5));
                    }),
                    grids));
}

// Over the small world is a second sun: a ray into it has its radiance, a ray beside it none.
TEST(WorldIdentity, ADiskInTheSkyIsSeenAndCheckedLikeASun) {
  const World small = smallWorld();
  const auto with = [&](double half_angle_rad, const SpectralGridPtr& grid) {
    return complaint([&](World& world) {
      world.sky = std::make_shared<BlackSkyWithDisk>(
          Sun{{0, 0, 1}, {grid, CDStokesVector(2.0)}, half_angle_rad});
    });
  };
  EXPECT_EQ(with(0.1, small.grid), "");  // the control
  EXPECT_TRUE(names(with(0, small.grid), "the sun's disk in the sky"));
  EXPECT_TRUE(names(with(2, small.grid), "half angle"));
  EXPECT_TRUE(names(with(0.1, otherGrid()), "different grids"));
  World world = small;
  world.sky = std::make_shared<BlackSkyWithDisk>(
      Sun{{0, 0, 1}, {small.grid, CDStokesVector(2.0)}, 0.1});
  const double radiance = 2 / (pi * std::sin(0.1) * std::sin(0.1));
  EXPECT_NEAR(seenAlong(world, {std::sin(0.09), 0, std::cos(0.09)}), radiance,
              1e-12 * radiance);
  EXPECT_EQ(seenAlong(world, {std::sin(0.11), 0, std::cos(0.11)}), 0.0);
}

TEST(WorldIdentity, ASunThatIsNotPhysicalIsRefused) {
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  const auto towards = [](const CDVector& to_sun) {
    return complaint([&](World& world) { world.sun->to_sun = to_sun; });
  };
  EXPECT_EQ(towards({0.6, 0, 0.8}), "");  // the control
  for (const CDVector& bad :
       {CDVector{0, 0, 0}, CDVector{0.6, 0, 0.81}, CDVector{0, 0, not_a_number}})
    EXPECT_TRUE(names(towards(bad), "not a unit vector"));
  const auto wide = [](double half_angle_rad) {
    return complaint([&](World& world) { world.sun->half_angle_rad = half_angle_rad; });
  };
  EXPECT_EQ(wide(0), "");  // a point
  for (const double bad : {-0.001, pi / 2, not_a_number})
    EXPECT_TRUE(names(wide(bad), "half angle"));
  const auto bright = [](const CDStokesVector& light) {
    return complaint([&](World& world) { world.sun->irradiance[0] = light; });
  };
  EXPECT_EQ(bright(CDStokesVector(2, 0, 0, -2)), "");  // behind a polariser
  for (const CDStokesVector& bad :
       {CDStokesVector(-1), CDStokesVector(not_a_number), CDStokesVector(2, 1.5, 1.5, 0)})
    EXPECT_TRUE(names(bright(bad), "at 550 nm is not physical"));
}

// By hand: a sun of 2 at 60 degrees contributes 1, and a sky of 0.3 everywhere 0.3 pi. At night
// nothing comes from the
// sun. The Rayleigh sky's own flux is an integral over depth, not over directions; the sky's table is good for 2e-6 (RayleighSky_test) and the rule of 32 points for 1e-6.
TEST(WorldIdentity, WhatFallsOnTheGround) {
  World world = smallWorld();
  EXPECT_NEAR(horizontalIrradiance(world)[0], 1, rounding);
  world.sky = std::make_shared<UniformSky>(
      CDSpectralVector<CDStokesVector>(world.grid, CDStokesVector(0.3)));
  EXPECT_NEAR(horizontalIrradiance(world)[0], 1 + 0.3 * pi, rounding);
  world.sun->to_sun = compassDirection(2, pi);
  EXPECT_NEAR(horizontalIrradiance(world)[0], 0.3 * pi, rounding);
  for (const double depth : {0.05, 0.3, 2.0})
    for (const double zenith : {0.0, 1.0, 1.5}) {
      const Sun sun{compassDirection(zenith, 1), {world.grid, CDStokesVector(2.0)}, 0};
      const auto sky = std::make_shared<RayleighSky>(
          sun, RayleighSky::Air{{world.grid, depth}, {world.grid, 0.03}, {world.grid, 0.25}});
      world.sky = sky;
      world.sun.reset();
      EXPECT_NEAR(horizontalIrradiance(world)[0] / sky->light(0).diffuseDown(), 1, 3e-6)
          << depth << ' ' << zenith;
    }
}
