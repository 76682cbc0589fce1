// Directions, ray frames and the sign of the rotation between them (nw/base/CDVector.nw).
#include "malus/base/CDVector.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();
// a dozen operations on unit vectors, each rounding by 1.1e-16
constexpr double rounding = 4e-15;

using Stokes = std::array<double, 4>;
using Field = std::array<std::complex<double>, 3>;

double distance(const CDVector& a, const CDVector& b) { return (a - b).getLength(); }

struct Draw {
  std::mt19937_64 engine;
  explicit Draw(unsigned seed) : engine(seed) {}
  double operator()() { return std::normal_distribution<double>()(engine); }
  CDVector direction() { return normalized({(*this)(), (*this)(), (*this)()}); }
};

// the component of a complex field along a real axis
std::complex<double> along(const Field& e, const CDVector& axis) {
  return e[0] * axis.x + e[1] * axis.y + e[2] * axis.z;
}

// eqs 3.27-3.30 for E = Re[E0 exp(-i w t)] with x = s, y = p. For y = i x the tip is at
// (cos wt, sin wt): counter-clockwise for an observer facing the source, S3 > 0 (table 3.1).
Stokes stokesOf(const Field& e, const RayFrame& frame) {
  const auto x = along(e, frame.s), y = along(e, frame.p);
  const auto cross = std::conj(x) * y;
  return {std::norm(x) + std::norm(y), std::norm(x) - std::norm(y), 2 * cross.real(),
          2 * cross.imag()};
}

// eq 3.48 written out
Stokes rotated(const Stokes& v, double theta) {
  const double c = std::cos(2 * theta), s = std::sin(2 * theta);
  return {v[0], c * v[1] + s * v[2], -s * v[1] + c * v[2], v[3]};
}

double worst(const Stokes& a, const Stokes& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}
}  // namespace

TEST(CDVectorIdentity, Arithmetic) {
  const CDVector a{1, 2, 3}, b{-4, 0.5, 2};
  EXPECT_EQ(a + b, (CDVector{-3, 2.5, 5}));
  EXPECT_EQ(a - b, (CDVector{5, 1.5, 1}));
  EXPECT_EQ(-a, (CDVector{-1, -2, -3}));
  EXPECT_EQ(a * 2, (CDVector{2, 4, 6}));
  EXPECT_EQ(2 * a, a * 2);
  EXPECT_EQ(a / 2, (CDVector{0.5, 1, 1.5}));
  EXPECT_EQ(dot(a, b), 3);
  EXPECT_EQ(cross(a, b), (CDVector{2 * 2 - 3 * 0.5, 3 * -4 - 1 * 2, 1 * 0.5 - 2 * -4}));
  EXPECT_EQ(cross({1, 0, 0}, {0, 1, 0}), (CDVector{0, 0, 1}));
  EXPECT_NE(a, b);
}

TEST(CDVectorIdentity, ForbiddenOperations) {
  const CDVector zero;
  EXPECT_THROW((CDVector{1, 2, 3}) / 0.0, MathError);
  EXPECT_THROW((CDVector{1, 2, 3}) / -0.0, MathError);
  EXPECT_THROW(zero.getZenith(), MathError);
  EXPECT_THROW(zero.getAzimuth(), MathError);
  EXPECT_THROW((void)normalized(zero), MathError);
  for (const double bad : {not_a_number, infinite, -infinite}) {
    EXPECT_THROW((void)normalized({1, bad, 0}), MathError) << bad;
    EXPECT_THROW((CDVector{0, 0, bad}).getZenith(), MathError) << bad;
    EXPECT_THROW(CDVector::fromAngles(bad, 0), MathError) << bad;
    EXPECT_THROW(CDVector::fromAngles(0, bad), MathError) << bad;
    EXPECT_THROW(rayFrame({0, 0, 1}, {bad, 0, 0}), MathError) << bad;
  }
  EXPECT_THROW(rayFrame(zero, {0, 0, 1}), MathError);
  EXPECT_THROW(rayFrame({0, 0, 1}, zero), MathError);
}

TEST(CDVectorIdentity, LengthNeitherOverflowsNorUnderflows) {
  // correctly rounded inputs 3:4:12 give 13 to within an ulp or two
  EXPECT_NEAR((CDVector{3e200, 4e200, 12e200}).getLength() / 13e200, 1, 4e-16);
  EXPECT_NEAR((CDVector{3e-200, 4e-200, 12e-200}).getLength() / 13e-200, 1, 4e-16);
  EXPECT_NEAR(normalized({3e-200, 4e-200, 12e-200}).z, 12.0 / 13, 4e-16);
}

TEST(CDVectorIdentity, AnglesAtThePolesAndTheSeam) {
  EXPECT_EQ((CDVector{0, 0, 2}).getZenith(), 0);
  EXPECT_EQ((CDVector{0, 0, -2}).getZenith(), pi);
  EXPECT_EQ((CDVector{-0.0, 0, -2}).getAzimuth(), 0);  // not pi, which atan2(0, -0) would give
  EXPECT_EQ((CDVector{0, -0.0, 2}).getAzimuth(), 0);
  EXPECT_EQ((CDVector{1, 0, 0}).getAzimuth(), 0);
  EXPECT_EQ((CDVector{0, 1, 0}).getAzimuth(), pi / 2);
  EXPECT_EQ((CDVector{-1, 0, 0}).getAzimuth(), pi);
  EXPECT_EQ((CDVector{0, -1, 0}).getAzimuth(), 3 * pi / 2);
  EXPECT_EQ((CDVector{1, -1e-300, 0}).getAzimuth(), 0);  // 2 pi would lie outside of [0, 2 pi)
  // an arc cosine would say 0 here
  EXPECT_DOUBLE_EQ((CDVector{1e-12, 0, 1}).getZenith(), 1e-12);
}

RC_GTEST_PROP(CDVectorIdentity, AnglesRoundTrip, (unsigned seed)) {
  Draw draw(seed);
  const CDVector v = draw.direction();
  const CDVector back = CDVector::fromAngles(v.getZenith(), v.getAzimuth());
  RC_ASSERT(distance(v, back) < rounding);
  RC_ASSERT(v.getAzimuth() >= 0);
  RC_ASSERT(v.getAzimuth() < 2 * pi);
  RC_ASSERT(distance(v, CDVector::fromAngles(v.getZenith(), v.getAzimuth() + 1e-6)) >
            rounding * std::abs(std::sin(v.getZenith())));  // negative control
}

// eqs 7.2, 7.3, 7.9, 7.10: the printed vectors have the printed angles, to the three printed
// digits
TEST(CDVectorPublished, FlatPlateDirections) {
  const double half_digit = 0.0005;  // of the printed components, which are of order one
  EXPECT_LT(distance(CDVector::fromAngles(pi / 6, pi), {-.5, 0, .866}), half_digit);
  EXPECT_LT(distance(CDVector::fromAngles(pi * 40 / 180, 0), {.643, 0, .766}), half_digit);
  EXPECT_GT(distance(CDVector::fromAngles(pi * 41 / 180, 0), {.643, 0, .766}),
            half_digit);  // control
}

RC_GTEST_PROP(CDVectorInvariant, FramesAreRightHandedAndOrthonormal, (unsigned seed)) {
  Draw draw(seed);
  const CDVector normal = 3 * draw.direction();
  // from well apart down to parallel, both ways
  for (const double tilt : {1.0, 1e-3, 1e-6, 1e-9, 1e-11, 1e-13, 1e-16, 0.0})
    for (const double way : {1.0, -1.0}) {
      const auto [s, p, k] = rayFrame(way * normal + tilt * draw.direction(), normal);
      RC_ASSERT(std::abs(s.getLength() - 1) < rounding);
      RC_ASSERT(std::abs(p.getLength() - 1) < rounding);
      RC_ASSERT(std::abs(dot(s, k)) < rounding);
      RC_ASSERT(distance(cross(s, p), k) < rounding);
      if (tilt >= 1e-3) RC_ASSERT(std::abs(dot(s, normal)) < 3 * rounding / tilt);
    }
}

TEST(CDVectorIdentity, FrameOfALevelRayAndOfARayAlongTheNormal) {
  const CDVector up{0, 0, 1};
  const auto level = rayFrame({1, 0, 0}, up);  // the worked example of the chapter
  EXPECT_EQ(level.s, (CDVector{0, 1, 0}));
  EXPECT_EQ(level.p, (CDVector{0, 0, 1}));
  EXPECT_EQ(rayFrame(up, up).s, (CDVector{0, 1, 0}));
  EXPECT_EQ(rayFrame(-up, up).s, (CDVector{0, 1, 0}));
  // it is the limit for rays of azimuth zero, upward and downward
  EXPECT_EQ(rayFrame({1e-6, 0, 1}, up).s, (CDVector{0, 1, 0}));
  EXPECT_EQ(rayFrame({1e-6, 0, -1}, up).s, (CDVector{0, 1, 0}));
  // a normal along x takes y in its place
  EXPECT_EQ(rayFrame({1, 0, 0}, {1, 0, 0}).s, (CDVector{0, 0, 1}));
}

TEST(CDVectorIdentity, RolledCameraSeesHorizontalAsVertical) {
  const RayFrame ground = rayFrame({1, 0, 0}, {0, 0, 1});
  const RayFrame camera{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}};
  EXPECT_DOUBLE_EQ(frameRotation(ground, camera), pi / 2);
  EXPECT_DOUBLE_EQ(frameRotation(camera, ground), -pi / 2);
}

// The sign against eq 3.48, from the components of one field along the axes of two frames.
RC_GTEST_PROP(CDVectorIdentity, RotationCarriesStokesFromFrameToFrame, (unsigned seed)) {
  Draw draw(seed);
  const CDVector k = draw.direction();
  const RayFrame from = rayFrame(k, draw.direction()), to = rayFrame(k, draw.direction());
  // any complex field across the ray: the part along k is taken off, axis by axis
  Field e{{{draw(), draw()}, {draw(), draw()}, {draw(), draw()}}};
  const auto longitudinal = along(e, k);
  e = {e[0] - longitudinal * k.x, e[1] - longitudinal * k.y, e[2] - longitudinal * k.z};
  const Stokes before = stokesOf(e, from), after = stokesOf(e, to);
  const double theta = frameRotation(from, to);
  const double tolerance =
      40 * rounding * (1 + before[0]);  // some forty products and sums on the way
  RC_ASSERT(worst(rotated(before, theta), after) < tolerance);
  // negative control: the other way round fails, unless sin(2 theta) or the linear part
  // vanishes
  const double seen = std::abs(std::sin(2 * theta)) * std::hypot(before[1], before[2]);
  if (seen > 1e-6 * (1 + before[0]))
    RC_ASSERT(worst(rotated(before, -theta), after) > tolerance);
}

RC_GTEST_PROP(CDVectorInvariant, RotationsCompose, (unsigned seed)) {
  Draw draw(seed);
  const CDVector k = draw.direction();
  const auto a = rayFrame(k, draw.direction()), b = rayFrame(k, draw.direction()),
             c = rayFrame(k, draw.direction());
  const double sum = frameRotation(a, b) + frameRotation(b, c) - frameRotation(a, c);
  RC_ASSERT(std::abs(std::remainder(sum, 2 * pi)) < 40 * rounding);
  RC_ASSERT(std::abs(std::remainder(sum + 1e-9, 2 * pi)) > 40 * rounding);  // negative control
}

TEST(CDVectorIdentity, FramesOfDifferentRaysAreRefused) {
  const RayFrame a = rayFrame({1, 0, 0}, {0, 0, 1});
  EXPECT_THROW(frameRotation(a, rayFrame({-1, 0, 0}, {0, 0, 1})), MathError);
  EXPECT_THROW(frameRotation(a, rayFrame({1, 1e-6, 0}, {0, 0, 1})), MathError);
  EXPECT_NO_THROW(frameRotation(a, rayFrame({1, 1e-12, 0}, {0, 0, 1})));
  EXPECT_THROW(frameRotation(a, {{0, 1, 0}, {0, 0, 1}, {not_a_number, 0, 0}}), MathError);
}
