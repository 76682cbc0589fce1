// The day over Rochester (nw/thesis/Section78.nw).
#include "thesis/Section78.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace malus;

namespace {
constexpr double degree = std::numbers::pi / 180;
}

TEST(Section78Identity, TwelveHoursAnHourApart) {
  const std::vector<CDHourOfDay> day = rochesterDay();
  ASSERT_EQ(day.size(), 12u);
  for (std::size_t i = 0; i < day.size(); ++i) {
    EXPECT_EQ(day[i].hour, 7 + static_cast<int>(i));
    // Julian days resolve 40 microseconds
    EXPECT_NEAR((day[i].moment.julian_day - day[0].moment.julian_day) * 24,
                static_cast<double>(i), 1e-7);
  }
  EXPECT_EQ(toString(day[0].moment), "2001-06-04T11:00:00Z");
}

// Elementary: sin(height) = sin(lat) sin(dec) + cos(lat) cos(dec) cos(H), and the hour angle H turns
// by 15 degrees an hour. Equation of time and declination move in half a day by less than 0.01 deg
// (15 s a day) and 0.06 deg; from the one hour of the highest sun the others follow within 0.1 deg.
TEST(Section78Invariant, TheSunTurnsByFifteenDegreesAnHour) {
  const std::vector<CDHourOfDay> day = rochesterDay();
  const double lat = rochester_latitude_deg * degree;
  const auto hourAngle = [&](const CDHourOfDay& at) {
    const CDVector d = at.sun.toSun();
    return std::atan2(-d.x, d.z * std::cos(lat) - d.y * std::sin(lat)) / degree;
  };
  for (const CDHourOfDay& at : day)
    EXPECT_NEAR(hourAngle(at) - hourAngle(day[0]), 15.0 * (at.hour - 7), 0.1);
  EXPECT_GT(std::abs(hourAngle(day[11]) - hourAngle(day[0]) - 15.0 * 10.9),
            0.1);  // negative control
}
