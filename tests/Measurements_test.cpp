// Measures of curves against closed forms (nw/thesis/Measurements.nw).
#include "malus/thesis/Measurements.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
// Golden section stops where values no longer differ: sqrt(epsilon) times the width of the peak.
constexpr double peak_tolerance = 1e-6;
constexpr double root_tolerance =
    1e-9;  // halving; limited by the peak's height, which is relative 1e-16

Curve gaussian(double centre, double sigma) {
  return [=](double x) { return 3.0 * std::exp(-0.5 * std::pow((x - centre) / sigma, 2)); };
}
}  // namespace

TEST(MeasurementsIdentity, GaussianHasItsPeakAndWidth) {
  const Lobe lobe = measureLobe(gaussian(12.34567, 5.0), -40, 60);
  EXPECT_NEAR(lobe.peak.x, 12.34567, peak_tolerance);
  EXPECT_NEAR(lobe.peak.y, 3.0, 1e-12);
  EXPECT_NEAR(lobe.width(), 2 * std::sqrt(2 * std::numbers::ln2) * 5.0, root_tolerance);
  EXPECT_FALSE(lobe.clipped_left || lobe.clipped_right);
}

TEST(MeasurementsIdentity, NegativeControlShiftedGaussianIsSeen) {
  EXPECT_GT(std::abs(maximize(gaussian(12.3457, 5.0), -40, 60).x - 12.34567), peak_tolerance);
}

TEST(MeasurementsIdentity, AnIntervalClipsTheLobe) {
  const Lobe lobe = measureLobe(gaussian(58, 5.0), -40, 60);
  EXPECT_TRUE(lobe.clipped_right);
  EXPECT_FALSE(lobe.clipped_left);
  EXPECT_EQ(lobe.right, 60);
  EXPECT_NEAR(lobe.width(), 2 + std::sqrt(2 * std::numbers::ln2) * 5.0, root_tolerance);
}

TEST(MeasurementsIdentity, PeakMayBeAnEndOrAKink) {
  EXPECT_EQ(maximize([](double x) { return x; }, 0, 2).x, 2);
  EXPECT_EQ(maximize([](double x) { return -x; }, 0, 2).x, 0);
  EXPECT_NEAR(maximize([](double x) { return -std::abs(x - 0.777); }, 0, 2).x, 0.777, 1e-9);
}

TEST(MeasurementsIdentity, LocalMaximaOfASine) {
  const auto maxima = localMaxima([](double x) { return std::sin(x); }, 0, 20);
  ASSERT_EQ(maxima.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(maxima[i].x, std::numbers::pi * (0.5 + 2.0 * static_cast<double>(i)),
                peak_tolerance);
  EXPECT_TRUE(localMaxima([](double x) { return x * x; }, -1, 1).empty());
}

TEST(MeasurementsIdentity, SecondaryPeakBeyondATrough) {
  const Curve two = [](double x) { return gaussian(0, 1)(x) + 0.5 * gaussian(10, 1)(x); };
  const SecondaryPeak right = secondaryPeak(two, 2, 15), left = secondaryPeak(two, 8, -5);
  EXPECT_NEAR(right.peak.x, 10, peak_tolerance);
  EXPECT_NEAR(right.rise, 1 - two(5) / two(10),
              0.01);                            // samples, 400 of them, beside the trough
  EXPECT_NEAR(left.peak.x, 0, peak_tolerance);  // the interval may run either way
  EXPECT_EQ(secondaryPeak(gaussian(0, 1), 1, 5).rise, 0);
  // a ripple of a thousandth is measured as one
  const Curve ripple = [](double x) { return 10 - x + 0.01 * std::sin(200 * x); };
  EXPECT_LT(secondaryPeak(ripple, 0, 5).rise, 0.01);
}

TEST(MeasurementsIdentity, RootOfACosineAndRefusal) {
  EXPECT_NEAR(findRoot([](double x) { return std::cos(x); }, 0, 3), std::numbers::pi / 2,
              1e-15);
  EXPECT_THROW(findRoot([](double) { return 1.0; }, 0, 1), MathError);
}

TEST(MeasurementsIdentity, LineAndItsResidual) {
  const Line exact = fitLine({0, 1, 2, 3}, {1, 3, 5, 7});
  EXPECT_NEAR(exact.slope, 2, 1e-15);
  EXPECT_NEAR(exact.intercept, 1, 1e-15);
  EXPECT_NEAR(exact.residual, 0, 1e-15);
  // y = 0, 1, 0 at x = -1, 0, 1: slope 0 through the mean 1/3; farthest point 2/3 away
  EXPECT_NEAR(fitLine({-1, 0, 1}, {0, 1, 0}).residual, 2.0 / 3, 1e-15);
  EXPECT_THROW(fitLine({1, 1}, {0, 1}), MathError);
  EXPECT_THROW(fitLine({1}, {0}), MathError);
}
