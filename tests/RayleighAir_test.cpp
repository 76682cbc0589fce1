// Optical depth and depolarisation of air (nw/air/RayleighAir.nw).
#include "malus/air/RayleighAir.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
// Bodhaine et al. 1999, eq 30: fit at sea level, 1013.25 hPa, 45 deg, 360 ppm; wavelength in micrometres
double bodhaineFit(double um) {
  const double s2 = 1 / (um * um);
  return 0.0021520 * (1.0455996 - 341.29061 * s2 - 0.90230850 * um * um) /
         (1 + 0.0027059889 * s2 - 85.968563 * um * um);
}
// Hansen and Travis 1974, eq 2.30, at 1013 hPa
double hansenTravis(double um) {
  const double s2 = 1 / (um * um);
  return 0.008569 * s2 * s2 * (1 + 0.0113 * s2 + 0.00013 * s2 * s2);
}
}  // namespace

// "better than 0.002 %" from 250 to 850 nm, says the paper of its cross sections' fit; we allow 0.01 %.
TEST(RayleighAirPublished, TheAuthorsOwnFit) {
  for (double nm = 300; nm <= 850; nm += 10) {
    EXPECT_NEAR(rayleighOpticalDepth(nm) / bodhaineFit(nm / 1000), 1, 1e-4) << nm;
    EXPECT_GT(std::abs(rayleighOpticalDepth(nm * 1.001) / bodhaineFit(nm / 1000) - 1),
              1e-4);  // control
  }
}

TEST(RayleighAirPublished, AnOlderFormulaWithinOnePercent) {
  for (double nm = 400; nm <= 800; nm += 50)
    EXPECT_NEAR(rayleighOpticalDepth(nm) / hansenTravis(nm / 1000), 1, 0.01) << nm;
  for (const double nm :
       {2000, 4000, 10000, 20000})  // beyond the measurements: the fourth power
    EXPECT_NEAR(rayleighOpticalDepth(nm) / hansenTravis(nm / 1000), 1, 0.01) << nm;
}

// The design's five values, from an independent evaluation in another language.
TEST(RayleighAirPublished, FiveDigits) {
  EXPECT_NEAR(rayleighOpticalDepth(450), 0.22111, 5e-6);
  EXPECT_NEAR(rayleighOpticalDepth(550), 0.09707, 5e-6);
  EXPECT_NEAR(rayleighOpticalDepth(650), 0.04919, 5e-6);
  EXPECT_NEAR(rayleighOpticalDepth(700), 0.03642, 5e-6);
  // Mauna Loa: 680 hPa, 3.4 km, 19.53 deg north
  EXPECT_NEAR(rayleighOpticalDepth(700, {680, 3400, 19.533, 360}), 0.02451, 5e-6);
}

// King factors of air in the literature lie near 1.05 in the visible: rho = 0.028 to 0.030.
TEST(RayleighAirPublished, Depolarisation) {
  EXPECT_NEAR(rayleighDepolarization(550), 0.0284, 0.0006);
  EXPECT_GT(rayleighDepolarization(400), rayleighDepolarization(700));
}

TEST(RayleighAirInvariant, PressureEntersLinearlyAndNonsenseIsRefused) {
  EXPECT_NEAR(rayleighOpticalDepth(500, {506.625}) * 2, rayleighOpticalDepth(500), 1e-15);
  EXPECT_EQ(rayleighOpticalDepth(500, {0}), 0);
  EXPECT_THROW(rayleighOpticalDepth(199), MathError);
  EXPECT_THROW(rayleighOpticalDepth(20001), MathError);
  EXPECT_THROW(rayleighOpticalDepth(std::nan("")), MathError);
  EXPECT_THROW(rayleighOpticalDepth(500, {-1}), MathError);
  EXPECT_THROW(rayleighOpticalDepth(500, {2000}), MathError);
}
