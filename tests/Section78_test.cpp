// The day over Rochester (nw/thesis/Section78.nw).
#include "malus/thesis/Section78.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "Items.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Scene.hpp"
#include "malus/thesis/Pictures.hpp"

using namespace malus;

namespace {}

TEST(Section78Identity, TwelveHoursAnHourApart) {
  const std::vector<HourOfDay> day = rochesterDay();
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
  const std::vector<HourOfDay> day = rochesterDay();
  const double lat = rochester_latitude_deg * degree;
  const auto hourAngle = [&](const HourOfDay& at) {
    const CDVector d = at.sun.toSun();
    return std::atan2(-d.x, d.z * std::cos(lat) - d.y * std::sin(lat)) / degree;
  };
  for (const HourOfDay& at : day)
    EXPECT_NEAR(hourAngle(at) - hourAngle(day[0]), 15.0 * (at.hour - 7), 0.1);
  EXPECT_GT(std::abs(hourAngle(day[11]) - hourAngle(day[0]) - 15.0 * 10.9),
            0.1);  // negative control
}

namespace {
/// Largest angle between the suns of a scene's frames and those of the chapter [rad].
double largestDifference(const Scene& scene) {
  double most = 0;
  const std::vector<HourOfDay> day = rochesterDay();
  for (std::size_t hour = 0; hour < scene.platform.frames(); ++hour) {
    World moved = scene.world;
    scene.move_sun(moved, scene.platform.time_s(hour));
    most = std::max(most, cross(moved.sun->to_sun, day.at(hour).sun.toSun()).getLength());
  }
  return most;
}
}  // namespace

TEST(Section78Identity, TheSceneFileHasTheSunsOfTheChapter) {
  const Scene scene = chunkyScene("rochester-day", 16);
  ASSERT_EQ(scene.platform.frames(), rochesterDay().size());
  EXPECT_LT(largestDifference(scene), 1e-7);  // Julian days resolve 40 microseconds
  EXPECT_GT(largestDifference(chunkyScene(    // negative control: a minute later
                "rochester-day", 16, R"({"sun": {"time": "2001-06-04T07:01:00-04:00"}})")),
            1e-3);
}

// Elementary: a Lambertian top under sun and uniform sky has the radiance rho/pi (E cos z + pi L).
TEST(Section78Identity, AMattTopFollowsTheCosineOfTheSun) {
  const Scene scene = chunkyScene(
      "rochester-day", 32,
      R"({"materials": {"copper-010": {"model": "lambertian", "reflectance": 0.2, "n": null, "k": null, "sigma": null}},
          "radiometry": {"rays": [401]}})");
  const std::vector<HourOfDay> day = rochesterDay();
  for (std::size_t hour = 0; hour < day.size(); ++hour) {
    const StokesImage image = renderImage(scene, hour);
    const double top = meanOver(image.stokes[0], insideOf(image, "2.top"));
    const auto expected = [&](std::size_t at) {
      return 0.2 / std::numbers::pi *
             (std::cos(day[at].sun.zenith_rad) + 0.05 * std::numbers::pi);
    };
    // the grid sums the cosine to a few parts in a thousand (chapter Radiometry)
    EXPECT_NEAR(top, expected(hour), 3e-3 * expected(hour)) << hour;
    if (hour < 3) {  // negative control: the sun of the next hour
      EXPECT_GT(std::abs(top - expected(hour + 1)), 3e-3 * expected(hour)) << hour;
    }
  }
}

// One test for both, because each test is a process that renders the day. What the sentences compare: smooth copper shines shortly, rough
// copper long, and the DoLP reverses it.
TEST(Section78Published, TheDayShowsWhatTheThesisSawAndTheTrendIsReversedInTheDoLP) {
  std::map<std::string, std::map<std::string, std::string>> left;
  for (const char* id : {"F7.39", "F7.40", "F7.41", "F7.42", "F7.43", "F7.44"}) {
    const Item item = ran(id);
    EXPECT_TRUE(named(item, Verdict::differs).empty()) << id;
    EXPECT_GE(named(item, Verdict::reproduced).size(), 1u) << id;
    left[id] = valuesOf(item);
  }
  const auto &bright = left["F7.40"], &polarized = left["F7.44"];
  const auto number = [](const auto& values, const char* name) {
    return std::stod(values.at(name));
  };
  EXPECT_GT(number(bright, "variation2"), number(bright, "variation5"));
  EXPECT_LT(number(bright, "hours2"), number(bright, "hours5"));
  EXPECT_LT(number(polarized, "variation2"), number(polarized, "variation5"));
}
