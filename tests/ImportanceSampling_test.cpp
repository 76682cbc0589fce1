// Directions drawn where the light comes from (nw/render/ImportanceSampling.nw).
#include "malus/render/ImportanceSampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Worlds.hpp"
#include "malus/render/HemisphereRays.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

Model copper(double sigma) { return facets(0.405, 2.95, sigma, DiffuseTerm::thesis); }

// Copper whose density claims three per cent too much.
class WrongDensity : public BRDFTorranceSparrow {
 public:
  using BRDFTorranceSparrow::BRDFTorranceSparrow;
  BRDFSample sample(const CDVector& given, double u1, double u2, double u3) const override {
    BRDFSample drawn = BRDFTorranceSparrow::sample(given, u1, u2, u3);
    drawn.density_per_sr *= 1.03;
    return drawn;
  }
  double density(const CDVector& given, const CDVector& sampled) const override {
    return 1.03 * BRDFTorranceSparrow::density(given, sampled);
  }
};

// Polarised, brighter in the west, with a bright spot of a tenth of a radian about `spot`, and a sampler that
// prefers the spot.
class SpottedSky : public Sky {
 public:
  explicit SpottedSky(double brightness) : Sky(oneBand()), brightness_(brightness) {}
  void radiance(const CDVector& d, CDSpectralVector<CDStokesVector>& out) const override {
    const double s0 = 1 - 0.5 * d.x + (dot(d, spot) > cosine ? brightness_ : 0);
    out[0] = CDStokesVector(s0, 0.3 * s0 * d.x, 0.4 * s0 * d.y, 0.1 * s0 * d.x * d.y);
  }
  bool polarized() const override { return true; }
  std::string description() const override { return "a sky for tests"; }
  Sample sample(double u1, double u2) const override {
    if (u1 >= 0.5) {
      const Sample plain = Sky::sample(2 * u1 - 1, u2);
      return {plain.to_sky, density(plain.to_sky)};
    }
    const double z = 1 - 2 * u1 * (1 - cosine), radius = std::sqrt(1 - z * z);
    const SurfaceAxes axes(spot);
    const CDVector d =
        axes.toWorld({radius * std::cos(2 * pi * u2), radius * std::sin(2 * pi * u2), z});
    return {d, density(d)};
  }
  double density(const CDVector& d) const override {
    return 0.5 * Sky::density(d) + (dot(d, spot) > cosine ? 0.5 / (2 * pi * (1 - cosine)) : 0);
  }

 private:
  static constexpr CDVector spot{0.48, 0.6, 0.64};
  static constexpr double cosine = 0.995;
  double brightness_;
};

// A floor and a steep wall beside it, both 2 m wide.
World corner(std::shared_ptr<const CDBRDFModel> floor, std::shared_ptr<const CDBRDFModel> wall,
             std::shared_ptr<const Sky> sky) {
  World world = worldOf({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, floor},
                         {{1, -1, 0}, {1.4, -1, 1.5}, {1.4, 1, 1.5}, {1, 1, 0}, wall}},
                        std::move(sky));
  world.sun.emplace(Sun{normalized(CDVector{-0.5, 0.2, 0.8}), spectrumOf(3.0)});
  return world;
}

RadiometryOptions importance(std::vector<int> rays, bool sobol = true, bool mis = true) {
  RadiometryOptions options;
  options.sampling = Sampling::importance;
  options.rays = std::move(rays), options.sobol = sobol, options.mis = mis;
  return options;
}

RadiometryOptions atRandom(std::vector<int> rays) {
  RadiometryOptions options;
  options.sampling = Sampling::random;
  options.rays = std::move(rays), options.seed = 77;
  return options;
}

// The largest deviation of two estimates in standard errors, over the four components.
double deviation(const Estimate& a, const Estimate& b) {
  double largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const double error = std::hypot(a.error[c], b.error[c]);
    largest = std::max(largest, std::abs(a.mean[c] - b.mean[c]) / error);
  }
  return largest;
}

const Radiometry::Ray corner_ray = looking({0.6, 0.1, 0}, {-0.5, 0.1, 0.8}, {0, -1, 0.1});
}  // namespace

// Ten comparisons of four components: 40 tests at one in a million all told are 5.5 standard errors each. Random
// directions with exact solid angles are unbiased by construction, so they are the judge.
constexpr double five_and_a_half = 5.5;

TEST(ImportanceSamplingInvariant, MeansAreThoseOfRandomDirections) {
  const auto sky = std::make_shared<SpottedSky>(20);
  for (const double sigma : {0.1, 0.3}) {
    const World world = corner(copper(sigma), copper(0.2), sky);
    const Estimate random = estimate(world, atRandom({2001, 1}), corner_ray, 100);
    for (const bool sobol : {false, true})
      for (const bool mis : {false, true}) {
        const Estimate ours =
            estimate(world, importance({34, 1}, sobol, mis), corner_ray, 1500);
        EXPECT_LT(deviation(ours, random), five_and_a_half)
            << sigma << " " << sobol << " " << mis;
        EXPECT_GT(std::abs(random.mean[3]), 10 * random.error[3])
            << "the test must see all components";
      }
  }
}

TEST(ImportanceSamplingInvariant, MeansOfTwoBouncesAreThoseOfRandomDirections) {
  const World world = corner(copper(0.2), matt(0.6), std::make_shared<SpottedSky>(5));
  const Estimate random = estimate(world, atRandom({400, 20}), corner_ray, 100);
  EXPECT_LT(deviation(estimate(world, importance({12, 5}), corner_ray, 1500), random),
            five_and_a_half);
  const Estimate one = estimate(world, importance({12, 1}), corner_ray, 1500);
  EXPECT_GT(deviation(one, random), five_and_a_half)
      << "negative control: the second hemisphere counts";
}

TEST(ImportanceSamplingInvariant, NegativeControlADensityWrongByThreePerCentIsSeen) {
  const CDSpectralVector<double> n(oneBand(), 0.405), k(oneBand(), 2.95), sigma(oneBand(), 0.2);
  const auto sky = std::make_shared<SpottedSky>(5);
  const World right = corner(copper(0.2), copper(0.2), sky);
  const World wrong = corner(std::make_shared<WrongDensity>(n, k, sigma), copper(0.2), sky);
  const Estimate random = estimate(right, atRandom({2001, 1}), corner_ray, 400);
  RadiometryOptions options = importance({34, 1});
  options.images = false;  // whose directions have another density, which is right
  EXPECT_GT(deviation(estimate(wrong, options, corner_ray, 4000), random), five_and_a_half);
}

// The converged uniform grid: its own error is taken from what a grid of twice as many directions changes, and
// falls at least as fast as 1/N, so that twice the change bounds what is left.
TEST(ImportanceSamplingInvariant, MeansAreThoseOfTheConvergedGrid) {
  const World world = corner(copper(0.3), copper(0.2), uniformSky(0.5));
  RadiometryOptions grid;
  grid.sampling = Sampling::gridRotated;
  grid.rays = {2001, 1};
  const Estimate half = estimate(world, grid, corner_ray, 64);
  grid.rays = {4001, 1};
  const Estimate whole = estimate(world, grid, corner_ray, 64);
  const Estimate ours = estimate(world, importance({34, 1}), corner_ray, 2000);
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(ours.mean[c], whole.mean[c],
                2 * std::abs(whole.mean[c] - half.mean[c]) +
                    five_and_a_half * std::hypot(ours.error[c], whole.error[c], half.error[c]))
        << c;
}

// The bright spot over a matt floor: 33 directions of the cosine lobe meet its 0.03 sr by chance.
TEST(ImportanceSamplingInvariant, TheSkysDensityHelpsWhereTheSkyIsUneven) {
  const World world = corner(matt(0.5), matt(0.5), std::make_shared<SpottedSky>(100));
  const double with = estimate(world, importance({34, 1}), corner_ray, 400).error[0];
  const double without =
      estimate(world, importance({34, 1}, true, false), corner_ray, 400).error[0];
  EXPECT_LT(with, without / 4);
}

TEST(ImportanceSamplingInvariant, ScrambledPointsAreQuieter) {
  const World world = corner(copper(0.2), copper(0.2), uniformSky(1));
  const double sobol = estimate(world, importance({65, 1}), corner_ray, 400).error[0];
  const double random = estimate(world, importance({65, 1}, false), corner_ray, 400).error[0];
  EXPECT_LT(sobol, random / 1.5);
}

// The cosine lobe over a matt surface: density cos(theta)/pi, so every weight is pi/count.
TEST(ImportanceSamplingIdentity, MattSurfaceGivesEveryDirectionTheSameWeight) {
  const auto brdf = matt(0.5);
  const auto sky = uniformSky(1);
  const SurfaceAxes axes({0, 0, 1});
  HemisphereRays rays;
  SobolReader points(SobolPoints(1), 3);
  importanceSampling({*brdf, *sky, axes, {0.6, 0, 0.8}, 1}, 50, points, 0, rays);
  ASSERT_EQ(rays.size(), 50u);
  for (const float weight : rays.weight) EXPECT_FLOAT_EQ(weight, float(pi / 50));
}

TEST(ImportanceSamplingIdentity, AViewerInThePlaneOfTheSurfaceGetsNothing) {
  const auto brdf = copper(0.2);
  const auto sky = uniformSky(1);
  const SurfaceAxes axes({0, 0, 1});
  HemisphereRays rays;
  SobolReader points(SobolPoints(1), 3);
  importanceSampling({*brdf, *sky, axes, {1, 0, 0}, 1}, 50, points, 0, rays);
  EXPECT_EQ(rays.size(), 0u);
}

TEST(ImportanceSamplingIdentity, PointsOfPathsFollowEachOther) {
  const std::vector<int> rays{91, 11, 3};
  EXPECT_EQ(firstPoint(0, 0, rays), 0u);
  EXPECT_EQ(firstPoint(1, 1, rays), 0u);
  EXPECT_EQ(firstPoint(2, 1, rays), 10u) << "the second of the first bounce has the second ten";
  EXPECT_EQ(firstPoint((2ull << 12) + 3, 2, rays), 24u) << "(1 * 10 + 2) * 2";
}

TEST(ImportanceSamplingInvariant, AnswersDependOnTheRayAlone) {
  const World world = corner(copper(0.2), copper(0.2), std::make_shared<SpottedSky>(5));
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              importance({20, 4}));
  std::vector<Radiometry::Ray> many(7, corner_ray);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].pixel = i;
  std::vector<double> together(many.size() * 4), alone(4);
  radiometry.radiance(many, together);
  for (std::size_t i = many.size(); i-- > 0;) {
    radiometry.radiance({&many[i], 1}, alone);
    EXPECT_TRUE(
        std::equal(alone.begin(), alone.end(), together.begin() + 4 * std::ptrdiff_t(i)))
        << i;
  }
  EXPECT_NE(together[0], together[4]) << "pixels have numbers of their own";
}
