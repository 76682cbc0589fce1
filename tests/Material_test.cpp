// Spectra and optical constants at their doors (nw/light/MeasuredSpectrum.nw,
// nw/files/OpticalConstants.nw).
#include "malus/scene/Material.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/OpticalConstants.hpp"
#include "malus/light/MeasuredSpectrum.hpp"

using namespace malus;

namespace {
constexpr double rounding = 1e-13;  // a few operations on numbers of size one to ten

SpectralGridPtr bands(std::initializer_list<double> nm) { return SpectralGrid::make(nm); }

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(std::min(what.find("x."), what.size()));
  }
  return "none";
}
std::string refusal(const std::string& file, const std::string& text,
                    std::initializer_list<double> nm = {500}) {
  const Scratch scratch;
  put(scratch / file, text);
  return complaint([&] { readOpticalConstants(scratch / file, bands(nm)); });
}
bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

OpticalConstants fromFormula(const std::string& formula, const std::string& coefficients) {
  const Scratch scratch;
  put(scratch / "x.yml",
      "DATA:\n  - type: formula " + formula +
          "\n    wavelength_range: 0.3 2\n    coefficients: " + coefficients +
          "\n  - type: tabulated k\n    data: |\n      0.3 0\n      2.0 0\n");
  return readOpticalConstants(scratch / "x.yml", bands({400, 589.3, 1000}));
}
}  // namespace

// section 7.1 of the thesis prints n = 0.405, k = 2.950 for copper at 600 nm
TEST(MaterialPublished, CopperAt600IsTheThesis) {
  const auto copper = readOpticalConstants("scenes/data/copper-weast-lide.csv", bands({600}));
  const double half_a_digit = 0.0005;  // printed to three digits after the point
  EXPECT_NEAR(copper.n[0], 0.405, half_a_digit);
  EXPECT_NEAR(copper.k[0], 2.950, half_a_digit);
  const auto next = readOpticalConstants("scenes/data/copper-weast-lide.csv", bands({601}));
  EXPECT_GT(std::abs(next.n[0] - 0.405),
            half_a_digit);  // the control: 1 nm further is another copper
}

TEST(MaterialPublished, TablesAndRecordsOfTheScenesCoverTheVisible) {
  const auto visible = bands({400, 450, 500, 550, 600, 650, 700});
  for (const std::string name : {"copper.csv", "copper-johnson-christy.yml",
                                 "aluminium-rakic.yml", "water.yml", "glass.yml"}) {
    const auto constants = readOpticalConstants("scenes/data/" + name, visible);
    for (std::size_t i = 0; i < visible->size(); ++i) EXPECT_GT(constants.n[i], 0.1) << name;
  }
  for (const std::string name :
       {"asphalt.csv", "concrete.csv", "soil.csv", "grass.csv", "foliage.csv"}) {
    const auto reflectance =
        readSpectrum("scenes/data/" + name, "reflectance", visible, {.high = 1});
    for (std::size_t i = 0; i < visible->size(); ++i) EXPECT_GT(reflectance[i], 0) << name;
  }
}

// Johnson and Christy and Hagemann et al. measured copper independently: at 650 nm the two agree to
// 0.02 in n and 2 % in k; a file in the wrong unit or with exchanged columns does not.
TEST(MaterialPublished, TwoMeasurementsOfCopperAgree) {
  const auto hagemann = readOpticalConstants("scenes/data/copper.csv", bands({450, 650}));
  const auto johnson =
      readOpticalConstants("scenes/data/copper-johnson-christy.yml", bands({450, 650}));
  EXPECT_NEAR(hagemann.n[1], johnson.n[1], 0.03);
  EXPECT_NEAR(hagemann.k[1], johnson.k[1], 0.03 * johnson.k[1]);
  EXPECT_GT(std::abs(hagemann.n[0] - johnson.n[1]), 0.03);  // the control: another wavelength
}

TEST(MaterialPublished, WindowGlassAtTheSodiumLine) {
  const auto glass = readOpticalConstants("scenes/data/glass.yml", bands({589.3}));
  EXPECT_NEAR(glass.n[0], 1.523, 0.0005);  // as opticians quote it, three digits
}

// Exact: the sample of a narrow band is the formula itself. Second evaluations by std::complex.
TEST(MaterialIdentity, FormulasAreWhatTheyAreCalled) {
  const std::vector<double> um{0.4, 0.5893, 1.0};
  using C = std::complex<double>;
  // fused silica (Malitson 1965): n(0.5893) = 1.4584
  const auto one =
      fromFormula("1", "0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161");
  EXPECT_NEAR(one.n[1], 1.4584, 0.00005);
  const auto two = fromFormula("2", "0.1 1.04 0.006 0.23 0.02");
  const auto three = fromFormula("3", "2.25 0.01 2 0.012 -2 0.0001 -4");
  const auto five = fromFormula("5", "1.5 0.004 -2");
  for (std::size_t i = 0; i < um.size(); ++i) {
    const C l = um[i], l2 = l * l;
    const C sellmeier = std::sqrt(1.1 + 1.04 * l2 / (l2 - 0.006) + 0.23 * l2 / (l2 - 0.02));
    EXPECT_NEAR(two.n[i], sellmeier.real(), rounding);
    const C polynomial = std::sqrt(2.25 + 0.01 * l2 + 0.012 / l2 + 0.0001 / (l2 * l2));
    EXPECT_NEAR(three.n[i], polynomial.real(), rounding);
    EXPECT_NEAR(five.n[i], (1.5 + 0.004 / l2).real(), rounding);
    EXPECT_GT(std::abs(two.n[i] - polynomial.real()), 1e-3);  // the control
  }
}

TEST(MaterialIdentity, BroadBandsSeeTheAverageOfTheStraightLines) {
  const SpectrumSamples samples{"r", {400, 500, 600}, {0, 1, 0}, {}, {}};
  const auto tent =
      spectrumOnGrid(samples, SpectralGrid::make(std::vector{CDSpectralLocation(
                                  CDSpectralPoint(500), BandResponse::rectangular(100))}));
  EXPECT_NEAR(tent[0], 0.75, rounding);  // the mean of 0.5 and 1 on both sides
}

// A rectangular band of 0.5 um to 1 mm over n = 1.5 + 0.004 / um^2 has the mean of that formula,
// 1.5 + 0.004 (1 / 0.5 - 1 / 1000) / (1000 - 0.5). Ten thousand samples, 0.1 um apart, are trapezoids
// whose sum is wrong by 0.1^2 / 12 times the slope 16 at the blue end, 0.014 of 999.5.
TEST(MaterialIdentity, VeryBroadBandsOfAFormulaAreAveragedToo) {
  const Scratch scratch;
  put(scratch / "x.yml",
      "DATA:\n  - type: formula 5\n    wavelength_range: 0.5 1000\n    coefficients: 1.5 0.004 "
      "-2\n"
      "  - type: tabulated k\n    data: |\n      0.5 0\n      1000 0\n");
  const auto broad = SpectralGrid::make(std::vector{
      CDSpectralLocation(CDSpectralPoint(500250), BandResponse::rectangular(999500))});
  const double n = readOpticalConstants(scratch / "x.yml", broad).n[0];
  const double mean = 1.5 + 0.004 * (1 / 0.5 - 1 / 1000.0) / 999.5;
  EXPECT_NEAR(n, mean, 0.004 * 2e-5);
  EXPECT_GT(std::abs(n - 1.5), 0.004 * 2e-5);  // the control: the infrared end alone
}

TEST(MaterialIdentity, EndsOfATableAreInside) {
  const auto ends =
      readOpticalConstants("scenes/data/aluminium-rakic.yml", bands({364.66, 815.69}));
  EXPECT_EQ(ends.n[0], 0.39877);
  EXPECT_EQ(ends.k[1], 8.2573);
}

TEST(MaterialIdentity, BadTablesNameTheirLine) {
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n400,1,2\n450,1,2\n"),
                   "x.csv: n: does not cover the band at 500 nm; it covers 400 to 450 nm"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n400,1,2\n600,1,-2\n"),
                   "x.csv:3: k = -2 at 600 nm"));
  EXPECT_TRUE(
      says(refusal("x.csv", "wavelength_nm,n,k\n400,1,2\n600,0,2\n"), "give a value above 0"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n600,1,2\n400,1,2\n"),
                   "x.csv:3: wavelength = 400 nm: does not ascend"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n-4,1,2\n"), "must be above zero"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n\n400,1\n"), "k"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n400,nan,2\n600,1,2\n"), "x.csv:2"));
  EXPECT_TRUE(says(refusal("x.csv", "wavelength_nm,n,k\n"), "give at least one sample"));
  EXPECT_TRUE(says(refusal("x.txt", ""), "not a known suffix"));
  EXPECT_EQ(refusal("x.csv", "wavelength_nm,n,k\n400,1,2\n600,1,2\n"), "none");  // the control
}

TEST(MaterialIdentity, BadRecordsNameTheirLine) {
  const std::string head = "REFERENCES: x\nDATA:\n  - type: tabulated nk\n    data: |\n";
  EXPECT_EQ(refusal("x.yml", head + "      0.4 1 2\n      0.6 1 2\n"), "none");  // the control
  EXPECT_TRUE(
      says(refusal("x.yml", head + "      0.4 1 2\n      0.6 1 z\n"), "x.yml:6: data = z"));
  EXPECT_TRUE(says(refusal("x.yml", head + "      0.4 1 2\n      0.6 1\n"),
                   "x.yml:6: data = 0.6 1: holds 2 numbers"));
  EXPECT_TRUE(says(refusal("x.yml", head + "      0.4 1 2\n      0.6 1 -2\n"),
                   "x.yml:6: k = -2 at 600 nm"));
  EXPECT_TRUE(
      says(refusal("x.yml", head + "      0.51 1 2\n      0.6 1 2\n"), "covers 510 to 600 nm"));
  EXPECT_TRUE(says(refusal("x.yml", "DATA: [1,\n"), "x.yml:2"));
  EXPECT_TRUE(says(refusal("x.yml", "DATA: 3\n"), "missing or not a list"));
  EXPECT_TRUE(says(refusal("x.yml", "just words\n"), "x.yml"));
  EXPECT_TRUE(says(refusal("x.yml", "DATA:\n  - type: formula 4\n"),
                   "x.yml:2: type = formula 4: is not known"));
  EXPECT_TRUE(says(
      refusal("x.yml", "DATA:\n  - type: tabulated n\n    data: |\n      0.4 1\n      0.6 1\n"),
      "k: is missing"));
  EXPECT_TRUE(
      says(refusal("x.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.6 0.3\n"),
           "is not a range"));
  EXPECT_TRUE(
      says(complaint([] { readSpectrum("x.csv", "r", bands({500})); }), "does not exist"));
  EXPECT_TRUE(
      says(complaint([] { readOpticalConstants("x.yml", bands({500})); }), "does not exist"));
}

TEST(MaterialIdentity, LimitsAreTheCallers) {
  const Scratch scratch;
  put(scratch / "x.csv", "wavelength_nm,paint\n400,0.5\n600,1.5\n");
  EXPECT_TRUE(says(
      complaint([&] { readSpectrum(scratch / "x.csv", "paint", bands({500}), {.high = 1}); }),
      "x.csv:3: paint = 1.5 at 600 nm"));
  EXPECT_NEAR(readSpectrum(scratch / "x.csv", "paint", bands({500}))[0], 1.0, rounding);
}
