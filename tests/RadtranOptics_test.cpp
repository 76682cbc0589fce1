// LibRadtran's optical properties (nw/files/RadtranOptics.nw) through the door for particles (nw/air/ParticleFiles.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "Program.hpp"
#include "malus/air/ParticleFiles.hpp"
#include "malus/base/Table.hpp"
#include "malus/files/NetCDF.hpp"

using namespace malus;

namespace {
const std::string waso = "scenes/data/waso.mie.cdf";

// Two wavelengths and two radii of particles that scatter like Rayleigh's (a file's element k has its own angles, `skew` apart),
// the first weighed by `ext`.
struct Made {
  std::vector<double> wavelength_um{0.4, 0.6}, radius_um{1, 3};
  std::vector<double> ext{200, 100, 50, 25}, ssa{1, 0.5, 1, 0.8};
  std::vector<std::int32_t> ntheta;
  std::vector<float> theta, phase;
  std::size_t elements, most = 721;

  explicit Made(std::size_t count = 6, bool skew = true) : elements(count) {
    for (std::size_t pair = 0; pair < 4; ++pair)
      for (std::size_t element = 0; element < elements; ++element) {
        const int steps = skew && element % 2 ? 720 : 360;
        ntheta.push_back(steps + 1);
        for (int i = 0; i < static_cast<int>(most); ++i) {
          const double angle = i <= steps ? 180.0 - 180.0 * i / steps : -999;
          theta.push_back(static_cast<float>(angle));
          phase.push_back(i <= steps ? static_cast<float>(function(pair, element, angle))
                                     : -999.f);
        }
      }
  }
  // P1 to P6 of molecules with a separate depolarisation, and an asymmetry that does not matter
  // for its mean
  static double function(std::size_t pair, std::size_t element, double angle) {
    const double c = std::cos(angle * std::acos(-1.0) / 180),
                 D = 1 - 0.1 * static_cast<double>(pair);
    const double p11 = 0.75 * D * (1 + c * c) + 1 - D, p22 = 0.75 * D * (1 + c * c);
    const double p12 = -0.75 * D * (1 - c * c), p33 = 1.5 * D * c;
    return std::array{p11, p12, p33, 0.0, p22, p33 * (1 - 0.6 * (1 - D) / D)}[element];
  }
  DataSet data() const {
    return {{{"nlam", wavelength_um.size()},
             {"nreff", radius_um.size()},
             {"nphamat", elements},
             {"nthetamax", most}},
            {{"wavelen", {"nlam"}, wavelength_um},
             {"reff", {"nreff"}, radius_um},
             {"ext", {"nlam", "nreff"}, ext},
             {"ssa", {"nlam", "nreff"}, ssa},
             {"ntheta", {"nlam", "nreff", "nphamat"}, ntheta},
             {"theta", {"nlam", "nreff", "nphamat", "nthetamax"}, theta},
             {"phase", {"nlam", "nreff", "nphamat", "nthetamax"}, phase}},
            {}};
  }
};

std::string complaint(const DataSet& data, std::optional<double> nm = 500,
                      std::optional<double> um = 2) {
  const Scratch scratch;
  saveNetCDF(data, scratch / "dust.cdf");
  try {
    ParticleFile(scratch / "dust.cdf").at(nm, um);
  } catch (const InputError& error) {
    const std::string whole = error.what();
    EXPECT_EQ(whole.find('\n'), whole.npos);
    return whole.substr(whole.find("dust.cdf"));
  }
  return "read";
}
}  // namespace

// The table was made of this file by hand and holds seven digits: half a unit of the last is at most 5e-7 of a number, and the
// mean, by which both are divided, is off by less than 1e-7.
TEST(RadtranOpticsPublished, TheBenchmarksFileIsTheCommittedTable) {
  const Aerosol file = ParticleFile(waso).at(350),
                table = ParticleFile("validation/printed/iprt-waso.csv").at(350);
  EXPECT_NEAR(file.albedo, table.albedo, 1e-8);
  double least = 0;
  for (double angle = 0; angle <= 180; angle += 0.5) {
    const double c = std::cos(angle * std::acos(-1.0) / 180);
    const ScatteringMatrix a = file.scatterer.matrix(c), b = table.scatterer.matrix(c);
    for (const auto element :
         {&ScatteringMatrix::a1, &ScatteringMatrix::a2, &ScatteringMatrix::a3,
          &ScatteringMatrix::a4, &ScatteringMatrix::b1, &ScatteringMatrix::b2})
      EXPECT_NEAR(a.*element, b.*element, 6e-7 * a.a1) << angle;
    least = std::min(least, a.b1 * b.b1 * 1e6), least = std::min(least, a.b2 * b.b2 * 1e6);
  }
  EXPECT_GE(least, -1e-6);  // signs agree
  const ScatteringMatrix side = file.scatterer.matrix(0);
  EXPECT_GT(std::abs(side.b1), 0.01);
  EXPECT_GT(std::abs(side.b2), 1e-3);  // and there is something to agree in
}

// Light in seven digits, for the same reason; V's sign would show.
TEST(RadtranOpticsPublished, TheSkyIsThatOfTheTable) {
  const auto light = [](const std::string& file) {
    const Outcome outcome = malusIn(
        ".", "sky --wavelength-nm 350 --tau 0 --mu0 0.766 --mu 0.6 --phi-deg 26 --aerosol " +
                 file + " --aerosol-tau 0.2");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream stream(outcome.out);
    const Table answer = Table::parse(stream, "answer");
    return std::array{answer.number(0, "I"), answer.number(0, "Q"), answer.number(0, "U"),
                      answer.number(0, "V")};
  };
  const auto file = light(waso), table = light("validation/printed/iprt-waso.csv");
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(file[k], table[k], 1e-6 * std::abs(table[k])) << k;
  EXPECT_GT(std::abs(table[3]), 1e-5);
}

// At a node of the file the numbers are the file's; between two, sums by hand.
TEST(RadtranOpticsIdentity, MixturesByHand) {
  const Made made;
  const Scratch scratch;
  saveNetCDF(made.data(), scratch / "dust.cdf");
  const ParticleFile file(scratch / "dust.cdf");
  for (std::size_t pair = 0; pair < 4; ++pair) {
    const Aerosol at = file.at(pair < 2 ? 400 : 600, pair % 2 ? 3 : 1);
    EXPECT_EQ(at.albedo, made.ssa[pair]);
    for (const double angle : {0.0, 30.0, 77.7, 120.0, 180.0}) {
      const ScatteringMatrix f = at.scatterer.matrix(std::cos(angle * std::acos(-1.0) / 180));
      const double tolerance = 1e-5;  // floats, and cosines between the file's angles
      EXPECT_NEAR(f.a1, Made::function(pair, 0, angle), tolerance);
      EXPECT_NEAR(f.b1, -Made::function(pair, 1, angle), tolerance);
      EXPECT_NEAR(f.a3, Made::function(pair, 2, angle), tolerance);
      EXPECT_NEAR(f.a2, Made::function(pair, 4, angle), tolerance);
      EXPECT_NEAR(f.a4, Made::function(pair, 5, angle), tolerance);
    }
  }
  // a quarter of the way from 400 to 600 nm, half-way from 1 to 3 um
  const double share[]{0.375, 0.375, 0.125, 0.125};
  double extinction = 0, scattering = 0, b1 = 0;
  for (std::size_t pair = 0; pair < 4; ++pair) {
    extinction += share[pair] * made.ext[pair];
    scattering += share[pair] * made.ext[pair] * made.ssa[pair];
    b1 -= share[pair] * made.ext[pair] * made.ssa[pair] * Made::function(pair, 1, 90);
  }
  const Aerosol at = file.at(450, 2);
  EXPECT_NEAR(at.albedo, scattering / extinction, 1e-12);
  EXPECT_NEAR(at.scatterer.matrix(0).b1, b1 / scattering, 1e-5);
  EXPECT_GT(std::abs(b1 / scattering - (0.75 - 0.75 * 0.15)),
            1e-2);  // plain mean of the matrices: control
}

TEST(RadtranOpticsIdentity, SpheresHaveFourElements) {
  const Scratch scratch;
  saveNetCDF(Made(4).data(), scratch / "dust.cdf");
  const ScatteringMatrix f =
      ParticleFile(scratch / "dust.cdf").at(400, 1).scatterer.matrix(0.3);
  EXPECT_EQ(f.a2, f.a1);
  EXPECT_EQ(f.a4, f.a3);
}

TEST(RadtranOpticsRefusals, WhatIsAskedOfTheFile) {
  const DataSet data = Made().data();
  EXPECT_EQ(
      complaint(data, std::nullopt),
      "dust.cdf: wavelength: holds 2 of them, 400 to 600 nm; choose one with wavelength_nm");
  EXPECT_EQ(complaint(data, 500, std::nullopt),
            "dust.cdf: effective radius: holds 2 of them, 1 to 3 um; choose one with "
            "aerosol_radius_um");
  EXPECT_EQ(complaint(data, 700),
            "dust.cdf: wavelength = 700 nm: is not covered: the file has 400 to 600 nm; give a "
            "file that reaches there; "
            "nothing is extrapolated");
  EXPECT_EQ(complaint(data, 600.9), "read");  // within a nanometre
  EXPECT_EQ(complaint(data, 500, 3.1),
            "dust.cdf: effective radius = 3.1 um: is not covered: the file has 1 to 3 um; give "
            "a file that reaches there; "
            "nothing is extrapolated");
}

TEST(RadtranOpticsRefusals, BrokenFiles) {
  const auto changed = [](const auto& change) {
    Made made;
    change(made);
    return complaint(made.data());
  };
  const auto without = [](const std::string& name) {
    DataSet data = Made().data();
    std::erase_if(data.variables, [&](const DataVariable& v) { return v.name == name; });
    return complaint(data);
  };
  for (const char* name : {"wavelen", "reff", "ext", "ssa", "ntheta", "theta", "phase"})
    EXPECT_EQ(without(name), std::string("dust.cdf: ") + name +
                                 ": is missing; give optical properties as libRadtran's mie "
                                 "writes them (wavelen, reff, "
                                 "ext, ssa, ntheta, theta, phase)");
  EXPECT_EQ(complaint(Made(1).data()),
            "dust.cdf: phase: has 1 elements of the matrix; give 4 (of spheres) or 6 (of other "
            "particles), with nstokes 4 "
            "in mie");
  EXPECT_EQ(changed([](Made& m) { m.wavelength_um[1] = 0.3; }),
            "dust.cdf: wavelen = 0.3: is number 2 and does not ascend; order them, each once, "
            "in micrometres");
  EXPECT_EQ(changed([](Made& m) { m.radius_um[0] = NAN; }).substr(0, 30),
            "dust.cdf: reff = nan: is numbe");
  EXPECT_EQ(
      changed([](Made& m) { m.ssa[2] = 1.2; }),
      "dust.cdf: ext, ssa = 50, 1.2: are not an extinction and an albedo (number 3); give an "
      "extinction above 0 and an "
      "albedo of 0 to 1");
  EXPECT_EQ(changed([](Made& m) { m.ntheta[0] = 2000; }),
            "dust.cdf: ntheta = 2000: is not a number of angles (wavelength 0.4 um, element "
            "1); "
            "give the functions from 0 to "
            "180 degrees, each angle once");
  EXPECT_EQ(changed([](Made& m) { m.ntheta[0] = -1; }).substr(0, 30),
            "dust.cdf: ntheta = -1: is not ");
  EXPECT_EQ(changed([](Made& m) { m.theta[3] = 190; }).substr(0, 42),
            "dust.cdf: theta = 190: is not an angle (wa");
  EXPECT_EQ(changed([](Made& m) { m.theta[3] = m.theta[4]; }).substr(0, 39),
            "dust.cdf: theta = 178: comes twice (wav");
  EXPECT_EQ(changed([](Made& m) { m.theta[0] = 179.9f; }).substr(0, 38),
            "dust.cdf: theta = 179.9: is an end tha");
  EXPECT_EQ(changed([](Made& m) { m.phase[7] = NAN; }).substr(0, 38),
            "dust.cdf: phase = nan: is not a number");
  EXPECT_EQ(changed([](Made& m) {
              for (float& p : m.phase) p *= 2;
            }),
            "dust.cdf: phase: scatterer: the mean of a1 is 2; it must be 1; give functions of "
            "the angle whose mean over "
            "all directions is 1");
  EXPECT_EQ(changed([](Made& m) { m.phase[100] = -5; }).substr(0, 35),
            "dust.cdf: phase: scatterer: at 130.");
}

// Two questions that differ in the radius or the wavelength alone are two skies.
TEST(RadtranOpticsIdentity, EachQuestionHasItsParticles) {
  const Scratch scratch;
  Made made;
  made.ssa = {1, 1, 1, 1};
  saveNetCDF(made.data(), scratch / "dust.cdf");
  put(scratch / "q.csv", "wavelength_nm,aerosol_radius_um\n400,1\n400,3\n600,3\n400,1\n");
  const Outcome outcome = malusIn(scratch.path,
                                  "sky --input q.csv --tau 0 --mu0 0.5 --mu 0.5 --phi-deg 40 "
                                  "--aerosol dust.cdf --aerosol-tau 0.3");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream stream(outcome.out);
  const Table answer = Table::parse(stream, "answer");
  EXPECT_NE(answer.number(0, "Q"), answer.number(1, "Q"));
  EXPECT_NE(answer.number(1, "Q"), answer.number(2, "Q"));
  EXPECT_EQ(answer.number(0, "Q"), answer.number(3, "Q"));
}

// A classic file that was cut short, or whose header states more than there is; a radius beside
// a table of ours.
TEST(RadtranOpticsRefusals, FilesThatLie) {
  const std::string whole = contents(waso);
  const Scratch scratch;
  const auto asked = [&](const std::string& bytes) {
    put(scratch / "lies.cdf", bytes);
    return malusIn(
        scratch.path,
        "sky --wavelength-nm 350 --mu0 0.5 --mu 0.5 --aerosol lies.cdf --aerosol-tau 0.1");
  };
  EXPECT_EQ(asked(whole).code, 0);
  for (const std::size_t size : {3ul, 4ul, 20ul, 400ul, 1500ul, whole.size() - 500}) {
    const Outcome outcome = asked(whole.substr(0, size));
    EXPECT_EQ(outcome.code, 2) << size;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.substr(0, 8), "lies.cdf") << outcome.err;
  }
  std::string larger = whole;  // nthetamax 100 -> 0x7fffffff
  const std::size_t at = larger.find("nthetamax") + 12;
  ASSERT_EQ(static_cast<unsigned char>(larger[at + 3]), 100);
  larger.replace(at, 4, "\x7f\xff\xff\xff");
  const Outcome outcome = asked(larger);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("lies.cdf: cannot be read as netCDF: "), std::string::npos)
      << outcome.err;
  try {
    ParticleFile("validation/printed/iprt-waso.csv").at(350, 2);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("2 um: selects nothing"), std::string::npos)
        << error.what();
  }
}
