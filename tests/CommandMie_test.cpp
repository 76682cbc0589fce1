// malus mie, from outside (nw/app/CommandMie.nw), and its files in malus sky.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "ExtremeNumbers.hpp"
#include "Program.hpp"
#include "malus/air/Scatterer.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}

Table answered(const Scratch& scratch, const std::string& question) {
  const Outcome outcome = malusIn(scratch.path, question);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return tableOf(outcome.out);
}

const std::string garcia =
    "mie --n 1.44 --wavelength-nm 951 --effective-radius-um 0.2 --effective-variance 0.07 ";
}  // namespace

// Bohren and Huffman 1983, appendix A; half a unit of the printed digit.
TEST(CommandMiePublished, SampleOfBohrenAndHuffman) {
  const Scratch scratch;
  const Table sphere =
      answered(scratch, "mie --n 1.55 --wavelength-nm 632.8 --radius-um 0.525");
  EXPECT_NEAR(sphere.number(0, "x_eff"), 5.213, 5e-4);
  EXPECT_NEAR(sphere.number(0, "Q_ext"), 3.10543, 5e-6);
  EXPECT_NEAR(sphere.number(0, "Q_sca"), 3.10543, 5e-6);
  EXPECT_NEAR(sphere.number(0, "Q_back"), 2.92534, 5e-6);
  EXPECT_NEAR(sphere.number(0, "asymmetry"), 0.63314, 5e-6);
  EXPECT_NEAR(sphere.number(0, "C_ext_um2"),
              sphere.number(0, "Q_ext") * std::numbers::pi * 0.525 * 0.525, 1e-12);
  const Table other = answered(scratch, "mie --n 1.55 --wavelength-nm 632 --radius-um 0.525");
  EXPECT_GT(std::abs(other.number(0, "Q_ext") - 3.10543), 5e-6);  // negative control
}

// Evans and Stephens 1991, table 3: twelve terms, each rounded at the eighth decimal. Their F34 has the other sense
// of V.
TEST(CommandMiePublished, MatrixOfEvansAndStephens) {
  const Table series = Table::read("validation/printed/evans1991-series.csv");
  const Scratch scratch;
  const Table ours = answered(scratch, garcia + "--matrix-step-deg 10");
  ASSERT_EQ(ours.rows(), 19u);
  std::vector<double> p(series.rows());
  for (std::size_t row = 0; row < ours.rows(); ++row) {
    const double angle = ours.number(row, "angle_deg");
    sphericalFunctions(0, 0, std::cos(angle * std::numbers::pi / 180), p);
    double f11 = 0, f12 = 0, f33 = 0, f34 = 0;
    for (std::size_t l = 0; l < p.size(); ++l) {
      f11 += p[l] * series.number(l, "F11"), f12 += p[l] * series.number(l, "F12");
      f33 += p[l] * series.number(l, "F33"), f34 += p[l] * series.number(l, "F34");
    }
    const double tolerance = 6e-8, scale = ours.number(row, "F11");
    EXPECT_NEAR(scale, f11, tolerance) << angle;
    EXPECT_NEAR(ours.number(row, "-F12/F11") * scale, -f12, tolerance) << angle;
    EXPECT_NEAR(ours.number(row, "F33/F11") * scale, f33, tolerance) << angle;
    EXPECT_NEAR(ours.number(row, "F34/F11") * scale, -f34, tolerance) << angle;
    if (angle > 0 && angle < 180) {
      EXPECT_GT(std::abs(ours.number(row, "F34/F11") * scale - f34), tolerance);  // control
    }
  }
}

// The file of malus mie has the same scattering as its matrix; terms beyond the series are
// below 1e-9.
TEST(CommandMieIdentity, GreekConstantsAreTheMatrix) {
  const Scratch scratch;
  const std::string spheres =
      "mie --n 1.5 --k 0.02 --wavelength-nm 500 --median-radius-um 0.1 --deviation 1.6 ";
  ASSERT_EQ(malusIn(scratch.path, spheres + "--greek --out dust.csv").code, 0);
  const Table file = Table::read(scratch / "dust.csv");
  const Scatterer read = Scatterer::read(file);
  const Table matrix = answered(scratch, spheres + "--matrix-step-deg 15"),
              row = answered(scratch, spheres);
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    const ScatteringMatrix f =
        read.matrix(std::cos(matrix.number(i, "angle_deg") * std::numbers::pi / 180));
    EXPECT_NEAR(f.a1, matrix.number(i, "F11"), 1e-12);
    EXPECT_NEAR(f.b1 / f.a1, matrix.number(i, "-F12/F11"), 1e-12);
    EXPECT_NEAR(f.a3 / f.a1, matrix.number(i, "F33/F11"), 1e-12);
    EXPECT_NEAR(-f.b2 / f.a1, matrix.number(i, "F34/F11"), 1e-12);
    if (i == 6) {
      EXPECT_GT(std::abs(f.b2), 1e-3);  // the sign was seen
    }
  }
  EXPECT_EQ(file.header("single_scattering_albedo"),
            fmt::format("{}", row.number(0, "albedo")));
  EXPECT_EQ(file.header("wavelength_nm"), "500");
  EXPECT_LT(row.number(0, "albedo"), 0.99);
  EXPECT_NEAR(row.number(0, "Q_ext"), row.number(0, "Q_sca") + row.number(0, "Q_abs"), 1e-14);
}

// A medium is another wavelength and another index; a size is a radius in units of the wavelength.
TEST(CommandMieIdentity, TheWaysToAskAgree) {
  const Scratch scratch;
  const Table
      air = answered(scratch, "mie --n 1.2 --k 0.01 --wavelength-nm 500 --radius-um 0.3"),
      water = answered(
          scratch,
          "mie --n 1.596 --k 0.0133 --medium-n 1.33 --wavelength-nm 665 --radius-um 0.3"),
      size =
          answered(scratch, fmt::format("mie --n 1.2 --k 0.01 --x {}", 1.2 * std::numbers::pi)),
      other = answered(scratch, "mie --n 1.2 --k 0.01 --wavelength-nm 510 --radius-um 0.3");
  for (const char* column : {"x_eff", "Q_ext", "Q_sca", "Q_back", "albedo", "asymmetry"}) {
    EXPECT_NEAR(water.number(0, column) / air.number(0, column), 1, 1e-9) << column;
    EXPECT_NEAR(size.number(0, column) / air.number(0, column), 1, 1e-9) << column;
    EXPECT_GT(std::abs(other.number(0, column) / air.number(0, column) - 1), 1e-9) << column;
  }
  EXPECT_FALSE(size.has("C_ext_um2"));
}

// The albedo of the file is the sky's, unless the question says otherwise.
TEST(CommandMieInvariant, TheSkyTakesTheAlbedoFromTheFile) {
  const Scratch scratch;
  ASSERT_EQ(
      malusIn(scratch.path,
              "mie --n 1.5 --k 0.02 --wavelength-nm 550 --radius-um 0.2 --greek --out dust.csv")
          .code,
      0);
  const std::string albedo =
      Table::read(scratch / "dust.csv").header("single_scattering_albedo");
  const std::string ask =
      "sky --wavelength-nm 550 --mu0 0.6 --mu 0.4 --phi-deg 90 --aerosol dust.csv "
      "--aerosol-tau "
      "0.3";
  const Table from_file = answered(scratch, ask),
              told = answered(scratch, ask + " --aerosol-albedo " + albedo),
              other = answered(scratch, ask + " --aerosol-albedo 1");
  for (const char* component : {"I", "Q", "U", "V"})
    EXPECT_EQ(from_file.cell(0, component), told.cell(0, component));
  EXPECT_GT(other.number(0, "I"), 1.01 * from_file.number(0, "I"));  // control
}

// One wavelength in the file, another in the question.
TEST(CommandMieInvariant, TheSkyRefusesTheAerosolOfAnotherWavelength) {
  const Scratch scratch;
  ASSERT_EQ(malusIn(scratch.path,
                    "mie --n 1.44 --wavelength-nm 650 --radius-um 0.2 --greek --out red.csv")
                .code,
            0);
  const std::string ask = " --mu0 0.6 --mu 0.4 --aerosol red.csv --aerosol-tau 0.3";
  EXPECT_EQ(malusIn(scratch.path, "sky --wavelength-nm 650" + ask).code, 0);
  EXPECT_EQ(malusIn(scratch.path, "sky --tau 0.1" + ask).code, 0);
  const Outcome wrong = malusIn(scratch.path, "sky --wavelength-nm 450" + ask);
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.err,
            "red.csv: wavelength_nm: is not that of the sky, 450 nm; make the file at this "
            "wavelength, or take wavelength_nm out of it\n");
}

TEST(CommandMieInvariant, BadInputIsOneLineAndExitCodeTwo) {
  const Scratch scratch;
  const std::string good = "--n 1.5 --wavelength-nm 500 ";
  for (const std::string& bad : std::vector<std::string>{
           "",
           "--n 1.5",
           "--x 3",
           "--n 1.5 --x 0",
           "--n 1.5 --x -1",
           "--n 1.5 --x nan",
           "--n 1.5 --x 451",
           "--n 1 --x 3",
           "--n 0 --x 3",
           "--n 1.5 --k -0.1 --x 3",
           "--n 1.5 --radius-um 0.2",
           "--n 1.5 --x 3 --wavelength-nm 500",
           "--n 1.33 --medium-n 1.33 --x 3",
           "--n 1.5 --medium-n 0 --x 3",
           good,
           good + "--radius-um 0",
           good + "--radius-um big",
           good + "--radius-um 100",
           good + "--radius-um 0.2 --x 3",
           good + "--radius-um 0.2 --effective-variance 0.1",
           good + "--radius-um 0.2 --largest-radius-um 1",
           good + "--effective-radius-um 0.2",
           good + "--effective-radius-um 0.2 --effective-variance 0.5",
           good + "--effective-radius-um 0.2 --effective-variance 0.1 --largest-radius-um 1e-6",
           good + "--effective-radius-um 0.2 --deviation 2",
           good + "--median-radius-um 0.2",
           good + "--median-radius-um 0.2 --deviation 1",
           good + "--median-radius-um 5 --deviation 3",
           good + "--radius-um 0.2 --matrix-step-deg 7",
           good + "--radius-um 0.2 --matrix-step-deg 0",
           good + "--radius-um 0.2 --matrix-step-deg 1 --greek",
           good + "--radius-um 0.2 --effective-radius-um 0.2 --effective-variance 0.1"}) {
    const Outcome outcome = malusIn(scratch.path, "mie " + bad + " --out answer.csv");
    EXPECT_EQ(outcome.code, 2) << bad << '\n' << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << bad << '\n'
                                                                           << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(scratch / "answer.csv")) << bad;
  }
  EXPECT_EQ(malusIn(scratch.path, "mie " + good + "--radius-um 0.2 --out answer.csv").code,
            0);  // control
  EXPECT_TRUE(std::filesystem::exists(scratch / "answer.csv"));
  const std::string cut =
      malusIn(scratch.path, "mie " + good + "--median-radius-um 5 --deviation 3").err;
  EXPECT_NE(cut.find("--largest-radius-um"), std::string::npos) << cut;
  put(scratch / "albedo.csv",
      "# convention: dehaan\n# single_scattering_albedo: "
      "1.5\nl,alpha1,alpha2,alpha3,alpha4,beta1,beta2\n0,1,0,0,0,0,0\n");
  const Outcome outcome = malusIn(
      scratch.path, "sky --tau 0.1 --mu0 0.5 --mu 0.5 --aerosol albedo.csv --aerosol-tau 0.1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("single_scattering_albedo"), std::string::npos) << outcome.err;
}

TEST(CommandMieInvariant, ExtremeNumbersAreAnsweredOrRefused) {
  const Scratch scratch;
  const auto ask = [&](const std::vector<std::pair<std::string, std::string>>& flags) {
    for (const auto& [flag, value] : flags) {
      std::string question = "mie";
      for (const auto& [other, text] : flags)
        if (other != flag) question += " " + other + " " + text;
      expectFiniteOrRefused(scratch.path, question, flag);
    }
  };
  ask({{"--n", "1.5"}, {"--k", "0.01"}, {"--medium-n", "1.1"}, {"--x", "2"}});
  ask({{"--n", "1.5"}, {"--wavelength-nm", "500"}, {"--radius-um", "0.1"}});
  ask({{"--n", "1.5"},
       {"--wavelength-nm", "900"},
       {"--effective-radius-um", "0.2"},
       {"--effective-variance", "0.07"},
       {"--largest-radius-um", "2"}});
  ask({{"--n", "1.5"},
       {"--wavelength-nm", "900"},
       {"--median-radius-um", "0.1"},
       {"--deviation", "1.5"},
       {"--largest-radius-um", "2"}});
}
