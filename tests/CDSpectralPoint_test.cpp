// A coordinate with its unit (nw/light/CDSpectralPoint.nw).
#include "malus/light/CDSpectralPoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace malus;
using enum CDSpectralUnits;

TEST(CDSpectralPointIdentity, RemembersWhatWasGiven) {
  const CDSpectralPoint point(20000, perCentimetre);
  EXPECT_EQ(point.getValue(), 20000);
  EXPECT_EQ(point.getUnits(), perCentimetre);
  EXPECT_EQ(point.nm(), 500);
  EXPECT_EQ(point.in(micrometre), 0.5);
  EXPECT_EQ(toString(point), "20000 cm^-1");
  EXPECT_EQ(toString(550.5), "550.5 nm");  // a plain number is a wavelength in nanometres
}

TEST(CDSpectralPointIdentity, OrderedByWavelengthAcrossUnits) {
  const CDSpectralPoint blue(3, electronVolt), red(2, electronVolt), green(550);
  EXPECT_LT(blue, red);  // the bare values say the opposite
  EXPECT_LT(blue, green);
  EXPECT_GT(red, green);
  EXPECT_FALSE(red < blue);
  EXPECT_EQ(CDSpectralPoint(0.5, micrometre), CDSpectralPoint(500));
  EXPECT_NE(CDSpectralPoint(0.5, micrometre),
            CDSpectralPoint(500.0000001));  // negative control
}

TEST(CDSpectralPointPublished, SodiumDLine) {
  // D. A. Steck, Sodium D Line Data (2000), table 3, D2: vacuum wavelength 589.158 326 4(15)
  // nm, frequency 508.848 716 2(13) THz, wave number 16 973.366 160(3) cm^-1; tolerances are
  // its uncertainties. (Its energy in eV rests on the older CODATA values of h and e.)
  const CDSpectralPoint d2(589.1583264);
  EXPECT_NEAR(d2.in(hertz)*1e-12, 508.8487162, 1.3e-6);
  EXPECT_NEAR(d2.in(perCentimetre), 16973.366160, 3e-6);
  // negative control: the wavelength in air, 588.995 nm, belongs to another frequency
  EXPECT_GT(std::abs(CDSpectralPoint(588.995).in(hertz)*1e-12 - 508.8487162), 1.3e-6);
}

TEST(CDSpectralPointInvariant, EveryPointIsPositiveAndFinite) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const auto units : {nanometre, micrometre, perCentimetre, electronVolt, hertz}) {
    for (const double bad : {0.0, -1.0, infinite, -infinite, std::nan("")})
      EXPECT_THROW(CDSpectralPoint(bad, units), MathError) << bad << " " << symbolOf(units);
    EXPECT_NO_THROW(CDSpectralPoint(1, units));
  }
}
