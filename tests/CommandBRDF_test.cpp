// malus brdf from outside (nw/app/CommandBRDF.nw, ModelRegistry.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Program.hpp"
#include "malus/base/Table.hpp"
#include "malus/surface/BRDFNEFDS.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

namespace {
const std::string copper =
    "brdf --model torrance-sparrow --param n=0.405 --param k=2.950 --param sigma=0.2 ";
const std::string plate = copper + "--theta-i-deg 30 --theta-r-deg 40 --phi-deg 180 ";

/// The names in the order of the list, as messages give them.
std::string knownModels() {
  std::string names;
  for (const ModelEntry& entry : modelEntries())
    names += (names.empty() ? "" : ", ") + entry.name;
  return names;
}

Table table(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "answer");
}

Table answer(const Scratch& scratch, const std::string& arguments) {
  const Outcome outcome = malusIn(scratch.path, arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return table(outcome.out);
}

/// Random geometries with their own parameters; the numbers need all their digits.
std::string someGeometries(bool with_parameters) {
  std::string text = with_parameters ? "label,theta_i_deg,n,theta_r_deg,phi_deg,k,sigma\n"
                                     : "theta_i_deg,theta_r_deg,phi_deg\n";
  std::uint64_t state = 1;
  const auto uniform = [&] {  // Knuth's MMIX generator: any spread of numbers will do
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (int row = 0; row < 200; ++row) {
    const double i = 90 * uniform(), r = 90 * uniform(), phi = 720 * uniform() - 360;
    const double n = 0.1 + 2 * uniform(), k = 4 * uniform(), sigma = 0.05 + 0.4 * uniform();
    if (with_parameters)
      text += fmt::format("\"a, {}\",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", row, i,
                          n, r, phi, k, sigma);
    else
      text += fmt::format("{:.17g},{:.17g},{:.17g}\n", i, r, phi);
  }
  return text;
}

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
}  // namespace

// Finding 1 of the inventory gives the specular part to the digits below; the diffuse term of finding 3 is
// .0085. Tolerance: half a unit of their last digit.
TEST(CommandBRDFPublished, TheCopperPlateOfSection71) {
  const Scratch scratch;
  const Table with = answer(scratch, plate + "--format csv");
  const Table without = answer(scratch, plate + "--format csv --param diffuse=none");
  const auto f = [](const Table& t, const char* element) { return t.number(0, element); };
  EXPECT_NEAR(f(without, "f00"), 1.17187, 5e-6);
  EXPECT_NEAR(f(without, "f11"), 1.17187, 5e-6);
  EXPECT_NEAR(f(without, "f01"), 0.040058, 5e-7);
  EXPECT_NEAR(f(without, "f10"), 0.040058, 5e-7);
  EXPECT_NEAR(f(without, "f22"), -1.131418, 5e-7);
  EXPECT_NEAR(f(without, "f33"), -1.131418, 5e-7);
  EXPECT_NEAR(f(without, "f23"), 0.302611, 5e-7);
  EXPECT_NEAR(f(without, "f32"), -0.302611, 5e-7);
  EXPECT_NEAR(f(with, "f00") - f(without, "f00"), 0.0085, 5e-5);
  EXPECT_EQ(f(with, "f11"), f(without, "f11"));
}

TEST(CommandBRDFPublished, NegativeControlOneDegreeMoreMissesThem) {
  const Scratch scratch;
  const Table off = answer(
      scratch,
      copper +
          "--theta-i-deg 31 --theta-r-deg 40 --phi-deg 180 --format csv --param diffuse=none");
  EXPECT_GT(std::abs(off.number(0, "f00") - 1.17187), 5e-6);
}

TEST(CommandBRDFIdentity, TextShowsTheMatrixAndWhatUnpolarisedLightBecomes) {
  const Scratch scratch;
  const Outcome outcome = malusIn(scratch.path, plate);
  EXPECT_EQ(outcome.code, 0);
  for (const char* words :
       {"torrance-sparrow at 550 nm",
        "n = 0.405, k = 2.950, sigma = 0.2, shadowing = v-groove, diffuse = thesis",
        "theta_r_deg = 40", "Mueller BRDF [1/sr]", "1.1803", "0.04005", "-1.13141", "0.30261",
        "unpolarised light: DoP 0.0339"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
  EXPECT_EQ(outcome.out.find("-0 "), std::string::npos) << outcome.out;
}

TEST(CommandBRDFInvariant, CsvAndJsonAndTheLibraryGiveTheSameBits) {
  const Scratch scratch;
  const Table csv = answer(scratch, plate + "--format csv");
  const auto json = nlohmann::json::parse(malusIn(scratch.path, plate + "--format json").out);
  const auto& matrix = json["geometries"][0]["mueller_per_sr"];
  const CDMuellerMatrix f =
      BRDFTorranceSparrow(0.405, 2.950, 0.2).at(BRDFGeometry::fromDegrees(30, 40, 180));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double ours = csv.number(0, fmt::format("f{}{}", i, j));
      EXPECT_TRUE(sameBits(ours, f.getMueller(i, j)));
      EXPECT_TRUE(sameBits(ours, matrix[i][j].get<double>()));
    }
  EXPECT_EQ(json["parameters"]["k"], 2.95);
  EXPECT_EQ(json["parameters"]["shadowing"], "v-groove");
  EXPECT_EQ(json["parameters"]["diffuse"], "thesis");
  EXPECT_EQ(json["geometries"][0]["theta_r_deg"], 40);
}

TEST(CommandBRDFInvariant, AFileComesBackWithTheSameColumnsAndItsAnswers) {
  const Scratch scratch;
  const std::string question = someGeometries(true);
  put(scratch / "q.csv", question);
  EXPECT_EQ(
      malusIn(scratch.path, "brdf --model torrance-sparrow --input q.csv --out a.csv").code, 0);
  const Table asked = table(question), answered = Table::read(scratch / "a.csv");
  ASSERT_EQ(answered.rows(), asked.rows());
  ASSERT_EQ(answered.columns().size(), asked.columns().size() + 16);
  for (const std::string& column : asked.columns())
    EXPECT_EQ(answered.text(column), asked.text(column)) << column;
  for (std::size_t row = 0; row < asked.rows(); row += 37) {
    const BRDFTorranceSparrow model(asked.number(row, "n"), asked.number(row, "k"),
                                    asked.number(row, "sigma"));
    const CDMuellerMatrix f = model.at(BRDFGeometry::fromDegrees(
        asked.number(row, "theta_i_deg"), asked.number(row, "theta_r_deg"),
        asked.number(row, "phi_deg")));
    for (int k = 0; k < 16; ++k)
      EXPECT_TRUE(sameBits(answered.number(row, fmt::format("f{}{}", k / 4, k % 4)),
                           f.getMueller(k / 4, k % 4)));
  }
}

TEST(CommandBRDFInvariant, StandardOutputIsTheFileThatOutWrites) {
  const Scratch scratch;
  put(scratch / "q.csv", someGeometries(false));
  const Outcome outcome = malusIn(scratch.path, copper + "--input q.csv");
  EXPECT_EQ(malusIn(scratch.path, copper + "--input q.csv --out a.csv").code, 0);
  EXPECT_EQ(contents(scratch / "a.csv"), outcome.out);
}

TEST(CommandBRDFIdentity, LambertIsReflectanceOverPi) {
  const Scratch scratch;
  const Table f =
      answer(scratch,
             "brdf --model lambertian --param reflectance=0.5 --param polarization_kept=0.25 "
             "--theta-i-deg 10 --theta-r-deg 20 --phi-deg 0 --format csv");
  EXPECT_DOUBLE_EQ(f.number(0, "f00"), 0.5 / M_PI);
  EXPECT_DOUBLE_EQ(f.number(0, "f33"), 0.125 / M_PI);
  EXPECT_EQ(f.number(0, "f01"), 0);
  const Table dhr = answer(
      scratch,
      "brdf --model lambertian --param reflectance=0.5 --dhr --theta-i-deg 60 --format csv");
  EXPECT_NEAR(dhr.number(0, "dhr"), 0.5, 1e-12);  // rounding of pi * (1/pi)
}

// The mean of f00 cos(theta_r) / density over all draws is the DHR. Tolerance: five standard errors of the mean,
// which a correct sampler exceeds in fewer than one of a million seeds; the seed is fixed.
TEST(CommandBRDFInvariant, SamplesGiveTheDHRAndDependOnTheSeed) {
  const Scratch scratch;
  const std::string model =
      "brdf --model torrance-sparrow --param n=1.5 --param k=1 --param sigma=0.3 --theta-i-deg "
      "50 ";
  const Table samples = answer(scratch, model + "--sample 20000 --seed 7");
  const double draws = std::stod(samples.header("draws"));
  EXPECT_EQ(static_cast<double>(samples.rows()) + std::stod(samples.header("rejected")), draws);
  double sum = 0, squares = 0;
  for (std::size_t row = 0; row < samples.rows(); ++row) {
    const double weight = samples.number(row, "f00_per_sr") *
                          std::cos(samples.number(row, "theta_r_deg") * M_PI / 180) /
                          samples.number(row, "density_per_sr");
    sum += weight;
    squares += weight * weight;
  }
  const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
  EXPECT_NEAR(mean, answer(scratch, model + "--dhr --format csv").number(0, "dhr"), 5 * error);
  EXPECT_GT(error, 0);
  const auto out = [&](const std::string& seed) {
    return malusIn(scratch.path, model + "--sample 5 --seed " + seed).out;
  };
  EXPECT_EQ(out("7"), out("7"));
  EXPECT_NE(out("7"), out("8"));
}

TEST(CommandBRDFIdentity, ModelsCanBeListedAndDescribed) {
  const Scratch scratch;
  const std::string list = malusIn(scratch.path, "brdf --list").out;
  ASSERT_GT(modelEntries().size(), 5u);
  for (const ModelEntry& model : modelEntries()) {
    EXPECT_NE(list.find(model.name), std::string::npos);
    EXPECT_EQ(malusIn(scratch.path, "brdf --describe " + model.name).code, 0);
  }
  EXPECT_NE(malusIn(scratch.path, "brdf --describe torrance-sparrow")
                .out.find("sigma        roughness, standard deviation of the facet slopes "
                          "[rad]: 1e-06 to 10"),
            std::string::npos);
  // a property that holds with some settings is listed with these settings and a small letter
  EXPECT_NE(list.find("torrance-sparrow   P-re"), std::string::npos) << list;
  EXPECT_NE(list.find("lambertian         --RE"), std::string::npos) << list;
  const std::string described = malusIn(scratch.path, "brdf --describe torrance-sparrow").out;
  EXPECT_NE(described.find("reciprocal: with diffuse=none or diffuse=reciprocal; never returns "
                           "more than it receives: with diffuse=none shadowing=v-groove or "),
            std::string::npos)
      << described;
}

// At the horizon the result is the limit: the neighbours' shadow shrinks as the projected area
// does.
// Tolerance: at 1e-7 degrees from the limit the BRDF differs by its slope (some units per radian) times 1.7e-9.
TEST(CommandBRDFIdentity, TheHorizonIsTheLimit) {
  const Scratch scratch;
  const auto f00 = [&](const std::string& theta_r) {
    return answer(scratch, copper + "--theta-i-deg 30 --theta-r-deg " + theta_r +
                               " --phi-deg 180 --format csv")
        .number(0, "f00");
  };
  EXPECT_GT(f00("90"), 0.05);
  EXPECT_NEAR(f00("90"), f00("89.9999999"), 1e-7);
  EXPECT_GT(std::abs(f00("90") - f00("89")), 1e-4);  // negative control
}

// A parameter in a column is the parameter of a flag, to the last bit, in whatever order the rows come; words too.
TEST(CommandBRDFInvariant, AColumnIsAFlag) {
  const Scratch scratch;
  const std::string sigmas[] = {"0.2", "0.31", "0.2", "0.7", "0.0021"},
                    words[] = {"smith", "v-groove", "none", "v-groove", "smith"};
  std::string question = "theta_i_deg,theta_r_deg,phi_deg,sigma,shadowing\n";
  for (int i = 0; i < 5; ++i) question += "70,60,175," + sigmas[i] + "," + words[i] + "\n";
  put(scratch / "q.csv", question);
  const std::string copper_only =
      "brdf --model torrance-sparrow --param n=0.405 --param k=2.950 ";
  const Table column = answer(scratch, copper_only + "--input q.csv");
  for (int i = 0; i < 5; ++i) {
    const Table flag = answer(
        scratch,
        copper_only +
            "--theta-i-deg 70 --theta-r-deg 60 --phi-deg 175 --format csv --param sigma=" +
            sigmas[i] + " --param shadowing=" + words[i]);
    EXPECT_TRUE(sameBits(column.number(i, "f00"), flag.number(0, "f00"))) << i;
    EXPECT_TRUE(sameBits(column.number(i, "f23"), flag.number(0, "f23"))) << i;
  }
  EXPECT_NE(column.number(0, "f00"), column.number(1, "f00"));
}

// A file made for BRDFs serves for --dhr too: its other angles pass through.
TEST(CommandBRDFIdentity, ReflectancesTakeTheSameFile) {
  const Scratch scratch;
  put(scratch / "q.csv", "theta_i_deg,theta_r_deg,phi_deg\n30,40,180\n0,40,180\n");
  const Table file = answer(scratch, copper + "--dhr --input q.csv");
  EXPECT_EQ(file.text("theta_r_deg"), (std::vector<std::string>{"40", "40"}));
  EXPECT_EQ(file.number(0, "dhr"),
            answer(scratch, copper + "--dhr --theta-i-deg 30 --format csv").number(0, "dhr"));
  EXPECT_NE(file.number(0, "dhr"), file.number(1, "dhr"));
}

// Without shadowing the BRDF has no bound at the horizon (chapter BRDFTorranceSparrow); a table cannot hold that.
// A file is a parameter: by flag, from a column, and the model is that of its class (nw/surface/BRDFNEFDS.nw).
TEST(CommandBRDFIdentity, AMaterialOfTheNEFComesFromItsTable) {
  const Scratch scratch;
  put(scratch / "nef.csv",
      "wavelength_nm,n,k,bias,sigma,rho_d\n500,1.5,0,0.03,0.2,0.05\n600,1.49,0,0.04,0.3,0."
      "07\n");
  const auto lasers = SpectralGrid::make({500.0, 600.0});
  const auto two = [&](double a, double b) {
    return CDSpectralVector<double>(lasers, std::vector<double>{a, b});
  };
  const BRDFNEFDS model({two(1.5, 1.49), two(0, 0), two(0.03, 0.04), two(0.2, 0.3),
                         two(0.05, 0.07), two(0, 0), 15, 40},
                        {SpectralGrid::make({550.0}), 0.4}, 20 * std::numbers::pi / 180);
  const CDMuellerMatrix f = model.getBRDF(BRDFGeometry::fromDegrees(30, 40, 170))[0];
  const std::string nefds = "brdf --model nefds --param dhr=0.4 --param dhr_zenith_deg=20 ";
  put(scratch / "q.csv", "file,theta_i_deg,theta_r_deg,phi_deg\nnef.csv,30,40,170\n");
  const std::string file = "--param file=nef.csv ";
  for (const std::string& way :
       {file + "--theta-i-deg 30 --theta-r-deg 40 --phi-deg 170 --format csv",
        std::string("--input q.csv")}) {
    const Table table = answer(scratch, nefds + way);
    for (int k = 0; k < 16; ++k)
      EXPECT_TRUE(sameBits(table.number(0, fmt::format("f{}{}", k / 4, k % 4)), f.data()[k]));
  }
  const auto error = [&](const std::string& arguments) {
    const Outcome outcome = malusIn(scratch.path, arguments + "--dhr --theta-i-deg 20");
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  const std::string remedy =
      "give a CSV table of wavelength_nm, n, k, bias, sigma and, optionally, rho_d, rho_v (the "
      "name of a file)\n";
  EXPECT_EQ(error(nefds + "--param file=nf.csv "),
            "command line: --param file = nf.csv: does not exist; " + remedy);
  EXPECT_EQ(error(nefds + "--param file=. "),
            "command line: --param file = .: is a directory; " + remedy);
  EXPECT_EQ(error(nefds), "command line: --param file: is missing for nefds; " + remedy);
  EXPECT_EQ(
      error(nefds + file + "--wavelength-nm 610 "),
      "nef.csv: n: does not cover the band at 610 nm; it covers 500 to 600 nm, and nothing "
      "is extrapolated; give a wider spectrum or leave out the band\n");
  put(scratch / "nef.csv", "wavelength_nm,n,k,bias,sigma,rhod\n500,1.5,0,1,1,1\n");
  EXPECT_EQ(error(nefds + file),
            "nef.csv: rhod: is not a column of this kind of table; did you mean rho_d? choose "
            "from: "
            "wavelength_nm, n, k, bias, sigma, rho_d, rho_v\n");
  put(scratch / "nef.csv", "wavelength_nm,n,k,bias,sigma\n500,1.5,0,1,1\n600,1.5,-1,1,1\n");
  EXPECT_EQ(
      error(nefds + file),
      "nef.csv:3: k = -1 at 600 nm: is beyond its limits; give a value from 0 to 1000000\n");
}

// A model goes into a table of each layout and comes back as a measured surface, near to what it was.
TEST(CommandBRDFInvariant, AModelThroughATable) {
  const Scratch scratch;
  const std::string glass =
      "brdf --model torrance-sparrow --param n=1.5 --param k=0 --param sigma=0.3 --param "
      "shadowing=smith --param diffuse=none ";  // reciprocal, as MERL's layout takes for granted
  const std::string geometry = "--theta-i-deg 30 --theta-r-deg 44 --phi-deg 170 --format csv";
  const Table truth = answer(scratch, glass + geometry);
  for (const auto& [file, model] :
       {std::pair{"t.csv", "measured"}, {"t.pbsdf", "measured"}, {"t.binary", "merl"}}) {
    const Outcome written = malusIn(scratch.path, glass + "--steps 20 --table " + file);
    EXPECT_EQ(written.code, 0) << written.err;
    const bool merl = std::string(model) == "merl";
    const Outcome outcome = malusIn(
        scratch.path,
        fmt::format("brdf --model {} --param file={} {} {}", model, file,
                    merl ? "--param blue_nm=500 --param green_nm=550 --param red_nm=600" : "",
                    geometry));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(fmt::format("{}: ", file)), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(" not realisable; reflects up to 0."), std::string::npos)
        << outcome.err;
    const Table back = table(outcome.out);
    const double f00 = truth.number(0, "f00");
    for (int k = 0; k < (merl ? 1 : 16); ++k) {
      const std::string element = fmt::format("f{}{}", k / 4, k % 4);
      EXPECT_NEAR(back.number(0, element), truth.number(0, element), 0.02 * f00) << element;
    }
    EXPECT_NE(back.number(0, "f00"), f00);  // negative control: it has been interpolated
  }
  const auto error = [&](const std::string& arguments) {
    const Outcome outcome = malusIn(scratch.path, arguments);
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  EXPECT_EQ(error("brdf --model measured --param file=t.csv --wavelength-nm 551 " + geometry),
            "t.csv: the table: does not cover the band at 551 nm; it covers 550 to 550 nm, and "
            "nothing is extrapolated; give a wider spectrum or leave out the band\n");
  EXPECT_EQ(error(glass + "--table t.dat"),
            "command line: --table = t.dat: has an unknown ending; choose "
            ".csv, .pbsdf (KAIST) or .binary (MERL)\n");
  EXPECT_EQ(
      error(glass + "--table t.csv --steps 181"),
      "command line: --steps = 181: is not a whole number from 1 to 180; give e.g. 180\n");
  EXPECT_EQ(error(glass + "--table t.csv --dhr"),
            "command line: --table: excludes angles, --input, --dhr, --emissivity, --sample, "
            "--format and --out; choose one of them\n");
  for (const std::string other :
       {"--emissivity", "--format csv", "--theta-i-deg 30", "--out a.csv"})
    EXPECT_EQ(malusIn(scratch.path, glass + "--table u.csv " + other).code, 2) << other;
  EXPECT_FALSE(std::filesystem::exists(scratch / "u.csv"));
  EXPECT_EQ(
      error("brdf --model merl --param file=t.csv --param blue_nm=500 --param green_nm=550 "
            "--param red_nm=600 " +
            geometry),
      "t.csv: does not begin with the sizes of a MERL file; give a complete file of measured "
      "reflection\n");
}

TEST(CommandBRDFIdentity, WithoutShadowingTheHorizonIsRefused) {
  const Scratch scratch;
  const Outcome outcome = malusIn(
      scratch.path,
      copper +
          "--param shadowing=none --theta-i-deg 30 --theta-r-deg 90 --phi-deg 180 --out a.csv");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "command line: --theta-r-deg = 90 deg: has no finite BRDF here; stay below 90, or "
            "choose a shadowing other than none\n");
  EXPECT_EQ(filesBelow(scratch.path), 0u);
}

// A name below something that is not a directory cannot be written, not even by root.
TEST(CommandBRDFIdentity, WhatCannotBeWrittenIsSaidSo) {
  const Scratch scratch;
  put(scratch / "file", "precious\n");
  const Outcome below = malusIn(scratch.path, plate + "--out file/a.csv");
  EXPECT_EQ(below.code, 2);
  EXPECT_EQ(below.err,
            "file/a.csv: cannot be written; choose a file in a writable directory with free "
            "space\n");
  std::filesystem::create_directory(scratch / "directory");
  const Outcome directory = malusIn(scratch.path, plate + "--out directory");
  EXPECT_EQ(directory.code, 2);
  EXPECT_EQ(directory.err,
            "directory: cannot be written; choose a file in a writable directory with free "
            "space\n");
  EXPECT_EQ(contents(scratch / "file"), "precious\n");
  EXPECT_EQ(filesBelow(scratch.path), 1u);
}

// Where, what, and what would be right; exit code 2; one line; no file.
TEST(CommandBRDFIdentity, BadInputIsOneLineAndLeavesNothing) {
  const std::string flags = "brdf --model torrance-sparrow --param n=0.405 --param k=2.950 ";
  const std::string angles = " --theta-i-deg 30 --theta-r-deg 40 --phi-deg 180 --out a.csv";
  const std::pair<std::string, std::string> cases[] = {
      {flags + "--param sigma=-1" + angles,
       "command line: --param sigma = -1 rad: must be 1e-06 to 10; give roughness, standard "
       "deviation of the facet slopes (1e-06 to 10)"},
      {flags + "--param sigma=0" + angles,
       "command line: --param sigma = 0 rad: must be 1e-06 to 10; give roughness, standard "
       "deviation of the facet slopes (1e-06 to 10)"},
      {flags + "--param sigma=1e200" + angles,
       "command line: --param sigma = 1e200 rad: must be 1e-06 to 10; give roughness, standard "
       "deviation of the facet slopes "
       "(1e-06 to 10)"},
      {"brdf --model torrance-sparrow --param n=0 --param k=1 --param sigma=0.2" + angles,
       "command line: --param n = 0: must be above 0, up to 1e+06; give real part of the index "
       "of refraction n + ik (above 0, up to 1e+06)"},
      {"brdf --model torrance-sparrow --param n=1 --param k=-2 --param sigma=0.2" + angles,
       "command line: --param k = -2: must be 0 to 1e+06; give imaginary part of the index, 0 "
       "for a dielectric (0 to 1e+06)"},
      {copper + "--theta-i-deg 30 --sample -5",
       "command line: --sample = -5: is not a whole number from 1 to 4294967295; give e.g. "
       "1000"},
      {copper + "--theta-i-deg 30 --sample 5 --seed x",
       "command line: --seed = x: is not a whole number from 0 to 4294967295; give e.g. 1000"},
      {plate + "--out ''",
       "command line: --out: must name a file; malus brdf --help shows the options"},
      {flags + "--param sigma=nan" + angles,
       "command line: --param sigma = nan: is not a finite number; write a number such as 0.2"},
      {flags + "--param sigma=0,2" + angles,
       "command line: --param sigma = 0,2: is not a number; write a number such as 0.2 or "
       "1.5e-3"},
      {flags + "--param sgima=0.2" + angles,
       "command line: --param sgima = 0.2: is not a parameter of torrance-sparrow; did you "
       "mean "
       "sigma? choose from: n, k, sigma, "
       "shadowing, diffuse"},
      {flags + angles,
       "command line: --param sigma: is missing for torrance-sparrow; give roughness, standard "
       "deviation of the facet slopes "
       "(1e-06 to 10)"},
      {flags + "--param sigma" + angles,
       "command line: --param = sigma: has no name and value; write --param sigma=0.2"},
      {flags + "--param n=1 --param sigma=0.2" + angles,
       "command line: --param n = 1: is given twice; give it once"},
      {flags + "--param sigma=0.2 --param shadowing=vgroove" + angles,
       "command line: --param shadowing = vgroove: is not one of the words allowed here; did "
       "you "
       "mean v-groove? choose from: none, "
       "v-groove, smith, smith-correlated"},
      {flags + "--param sigma=0.2 --wavelength-nm -5" + angles,
       "command line: --wavelength-nm = -5 nm: must be above 0; give e.g. 550"},
      {"brdf --model torence-sparrow" + angles,
       "command line: --model = torence-sparrow: is not a model of malus; did you mean "
       "torrance-sparrow? choose from: " +
           knownModels()},
      {"brdf" + angles,
       "command line: --model: is missing; malus brdf --list shows the models"},
      {copper + "--theta-i-deg 90.5 --theta-r-deg 40 --phi-deg 180 --out a.csv",
       "command line: --theta-i-deg = 90.5 deg: must be 0 to 90; give the angle from the "
       "surface "
       "normal, in degrees"},
      {copper + "--theta-i-deg -1 --theta-r-deg 40 --phi-deg 180 --out a.csv",
       "command line: --theta-i-deg = -1 deg: must be 0 to 90; give the angle from the surface "
       "normal, in degrees"},
      {copper + "--theta-i-deg 30 --theta-r-deg inf --phi-deg 180 --out a.csv",
       "command line: --theta-r-deg = inf: is not a finite number; write a number such as 0.2"},
      {copper + "--theta-i-deg 30 --phi-deg 180 --out a.csv",
       "command line: --theta-r-deg: is missing; give an angle in degrees, or a file with "
       "--input"},
      {copper + "--theta-i-deg 90 --dhr --out a.csv",
       "command line: --theta-i-deg = 90 deg: must be 0 to 90, without 90; give the angle from "
       "the "
       "surface normal, in degrees"},
      {copper + "--theta-i-deg 30 --phi-deg 180 --dhr --out a.csv",
       "command line: --phi-deg: has no meaning here; give only --theta-i-deg"},
      {copper + "--theta-r-deg 30 --theta-i-deg 20 --emissivity --out a.csv",
       "command line: --theta-i-deg: has no meaning here; give only --theta-r-deg"},
      {plate + "--seed 2 --out a.csv",
       "command line: --seed: belongs to --sample; leave it out"},
      {plate + "--steps 2 --out a.csv",
       "command line: --steps: belongs to --table; leave it out"},
      {copper + "--input none.csv --out a.csv",
       "none.csv: does not exist; give the name of a readable CSV file"},
      {copper + "--input q.csv --theta-i-deg 30 --out a.csv",
       "command line: --input: excludes --theta-i-deg, --theta-r-deg and --phi-deg; give a "
       "file or "
       "angles"},
      {plate + "--format xml",
       "command line: --format: xml not in {text,csv,json}; malus brdf --help shows the "
       "options"},
  };
  const Scratch scratch;
  for (const auto& [arguments, line] : cases) {
    const Outcome outcome = malusIn(scratch.path, arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.err, line + "\n") << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
  }
  EXPECT_EQ(filesBelow(scratch.path), 0u);
}

TEST(CommandBRDFIdentity, ABadFileIsOneLineAndLeavesNothing) {
  const std::pair<std::string, std::string> cases[] = {
      {"theta_i_deg,phi_deg\n30,180\n",
       "q.csv:1: theta_r_deg: is not among the columns; did you mean theta_i_deg? choose from: "
       "theta_i_deg, phi_deg"},
      {"theta_i_deg,theta_r_deg,phi_deg\n30,40,180\n30,4o,180\n",
       "q.csv:3: theta_r_deg = 4o: is not a number; write a number such as 0.2 or 1.5e-3"},
      {"theta_i_deg,theta_r_deg,phi_deg\n30,95,180\n",
       "q.csv:2: theta_r_deg = 95 deg: must be 0 to 90; give the angle from the surface "
       "normal, in degrees"},
      {"theta_i_deg,theta_r_deg,phi_deg\n30,nan,180\n",
       "q.csv:2: theta_r_deg = nan: is not a finite number; write a number such as 0.2"},
      {"theta_i_deg,theta_r_deg,phi_deg,sigma\n30,40,180,0.2\n",
       "q.csv:1: sigma: is given by --param as well; give it once, as an option or as a "
       "column"},
      {"theta_i_deg,theta_r_deg,phi_deg,shadwing\n30,40,180,smith\n",
       "q.csv:1: shadwing: is similar to a column name of malus; did you mean shadowing? "
       "choose from: theta_i_deg, theta_r_deg, "
       "phi_deg, n, k, sigma, shadowing, diffuse"},
      {"theta_i_deg,theta_r_deg,phi_deg,f00\n30,40,180,1\n",
       "q.csv:1: f00: is a column of the output; leave it out of the input"},
      {"theta_i_deg,theta_r_deg,phi_deg\n30,40\n",
       "q.csv:2: 2 cells: but line 1 names 3 columns; give one cell for each column"},
      {"theta_i_deg,theta_r_deg,phi_deg\n",
       "q.csv: has no row of angles; write a line of angles below the column names"},
      {"",
       "q.csv: has no line of column names; begin with a line such as "
       "theta_i_deg,theta_r_deg,phi_deg"},
  };
  const Scratch scratch;
  for (const auto& [question, line] : cases) {
    put(scratch / "q.csv", question);
    const Outcome outcome = malusIn(scratch.path, copper + "--input q.csv --out a.csv");
    EXPECT_EQ(outcome.code, 2) << question;
    EXPECT_EQ(outcome.err, line + "\n") << question;
    EXPECT_EQ(filesBelow(scratch.path), 1u) << question;
  }
}

// A parameter that is wrong in one row is named with that row, and nothing is written.
TEST(CommandBRDFIdentity, AParameterInATableIsCheckedWithItsLine) {
  const Scratch scratch;
  put(scratch / "q.csv",
      "theta_i_deg,theta_r_deg,phi_deg,sigma\n30,40,180,0.2\n30,40,180,-1\n");
  const Outcome outcome = malusIn(scratch.path,
                                  "brdf --model torrance-sparrow --param n=0.405 --param "
                                  "k=2.950 --input q.csv --out a.csv");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "q.csv:3: sigma = -1 rad: must be 1e-06 to 10; give roughness, standard deviation "
            "of the facet slopes (1e-06 to 10)\n");
  EXPECT_EQ(filesBelow(scratch.path), 1u);
}

TEST(CommandBRDFInvariant, AnOldFileSurvivesAFailedRun) {
  const Scratch scratch;
  put(scratch / "a.csv", "precious\n");
  malusIn(scratch.path,
          copper + "--theta-i-deg 30 --theta-r-deg 400 --phi-deg 180 --out a.csv");
  EXPECT_EQ(contents(scratch / "a.csv"), "precious\n");
}
