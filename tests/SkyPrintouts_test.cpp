// Skies that uvspec, MYSTIC and MODTRAN print (nw/air/SkyPrintouts.nw). The texts are made here, in the forms and with the
// digits of these programs.
#include "malus/air/SkyPrintouts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>

#include "Program.hpp"
#include "malus/air/RayleighSky.hpp"
#include "malus/air/Sun.hpp"
#include "malus/air/TableSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Scene.hpp"

using namespace malus;

namespace {
const auto grid = SpectralGrid::make({500.0});
const double sun_zenith_deg = 50;

CDStokesVector ask(const Sky& sky, double zenith_deg, double azimuth_deg) {
  CDSpectralVector<CDStokesVector> out(sky.grid());
  sky.radiance(compassDirection(std::max(zenith_deg, 1e-6) * degree, azimuth_deg * degree),
               out);
  return std::as_const(out)[0];
}
double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a.getStokes(k) - b.getStokes(k)));
  return most / b.getScalar();
}

// The clear sky with the sun at a compass azimuth.
const Sky& truth(double sun_azimuth_deg = 180) {
  static std::map<double, std::unique_ptr<RayleighSky>> skies;
  auto& sky = skies[sun_azimuth_deg];
  if (!sky)
    sky = std::make_unique<RayleighSky>(
        Sun{compassDirection(sun_zenith_deg * degree, sun_azimuth_deg * degree),
            CDSpectralVector<CDStokesVector>(grid, 1.0)},
        RayleighSky::clearAir(grid, 0.2));
  return *sky;
}

// What uvspec would print of it: phi is where the light travels to, and the sun is in the south.
struct Printing {
  int last_phi = 350, components = 3;
  double unit = 1e-3;
  std::string header = "# unit: mW m^-2 sr^-1 nm^-1\n# convention: iprt\n";
  std::string flux = " 5.123456e+02  2.345678e+01  1.234567e+02  1.345678e+01";
  double first_zenith_deg = 0, last_zenith_deg = 88.5;
};

std::string block(const Printing& p, double nm, double scale) {
  std::string text = fmt::format("{:10.3f} {}\n                              ", nm, p.flux);
  for (int phi = 0; phi <= p.last_phi; phi += 10) text += fmt::format("{:14.3f}", phi * 1.0);
  for (int k = 0; k < p.components; ++k) {
    text += p.components > 1 ? fmt::format("\nStokes vector {}", "IQUV"[k]) : "";
    for (int step = 0; step <= 18; ++step) {
      const double zenith = step == 0    ? p.first_zenith_deg
                            : step == 18 ? p.last_zenith_deg
                                         : step * 5;
      text += fmt::format("\n{:9.6f} {:13.6e}", -std::cos(zenith * degree), 0.0);
      for (int phi = 0; phi <= p.last_phi; phi += 10) {
        const CDStokesVector light = convertSky(ask(truth(), zenith, phi + 180),
                                                SkyConvention::malus, SkyConvention::iprt);
        text += fmt::format(" {:13.6e}", scale * light.getStokes(k) / p.unit);
      }
    }
    text += fmt::format("\n{:9.6f} {:13.6e}", 0.5, 0.0);  // light from below
    for (int phi = 0; phi <= p.last_phi; phi += 10) text += fmt::format(" {:13.6e}", 77.0);
  }
  return text + "\n";
}
std::string uvspec(const Printing& p = {}) {
  return p.header + block(p, 450, 2) + block(p, 500, 1) + block(p, 550, 0.5);
}

std::unique_ptr<TableSky> skyOf(const std::filesystem::path& file) {
  return std::make_unique<TableSky>(readSkyTable(file, *grid), grid);
}
std::unique_ptr<TableSky> skyOf(const std::string& text) {
  const Scratch scratch;
  put(scratch / "sky.out", text);
  return skyOf(scratch / "sky.out");
}
std::string complaint(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string whole = error.what();
    EXPECT_EQ(whole.find('\n'), whole.npos);
    return whole.substr(whole.find('/', whole.find("malus-test")) + 1);
  }
  return "read";
}
// The result of a printout with one text replaced by another.
std::string changed(const std::string& old, const std::string& fresh, const Printing& p = {}) {
  std::string text = uvspec(p);
  EXPECT_NE(text.find(old), text.npos) << old;
  text.replace(text.find(old), old.size(), fresh);
  return complaint([&] { skyOf(text); });
}
void has(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), message.npos) << message;
}

// A sky of two zenith angles and four azimuths whose printouts are all the same text, but one.
struct Listing : Scratch {
  Listing(const std::string& common, const std::string& special,
          const std::string& header = "# convention: malus\n",
          const std::string& azimuth = "azimuth_deg") {
    put(*this / "common.txt", common);
    put(*this / "special.txt", special);
    std::string text = header + "zenith_deg," + azimuth + ",printout\n";
    for (const int zenith : {0, 80, 90})
      for (const int a : {0, 30, 120, 210, 300})
        text += fmt::format("{},{},{}\n", zenith, a,
                            zenith == 80 && a == 30 ? "special.txt" : "common.txt");
    put(*this / "sky.csv", text);
  }
  CDStokesVector special() const { return ask(*skyOf(*this / "sky.csv"), 80, 30); }
  std::string refused() const {
    return complaint([&] { skyOf(*this / "sky.csv"); });
  }
};

const std::string cards =
    " TMF 2    2    2    1    0    0    0    0    0    0    1    0    0   0.000   0.20\n"
    "   0.00000 100.00000  80.00000   0.00000   0.00000   0.00000    0          0.00000\n"
    "    MIDLATITUDE SUMMER\n";
// With DISORT, in the widths of MODTRAN 5: F8.2, F11.8, E11.4, 11X, 6E11.4, 2E9.2, F8.3, F7.4, E11.4, F11.3.
std::string row(double wavenumber, double radiance) {
  return fmt::format(
      "{:8.2f}{:11.8f}{:11.4E}{:11}{:11.4E}{:11.4E}{:11.4E}{:11.4E}{:11.4E}{:11.4E}{:9.2E}{:9."
      "2E}"
      "{:8.3f}{:7.4f}{:11.4E}{:11.3f}\n",
      wavenumber, 0.75012345, 0.0, "", 0.0, radiance, radiance / 2, 0.0, 0.0, radiance, 0.0,
      3.21e-6, 0.288, 0.0, 5.5e-6, 2500.123);
}
const std::string modtran5 =
    cards +
    "    FREQ  TOT_TRANS  PTH_THRML  THRML_SCT  SURF_EMIS   SOL_SCAT  SING_SCAT  GRND_RFLT  "
    "DRCT_RFLT  TOTAL_RAD  REF_SOL  SOL@OBS   DEPTH DIR_EM    TOA_SUN BBODY_T[K]\n" +
    row(19000, 2e-6) + row(20000, 1e-6) + row(21000, 3e-6) + " -9999.\n";
}  // namespace

// At the nodes the sky is the one that was printed, to the seven digits that were; the cosines have six, which at a zenith angle
// of 5 degrees is 6e-6 rad.
TEST(SkyPrintoutsInvariant, UvspecIsReadAsItWasPrinted) {
  const auto sky = skyOf(uvspec());
  EXPECT_EQ(sky->polarization().state(), "full");
  const auto reversed = skyOf([] {
    Printing p;
    p.header.replace(p.header.find("iprt"), 4, "natraj");
    return uvspec(p);
  }());
  double worst = 0, control = 0;
  for (int zenith = 0; zenith <= 85; zenith += 5)
    for (int azimuth = 0; azimuth < 360; azimuth += 10) {
      worst = std::max(worst, apart(ask(*sky, zenith, azimuth), ask(truth(), zenith, azimuth)));
      control = std::max(control,
                         apart(ask(*reversed, zenith, azimuth), ask(truth(), zenith, azimuth)));
    }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(control, 0.5);  // the wrong sign of Q
  // the horizon is the last row
  EXPECT_LT(apart(ask(*sky, 90, 70), ask(truth(), 88.5, 70)), 1e-6);
}

TEST(SkyPrintoutsInvariant, TheSunMayStandElsewhere) {
  Printing p;
  p.header += "# sun_azimuth_deg: 212\n";
  const auto sky = skyOf(uvspec(p));
  for (int azimuth = 2; azimuth < 360; azimuth += 10) {
    EXPECT_LT(apart(ask(*sky, 45, azimuth), ask(truth(212), 45, azimuth)), 1e-4);
  }
  EXPECT_GT(apart(ask(*sky, 45, 92), ask(truth(180), 45, 92)), 0.1);  // control
}

TEST(SkyPrintoutsInvariant, HalfACircleIsMirrored) {
  Printing half;
  half.last_phi = 180;
  const auto sky = skyOf(uvspec(half)), whole = skyOf(uvspec());
  double turned_u = 0;
  for (int zenith = 0; zenith <= 85; zenith += 5)
    for (int azimuth = 0; azimuth < 360; azimuth += 10) {
      EXPECT_LT(apart(ask(*sky, zenith, azimuth), ask(*whole, zenith, azimuth)), 1e-5)
          << zenith << ' ' << azimuth;
      turned_u = std::max(turned_u, std::abs(ask(*sky, zenith, azimuth).getStokes(2) +
                                             ask(*sky, zenith, 360 - azimuth).getStokes(2)));
    }
  EXPECT_LT(turned_u, 1e-6);
  const CDStokesVector east = ask(*sky, 45, 90);
  EXPECT_GT(std::abs(east.getStokes(2)), 0.1 * east.getScalar());  // control: there is some U
}

TEST(SkyPrintoutsInvariant, DisortHasNoPolarisation) {
  Printing p;
  p.components = 1;
  p.header = "# unit: mW m^-2 sr^-1 nm^-1\n";
  for (const std::string flux : {" 1.0", " 1 2 3", " 1 2 3 4 5 6"}) {
    p.flux = flux;
    const auto sky = skyOf(uvspec(p));
    EXPECT_EQ(sky->polarization().state(), "none");
    EXPECT_NEAR(ask(*sky, 45, 70).getScalar() / ask(truth(), 45, 70).getScalar(), 1, 1e-4);
  }
}

TEST(SkyPrintoutsByHand, Units) {
  const auto read = [](const std::string& unit) {
    Printing p;
    p.unit = 1;
    p.header = fmt::format("# unit: {}\n# convention: iprt\n", unit);
    return ask(*skyOf(uvspec(p)), 45, 70).getScalar() / ask(truth(), 45, 70).getScalar();
  };
  EXPECT_NEAR(read("W m^-2 sr^-1 nm^-1"), 1, 1e-4);
  EXPECT_NEAR(read("mW m^-2 sr^-1 nm^-1"), 1e-3, 1e-7);
  EXPECT_NEAR(read("W m^-2 sr^-1 um^-1"), 1e-3, 1e-7);
  EXPECT_NEAR(read("sr^-1"), solarIrradiance(grid)[0].getScalar(), 1e-4);
}

// A band at 500 nm needs one of the three wavelengths, and the first and last say how far the printout reaches.
TEST(SkyPrintoutsByHand, OnlyTheWavelengthsThatBandsDrawOn) {
  const Scratch scratch;
  Printing p;
  put(scratch / "sky.out", p.header + block(p, 400, 1) + block(p, 450, 2) + block(p, 500, 1) +
                               block(p, 550, 0.5) + block(p, 600, 1));
  const std::size_t directions = 20 * 36;
  EXPECT_EQ(readSkyTable(scratch / "sky.out", *grid).rows(), 3 * directions);
  const auto between = SpectralGrid::make({470.0});  // between 450 and 500
  EXPECT_EQ(readSkyTable(scratch / "sky.out", *between).rows(), 4 * directions);
  const TableSky sky(readSkyTable(scratch / "sky.out", *between), between);
  EXPECT_NEAR(ask(sky, 45, 70).getScalar() / ask(truth(), 45, 70).getScalar(), 1.6, 1e-4);
}

// Printed by the IPRT (Emde et al. 2015): case A2, sun at 50 deg, line of sight at 80 deg, 30 deg beside the sun.
TEST(SkyPrintoutsPublished, NumbersOfMystic) {
  const std::string common =
      "450 0 0 0 1\n450 0 0 0 0\n450 0 0 0 0\n450 0 0 0 0\n"
      "550 0 0 0 1\n550 0 0 0 0\n550 0 0 0 0\n550 0 0 0 0\n";
  std::string special;
  for (const char* nm : {"  450.00000", "  550.00000"})
    for (const char* value : {"5.79935e-02", "-1.64765e-03", "1.04032e-02", "0.00000e+00"})
      special += fmt::format("{} {} {} {} {}\n", nm, 0, 0, 0, value);
  const std::string unit = "# unit: W m^-2 sr^-1 nm^-1\n";
  const CDStokesVector expected(5.79935e-02, 1.64765e-03, 1.04032e-02, 0);
  const Listing relative(common, special, unit + "# convention: iprt\n# sun_azimuth_deg: 0\n",
                         "phi_deg"),
      compass(common, special, unit + "# convention: malus\n"),
      natraj(common, special, unit + "# convention: natraj\n# sun_azimuth_deg: 0\n", "phi_deg");
  for (const Listing* listing : {&relative, &compass, &natraj})
    EXPECT_LT(apart(listing->special(), expected), 1e-12);
  // control: a printout without polarisation
  const Listing scalar("450 0 0 0 1\n550 0 0 0 1\n", "450 0 0 0 2\n550 0 0 0 2\n",
                       unit + "# convention: malus\n");
  EXPECT_FALSE(skyOf(scalar / "sky.csv")->polarized());
  EXPECT_DOUBLE_EQ(scalar.special().getScalar(), 2);
}

TEST(SkyPrintoutsByHand, ModtranInItsForms) {
  EXPECT_NEAR(Listing(modtran5, modtran5).special().getScalar(), 0.4, 1e-12);
  const std::string modtran4 =
      cards +
      "   FREQ   TOT TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT  GRND RFLT  "
      "DRCT RFLT  TOTAL RAD  REF SOL  SOL@OBS   DEPTH\n"
      "  20000.  0.7501  0.00E+00 0.00E+00 0.00E+00 1.00E-06 5.00E-07 0.00E+00 0.00E+00 "
      "1.00E-06 0.00E+00 3.21E-06   0.288\n -9999.\n";
  EXPECT_NEAR(Listing(modtran4, modtran4).special().getScalar(), 0.4, 1e-12);
  const std::string microns =
      "WAVLEN(MCRN)      TRAN  PTH_THRML  TOTAL_RAD\n 0.4 0.7 0.0 0.08\n 0.5 0.75 0.0 0.04\n "
      "0.6 0.8 0.0 0.02\n";
  EXPECT_NEAR(Listing(microns, microns).special().getScalar(), 0.4, 1e-12);
  const std::string nanometres =
      "  WAVLEN(NM)      TRAN  PTH_THRML  TOTAL_RAD\n 500. 0.75 0.0 "
      "40.0\n";
  EXPECT_NEAR(Listing(nanometres, nanometres).special().getScalar(), 0.4, 1e-12);
  // a run without the sun, F8.2, F11.8, 2(E11.4, 11X), 2E22.4, F26.3, F7.4, F22.3: 10 um
  const std::string thermal =
      modtran5.substr(0, modtran5.find("19000.00")) +
      fmt::format(
          "{:8.2f}{:11.8f}{:11.4E}{:11}{:11.4E}{:11}{:22.4E}{:22.4E}{:26.3f}{:7.4f}{:22.3f}\n",
          1000.0, 0.5, 4e-6, "", 0.0, "", 0.0, 4e-6, 0.693, 0.0, 260.0) +
      " -9999.\n";
  const auto infrared = SpectralGrid::make({1e4});
  const Listing listing(thermal, thermal);
  const TableSky warm(readSkyTable(listing / "sky.csv", *infrared), infrared);
  EXPECT_NEAR(ask(warm, 80, 30).getScalar(), 4e-3, 1e-12);
  const std::string commas = "FREQ (CM-1),TOT TRANS,PTH THRML,TOTAL RAD\n20000,0.75,,1e-06\n";
  EXPECT_NEAR(Listing(commas, commas).special().getScalar(), 0.4, 1e-12);
}

TEST(SkyPrintoutsByHand, RunsOfATape7) {
  const Scratch scratch;
  std::string brighter = modtran5;
  brighter.replace(brighter.find(row(20000, 1e-6)), row(0, 0).size(), row(20000, 4e-6));
  put(scratch / "tape7", modtran5 + brighter);
  const auto write = [&](const std::string& run) {
    put(scratch / "sky.csv",
        "# convention: malus\n# azimuths: one\nzenith_deg,azimuth_deg,printout" +
            std::string(run.empty() ? "" : ",run") + "\n0,0,tape7" + (run.empty() ? "" : ",1") +
            "\n90,0,tape7" + run + "\n");
  };
  write(",2");
  EXPECT_NEAR(ask(*skyOf(scratch / "sky.csv"), 90, 0).getScalar(), 1.6, 1e-12);
  EXPECT_NEAR(ask(*skyOf(scratch / "sky.csv"), 0, 0).getScalar(), 0.4,
              1e-7);  // 1e-6 deg beside
  const auto refused = [&] { return complaint([&] { skyOf(scratch / "sky.csv"); }); };
  write(",3");
  has(refused(),
      "sky.csv:5: run = 3: is not a run of tape7, which has 2; give its number in a column "
      "run");
  write(",1.5");
  has(refused(), "sky.csv:5: run = 1.5: is not a run of tape7");
  write("");
  has(refused(), "sky.csv:4: printout = tape7: is not a run of tape7, which has 2");
}

// Half a circle of MYSTIC's: the other half has the opposite U. One azimuth alone must be declared.
TEST(SkyPrintoutsInvariant, HalfACircleOfPrintouts) {
  const Scratch scratch;
  const std::string header =
      "# unit: W m^-2 sr^-1 nm^-1\n# convention: malus\nzenith_deg,azimuth_deg,printout\n";
  std::string text = header;
  for (const int zenith : {0, 90})
    for (const int azimuth : {20, 110, 200})
      text += fmt::format("{},{},mc.rad.spc\n", zenith, azimuth);
  put(scratch / "mc.rad.spc", "500 0 0 0 1.0\n500 0 0 0 0.2\n500 0 0 0 0.3\n500 0 0 0 0.1\n");
  put(scratch / "sky.csv", text);
  const auto sky = skyOf(scratch / "sky.csv");
  EXPECT_LT(apart(ask(*sky, 90, 110), {1, -0.2, 0.3, 0.1}), 1e-12);
  EXPECT_LT(apart(ask(*sky, 90, 290), {1, -0.2, -0.3, -0.1}), 1e-12);
  put(scratch / "sky.csv", header + "0,0,mc.rad.spc\n90,0,mc.rad.spc\n");
  has(complaint([&] { skyOf(scratch / "sky.csv"); }),
      "sky.csv: azimuths = 0: leave out 360 deg of the circle");
}

TEST(SkyPrintoutsRefusal, UvspecByItsLine) {
  has(changed("# unit: mW m^-2 sr^-1 nm^-1\n", ""),
      "sky.out: unit: is missing; begin the file with a line such as");
  has(changed("mW m^-2", "kW m^-2"), "sky.out: unit = kW m^-2 sr^-1 nm^-1: is not a unit of");
  has(changed("# convention: iprt\n", ""), "sky.out: convention: is missing; declare");
  has(changed("iprt", "malus"), "has compass azimuths, and phi is not one");
  has(changed("   550.000", "   500.000"), "does not follow the wavelength before it");
  has(changed("-0.996195  0.000000e+00", "-0.996195  0.000000f+00"),
      ":7: radiance = 0.000000f+00: is not a number");
  has(changed("-0.996195", "-0.99f195"), ":7: -0.99f195");
  has(changed("-0.996195 ", "-1.0 "), "umu = -1: does not ascend");
  has(changed("-0.996195 ", "-0.995195 ", {.components = 1}),
      "are not those of the first block");
  has(changed("Stokes vector Q", "Stokes vector U"), "is not a line of a printout");
  has(changed("       350.000", ""), "holds 38 numbers; give 37");
  has(changed("        20.000", "         5.000"),
      "phi = 5: is not an azimuth in ascending "
      "order");
  Printing p;
  p.first_zenith_deg = 2;
  has(complaint([&] { skyOf(uvspec(p)); }), "umu = -0.999391: is not the zenith");
  p = {};
  p.last_zenith_deg = 86;
  has(complaint([&] { skyOf(uvspec(p)); }), "stops at a zenith angle of 86.00 deg");
  p = {};
  p.components = 2;
  has(complaint([&] { skyOf(uvspec(p)); }), ":3: wavelength = 450 nm: has 2 Stokes components");
  p = {};
  p.last_phi = 90;
  has(complaint([&] { skyOf(uvspec(p)); }), "leave out 270 deg of the circle");
}

TEST(SkyPrintoutsRefusal, UvspecWithoutASky) {
  const std::string unit = "# unit: mW m^-2 sr^-1 nm^-1\n";
  has(complaint([&] { skyOf(unit + "450.0 1 2 3 4 5 6\n500.0 1 2 3 4 5 6\n"); }),
      ":3: phi = 500: is not an azimuth");
  has(complaint([&] { skyOf(unit + "450.0 1 2 3 4 5 6\n-1.0 5.0\n-0.5 6.0\n"); }),
      ":3: phi: is missing: there are means over the azimuths only");
  has(complaint([&] { skyOf(unit + "450.0 1 2 3 4 5 6\n"); }), "the file ends within a block");
  has(complaint([&] { skyOf(unit + "450.0 1 2 3\n 0.0 90.0 180.0\n451.0 1 2 3\n"); }),
      ":2: wavelength = 450 nm: has no lines of radiances");
  has(complaint([&] { skyOf(modtran5); }),
      "is the spectrum of one direction; name it in a table");
}

TEST(SkyPrintoutsRefusal, BrokenLight) {
  Printing p;
  p.components = 1;
  const std::string text = uvspec(p);
  const std::size_t row = text.find("-0.996195"), cell = row + 9 + 1 + 13 + 1;
  std::string negative = text;
  negative[cell] = '-';
  has(complaint([&] { skyOf(negative); }), ":6: radiance = -");
  // more polarisation than light, in the line of U
  std::string printed = uvspec();
  const std::size_t u = printed.find("Stokes vector U"),
                    value = printed.find("-0.707107", u) + 9 + 1 + 13 + 1;
  printed.replace(value, 13, " 9.999999e+05");
  has(complaint([&] { skyOf(printed); }), "the degree of polarisation exceeds one");
}

TEST(SkyPrintoutsRefusal, Listings) {
  const auto swapped = [](const std::string& old, const std::string& fresh) {
    std::string special = modtran5;
    special.replace(special.find(old), old.size(), fresh);
    return Listing(modtran5, special).refused();
  };
  has(swapped("2.0000E-06 0.00E+00", "-2.000E-06 0.00E+00"), "special.txt:5: TOTAL_RAD = -");
  has(swapped("2.0000E-06 0.00E+00", "           0.00E+00"),
      "special.txt:5: TOTAL_RAD: the number is missing");
  for (const char* broken :
       {"2.0000E-06 0.00E 00", "2.0000E-0620.00E+00", "2.0000E-06 0 00E+00"})
    has(swapped("2.0000E-06 0.00E+00", broken), "special.txt:5: TOTAL_RAD");
  has(swapped("2500.123", "2500.123 1"),
      "special.txt:5: TOTAL_RAD = 17 columns: but line 4 has 16 names");
  has(swapped("TOTAL_RAD", "TOTAL_RED"), "special.txt: TOTAL_RAD: is named in no line");
  has(swapped("    FREQ  TOT", "    SPAM  TOT"), "special.txt:4: SPAM: is not the spectrum of");
  has(swapped("    FREQ  TOT_TRANS", "    FREQ LOS"),
      "is not the spectrum of one line of sight");
  has(swapped("21000.00", "19500.00"), "special.txt:7: FREQ = 19500.00: is out of order");
  has(swapped("21000.00", "20000.00"), "special.txt:7: FREQ = 20000.00: is out of order");
  has(swapped("21000.00", "22000.00"),
      "sky.csv:9: printout = special.txt: has other wavelengths or components than common.txt");
  has(swapped(modtran5.substr(modtran5.find("19000.00")), " -9999.\n"),
      "special.txt: run 1: has no numbers");
  const Listing empty(modtran5, modtran5);
  put(empty / "sky.csv", "# convention: malus\nzenith_deg,azimuth_deg,printout\n");
  has(empty.refused(), "sky.csv: printout: names no printout; give a row");
  const Listing gone(modtran5, modtran5);
  std::filesystem::remove(gone / "special.txt");
  has(gone.refused(), "sky.csv:9: printout = special.txt: does not exist; name a file");
  const Listing twice(modtran5, modtran5);
  put(twice / "sky.csv", contents(twice / "sky.csv") + "80,30,common.txt\n");
  has(twice.refused(), "sky.csv:18: zenith_deg = 80: repeats the direction");
}

TEST(SkyPrintoutsRefusal, Mystic) {
  const std::string good = "450 0 0 0 1\n550 0 0 0 1\n",
                    header = "# unit: mW m^-2 sr^-1 nm^-1\n# convention: malus\n";
  const auto special = [&](const std::string& text) {
    return Listing(good, text, header).refused();
  };
  has(special("450 0 0 0 1\n450 0 0 0 0\n550 0 0 0 1\n"),
      "special.txt:3: radiance = 550 nm: comes after a wavelength with 2 lines");
  has(special("450 0 0 0 1\n550 0 0 0 1\n550 0 0 0 1\n"),
      "special.txt:3: radiance = 550 nm: has 2");
  has(special("450 0 0 0 1\n550 1 0 0 1\n"),
      "special.txt:2: radiance = pixel 1 0 0: differs from the first");
  has(special("450 0 0 0 1\n440 0 0 0 1\n"),
      "special.txt:2: radiance = 440 nm: is out of order");
  has(special("450 0 0 0\n"), "special.txt:1: radiance = 450 0 0 0: holds 4 numbers");
  has(Listing(good, good).refused(), "sky.csv: unit: is missing");
  const Listing deviations(good, good, header);
  put(deviations / "sky.csv", header + "zenith_deg,azimuth_deg,printout\n0,0,mc.rad.std.spc\n");
  put(deviations / "mc.rad.std.spc", good);
  has(deviations.refused(), "holds standard deviations, not radiances");
}

// A byte changed, a piece cut out or doubled: whatever becomes of a text, it is read or refused in one line.
TEST(SkyPrintoutsInvariant, BrokenTextsAreReadOrRefused) {
  Printing p;
  p.last_phi = 180;
  const std::string mystic = "450 0 0 0 1\n450 0 0 0 0\n450 0 0 0 0\n450 0 0 0 0\n";
  std::mt19937_64 engine(7);
  int refused = 0;
  for (const std::string& text : {p.header + block(p, 450, 1), modtran5, mystic})
    for (int trial = 0; trial < 150; ++trial) {
      std::string broken = text;
      const std::size_t at = engine() % broken.size(), length = engine() % 40;
      if (trial % 3 == 0) broken[at] = " \t\n-#,.eE0169aV\0"[engine() % 17];
      if (trial % 3 == 1) broken.erase(at, length);
      if (trial % 3 == 2) broken.insert(at, broken.substr(at, length));
      const std::string message = complaint([&] {
        if (text[0] == '#')
          skyOf(broken);
        else
          skyOf(Listing(broken, broken, "# unit: sr^-1\n# convention: malus\n") / "sky.csv");
      });
      refused += message != "read";
    }
  EXPECT_GT(refused, 100);
}

// The files that a table names belong to the scene, which records them and sends them to other machines.
TEST(SkyPrintoutsInvariant, FilesOfATable) {
  const Listing listing(modtran5, modtran5);
  const auto files = skyPrintoutsOf(listing / "sky.csv");
  ASSERT_EQ(files.size(), 15u);
  EXPECT_EQ(files[6], listing / "special.txt");
  EXPECT_TRUE(skyPrintoutsOf(listing / "special.txt").empty());
}

TEST(SkyPrintoutsInvariant, AScene) {
  const Listing listing(modtran5, modtran5);
  const std::string scene = R"({"malus": 1, "bands": {"wavelength_nm": [500]},
    "geometry": [{"ground": {"z_m": 0, "material": "plate"}}],
    "materials": {"plate": {"model": "lambertian", "reflectance": 0.5}},
    "sky": {"model": "table", "file": "sky.csv"},
    "sensor": {"kind": "framing", "width": 1, "height": 1, "field_of_view_deg": 1},
    "platform": {"path": "fixed", "position_m": [0, 0, 10], "look_at_m": [0, 0, 0], "up": [0, 1, 0]}})";
  const Scene read = readSceneText(scene, "scene.json", listing.path);
  EXPECT_NE(std::ranges::find(read.files, listing / "special.txt"), read.files.end());
  EXPECT_NEAR(ask(*read.world.sky, 80, 30).getScalar(), 0.4, 1e-12);
  EXPECT_FALSE(read.world.sky->polarized());
}

// For a user: a result of malus sky, and a broken file with exit code 2 and one line.
TEST(SkyPrintoutsInvariant, MalusSkyTakesThem) {
  const Scratch scratch;
  put(scratch / "sky.out", uvspec());
  const std::string question =
      "sky --model table --file sky.out --wavelength-nm 500 --mu 0.7071067811865476 --phi-deg "
      "70 "
      "--convention iprt";
  const Outcome good = malusIn(scratch.path, question);
  ASSERT_EQ(good.code, 0) << good.err;
  put(scratch / "answer.csv", good.out);
  const Table answer = Table::read(scratch / "answer.csv");
  const CDStokesVector expected =
      convertSky(ask(truth(), 45, 70), SkyConvention::malus, SkyConvention::iprt);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(answer.number(0, std::string(1, "IQU"[k])), expected.getStokes(k),
                1e-4 * expected.getScalar());
  // the sun is in the south; a clear sky has two neutral points near it and one far from it, and none in the zenith
  const Outcome picture = malusIn(
      scratch.path, "sky --model table --file sky.out --wavelength-nm 500 --picture dome");
  ASSERT_EQ(picture.code, 0) << picture.err;
  put(scratch / "points.csv", picture.out);
  const Table points = Table::read(scratch / "points.csv");
  EXPECT_GE(points.rows(), 1u);
  for (std::size_t row = 0; row < points.rows(); ++row)
    EXPECT_GT(points.number(row, "zenith_deg"), 20) << picture.out;
  put(scratch / "sky.out", uvspec().substr(0, 9000));
  const Outcome bad = malusIn(scratch.path, question);
  EXPECT_EQ(bad.code, 2);
  EXPECT_TRUE(bad.out.empty());
  EXPECT_EQ(std::count(bad.err.begin(), bad.err.end(), '\n'), 1) << bad.err;
}
