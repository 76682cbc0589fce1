// Degrees and radians (nw/base/Angles.nw).
#include "malus/base/Angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace malus;

TEST(AnglesIdentity, RightAnglesAreExact) {
  for (const int turns : {0, 1, 2, 4}) {
    EXPECT_EQ(toRadians(90 * turns), turns * std::numbers::pi / 2);
    EXPECT_EQ(90 * turns * degree, turns * std::numbers::pi / 2);
    EXPECT_EQ(toDegrees(turns * std::numbers::pi / 2), 90 * turns);
  }
}

// The digits that the chapter prints: multiplied first, or divided first.
TEST(AnglesIdentity, ThereAreTwoRoundings) {
  EXPECT_EQ(toRadians(3), 0.05235987755982988);
  EXPECT_EQ(3 * degree, 0.05235987755982989);
  int differ = 0;
  for (int angle = 0; angle <= 360; ++angle) differ += toRadians(angle) != angle * degree;
  EXPECT_EQ(differ, 93);
}

// Three roundings, each of half a unit in the last place at most.
TEST(AnglesIdentity, ThereAndBack) {
  const auto misses = [](double factor) {
    int missed = 0;
    for (int angle = 1; angle <= 360; ++angle)
      missed += std::abs(toDegrees(toRadians(angle) * factor) / angle - 1) > 4e-16;
    return missed;
  };
  EXPECT_EQ(misses(1), 0);
  EXPECT_EQ(misses(1.001), 360);  // control
}

TEST(AnglesIdentity, FractionsOfATurn) {
  const auto worst = [](double factor) {
    double most = 0;
    for (int i = 0; i <= 2000; ++i) {
      const double turns = i / 1000.0, angle = 2 * std::numbers::pi * turns * factor;
      const auto [cosine, sine] = cosineAndSine(turns);
      most = std::max(
          {most, std::abs(cosine - std::cos(angle)), std::abs(sine - std::sin(angle))});
    }
    return most;
  };
  for (int i = 0; i <= 2000; ++i) {
    const auto [x, y] = pointOnCircle(i / 1000.0);
    EXPECT_NEAR(x * x + y * y, 1, 8e-16) << i;  // seven roundings of 1.1e-16
    EXPECT_NEAR(x, cosineAndSine(i / 1000.0)[0], 2e-9) << i;
  }
  EXPECT_LT(worst(1), 1e-9);
  EXPECT_GT(worst(1 + 1e-8), 1e-9);  // control
}
