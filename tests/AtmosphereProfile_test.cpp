// Air by height (nw/air/AtmosphereProfile.nw), and the texts it is read from (nw/base/TextLines.nw).
#include "malus/air/AtmosphereProfile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Scratch.hpp"
#include "malus/air/RayleighAir.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
constexpr double all = std::numeric_limits<double>::infinity();

AtmosphereProfile standard(const std::string& name) {
  return AtmosphereProfile::named(name, {"test", 0, ""});
}

// The result of reading this text.
std::string complaint(const std::string& text) {
  const Scratch scratch;
  put(scratch / "air.dat", text);
  try {
    AtmosphereProfile::read(scratch / "air.dat");
  } catch (const InputError& error) {
    const std::string whole = error.what();
    return whole.substr(whole.find("air.dat"));
  }
  return "read";
}

// The benchmark's layers at a column of its table, and ours: worst ratio of a layer, and ratio of the sums.
struct Ratios {
  double worst = 0, whole = 0;
};
template <class Depth>
Ratios against(const std::string& column, const Depth& depth, double below_km = 30) {
  const Table table = Table::read("validation/printed/iprt-depths.csv");
  Ratios ratios;
  double sum = 0, theirs = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double low = 1000 * table.number(row, "z_km"), high = low + 1000;
    const double own = depth(low, high), printed = table.number(row, column);
    if (low < 1000 * below_km)
      ratios.worst = std::max(ratios.worst, std::abs(own / printed - 1));
    sum += own, theirs += printed;
  }
  ratios.whole = std::abs(sum / theirs - 1);
  return ratios;
}
}  // namespace

// Emde et al. 2015 have libRadtran's U.S. standard atmosphere and Bodhaine's cross sections. They count the molecules from
// density, we weigh them by pressure: the table's four digits allow one per cent in a layer, the sums two thousandths. Above
// 25 km, where the levels are 2.5 km apart, the benchmark's own columns differ by 1.6 % (800 and 350 nm against 450 and 325,
// which below agree in the cross sections' ratio to 2e-3): two of its cases interpolate otherwise, and are compared below.
TEST(AtmosphereProfilePublished, MoleculesOfTheBenchmark) {
  const AtmosphereProfile air = standard("us-standard");
  const auto compared = [&](const char* column, double nm, double below_km) {
    const Ratios ratios = against(
        column, [&](double low, double high) { return air.rayleighDepth(nm, low, high); },
        below_km);
    EXPECT_LT(ratios.worst, 0.01) << column;
    EXPECT_LT(ratios.whole, 0.002) << column;
  };
  compared("rayleigh_450", 450, 30), compared("rayleigh_325", 325, 30);
  compared("rayleigh_350", 350, 25), compared("rayleigh_800", 800, 25);
  const AtmosphereProfile other = standard("tropical");  // control
  EXPECT_GT(
      against("rayleigh_450",
              [&](double low, double high) { return other.rayleighDepth(450, low, high); })
          .worst,
      0.01);
}

// Their ozone is the same, its cross sections are from another laboratory: these differ by two per cent in this band.
TEST(AtmosphereProfilePublished, OzoneOfTheBenchmark) {
  const AtmosphereProfile air = standard("us-standard");
  const OzoneAbsorption ozone(SpectralGrid::make({325.0}));
  const Ratios ratios = against("absorption_325", [&](double low, double high) {
    return air.ozoneDepth(ozone, 0, low, high);
  });
  EXPECT_LT(ratios.worst, 0.02);
  EXPECT_LT(ratios.whole, 0.02);
  const AtmosphereProfile more = air.withOzone(1.05 * air.ozone_DU());  // control
  EXPECT_GT(
      against("absorption_325",
              [&](double low, double high) { return more.ozoneDepth(ozone, 0, low, high); })
          .whole,
      0.02);
}

// The column is the sum of exponentials by hand.
TEST(AtmosphereProfileIdentity, ColumnsAreSumsOfExponentials) {
  for (const std::string& name : AtmosphereProfile::standards()) {
    const AtmosphereProfile air = standard(name);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < air.levels().size(); ++i) {
      const auto &a = air.levels()[i], &b = air.levels()[i + 1];
      const double fall = std::log(b.ozone_cm3 / a.ozone_cm3);
      sum += 100 * (b.height_m - a.height_m) *
             (std::abs(fall) < 1e-9 ? a.ozone_cm3 : (b.ozone_cm3 - a.ozone_cm3) / fall);
    }
    EXPECT_NEAR(air.ozoneColumn_cm2(0, all) / sum, 1, 1e-12) << name;
    EXPECT_NEAR(air.withOzone(300).ozone_DU(), 300, 1e-9) << name;
    EXPECT_EQ(air.levels().size(), 50u) << name;
  }
  EXPECT_LT(standard("tropical").ozone_DU(), standard("subarctic-winter").ozone_DU());
}

TEST(AtmosphereProfileIdentity, LayersAddUp) {
  const AtmosphereProfile air = standard("midlatitude-summer");
  const OzoneAbsorption ozone(SpectralGrid::make({600.0}));
  double rayleigh = 0, absorbed = 0;
  for (double low = 0; low < 120e3; low += 1700) {
    const double high = low + 1700 < 119e3 ? low + 1700 : all;
    rayleigh += air.rayleighDepth(550, low, high);
    absorbed += air.ozoneDepth(ozone, 0, low, high);
    if (std::isinf(high)) break;
  }
  EXPECT_NEAR(rayleigh / rayleighOpticalDepth(550, {1013, 0}), 1, 1e-13);
  EXPECT_NEAR(absorbed / air.ozoneDepth(ozone, 0, 0, all), 1, 1e-9);
  // by hand, between the middle of the first two levels
  EXPECT_NEAR(air.pressure_hPa(500), std::sqrt(1013.0 * 902.0), 1e-9);
  EXPECT_NEAR(air.temperature_K(500), (294.2 + 289.7) / 2, 1e-9);
}

// Around 600 nm a vertical beam loses about four per cent: 344 Dobson units times 4.89e-21 cm2.
TEST(AtmosphereProfileIdentity, TheBandsOfChappuisByHand) {
  const AtmosphereProfile air = standard("us-standard");
  const OzoneAbsorption ozone(SpectralGrid::make({325.0, 400.0, 600.0}));
  EXPECT_NEAR(air.ozoneDepth(ozone, 2, 0, all),
              air.ozone_DU() * AtmosphereProfile::dobson_cm2 * 4.89e-21, 1e-9);
  EXPECT_EQ(air.ozoneDepth(ozone, 1, 0, all), 0);
  // half-way between 226 and 263 K; constant beyond the ends
  EXPECT_NEAR(ozone.crossSection_cm2(0, 244.5), (1.486 + 1.593) / 2 * 1e-20, 1e-26);
  EXPECT_EQ(ozone.crossSection_cm2(0, 100), ozone.crossSection_cm2(0, 226));
  EXPECT_EQ(ozone.crossSection_cm2(0, 400), ozone.crossSection_cm2(0, 298));
}

TEST(AtmosphereProfileIdentity, EachFormOfAFileIsRead) {
  const Scratch scratch;
  put(scratch / "libradtran.dat",
      "#  z(km) p(mb) T(K) air(cm-3) o3(cm-3) o2(cm-3)\n"
      "  10.000 2.650e+02 223.3 8.6e+18 1.1e+12 1.8e+18\n\n"
      "   0.000 1.013e+03 288.2 2.5e+19 6.8e+11 5.3e+18\r\n");
  put(scratch / "ours.csv",
      "# title: two levels\nheight_km,pressure_hPa,temperature_K,ozone_ppmv\n"
      "0,1013,288.2,0.0267\n10,265,223.3,0.131\n");
  put(scratch / "dry.dat", "0 1013 288.2\n10 265 223.3\n");
  const auto theirs = AtmosphereProfile::read(scratch / "libradtran.dat");
  EXPECT_EQ(theirs.levels()[0].pressure_hPa, 1013);
  EXPECT_EQ(theirs.levels()[1].ozone_cm3, 1.1e12);
  const auto ours = AtmosphereProfile::named((scratch / "ours.csv").string(), {"test", 0, ""});
  EXPECT_NEAR(ours.levels()[0].ozone_cm3, 0.0267e-6 * 101300 / (1.380649e-23 * 288.2) * 1e-6,
              1e3);
  EXPECT_EQ(AtmosphereProfile::read(scratch / "dry.dat").ozone_DU(), 0);
}

TEST(AtmosphereProfileRefusals, BrokenFilesNameTheLine) {
  const std::string ends = "0 1013 288 2e19 6e11\n";
  EXPECT_EQ(complaint("# z p T\n20 55 217 1e18\n10 265 223\n"),
            "air.dat:3: 10 265 223: holds 3 numbers; give 4 as in the lines before");
  EXPECT_EQ(complaint("10 265 223 1e18 1e12\n" + ends + "-0.2 10l3 288 2e19 6e11\n"),
            "air.dat:3: 10l3: is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(complaint("10 265 -50 1e18 1e12\n" + ends),
            "air.dat:1: temperature = -50 K: must be 50 to 3000; fix the level");
  EXPECT_EQ(complaint("10000 265 223 1e18 1e12\n" + ends),
            "air.dat:1: height = 10000 km: must be -0.5 to 1000; fix the level");
  EXPECT_EQ(complaint("10 1265 223 1e18 1e12\n" + ends),
            "air.dat:1: pressure = 1265 hPa: must be above 0, up to 1100; fix the level");
  EXPECT_EQ(complaint("20 55 217 1 1\n10 26.5 223 1 1\n" + ends).substr(0, 60),
            "air.dat:1: 20 km, 55 hPa: is not above its neighbour with le");
  EXPECT_EQ(complaint("0 1013\n1 900\n").substr(0, 45),
            "air.dat:1: 0 1013: holds fewer than 3 numbers");
  EXPECT_EQ(complaint(ends),
            "air.dat: has fewer than two levels; give the air at two or more heights");
  EXPECT_EQ(complaint("").substr(0, 17), "air.dat: is empty");
  EXPECT_EQ(complaint("height_km,pressure_hPa\n0,1013\n").substr(0, 24),
            "air.dat:1: temperature_K");
  try {
    standard("us-standart");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what()).find("does not exist; give the file of a profile, or one of"),
        std::string::npos)
        << error.what();
  }
}

TEST(AtmosphereProfileRefusals, HeightsAndCrossSections) {
  const AtmosphereProfile air = standard("us-standard");
  EXPECT_THROW(air.pressure_hPa(-1), Refusal);
  EXPECT_THROW(air.pressure_hPa(std::nan("")), Refusal);
  EXPECT_THROW(air.rayleighDepth(550, 2000, 1000), Refusal);
  EXPECT_THROW(air.rayleighDepth(550, 0, 130e3), Refusal);
  EXPECT_THROW(air.rayleighDepth(150, 0, all), Refusal);
  EXPECT_THROW(air.ozoneColumn_cm2(-5, all), Refusal);
  EXPECT_THROW(air.withOzone(1e4), Refusal);
  EXPECT_THROW(AtmosphereProfile({{0, 1013, 288}}), Refusal);
  EXPECT_THROW(AtmosphereProfile({{0, 1013, 288}, {0, 900, 288}}), Refusal);
  EXPECT_THROW(OzoneAbsorption(SpectralGrid::make({900.0})), InputError);
  const Scratch scratch;
  put(scratch / "a.csv", "wavelength_nm,at_298K,at_226K\n500,1,1\n600,1,1\n");
  put(scratch / "b.csv", "wavelength_nm,sigma\n500,1\n600,1\n");
  put(scratch / "c.csv", "wavelength_nm,at_298K\n500,-1\n600,1\n");
  for (const char* name : {"a.csv", "b.csv", "c.csv"})
    EXPECT_THROW(OzoneAbsorption(SpectralGrid::make({550.0}), scratch / name), InputError)
        << name;
}
