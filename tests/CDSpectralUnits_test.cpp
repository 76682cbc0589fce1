// Units of the spectral axis and densities over it (nw/light/CDSpectralUnits.nw).
#include "malus/light/CDSpectralUnits.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace malus;
using enum CDSpectralUnits;

namespace {
const std::vector<CDSpectralUnits> all{nanometre, micrometre, perCentimetre, electronVolt,
                                       hertz};
// three multiplications or divisions, each rounding by 1.1e-16
constexpr double rounding = 5e-16;

double relative(double ours, double theirs) { return std::abs(ours / theirs - 1); }
}  // namespace

TEST(CDSpectralUnitsPublished, ExactConstantsOfTheSI) {
  // The International System of Units, 9th edition (2019), table 1
  EXPECT_EQ(speed_of_light_m_s, 299792458.0);
  EXPECT_EQ(planck_J_s, 6.62607015e-34);
  EXPECT_EQ(elementary_charge_C, 1.602176634e-19);
}

TEST(CDSpectralUnitsPublished, ElectronvoltOfCODATA) {
  // CODATA 2018, "electron volt-hertz relationship" and "electron volt-inverse meter
  // relationship"
  const double printed_digits = 1e-9;  // ten digits are printed
  EXPECT_LT(relative(convertSpectral(1, electronVolt, hertz), 2.417989242e14), printed_digits);
  EXPECT_LT(relative(convertSpectral(1, electronVolt, perCentimetre), 8065.543937),
            printed_digits);
  EXPECT_GT(relative(convertSpectral(1, electronVolt, perCentimetre), 8065.543947),
            printed_digits);  // negative control: one digit changed
  EXPECT_NEAR(convertSpectral(1, electronVolt, nanometre), 1239.84, 0.005);
  // the SI's own example of c: 1 m is 299 792 458 Hz
  EXPECT_LT(relative(convertSpectral(1e9, nanometre, hertz), 299792458), rounding);
}

TEST(CDSpectralUnitsIdentity, WorkedExamples) {
  EXPECT_EQ(convertSpectral(500, nanometre, perCentimetre), 20000);
  EXPECT_EQ(convertSpectral(20000, perCentimetre, micrometre), 0.5);
  EXPECT_EQ(convertSpectral(0.55, micrometre, nanometre), 550);
  EXPECT_EQ(convertSpectralDensity(500, 2, nanometre, perCentimetre), 0.05);
  EXPECT_EQ(convertSpectralDensity(0.5, 2000, micrometre, nanometre), 2);
}

RC_GTEST_PROP(CDSpectralUnitsIdentity, RoundTrips, ()) {
  const double nm =
      *rc::gen::map(rc::gen::inRange(100000, 20000000), [](int i) { return i * 1e-3; });
  for (const auto a : all)
    for (const auto b : all) {
      const double there = convertSpectral(nm, nanometre, a);
      const double back = convertSpectral(convertSpectral(there, a, b), b, a);
      RC_ASSERT(relative(back, there) < rounding);
      RC_ASSERT(relative(back * (1 + 1e-15), there) > rounding);  // negative control
      RC_ASSERT(convertSpectral(there, a, a) == there);
      const double density = convertSpectralDensity(there, 3, a, b);
      RC_ASSERT(relative(convertSpectralDensity(convertSpectral(there, a, b), density, b, a),
                         3) < 2 * rounding);
    }
}

// What is radiated between 400 and 700 nm does not depend on the axis. Simpson's rule on each
// axis; the integrand is smooth, and halving the step shows the quadrature's own error.
TEST(CDSpectralUnitsInvariant, DensityConservesTheIntegral) {
  const auto per_nm = [](double nm) { return 1 + std::exp(-(nm - 520) * (nm - 520) / 5000); };
  const auto integral = [&](CDSpectralUnits units, int steps, bool convert) {
    double a = convertSpectral(400, nanometre, units),
           b = convertSpectral(700, nanometre, units);
    if (a > b) std::swap(a, b);
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
      const double x = a + (b - a) * i / steps, nm = convertSpectral(x, units, nanometre);
      const double density =
          convert ? convertSpectralDensity(nm, per_nm(nm), nanometre, units) : per_nm(nm);
      sum += density * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
    }
    return sum * (b - a) / steps / 3;
  };
  // over wavelength, in closed form: 300 + sqrt(5000 pi)/2 (erf - erf)
  const double w = std::sqrt(5000.0);
  const double exact =
      300 + w * std::sqrt(std::acos(-1.0)) / 2 * (std::erf(180 / w) + std::erf(120 / w));
  for (const auto units : all) {
    // fourth order: the error of 2000 steps is about a fifteenth of its change from 1000 steps
    const double ours = integral(units, 2000, true);
    const double tolerance = std::abs(ours - integral(units, 1000, true)) + 1e-12 * exact;
    EXPECT_NEAR(ours, exact, tolerance) << symbolOf(units);
    EXPECT_LT(tolerance, 1e-6 * exact) << symbolOf(units);
    if (units == nanometre) continue;
    EXPECT_GT(std::abs(integral(units, 2000, false) - exact), tolerance);  // negative control
  }
}

TEST(CDSpectralUnitsIdentity, ForbiddenCoordinates) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -0.0, -550.0, infinite, -infinite,
                           std::numeric_limits<double>::quiet_NaN(), 5e-324})
    for (const auto from : all)
      for (const auto to : all) {
        // the smallest number is a wavelength, but has no reciprocal
        if (bad > 0 && std::isfinite(bad) && (from == nanometre || from == micrometre) &&
            (to == nanometre || to == micrometre))
          continue;
        EXPECT_THROW(convertSpectral(bad, from, to), MathError)
            << bad << symbolOf(from) << symbolOf(to);
        EXPECT_THROW(convertSpectralDensity(bad, 1, from, to), MathError);
      }
}

TEST(CDSpectralUnitsIdentity, AnyDensityPasses) {
  EXPECT_EQ(convertSpectralDensity(500, -2, nanometre, perCentimetre), -0.05);
  EXPECT_TRUE(std::isnan(convertSpectralDensity(500, std::nan(""), nanometre, electronVolt)));
}

TEST(CDSpectralUnitsIdentity, NamesAreReadAndWritten) {
  for (const auto units : all) EXPECT_EQ(parseSpectralUnits(symbolOf(units)), units);
  EXPECT_EQ(parseSpectralUnits("cm-1"), perCentimetre);
  EXPECT_EQ(parseSpectralUnits("\xC2\xB5m"), micrometre);  // U+00B5
  EXPECT_EQ(parseSpectralUnits("\xCE\xBCm"), micrometre);  // U+03BC
}

TEST(CDSpectralUnitsIdentity, AWrongNameIsToldWithItsPlace) {
  try {
    parseSpectralUnits("NM", {"copper.csv", 3, "units"});
    FAIL() << "NM was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "copper.csv:3: units = NM: is not a unit of the spectral axis; choose from: nm, um, "
        "cm^-1, eV, Hz");
  }
  for (const char* bad : {"", "m", "EV", "hz", " nm", "nm "})
    EXPECT_THROW(parseSpectralUnits(bad), InputError) << bad;
}
