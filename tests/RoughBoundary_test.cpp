// Rough boundaries of clear bodies (nw/surface/RoughBoundary.nw, nw/render/LightThroughGlass.nw).
#include "malus/surface/RoughBoundary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Random.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/surface/Panes.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
CDSpectralVector<double> same(double value) { return {oneBand(), value}; }

struct Beyond {
  double S0 = 0, S1 = 0, drawn = 0, error = 0;
};
/// What a viewer at this angle sees of a uniform sky of one beyond the surface, from draws; and the share that is not rejected.
Beyond skyBeyond(const CDBRDFModel& model, double zenith_rad, int draws = 40000) {
  Random random(7);
  const CDVector viewer = CDVector::fromAngles(zenith_rad, 0.4);
  Beyond sky;
  double squares = 0;
  for (int i = 0; i < draws; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    const BRDFSample one = model.sample(viewer, u1, u2, u3);
    if (one.rejected()) continue;
    const CDMuellerMatrix f =
        model.getBRDF(BRDFGeometry::fromDirections(one.direction, viewer)).at(0);
    const double weight = one.direction.z / one.density_per_sr;
    sky.S0 += weight * f.getMueller(0, 0), sky.S1 += weight * f.getMueller(1, 0), ++sky.drawn;
    squares += std::pow(weight * f.getMueller(0, 0), 2);
  }
  sky.S0 /= draws, sky.S1 /= draws, sky.drawn /= draws;
  sky.error = std::sqrt((squares / draws - sky.S0 * sky.S0) / draws);
  return sky;
}
}  // namespace

// Slopes of a hundredth bend nothing by more than a degree; what they change is of second order, 1e-4 times a few.
TEST(RoughBoundaryIdentity, NearlySmoothItIsTheSmoothBoundary) {
  for (const double ratio : {1.5, 1 / 1.5})
    for (const double deg : {0.0, 10.0, 30.0}) {
      const double theta = toRadians(deg), s2 = std::sin(theta) * std::sin(theta);
      const FresnelTerms<double> t = fresnelTransmission(std::cos(theta), s2, ratio);
      const Beyond sky = skyBeyond(RoughTransmission(same(ratio), 0.01), theta);
      const double scale = 1 / (ratio * ratio);
      EXPECT_NEAR(sky.S0, t.sum * scale, 5 * sky.error + 1e-3 * scale) << ratio << ' ' << deg;
      EXPECT_NEAR(sky.S1, t.diff * scale, 5 * sky.error + 1e-3 * scale) << ratio << ' ' << deg;
      EXPECT_GT(std::abs(sky.S0 - t.sum),
                0.3);  // negative control: without the radiance's factor
    }
  EXPECT_LT(skyBeyond(RoughTransmission(same(1 / 1.5), 0.01), toRadians(50)).S0, 1e-6);
}

// By reciprocity what is seen of a sky of one on either side is what the surface mirrors and refracts of a beam.
TEST(RoughBoundaryInvariant, MirrorAndRefractionKeepTheEnergy) {
  for (const double sigma : {0.05, 0.1, 0.4})
    for (const double deg : {0.0, 30.0, 60.0, 80.0})
      for (const bool inside : {false, true}) {
        const RoughBoundary surface(same(1.5), sigma, same(0));
        const double theta = toRadians(deg), ratio = inside ? 1 / 1.5 : 1.5;
        const Beyond sky = skyBeyond(surface.transmitted(inside), theta);
        const Beyond mirror = skyBeyond(surface.reflected(inside), theta);
        const double all = mirror.S0 + sky.S0 * ratio * ratio;
        const double error = mirror.error + sky.error * ratio * ratio;
        EXPECT_LT(all, 1 + 5 * error) << sigma << ' ' << deg << ' ' << inside;
        if (sigma < 0.2 && deg < 50) {
          EXPECT_GT(all, 0.985 - 5 * error) << sigma << ' ' << deg << ' ' << inside;
        }
      }
}

TEST(RoughBoundaryInvariant, BothEndsMayBeExchanged) {
  const RoughTransmission out(same(1.5), 0.3), in(same(1 / 1.5), 0.3);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double a = 1.4 * random.uniform(), b = 1.4 * random.uniform(),
                 phi = 2 * pi * random.uniform();
    const double f = out.getBRDF(BRDFGeometry::fromAngles(a, b, phi)).at(0).getScalar();
    const double g = in.getBRDF(BRDFGeometry::fromAngles(b, a, -phi)).at(0).getScalar();
    EXPECT_NEAR(f * 1.5 * 1.5, g, 1e-9 * g + 1e-12);
  }
}

TEST(RoughBoundaryInvariant, TheDensityIsThatOfTheDraws) {
  for (const double ratio : {1.5, 1 / 1.5}) {
    const RoughTransmission model(same(ratio), 0.3);
    const CDVector viewer = CDVector::fromAngles(0.7, 0);
    double sum = 0;
    const int n = 600;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double mu = (i + 0.5) / n;
        sum +=
            model.density(viewer, CDVector::fromAngles(std::acos(mu), 2 * pi * (j + 0.5) / n)) *
            2 * pi / (n * n);
      }
    EXPECT_NEAR(sum, skyBeyond(model, 0.7).drawn, 0.01)
        << ratio;  // five standard errors of 40000 draws
  }
}

TEST(RoughBoundaryInvariant, MatricesAreRealisable) {
  const RoughTransmission model(same(1.5), 0.4);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const CDMuellerMatrix f =
        model
            .getBRDF(BRDFGeometry::fromAngles(1.5 * random.uniform(), 1.5 * random.uniform(),
                                              2 * pi * random.uniform()))
            .at(0);
    if (f.getScalar() == 0) continue;
    EXPECT_GE(f.getScalar() * (1 + 1e-12),
              std::hypot(f.getMueller(0, 1), f.getMueller(0, 2), f.getMueller(0, 3)));
    double squares = 0;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) squares += f.getMueller(r, c) * f.getMueller(r, c);
    EXPECT_NEAR(squares, 4 * f.getScalar() * f.getScalar(),
                1e-9 * squares);  // a facet depolarises nothing
  }
}

namespace {
World boxed(const CDVector& l, const CDVector& h, const Model& model, const Quad* bed,
            std::shared_ptr<const Sky> sky) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? h.x : l.x, i & 2 ? h.y : l.y, i & 4 ? h.z : l.z});
  mesh.facets = mesh.materials = {"body"};
  for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{2, 3, 1, 0},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {3, 2, 6, 7},
                                   {1, 3, 7, 5},
                                   {2, 0, 4, 6}})
    mesh.triangles.push_back({a, b, c, 0, 0}), mesh.triangles.push_back({a, c, d, 0, 0});
  World world;
  world.grid = oneBand();
  GeometryBuilder builder;
  builder.addMesh(mesh, {});
  world.materials.push_back({"body", model});
  if (bed) {
    Mesh quad;
    quad.vertices = {bed->a, bed->b, bed->c, bed->d};
    quad.facets = quad.materials = {"bed"};
    quad.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
    builder.addMesh(quad, {});
    world.materials.push_back({"bed", bed->brdf});
  }
  world.geometry = std::move(builder).build();
  world.sky = sky ? std::move(sky) : blackSky(oneBand());
  return world;
}
Model rough(double sigma, double absorption = 0) {
  return std::make_shared<RoughBoundary>(same(1.5), sigma, same(absorption));
}
}  // namespace

// The list of rays ends after six surfaces, and light that a facet sends onto its own surface is lost: some per cent.
TEST(RoughBoundaryInvariant, ARoughBlockInAUniformSkyIsNearlyInvisible) {
  const World clear = boxed({-1, -1, -1}, {1, 1, 1}, rough(0.05), nullptr, uniformSky(1)),
              smoky = boxed({-1, -1, -1}, {1, 1, 1}, rough(0.05, 1), nullptr, uniformSky(1));
  const auto ray = looking({0.1, 0.2, 1}, {0.3, 0.1, 1}, {0, 1, 0});
  const RadiometryOptions options{.rays = {9, 4, 3, 2, 2, 2}};
  const auto got = estimate(clear, options, ray, 600);
  EXPECT_LT(got.mean[0], 1 + 5 * got.error[0]);
  EXPECT_GT(got.mean[0], 0.93 - 5 * got.error[0]);
  EXPECT_LT(estimate(smoky, options, ray, 600).mean[0], 0.5);  // two ways of two metres
}

// The bed in the sun below waves has nearly the light that it has below a calm surface: the slopes change the transmission and
// the ways by their square, 0.02, times a few.
TEST(RoughBoundaryIdentity, TheBottomOfALakeWithWaves) {
  const double n = 1.5, a = 0.1, theta = 0.6, view = 0.3;
  const Quad bed{{-8, -8, -1}, {8, -8, -1}, {8, 8, -1}, {-8, 8, -1}, matt(0.5)};
  World world = boxed({-9, -9, -2}, {9, 9, 0}, rough(0.15, a), &bed, nullptr);
  world.sun.emplace(Sun{CDVector::fromAngles(theta, 1), spectrumOf(1.0), 0});
  const auto passed = [&](double angle) {
    return fresnelTransmission(std::cos(angle), std::sin(angle) * std::sin(angle), n).sum *
           std::exp(-a / std::cos(refractedAngle(angle, n)));
  };
  const double calm = 0.5 / pi * std::cos(theta) * passed(theta) * passed(view) / (n * n);
  const auto got = estimate(world, {.rays = {17, 17, 2}},
                            looking({}, CDVector::fromAngles(view, 2.5), {1, 0, 0}), 1500);
  // the waves' own glint at this viewer is the first surface's; it is taken off by a lake without a bed
  const World deep = [&] {
    Quad black = bed;
    black.brdf = matt(0);
    World made = boxed({-9, -9, -2}, {9, 9, 0}, rough(0.15, a), &black, nullptr);
    made.sun = world.sun;
    return made;
  }();
  const auto glint = estimate(deep, {.rays = {17, 17, 2}},
                              looking({}, CDVector::fromAngles(view, 2.5), {1, 0, 0}), 1500);
  EXPECT_NEAR(got.mean[0] - glint.mean[0], calm,
              0.08 * calm + 5 * std::hypot(got.error[0], glint.error[0]));
}

TEST(RoughBoundaryRefusal, WhatIsNoRoughBody) {
  EXPECT_THROW(RoughBoundary(same(1), 0.1, same(0)), Refusal);
  EXPECT_THROW(RoughBoundary(same(1.5), 0.001, same(0)), Refusal);
  World world = worldOf({floorOf(rough(0.1))});
  EXPECT_THROW(Radiometry(world, std::make_shared<RayTracer>(world.geometry), {.rays = {1}}),
               Refusal);
}
