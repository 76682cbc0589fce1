// The rough metal (nw/surface/BRDFTorranceSparrow.nw, FacetIntegral.nw) against field
// vectors, std::complex and 4x4 algebra.
#include "malus/surface/BRDFTorranceSparrow.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "DrawnDirections.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/DHRTorranceSparrow.hpp"

using namespace malus;

namespace {
using Complex = std::complex<double>;
using Matrix = std::array<double, 16>;
constexpr double pi = std::numbers::pi;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double false_alarm = 1e-6;  // of one chi-squared test; the suite makes fewer than ten

constexpr TorranceSparrowOptions with(Shadowing shadowing, DiffuseTerm diffuse,
                                      bool polarized = true) {
  return {shadowing, diffuse, polarized};
}
constexpr TorranceSparrowOptions specular_only = with(Shadowing::vGroove, DiffuseTerm::none);
constexpr TorranceSparrowOptions as_thesis = with(Shadowing::vGroove, DiffuseTerm::thesis);
constexpr TorranceSparrowOptions reciprocal = with(Shadowing::vGroove, DiffuseTerm::reciprocal);

Matrix elements(const CDMuellerMatrix& m) {
  Matrix out;
  for (int i = 0; i < 16; ++i) out[i] = m.getMueller(i / 4, i % 4);
  return out;
}

double largestDifference(const Matrix& a, const Matrix& b) {
  double largest = 0;
  for (int i = 0; i < 16; ++i) {
    if (!(std::abs(a[i] - b[i]) <= largest)) largest = std::abs(a[i] - b[i]);  // keeps a NaN
  }
  return largest;
}

// ---- An evaluation that shares nothing with the book's but eq 5.7: field vectors in space,
// complex Fresnel coefficients as in Hecht, and the Mueller matrix from the Jones matrix by the
// Pauli traces.
struct Coefficients {
  Complex rs, rp;
};
Coefficients hecht(double cos_beta, double n, double k) {
  const Complex index(n, k);
  const double sin_beta2 = 1 - cos_beta * cos_beta;
  Complex cos_t = std::sqrt(1.0 - sin_beta2 / (index * index));
  if ((index * cos_t).imag() < 0) cos_t = -cos_t;  // the wave below decays for e^{-i w t}
  return {(cos_beta - index * cos_t) / (cos_beta + index * cos_t),
          (index * cos_beta - cos_t) / (index * cos_beta + cos_t)};
}

struct Axes {
  CDVector s, p;
};
/// Light that meets a facet head on has no plane of incidence: any transverse axis serves, here y.
Axes axes(const CDVector& k, const CDVector& normal) {
  const CDVector across = cross(normal, k);
  const CDVector s = across.getLength() < 1e-12 ? CDVector{0, 1, 0} : normalized(across);
  return {s, cross(k, s)};
}

using Jones = std::array<Complex, 4>;
Matrix muellerOf(const Jones& j) {
  const Complex i(0, 1);
  const std::array<Jones, 4> pauli{
      {{1, 0, 0, 1}, {1, 0, 0, -1}, {0, 1, 1, 0}, {0, -i, i, 0}}};  // S3 = 2 Im(Es* Ep)
  const auto product = [](const Jones& a, const Jones& b) {
    return Jones{a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3],
                 a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]};
  };
  const Jones dagger{std::conj(j[0]), std::conj(j[2]), std::conj(j[1]), std::conj(j[3])};
  Matrix out;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const Jones t = product(product(pauli[a], j), product(pauli[b], dagger));
      out[4 * a + b] = 0.5 * (t[0] + t[3]).real();
    }
  return out;
}

/// Specular part of f with the V-groove factor (or without).
Matrix reference(double theta_i, double theta_r, double phi, double n, double k, double sigma,
                 bool groove = true) {
  const CDVector to_source{std::sin(theta_i), 0, std::cos(theta_i)};
  const CDVector to_viewer{std::sin(theta_r) * std::cos(phi), std::sin(theta_r) * std::sin(phi),
                           std::cos(theta_r)};
  const CDVector normal{0, 0, 1}, h = normalized(to_source + to_viewer);
  const double cos_beta = dot(h, to_source), cos_tilt = h.z;
  const Coefficients r = hecht(cos_beta, n, k);
  const Axes in = axes(-to_source, normal), facet_in = axes(-to_source, h);
  const Axes out = axes(to_viewer, normal), facet_out = axes(to_viewer, h);
  const auto element = [&](const CDVector& to, const CDVector& from) {
    return r.rs * dot(to, facet_out.s) * dot(facet_in.s, from) +
           r.rp * dot(to, facet_out.p) * dot(facet_in.p, from);
  };
  Matrix m = muellerOf(
      {element(out.s, in.s), element(out.s, in.p), element(out.p, in.s), element(out.p, in.p)});
  const double tan2 = 1 / (cos_tilt * cos_tilt) - 1;
  double factor =
      std::exp(-tan2 / (2 * sigma * sigma)) /
      (8 * pi * sigma * sigma * std::pow(cos_tilt, 4) * std::cos(theta_i) * std::cos(theta_r));
  if (groove)
    factor *= std::min({1.0, 2 * cos_tilt * std::cos(theta_i) / cos_beta,
                        2 * cos_tilt * std::cos(theta_r) / cos_beta});
  for (double& x : m) x *= factor;
  return m;
}

// Rounding: the exponent of the Gaussian, up to about 100 in the cases below, magnifies that of
// the half vector; rotations of rays within a degree of the normal magnify it by 60.
constexpr double rounding = 1e-12;

double angle(int low_tenths, int high_tenths) {
  return *rc::gen::inRange(low_tenths, high_tenths + 1) * 0.1 * degree;
}
double fraction() { return *rc::gen::inRange(1, 1000) / 1000.0; }

const std::vector<double> four_bands{450, 550, 650, 750};
CDSpectralVector<double> spectrum(const SpectralGridPtr& grid,
                                  const std::vector<double>& values) {
  CDSpectralVector<double> v(grid);
  for (std::size_t i = 0; i < values.size(); ++i) v[i] = values[i];
  return v;
}

/// A metal whose parameters all vary, with a change of roughness after the second band.
BRDFTorranceSparrow varied(const SpectralGridPtr& grid, TorranceSparrowOptions options) {
  return BRDFTorranceSparrow(spectrum(grid, {0.4, 1.5, 0.2, 1.3}),
                             spectrum(grid, {2.9, 0, 3.4, 7.5}),
                             spectrum(grid, {0.2, 0.2, 0.3, 0.15}), options);
}
}  // namespace

// Finding 1 of the inventory; the digits it prints, half a unit of the last as tolerance.
TEST(BRDFTorranceSparrowPublished, ThePlateOfSection71) {
  const auto plate = BRDFGeometry::fromDegrees(30, 40, 180);
  const CDMuellerMatrix f = BRDFTorranceSparrow(0.405, 2.950, 0.2, specular_only).at(plate);
  EXPECT_NEAR(f.getMueller(0, 0), 1.17187, 5e-6);
  EXPECT_NEAR(f.getMueller(1, 1), 1.17187, 5e-6);
  EXPECT_NEAR(f.getMueller(0, 1), 0.040058, 5e-7);
  EXPECT_NEAR(f.getMueller(1, 0), 0.040058, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 2), -1.131418, 5e-7);
  EXPECT_NEAR(f.getMueller(3, 3), -1.131418, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 3), 0.302611, 5e-7);
  EXPECT_NEAR(f.getMueller(3, 2), -0.302611, 5e-7);
  for (const auto& [i, j] :
       {std::pair{0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 0}, {2, 1}, {3, 0}, {3, 1}})
    EXPECT_NEAR(f.getMueller(i, j), 0, 1e-15) << i << j;  // sin 180 degrees is 1.2e-16
}

// Eq 7.8 and finding 3: the diffuse term at the viewer's 40 degrees is .0085, at the sun's 30,
// .0044.
TEST(BRDFTorranceSparrowPublished, TheDiffuseTermOfSection71) {
  const BRDFTorranceSparrow copper(0.405, 2.950, 0.2);
  const auto diffuse = [&](double theta_i, double theta_r) {
    const CDMuellerMatrix f = copper.at(BRDFGeometry::fromDegrees(theta_i, theta_r, 180));
    return f.getMueller(0, 0) - f.getMueller(1, 1);
  };
  EXPECT_NEAR(diffuse(30, 40), 0.0085, 5e-5);
  EXPECT_NEAR(diffuse(40, 30), 0.0044, 5e-5);
  EXPECT_NEAR(copper.at(BRDFGeometry::fromDegrees(30, 40, 180)).getScalar(), 1.18, 5e-3);
}

RC_GTEST_PROP(BRDFTorranceSparrowIdentity, AllSixteenElementsAgreeWithFieldVectors, ()) {
  const double theta_i = angle(10, 890), theta_r = angle(10, 890), phi = angle(0, 3599);
  const double n = 0.2 + 3 * fraction(), k = *rc::gen::inRange(0, 2) * 5 * fraction();
  const double sigma = 0.1 + 0.5 * fraction();
  const Matrix expected = reference(theta_i, theta_r, phi, n, k, sigma);
  const auto f = BRDFTorranceSparrow(n, k, sigma, specular_only)
                     .at(BRDFGeometry::fromAngles(theta_i, theta_r, phi));
  const double f00 = expected[0];
  RC_PRE(f00 > 1e-40);
  // near the critical angle of a thin medium the coefficients go as the root of the distance to
  // it
  const double slack = k == 0 && n < 1 ? 1e4 : 1;
  RC_ASSERT(largestDifference(elements(f), expected) <= 200 * slack * rounding * f00);
}

TEST(BRDFTorranceSparrowIdentity, NegativeControlAnotherTiltIsNoticed) {
  const auto f = elements(BRDFTorranceSparrow(1.3, 7.5, 0.2, specular_only)
                              .at(BRDFGeometry::fromAngles(0.5, 0.7, 2.5)));
  EXPECT_LT(largestDifference(f, reference(0.5, 0.7, 2.5, 1.3, 7.5, 0.2)), 1e-12);
  EXPECT_GT(largestDifference(f, reference(0.5, 0.7, 2.5 + 1e-6, 1.3, 7.5, 0.2)), 1e-9);
  EXPECT_GT(largestDifference(f, reference(0.5, 0.7, -2.5, 1.3, 7.5, 0.2)),
            1e-3);  // S2 turns its sign
}

TEST(BRDFTorranceSparrowIdentity, WithoutShadowingTheGrooveFactorIsMissing) {
  const auto f = BRDFTorranceSparrow(1.3, 7.5, 0.2, with(Shadowing::none, DiffuseTerm::none))
                     .at(BRDFGeometry::fromAngles(0.5, 1.4, 3.0));
  const Matrix bare = reference(0.5, 1.4, 3.0, 1.3, 7.5, 0.2, false);
  EXPECT_NEAR(f.getScalar() / bare[0], 1, 1e-12);  // rounding, as above
  EXPECT_LT(reference(0.5, 1.4, 3.0, 1.3, 7.5, 0.2)[0], 0.9 * bare[0]);
}

// Smith's factor is a product of Lambda functions of both directions: at least as large
// uncorrelated.
TEST(BRDFTorranceSparrowIdentity, SmithsShadowingIsBetweenZeroAndOne) {
  for (const double theta : {0.1, 0.8, 1.3, 1.5}) {
    const auto g = BRDFGeometry::fromAngles(theta, theta, pi);
    const auto f00 = [&](Shadowing s) {
      return BRDFTorranceSparrow(1.3, 7.5, 0.4, with(s, DiffuseTerm::none)).at(g).getScalar();
    };
    EXPECT_LE(f00(Shadowing::smith), f00(Shadowing::smithCorrelated));
    EXPECT_LE(f00(Shadowing::smithCorrelated), f00(Shadowing::none));
    EXPECT_GT(f00(Shadowing::smith), 0);
    if (theta > 1) {
      EXPECT_LT(f00(Shadowing::smith), 0.99 * f00(Shadowing::smithCorrelated));
      EXPECT_LT(f00(Shadowing::smithCorrelated), 0.99 * f00(Shadowing::none));
    }
  }
}

TEST(BRDFTorranceSparrowIdentity, NormalIncidence) {
  const auto f =
      BRDFTorranceSparrow(2, 0, 0.2, specular_only).at(BRDFGeometry::fromDegrees(0, 0, 0));
  const double expected = (1.0 / 9) / (8 * pi * 0.04);  // R = ((n-1)/(n+1))^2, D(0)/4
  EXPECT_NEAR(f.getMueller(0, 0), expected, 1e-14);
  EXPECT_NEAR(f.getMueller(0, 1), 0, 1e-15);
  EXPECT_NEAR(std::abs(f.getMueller(1, 1)), expected,
              1e-14);                                 // the azimuth of s is free at the normal,
  EXPECT_NEAR(f.getMueller(3, 3), -expected, 1e-14);  // the handedness is not: it reverses
  const auto near = BRDFTorranceSparrow(2, 0, 0.2, specular_only)
                        .at(BRDFGeometry::fromDegrees(1e-6, 1e-6, 180));
  EXPECT_NEAR(near.getMueller(0, 0), expected, 1e-12);  // second order in 2e-8 rad
  EXPECT_NEAR(near.getMueller(2, 2), -expected, 1e-12);
}

TEST(BRDFTorranceSparrowIdentity, TotalReflectionReflectsAllAndRetards) {
  // beta = 60 degrees on the mean facet; the critical angle of n = .7 is 44.4 degrees
  const auto g = BRDFGeometry::fromDegrees(60, 60, 180);
  const Matrix f = elements(BRDFTorranceSparrow(0.7, 0, 0.2, specular_only).at(g));
  const double factor =
      reference(60 * degree, 60 * degree, pi, 1.0, 1e9, 0.2)[0];  // a perfect mirror
  EXPECT_NEAR(f[0] / factor, 1, 1e-8);  // the mirror of k = 1e9 lacks 4/k
  EXPECT_NEAR(f[1], 0, 1e-14 * f[0]);
  EXPECT_NEAR(std::hypot(f[10], f[11]) / f[0], 1, 1e-14);
  EXPECT_GT(std::abs(f[11]), 0.1 * f[0]);
}

TEST(BRDFTorranceSparrowIdentity, CircularElementsVanishExactlyWithoutAbsorption) {
  const auto g = BRDFGeometry::fromDegrees(10, 50, 180);
  EXPECT_EQ(BRDFTorranceSparrow(1.7, 0, 0.2).at(g).getMueller(2, 3), 0);
  const auto absorbing = BRDFTorranceSparrow(1.7, 0.01, 0.2).at(g);
  EXPECT_NE(absorbing.getMueller(2, 3), 0);
  EXPECT_EQ(absorbing.getMueller(3, 2), -absorbing.getMueller(2, 3));
}

TEST(BRDFTorranceSparrowIdentity, GrazingIsFiniteAndTheHorizonIsDark) {
  for (const auto options : {specular_only, as_thesis, reciprocal}) {
    const BRDFTorranceSparrow metal(1.3, 7.5, 0.3, options);
    for (const double theta_r : {89.0, 89.999, 90 - 1e-9}) {
      const double f00 = metal.at(BRDFGeometry::fromDegrees(45, theta_r, 180)).getScalar();
      EXPECT_TRUE(std::isfinite(f00));
      EXPECT_GT(f00, 0);
    }
    for (const double theta_r : {90.0001, 120.0, 180.0})
      EXPECT_EQ(elements(metal.at(BRDFGeometry::fromDegrees(45, theta_r, 180))), Matrix{});
    EXPECT_EQ(elements(metal.at(BRDFGeometry::fromDegrees(91, 20, 180))), Matrix{});
  }
}

TEST(BRDFTorranceSparrowIdentity, ANaNShows) {
  const auto f =
      BRDFTorranceSparrow(1.3, 7.5, 0.3).at(BRDFGeometry::fromAngles(0.3, not_a_number, 0));
  EXPECT_TRUE(std::isnan(f.getScalar()));
}

TEST(BRDFTorranceSparrowIdentity, AVerySmoothSurfaceIsDefined) {
  for (const double sigma : {1e-2, 1e-4, 1e-8}) {
    const BRDFTorranceSparrow mirror(1.5, 0, sigma);
    const double peak = mirror.at(BRDFGeometry::fromDegrees(0, 0, 0)).getScalar();
    EXPECT_NEAR(peak * 8 * pi * sigma * sigma, 0.04, 1e-9);  // the diffuse term adds less
    const double off = mirror.at(BRDFGeometry::fromDegrees(30, 40, 180)).getScalar();
    EXPECT_GE(off, 0);
    EXPECT_LT(off, 1e-5);
  }
}

RC_GTEST_PROP(BRDFTorranceSparrowIdentity, FastScatteringEqualsTheMatrixTimesTheVector, ()) {
  static const auto grid = SpectralGrid::make(four_bands);
  const auto diffuse =
      *rc::gen::element(DiffuseTerm::none, DiffuseTerm::thesis, DiffuseTerm::reciprocal);
  const auto model =
      varied(grid, with(Shadowing::vGroove, diffuse, *rc::gen::arbitrary<bool>()));
  const auto g = BRDFGeometry::fromAngles(angle(0, 890), angle(0, 890), angle(0, 3599));
  CDSpectralVector<CDStokesVector> in(grid), fast(grid), plain(grid);
  for (std::size_t band = 0; band < 4; ++band) {
    const double s0 = fraction();
    if (*rc::gen::arbitrary<bool>())
      in[band] = CDStokesVector(s0, 0.5 * s0 * fraction(), -0.5 * s0 * fraction(),
                                0.5 * s0 * fraction());
    else
      in[band] = CDStokesVector(s0);
    if (*rc::gen::arbitrary<bool>()) {
      fast[band] = CDStokesVector(1, 0.1, 0.2, 0.3);
      plain[band] = CDStokesVector(1, 0.1, 0.2, 0.3);
    }
  }
  model.scatter(g, 0.7, in, fast);
  model.CDBRDFModel::scatter(g, 0.7, in, plain);
  const auto f = model.getBRDF(g);
  for (std::size_t band = 0; band < 4; ++band)
    for (int i = 0; i < 4; ++i)  // sums of at most nine terms of at most f00
      RC_ASSERT(std::abs(fast.at(band).getStokes(i) - plain.at(band).getStokes(i)) <=
                1e-14 * (1 + f.at(band).getScalar()));
}

TEST(BRDFTorranceSparrowIdentity, ScatterAddsAndNegativeControl) {
  const auto grid = SpectralGrid::make(four_bands);
  const auto model = varied(grid, as_thesis);
  const auto g = BRDFGeometry::fromDegrees(30, 40, 170);
  const CDSpectralVector<CDStokesVector> in(grid, CDStokesVector(1, 0.5, 0.2, 0.1));
  CDSpectralVector<CDStokesVector> once(grid), twice(grid);
  model.scatter(g, 2, in, once);
  model.scatter(g, 1, in, twice);
  EXPECT_GT(std::abs(once.at(0).getScalar() - twice.at(0).getScalar()), 1e-3);  // not yet
  model.scatter(g, 1, in, twice);
  for (std::size_t band = 0; band < 4; ++band)
    for (int i = 0; i < 4; ++i)  // one rounding of a sum
      EXPECT_NEAR(once.at(band).getStokes(i), twice.at(band).getStokes(i), 1e-14);
}

TEST(BRDFTorranceSparrowIdentity, SinglePrecisionKernelsAgree) {
  const auto facet = facetGeometry(BRDFGeometry::fromDegrees(30, 50, 160));
  const auto shared = [&](auto real) {
    using Real = decltype(real);
    const auto r = [](double x) { return static_cast<Real>(x); };
    return FacetLight<Real>{
        r(1.1),         r(0.01),        r(facet.cos_beta), r(facet.sin2_beta),
        r(facet.cos2i), r(facet.sin2i), r(facet.cos2r),    r(facet.sin2r)};
  };
  constexpr std::size_t n = 37;  // not a multiple of any vector length
  std::vector<double> e1(n), e2(n), in(4 * n), out(4 * n);
  for (std::size_t j = 0; j < n; ++j) {
    const double index = 0.5 + 0.05 * static_cast<double>(j),
                 k = 0.1 * static_cast<double>(j % 5);
    e1[j] = index * index - k * k, e2[j] = 2 * index * k;
    for (std::size_t c = 0; c < 4; ++c)
      in[c * n + j] = c == 0 ? 1 : 0.1 * static_cast<double>(c + j % 3);
  }
  const std::vector<float> e1f(e1.begin(), e1.end()), e2f(e2.begin(), e2.end()),
      inf(in.begin(), in.end());
  std::vector<float> outf(4 * n);
  scatterPolarized(shared(0.0), n, e1.data(), e2.data(), in.data(), out.data(), n);
  scatterPolarized(shared(0.0f), n, e1f.data(), e2f.data(), inf.data(), outf.data(), n);
  for (std::size_t j = 0; j < 4 * n; ++j)
    // 24 bits, about twenty operations, no cancellation beyond a factor of ten
    EXPECT_NEAR(outf[j], out[j], 3e-6) << j;
}

TEST(BRDFTorranceSparrowIdentity, TheUnpolarisedModelIsF00) {
  const auto grid = SpectralGrid::make(four_bands);
  const auto g = BRDFGeometry::fromDegrees(30, 40, 150);
  const auto scalar =
      varied(grid, with(Shadowing::vGroove, DiffuseTerm::thesis, false)).getBRDF(g);
  const auto full = varied(grid, as_thesis).getBRDF(g);
  EXPECT_FALSE(scalar.anyPolarized());
  for (std::size_t band = 0; band < 4; ++band)
    EXPECT_NEAR(scalar.at(band).getScalar(), full.at(band).getScalar(),
                1e-15 * full.at(band).getScalar() + 1e-17);
}

// Bands are independent: a spectrum of four is four models of one band.
TEST(BRDFTorranceSparrowInvariant, BandsDoNotMix) {
  const auto grid = SpectralGrid::make(four_bands);
  const auto g = BRDFGeometry::fromDegrees(20, 60, 140);
  const auto all = varied(grid, reciprocal).getBRDF(g);
  const double n[]{0.4, 1.5, 0.2, 1.3}, k[]{2.9, 0, 3.4, 7.5}, sigma[]{0.2, 0.2, 0.3, 0.15};
  for (std::size_t band = 0; band < 4; ++band) {
    const auto one = BRDFTorranceSparrow(n[band], k[band], sigma[band], reciprocal).at(g);
    EXPECT_LT(largestDifference(elements(all.at(band)), elements(one)),
              1e-14);  // vector and scalar code
    EXPECT_LT(largestDifference(elements(varied(grid, reciprocal).at(g, band)), elements(one)),
              1e-14);
  }
  EXPECT_THROW(varied(grid, reciprocal).at(g, 4), std::out_of_range);
}

RC_GTEST_PROP(BRDFTorranceSparrowInvariant, EveryMatrixIsRealizable, ()) {
  const auto options = *rc::gen::element(specular_only, as_thesis, reciprocal);
  const auto f =
      BRDFTorranceSparrow(0.2 + 3 * fraction(), 5 * fraction(), 0.05 + 0.5 * fraction(),
                          options)
          .at(BRDFGeometry::fromAngles(angle(0, 890), angle(0, 890), angle(0, 3599)));
  RC_ASSERT(
      isRealizable(f, 1e-12 * (1 + f.getScalar())));  // eigenvalues of a 4x4 matrix, rounding
}

// Reciprocity (eq 7.4's prose; the signs are derived in the chapter on CDBRDFModel).
namespace {
double reciprocityError(const BRDFTorranceSparrow& model, double theta_i, double theta_r,
                        double phi, const std::array<double, 4>& q) {
  const Matrix forth = elements(model.at(BRDFGeometry::fromAngles(theta_i, theta_r, phi)));
  const Matrix back = elements(model.at(BRDFGeometry::fromAngles(theta_r, theta_i, -phi)));
  Matrix expected;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) expected[4 * i + j] = q[i] * back[4 * j + i] * q[j];
  return largestDifference(forth, expected) / forth[0];
}
constexpr std::array<double, 4> q_right{1, 1, -1, 1}, q_wrong{1, 1, 1, -1};
}  // namespace

RC_GTEST_PROP(BRDFTorranceSparrowInvariant, Reciprocity, ()) {
  const double theta_i = angle(10, 890), theta_r = angle(10, 890), phi = angle(0, 3599);
  const auto shadowing = *rc::gen::element(Shadowing::none, Shadowing::vGroove);
  const auto diffuse = *rc::gen::element(DiffuseTerm::none, DiffuseTerm::reciprocal);
  const BRDFTorranceSparrow model(0.2 + 3 * fraction(), 5 * fraction(), 0.1 + 0.5 * fraction(),
                                  with(shadowing, diffuse));
  RC_PRE(model.at(BRDFGeometry::fromAngles(theta_i, theta_r, phi)).getScalar() > 1e-40);
  RC_ASSERT(reciprocityError(model, theta_i, theta_r, phi, q_right) <= 200 * rounding);
}

TEST(BRDFTorranceSparrowInvariant, ReciprocityIsBrokenByTheThesisTermAndByWrongSigns) {
  const BRDFTorranceSparrow honest(1.3, 7.5, 0.3, reciprocal), thesis(1.3, 7.5, 0.3, as_thesis);
  EXPECT_LT(reciprocityError(honest, 0.3, 1.2, 2.0, q_right), 1e-12);
  EXPECT_GT(reciprocityError(honest, 0.3, 1.2, 2.0, q_wrong), 0.01);
  EXPECT_GT(reciprocityError(thesis, 0.3, 1.2, 2.0, q_right), 0.01);  // claim C4
}

TEST(BRDFTorranceSparrowInvariant, TheDiffuseTermKnowsNothingOfTheMetal) {  // claim C3
  const auto g = BRDFGeometry::fromDegrees(20, 70, 90);
  const auto diffuse = [&](double n, double k) {
    return BRDFTorranceSparrow(n, k, 0.3).at(g).getScalar() -
           BRDFTorranceSparrow(n, k, 0.3, specular_only).at(g).getScalar();
  };
  EXPECT_NEAR(diffuse(1.5, 0), diffuse(0.4, 3), 1e-15);  // rounding of a difference
  EXPECT_GT(diffuse(1.5, 0), 0.01);
}

TEST(BRDFTorranceSparrowIdentity, TheRemainderIsThatOfTheDHRChapter) {
  const DHRTorranceSparrow dhr;
  for (const double sigma : {0.01, 0.0507, 0.2, 0.35, 0.6, 0.7}) {
    const BRDFTorranceSparrow model(1.5, 0, sigma);
    const double mean = BRDFTorranceSparrow(1.5, 0, sigma).getDHR(0)[0] -
                        BRDFTorranceSparrow(1.5, 0, sigma, specular_only).getDHR(0)[0];
    EXPECT_NEAR(mean, 1 - dhr.getAverage(sigma), 1e-9)
        << sigma;  // two quadratures of one polygon
    for (double theta = 0; theta < 89.9; theta += 0.37) {
      const auto g = BRDFGeometry::fromDegrees(20, theta, 90);
      const double d = model.at(g).getScalar() -
                       BRDFTorranceSparrow(1.5, 0, sigma, specular_only).at(g).getScalar();
      // the same polygon; a sum with the specular term rounds
      if (sigma <= 0.6)
        EXPECT_NEAR(d * pi, dhr.getRemainder(theta * degree, sigma),
                    1e-13 + 1e-15 * model.at(g).getScalar())
            << sigma << ' ' << theta;
      else  // straight lines between nodes against the quadrature itself
        EXPECT_NEAR(d * pi, dhr.getRemainder(theta * degree, sigma), 1e-5)
            << sigma << ' ' << theta;
    }
  }
}

// Energy: with the reciprocal term at most everything comes back, at every angle and roughness.
TEST(BRDFTorranceSparrowInvariant, EnergyIsConservedWithTheReciprocalTerm) {
  const auto grid = SpectralGrid::make({450.0, 550.0});
  const auto n = spectrum(grid, {1, 0.405}),
             k = spectrum(grid, {1e6, 2.95});  // a mirror, and copper
  const auto check = [&](double sigma, Shadowing shadowing) {
    const BRDFTorranceSparrow model(n, k, CDSpectralVector<double>(grid, sigma),
                                    with(shadowing, DiffuseTerm::reciprocal));
    for (const double theta : {0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9}) {
      const auto dhr = model.getDHR(theta * degree);
      EXPECT_NEAR(dhr[0], 1, 2e-5)
          << sigma << ' ' << theta;  // the table of the remainder: 1e-5
      EXPECT_LE(dhr[1], 1 + 1e-5);
      EXPECT_GT(dhr[1], 0.5);
    }
  };
  for (const double sigma : {0.01, 0.05, 0.1, 0.2, 0.4, 0.6}) check(sigma, Shadowing::vGroove);
  for (const double sigma : {0.05, 0.5}) check(sigma, Shadowing::smith);
  check(0.3, Shadowing::smithCorrelated);
}

TEST(BRDFTorranceSparrowInvariant, TheThesisTermCreatesEnergy) {
  // grazing light loses nothing to the facets, and gets the diffuse term on top
  EXPECT_GT(BRDFTorranceSparrow(1, 1e6, 0.4, as_thesis).getDHR(1.57)[0], 1.01);
}

// The quadrature over slopes against the plain product rule of the base class, which shares
// nothing with it.
TEST(BRDFTorranceSparrowIdentity, DHRAgreesWithThePlainIntegration) {
  const auto grid = SpectralGrid::make(four_bands);
  for (const auto options :
       {specular_only, as_thesis, reciprocal, with(Shadowing::smith, DiffuseTerm::none)}) {
    const BRDFTorranceSparrow model(spectrum(grid, {0.4, 1.5, 0.2, 1.3}),
                                    spectrum(grid, {2.9, 0, 3.4, 7.5}),
                                    CDSpectralVector<double>(grid, 0.4), options);
    for (const double theta : {0.0, 0.3, 0.9, 1.3}) {
      const auto fine = model.getDHR(theta), plain = model.CDBRDFModel::getDHR(theta);
      for (std::size_t band = 0; band < 4;
           ++band)  // the plain rule does not see the kinks of G
        EXPECT_NEAR(fine[band], plain[band], 2e-4) << theta << ' ' << band;
    }
  }
}

// A mirror's DHR, against the quadratures of the DHR chapter: other coordinates, other rules, and for
// V-grooves the integral of what is missing. Tolerances: the accuracy that the chapter states.
TEST(BRDFTorranceSparrowIdentity, DHROfAMirrorAgreesWithTheDHRChapter) {
  for (const double sigma : {0.001, 0.01, 0.05, 0.2, 0.4, 0.6, 1.0})
    for (const double theta : {0.0, 10.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9}) {
      const auto dhr = [&](Shadowing s) {
        const BRDFTorranceSparrow mirror(1, 1e10, sigma, with(s, DiffuseTerm::none));
        return mirror.getDHR(theta * degree)[0];
      };
      const double groove = dhr(Shadowing::vGroove);
      EXPECT_NEAR(groove, DHRTorranceSparrow::integrate(theta * degree, sigma), 1e-8)
          << sigma << ' ' << theta;
      if (sigma > 0.1) {
        EXPECT_NEAR(dhr(Shadowing::smith),
                    DHRTorranceSparrow::integrate(theta * degree, sigma, Shadowing::smith),
                    1e-6)
            << sigma << ' ' << theta;
      }
      if (sigma > 0.1 && theta == 60) {  // negative control: another roughness
        EXPECT_GT(
            std::abs(groove - DHRTorranceSparrow::integrate(theta * degree, 1.001 * sigma)),
            1e-6);
      }
    }
}

// Total reflection begins like a square root, on a separate curve: against midpoints on a fine
// grid of slopes.
TEST(BRDFTorranceSparrowIdentity, DHRKnowsWhereTotalReflectionBegins) {
  const double sigma = 0.3, theta = 70 * degree, n = 0.9;
  const double ci = std::cos(theta), si = std::sin(theta);
  constexpr int N = 1500;
  const double step = 8.5 * sigma / N;
  double sum = 0;
  for (int i = -N; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      const double p = (i + 0.5) * step, q = (j + 0.5) * step, s2 = p * p + q * q;
      const double b = ci + p * si, cos_alpha = 1 / std::sqrt(1 + s2);
      const double cos_r = 2 * b * cos_alpha * cos_alpha - ci;
      if (b <= 0 || cos_r <= 0) continue;
      const auto [rs, rp] = hecht(b * cos_alpha, n, 0);
      sum += std::exp(-s2 / (2 * sigma * sigma)) * std::min({b / ci, 2.0, 2 * cos_r / ci}) *
             0.5 * (std::norm(rs) + std::norm(rp));
    }
  sum *= 2 * step * step / (2 * pi * sigma * sigma);
  // midpoints across a root: about step^1.5 on a line of the area's length; the rule itself had 3e-3
  EXPECT_NEAR(BRDFTorranceSparrow(n, 0, sigma, specular_only).getDHR(theta)[0], sum, 3e-5);
}

TEST(BRDFTorranceSparrowIdentity, ScoreIsThatOfTheBaseClass) {
  const auto grid = SpectralGrid::make(four_bands);
  const auto model = varied(grid, as_thesis);
  for (const double phi : {0.0, 1.0, pi}) {
    const auto g = BRDFGeometry::fromAngles(0.5, 0.7, phi);
    EXPECT_NEAR(model.getScore(g), model.CDBRDFModel::getScore(g),
                1e-14 * (1 + model.getScore(g)));
  }
  EXPECT_EQ(model.getScore(BRDFGeometry::fromAngles(2, 0.7, 0)), 0);
}

// ---- the importance sampler
using malus::testing::draw;
using malus::testing::Drawn;

TEST(BRDFTorranceSparrowInvariant, SamplesFollowTheirDensity) {
  for (const double zenith : {0.0, 0.6, 1.2, 1.45}) {
    const BRDFTorranceSparrow model(0.405, 2.95, 0.3, reciprocal);
    const Drawn drawn = draw(model, model, zenith);
    EXPECT_GT(drawn.p_value, false_alarm) << zenith;
    // five standard errors of a fraction of 200,000, and 1e-3 for the midpoint rule
    EXPECT_NEAR(drawn.rejected + drawn.density_integral, 1, 5 * std::sqrt(0.25 / 200000) + 1e-3)
        << zenith;
  }
  const auto grid = SpectralGrid::make(four_bands);
  const auto mixed = varied(grid, as_thesis);
  EXPECT_GT(draw(mixed, mixed, 0.8).p_value, false_alarm);
}

// Without a diffuse term all draws go to the facets: at the mirror image the density of sigma = 0.1 is 1/(8 pi sigma^2 cos) by the
// lobe's two deviations, 2 sigma and 2 sigma cos; the cosine's is below 1/pi.
TEST(BRDFTorranceSparrowIdentity, FacetsAloneGetAllDraws) {
  const double sigma = 0.1, zenith = 0.5;
  TorranceSparrowOptions alone = reciprocal;
  alone.diffuse = DiffuseTerm::none;
  const BRDFTorranceSparrow model(1.5, 0, sigma, alone);
  const double lobe = 1 / (8 * pi * sigma * sigma * std::cos(zenith));
  const double density =
      model.density(CDVector::fromAngles(zenith, 0), CDVector::fromAngles(zenith, pi));
  EXPECT_NEAR(density / lobe, 1, 0.1);  // of order sigma^2 cot, and masking
  EXPECT_GT(lobe, 10 / pi) << "negative control: far from the cosine's";
}

TEST(BRDFTorranceSparrowInvariant, NegativeControlAnotherDensityIsNoticed) {
  const BRDFTorranceSparrow model(0.405, 2.95, 0.3, reciprocal),
      rougher(0.405, 2.95, 0.31, reciprocal);
  EXPECT_LT(draw(model, rougher, 0.6).p_value, false_alarm);
}

TEST(BRDFTorranceSparrowInvariant, SampleAndDensityTellTheSameNumber) {
  const auto grid = SpectralGrid::make(four_bands);
  const auto model = varied(grid, reciprocal);
  const CDVector given = CDVector::fromAngles(1.0, 2.0);
  Random random(3);
  int accepted = 0;
  for (int i = 0; i < 1000; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    const BRDFSample s = model.sample(given, u1, u2, u3);
    if (s.rejected()) continue;
    ++accepted;
    EXPECT_NEAR(s.direction.getLength(), 1, 1e-14);
    EXPECT_GT(s.direction.z, 0);
    EXPECT_NEAR(s.density_per_sr / model.density(given, s.direction), 1, 1e-9);
  }
  EXPECT_GT(accepted, 800);
}

// Integrating f cos with the sampler gives the DHR: density and matrix belong together.
TEST(BRDFTorranceSparrowInvariant, MonteCarloOfTheSamplerGivesTheDHR) {
  const BRDFTorranceSparrow model(0.405, 2.95, 0.2, reciprocal);
  for (const double zenith : {0.2, 1.0}) {
    const CDVector given = CDVector::fromAngles(zenith, 0.0);
    Random random(5);
    double sum = 0, squares = 0;
    constexpr int draws = 200000;
    for (int i = 0; i < draws; ++i) {
      const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
      const BRDFSample s = model.sample(given, u1, u2, u3);
      if (s.rejected()) continue;
      const double x = model.at(BRDFGeometry::fromDirections(given, s.direction)).getScalar() *
                       s.direction.z / s.density_per_sr;
      sum += x, squares += x * x;
    }
    const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
    EXPECT_LT(error, 1e-3);  // weights are nearly constant
    EXPECT_NEAR(mean, model.getDHR(zenith)[0], 5 * error) << zenith;  // five standard errors
  }
}

TEST(BRDFTorranceSparrowIdentity, ImpossibleSurfacesAreRefused) {
  for (const double bad : {-1.0, not_a_number, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(BRDFTorranceSparrow(bad, 1, 0.2), MathError);
    EXPECT_THROW(BRDFTorranceSparrow(1, bad, 0.2), MathError);
    EXPECT_THROW(BRDFTorranceSparrow(1, 1, bad), MathError);
  }
  EXPECT_THROW(BRDFTorranceSparrow(0, 0, 0.2), MathError);
  EXPECT_THROW(BRDFTorranceSparrow(1, 1, 0), MathError);
  const auto a = SpectralGrid::make(four_bands), b = SpectralGrid::make({450.0, 550.0});
  EXPECT_THROW(
      BRDFTorranceSparrow(CDSpectralVector<double>(a, 1.0), CDSpectralVector<double>(b, 1.0),
                          CDSpectralVector<double>(a, 0.2)),
      MathError);
  const auto model = varied(a, as_thesis);
  CDSpectralVector<CDStokesVector> other(b), mine(a);
  CDSpectralVector<CDMuellerMatrix> out(b);
  const auto g = BRDFGeometry::fromDegrees(30, 40, 180);
  EXPECT_THROW(model.scatter(g, 1, other, mine), MathError);
  EXPECT_THROW(model.scatter(g, 1, mine, other), MathError);
  EXPECT_THROW(model.evaluate(g, out), MathError);
  for (const double zenith : {-0.1, pi / 2, not_a_number})
    EXPECT_THROW(model.getDHR(zenith), MathError);
  EXPECT_THROW(model.sample(CDVector{0, 0, -1}, 0.5, 0.5, 0.5), MathError);
}
