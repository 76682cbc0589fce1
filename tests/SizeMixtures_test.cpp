// Scattering by mixtures of spheres and inversions of AERONET (nw/air/SizeMixtures.nw), from outside, by malus mie.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "Program.hpp"
#include "malus/air/Scatterer.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
const std::string columns =
    "number_cm3,n,k,median_radius_um,deviation,effective_radius_um,effective_variance,radius_"
    "um\n";

Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}

Table answered(const Scratch& scratch, const std::string& question) {
  const Outcome outcome = malusIn(scratch.path, "mie --wavelength-nm 550 " + question);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return tableOf(outcome.out);
}

// The one line with which a file is refused.
std::string complaint(const std::string& text, const std::string& more = "") {
  const Scratch scratch;
  put(scratch / "sizes.csv", text);
  const Outcome outcome = malusIn(
      scratch.path, "mie --sizes sizes.csv --wavelength-nm 550 --out answer.csv " + more);
  EXPECT_EQ(outcome.code, outcome.err.empty() ? 0 : 2);
  EXPECT_EQ(filesBelow(scratch.path), outcome.err.empty() ? 2u : 1u);
  return outcome.err.empty() ? "read" : outcome.err.substr(0, outcome.err.find('\n'));
}

// The inversion of the Southern Great Plains, 15 August 2019, 21:46:45 (version 3, level 1.5), with its columns of index and
// size; the header is shortened.
struct Inversion {
  std::vector<double> radius_um{0.050000, 0.065604, 0.086077,  0.112939, 0.148184, 0.194429,
                                0.255105, 0.334716, 0.439173,  0.576227, 0.756052, 0.991996,
                                1.301571, 1.707757, 2.240702,  2.939966, 3.857452, 5.061260,
                                6.640745, 8.713145, 11.432287, 15.000000};
  std::vector<double> volume{0.000321, 0.002708, 0.010422, 0.018989, 0.018266, 0.011193,
                             0.005670, 0.003155, 0.002377, 0.002548, 0.003535, 0.005525,
                             0.008811, 0.013720, 0.020467, 0.028187, 0.032764, 0.028586,
                             0.017028, 0.006553, 0.001587, 0.000240};
  std::string text() const {
    std::string names, values;
    for (std::size_t i = 0; i < volume.size(); ++i)
      names += fmt::format(",{:.6f}", radius_um[i]),
          values += fmt::format(",{:.7g}", volume[i]);
    std::string index;
    for (const char* part : {"Real", "Imaginary"})
      for (const int nm : {440, 675, 870, 1020})
        index += fmt::format(",Refractive_Index-{}_Part[{}nm]", part, nm);
    return "AERONET Version 3;\nARM_SGP\nVersion 3: Almucantar Level 1.5 Inversion\n"
           "Site,Date(dd:mm:yyyy),Time(hh:mm:ss)" +
           index + names +
           ",Scan\nARM_SGP,15:08:2019,21:46:45,1.581700,1.584500,1.600000,1.600000,0.025597,0."
           "021507,0.020917,0.020566" +
           values + ",Almucantar\n";
  }
};

double depth(const Scratch& scratch, int nm) {
  const Outcome outcome =
      malusIn(scratch.path, fmt::format("mie --sizes sgp.all --wavelength-nm {}", nm));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return std::stod(tableOf(outcome.out).header("optical_depth"));
}
}  // namespace

// AERONET's own AOD_Extinction-Total of this inversion. Its particles are partly spheroids, ours are spheres, whose extinction
// differs by less than three per cent.
TEST(SizeMixturesPublished, OpticalDepthOfAnInversion) {
  const Scratch scratch;
  put(scratch / "sgp.all", Inversion().text());
  const std::vector<std::pair<int, double>> theirs{
      {440, 0.2282}, {675, 0.1196}, {870, 0.0851}, {1020, 0.0702}};
  for (const auto& [nm, tau] : theirs) EXPECT_NEAR(depth(scratch, nm) / tau, 1, 0.03) << nm;
  Inversion other;
  for (double& radius : other.radius_um) radius *= 1.1;  // control
  put(scratch / "sgp.all", other.text());
  EXPECT_GT(std::abs(depth(scratch, 440) / 0.2282 - 1), 0.03);
}

// A radius between each two, with the mean volume, is the same distribution in half the steps.
TEST(SizeMixturesInvariant, TheStepsOfAnInversionAreFineEnough) {
  const Scratch scratch;
  const Inversion coarse;
  Inversion fine{{coarse.radius_um[0]}, {coarse.volume[0]}};
  for (std::size_t i = 1; i < coarse.volume.size(); ++i) {
    fine.radius_um.push_back(std::sqrt(coarse.radius_um[i - 1] * coarse.radius_um[i]));
    fine.volume.push_back((coarse.volume[i - 1] + coarse.volume[i]) / 2);
    fine.radius_um.push_back(coarse.radius_um[i]), fine.volume.push_back(coarse.volume[i]);
  }
  put(scratch / "sgp.all", coarse.text());
  const double tau = depth(scratch, 440);
  put(scratch / "sgp.all", fine.text());
  EXPECT_NEAR(depth(scratch, 440) / tau, 1, 1e-4);
}

TEST(SizeMixturesIdentity, ModesOfOneLawAreThatLaw) {
  const Scratch scratch;
  put(scratch / "one.csv", columns + "30,1.5,0.01,0.1,1.6,,,\n70,1.5,0.01,0.1,1.6,,,\n");
  const Table mixture = answered(scratch, "--sizes one.csv"),
              law =
                  answered(scratch, "--n 1.5 --k 0.01 --median-radius-um 0.1 --deviation 1.6");
  for (const std::string& column : law.columns())
    EXPECT_NEAR(mixture.number(0, column) / law.number(0, column), 1, 1e-12) << column;
  EXPECT_NEAR(std::stod(mixture.header("extinction_per_km")),
              100e-3 * law.number(0, "C_ext_um2"), 1e-15);
  EXPECT_EQ(law.header("extinction_per_km"), "");
}

// Three modes of different laws and indices: cross sections and matrix are sums by hand, whatever the unit of the numbers.
TEST(SizeMixturesIdentity, ModesAddUp) {
  const Scratch scratch;
  const std::vector<std::pair<double, std::string>> alone{
      {1000, "--n 1.5 --k 0.01 --median-radius-um 0.1 --deviation 1.6"},
      {3, "--n 1.4 --effective-radius-um 0.5 --effective-variance 0.1"},
      {200, "--n 1.75 --k 0.44 --radius-um 0.05"}};
  const std::string rows = ",1.5,0.01,0.1,1.6,,,\n{},1.4,0,,,0.5,0.1,\n{},1.75,0.44,,,,,0.05\n";
  for (const double unit : {1.0, 1e-3}) {
    put(scratch / "three.csv", columns + fmt::format("{}", 1000 * unit) +
                                   fmt::format(fmt::runtime(rows), 3 * unit, 200 * unit));
    const Table mixture = answered(scratch, "--sizes three.csv"),
                matrix = answered(scratch, "--sizes three.csv --matrix-step-deg 45");
    double number = 0, extinction = 0, scattering = 0, f11 = 0, f12 = 0, f34 = 0;
    for (const auto& [share, flags] : alone) {
      const Table one = answered(scratch, flags),
                  at = answered(scratch, flags + " --matrix-step-deg 45");
      number += share, extinction += share * one.number(0, "C_ext_um2");
      const double part = share * one.number(0, "C_sca_um2"), a1 = at.number(1, "F11");
      scattering += part, f11 += part * a1;
      f12 += part * a1 * at.number(1, "-F12/F11"), f34 += part * a1 * at.number(1, "F34/F11");
    }
    EXPECT_NEAR(mixture.number(0, "C_ext_um2") / (extinction / number), 1, 1e-12);
    EXPECT_NEAR(mixture.number(0, "albedo") / (scattering / extinction), 1, 1e-12);
    EXPECT_NEAR(matrix.number(1, "F11") / (f11 / scattering), 1, 1e-9);
    EXPECT_NEAR(matrix.number(1, "-F12/F11") / (f12 / f11), 1, 1e-8);
    EXPECT_NEAR(matrix.number(1, "F34/F11") / (f34 / f11), 1, 1e-8);
    const Table first = answered(scratch, alone[0].second);  // control
    EXPECT_GT(std::abs(first.number(0, "C_ext_um2") / mixture.number(0, "C_ext_um2") - 1), 0.1);
  }
}

// The whole way: a mixture becomes Greek constants, and these a sky.
TEST(SizeMixturesIdentity, AMixtureLightsASky) {
  const Scratch scratch;
  put(scratch / "continental.csv", contents("scenes/data/continental.csv"));
  ASSERT_EQ(malusIn(scratch.path,
                    "mie --sizes continental.csv --wavelength-nm 550 --greek --out haze.csv")
                .code,
            0);
  const Outcome sky = malusIn(
      scratch.path,
      "sky --wavelength-nm 550 --mu0 0.5 --mu 0.5 --aerosol haze.csv --aerosol-tau 0.3");
  EXPECT_EQ(sky.code, 0) << sky.err;
  EXPECT_NE(contents(scratch / "haze.csv").find("# extinction_per_km: 0.03"),
            std::string::npos);
  // a table of two wavelengths, of which one is requested
  put(scratch / "two.csv",
      "wavelength_nm,number_cm3,n,radius_um\n440,1,1.5,0.2\n550,1,1.4,0.2\n");
  EXPECT_EQ(answered(scratch, "--sizes two.csv").number(0, "Q_ext"),
            answered(scratch, "--n 1.4 --radius-um 0.2").number(0, "Q_ext"));
  // an index for all modes, by the flag
  put(scratch / "bare.csv", "number_cm3,radius_um\n1,0.2\n");
  EXPECT_EQ(answered(scratch, "--sizes bare.csv --n 1.4").number(0, "Q_ext"),
            answered(scratch, "--n 1.4 --radius-um 0.2").number(0, "Q_ext"));
}

TEST(SizeMixturesRefusals, BrokenModes) {
  const auto row = [](const std::string& cells) {
    return complaint(columns + "1,1.5,0,0.1,1.6,,,\n" + cells + "\n");
  };
  EXPECT_EQ(row("0,1.5,0,0.1,1.6,,,"),
            "sizes.csv:3: number_cm3 = 0: must be above 0, up to 1e+15; fix the mode");
  EXPECT_EQ(row("1,1.5,-1,0.1,1.6,,,"), "sizes.csv:3: k = -1: must be 0 to 100; fix the mode");
  EXPECT_EQ(row("1,1.5,0,0.1,9,,,"),
            "sizes.csv:3: deviation = 9: must be 1.01 to 3; fix the mode");
  EXPECT_EQ(row("1,1.5,0,0.1,,,,").substr(0, 38), "sizes.csv:3: deviation: the number is ");
  EXPECT_EQ(row("1,1.5,0,0.1,1.6,,,0.2").substr(0, 50),
            "sizes.csv:3: has no law of sizes, or several; fill");
  EXPECT_EQ(row("1,1.5,0,,,,,").substr(0, 50),
            "sizes.csv:3: has no law of sizes, or several; fill");
  EXPECT_EQ(row("1,1.5,0,O.1,1.6,,,").substr(0, 38), "sizes.csv:3: median_radius_um = O.1: i");
  EXPECT_EQ(row("1,1,0,0.1,1.6,,,").substr(0, 60),
            "command line: --sizes = sizes.csv: is the index of the mediu");
  EXPECT_EQ(complaint(columns),
            "sizes.csv: has no mode for 550 nm; give a row for each mode, with number_cm3 and "
            "a law of sizes");
  EXPECT_EQ(complaint("").substr(0, 19), "sizes.csv: is empty");
  EXPECT_EQ(complaint(columns + "1,1.5,0,0.1,1.6,,,\n", "--row 1"),
            "sizes.csv: 1: selects nothing among modes; leave out --row, which chooses an "
            "inversion of AERONET");
  EXPECT_EQ(complaint(columns + "1,1.5,0,0.1,1.6,,,\n", "--n 1.5"),
            "command line: --n: conflicts with an index in the file; leave it out");
  EXPECT_EQ(complaint("number_cm3,radius_um\n1,0.1\n").substr(0, 32),
            "command line: --n: is missing; g");
  EXPECT_EQ(complaint(columns + "1,1.5,0,0.1,1.6,,,\n", "--deviation 2").substr(0, 57),
            "command line: --deviation = 2: has no meaning beside --si");
  EXPECT_EQ(complaint(columns + "1,1.5,0,40,1.6,,,\n").substr(0, 40),
            "command line: --sizes = sizes.csv: spher");
}

TEST(SizeMixturesRefusals, BrokenInversions) {
  const std::string whole = Inversion().text(), last = whole.substr(whole.find("ARM_SGP,"));
  EXPECT_EQ(complaint(whole), "read");
  EXPECT_EQ(complaint(whole + last),
            "sizes.csv: holds 2 inversions; choose one with --row, 1 to 2");
  EXPECT_EQ(complaint(whole + last, "--row 2"), "read");
  EXPECT_EQ(complaint(whole + last, "--row 3"),
            "sizes.csv: row = 3: must be a number from 1 to 2; choose an inversion");
  EXPECT_EQ(complaint(whole + last, "--row 1.5").substr(0, 21), "sizes.csv: row = 1.5:");
  EXPECT_EQ(complaint(whole.substr(0, whole.find("ARM_SGP,"))),
            "sizes.csv:4: is followed by no inversion; give the whole file");
  EXPECT_EQ(complaint(whole.substr(0, whole.size() - 20)).substr(0, 47),
            "sizes.csv:5: 32 cells: but line 4 names 34 colu");
  const auto changed = [&](const std::string& old, const std::string& fresh,
                           const std::string& more = "") {
    std::string text = whole;
    return complaint(text.replace(text.find(old), old.size(), fresh), more);
  };
  EXPECT_EQ(
      changed("0.010422", "-999"),
      "sizes.csv:5: 0.086077 = -999: was not found by the inversion; choose another inversion");
  EXPECT_EQ(changed("0.010422", "-0.01"),
            "sizes.csv:5: 0.086077 = -0.01: is not a volume at a radius above the one before; "
            "give dV/dlnr, 0 or more, with the "
            "radii in order");
  EXPECT_EQ(changed("0.010422", "O.01").substr(0, 40),
            "sizes.csv:5: 0.086077 = O.01: is not a n");
  EXPECT_EQ(changed("0.086077", "0.066").substr(0, 30), "read");
  EXPECT_EQ(changed("0.086077", "0.065").substr(0, 36), "sizes.csv:5: 0.065 = 0.010422: is no");
  EXPECT_EQ(changed("1.581700", "N/A").substr(0, 60),
            "sizes.csv:5: Refractive_Index-Real_Part[440nm] = N/A: is not");
  EXPECT_EQ(changed("Version", "version", "--n 1.5"),
            "command line: --n: conflicts with an index in the file; leave it out");
  const Scratch scratch;
  put(scratch / "sgp.all", whole);
  const Outcome beyond = malusIn(scratch.path, "mie --sizes sgp.all --wavelength-nm 400");
  EXPECT_EQ(beyond.code, 2);
  EXPECT_EQ(beyond.err,
            "sgp.all:5: Refractive_Index-Real_Part[...] = 400 nm: is not covered: the file has "
            "440 to 1020 nm; choose a wavelength in between; nothing is extrapolated\n");
}
