// Point spread functions as displaced rays (nw/render/PointSpread.nw), and pictures of an edge.
#include "malus/render/PointSpread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <vector>

#include "Worlds.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

// Mean of cos(2 pi nu x) over displacements, and its standard error over `pixels` random starts.
struct Contrast {
  double mean = 0, error = 0;
};
Contrast contrastOf(const PointSpread& spread, double nu_x, double nu_y = 0) {
  constexpr std::size_t pixels = 64, samples = 256;
  double sum = 0, squares = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    double one = 0;
    for (std::size_t s = 0; s < samples; ++s) {
      const auto u = opticsPoint(3, 0, pixel, s);
      const ImagePoint q = spread.draw(u[0], u[1]);
      one += std::cos(2 * pi * (nu_x * q.x + nu_y * q.y)) / samples;
    }
    sum += one / pixels, squares += one * one / pixels;
  }
  return {sum, std::sqrt(std::max(0.0, squares - sum * sum) / pixels)};
}
// 24 comparisons at 5 standard errors: one of 70,000 runs would fail by chance; and rounding.
void expectContrast(const Contrast& found, double expected) {
  EXPECT_NEAR(found.mean, expected, 5 * found.error + 1e-9);
}

double airyMTF(double s) {
  return s < 1 ? 2 / pi * (std::acos(s) - s * std::sqrt(1 - s * s)) : 0;
}
}  // namespace

TEST(PointSpreadPublished, TheContrastOfAGaussianOfAnApertureAndOfASquare) {
  const double fwhm = 2, sigma = fwhm / 2.3548200450309493, cutoff = 0.9469696969696969;
  const PointSpread gauss = PointSpread::gaussian(fwhm), airy = PointSpread::airy(cutoff);
  const PointSpread square = PointSpread::table({{1, 1}, {1, 1}}, 0.7);
  for (const double nu : {0.05, 0.15, 0.3, 0.5, 0.7}) {
    expectContrast(contrastOf(gauss, nu), std::exp(-2 * std::pow(pi * sigma * nu, 2)));
    expectContrast(contrastOf(gauss, 0.6 * nu, 0.8 * nu),
                   std::exp(-2 * std::pow(pi * sigma * nu, 2)));
    expectContrast(contrastOf(airy, nu), airyMTF(nu / cutoff));
    expectContrast(contrastOf(airy, 0.6 * nu, -0.8 * nu), airyMTF(nu / cutoff));
    expectContrast(contrastOf(square, nu), std::sin(1.4 * pi * nu) / (1.4 * pi * nu));
  }
  expectContrast(contrastOf(airy, 1.1), 0);  // beyond the cutoff
  // the negative controls: a width that is off by 5 %
  const Contrast wider = contrastOf(PointSpread::gaussian(1.05 * fwhm), 0.15);
  EXPECT_GT(std::abs(wider.mean - std::exp(-2 * std::pow(pi * sigma * 0.15, 2))),
            5 * wider.error);
  const Contrast narrower = contrastOf(PointSpread::airy(1.05 * cutoff), 0.3);
  EXPECT_GT(std::abs(narrower.mean - airyMTF(0.3 / cutoff)), 5 * narrower.error);
}

// The light within a radius: 1 - J0^2 - J1^2, of which 83.78 % lies within the first dark ring (Born and Wolf 8.5).
TEST(PointSpreadPublished, TheLightWithinTheDarkRings) {
  const PointSpread airy = PointSpread::airy(1 / pi);  // q = w
  const double rings[] = {3.831705970207512, 7.015586669815619, 10.173468135062722};
  const double within[] = {0.8378, 0.9099, 0.9376};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(airy.draw(within[i], 0).x, rings[i], 0.35) << "flat at a dark ring";
    const double light = 1 - std::pow(::j0(rings[i]), 2) - std::pow(::j1(rings[i]), 2);
    EXPECT_NEAR(light, within[i], 1e-4);
  }
  for (const double u : {0.1, 0.5, 0.83, 0.95, 0.985, 0.99, 0.999, 0.9999999}) {
    const double w = airy.draw(u, 0).x;
    EXPECT_NEAR(std::pow(::j0(w), 2) + std::pow(::j1(w), 2), 1 - u, 1e-8 * (1 - u) + 1e-15)
        << u;
  }
}

TEST(PointSpreadIdentity, ATablePutsItsLightWhereItStands) {
  const PointSpread corner = PointSpread::table({{0, 0, 0}, {0, 0, 0}, {0, 0, 4}}, 0.5);
  for (double u = 0; u < 1; u += 0.1) {
    const ImagePoint q = corner.draw(u, 0.25);
    EXPECT_NEAR(q.x, 0.25 + 0.5 * u, 1e-12);     // right, and
    EXPECT_NEAR(q.y, 0.25 + 0.5 * 0.25, 1e-12);  // below
  }
  const PointSpread three = PointSpread::table({{1, 0, 3}}, 1);
  int right = 0;
  for (int i = 0; i < 1000; ++i) {
    const ImagePoint q = three.draw((i + 0.5) / 1000, 0.5);
    EXPECT_TRUE(std::abs(q.x) >= 0.5) << "none in the middle";
    right += q.x > 0;
  }
  EXPECT_EQ(right, 750);
  EXPECT_THROW(PointSpread::table({{1, 2}, {3}}, 1), Refusal);
  EXPECT_THROW(PointSpread::table({{0, 0}}, 1), Refusal);
  EXPECT_THROW(PointSpread::table({{1, -1}}, 1), Refusal);
  EXPECT_THROW(PointSpread::gaussian(0), Refusal);
  EXPECT_THROW(PointSpread::airy(0), Refusal);
}

namespace {
constexpr std::size_t across = 16;
constexpr double focal = 1000, height_m = 10, pixel_m = height_m / focal;

// Two paints that meet at x = edge [pixels from the axis]; under a sun of irradiance pi in the zenith a matt surface
// has its reflectance as radiance.
Scene edgeScene(double edge_px, const std::function<void(SensorGeometry&)>& change,
                std::size_t samples) {
  const double e = edge_px * pixel_m, far = 50;
  World world =
      worldOf({{{-far, -far, 0}, {e, -far, 0}, {e, far, 0}, {-far, far, 0}, matt(0.2)},
               {{e, -far, 0}, {far, -far, 0}, {far, far, 0}, {e, far, 0}, matt(0.8)}});
  world.sun.emplace(Sun{{0, 0, 1}, spectrumOf(CDStokesVector(pi)), 0});
  SensorGeometry g;
  g.width = across, g.height = 2, g.focal_length_px = focal, g.samples = samples;
  g.principal_x = across / 2.0, g.principal_y = 1, g.jitter = true;
  change(g);
  RadiometryOptions options;
  options.rays = {1};
  const auto tracer = std::make_shared<const RayTracer>(world.geometry);
  return {"",
          "",
          std::move(world),
          Sensor(g, oneBand(), oneBand()),
          Platform::fixed(Pose::looking({0, 0, height_m}, {0, 0, -1}, {0, 1, 0})),
          options,
          tracer,
          {},
          {},
          {},
          {},
          {},
          {}};
}

// Largest deviation of the pixels from 0.2 + 0.6 times the part of each detector's light that comes from the right.
double offTheEdge(const RenderedImage& image, const std::function<double(double)>& right,
                  double edge_px, double detector = 1) {
  double most = 0;
  for (std::size_t x = 0; x < across; ++x) {
    const double middle = double(x) + 0.5 - across / 2.0 - edge_px;
    double part = 0;  // Simpson's rule over the detector
    constexpr int n = 200;
    for (int i = 0; i <= n; ++i)
      part += right(middle + detector * (double(i) / n - 0.5)) *
              (i == 0 || i == n ? 1
               : i % 2          ? 4
                                : 2) /
              (3.0 * n);
    for (std::size_t y = 0; y < 2; ++y)
      most = std::max(most, std::abs(image.at(x, y)[0] - 0.2 - 0.6 * part));
  }
  return most;
}
}  // namespace

// The edge response of a Gaussian is the error function. 16384 rays a pixel: 0.6 / 2 / sqrt(16384) = 0.0023 for independent
// ones, and those of the sequence are better; 5 of them.
TEST(PointSpreadIdentity, PixelsOfAnEdgeHaveTheErrorFunction) {
  const double fwhm = 3, sigma = fwhm / 2.3548200450309493, edge = 0.37;
  constexpr double chance = 5 * 0.6 / 2 / 128;
  const auto phi = [](double s) {
    return [s](double x) { return 0.5 * std::erfc(-x / (s * std::sqrt(2.0))); };
  };
  const RenderedImage image = renderScene(edgeScene(
      edge, [&](SensorGeometry& g) { g.point_spread = PointSpread::gaussian(fwhm); }, 16384));
  EXPECT_LT(offTheEdge(image, phi(sigma), edge), chance);
  EXPECT_GT(offTheEdge(image, phi(1.2 * sigma), edge), chance) << "the negative control";
  const RenderedImage sharp = renderScene(edgeScene(
      edge,
      [](SensorGeometry& g) {
        g.detector = DetectorSize{2.5, 1};
      },
      16384));
  const auto step = [](double x) { return x > 0 ? 1.0 : 0.0; };
  EXPECT_LT(offTheEdge(sharp, step, edge, 2.5), chance);
  EXPECT_GT(offTheEdge(sharp, step, edge, 1), chance) << "the negative control";
}

// A table that is skew: a star's light falls to the right, so that an edge's light falls to the right as well.
TEST(PointSpreadIdentity, ASkewTableShiftsTheEdgeAsItShiftsAStar) {
  const RenderedImage image = renderScene(edgeScene(
      0,
      [](SensorGeometry& g) {
        g.point_spread = PointSpread::table({{0, 0, 1}}, 2);  // 1 to 3 pixels to the right
      },
      4096));
  const auto shifted = [](double x) { return std::clamp((x - 1) / 2, 0.0, 1.0); };
  constexpr double chance = 5 * 0.6 / 2 / 64;
  EXPECT_LT(offTheEdge(image, shifted, 0), chance);
  EXPECT_GT(offTheEdge(
                image, [&](double x) { return 1 - shifted(-x); }, 0),
            chance);
}

// By hand in chapter Sensor: 2 m/s over 20 ms at 10 m are 4 pixels, and so is a turn of 0.2 rad/s. A camera that flies to the right
// sees the edge run to the left, and one that turns to the left (about its up axis) sees it run to the right. The tangent
// bends the turn's smear by (8 / 1000)^2 of 4 pixels.
TEST(ExposureIdentity, AnEdgeIsSmearedIntoARamp) {
  const double edge = 0.37, smear = 4;
  constexpr double chance = 5 * 0.6 / 2 / 64;
  const auto exposed = [](SensorGeometry& g) { g.exposure_s = 0.02; };
  const Pose pose = Pose::looking({0, 0, height_m}, {0, 0, -1}, {0, 1, 0});
  const auto left = [&](double x) { return std::clamp(1 + x / smear, 0.0, 1.0); };
  const auto right = [&](double x) { return std::clamp(x / smear, 0.0, 1.0); };
  Scene flies = edgeScene(edge, exposed, 4096);
  flies.platform = Platform::straight(pose, {2, 0, 0}, 1, 0);
  const RenderedImage flown = renderScene(flies);
  EXPECT_LT(offTheEdge(flown, left, edge), chance);
  EXPECT_GT(offTheEdge(flown, right, edge), chance) << "the negative control";
  Scene turns = edgeScene(edge, exposed, 4096);
  turns.platform = Platform::fixed(pose).turning({0, 0.2, 0});
  const RenderedImage turned = renderScene(turns);
  EXPECT_LT(offTheEdge(turned, right, edge), chance);
  EXPECT_GT(offTheEdge(turned, left, edge), chance) << "the negative control";
  const RenderedImage still = renderScene(edgeScene(edge, exposed, 16));
  EXPECT_LT(offTheEdge(
                still, [](double x) { return x > 0 ? 1.0 : 0.0; }, edge),
            0.6 / 4 + 1e-9)
      << "a camera that stands still does not smear: four columns of rays";
}

// The contrasts of detector, motion and point spread multiply.
TEST(ExposureIdentity, ContrastsMultiply) {
  SensorGeometry g;
  g.width = g.height = 8, g.focal_length_px = focal, g.samples = 1024, g.jitter = true;
  g.principal_x = g.principal_y = 4, g.exposure_s = 0.02;
  g.detector = DetectorSize{0.7, 1}, g.point_spread = PointSpread::gaussian(1.5);
  const Sensor sensor(g, oneBand(), oneBand());
  const Platform flight = Platform::straight(
      Pose::looking({0, 0, height_m}, {0, 0, -1}, {0, 1, 0}), {0.5, 0, 0}, 1, 0);
  const double smear = 1, sigma = 1.5 / 2.3548200450309493;
  const auto sinc = [](double t) { return std::sin(pi * t) / (pi * t); };
  for (const double nu : {0.1, 0.25, 0.4}) {
    std::complex<double> sum = 0;
    double squares = 0;
    for (std::size_t y = 0; y < 8; ++y)
      for (std::size_t x = 0; x < 8; ++x) {
        std::complex<double> one = 0;
        for (std::size_t s = 0; s < g.samples; ++s) {
          const auto ray = sensor.ray(x, y, s, flight, 0, 1);
          const double ground = ray.origin.x - ray.origin.z * ray.direction.x / ray.direction.z;
          const double off = ground / pixel_m - (double(x) + 0.5 - 4) - smear / 2;
          one += std::polar(1.0 / double(g.samples), 2 * pi * nu * off);
        }
        sum += one / 64.0, squares += std::norm(one) / 64;
      }
    const double error = std::sqrt(std::max(0.0, squares - std::norm(sum)) / 64);
    const double expected =
        sinc(0.7 * nu) * sinc(smear * nu) * std::exp(-2 * std::pow(pi * sigma * nu, 2));
    EXPECT_NEAR(sum.real(), expected, 5 * error + 1e-9) << nu;
    EXPECT_NEAR(sum.imag(), 0, 5 * error + 1e-9) << nu;
    EXPECT_GT(std::abs(sum.real() - expected * sinc(smear * nu)), 5 * error) << "the control";
  }
}

// Parts are the very bits of the whole: a displaced ray does not use neighbours.
TEST(PointSpreadInvariant, TilesAreTheBitsOfTheWhole) {
  const Scene scene = edgeScene(
      0.2, [](SensorGeometry& g) { g.point_spread = PointSpread::airy(0.4); }, 16);
  const RenderedImage whole = renderScene(scene);
  const RenderedImage part = renderScene(scene, 0, {.tile = Tile{5, 1, 9, 2}});
  for (std::size_t x = 0; x < 4; ++x) EXPECT_EQ(part.at(x, 0)[0], whole.at(5 + x, 1)[0]);
  EXPECT_NE(whole.at(7, 0)[0], whole.at(7, 1)[0]) << "rows have random starts of their own";
}
