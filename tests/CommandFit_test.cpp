// malus fit, from outside (nw/app/CommandFit.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "Program.hpp"
#include "malus/base/Table.hpp"

using malus::Table;

namespace {
Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}

/// Geometries about three mirror directions, in the plane of incidence.
std::string geometries() {
  std::string text = "theta_i_deg,theta_r_deg,phi_deg\n";
  for (const int i : {20, 45, 65})
    for (int r = i - 15; r <= i + 15; r += 5)
      text += std::to_string(i) + "," + std::to_string(r) + ",180\n";
  return text;
}
}  // namespace

// Samples without noise; the numbers of the CSV have 17 digits. What is left is the table of the
// diffuse term (1e-5 absolute) and the differences.
TEST(CommandFitIdentity, FindsTheCopperThatBrdfWasGiven) {
  const Scratch scratch;
  put(scratch / "angles.csv", geometries());
  const Outcome brdf = malusIn(scratch.path,
                               "brdf --model torrance-sparrow --param n=0.405 --param k=2.95 "
                               "--param sigma=0.2 --input angles.csv --out plate.csv");
  ASSERT_EQ(brdf.code, 0) << brdf.err;
  const Outcome fit = malusIn(scratch.path, "fit --input plate.csv --out fit.csv");
  ASSERT_EQ(fit.code, 0) << fit.err;
  EXPECT_EQ(fit.out, "");
  const Table answer = Table::read(scratch / "fit.csv");
  ASSERT_EQ(answer.rows(), 1u);
  EXPECT_NEAR(answer.number(0, "n"), 0.405, 1e-3);
  EXPECT_NEAR(answer.number(0, "k"), 2.950, 1e-3);
  EXPECT_NEAR(answer.number(0, "sigma"), 0.2, 1e-4);
  EXPECT_NEAR(answer.number(0, "diffuse"), 1, 0.02);
  EXPECT_GT(answer.number(0, "n_error"), 0);
  EXPECT_EQ(answer.number(0, "samples"), 16 * 21);
  // negative control: another plate is not this copper
  malusIn(scratch.path,
          "brdf --model torrance-sparrow --param n=0.45 --param k=2.95 --param sigma=0.21 "
          "--input angles.csv --out other.csv");
  const Table other = tableOf(malusIn(scratch.path, "fit --input other.csv").out);
  EXPECT_GT(other.number(0, "n"), 0.42);
  EXPECT_GT(other.number(0, "sigma"), 0.205);
}

// Born and Wolf's formula at normal incidence, by hand: n = 1.5 gives R = 0.04; at 45 degrees
// Rs = 0.0920134 and Rp = Rs^2. For n = 5/3 they are 0.0625, 0.1309819 and its square.
TEST(CommandFitPublished, GlassByHandAndTwoWavelengths) {
  const Scratch scratch;
  put(scratch / "glass.csv",
      "wavelength_nm,theta_i_deg,Rs,Rp\n500,0,0.04,0.04\n500.0,45,0.0920134,0.00846647\n"
      "600,0,0.0625,0.0625\n600,45,0.1309819,0.0171563\n");
  const Outcome fit =
      malusIn(scratch.path, "fit --input glass.csv --fix sigma=0.1 --fix diffuse=0 --fix k=0");
  ASSERT_EQ(fit.code, 0) << fit.err;
  const Table answer = tableOf(fit.out);
  ASSERT_EQ(answer.rows(), 2u);
  EXPECT_EQ(answer.cell(0, "wavelength_nm"), "500");
  EXPECT_NEAR(answer.number(0, "n"), 1.5, 1e-4);                  // six printed digits
  EXPECT_NEAR(answer.number(1, "n"), 5.0 / 3, 1e-4);              // R = (1/4)^2
  EXPECT_GT(answer.number(1, "n") - answer.number(0, "n"), 0.1);  // negative control
  EXPECT_EQ(answer.number(0, "k"), 0);
  EXPECT_EQ(answer.number(0, "k_error"), 0);
}

TEST(CommandFitInvariant, BadInputIsOneLineAndExitCodeTwo) {
  const Scratch scratch;
  put(scratch / "none.csv", "theta_i_deg,Rs\n");
  put(scratch / "nothing.csv", "theta_i_deg,label\n20,a\n");
  put(scratch / "almost.csv", "theta_i_dg,Rs\n20,0.1\n");
  put(scratch / "angle.csv", "theta_i_deg,Rs\n20,0.1\n90,0.1\n");
  put(scratch / "text.csv", "theta_i_deg,Rs\n20,bright\n");
  put(scratch / "zero.csv", "theta_i_deg,Rs\n20,0\n");
  put(scratch / "normal.csv", "theta_i_deg,Rs,Rp\n0,0.8,0.8\n");
  put(scratch / "view.csv", "theta_i_deg,f00\n20,0.1\n");
  put(scratch / "percent.csv", "theta_i_deg,Rs,Rp\n20,5,3.2\n60,17.8,0.2\n");
  put(scratch / "colour.csv", "wavelength_nm,theta_i_deg,Rs\n-5,20,0.1\n");
  for (const std::string& bad :
       {std::string("fit"), std::string("fit --input absent.csv"),
        std::string("fit --input none.csv"), std::string("fit --input nothing.csv"),
        std::string("fit --input almost.csv"), std::string("fit --input angle.csv"),
        std::string("fit --input text.csv"), std::string("fit --input zero.csv"),
        std::string("fit --input view.csv"), std::string("fit --input colour.csv"),
        std::string("fit --input percent.csv --fix sigma=0.1 --fix diffuse=0"),
        std::string("fit --input normal.csv"),
        std::string("fit --input normal.csv --fix sigma=0.1 --fix diffuse=0 --out fit.csv"),
        std::string("fit --input normal.csv --fix sigma"),
        std::string("fit --input normal.csv --fix sigam=0.1"),
        std::string("fit --input normal.csv --fix sigma=-1"),
        std::string("fit --input normal.csv --fix k=1 --fix k=1"),
        std::string("fit --input normal.csv --error 0"),
        std::string("fit --input normal.csv --error x")}) {
    const Outcome outcome = malusIn(scratch.path, bad);
    EXPECT_EQ(outcome.code, 2) << bad;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << bad << '\n'
                                                                           << outcome.err;
    EXPECT_EQ(outcome.out, "") << bad;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "fit.csv"));
  const auto line = [&](const std::string& arguments) {
    return malusIn(scratch.path, "fit --input " + arguments).err;
  };
  EXPECT_NE(line("angle.csv").find("angle.csv:3"), std::string::npos);
  EXPECT_EQ(
      line("percent.csv"),
      "percent.csv:2: Rs = 5: is not a reflectance; give a share of the light, 0 to 1, not per "
      "cent\n");
  EXPECT_EQ(line("zero.csv"), "zero.csv:2: has no value other than zero; leave the row out\n");
  EXPECT_EQ(line("normal.csv --fix sigma"),
            "command line: --fix = sigma: has no value; write --fix sigma=0.2\n");
  EXPECT_EQ(line("normal.csv --fix n=1 --fix k=1 --fix sigma=1 --fix diffuse=1"),
            "command line: --fix: fixes every parameter; leave at least one to be fitted\n");
}

// A coating as a sum of order five is read back with its reflectance: one fiftieth, as good as the sum is.
TEST(CommandFitInvariant, ASumIsReadBack) {
  const Scratch scratch;
  const std::string coating =
      "--model glossy-coating --param n=1.5 --param reflectance=0.8 --param sigma=0.4 ";
  const Outcome fit =
      malusIn(scratch.path, "fit --basis 5 " + coating +
                                "--wavelength-nm 500 --wavelength-nm 600 --out sum.csv");
  ASSERT_EQ(fit.code, 0) << fit.err;
  EXPECT_EQ(fit.out, "");
  EXPECT_NE(fit.err.find("coefficients a wavelength: error "), std::string::npos) << fit.err;
  const auto dhr = [&](const std::string& model) {
    return tableOf(
               malusIn(scratch.path, "brdf " + model + " --dhr --theta-i-deg 30 --format csv")
                   .out)
        .number(0, "dhr");
  };
  EXPECT_NEAR(dhr("--model basis --param file=sum.csv") / dhr(coating), 1, 0.02);
  EXPECT_GT(std::abs(dhr("--model lambertian --param reflectance=0.7") / dhr(coating) - 1),
            0.02);  // negative control
  for (const std::string& bad :
       {std::string("--basis 5"), "--basis 5.5 " + coating, "--basis 13 " + coating,
        "--basis x " + coating, "--basis 5 --input plate.csv " + coating, coating,
        "--basis 5 --error 0.1 " + coating,
        std::string("--basis 5 --model lambertian --param reflectance=0"),
        "--basis 5 " + coating + "--wavelength-nm 500 --wavelength-nm 500",
        "--basis 5 " + coating + "--wavelength-nm 0"}) {
    const Outcome refused = malusIn(scratch.path, "fit " + bad);
    EXPECT_EQ(refused.code, 2) << bad;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_EQ(refused.out, "");
  }
  EXPECT_EQ(malusIn(scratch.path,
                    "brdf --model basis --param file=sum.csv --wavelength-nm 650 "
                    "--dhr --theta-i-deg 30")
                .code,
            2);
}
