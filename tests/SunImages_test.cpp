// Directions drawn where flat facets mirror the sun (nw/render/SunImages.nw).
#include "malus/render/SunImages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "ChiSquared.hpp"
#include "Worlds.hpp"
#include "malus/base/Random.hpp"
#include "malus/render/Renderer.hpp"
#include "malus/thesis/XSampling.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

Model copper(double sigma) { return facets(0.405, 2.95, sigma, DiffuseTerm::thesis); }

constexpr int cells = 64;
constexpr double side = 5.5,
                 cell =
                     2 * side / cells;  // standard deviations; cuts are at the sides of cells

struct Counted {
  double p_value, integral;
};

/// Draws from a bunch in 64 x 64 cells over its plane, against the claimed density integrated by the midpoint rule over the
/// cells' solid angles.
Counted count(const Bunch& drawn, const Bunch& claimed) {
  constexpr int fine = 8;
  std::vector<double> probability(cells * cells);
  double integral = 0;
  for (int i = 0; i < cells * fine; ++i)
    for (int j = 0; j < cells * fine; ++j) {
      const double a = side * (2 * (i + 0.5) / (cells * fine) - 1);
      const double b = side * (2 * (j + 0.5) / (cells * fine) - 1);
      const CDVector there = drawn.axis() + drawn.u() * a + drawn.v() * b;
      const double length = there.getLength(), step = 2 * side / (cells * fine);
      const double sr = drawn.area() * step * step / (length * length * length);
      const double share = claimed.density(there * (1 / length)) * sr;
      probability[i / fine * cells + j / fine] += share, integral += share;
    }
  std::vector<std::size_t> counts(probability.size());
  Random random(5);
  constexpr std::size_t draws = 400000;
  for (std::size_t i = 0; i < draws; ++i) {
    const CDVector d = drawn.sample(random.uniform(), random.uniform());
    const double along = dot(d, drawn.axis());
    const double a = dot(d, drawn.toA()) / along, b = dot(d, drawn.toB()) / along;
    ++counts[static_cast<std::size_t>((a / side + 1) / 2 * cells) * cells +
             static_cast<std::size_t>((b / side + 1) / 2 * cells)];
  }
  return {chiSquaredPValue(counts, probability, draws), integral};
}

Bunch slanted() {
  const CDVector axis = normalized(CDVector{0.3, -0.4, 0.8});
  const CDVector x = normalized(cross(axis, CDVector{0, 0, 1})), y = cross(axis, x);
  return Bunch(axis, x * 0.3 + y * 0.2, y * 0.25);
}

/// A place on the floor that looks at the wall of a world as in `wallWorld`.
std::vector<Bunch> seenFromFloor(const World& world, const CDVector& at,
                                 const CDVector& viewer) {
  std::vector<Bunch> bunches;
  const SurfaceAxes axes({0, 0, 1});
  SunImages(world).seenFrom(at, axes, *world.materials[0].brdf, axes.toLocal(viewer),
                            RayTracer(world.geometry), bunches);
  return bunches;
}

/// A floor and a vertical wall at x = 1, which faces west; the sun is 30 degrees from the
/// zenith in the west.
World wallWorld(const Model& floor, const Model& wall) {
  World world = worldOf({floorOf(floor), {{1, -1, 0}, {1, -1, 3}, {1, 1, 3}, {1, 1, 0}, wall}},
                        uniformSky(0.05));
  world.sun.emplace(Sun{{-0.5, 0, std::sqrt(0.75)}, spectrumOf(3.0)});
  return world;
}

RadiometryOptions drawing(std::vector<int> rays, bool images, std::uint64_t seed = 1) {
  RadiometryOptions options;
  options.rays = std::move(rays), options.images = images, options.seed = seed;
  return options;
}

/// Plates of several models about the origin, leaning at random, over a floor.
World plates(Random& random) {
  const auto any = [&](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  const auto model = [&]() -> Model {
    const double kind = random.uniform();
    if (kind < 0.2) return matt(0.5);
    if (kind < 0.6) return copper(any(0.1, 0.35));
    return facets(1.5, 0, any(0.1, 0.3), DiffuseTerm::none);
  };
  std::vector<Quad> quads{floorOf(copper(any(0.1, 0.4)), 3)};
  for (int i = 0; i < 5; ++i) {
    const double azimuth = 2 * pi * (i + random.uniform()) / 5, lean = any(-0.3, 0.5);
    const CDVector out{std::cos(azimuth), std::sin(azimuth), 0}, along{-out.y, out.x, 0};
    const CDVector foot = out * any(0.6, 1.2),
                   up = out * std::sin(lean) + CDVector{0, 0, std::cos(lean)};
    const double half = any(0.3, 0.8), height = any(0.5, 1.5);
    quads.push_back({foot - along * half, foot + along * half,
                     foot + along * half + up * height, foot - along * half + up * height,
                     model()});
  }
  World world = worldOf(quads, uniformSky(any(0.01, 0.3)));
  world.sun.emplace(Sun{CDVector::fromAngles(any(0.1, 0.6), any(0, 6)), spectrumOf(3.0)});
  world.sun->half_angle_rad = random.uniform() < 0.5 ? 0 : 0.005;
  return world;
}

double deviation(const Estimate& a, const Estimate& b) {
  double largest = 0;
  for (std::size_t c = 0; c < 4; ++c)
    largest =
        std::max(largest, std::abs(a.mean[c] - b.mean[c]) / std::hypot(a.error[c], b.error[c]));
  return largest;
}
}  // namespace

// A p-value of 1e-4 in four tests is a false alarm in two thousand five hundred.
TEST(SunImagesIdentity, BunchesAreDrawnWithTheirDensity) {
  Bunch whole = slanted(), cut = slanted(), tail = slanted();
  ASSERT_TRUE(cut.cut({-4 * cell, 9 * cell}, {-12 * cell, 2 * cell}));
  ASSERT_TRUE(tail.cut({7 * cell, 17 * cell}, {-29 * cell, -3 * cell}));
  for (const Bunch& bunch : {whole, cut, tail}) {
    const Counted counted = count(bunch, bunch);
    EXPECT_GT(counted.p_value, 1e-4);
    EXPECT_NEAR(counted.integral, 1, 1e-4);  // the midpoint rule
  }
  Bunch wrong = slanted();
  ASSERT_TRUE(wrong.cut({-4 * cell, 9 * cell}, {-12 * cell, 3 * cell}));
  EXPECT_LT(count(cut, wrong).p_value, 1e-4) << "negative control";
}

// What a bunch is made with is what the cut to its ends computes.
TEST(SunImagesIdentity, ABunchIsMadeWholeAndTurnsInItself) {
  Bunch cut = slanted(), turned = slanted();
  ASSERT_TRUE(cut.cut({-5, 5}, {-5, 5}));
  EXPECT_DOUBLE_EQ(cut.kept(), slanted().kept());
  turned.turn(std::cos(0.7), std::sin(0.7));
  EXPECT_GT((turned.u() - slanted().u()).getLength(), 0.1);
  for (const auto& [a, b] : {std::pair{0.3, -1.2}, {2.0, 0.1}, {-1.5, 2.5}}) {
    const CDVector at = normalized(slanted().axis() + slanted().u() * a + slanted().v() * b);
    const double density = slanted().density(at);
    EXPECT_NEAR(cut.density(at), density, 1e-12 * density);
    EXPECT_NEAR(turned.density(at), density, 1e-12 * density);
  }
  ASSERT_TRUE(cut.cut({-5, 4}, {-5, 5}));
  EXPECT_LT(cut.kept(), slanted().kept() - 1e-5) << "negative control";
}

TEST(SunImagesIdentity, ACutThatLeavesNothingIsNoBunch) {
  Bunch bunch = slanted();
  EXPECT_FALSE(bunch.cut({4.5, 6}, {-1, 1}));
  EXPECT_TRUE(bunch.cut({-1, 1}, {-1, 1}));
}

// Equation image: in a wall that faces west the image of the sun in the west is in the east, at
// the same height.
TEST(SunImagesPublished, AWallShowsTheSunWhereAMirrorDoes) {
  const World world = wallWorld(matt(0.5), copper(0.1));
  EXPECT_EQ(SunImages(world).mirrors(), 1u);
  const auto bunches = seenFromFloor(world, {0.5, 0, 0}, {0, 0, 1});
  ASSERT_EQ(bunches.size(), 1u);
  const CDVector image{0.5, 0, std::sqrt(0.75)};
  EXPECT_NEAR(bunches[0].axis().x, image.x, 1e-12);
  EXPECT_NEAR(bunches[0].axis().z, image.z, 1e-12);
  EXPECT_GT(bunches[0].share, 0.1);
  EXPECT_LE(bunches[0].share, 0.75);
  // behind the wall, and where the image is far below the wall's foot
  EXPECT_TRUE(seenFromFloor(world, {1.5, 0, 0}, {0, 0, 1}).empty());
  EXPECT_TRUE(seenFromFloor(world, {-9, 0, 0}, {0, 0, 1}).empty());
}

// A floor with its own lobe, seen from where it mirrors the image: both lobes have their middle
// there.
TEST(SunImagesIdentity, TwoLobesThatAgreeMeetInTheirMiddle) {
  const World world = wallWorld(copper(0.2), copper(0.1));
  const CDVector viewer{-0.5, 0, std::sqrt(0.75)};
  const auto bunches = seenFromFloor(world, {0.5, 0, 0}, viewer);
  ASSERT_EQ(bunches.size(), 1u);
  EXPECT_NEAR(bunches[0].axis().x, 0.5, 1e-9);
  EXPECT_NEAR(bunches[0].axis().y, 0, 1e-9);
  // seen from elsewhere they meet between the two
  const auto between = seenFromFloor(world, {0.5, 0, 0}, normalized(CDVector{-0.2, 0, 1}));
  ASSERT_EQ(between.size(), 1u);
  EXPECT_GT(between[0].axis().x, 0.2);
  EXPECT_LT(between[0].axis().x, 0.5);
}

TEST(SunImagesIdentity, NoMirrorsWithoutASunOrALobe) {
  World world = wallWorld(matt(0.5), matt(0.5));
  EXPECT_EQ(SunImages(world).mirrors(), 0u);
  world = wallWorld(matt(0.5), copper(0.1));
  world.sun.reset();
  EXPECT_EQ(SunImages(world).mirrors(), 0u);
}

// Ten worlds, four components each: 5 standard errors are 2e-5 of false alarm for all.
TEST(SunImagesInvariant, TenWorldsHaveTheMeansOfRandomDirections) {
  Random random(2002);
  int with_mirrors = 0;
  for (int i = 0; i < 10; ++i) {
    World world = plates(random);
    with_mirrors += SunImages(world).mirrors() > 1;
    const Radiometry::Ray ray = looking({0.1, -0.1, 0}, {0.3, 0.2, 1.2}, {1, 0, 0});
    RadiometryOptions judge;
    judge.sampling = Sampling::random;
    judge.rays = {2001, 1}, judge.seed = 77;
    const Estimate brute = estimate(world, judge, ray, 1000);
    EXPECT_LT(deviation(estimate(world, drawing({17, 1}, true), ray, 4000), brute), 5.0) << i;
    world.sun->irradiance = spectrumOf(3.6);
    EXPECT_GT(deviation(estimate(world, drawing({17, 1}, true), ray, 4000), brute), 5.0)
        << "negative control " << i;
  }
  EXPECT_GE(with_mirrors, 8);
}

// A rough copper floor before a copper wall: most of the noise is the sun in the wall.
TEST(SunImagesInvariant, TheErrorIsLessThanHalf) {
  const World world = wallWorld(copper(0.2), copper(0.15));
  const Radiometry::Ray ray = looking({0.4, 0.1, 0}, {-0.3, 0, 1}, {0, 1, 0});
  const double with = estimate(world, drawing({9, 1}, true), ray, 2000).error[0];
  const double without = estimate(world, drawing({9, 1}, false), ray, 2000).error[0];
  EXPECT_LT(with, without / 2);
}

// More mirrors than are looked at: the picture is that without images, to the bit.
TEST(SunImagesInvariant, TooManyMirrorsAreNotLookedAt) {
  const auto steps = [](int count) {
    std::vector<Quad> quads{floorOf(copper(0.2), 3)};
    for (int i = 0; i < count; ++i) {
      const double y = -2 + 0.1 * i;
      quads.push_back({{1, y, 0},
                       {1 + 0.01 * i, y, 1},
                       {1 + 0.01 * i, y + 0.1, 1},
                       {1, y + 0.1, 0},
                       copper(0.1)});
    }
    World world = worldOf(quads, uniformSky(0.1));
    world.sun.emplace(Sun{{-0.5, 0, std::sqrt(0.75)}, spectrumOf(3.0)});
    return world;
  };
  const Radiometry::Ray ray = looking({0.4, 0.1, 0}, {-0.3, 0, 1}, {0, 1, 0});
  const World few = steps(20), many = steps(40);
  EXPECT_EQ(SunImages(few).mirrors(), 21u);
  EXPECT_EQ(SunImages(many).mirrors(), 0u);
  const auto mean = [&](const World& world, bool images) {
    return estimate(world, drawing({9, 1}, images), ray, 10).mean;
  };
  EXPECT_EQ(mean(many, true), mean(many, false));
  EXPECT_NE(mean(few, true), mean(few, false));  // negative control
}

// The bowl has more facets than are looked at, and the bits of a picture without images; the others have not.
TEST(SunImagesInvariant, ShippedScenesAreLookedAtAsTheyShould) {
  const auto bits = [](Scene scene, bool images) {
    scene.radiometry.images = images;
    return renderScene(scene).stokes;
  };
  for (const auto& [name, mirrors] :
       {std::pair{"varnish", 2u}, {"copper-bowl", 0u}, {"canyon", 8u}}) {
    const Scene scene = sceneWithMirrors(name, 16);
    EXPECT_EQ(SunImages(scene.world).mirrors(), mirrors) << name;
    EXPECT_EQ(bits(scene, true) == bits(scene, false), mirrors == 0) << name;
  }
}

// Two scenes, four components: five standard errors of 32 pictures are a false alarm in a thousand runs at most (the
// deviations are Student's with about 60 degrees of freedom).
TEST(SunImagesInvariant, ShippedScenesHaveTheMeansOfThoseWithoutImages) {
  for (const char* name : {"varnish", "canyon"}) {
    Scene scene = sceneWithMirrors(name, 16);
    const ImagesTrial without = tryImages(scene, false, 32), with = tryImages(scene, true, 32);
    EXPECT_LT(standardErrorsApart(without, with), 5) << name;
    EXPECT_LT(with.picture, without.picture) << name;
    EXPECT_LT(with.pixels, without.pixels) << name;
    scene.world.sun->irradiance *= 1.05;
    EXPECT_GT(standardErrorsApart(without, tryImages(scene, true, 32)), 5)
        << "negative control: a brighter sun, " << name;
  }
}
