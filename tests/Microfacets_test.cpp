// Geometry of the facets against frames built as vectors, their statistics against integrals,
// the sampler against chi-squared (nw/surface/Microfacets.nw).
#include "malus/surface/Microfacets.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <bit>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "ChiSquared.hpp"
#include "malus/base/Angles.hpp"
#include "malus/surface/Fresnel.hpp"

using namespace malus;
using std::numbers::pi;
using Complex = std::complex<double>;
using Vector = Eigen::Vector3d;
using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;

namespace {
CDMuellerMatrix rotation(double cos2, double sin2) {
  return CDMuellerMatrix({1, 0, 0, 0, 0, cos2, sin2, 0, 0, -sin2, cos2, 0, 0, 0, 0, 1});
}

// What the chapter says a facet's Mueller matrix is, put together from its parts.
CDMuellerMatrix facetMatrix(const BRDFGeometry& g, double n, double k) {
  const FacetGeometry facet = facetGeometry(g);
  const auto f = fresnelReflection(facet.cos_beta, facet.sin2_beta, n * n - k * k, 2 * n * k);
  const CDMuellerMatrix M(
      {f.sum, f.diff, 0, 0, f.diff, f.sum, 0, 0, 0, 0, f.re, f.im, 0, 0, -f.im, f.re});
  return rotation(facet.cos2r, facet.sin2r) * M * rotation(facet.cos2i, facet.sin2i);
}

// The same by fields in space: the frames of both rays and of the facet as vectors, amplitudes
// by eqs 3.50, 3.51 in complex numbers, Stokes vectors of four incident states.
struct Frame {
  Vector s, p;
};
Frame frameOf(const Vector& k, const Vector& normal) {
  const Vector s = normal.cross(k).normalized();
  return {s, k.cross(s)};
}

CDMuellerMatrix byFields(double theta_i, double theta_r, double phi_i, double phi, double n,
                         double kappa) {
  const auto direction = [](double theta, double azimuth) {
    return Vector(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                  std::cos(theta));
  };
  const Vector i = direction(theta_i, phi_i), r = direction(theta_r, phi_i + phi);
  const Vector m = (i + r).normalized(), up(0, 0, 1), k_in = -i, k_out = r;
  const Frame macro_in = frameOf(k_in, up), macro_out = frameOf(k_out, up);
  const Frame facet_in = frameOf(k_in, m), facet_out = frameOf(k_out, m);
  const Complex N(n, kappa);
  const double c = i.dot(m);
  const Complex w = std::sqrt(N * N - (1 - c * c));
  const Complex rs = (c - w) / (c + w), rp = (N * N * c - w) / (N * N * c + w);
  const auto stokes_out = [&](Complex Es, Complex Ep) {
    const Eigen::Vector3cd E =
        Es * macro_in.s.cast<Complex>() + Ep * macro_in.p.cast<Complex>();
    const auto along = [](const Vector& axis, const Eigen::Vector3cd& field) {
      return axis.x() * field.x() + axis.y() * field.y() + axis.z() * field.z();
    };
    const Eigen::Vector3cd R = rs * along(facet_in.s, E) * facet_out.s.cast<Complex>() +
                               rp * along(facet_in.p, E) * facet_out.p.cast<Complex>();
    const Complex s = along(macro_out.s, R), p = along(macro_out.p, R),
                  cross = 2. * s * std::conj(p);
    return std::array{std::norm(s) + std::norm(p), std::norm(s) - std::norm(p), cross.real(),
                      -cross.imag()};
  };
  const double half = std::sqrt(0.5);
  const auto h = stokes_out(1, 0), v = stokes_out(0, 1), d = stokes_out(half, half);
  const auto right = stokes_out(half, Complex(0, half));
  std::array<double, 16> rows;
  for (std::size_t row = 0; row < 4; ++row) {
    const double mean = (h[row] + v[row]) / 2;
    rows[4 * row] = mean;
    rows[4 * row + 1] = (h[row] - v[row]) / 2;
    rows[4 * row + 2] = d[row] - mean;
    rows[4 * row + 3] = right[row] - mean;
  }
  return CDMuellerMatrix(rows);
}

double worst(const CDMuellerMatrix& a, const CDMuellerMatrix& b) {
  double most = 0;
  for (int e = 0; e < 16; ++e) {
    const double d = std::abs(a.data()[e] - b.data()[e]);
    if (!(d <= most)) most = d;  // a NaN is kept
  }
  return most;
}

struct Angles {
  double theta_i, theta_r, phi;
};
Angles anyAngles() {
  return {*rc::gen::inRange(0, 8999) * 0.01 * degree,
          *rc::gen::inRange(0, 8999) * 0.01 * degree,
          *rc::gen::inRange(0, 36000) * 0.01 * degree};
}
}  // namespace

// Sixteen elements, each of some fifty roundings; the reference normalises m x k, which loses
// 1/sin(beta) digits, so both rays are kept a degree apart.
RC_GTEST_PROP(MicrofacetsIdentity, RotationsEqualFieldsTracedThroughFramesInSpace, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  RC_PRE(theta_i > 0 && theta_r > 0);
  RC_PRE(facetGeometry(BRDFGeometry::fromAngles(theta_i, theta_r, phi)).sin2_beta > 1e-4);
  const double azimuth = *rc::gen::inRange(0, 36000) * 0.01 * degree;
  const CDMuellerMatrix seen =
      facetMatrix(BRDFGeometry::fromAngles(theta_i, theta_r, phi), 0.405, 2.95);
  RC_ASSERT(worst(seen, byFields(theta_i, theta_r, azimuth, phi, 0.405, 2.95)) < 1e-12);
}

TEST(MicrofacetsIdentity, NegativeControlTheOtherSenseOfAzimuthIsSeen) {
  const auto g = BRDFGeometry::fromAngles(0.5, 0.9, 2.0);
  EXPECT_LT(worst(facetMatrix(g, 0.405, 2.95), byFields(0.5, 0.9, 0, 2.0, 0.405, 2.95)), 1e-12);
  EXPECT_GT(worst(facetMatrix(g, 0.405, 2.95), byFields(0.5, 0.9, 0, -2.0, 0.405, 2.95)), 0.05);
}

RC_GTEST_PROP(MicrofacetsIdentity, AnglesOfTheFacetEqualThoseOfVectors, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  const auto g = BRDFGeometry::fromAngles(theta_i, theta_r, phi);
  const FacetGeometry facet = facetGeometry(g);
  const Vector i(g.sin_i, 0, g.cos_i), r(g.sin_r * g.cos_phi, g.sin_r * g.sin_phi, g.cos_r);
  const Vector m = (i + r).normalized();
  RC_ASSERT(std::abs(facet.cos_beta - i.dot(m)) < 1e-13);
  RC_ASSERT(std::abs(facet.sin2_beta - (i - r).squaredNorm() / 4) < 1e-15);
  RC_ASSERT(std::abs(facet.cos_alpha - m.z()) < 1e-12);  // |i + r| is as small as 2e-4
  const double tan2 = (m.x() * m.x() + m.y() * m.y()) / (m.z() * m.z());
  RC_ASSERT(std::abs(facet.tan2_alpha - tan2) <= 1e-9 * (1 + tan2));
}

TEST(MicrofacetsIdentity, BackToTheSourceIsNormalIncidenceWithoutRotation) {
  for (const double theta : {0.0, 0.3, 1.2}) {
    const CDMuellerMatrix M =
        facetMatrix(BRDFGeometry::fromAngles(theta, theta, 0), 0.405, 2.95);
    const double R = M.getScalar();
    const CDMuellerMatrix expected({R, 0, 0, 0, 0, R, 0, 0, 0, 0, -R, 0, 0, 0, 0, -R});
    EXPECT_LT(worst(M, expected), 1e-15) << theta;
  }
}

TEST(MicrofacetsIdentity, NearlyBackToTheSourceTheRotationsKeepTheirDigits) {
  // Within 1e-12 rad of the source the two rotations carry errors of 1e-4 each; only their
  // difference counts, and the matrix is that of exact return up to 1e-12 / tan(theta).
  std::mt19937_64 random(20020607);
  std::uniform_real_distribution<double> any(-1e-12, 1e-12);
  const CDMuellerMatrix exact = facetMatrix(BRDFGeometry::fromAngles(0.7, 0.7, 0), 0.405, 2.95);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto g = BRDFGeometry::fromAngles(0.7, 0.7 + any(random), any(random));
    ASSERT_LT(worst(facetMatrix(g, 0.405, 2.95), exact), 1e-11);
  }
}

TEST(MicrofacetsIdentity, VerticalDirectionsKeepTheFramesThatTheAzimuthGives) {
  // A vertical ray's frame is the limit of rays of the same azimuth: 1e-9 rad off, 1e-8 apart.
  for (const auto& [ti, tr] : {std::pair{0., 0.6}, {0.6, 0.}, {0., 0.}}) {
    const auto exact = facetMatrix(BRDFGeometry::fromAngles(ti, tr, 1.1), 1.3, 7.5);
    const auto near = facetMatrix(
        BRDFGeometry::fromAngles(ti + (ti == 0) * 1e-9, tr + (tr == 0) * 2e-9, 1.1), 1.3, 7.5);
    EXPECT_LT(worst(exact, near), 1e-8) << ti << " " << tr;
  }
}

TEST(MicrofacetsIdentity, GrazingDirectionsOppositeEachOther) {
  const auto g = BRDFGeometry::fromDegrees(90, 90, 180);
  const FacetGeometry facet = facetGeometry(g);
  EXPECT_EQ(facet.cos_beta, 0);
  EXPECT_EQ(facet.sin2_beta, 1);
  EXPECT_EQ(facet.cos_alpha, 1);
  EXPECT_EQ(facet.tan2_alpha, 0);
  EXPECT_LT(worst(facetMatrix(g, 0.405, 2.95), CDMuellerMatrix({1, 0, 0, 0, 0, 1, 0, 0,  //
                                                                0, 0, 1, 0, 0, 0, 0, 1})),
            1e-15);
  EXPECT_EQ(facetFactor(Shadowing::vGroove, g, facet, 0.2),
            std::numeric_limits<double>::infinity());
  // beside each other: a facet would have to be vertical, and there is none
  const auto beside = BRDFGeometry::fromDegrees(90, 90, 90);
  for (const auto kind : {Shadowing::none, Shadowing::vGroove, Shadowing::smith})
    EXPECT_EQ(facetFactor(kind, beside, facetGeometry(beside), 0.2), 0);
}

TEST(MicrofacetsIdentity, NearlyGrazingTiltKeepsItsDigits) {
  // 4e-7 and 1e-7 rad above the horizon: tilt = half the difference. The sines hold their
  // difference of 7.5e-14 to 1.1e-16; from the cosine of the tilt not one digit would come
  // back.
  const auto g = BRDFGeometry{4e-7, 1 - 8e-14, 1e-7, 1 - 5e-15, -1, 0};
  EXPECT_NEAR(facetGeometry(g).tan2_alpha / std::pow(1.5e-7, 2), 1, 3e-3);
}

// The library's remquo gives the exact rest after whole quarter turns, ties, signs of zero and huge angles included. The bound: half a unit in the
// last place for the last sum, and three roundings of what is at most 0.103 of the whole, which may count double below a power of two.
TEST(MicrofacetsIdentity, DegreesAreReducedAsTheLibraryDoes) {
  using Long = long double;
  const auto expected = [](double deg) {
    int quarters = 0;
    const Long rest = std::remquo(deg, 90, &quarters) * (std::numbers::pi_v<Long> / 180);
    const Long c = std::cos(rest), s = std::sin(rest);
    const std::array<std::array<Long, 2>, 4> turned{{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
    return turned[quarters & 3];
  };
  const auto right = [](double ours, Long exact) {
    if (exact == 0) return ours == 0 && std::signbit(ours) == std::signbit(exact);
    const double unit = std::nextafter(std::abs(static_cast<double>(exact)), 2.0) -
                        std::abs(static_cast<double>(exact));
    return std::abs(static_cast<double>(ours - exact)) < 0.82 * unit;
  };
  std::mt19937_64 random(90);
  std::vector<double> angles{0.0, -0.0, 45, -45, 135, -135, 180, -180, 1e9, 1e300, 5e-324};
  for (int i = -1000; i <= 1000; ++i)
    for (const double near :
         {i * 45.0, std::nextafter(i * 45.0, 1e9), std::nextafter(i * 45.0, -1e9)})
      angles.push_back(near);
  for (int i = 0; i < 100000; ++i)
    angles.push_back(std::uniform_real_distribution(-1e4, 1e4)(random));
  for (const double deg : angles) {
    const auto g = BRDFGeometry::fromDegrees(0, 0, deg);
    ASSERT_TRUE(right(g.cos_phi, expected(deg)[0])) << deg;
    ASSERT_TRUE(right(g.sin_phi, expected(deg)[1])) << deg;
  }
  // negative controls: another sign of a zero, another last place
  EXPECT_FALSE(right(BRDFGeometry::fromDegrees(0, 0, -180).sin_phi, expected(180)[1]));
  EXPECT_FALSE(right(std::nextafter(0.5, 1), expected(30)[1]));
}

TEST(MicrofacetsIdentity, DegreesAreExactAtQuarterTurns) {
  const auto g = BRDFGeometry::fromDegrees(0, 90, -180);
  EXPECT_EQ(g.cos_i, 1);
  EXPECT_EQ(g.sin_i, 0);
  EXPECT_EQ(g.cos_r, 0);
  EXPECT_EQ(g.sin_r, 1);
  EXPECT_EQ(g.cos_phi, -1);
  EXPECT_EQ(g.sin_phi, 0);
  for (const double phi : {-350.0, -100.0, 10.0, 100.0, 190.0, 280.0, 730.0}) {
    const auto h = BRDFGeometry::fromDegrees(20, 70, phi);
    EXPECT_NEAR(h.cos_phi, std::cos(phi * degree), 1e-14);  // 730 deg rounds to 1e-15 rad
    EXPECT_NEAR(h.sin_phi, std::sin(phi * degree), 1e-14);
  }
}

RC_GTEST_PROP(MicrofacetsIdentity, DirectionsGiveTheSameGeometryAsAngles, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  RC_PRE(theta_i > 0 && theta_r > 0);
  const double azimuth = *rc::gen::inRange(0, 36000) * 0.01 * degree;
  const auto g = BRDFGeometry::fromDirections(CDVector::fromAngles(theta_i, azimuth),
                                              CDVector::fromAngles(theta_r, azimuth + phi));
  const auto h = BRDFGeometry::fromAngles(theta_i, theta_r, phi);
  RC_ASSERT(std::abs(g.cos_i - h.cos_i) + std::abs(g.sin_i - h.sin_i) < 1e-14);
  RC_ASSERT(std::abs(g.cos_r - h.cos_r) + std::abs(g.sin_r - h.sin_r) < 1e-14);
  RC_ASSERT(std::abs(g.cos_phi - h.cos_phi) + std::abs(g.sin_phi - h.sin_phi) < 1e-14);
}

TEST(MicrofacetsIdentity, GroovesHideFromSixtyDegreesPlusAThirdOn) {
  for (const double theta_i : {10.0, 30.0, 45.0}) {
    const auto G = [&](double theta_r) {
      const auto g = BRDFGeometry::fromDegrees(theta_i, theta_r, 180);
      const auto facet = facetGeometry(g);
      return shadowing(Shadowing::vGroove, facet.cos_alpha, facet.cos_beta, g.cos_i, g.cos_r,
                       0.2);
    };
    const double onset = 60 + theta_i / 3;
    EXPECT_EQ(G(onset - 0.01), 1);
    EXPECT_LT(G(onset + 0.01), 1);
    EXPECT_NEAR(G(90), 0, 1e-15);
  }
}

TEST(MicrofacetsIdentity, SmithSeesWhatTheProjectedFacetsLeave) {
  // Facets that face the viewer cover 1 + Lambda of what the mean surface covers: an integral
  // over slopes that does not use the error function.
  for (const double sigma : {0.05, 0.2, 0.6})
    for (const double theta : {0.1, 1.0, 1.5}) {
      const double t = std::tan(theta);
      const auto facing = [&](double x) {
        return std::max(0., 1 + sigma * x * t) * std::exp(-x * x / 2) / std::sqrt(2 * pi);
      };
      const double kink = std::max(-9., -1 / (sigma * t));
      const double area = Quadrature::integrate(facing, kink, 9., 12, 1e-13);
      const double G1 = shadowing(Shadowing::smith, 1, 1, std::cos(theta), 1, sigma);
      EXPECT_NEAR(G1 * area, 1, 1e-12) << sigma << " " << theta;  // quadrature
      // with the viewer at the zenith nothing is hidden from him, and both Smiths agree
      EXPECT_NEAR(shadowing(Shadowing::smithCorrelated, 1, 1, std::cos(theta), 1, sigma), G1,
                  1e-15);
    }
}

RC_GTEST_PROP(MicrofacetsIdentity, FactorIsTheDensityTimesShadowingOverCosines, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  const auto g = BRDFGeometry::fromAngles(theta_i, theta_r, phi);
  const auto facet = facetGeometry(g);
  for (const auto kind :
       {Shadowing::none, Shadowing::vGroove, Shadowing::smith, Shadowing::smithCorrelated}) {
    const double G = shadowing(kind, facet.cos_alpha, facet.cos_beta, g.cos_i, g.cos_r, 0.3);
    const double expected = gaussianSlopes(facet.tan2_alpha, 0.3) * G / (4 * g.cos_i * g.cos_r);
    RC_ASSERT(G >= 0 && G <= 1 + 1e-15);
    RC_ASSERT(std::abs(facetFactor(kind, g, facet, 0.3) - expected) <= 1e-13 * expected);
  }
}

TEST(MicrofacetsIdentity, FactorIsFiniteForAGrazingViewer) {
  const auto grazing = BRDFGeometry::fromDegrees(45, 90, 180);
  const auto nearly = BRDFGeometry::fromDegrees(45, 90 - 1e-7, 180);
  for (const auto kind : {Shadowing::vGroove, Shadowing::smith, Shadowing::smithCorrelated}) {
    const double factor = facetFactor(kind, grazing, facetGeometry(grazing), 0.3);
    EXPECT_GT(factor, 0);
    EXPECT_NEAR(facetFactor(kind, nearly, facetGeometry(nearly), 0.3) / factor, 1, 1e-6);
  }
  const auto below = BRDFGeometry::fromDegrees(45, 91, 180);
  EXPECT_EQ(facetFactor(Shadowing::vGroove, below, facetGeometry(below), 0.3), 0);
}

TEST(MicrofacetsIdentity, VerySmallRoughnessStaysFinite) {
  const auto g = BRDFGeometry::fromDegrees(30, 30, 180);
  EXPECT_NEAR(
      facetFactor(Shadowing::vGroove, g, facetGeometry(g), 1e-6) * 8 * pi * 1e-12 * 0.75, 1,
      1e-9);  // tilt 1e-16 against sigma 1e-6
  const auto off = BRDFGeometry::fromDegrees(30, 31, 180);
  EXPECT_EQ(facetFactor(Shadowing::vGroove, off, facetGeometry(off), 1e-6), 0);
}

TEST(MicrofacetsInvariant, FacetsCoverTheSurfaceOnce) {
  for (const double sigma : {0.01, 0.2, 0.6}) {
    const auto covered = [&](double alpha) {
      return gaussianSlopes(std::pow(std::tan(alpha), 2), sigma) * std::cos(alpha) * 2 * pi *
             std::sin(alpha);
    };
    const double far = std::atan(9 * sigma);
    EXPECT_NEAR(Quadrature::integrate(covered, 0., far, 15, 1e-13), 1, 1e-12);
    EXPECT_GT(std::abs(Quadrature::integrate(covered, 0., far / 9, 15, 1e-13) - 1), 1e-12);
  }
}

RC_GTEST_PROP(MicrofacetsInvariant, ReversingLightTransposesTheMatrix, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  const auto forth = BRDFGeometry::fromAngles(theta_i, theta_r, phi);
  const auto back = BRDFGeometry::fromAngles(theta_r, theta_i, -phi);
  const CDMuellerMatrix M = facetMatrix(forth, 0.405, 2.95), B = facetMatrix(back, 0.405, 2.95);
  // reversing k turns s = z x k about and leaves p: S2 changes sign
  const std::array<double, 4> turn{1, 1, -1, 1};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      RC_ASSERT(std::abs(B.getMueller(i, j) - turn[i] * turn[j] * M.getMueller(j, i)) < 1e-12);
  for (const auto kind :
       {Shadowing::none, Shadowing::vGroove, Shadowing::smith, Shadowing::smithCorrelated}) {
    const double f = facetFactor(kind, forth, facetGeometry(forth), 0.3);
    RC_ASSERT(std::abs(facetFactor(kind, back, facetGeometry(back), 0.3) - f) <= 1e-12 * f);
  }
}

namespace {
// Probability that slopes drawn from the density of visible slopes, P max(0, min(u, 2)) with
// u = 1 + p tan(theta), p along the plane of incidence, deviate as much from it as these do; 12
// x 12 cells equally likely under P.
template <class Draw>
double chiSquared(double theta, double sigma, Draw draw) {
  constexpr std::size_t cells = 12, draws = 200000;
  const boost::math::normal gaussian;
  std::vector<std::size_t> counts(cells * cells);
  std::vector<double> shares;
  std::mt19937_64 random(1729);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t trial = 0; trial < draws; ++trial) {
    const double u1 = uniform(random), u2 = uniform(random), u3 = uniform(random);
    const CDVector m = draw(u1, u2, u3);
    const auto cell = [&](double slope) {
      return std::min(cells - 1,
                      static_cast<std::size_t>(cells * cdf(gaussian, slope / sigma)));
    };
    ++counts[cells * cell(m.x / m.z) + cell(m.y / m.z)];
  }
  for (std::size_t a = 0; a < cells; ++a) {
    const auto visible = [&](double x) {
      return std::clamp(1 + sigma * x * std::tan(theta), 0., 2.) * pdf(gaussian, x);
    };
    const double from = a == 0 ? -9 : quantile(gaussian, double(a) / cells);
    const double to = a == cells - 1 ? 9 : quantile(gaussian, double(a + 1) / cells);
    const double share = Quadrature::integrate(visible, from, to, 15, 1e-10) / cells;
    shares.insert(shares.end(), cells, share);
  }
  return malus::testing::chiSquaredPValue(counts, shares, draws);
}

// In each of the tests below; the seed is fixed, so a pass stays one.
constexpr double false_alarm = 1e-6;
}  // namespace

TEST(MicrofacetsInvariant, DrawnNormalsFollowTheirDensityByChiSquared) {
  for (const auto& [theta_deg, sigma] :
       {std::pair{0., 0.2}, {40., 0.2}, {75., 0.3}, {85., 0.6}, {89.9, 0.1}}) {
    const CDVector to_source = CDVector::fromAngles(theta_deg * degree, 0);
    const auto draw = [&, s = sigma](double u1, double u2, double u3) {
      return sampleVGrooveNormal(to_source, s, u1, u2, u3);
    };
    EXPECT_GT(chiSquared(theta_deg * degree, sigma, draw), false_alarm)
        << theta_deg << " deg, sigma " << sigma;
  }
}

TEST(MicrofacetsInvariant, NegativeControlChiSquaredSeesAWrongSampler) {
  const double theta = 40 * degree;
  const CDVector to_source = CDVector::fromAngles(theta, 0);
  const auto rougher = [&](double u1, double u2, double u3) {
    return sampleVGrooveNormal(to_source, 0.206, u1, u2, u3);  // 3 % too rough
  };
  EXPECT_LT(chiSquared(theta, 0.2, rougher), false_alarm);
  const auto unseen = [&](double u1, double u2, double) {
    return sampleVGrooveNormal({0, 0, 1}, 0.2, u1, u2, 0.5);  // never exchanged for the twin
  };
  EXPECT_LT(chiSquared(theta, 0.2, unseen), false_alarm);
}

TEST(MicrofacetsInvariant, DensityOfDrawnNormalsIsTheVisibleSlopesAndIntegratesToOne) {
  const double sigma = 0.3;
  for (const double theta_deg : {0.0, 50.0, 80.0, 89.0}) {
    const CDVector to_source = CDVector::fromAngles(theta_deg * degree, 0);
    const double t = std::tan(theta_deg * degree);
    double sum = 0;
    const double step = 0.02;  // midpoint sums of smooth Gaussians; the kinks leave 1e-4
    for (double x = -7 + step / 2; x < 7; x += step)
      for (double y = -7 + step / 2; y < 7; y += step) {
        const double p = sigma * x, q = sigma * y, length = std::sqrt(1 + p * p + q * q);
        const CDVector m{p / length, q / length, 1 / length};
        const double per_slope =
            vGrooveNormalDensity(to_source, m, sigma) / std::pow(length, 3);
        const double P = std::exp(-(x * x + y * y) / 2) / (2 * pi * sigma * sigma);
        ASSERT_NEAR(per_slope, P * std::clamp(1 + p * t, 0., 2.), 1e-12 * P * (1 + t));
        sum += per_slope * sigma * sigma * step * step;
      }
    EXPECT_NEAR(sum, 1, 1e-4) << theta_deg;
  }
}

RC_GTEST_PROP(MicrofacetsInvariant, ReflectionMapsTheDensityByFourCosines, ()) {
  const auto [theta_i, theta_r, phi] = anyAngles();
  const auto g = BRDFGeometry::fromAngles(theta_i, theta_r, phi);
  const auto facet = facetGeometry(g);
  RC_PRE(facet.cos_beta > 1e-3);
  const CDVector i{g.sin_i, 0, g.cos_i}, r{g.sin_r * g.cos_phi, g.sin_r * g.sin_phi, g.cos_r};
  const CDVector m = normalized(i + r);
  const double expected = vGrooveNormalDensity(i, m, 0.3) / (4 * facet.cos_beta);
  RC_ASSERT(std::abs(vGrooveReflectionDensity(g, facet, 0.3) - expected) <=
            1e-8 * expected + 1e-300);
}

TEST(MicrofacetsPublished, SpecularPartOfTheCopperPlate) {
  // thesis eq 7.8: theta_i 30, theta_r 40, phi 180, n .405, k 2.950, sigma .2; half a unit of
  // the last printed digit. f00 also holds the diffuse term, f33 is printed with the wrong
  // sign.
  const auto g = BRDFGeometry::fromDegrees(30, 40, 180);
  const auto facet = facetGeometry(g);
  const CDMuellerMatrix f =
      facetFactor(Shadowing::vGroove, g, facet, 0.2) * facetMatrix(g, 0.405, 2.95);
  EXPECT_NEAR(f.getMueller(0, 1), 0.04, 5e-3);
  EXPECT_NEAR(f.getMueller(1, 0), 0.04, 5e-3);
  EXPECT_NEAR(f.getMueller(1, 1), 1.172, 5e-4);
  EXPECT_NEAR(f.getMueller(2, 2), -1.131, 5e-4);
  EXPECT_NEAR(f.getMueller(2, 3), 0.3026, 5e-5);
  EXPECT_NEAR(f.getMueller(3, 2), -0.3026, 5e-5);
  EXPECT_NEAR(f.getMueller(3, 3), -1.131, 5e-4);
  for (const int zero : {2, 3, 6, 7, 8, 9, 12, 13}) EXPECT_EQ(f.data()[zero], 0);
}

TEST(MicrofacetsPublished, NegativeControlTheAngleNamedInTheTextGivesNothing) {
  // with theta = 35 deg, "the angle of incidence ... for the specular microfacets", in eq 5.7
  const double tan2 = std::pow(std::tan(35 * degree), 2);
  EXPECT_LT(gaussianSlopes(tan2, 0.2) / (4 * std::cos(30 * degree) * std::cos(40 * degree)),
            0.01);
}

TEST(MicrofacetsRegression, SixDigitsOfTheCopperPlate) {
  const auto g = BRDFGeometry::fromDegrees(30, 40, 180);
  const double factor = facetFactor(Shadowing::vGroove, g, facetGeometry(g), 0.2);
  EXPECT_NEAR(factor, 1.38352, 5e-6);  // the chapter's example
  const CDMuellerMatrix f = factor * facetMatrix(g, 0.405, 2.95);
  EXPECT_NEAR(f.getMueller(0, 0), 1.17187, 5e-6);
  EXPECT_NEAR(f.getMueller(0, 1), 0.040058, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 2), -1.131418, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 3), 0.302611, 5e-7);
  EXPECT_GT(std::abs((f * 1.001).getMueller(2, 3) - 0.302611), 5e-7);  // negative control
}
