// Brown and Conrady's lens and its inverse (nw/render/LensDistortion.nw), and the sensor behind it (nw/render/Sensor.nw).
#include "malus/render/LensDistortion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "malus/base/Error.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/render/Sensor.hpp"

using namespace malus;

namespace {
// The inverse stops at 1e-13 focal lengths of F; J's least eigenvalue in the tests is above 0.01.
constexpr double inverted = 1e-11;

const std::vector<BrownConrady> lenses{
    {-0.3, 0, 0, 0, 0},          {0.2, 0, 0, 0, 0},          {-0.21, 0.05, 0, 0.0004, -0.0007},
    {0.1, -0.08, 0.01, 0.01, 0}, {-0.4, 0.3, -0.1, 0, 0.02}, {0, 0, 0, 0.03, -0.01}};

double reachOf(const BrownConrady& lens) { return LensDistortion(lens, 0).reach(); }

// Equation (brown) in components, as OpenCV's documentation writes it.
ImagePoint inComponents(const BrownConrady& c, const ImagePoint& p) {
  const double r2 = p.x * p.x + p.y * p.y,
               round = 1 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
  return {p.x * round + 2 * c.p1 * p.x * p.y + c.p2 * (r2 + 2 * p.x * p.x),
          p.y * round + c.p1 * (r2 + 2 * p.y * p.y) + 2 * c.p2 * p.x * p.y};
}
double apart(const ImagePoint& a, const ImagePoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}
}  // namespace

TEST(LensDistortionIdentity, ThePointAndTheFoldWorkedByHand) {
  const LensDistortion lens({-0.2, 0, 0, 0, 0.01}, 0.5);
  EXPECT_LT(apart(lens.distorted({0.5, 0}), {0.4825, 0}), 1e-15);
  EXPECT_NEAR(reachOf({-0.3, 0, 0, 0, 0}), std::sqrt(1 / 0.9) * 2 / 3, 1e-12);
  EXPECT_EQ(reachOf({0.3, 0.1, 0, 0, 0}), std::numeric_limits<double>::infinity());
}

TEST(LensDistortionPublished, TheFormulaInComponents) {
  for (const BrownConrady& c : lenses)
    for (const ImagePoint& p : {ImagePoint{0.3, -0.2}, {-0.1, 0.4}, {0.5, 0.5}})
      EXPECT_LT(apart(LensDistortion(c, 0).distorted(p), inComponents(c, p)), 1e-15);
}

TEST(LensDistortionInvariant, ThereAndBackOverTheWholeReach) {
  for (const BrownConrady& c : lenses) {
    const double most = 0.999 * std::min(reachOf(c), 3.0);
    const LensDistortion lens(c, most);
    for (int i = 0; i < 720; ++i) {
      const double r = most * std::sqrt((i + 0.5) / 720), a = 2.399963 * i;
      const ImagePoint d{r * std::cos(a), r * std::sin(a)};
      EXPECT_LT(apart(lens.distorted(lens.ideal(d)), d), 1e-12) << c.k1 << ' ' << i;
    }
  }
  // the negative control: one round of the fixed-point iteration
  const BrownConrady barrel{-0.3, 0, 0, 0, 0};
  const ImagePoint d{0.4, 0.2}, once{0.4 / (1 - 0.3 * 0.2), 0.2 / (1 - 0.3 * 0.2)};
  EXPECT_GT(apart(LensDistortion(barrel, 0.5).distorted(once), d), 1e-3);
}

// The inverse must be the point inside of the fold, not the other root of the polynomial.
TEST(LensDistortionInvariant, TheInverseIsTheNearRoot) {
  const BrownConrady barrel{-0.3, 0, 0, 0, 0};
  const double rim = std::sqrt(1 / 0.9);
  const LensDistortion lens(barrel, 0.7);
  for (double r = 0.05; r < 1.04; r += 0.05) {
    const ImagePoint before{r * 0.6, -r * 0.8};
    EXPECT_LT(apart(lens.ideal(lens.distorted(before)), before), inverted) << r;
    EXPECT_LT(std::hypot(before.x, before.y), rim);
  }
}

TEST(LensDistortionIdentity, AFoldIsRefusedJustBeforeTheFarthestPixel) {
  for (const BrownConrady& c : lenses) {
    const double reach = reachOf(c);
    if (!std::isfinite(reach)) continue;
    EXPECT_NO_THROW(LensDistortion(c, reach * (1 - 1e-9)));
    EXPECT_THROW(LensDistortion(c, reach * (1 + 1e-9)), Refusal);
  }
  EXPECT_THROW(LensDistortion({-0.3, 0, 0, 0, 0}, 0.71), Refusal);
}

// Brute force: on the disc that is claimed, the least eigenvalue of the Jacobian (by differences) is above zero; for a
// round lens it vanishes on the rim.
TEST(LensDistortionInvariant, TheJacobianIsPositiveWithinTheFold) {
  for (const BrownConrady& c : lenses) {
    const LensDistortion lens(c, 0);
    const double q = std::hypot(c.p1, c.p2);
    const auto positive = [&](double r) {
      double least = 1e9;
      for (int i = 0; i < 360; ++i) {
        const ImagePoint p{r * std::cos(i * 0.0174533), r * std::sin(i * 0.0174533)};
        const double h = 1e-5;
        const auto at = [&](double dx, double dy) {
          return inComponents(c, {p.x + dx, p.y + dy});
        };
        const double xx = (at(h, 0).x - at(-h, 0).x) / (2 * h),
                     yy = (at(0, h).y - at(0, -h).y) / (2 * h),
                     xy = (at(0, h).x - at(0, -h).x) / (2 * h),
                     yx = (at(h, 0).y - at(-h, 0).y) / (2 * h);
        EXPECT_NEAR(xy, yx, 1e-8) << "the Jacobian is symmetric";
        least = std::min(least, (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy));
      }
      return least;
    };
    double rim = 0;  // where D(r) = r (f - 3 q r) is the reach
    if (!std::isfinite(lens.reach())) continue;
    for (double r = 0;
         r * (1 + c.k1 * r * r + c.k2 * std::pow(r, 4) + c.k3 * std::pow(r, 6) - 3 * q * r) <
         lens.reach() * (1 - 1e-6);
         r += 1e-4)
      rim = r;
    for (double r = 0; r < 0.98 * rim; r += 0.05 * rim) EXPECT_GT(positive(r), 0) << r / rim;
    EXPECT_LT(positive(1.05 * rim + (q > 0 ? rim : 0)), 0) << "the negative control";
  }
}

namespace {
SensorGeometry wide(const BrownConrady& lens = {}) {
  SensorGeometry g;
  g.width = 40, g.height = 30, g.focal_length_px = 45, g.principal_x = 21, g.principal_y = 14;
  g.distortion = lens;
  return g;
}
const SpectralGridPtr band = SpectralGrid::make({550});
Sensor sensorOf(const SensorGeometry& g) { return Sensor(g, band, band); }
const Platform above = Platform::fixed(Pose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0}));

// Where a ray's direction comes to lie behind the lens, in pixels from the corner.
ImagePoint behind(const SensorGeometry& g, const BrownConrady& lens, const CDVector& d) {
  const ImagePoint p = inComponents(lens, {-d.x / d.z, d.y / d.z});
  return {p.x * g.focal_length_px + g.principal_x, p.y * g.focal_length_px + g.principal_y};
}
}  // namespace

TEST(SensorIdentity, RaysThroughALensComeBackToTheirPixels) {
  const BrownConrady lens{-0.21, 0.05, 0.002, 0.0014, -0.0007};
  const SensorGeometry g = wide(lens);
  double without = 0;
  for (std::size_t y = 0; y < g.height; ++y)
    for (std::size_t x = 0; x < g.width; ++x) {
      const ImagePoint middle{double(x) + 0.5, double(y) + 0.5};
      const CDVector d = sensorOf(g).ray(x, y, 0, above, 0, 1).direction;
      EXPECT_LT(apart(behind(g, lens, d), middle), 1e-10);
      const CDVector pinhole = sensorOf(wide()).ray(x, y, 0, above, 0, 1).direction;
      without = std::max(without, apart(behind(g, lens, pinhole), middle));
    }
  EXPECT_GT(without, 1) << "the negative control: a pinhole is off by a pixel";
}

TEST(SensorIdentity, ALineOfDetectorsHasALensToo) {
  SensorGeometry g = wide({-0.21, 0.05, 0, 0.002, 0});
  g.kind = SensorKind::pushbroom, g.row_time_s = 1;
  const Platform flight =
      Platform::straight(Pose::looking({0, 0, 15}, {0, 0, -1}, {0, 1, 0}), {0, -1, 0}, 1, 0);
  for (const std::size_t x : {0u, 20u, 39u}) {
    const CDVector d = sensorOf(g).ray(x, 3, 0, flight, 0, 1).direction;
    const ImagePoint at = behind(g, g.distortion, d);
    EXPECT_NEAR(at.x, double(x) + 0.5, 1e-10);
    EXPECT_NEAR(at.y, g.principal_y, 1e-10);
  }
  g.kind = SensorKind::lineScanner;
  EXPECT_THROW(sensorOf(g), Refusal);
  SensorGeometry folded = wide({-0.9, 0, 0, 0, 0});
  EXPECT_THROW(sensorOf(folded), Refusal);
}

// Detector of 0.8 x 0.5 pixels: the rays fill it evenly, and nothing else.
TEST(SensorInvariant, RaysFillTheDetector) {
  for (const SensorKind kind :
       {SensorKind::framing, SensorKind::pushbroom, SensorKind::lineScanner}) {
    SensorGeometry g = wide();
    g.kind = kind, g.samples = 4096, g.jitter = true;
    g.detector = DetectorSize{0.8, 0.5};
    if (kind != SensorKind::framing) g.row_time_s = 1;
    const Sensor sensor = sensorOf(g);
    const bool sweeps = kind == SensorKind::lineScanner;
    double least_u = 1e9, most_u = -1e9, least_v = 1e9, most_v = -1e9, mean_u = 0, mean_v = 0;
    for (std::size_t s = 0; s < g.samples; ++s) {
      const CDVector d = sensor.ray(3, 2, s, above, 0, 1).direction;
      const double u = (sweeps ? std::atan2(d.x, -d.z) : -d.x / d.z) * g.focal_length_px,
                   v = (sweeps ? -d.y / std::hypot(d.x, d.z) : d.y / d.z) * g.focal_length_px;
      least_u = std::min(least_u, u), most_u = std::max(most_u, u), mean_u += u / 4096;
      least_v = std::min(least_v, v), most_v = std::max(most_v, v), mean_v += v / 4096;
    }
    const double mid_u = 3.5 - g.principal_x,
                 mid_v = kind == SensorKind::framing ? 2.5 - g.principal_y : 0;
    constexpr double cell = 1.0 / 64;  // of 64 x 64: no edge is farther from a ray
    EXPECT_GE(least_u, mid_u - 0.4 - 1e-9);
    EXPECT_LE(least_u, mid_u - 0.4 + 0.8 * cell);
    EXPECT_LE(most_u, mid_u + 0.4 + 1e-9);
    EXPECT_GE(most_u, mid_u + 0.4 - 0.8 * cell);
    EXPECT_GE(least_v, mid_v - 0.25 - 1e-9);
    EXPECT_LE(least_v, mid_v - 0.25 + 0.5 * cell);
    EXPECT_LE(most_v, mid_v + 0.25 + 1e-9);
    EXPECT_GE(most_v, mid_v + 0.25 - 0.5 * cell);
    EXPECT_NEAR(mean_u, mid_u, 0.8 * cell * 0.29 / 64 * 5);  // 5 standard errors of 4096 cells
    EXPECT_NEAR(mean_v, mid_v, 0.5 * cell * 0.29 / 64 * 5);
  }
}

// A detector of one pixel is the pixel: the very bits.
TEST(SensorInvariant, WithoutFinerOpticsTheBitsAreThoseOfBefore) {
  SensorGeometry plain = wide(), named = wide();
  named.detector = DetectorSize{1, 1};
  plain.samples = named.samples = 5, plain.jitter = named.jitter = true;
  for (std::size_t s = 0; s < 5; ++s) {
    const CDVector a = sensorOf(plain).ray(7, 9, s, above, 0, 3).direction,
                   b = sensorOf(named).ray(7, 9, s, above, 0, 3).direction;
    EXPECT_LT((a - b).getLength(), 1e-15);
  }
}
