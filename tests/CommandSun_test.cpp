// malus sun, from outside (nw/app/CommandSun.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "ExtremeNumbers.hpp"
#include "Program.hpp"
#include "malus/base/Table.hpp"

using malus::Table;

namespace {
Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}
const char* const nrel =
    "sun --latitude-deg 39.742476 --longitude-deg -105.1786 --time 2003-10-17T12:30:30-07:00";
}  // namespace

// Reda and Andreas, NREL/TP-560-34302, table A5.1; tolerances as in Sun_test.
TEST(CommandSunPublished, NrelWorkedExample) {
  const Scratch scratch;
  const Outcome outcome = malusIn(scratch.path, nrel);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Table answer = tableOf(outcome.out);
  ASSERT_EQ(answer.rows(), 1u);
  EXPECT_NEAR(answer.number(0, "zenith_deg"), 50.11162 + 0.01633, 1e-4);
  EXPECT_NEAR(answer.number(0, "azimuth_deg"), 194.34024, 2e-4);
  EXPECT_GT(std::abs(answer.number(0, "azimuth_deg") - 194.341), 2e-4);  // negative control
  EXPECT_EQ(answer.cell(0, "time"), "2003-10-17T12:30:30-07:00");
  EXPECT_EQ(answer.cell(0, "latitude_deg"), "39.742476");  // the question as it was put
}

TEST(CommandSunIdentity, AFileAsksTheSame) {
  const Scratch scratch;
  put(scratch / "places.csv",
      "time,latitude_deg,longitude_deg\n2003-10-17T19:30:30Z,39.742476,-105.1786\n2001-06-"
      "10T17:08:00Z,43.16,-77.61\n");
  const Outcome outcome = malusIn(scratch.path, "sun --input places.csv --out suns.csv");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  const Table file = Table::read(scratch / "suns.csv"),
              flags = tableOf(malusIn(scratch.path, nrel).out);
  ASSERT_EQ(file.rows(), 2u);
  EXPECT_EQ(file.cell(0, "zenith_deg"), flags.cell(0, "zenith_deg"));
  EXPECT_NE(file.cell(1, "zenith_deg"), flags.cell(0, "zenith_deg"));
}

TEST(CommandSunIdentity, ASeriesOfTwelveHours) {
  const Scratch scratch;
  const Outcome outcome = malusIn(scratch.path,
                                  "sun --latitude-deg 43.16 --longitude-deg -77.61 --time "
                                  "2001-06-21T07:00:00-04:00 --until "
                                  "2001-06-21T18:00:00-04:00");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Table answer = tableOf(outcome.out);
  ASSERT_EQ(answer.rows(), 12u);
  EXPECT_EQ(answer.cell(0, "time"), "2001-06-21T11:00:00Z");
  EXPECT_EQ(answer.cell(11, "time"), "2001-06-21T22:00:00Z");
  const std::vector<double> azimuth = answer.column("azimuth_deg");
  EXPECT_TRUE(std::is_sorted(azimuth.begin(), azimuth.end()));
}

TEST(CommandSunInvariant, BadInputIsOneLineAndExitCodeTwo) {
  const Scratch scratch;
  put(scratch / "none.csv", "time,latitude_deg,longitude_deg\n");
  put(scratch / "bad.csv",
      "time,latitude_deg,longitude_deg\n2001-06-10T17:08:00Z,43.16,-77.61\n2001-06-10T17:08:"
      "00Z,91,0\n");
  put(scratch / "column.csv",
      "time,latitude_deg,longtitude_deg\n2001-06-10T17:08:00Z,43.16,-77.61\n");
  const std::string place = "sun --latitude-deg 43.16 --longitude-deg -77.61 ";
  for (const std::string& bad :
       {std::string("sun"), place, place + "--time noon", place + "--time 2001-06-10T17:08:00",
        std::string("sun --latitude-deg 91 --longitude-deg 0 --time 2001-06-10T17:08:00Z"),
        std::string("sun --latitude-deg 0 --longitude-deg 181 --time 2001-06-10T17:08:00Z"),
        std::string("sun --latitude-deg x --longitude-deg 0 --time 2001-06-10T17:08:00Z"),
        place + "--time 2001-06-10T17:08:00Z --until 2001-06-09T17:08:00Z",
        place + "--time 2001-06-10T17:08:00Z --step-min 5",
        place + "--time 2001-06-10T17:08:00Z --until 2001-06-11T17:08:00Z --step-min 0",
        place + "--time 2001-06-10T17:08:00Z --until 2101-06-11T17:08:00Z --step-min 1",
        place + "--time 2001-06-10T17:08:00Z --input bad.csv",
        std::string("sun --input absent.csv"), std::string("sun --input none.csv"),
        std::string("sun --input bad.csv --out suns.csv"),
        std::string("sun --input column.csv"),
        place + "--time 2001-06-10T17:08:00Z --out ''"}) {
    const Outcome outcome = malusIn(scratch.path, bad);
    EXPECT_EQ(outcome.code, 2) << bad;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << bad << '\n'
                                                                           << outcome.err;
    EXPECT_EQ(outcome.out, "") << bad;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "suns.csv"));
  EXPECT_NE(malusIn(scratch.path, "sun --input bad.csv").err.find("bad.csv:3"),
            std::string::npos);
}

TEST(CommandSunInvariant, ExtremeNumbersAreAnsweredOrRefused) {
  const Scratch scratch;
  const std::string time = "sun --time 2001-06-10T17:08:00Z ";
  expectFiniteOrRefused(scratch.path, time + "--longitude-deg -77.61", "--latitude-deg");
  expectFiniteOrRefused(scratch.path, time + "--latitude-deg 43.16", "--longitude-deg");
  expectFiniteOrRefused(
      scratch.path,
      time + "--latitude-deg 43.16 --longitude-deg -77.61 --until 2001-06-10T18:08:00Z",
      "--step-min");
}
