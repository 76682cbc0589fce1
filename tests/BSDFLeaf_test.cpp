// Leaves and other surfaces that scatter to both sides (nw/surface/BSDFLeaf.nw, nw/surface/Transmitting.nw,
// nw/render/LightThroughGlass.nw).
#include "malus/surface/BSDFLeaf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Refusal.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
Model leaf(double reflectance, double transmittance) {
  return std::make_shared<BSDFLeaf>(CDSpectralVector<double>(oneBand(), reflectance),
                                    CDSpectralVector<double>(oneBand(), transmittance));
}
const RadiometryOptions sun_only{.rays = {1}};
double seen(const World& world, const RadiometryOptions& options, const CDVector& to_viewer,
            double distance = 0.5) {
  return estimate(world, options, looking({0.1, 0, 0}, to_viewer, {0, 1, 0}, 0, distance), 64)
      .mean[0];
}
}  // namespace

// Directions from the cosine lobe make each half of a uniform sky exact, but for single precision.
TEST(BSDFLeafIdentity, AUniformSkyShowsTheSumOfBothShares) {
  const World world = worldOf({floorOf(leaf(0.4, 0.3))}, uniformSky(2));
  for (const CDVector& from : {CDVector{0.2, 0.3, 1}, {0.5, 0.1, -0.4}, {0, 0, 1}, {0, 0, -1}})
    EXPECT_NEAR(seen(world, {.rays = {5}}, from), 2 * 0.7, 1e-6);
}

TEST(BSDFLeafIdentity, TheSunBeforeAndBehind) {
  World world = worldOf({floorOf(leaf(0.4, 0.3))});
  const double theta = pi / 3;
  world.sun.emplace(Sun{CDVector::fromAngles(theta, 1), spectrumOf(1.0), 0});
  EXPECT_NEAR(seen(world, sun_only, {0.2, 0.3, 1}), 0.4 * std::cos(theta) / pi, 1e-12);
  EXPECT_NEAR(seen(world, sun_only, {0.2, 0.3, -1}), 0.3 * std::cos(theta) / pi, 1e-12);
  // a second leaf on the far side casts its shadow on the light that comes through
  World shaded = worldOf(
      {floorOf(leaf(0.4, 0.3)), {{-9, -9, 1}, {9, -9, 1}, {9, 9, 1}, {-9, 9, 1}, matt(0)}});
  shaded.sun = world.sun;
  EXPECT_EQ(seen(shaded, sun_only, {0.2, 0.3, -1}), 0);
}

// Over matt ground, endless but for the single part in a thousand that its width leaves out: the ground has
// B = rho_g tau / (1 - rho_g rho), and the leaf shows rho + tau B. Five surfaces leave (rho_g rho)^2 of B out.
TEST(BSDFLeafInvariant, LightBetweenALeafAndTheGround) {
  const World world = worldOf(
      {floorOf(leaf(0.2, 0.4), 300),
       {{-300, -300, -0.1}, {300, -300, -0.1}, {300, 300, -0.1}, {-300, 300, -0.1}, matt(0.2)}},
      uniformSky(1));
  const auto got =
      estimate(world, {.rays = {17, 3, 2, 2, 2}}, looking({}, {0.1, 0.2, 1}, {1, 0, 0}), 1000);
  const double ground = 0.2 * 0.4 / (1 - 0.2 * 0.2);
  EXPECT_NEAR(got.mean[0], 0.2 + 0.4 * ground, 5 * got.error[0] + 1e-4);
  EXPECT_GT(got.mean[0] - 0.2,
            20 * got.error[0]);  // negative control: a leaf that only reflects
}

TEST(BSDFLeafInvariant, EnergyIsKept) {
  for (const double n : {1.1, 1.4, 2.0})
    for (const double plates : {1.0, 1.5, 2.0, 7.3}) {
      const LeafShares clear = leafShares(n, 0, plates);
      EXPECT_NEAR(clear.reflectance + clear.transmittance, 1, 1e-12) << n << ' ' << plates;
      double before = 1, through = 1;
      for (const double depth : {1e-9, 0.01, 0.1, 1.0, 10.0}) {
        const LeafShares shares = leafShares(n, depth, plates);
        EXPECT_LT(shares.reflectance + shares.transmittance, before) << depth;
        EXPECT_LT(shares.transmittance, through) << depth;
        before = shares.reflectance + shares.transmittance, through = shares.transmittance;
      }
    }
  EXPECT_GT(leafShares(1.4, 0, 2).reflectance, leafShares(1.4, 0, 1.5).reflectance);
}

// Two and three plates, added one by one.
TEST(BSDFLeafIdentity, APileIsTheSumOfItsPlates) {
  const double n = 1.4, depth = 0.2;
  const LeafShares one = leafShares(n, depth, 1), two = leafShares(n, depth, 2),
                   three = leafShares(n, depth, 3);
  const double diffuse = coneTransmission(n, pi / 2), back = 1 - diffuse / (n * n);
  double theta = 0;
  const int steps =
      200000;  // the midpoint rule; its error is 1/steps^2 times a slope of about one
  for (int i = 0; i < steps; ++i) {
    const double mu = (i + 0.5) / steps;
    theta += 2 * mu * std::exp(-depth / mu) / steps;
  }
  const double t = diffuse * theta * (1 - back) / (1 - back * back * theta * theta);
  const double r = 1 - diffuse + back * theta * t;
  const auto add = [&](const LeafShares& above, double r2, double t2) {
    return LeafShares{above.reflectance + above.transmittance * r2 * t / (1 - r * r2),
                      above.transmittance * t2 / (1 - r * r2)};
  };
  const LeafShares pair = add(one, r, t),
                   pile = add(one, r + t * t * r / (1 - r * r), t * t / (1 - r * r));
  EXPECT_NEAR(two.reflectance, pair.reflectance, 1e-8);
  EXPECT_NEAR(two.transmittance, pair.transmittance, 1e-8);
  EXPECT_NEAR(three.reflectance, pile.reflectance, 1e-8);
  EXPECT_NEAR(three.transmittance, pile.transmittance, 1e-8);
  EXPECT_GT(std::abs(three.transmittance - pair.transmittance),
            0.01);  // negative control: one plate fewer
}

// What a smooth face of index 1.5 reflects of diffuse light (Judd 1942, as cited by many: 9.2 %).
TEST(BSDFLeafPublished, DiffuseReflectanceOfAFace) {
  EXPECT_NEAR(1 - coneTransmission(1.5, pi / 2), 0.092, 0.0005);
  EXPECT_NEAR(1 - coneTransmission(1.5, 1e-3), 0.04, 1e-6);
}

TEST(BSDFLeafRefusal, MoreThanAllLight) {
  EXPECT_THROW(leaf(0.6, 0.5), Refusal);
  EXPECT_NO_THROW(leaf(0.5, 0.5));
  EXPECT_THROW(leafShares(1.4, -1, 1), Refusal);
  EXPECT_THROW(leafShares(1.4, 1, 0.5), Refusal);
}
