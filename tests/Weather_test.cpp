// The weather of a scene (nw/scene/Weather.nw).
#include "malus/scene/Weather.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
const InputPlace here{"test", 1, "time"};
constexpr const char* header =
    "time,air_C,wind_m_s,direct_normal_W_m2,diffuse_horizontal_W_m2,dew_point_C\n";

class WeatherTable : public ::testing::Test {
 protected:
  Scratch scratch_;
  Weather read(const std::string& text) {
    std::ofstream(scratch_.path / "june.csv") << text;
    return Weather::read(scratch_.path / "june.csv");
  }
  /// The complaint, without the folder.
  std::string complaint(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string what = error.what(), folder = scratch_.path.string() + "/";
      return what.starts_with(folder) ? what.substr(folder.size()) : what;
    }
    return "";
  }
};
const std::string good = std::string(header) +
                         "2001-06-10T04:00:00Z,20,2,0,0,10\n"
                         "2001-06-10T01:00:00-04:00,16,4,100,50,10\n"
                         "2001-06-10T06:00:00Z,18,0,300,70,8\n";
std::string with(const std::string& from, const std::string& to) {
  std::string text = good;
  return text.replace(text.find(from), from.size(), to);
}
}  // namespace

// By hand in the chapter: emissivity 0.711 + 0.056 + 0.0073 (Berdahl and Martin 1984), and 419 W/m^2 of a black body.
TEST(WeatherPublished, AClearSky) {
  const double black = 5.670374419e-8 * std::pow(293.15, 4);
  EXPECT_NEAR(clearSkyLongwave_W_m2(293.15, 10) / black, 0.7743, 1e-9);
  EXPECT_NEAR(clearSkyLongwave_W_m2(293.15, 10), 324, 0.5);
  EXPECT_NEAR(clearSkyLongwave_W_m2(300, 0) / clearSkyLongwave_W_m2(300, -20),
              0.711 / (0.711 - 0.112 + 0.0292), 1e-12);
  EXPECT_DOUBLE_EQ(convection_W_m2_K(2), 13.3);
}

TEST_F(WeatherTable, GoesAlongStraightLines) {
  const Weather weather = read(good);
  EXPECT_EQ(toString(weather.begins()), "2001-06-10T04:00:00Z");
  EXPECT_EQ(toString(weather.ends()), "2001-06-10T06:00:00Z");
  EXPECT_EQ(weather.step_s(), 3600);
  const WeatherMoment row = weather.at(readMoment("2001-06-10T05:00:00Z", here));
  EXPECT_NEAR(row.air_K, 289.15, 1e-6);
  EXPECT_NEAR(row.direct_W_m2, 100, 1e-5);
  EXPECT_NEAR(row.longwave_W_m2, clearSkyLongwave_W_m2(289.15, 10), 1e-4);
  const WeatherMoment between = weather.at(readMoment("2001-06-10T04:30:00Z", here));
  EXPECT_NEAR(between.air_K, 291.15, 1e-6);
  EXPECT_NEAR(between.wind_m_s, 3, 1e-6);
  EXPECT_NEAR(between.diffuse_W_m2, 25, 1e-5);
  // the sky's own column, if there is one
  std::string text = good;
  text.replace(text.find("dew_point_C"), 11, "sky_longwave_W_m2");
  for (const char* end : {",10\n", ",10\n", ",8\n"})
    text.replace(text.find(end), std::string(end).size(), ",333\n");
  EXPECT_EQ(read(text).at(weather.begins()).longwave_W_m2, 333);
}

TEST_F(WeatherTable, HasNoWeatherElsewhere) {
  const Weather weather = read(good);
  EXPECT_NO_THROW(weather.at(weather.ends()));
  EXPECT_THROW(weather.at(weather.ends().later(60)), MathError);
  EXPECT_THROW(weather.at(weather.begins().later(-60)), MathError);
  EXPECT_THROW(Weather(weather.begins(), 0, {{}, {}}), MathError);
  EXPECT_THROW(Weather(weather.begins(), 3600, {{}}), MathError);
}

TEST_F(WeatherTable, RefusesWhatIsBroken) {
  EXPECT_EQ(complaint(good), "");
  EXPECT_EQ(complaint(with("06:00:00Z", "09:00:00Z")),
            "june.csv:4: time = 2001-06-10T09:00:00Z: comes 14400 s after the row before, and "
            "rows come every 3600 s; fill in the missing rows, or cut the file at the gap");
  EXPECT_EQ(complaint(with("01:00:00-04:00", "01:00:00-01:00")),
            "june.csv:3: time = 2001-06-10T01:00:00-01:00: comes -7200 s after the row before; "
            "give rows in order of time, a minute to three hours apart");
  EXPECT_EQ(complaint(with("01:00:00-04:00", "01:00:00")),
            "june.csv:3: time = 2001-06-10T01:00:00: is not a time with its offset from "
            "universal time; write e.g. 2001-06-10T17:06:00Z, or 2001-06-10T13:06:00-04:00");
  EXPECT_EQ(complaint(with(",16,", ",-9999,")),
            "june.csv:3: air_C = -9999: must be -100 to 70 degrees Celsius; if the value is "
            "missing, put one between its neighbours, or cut the file there");
  EXPECT_EQ(complaint(with(",16,", ",,")),
            "june.csv:3: air_C: the number is missing; write a number such as 0.2");
  EXPECT_EQ(complaint(with(",4,100,", ",4,-1,")),
            "june.csv:3: direct_normal_W_m2 = -1: must be 0 to 1500 W/m^2; if the value is "
            "missing, put one between its neighbours, or cut the file there");
  EXPECT_EQ(complaint(with("dew_point_C", "dew_point_K")),
            "june.csv: has no longwave radiation of the sky; give a column sky_longwave_W_m2 "
            "or, for "
            "clear skies, dew_point_C");
  EXPECT_EQ(
      complaint(std::string(header) + "2001-06-10T04:00:00Z,20,2,0,0,10\n"),
      "june.csv: has fewer than two rows; give the weather of the days before the picture");
  EXPECT_NE(complaint(with("wind_m_s", "wind")).find("wind_m_s"), std::string::npos);
}
