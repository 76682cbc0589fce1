// malus sky, from outside (nw/app/CommandSky.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "ExtremeNumbers.hpp"
#include "Program.hpp"
#include "malus/air/Sky.hpp"
#include "malus/air/Sun.hpp"
#include "malus/air/TableSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}

// The printed values as a file of questions: the file's own columns under the names of malus sky.
std::string questions(const Table& printed) {
  std::string text = "tau,depolarization,albedo,irradiance,mu0,mu,phi_deg,direction,tau_obs\n";
  for (std::size_t row = 0; row < printed.rows(); ++row) {
    for (const char* column : {"tau", "rho_depol", "albedo", "F0", "mu0", "mu", "phi_deg"})
      text += printed.cell(row, column) + ",";
    text += printed.cell(row, "dir") == "UP" ? "up," : "down,";
    text += printed.cell(row, "tau_obs") + "\n";
  }
  return text;
}

const std::string spheroids =
    fmt::format("'{}'", (std::filesystem::path(MALUS_SOURCE_DATA).parent_path() /
                         "scenes/data/aerosol-spheroids.csv")
                            .string());
}  // namespace

// Siewert 2000, problem IIA, through files: half a unit of the sixth digit, and 1e-6 for flat lines of sight.
TEST(CommandSkyPublished, AFileOfAerosolQuestions) {
  const Table printed = Table::read("validation/printed/siewert2000.csv");
  const Scratch scratch;
  std::string text = "tau,aerosol_tau,aerosol_albedo,mu0,mu,phi_deg,direction,tau_obs\n";
  const std::vector<std::pair<std::string, std::string>> depths{
      {"tau_0", "0"}, {"tau_0.25", "0.25"}, {"tau_1", "1"}};
  struct Row {
    double value;
    char component;
  };
  std::vector<Row> wanted;
  for (std::size_t row = 0; row < printed.rows(); ++row) {
    const double mu = printed.number(row, "mu");
    if (std::abs(mu) == 1) continue;  // computed a little beside the vertical
    for (const auto& [column, depth] : depths) {
      text += fmt::format("0,1,0.973527,0.6,{},{},{},{}\n", std::abs(mu),
                          -printed.number(row, "phi_deg"), mu < 0 ? "up" : "down", depth);
      wanted.push_back({printed.number(row, column), printed.cell(row, "component")[0]});
    }
  }
  put(scratch / "questions.csv", text);
  const Outcome outcome = malusIn(
      scratch.path, "sky --input questions.csv --convention iprt --aerosol " + spheroids);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Table answer = tableOf(outcome.out);
  ASSERT_EQ(answer.rows(), wanted.size());
  int with_v = 0;
  for (std::size_t row = 0; row < wanted.size(); ++row) {
    const double ours = answer.number(row, std::string(1, wanted[row].component)),
                 theirs = wanted[row].value;
    EXPECT_NEAR(ours, theirs, 1e-6 + 5e-6 * std::abs(theirs)) << row;
    with_v += wanted[row].component == 'V' && std::abs(theirs) > 1e-5;
    if (std::abs(theirs) > 1e-3) {
      EXPECT_GT(std::abs(ours * 1.002 - theirs), 1e-6 + 5e-6 * std::abs(theirs));  // control
    }
  }
  EXPECT_GT(with_v, 30);
}

TEST(CommandSkyInvariant, FluxesBalance) {
  const Scratch scratch;
  for (const std::string albedo : {"0", "0.3", "1"}) {
    const Table clear = tableOf(
        malusIn(scratch.path,
                "sky --tau 0.5 --depolarization 0.03 --mu0 0.6 --fluxes --albedo " + albedo)
            .out);
    EXPECT_NEAR(clear.number(0, "flux_in"), 0.6 * std::numbers::pi, 1e-15);
    EXPECT_NEAR(clear.number(0, "flux_air"), 0, 1e-10);
    EXPECT_NEAR(clear.number(0, "flux_direct"), 0.6 * std::numbers::pi * std::exp(-0.5 / 0.6),
                1e-14);
    EXPECT_GT(clear.number(0, "flux_down"), 0.1);
    const Table dusty = tableOf(malusIn(scratch.path,
                                        "sky --tau 0.5 --mu0 0.6 --fluxes --aerosol-tau 0.2 "
                                        "--aerosol-albedo 0.9 --aerosol " +
                                            spheroids + " --albedo " + albedo)
                                    .out);
    EXPECT_GT(dusty.number(0, "flux_air"), 0.01);  // control: what absorbs does not balance
  }
}

// Path radiance and transmission: what they say together is what is seen, and over black ground there is only path.
TEST(CommandSkyIdentity, PathAndGroundAddUp) {
  const Scratch scratch;
  const std::string question =
      "sky --tau 0.3 --mu0 0.6 --mu 0.4 --phi-deg 50 --direction up --tau-obs 0.1 --path ";
  const Table grey = tableOf(malusIn(scratch.path, question + "--albedo 0.4").out),
              black = tableOf(malusIn(scratch.path, question).out);
  EXPECT_NEAR(grey.number(0, "transmission"), std::exp(-0.2 / 0.4), 1e-15);
  EXPECT_NEAR(
      grey.number(0, "path_I") + grey.number(0, "transmission") * grey.number(0, "ground_I"),
      grey.number(0, "I"), 1e-15);
  EXPECT_EQ(black.number(0, "ground_I"), 0);
  EXPECT_EQ(black.number(0, "path_I"), black.number(0, "I"));
  EXPECT_GT(grey.number(0, "path_I"),
            black.number(0, "path_I"));  // the ground lights the air, too
  EXPECT_NE(grey.number(0, "path_U"), 0);
}

// The neutral points of the picture are zeros of Q in the meridian that malus sky computes for
// directions.
TEST(CommandSkyInvariant, ThePictureMarksTheNeutralPoints) {
  const Scratch scratch;
  for (const std::string& aerosol :
       {std::string(), " --aerosol-tau 0.05 --aerosol " + spheroids}) {
    const std::string air = "sky --wavelength-nm 450 --mu0 0.17" + aerosol;
    const Outcome outcome = malusIn(scratch.path, air + " --picture dome");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* kind : {"S0", "DoLP", "AoLP"})
      EXPECT_GT(std::filesystem::file_size(scratch / fmt::format("dome.{}.png", kind)), 1000u);
    const Table points = tableOf(outcome.out);
    std::vector<std::string> names = points.text("name");
    EXPECT_NE(std::find(names.begin(), names.end(), "Babinet"), names.end());
    EXPECT_NE(std::find(names.begin(), names.end(), "Arago"), names.end());
    for (std::size_t row = 0; row < points.rows(); ++row) {
      const auto at = [&](double zenith_deg) {
        const Table one =
            tableOf(malusIn(scratch.path,
                            air + fmt::format(" --mu {} --phi-deg {}",
                                              std::cos(zenith_deg * std::numbers::pi / 180),
                                              points.cell(row, "phi_deg")))
                        .out);
        return one.number(0, "Q") / one.number(0, "I");
      };
      const double zenith = points.number(row, "zenith_deg");
      if (zenith > 88) continue;
      EXPECT_LT(std::abs(at(zenith)), 2e-4)
          << points.cell(row, "name");  // linear between quarters of a degree
      EXPECT_LT(at(zenith - 1) * at(zenith + 1), 0) << points.cell(row, "name");
    }
  }
}

// Natraj, Li and Yung 2009 and IPRT A2; half a unit of the last printed digit, or the file's tolerance.
TEST(CommandSkyPublished, AFileOfPrintedValuesInEveryConvention) {
  const Table printed = Table::read("validation/printed/rayleigh.csv");
  const Scratch scratch;
  put(scratch / "questions.csv", questions(printed));
  for (const std::string convention : {"iprt", "natraj", "malus"}) {
    const Outcome outcome =
        malusIn(scratch.path, "sky --input questions.csv --convention " + convention);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Table answer = tableOf(outcome.out);
    EXPECT_EQ(answer.header("convention"), convention);
    ASSERT_EQ(answer.rows(), printed.rows());
    const double q_sign = convention == "iprt" ? 1 : -1;
    for (std::size_t row = 0; row < printed.rows(); ++row) {
      const double tolerance = std::max(6e-9, printed.cell(row, "source") == "natraj2009"
                                                  ? 0
                                                  : printed.number(row, "tol_abs"));
      EXPECT_NEAR(answer.number(row, "I"), printed.number(row, "I"), tolerance) << row;
      EXPECT_NEAR(answer.number(row, "Q"), q_sign * printed.number(row, "Q"), tolerance) << row;
      EXPECT_NEAR(answer.number(row, "U"), printed.number(row, "U"), tolerance) << row;
      EXPECT_EQ(answer.number(row, "V"), 0);
      EXPECT_GT(std::abs(answer.number(row, "I") * 1.0001 - printed.number(row, "I")),
                tolerance);  // control
    }
  }
}

TEST(CommandSkyIdentity, FlagsAskTheSameAsAFile) {
  const Scratch scratch;
  put(scratch / "one.csv", "tau,albedo,mu0,mu,phi_deg,label\n0.5,0.25,0.6,0.4,90,here\n");
  const Table flags = tableOf(
      malusIn(scratch.path,
              "sky --tau 0.5 --albedo 0.25 --mu0 0.6 --mu 0.4 --phi-deg 90 --convention iprt")
          .out);
  const Table file =
      tableOf(malusIn(scratch.path, "sky --input one.csv --convention iprt").out);
  ASSERT_EQ(flags.rows(), 1u);
  for (const char* column : {"I", "Q", "U"})
    EXPECT_EQ(flags.cell(0, column), file.cell(0, column));
  EXPECT_EQ(file.cell(0, "label"), "here");
  EXPECT_NEAR(flags.number(0, "I"), 0.22239883, 6e-9);  // Natraj, Li and Yung 2009
  EXPECT_NEAR(flags.number(0, "U"), 0.11112462, 6e-9);
}

// The dome that comes out is a sky that goes in.
TEST(CommandSkyIdentity, TheDomeIsASky) {
  const Scratch scratch;
  for (const std::string convention : {"malus", "iprt"}) {
    const Outcome outcome = malusIn(scratch.path,
                                    "sky --wavelength-nm 450 --albedo 0.2 --mu0 0.5 "
                                    "--dome-step-deg 10 --out sky.csv --convention " +
                                        convention);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const TableSky sky(Table::read(scratch / "sky.csv"), SpectralGrid::make({450.0}));
    CDSpectralVector<CDStokesVector> out(sky.grid());
    sky.radiance(compassDirection(60 * degree, 40 * degree), out);
    const Table one =
        tableOf(malusIn(scratch.path,
                        "sky --wavelength-nm 450 --albedo 0.2 --mu0 0.5 --mu 0.5 --phi-deg 40")
                    .out);
    const CDStokesVector light = out[0];
    const char* const names[]{"I", "Q", "U"};
    // 0.5 is not the cosine of 60 deg to the last digit
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(light.getStokes(k), one.number(0, names[k]), 1e-9) << convention << k;
  }
}

TEST(CommandSkyIdentity, WavelengthsAndTheRealSun) {
  const Scratch scratch;
  const Table real = tableOf(
      malusIn(scratch.path, "sky --wavelength-nm 450 --mu0 0.9 --mu 0.5 --irradiance astm-e490")
          .out);
  const Table unit = tableOf(
      malusIn(scratch.path, "sky --wavelength-nm 450 --mu0 0.9 --mu 0.5 --irradiance 1").out);
  EXPECT_NEAR(real.number(0, "I") / unit.number(0, "I"), 1.996,
              0.0005);  // ASTM E490, 10-nm mean
  const Table low = tableOf(
      malusIn(scratch.path, "sky --wavelength-nm 450 --pressure-hPa 500 --mu0 0.9 --mu 0.5")
          .out);
  EXPECT_LT(low.number(0, "I"), unit.number(0, "I") * std::numbers::pi);
}

TEST(CommandSkyInvariant, BadInputIsOneLineAndExitCodeTwo) {
  const Scratch scratch;
  put(scratch / "none.csv", "tau,mu0,mu\n");
  put(scratch / "bad.csv", "tau,mu0,mu\n0.1,0.5,0.5\n0.1,0.5,0\n");
  put(scratch / "column.csv", "tau,albdo,mu0,mu\n0.1,0.2,0.5,0.5\n");
  put(scratch / "answer.csv", "tau,mu0,mu,I\n0.1,0.5,0.5,1\n");
  put(scratch / "greek.csv",
      "# convention: dehaan\nl,alpha1,alpha2,alpha3,alpha4,beta1,beta2\n0,1,0,0,0,0,0\n");
  put(scratch / "good.csv", "tau,mu0,mu\n0.1,0.5,0.5\n");
  for (const std::string bad :
       {"",
        "--tau 0.5",
        "--tau 0.5 --mu0 0.5",
        "--mu0 0.5 --mu 0.5",
        "--tau -1 --mu0 0.5 --mu 0.5",
        "--tau 0 --mu0 0.5 --mu 0.5",
        "--tau 17 --mu0 0.5 --mu 0.5",
        "--tau nan --mu0 0.5 --mu 0.5",
        "--tau 0.5 --mu0 0 --mu 0.5",
        "--tau 0.5 --mu0 -0.2 --mu 0.5",
        "--tau 0.5 --mu0 0.5 --mu 0",
        "--tau 0.5 --mu0 0.5 --mu 1.1",
        "--tau 0.5 --albedo 1.1 --mu0 0.5 --mu 0.5",
        "--tau 0.5 --depolarization 1 --mu0 0.5 --mu 0.5",
        "--wavelength-nm 100 --mu0 0.5 --mu 0.5",
        "--wavelength-nm 500 --pressure-hPa -3 --mu0 0.5 --mu 0.5",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --direction sideways",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --tau-obs 0.6",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --irradiance astm-e490",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --irradiance bright",
        "--wavelength-nm 1500 --mu0 0.5 --mu 0.5 --irradiance astm-e490",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --convention coulson",
        "--input absent.csv",
        "--input none.csv",
        "--input bad.csv --out answers.csv",
        "--input column.csv",
        "--input answer.csv",
        "--input good.csv --mu 0.4",
        "--input good.csv --dome-step-deg 5",
        "--tau 0.5 --mu0 0.5 --dome-step-deg 5",
        "--wavelength-nm 500 --mu0 0.5 --dome-step-deg 7",
        "--wavelength-nm 500 --mu0 0.5 --dome-step-deg 5 --picture dome",
        "--tau 0.5 --mu0 0.5 --dome-step-deg 5 --fluxes",
        "--wavelength-nm 500 --mu0 0.5 --dome-step-deg 5 --mu 0.4",
        "--wavelength-nm 500 --mu0 0.5 --dome-step-deg 5 --path",
        "--tau 0.5 --mu0 0.5 --fluxes --phi-deg 3",
        "--tau 0.5 --pressure-hPa 1000 --mu0 0.5 --mu 0.5",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --phi-deg 1e300",
        "--tau 0.5 --mu0 0 --fluxes",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --path",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol-tau 0.1",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol absent.csv --aerosol-tau 0.1",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol good.csv --aerosol-tau 0.1",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol greek.csv",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol greek.csv --aerosol-tau -1",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol greek.csv --aerosol-tau 0.1 --aerosol-albedo 2",
        "--tau 0.5 --mu0 0.5 --mu 0.5 --aerosol greek.csv --aerosol-tau 0.1 --aerosol-place "
        "beside"}) {
    const Outcome outcome = malusIn(scratch.path, std::string("sky ") + bad);
    EXPECT_EQ(outcome.code, 2) << bad;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << bad << '\n'
                                                                           << outcome.err;
    EXPECT_EQ(outcome.out, "") << bad;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "answers.csv"));
  EXPECT_NE(malusIn(scratch.path, "sky --input bad.csv").err.find("bad.csv:3"),
            std::string::npos);
  EXPECT_NE(malusIn(scratch.path, "sky --tau 0.5 --mu0 0.5 --mu 0.5 --irradiance bright")
                .err.find("is not an irradiance; give pi, astm-e490 or a number"),
            std::string::npos);
  const std::string choices =
      malusIn(scratch.path, "sky --tau 0.5 --mu0 0.5 --mu 0.5 --convention coulson").err;
  for (const char* choice : {"malus", "natraj", "iprt"})
    EXPECT_NE(choices.find(choice), std::string::npos);
}

TEST(CommandSkyIdentity, DepolarisationMayBeSpeltInTwoWays) {
  const Scratch scratch;
  const auto intensity = [&](const std::string& column, const std::string& value) {
    put(scratch / "one.csv",
        "tau,mu0,mu,phi_deg," + column + "\n0.5,0.6,0.4,90," + value + "\n");
    return tableOf(malusIn(scratch.path, "sky --input one.csv").out).number(0, "I");
  };
  EXPECT_EQ(intensity("depolarisation", "0.03"), intensity("depolarization", "0.03"));
  EXPECT_NE(intensity("depolarisation", "0.03"),
            intensity("depolarisation", "0"));  // it is read
  put(scratch / "two.csv",
      "tau,mu0,mu,phi_deg,depolarization,depolarisation\n0.5,0.6,0.4,90,0,0\n");
  const Outcome twice = malusIn(scratch.path, "sky --input two.csv");
  EXPECT_EQ(twice.code, 2);
  EXPECT_EQ(twice.err,
            "two.csv: depolarisation: conflicts with depolarization; give it once\n");
}

// Each number of a question by itself, the others as they should be.
TEST(CommandSkyInvariant, ExtremeNumbersAreAnsweredOrRefused) {
  const Scratch scratch;
  const std::vector<std::pair<std::string, std::string>> air{
      {"--tau", "0.3"},     {"--depolarization", "0.03"},
      {"--albedo", "0.5"},  {"--mu0", "0.6"},
      {"--mu", "0.4"},      {"--phi-deg", "30"},
      {"--tau-obs", "0.1"}, {"--irradiance", "2"}};
  const auto without = [](const auto& flags, const std::string& left_out) {
    std::string text;
    for (const auto& [flag, value] : flags)
      if (flag != left_out) text += " " + flag + " " + value;
    return text;
  };
  for (const auto& [flag, value] : air) {
    expectFiniteOrRefused(scratch.path, "sky" + without(air, flag), flag);
    expectFiniteOrRefused(scratch.path, "sky --direction up" + without(air, flag), flag);
  }
  for (const std::string flag : {"--tau", "--albedo", "--mu0"})
    expectFiniteOrRefused(
        scratch.path,
        "sky --fluxes" + without(
                             std::vector<std::pair<std::string, std::string>>{
                                 {"--tau", "0.3"}, {"--albedo", "1"}, {"--mu0", "0.6"}},
                             flag),
        flag);
  for (const std::string flag : {"--wavelength-nm", "--pressure-hPa"})
    expectFiniteOrRefused(
        scratch.path,
        "sky --mu0 0.6 --mu 0.4" +
            without(std::vector<std::pair<std::string, std::string>>{{"--wavelength-nm", "500"},
                                                                     {"--pressure-hPa", "900"}},
                    flag),
        flag);
  put(scratch / "dust.csv",
      "# convention: dehaan\nl,alpha1,alpha2,alpha3,alpha4,beta1,beta2\n0,1,0,0,0,0,0\n"
      "1,1,0,0,0,0,0\n");
  const std::vector<std::pair<std::string, std::string>> dusty{
      {"--tau", "0.1"},      {"--mu0", "0.6"},         {"--mu", "0.4"},
      {"--tau-obs", "0.05"}, {"--aerosol-tau", "0.1"}, {"--aerosol-albedo", "0.9"}};
  for (const auto& [flag, value] : dusty)
    expectFiniteOrRefused(scratch.path, "sky --aerosol dust.csv" + without(dusty, flag), flag);
}

// A grazing sun through the command: over white ground all comes back.
TEST(CommandSkyInvariant, AGrazingSunIsBalanced) {
  const Scratch scratch;
  for (const char* sun : {"1e-9", "2e-5", "1e-4"}) {
    const Outcome outcome =
        malusIn(scratch.path, std::string("sky --tau 0.05 --albedo 1 --fluxes --mu0 ") + sun);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Table fluxes = tableOf(outcome.out);
    EXPECT_NEAR(fluxes.number(0, "flux_up") / fluxes.number(0, "flux_in"), 1, 2e-6) << sun;
  }
}

TEST(CommandSkyInvariant, AnEmptyTextIsNoFlag) {
  const Scratch scratch;
  for (const char* flag : {"--aerosol", "--input", "--picture", "--albedo", "--out"}) {
    const Outcome outcome =
        malusIn(scratch.path, std::string("sky --tau 0.3 --mu0 0.6 --mu 0.4 ") + flag + " ''");
    EXPECT_EQ(outcome.code, 2) << flag;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(flag), std::string::npos) << outcome.err;
  }
}
