// White furnaces for every sampling and number of rays, and the trial that warns of those that fail
// (nw/render/SamplingTrial.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/ImportanceSampling.hpp"
#include "malus/render/SamplingTrial.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/Emission.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
World plate(const Model& model) { return worldOf({floorOf(model)}, uniformSky(1)); }

// As bright everywhere as the uniform sky, without saying so: sampling by the sky's density has its turn.
class EvenSky : public Sky {
 public:
  EvenSky() : Sky(oneBand()) {}
  void radiance(const CDVector&, CDSpectralVector<CDStokesVector>& out) const override {
    out[0] = CDStokesVector(1);
  }
  bool polarized() const override { return false; }
  std::string description() const override { return "an even sky for tests"; }
};

struct Candidate {
  const char* name;
  RadiometryOptions options;
  bool grid;  // a fixed set of directions: may be biased, and must then be reported
};
const std::vector<Candidate>& candidates() {
  using enum Sampling;
  static const std::vector<Candidate> all{
      {"random, exact", {.sampling = random, .solid_angle = SolidAngle::exact}, false},
      {"random, equal", {.sampling = random, .solid_angle = SolidAngle::equal}, false},
      {"grid", {.sampling = grid}, true},
      {"grid-rotated", {.sampling = gridRotated}, true},
      {"adaptive", {.sampling = adaptive}, true},
      {"importance", {.sampling = importance}, false},
      {"importance without sobol", {.sampling = importance, .sobol = false}, false},
      {"importance without mis", {.sampling = importance, .mis = false}, false},
      {"importance, plain", {.sampling = importance, .sobol = false, .mis = false}, false}};
  return all;
}
const std::vector<int> counts{2,  3,  4,  5,  6,  7,  8,  9,  10, 11,  12,  13,  14,  15,  16,
                              17, 24, 25, 32, 33, 61, 64, 91, 92, 121, 122, 128, 129, 256, 400};

// Enough pixels for the mean of random directions to show one per cent, and a grid's turn to be averaged.
std::uint64_t pixelsFor(int rays) {
  return std::max<std::uint64_t>(16, 40000 / static_cast<std::uint64_t>(rays - 1));
}
const Radiometry::Ray aslant = looking({0.1, 0.2, 0}, {0.5, 0.2, 1}, {0, 1, 0});

bool reported(const World& world, const RadiometryOptions& options) {
  return trySampling(world, options).all_bounces > SamplingTrial::most_bias;
}
}  // namespace

// The criterion, before any number: |S0 - 1| <= 1 % (beside 5 standard errors of chance), or
// the user is warned. And no warning comes without cause: each reported scene is off by more
// than 1 %. The reported numbers themselves are means over turns.
TEST(FurnaceInvariant, AFlatWhiteCardIsWhiteOrReported) {
  const World world = plate(matt(1));
  std::size_t biased = 0;
  for (Candidate candidate : candidates())
    for (const int rays : counts) {
      candidate.options.rays = {rays};
      const Estimate seen = estimate(world, candidate.options, aslant, pixelsFor(rays));
      const double off = std::abs(seen.mean[0] - 1), chance = 5 * seen.error[0];
      if (reported(world, candidate.options)) {
        EXPECT_TRUE(candidate.grid) << candidate.name << " " << rays;
        EXPECT_GT(off, SamplingTrial::most_bias - chance) << candidate.name << " " << rays;
        ++biased;
      } else {
        EXPECT_LT(off, SamplingTrial::most_bias + chance) << candidate.name << " " << rays;
        EXPECT_LT(chance, 0.03) << "the comparison means something";
      }
    }
  EXPECT_GT(biased, 40u) << "negative control: the thesis's grids are biased with few rays";
}

// A grid of n zeniths up to the angle m sums, on a white card under a sky of one, to sin^2 m / cos(h / 2), h = m / n: chapter Radiometry's
// sum, ended early. 2e-6: single precision.
TEST(FurnaceIdentity, AGridHasTheZenithsAndTheLargestOneThatAreNamed) {
  const World world = plate(matt(1));
  for (const double largest : {30 * degree, 60 * degree, 90 * degree})
    for (const std::size_t zeniths : {1u, 2u, 5u, 9u})
      for (const Sampling sampling : {Sampling::grid, Sampling::gridRotated}) {
        const Estimate seen = estimate(
            world,
            {.sampling = sampling, .rays = {91}, .max_zenith_rad = largest, .zeniths = zeniths},
            aslant, 3);
        const double h = largest / double(zeniths);
        EXPECT_NEAR(seen.mean[0], std::pow(std::sin(largest), 2) / std::cos(h / 2), 2e-6)
            << largest / degree << " deg, " << zeniths << " zeniths";
      }
  const RadiometryOptions many{.sampling = Sampling::grid, .rays = {5}, .zeniths = 5};
  EXPECT_THROW(estimate(world, many, aslant, 1), MathError) << "four directions";
}

// A point that deviates by a triangular density of half width d h / 2 has the mean cosine of its middle times (sin(d h / 4) / (d h / 4))^2.
// The criterion: five standard errors of 20000 pixels, which must be small beside the effect.
TEST(FurnaceIdentity, PointsOfAGridDeviateFromTheMiddlesAsFarAsNamed) {
  const World world = plate(matt(1));
  const double h = pi / 4;
  const auto expected = [&](double deviation) {
    const double x = deviation * h / 4;
    return (x > 0 ? std::pow(std::sin(x) / x, 2) : 1) / std::cos(h / 2);
  };
  for (const Sampling sampling : {Sampling::grid, Sampling::gridRotated})
    for (const double deviation : {0.5, 1.0}) {
      const Estimate seen = estimate(
          world, {.sampling = sampling, .rays = {17}, .zeniths = 2, .deviation = deviation},
          aslant, 20000);
      EXPECT_NEAR(seen.mean[0], expected(deviation), 5 * seen.error[0]) << deviation;
      EXPECT_GT(seen.error[0], 1e-5) << "drawn anew at each hit";
      EXPECT_GT(std::abs(expected(deviation) - expected(0)), 8 * seen.error[0])
          << "negative control: a rigid grid would be noticed";
    }
}

// Random directions within 60 degrees find sin^2 60 = 3/4 of an even sky, and the trial reports it.
TEST(FurnaceIdentity, RandomDirectionsInAConeLeaveTheRestOut) {
  const World world = plate(matt(1));
  const RadiometryOptions cone{
      .sampling = Sampling::random, .rays = {65}, .max_zenith_rad = 60 * degree};
  const Estimate seen = estimate(world, cone, aslant, 2000);
  EXPECT_NEAR(seen.mean[0], 0.75, 5 * seen.error[0]);
  EXPECT_LT(5 * seen.error[0], 0.01);
  EXPECT_NEAR(trySampling(world, cone).found, 0.75, 1e-3) << "4000 directions: 3e-4";
  EXPECT_FALSE(reported(world, {.sampling = Sampling::random, .rays = {65}}));
}

// Directions from the cosine lobe make a white card white for every number of rays, to single precision.
TEST(FurnaceIdentity, ImportanceSamplingIsExactOnAWhiteCard) {
  for (const bool sobol : {true, false})
    for (const int rays : counts)
      EXPECT_NEAR(estimate(plate(matt(1)),
                           {.sampling = Sampling::importance, .rays = {rays}, .sobol = sobol},
                           aslant, 4)
                      .mean[0],
                  1, 1e-6)
          << rays;
}

// Half of the directions drawn from the sky: unbiased, and no more than that.
TEST(FurnaceInvariant, AnEvenSkyThatDoesNotSaySoIsEvenAsWell) {
  const World world = worldOf({floorOf(matt(1))}, std::make_shared<EvenSky>());
  for (const bool sobol : {true, false})
    for (const bool mis : {true, false})
      for (const int rays : {2, 3, 8, 17, 64, 91}) {
        const Estimate seen = estimate(
            world,
            {.sampling = Sampling::importance, .rays = {rays}, .sobol = sobol, .mis = mis},
            aslant, pixelsFor(rays));
        EXPECT_NEAR(seen.mean[0], 1, 5 * seen.error[0] + 1e-6) << rays << sobol << mis;
        EXPECT_LT(5 * seen.error[0], 0.02);
      }
}

// One to eight reflections in a white globe with a share a of its area open return 1 - (1 -
// a)^m of the sky. 7200 flat facets approximate the globe: 2e-3.
TEST(FurnaceInvariant, AHollowReturnsWhatItMustReflectionByReflection) {
  const double opening = 70 * degree, share = (1 - std::cos(opening)) / 2;
  const World world = globe(opening, matt(1));
  for (const Candidate& candidate : candidates()) {
    if (candidate.grid) continue;
    double left = 1;
    for (std::size_t m = 1; m <= 8; ++m) {
      left *= 1 - share;
      RadiometryOptions options = candidate.options;
      options.rays.assign(m, 2), options.rays[0] = 33;
      const Estimate seen = estimate(world, options, intoGlobe(), 400);
      EXPECT_NEAR(seen.mean[0], 1 - left, 5 * seen.error[0] + 2e-3) << candidate.name << m;
      if (m <= 3) {
        EXPECT_GT(std::abs(seen.mean[0] - 1 + left * (1 - share)), 5 * seen.error[0] + 2e-3)
            << "negative control: one reflection more; " << candidate.name << m;
      }
      EXPECT_FALSE(reported(world, options));
    }
  }
}

// A closed box whose walls reflect nine tenths and glow with the rest is black at every depth: after m reflections
// 1 - 0.9^(m+1) of the black body's light is there, the same from everywhere, so that a grid has no edge to miss. Its bias counts
// once for each reflection: 128 directions from every hit are off by 0.9 % each time, which no
// single plate shows. The
// criterion is that of the card.
TEST(FurnaceInvariant, AGlowingBoxUnderAGridIsRightOrReported) {
  constexpr double temperature_K = 6000, reflectance = 0.9;
  const Model wall = matt(reflectance);
  std::array<Model, 6> walls;
  walls.fill(wall);
  World box = worldOf(boxOf(walls));
  for (Material& material : box.materials)
    material.emission = std::make_shared<Emission>(*wall, temperature_K);
  const double black = planckRadiance(550, temperature_K);
  const Radiometry::Ray inside{
      {0.1, 0.05, 0}, normalized({0.2, 0.7, -0.5}), {1, 0, 0}, 0, 0, 0};
  const std::vector<std::vector<int>> lists{
      {2, 2},     {91, 2}, {33, 3, 2}, {129},
      {129, 129}, {500},   {500, 500}, {3, 2, 2, 2, 2, 2, 2, 2}};
  std::size_t right = 0, wrong = 0;
  for (const Candidate& candidate : candidates())
    for (const auto& rays : lists) {
      RadiometryOptions options = candidate.options;
      options.rays = rays;
      const double expected = black * (1 - std::pow(reflectance, double(rays.size()) + 1));
      const bool adaptive = options.sampling == Sampling::adaptive;
      if (adaptive && rays.size() > 2) continue;  // 24 directions from each hit, at least
      double paths = 1;
      for (const int count : rays) paths *= count - 1;
      const auto pixels =
          std::uint64_t(std::clamp(40000 / paths, adaptive ? 1.0 : 4.0, 2000.0));
      const Estimate seen = estimate(box, options, inside, pixels);
      const double off = std::abs(seen.mean[0] / expected - 1),
                   chance = 5 * seen.error[0] / expected;
      if (reported(box, options)) {
        EXPECT_TRUE(candidate.grid) << candidate.name;
        wrong += off > SamplingTrial::most_bias / 2;
      } else {
        EXPECT_LT(off, SamplingTrial::most_bias + chance)
            << candidate.name << rays[0] << rays.size();
        right += candidate.grid;
      }
    }
  EXPECT_GE(right, 6u) << "{129}, {500} and {500, 500} are right for both grids";
  EXPECT_GE(wrong, 8u) << "negative control: {2, 2}, {91, 2}, {33, 3, 2} and eight reflections "
                          "are wrong for both";
  EXPECT_TRUE(reported(box, {.sampling = Sampling::gridRotated, .rays = {129, 129}}));
  EXPECT_FALSE(reported(box, {.sampling = Sampling::gridRotated, .rays = {129}}));
}

// A groove of two white walls at a right angle: what is missing after eight reflections is less than 0.5^8.
TEST(FurnaceInvariant, AGrooveIsWhiteAfterEightReflections) {
  const World world = worldOf({{{-9, -9, 0}, {0, -9, 0}, {0, 9, 0}, {-9, 9, 0}, matt(1)},
                               {{0, -9, 0}, {0, -9, 9}, {0, 9, 9}, {0, 9, 0}, matt(1)}},
                              uniformSky(1));
  const auto ray = looking({-0.4, 0.1, 0}, {-0.6, 0.2, 1}, {0, 1, 0});
  RadiometryOptions options;
  options.rays = {17, 2, 2, 2, 2, 2, 2, 2};
  const Estimate seen = estimate(world, options, ray, 1000);
  EXPECT_NEAR(seen.mean[0], 1, 5 * seen.error[0] + std::pow(0.5, 8));
  options.rays = {17};
  EXPECT_LT(estimate(world, options, ray, 100).mean[0], 0.9)
      << "negative control: one reflection";
}

// A surface however smooth returns its directional hemispherical reflectance of an even sky, and tends to Fresnel's
// reflectance at its own zenith angle. The draws' weights are exact but for shadowing; 5 standard errors and single
// precision, 1e-5 (the rounding of a direction, 6e-8, beside the narrowest lobe that is gathered, 1e-5, squared, and sums).
TEST(FurnaceIdentity, SmoothSurfacesReflectTheSky) {
  for (const double sigma : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8})
    for (const double zenith : {0.0, 0.3, 0.98, 1.3}) {
      const Model glass = facets(1.5, 0, sigma);
      const double right = glass->getDHR(zenith).at(0);
      for (const bool even : {true, false}) {
        World world = plate(glass);
        if (!even) world.sky = std::make_shared<EvenSky>();
        const Estimate seen =
            estimate(world, {.sampling = Sampling::importance, .rays = {257}, .mis = false},
                     looking({0, 0, 0}, CDVector::fromAngles(zenith, 1), {0.3, 1, 0.2}), 100);
        EXPECT_NEAR(seen.mean[0], right, 5 * seen.error[0] + 1e-4 * right)
            << sigma << " " << zenith;
        EXPECT_LT(seen.error[0], 0.01 * right) << "the comparison means something";
      }
      const double c = std::cos(zenith),
                   t = std::sqrt(2.25 - std::sin(zenith) * std::sin(zenith));
      const double rs = (c - t) / (c + t), rp = (2.25 * c - t) / (2.25 * c + t);
      if (sigma <= 1e-3) {
        EXPECT_NEAR(right, (rs * rs + rp * rp) / 2, 1e-4) << sigma << " " << zenith;
      }
    }
}

// A smooth floor beside a matt wall shows the wall: the light that the wall sends along the mirrored ray, times Fresnel's
// reflectance, polarised across the plane of incidence.
TEST(FurnaceIdentity, SmoothSurfacesReflectTheirNeighbours) {
  const Quad wall{{1, -40, 0}, {1, -40, 60}, {1, 40, 60}, {1, 40, 0}, matt(0.6)};
  const double zenith = 0.9, c = std::cos(zenith), t = std::sqrt(2.25 - 1 + c * c);
  const double rs = std::pow((c - t) / (c + t), 2),
               rp = std::pow((2.25 * c - t) / (2.25 * c + t), 2);
  const CDVector viewer{-std::sin(zenith), 0, c}, mirrored{std::sin(zenith), 0, c};
  for (const double sigma : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    World world = worldOf({floorOf(facets(1.5, 0, sigma), 60), wall}, uniformSky(1));
    RadiometryOptions options;
    options.rays = {33, 17};
    const Estimate mirror =
        estimate(world, options, looking({0, 0, 0}, viewer, {0, 1, 0}, 0, 0.5), 400);
    options.rays = {1025};
    const Radiometry::Ray direct{{0, 0, 1e-3}, mirrored, {0, 1, 0}, 0, 0, 0};
    const Estimate seen = estimate(world, options, direct, 16);
    const double size = seen.mean[0] * (rs + rp) / 2;
    EXPECT_NEAR(mirror.mean[0], size,
                5 * std::hypot(mirror.error[0], seen.error[0]) + 3e-3 * size)
        << sigma;
    EXPECT_NEAR(mirror.mean[1], seen.mean[0] * (rs - rp) / 2,
                5 * std::hypot(mirror.error[1], seen.error[0]) + 3e-3 * size)
        << sigma;
    EXPECT_LT(seen.mean[0], 0.7) << "negative control: the sky is brighter than the wall";
  }
}

// What a fixed set of directions cannot see is named; what it can see is not.
TEST(FurnaceInvariant, ANarrowLobeIsRefusedToDirectionsThatMissIt) {
  const auto trial = [](double sigma, Sampling sampling, int rays) {
    return trySampling(plate(facets(1.5, 0, sigma)), {.sampling = sampling, .rays = {rays}});
  };
  for (const Sampling sampling :
       {Sampling::random, Sampling::grid, Sampling::gridRotated, Sampling::adaptive}) {
    EXPECT_EQ(trial(1e-3, sampling, 91).unseen, "0") << int(sampling);
    EXPECT_EQ(trial(1e-6, sampling, 91).unseen, "0") << int(sampling);
    EXPECT_EQ(trial(0.2, sampling, 91).unseen, "") << int(sampling);
  }
  for (const double sigma : {0.2, 1e-3, 1e-8}) {
    EXPECT_EQ(trial(sigma, Sampling::importance, 2).unseen, "");
    EXPECT_EQ(trial(sigma, Sampling::importance, 2).all_bounces, 0);
  }
  EXPECT_GT(trial(0.1, Sampling::gridRotated, 7).all_bounces, 0.01);
  EXPECT_LT(trial(0.2, Sampling::gridRotated, 2001).all_bounces, 0.01);
}

// The trial looks from 0, 15, ... 75 degrees, and names the one at which a grid is worst.
TEST(FurnaceIdentity, TheTrialNamesTheViewerItLookedFrom) {
  int oblique = 0;
  for (const int rays : {9, 33, 91}) {
    const SamplingTrial trial =
        trySampling(plate(facets(1.5, 0, 0.3)), {.sampling = Sampling::grid, .rays = {rays}});
    const double zenith_deg = trial.zenith_rad / degree;
    EXPECT_NEAR(zenith_deg, 15 * std::round(zenith_deg / 15), 1e-9);
    EXPECT_LE(zenith_deg, 75 + 1e-9);
    oblique += zenith_deg > 1;
  }
  EXPECT_GT(oblique, 0) << "negative control: rough glass is not worst from above every time";
}
