// The item on heat and its polarised light (nw/thesis/XThermal.nw).

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "Items.hpp"
#include "malus/air/Sun.hpp"
#include "malus/base/Angles.hpp"
#include "malus/scene/Weather.hpp"

using namespace malus;

TEST(XThermalRegression, TheVerdictsAreTheCommittedOnes) {
  const Item item = ran("X.thermal");
  const Table claims = Table::read("validation/claims.csv");
  std::map<std::string, std::string> committed, now;
  for (std::size_t row = 0; row < claims.rows(); ++row)
    if (claims.cell(row, "item") == "X.thermal")
      committed[claims.cell(row, "claim")] = claims.cell(row, "verdict");
  for (const auto& [name, verdict] : verdictsOf(item))
    now[name] = std::string(toString(verdict));
  EXPECT_EQ(now, committed);
  EXPECT_EQ(now.at("amplitude"), "reproduced");
  EXPECT_EQ(now.at("lag"), "reproduced");
  EXPECT_EQ(item.pictures().size(), 5u);
  // negative control: paint is polarised at some hour, and not as strongly as its emission
  const auto values = valuesOf(item);
  EXPECT_GT(std::stod(values.at("paint.most")), 0.003);
  EXPECT_LT(std::stod(values.at("paint.most")), std::stod(values.at("paint.emitted")));
}

// The formulas in the header of the file; rounding to a watt, and a sun that refraction and the almanac move by 0.02 deg.
TEST(XThermalIdentity, TheWeatherOfJuneIsThatOfItsFormulas) {
  const Table table = Table::read("scenes/data/clear-june.csv");
  const Weather june = Weather::read("scenes/data/clear-june.csv");
  ASSERT_EQ(table.rows(), 8u * 24 + 1);
  for (std::size_t hour = 0; hour < table.rows(); ++hour) {
    const Moment when = june.begins().later(3600.0 * double(hour));
    const double sine = solarPosition(43.16, -77.61, when).toSun().z;
    const double turn = 2 * std::numbers::pi * (double(hour % 24) - 15) / 24;
    EXPECT_NEAR(table.number(hour, "air_C"), 19 + 6 * std::cos(turn), 0.006);
    EXPECT_NEAR(table.number(hour, "wind_m_s"), 2 + std::cos(turn), 0.006);
    if (sine < 0) {
      EXPECT_EQ(table.number(hour, "direct_normal_W_m2"), 0) << hour;
      continue;
    }
    const double height = std::asin(sine) / degree;
    const double mass = 1 / (sine + 0.50572 * std::pow(height + 6.07995, -1.6364));
    EXPECT_NEAR(table.number(hour, "direct_normal_W_m2"),
                1353 * std::pow(0.7, std::pow(mass, 0.678)), 3)
        << hour;
    EXPECT_NEAR(table.number(hour, "diffuse_horizontal_W_m2"), 100 * std::sqrt(sine), 1)
        << hour;
  }
}
