// Mie's series (nw/air/Mie.nw) against printed values, Rayleigh's limit, the optical theorem and Fresnel's mirror.
#include "malus/air/Mie.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "malus/base/Error.hpp"
#include "malus/surface/Fresnel.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
double largestApart(const Scatterer::Term& a, const Scatterer::Term& b) {
  return std::max({std::abs(a.alpha1 - b.alpha1), std::abs(a.alpha2 - b.alpha2),
                   std::abs(a.alpha3 - b.alpha3), std::abs(a.alpha4 - b.alpha4),
                   std::abs(a.beta1 - b.beta1), std::abs(a.beta2 - b.beta2)});
}
}  // namespace

// Bohren and Huffman 1983, appendix A: a sphere of m = 1.55, radius 0.525, wavelength 0.6328.
TEST(MiePublished, SampleOfBohrenAndHuffman) {
  const MieSphere sphere(2 * pi * 0.525 / 0.6328, 1.55, 0);
  EXPECT_NEAR(sphere.extinction(), 3.10543, 5e-6);  // half a unit of the last digit
  EXPECT_NEAR(sphere.scattering(), 3.10543, 5e-6);
  EXPECT_NEAR(sphere.backscattering(), 2.92534, 5e-6);
  EXPECT_NEAR(sphere.asymmetry(), 0.63314, 5e-6);
  const MieSphere other(2 * pi * 0.525 / 0.6328, 1.56, 0);  // negative control
  EXPECT_GT(std::abs(other.extinction() - 3.10543), 5e-6);
}

// Test cases of Wiscombe's MIEV0 (NCAR/TN-140+STR, 1979), printed to six digits.
TEST(MiePublished, CasesOfWiscombe) {
  struct Case {
    double n, k, size, scattering, asymmetry;
  };
  for (const Case& c :
       {Case{0.75, 0, 0.099, 0.000007, 0.001448}, Case{0.75, 0, 0.101, 0.000008, 0.001507},
        Case{0.75, 0, 10, 2.232265, 0.896473}, Case{0.75, 0, 1000, 1.997908, 0.844944},
        Case{1.33, 1e-5, 1, 0.093923, 0.184517}, Case{1.33, 1e-5, 100, 2.096594, 0.868959},
        Case{1.33, 1e-5, 10000, 1.723857, 0.907840}, Case{1.5, 1, 0.055, 0.000011, 0.000491},
        Case{1.5, 1, 0.056, 0.000012, 0.000509}, Case{1.5, 1, 1, 0.663454, 0.192136},
        Case{1.5, 1, 100, 1.283697, 0.850252}, Case{1.5, 1, 10000, 1.236575, 0.846309},
        Case{10, 10, 1, 2.049405, -0.110664}, Case{10, 10, 100, 1.836785, 0.556215},
        Case{10, 10, 10000, 1.795393, 0.548194}}) {
    const MieSphere sphere(c.size, c.n, c.k);
    EXPECT_NEAR(sphere.scattering(), c.scattering, 1e-6) << c.n << ' ' << c.size;
    EXPECT_NEAR(sphere.asymmetry(), c.asymmetry, 1e-6) << c.n << ' ' << c.size;
  }
  EXPECT_NEAR(MieSphere(1, 1.5, 1).extinction(), 2.336321, 2e-6);
  EXPECT_GT(std::abs(MieSphere(100, 1.5, 0.9).scattering() - 1.283697), 1e-6);  // control
}

// Amplitudes of his case 14, m = 1.5 - i in his convention and size 1, at 0, 30 ... 180 degrees: the complex
// conjugates of ours, since his fields go with exp(+i w t).
TEST(MiePublished, AmplitudesOfWiscombe) {
  const double printed[7][4]{
      {0.584080, 0.190515, 0.584080, 0.190515},   {0.565702, 0.187200, 0.500161, 0.145611},
      {0.517525, 0.178443, 0.287964, 0.041054},   {0.456340, 0.167167, 0.0362285, -0.0618265},
      {0.400212, 0.156643, -0.174875, -0.122959}, {0.362157, 0.149391, -0.305682, -0.143846},
      {0.348844, 0.146829, -0.348844, -0.146829}};
  const MieSphere sphere(1, 1.5, 1);
  for (int i = 0; i < 7; ++i) {
    const auto [s1, s2] = sphere.amplitudes(std::cos(i * pi / 6));
    EXPECT_NEAR(s1.real(), printed[i][0], 1e-6) << i;
    EXPECT_NEAR(s1.imag(), -printed[i][1], 1e-6) << i;
    EXPECT_NEAR(s2.real(), printed[i][2], 1e-6) << i;
    EXPECT_NEAR(s2.imag(), -printed[i][3], 1e-6) << i;
  }
}

// Much smaller than the wavelength: Rayleigh's cross section and all six lists; deviations go with x^2.
TEST(MieIdentity, SmallSpheresAreRayleighs) {
  const double x = 0.01, n = 1.7;
  const double contrast = (n * n - 1) / (n * n + 2);
  const MieSphere sphere(x, n, 0);
  EXPECT_NEAR(sphere.scattering() / (8. / 3 * std::pow(x, 4) * contrast * contrast), 1, 2e-4);
  const MiePowder powder = miePowder(n, 0, {x / (2 * pi), 1}, 1);
  const auto rayleigh = rayleighScatterer(0).terms();
  for (std::size_t l = 0; l < 3; ++l)
    EXPECT_LT(largestApart(powder.scatterer.terms()[l], rayleigh[l]), 1e-3) << l;
  const MiePowder large = miePowder(n, 0, {1 / (2 * pi), 1}, 1);
  EXPECT_GT(largestApart(large.scatterer.terms()[1], rayleigh[1]), 1e-3);  // negative control
}

TEST(MieInvariant, OpticalTheoremAndConservation) {
  for (const double size : {0.05, 0.7, pi, 2 * pi, 12.0, 60.0, 500.0})
    for (const double n : {0.6, 1.33, 1.8, 3.0})
      for (const double k : {0.0, 0.01, 1.0}) {
        const MieSphere sphere(size, n, k);
        const auto ahead = sphere.amplitudes(1);
        EXPECT_NEAR(4 / (size * size) * ahead.s1.real() / sphere.extinction(), 1, 1e-11);
        EXPECT_LT(std::abs(ahead.s1 - ahead.s2), 1e-12 * std::abs(ahead.s1));
        if (k == 0) {
          EXPECT_NEAR(sphere.scattering() / sphere.extinction(), 1, 1e-9) << size << ' ' << n;
        } else {
          EXPECT_LT(sphere.scattering(), sphere.extinction());
        }
        const auto behind = sphere.amplitudes(-1);
        EXPECT_NEAR(4 * std::norm(behind.s1) / (size * size) / sphere.backscattering(), 1,
                    1e-6);
      }
}

// The terms of a powder sum up to the mean of its grains; their first is the normalisation, their second the mean cosine.
TEST(MieIdentity, TermsOfAPowder) {
  const MiePowder one = miePowder(1.8, 0.02, {300 / (2 * pi) * 4.0, 1}, 300);
  const MieSphere sphere(4, 1.8, 0.02);
  EXPECT_NEAR(one.scatterer.terms()[0].alpha1, 1, 1e-10);
  EXPECT_NEAR(one.scatterer.terms()[1].alpha1 / 3, sphere.asymmetry(), 1e-10);
  const double area = pi * std::pow(300 / (2 * pi) * 4.0, 2);
  EXPECT_NEAR(one.extinction_nm2 / area, sphere.extinction(), 1e-12);
  for (const double c : {-0.9, 0.1, 0.8}) {
    const auto [s1, s2] = sphere.amplitudes(c);
    const double norm = 4 / (16 * sphere.scattering());
    const ScatteringMatrix f = one.scatterer.matrix(c);
    EXPECT_NEAR(f.a1, norm / 2 * (std::norm(s1) + std::norm(s2)), 1e-5);  // terms left out
    EXPECT_NEAR(f.b2, norm * (s1 * std::conj(s2)).imag(), 1e-5);
    EXPECT_NEAR(f.a1 * f.a1, f.b1 * f.b1 + f.a3 * f.a3 + f.b2 * f.b2,
                1e-4);  // one grain depolarises nothing
  }
  const MiePowder many = miePowder(1.8, 0.02, {300 / (2 * pi) * 4.0, 1.5}, 300);
  EXPECT_NEAR(many.volume_nm3, one.volume_nm3 * std::exp(4.5 * std::pow(std::log(1.5), 2)),
              2e-3 * many.volume_nm3);  // moment of the log-normal law, cut at four deviations
  const ScatteringMatrix f = many.scatterer.matrix(-0.9);
  EXPECT_GT(f.a1 * f.a1, 1.001 * (f.b1 * f.b1 + f.a3 * f.a3 + f.b2 * f.b2));  // many do
}

// A ball that swallows what enters reflects by its surface: Fresnel's mirror at (pi - Theta)/2. Geometrical optics
// is right to the order of x^(-2/3).
TEST(MiePublished, LargeBlackBallsAreMirrors) {
  const double n = 1.6, k = 0.8;
  const MieSphere ball(3000, n, k);
  for (const double degrees : {60.0, 90.0, 120.0, 150.0}) {
    const double angle = degrees * pi / 180, incidence = (pi - angle) / 2;
    const auto [s1, s2] = ball.amplitudes(std::cos(angle));
    const double a1 = (std::norm(s1) + std::norm(s2)) / 2;
    const auto f = fresnelReflection(std::cos(incidence), std::pow(std::sin(incidence), 2),
                                     n * n - k * k, 2 * n * k);
    EXPECT_NEAR((std::norm(s1) - std::norm(s2)) / 2 / a1, f.diff / f.sum, 5e-3) << degrees;
    EXPECT_NEAR((s1 * std::conj(s2)).real() / a1, f.re / f.sum, 5e-3) << degrees;
    EXPECT_NEAR((s1 * std::conj(s2)).imag() / a1, f.im / f.sum, 5e-3) << degrees;
    EXPECT_GT(f.im / f.sum, 0.02);  // the other sign would be noticed
  }
}

TEST(MieIdentity, ImpossibleSpheresAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MieSphere(0, 1.5, 0), MathError);
  EXPECT_THROW(MieSphere(nan, 1.5, 0), MathError);
  EXPECT_THROW(MieSphere(1, 0, 1), MathError);
  EXPECT_THROW(MieSphere(1, 1.5, -0.1), MathError);
  EXPECT_THROW(miePowder(1, 0, {100, 1}, 500), MathError);
  EXPECT_THROW(miePowder(1.5, 0, {100, 3.1}, 500), MathError);
  EXPECT_THROW(miePowder(1.5, 0, {-1, 1}, 500), MathError);
  EXPECT_THROW(miePowder(1.5, 0, {5000, 1}, 500), MathError);
  // the ends of what is taken: a size of 60, which is a radius of 30 wavelengths over pi, and a spread of 3
  EXPECT_NO_THROW(miePowder(1.5, 0, {59.9 * 500 / (2 * pi), 1}, 500));
  EXPECT_THROW(miePowder(1.5, 0, {60.1 * 500 / (2 * pi), 1}, 500), MathError);
  EXPECT_NO_THROW(miePowder(1.5, 0, {1, 3}, 500));
}
