// Laws of sizes (nw/air/SizeLaws.nw): their moments, and that enough radii represent them.
#include "malus/air/SizeLaws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
double moment(const Radii& radii, double power) {
  double sum = 0;
  for (std::size_t i = 0; i < radii.share.size(); ++i)
    sum += radii.share[i] * std::pow(radii.radius_nm[i], power);
  return sum;
}

// The same law with half of its radii: every second one, with twice the share.
Radii halved(const Radii& radii) {
  Radii half;
  double sum = 0;
  for (std::size_t i = 0; i < radii.share.size(); i += 2) {
    half.radius_nm.push_back(radii.radius_nm[i]), half.share.push_back(radii.share[i]);
    sum += radii.share[i];
  }
  for (double& share : half.share) share /= sum;
  return half;
}

Radii fewOf(Radii radii) {
  while (radii.radius_nm.size() > 8) radii = halved(radii);
  return radii;
}
}  // namespace

// Hansen and Travis: the parameters of the gamma law are its effective radius and variance, and its mean radius is
// a (1 - 2b). What is left out of the bell, 1e-11 of it, is worth less than 1e-8 of a moment.
TEST(SizeLawsIdentity, TheGammaLawHasItsEffectiveRadiusAndVariance) {
  for (const double b : {1e-4, 0.01, 0.07, 0.2, 0.33}) {
    const Radii radii = gammaRadii(300, b, 550);
    const EffectiveSize size = effectiveSize(radii);
    EXPECT_NEAR(size.radius_nm / 300, 1, 1e-8) << b;
    EXPECT_NEAR(size.variance / b, 1, 1e-7) << b;
    EXPECT_NEAR(moment(radii, 0), 1, 1e-12);
    // a sum of steps of a quarter of the width over r n(r): the small radii decay slowly for wide laws
    EXPECT_NEAR(moment(radii, 1) / (300 * (1 - 2 * b)), 1, 1e-6) << b;
  }
  EXPECT_GT(std::abs(effectiveSize(gammaRadii(300, 0.07, 550)).radius_nm / 301 - 1),
            1e-8);  // control
}

TEST(SizeLawsIdentity, TheLogNormalLawHasItsMoments) {
  for (const double deviation : {1.01, 1.3, 2.0}) {
    const double s2 = std::pow(std::log(deviation), 2);
    const Radii radii = logNormalRadii(80, deviation, 550);
    const EffectiveSize size = effectiveSize(radii);
    EXPECT_NEAR(size.radius_nm / (80 * std::exp(2.5 * s2)), 1, 1e-8) << deviation;
    EXPECT_NEAR(size.variance / std::expm1(s2), 1, 1e-6) << deviation;
    EXPECT_NEAR(moment(radii, 1) / (80 * std::exp(0.5 * s2)), 1, 1e-8) << deviation;
  }
  const double s2 = std::pow(std::log(2.0), 2);
  EXPECT_GT(std::abs(effectiveSize(logNormalRadii(80, 2.01, 550)).radius_nm /
                         (80 * std::exp(2.5 * s2)) -
                     1),
            1e-3);  // control
}

TEST(SizeLawsIdentity, ANarrowLawIsOneRadius) {
  const MiePowder one = miePowder(1.44, 0, oneRadius(200), 550),
                  narrow = miePowder(1.44, 0, gammaRadii(200, 1e-4, 550), 550),
                  wide = miePowder(1.44, 0, gammaRadii(200, 0.1, 550), 550);
  // the mean of a function over a law of variance v differs from its value by the order of v
  EXPECT_NEAR(narrow.scattering_nm2 / one.scattering_nm2, 1, 1e-3);
  EXPECT_GT(std::abs(wide.scattering_nm2 / one.scattering_nm2 - 1), 1e-2);  // control
  EXPECT_EQ(effectiveSize(oneRadius(200)).radius_nm, 200);
  EXPECT_EQ(effectiveSize(oneRadius(200)).variance, 0);
}

// Half of the radii give nearly the same powder, and so all of them are better than that: the
// ripple of spheres, not the law, determines the steps, and the narrow peaks of the larger ones
// cost two digits.
TEST(SizeLawsInvariant, ThereAreEnoughRadii) {
  const Radii fine = gammaRadii(200, 0.07, 951), large = logNormalRadii(300, 1.5, 550);
  for (const Radii* radii : {&fine, &large}) {
    const double wavelength = radii == &fine ? 951 : 550,
                 tolerance = radii == &fine ? 1e-6 : 2e-4;
    const MiePowder all = miePowder(1.44, 0, *radii, wavelength),
                    half = miePowder(1.44, 0, halved(*radii), wavelength);
    EXPECT_NEAR(half.scattering_nm2 / all.scattering_nm2, 1, tolerance);
    for (std::size_t l = 0; l < 8; ++l)
      EXPECT_NEAR(half.scatterer.terms()[l].alpha1, all.scatterer.terms()[l].alpha1, tolerance)
          << l;
    const MiePowder few = miePowder(1.44, 0, fewOf(*radii), wavelength);
    EXPECT_GT(std::abs(few.scattering_nm2 / all.scattering_nm2 - 1), tolerance);  // control
  }
}

TEST(SizeLawsInvariant, ACutLawHasNoSphereBeyond) {
  const Radii cut = logNormalRadii(100, 2, 550, 250), whole = logNormalRadii(100, 2, 550);
  EXPECT_NEAR(*std::max_element(cut.radius_nm.begin(), cut.radius_nm.end()), 250, 1e-9);
  EXPECT_GT(*std::max_element(whole.radius_nm.begin(), whole.radius_nm.end()), 1000);
  EXPECT_LT(effectiveSize(cut).radius_nm, effectiveSize(whole).radius_nm);
  EXPECT_NEAR(moment(cut, 0), 1, 1e-12);
  // a cut where nothing is left changes nothing
  EXPECT_EQ(gammaRadii(200, 0.07, 550, 1e6).radius_nm, gammaRadii(200, 0.07, 550).radius_nm);
}

TEST(SizeLawsIdentity, ImpossibleLawsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_THROW(oneRadius(bad), MathError);
    EXPECT_THROW(gammaRadii(bad, 0.1, 550), MathError);
    EXPECT_THROW(gammaRadii(100, bad, 550), MathError);
    EXPECT_THROW(gammaRadii(100, 0.1, bad), MathError);
    EXPECT_THROW(gammaRadii(100, 0.1, 550, bad), MathError);
    EXPECT_THROW(logNormalRadii(bad, 1.5, 550), MathError);
    EXPECT_THROW(logNormalRadii(100, bad, 550), MathError);
  }
  EXPECT_THROW(gammaRadii(100, 0.4, 550), MathError);
  EXPECT_THROW(logNormalRadii(100, 3.1, 550), MathError);
  EXPECT_THROW(gammaRadii(100, 0.01, 550, 1), MathError);  // nothing is left
  EXPECT_THROW(miePowder(1.5, 0, Radii{{100, 200}, {1}}, 550), MathError);
  EXPECT_THROW(miePowder(1.5, 0, Radii{{}, {}}, 550), MathError);
  EXPECT_THROW(miePowder(1.5, 0, oneRadius(1e5), 550), MathError);
}
