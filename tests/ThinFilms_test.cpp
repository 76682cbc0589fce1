// Boundaries with films (nw/surface/ThinFilms.nw) against Fresnel, Airy's sum, and quarter waves.
#include "malus/surface/ThinFilms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
using Complex = std::complex<double>;
double apart(const FresnelTerms<double>& a, const FresnelTerms<double>& b) {
  return std::max({std::abs(a.sum - b.sum), std::abs(a.diff - b.diff), std::abs(a.re - b.re),
                   std::abs(a.im - b.im)});
}
double sin2(double degrees) { return std::pow(std::sin(degrees * pi / 180), 2); }
}  // namespace

TEST(ThinFilmsIdentity, NoFilmIsFresnel) {
  for (const double degrees : {0.0, 20.0, 45.0, 56.3, 70.0, 89.0, 90.0})
    for (const auto& index : {std::pair{1.5, 0.0}, {0.405, 2.95}, {0.5, 0.0}, {1.33, 0.01}}) {
      const double n = index.first, k = index.second;
      const double s2 = sin2(degrees), c = std::cos(degrees * pi / 180);
      const FilmTerms bare = filmStack(1, {}, n, k, 550, s2);
      EXPECT_LT(apart(bare.reflection, fresnelReflection(c, s2, n * n - k * k, 2 * n * k)),
                1e-12)
          << degrees << ' ' << n;
      if (k == 0) {
        EXPECT_LT(apart(bare.transmission, fresnelTransmission(c, s2, n)), 1e-12)
            << degrees << n;
      }
      // a film of the medium, or of the substrate, or none thick
      const auto same = [&](Film film) {
        return apart(filmStack(1, {film}, n, k, 550, s2).reflection, bare.reflection);
      };
      EXPECT_LT(same({1.7, 0.2, 0}), 1e-12);
      EXPECT_LT(same({n, k, 80}), 1e-11);
      if (degrees > 0 && degrees < 89) {
        EXPECT_GT(same({1.7, 0.2, 20}), 1e-4);  // negative control
      }
    }
}

// All waves that go to and fro in one film, added one by one.
TEST(ThinFilmsPublished, OneFilmIsAirysSum) {
  const double wavelength = 550, d = 230, s2 = sin2(50);
  const Complex n1(1.9, 0.15), n2(1.5, 0.4);
  const double c0 = std::sqrt(1 - s2);
  const Complex w1 = std::sqrt(n1 * n1 - s2), w2 = std::sqrt(n2 * n2 - s2);
  const Complex once = std::exp(Complex(0, 2 * pi * d / wavelength) * w1);
  const auto sum = [&](Complex r01, Complex r12) {
    Complex r = r01, wave = (1.0 - r01 * r01) * once * r12 * once;
    for (int i = 0; i < 200; ++i, wave *= -r01 * r12 * once * once) r += wave;
    return r;
  };
  const auto e = [](Complex n) { return n * n; };
  const Complex rs = sum((c0 - w1) / (c0 + w1), (w1 - w2) / (w1 + w2));
  const Complex rp = sum((e(n1) * c0 - w1) / (e(n1) * c0 + w1),
                         (e(n2) * w1 - e(n1) * w2) / (e(n2) * w1 + e(n1) * w2));
  const auto ours = filmStack(1, {{1.9, 0.15, d}}, 1.5, 0.4, wavelength, s2).reflection;
  EXPECT_NEAR(ours.sum, (std::norm(rs) + std::norm(rp)) / 2, 1e-13);
  EXPECT_NEAR(ours.diff, (std::norm(rs) - std::norm(rp)) / 2, 1e-13);
  EXPECT_NEAR(ours.re, (rs * std::conj(rp)).real(), 1e-13);
  EXPECT_NEAR(ours.im, (rs * std::conj(rp)).imag(), 1e-13);
  EXPECT_GT(std::abs(ours.im), 5e-4);  // the sign was there to be seen
}

// Born and Wolf, section 1.6.4: a quarter wave of n on n_t reflects ((n_t - n^2)/(n_t + n^2))^2.
TEST(ThinFilmsPublished, QuarterAndHalfWaves) {
  const auto normal = [](double n, double waves, double n_t) {
    return filmStack(1, {{n, 0, waves * 550 / n}}, n_t, 0, 550, 0).reflection.sum;
  };
  EXPECT_NEAR(normal(std::sqrt(1.52), 0.25, 1.52), 0, 1e-15);
  EXPECT_NEAR(normal(1.38, 0.25, 1.52), std::pow((1.52 - 1.9044) / (1.52 + 1.9044), 2), 1e-14);
  EXPECT_NEAR(normal(1.38, 0.5, 1.52), std::pow(0.52 / 2.52, 2), 1e-14);
  EXPECT_GT(normal(1.38, 0.3, 1.52), 0.0127);  // negative control
}

TEST(ThinFilmsInvariant, LosslessStacksKeepEnergyFromBothSides) {
  const std::vector<Film> films{{1.38, 0, 100}, {2.3, 0, 57}, {1.7, 0, 300}};
  const std::vector<Film> reversed(films.rbegin(), films.rend());
  for (const double degrees : {0.0, 30.0, 60.0, 85.0, 90.0})
    for (const double nm : {400.0, 700.0}) {
      const auto there = filmStack(1, films, 1.5, 0, nm, sin2(degrees)),
                 back = filmStack(1.5, reversed, 1, 0, nm, sin2(degrees));
      EXPECT_NEAR(there.reflection.sum + there.transmission.sum, 1, 1e-13);
      EXPECT_NEAR(there.reflection.diff + there.transmission.diff, 0, 1e-13);
      // at 90 degrees the cosine, 6e-17 or 1e-8, is what rounding leaves of it
      EXPECT_LT(apart(there.transmission, back.transmission), degrees < 90 ? 1e-13 : 1e-7);
      EXPECT_NEAR(there.reflection.sum, back.reflection.sum, degrees < 90 ? 1e-13 : 1e-7);
    }
  // beyond the critical angle everything comes back, through any films
  const auto total = filmStack(1.5, reversed, 1, 0, 550, 2.25 * sin2(60));
  EXPECT_NEAR(total.reflection.sum, 1, 1e-13);
  EXPECT_NEAR(total.reflection.diff, 0, 1e-13);
  EXPECT_NEAR(std::hypot(total.reflection.re, total.reflection.im), 1, 1e-13);
  EXPECT_EQ(total.transmission.sum, 0);
  const auto lossy = filmStack(1, {{1.38, 0.1, 100}}, 1.5, 0, 550, 0);  // negative control
  EXPECT_LT(lossy.reflection.sum + lossy.transmission.sum, 0.95);
}

TEST(ThinFilmsIdentity, CutFilmsAndThickMetal) {
  const auto whole = filmStack(1, {{1.8, 0.05, 250}}, 2.2, 0.3, 600, 0.4),
             cut = filmStack(1, {{1.8, 0.05, 90}, {1.8, 0.05, 160}}, 2.2, 0.3, 600, 0.4);
  EXPECT_LT(apart(whole.reflection, cut.reflection), 1e-14);
  EXPECT_LT(apart(whole.transmission, cut.transmission), 1e-14);
  const auto thick = filmStack(1, {{0.405, 2.95, 1e5}}, 1.5, 0, 550, 0.5);
  EXPECT_LT(apart(thick.reflection, fresnelReflection(std::sqrt(0.5), 0.5, -8.538475, 2.3895)),
            1e-12);
  EXPECT_EQ(thick.transmission.sum, 0);
}

TEST(ThinFilmsIdentity, ImpossibleStacksAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(filmStack(1, {{1.5, 0, -1}}, 1.5, 0, 550, 0), MathError);
  EXPECT_THROW(filmStack(1, {{1.5, -0.1, 1}}, 1.5, 0, 550, 0), MathError);
  EXPECT_THROW(filmStack(1, {}, nan, 0, 550, 0), MathError);
  EXPECT_THROW(filmStack(1, {}, 1.5, 0, 0, 0), MathError);
  EXPECT_THROW(filmStack(1, {}, 1.5, 0, 550, 1.1), MathError);
}
