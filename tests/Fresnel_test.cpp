// A smooth boundary against std::complex, Maxwell's boundary conditions and printed values
// (nw/surface/Fresnel.nw).
#include "malus/surface/Fresnel.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Dense>
#include <complex>
#include <numbers>
#include <vector>

#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"

using namespace malus;
using std::numbers::pi;
using Complex = std::complex<double>;

namespace {
struct Amplitudes {
  Complex rs, rp;
};

// Eqs 3.50, 3.51 as printed, theta_t from Snell's law with the complex index.
Amplitudes textbook(double theta, Complex N) {
  const double c = std::cos(theta), s = std::sin(theta);
  Complex Ncos_t = std::sqrt(N * N - s * s);
  if (Ncos_t.imag() < 0) Ncos_t = -Ncos_t;
  const Complex cos_t = Ncos_t / N;
  return {(c - N * cos_t) / (c + N * cos_t), (N * c - cos_t) / (cos_t + N * c)};
}

double worstDifference(const FresnelTerms<double>& f, const Amplitudes& r) {
  const double Rs = std::norm(r.rs), Rp = std::norm(r.rp);
  const Complex cross = r.rs * std::conj(r.rp);
  return std::max({std::abs(f.sum - (Rs + Rp) / 2), std::abs(f.diff - (Rs - Rp) / 2),
                   std::abs(f.re - cross.real()), std::abs(f.im - cross.imag())});
}

FresnelTerms<double> at(double theta, double n, double k) {
  const double s = std::sin(theta);
  return fresnelReflection(std::cos(theta), s * s, n * n - k * k, 2 * n * k);
}

// Maxwell's boundary conditions as four complex equations, solved for the reflected amplitudes
// with the frames {s,p,k} as vectors: E and H (~ wave vector x E) tangential to z = 0 continue.
Amplitudes boundaryConditions(double theta, Complex N) {
  using Vector = Eigen::Vector3cd;
  const double S = std::sin(theta), C = std::cos(theta);
  Complex w = std::sqrt(N * N - S * S);
  if (w.imag() < 0) w = -w;
  const Vector k_in(S, 0, -C), k_out(S, 0, C), k_through(S, 0, -w);
  const Vector s(0, 1, 0);  // z x k / |z x k|, the same for all three
  const auto cross = [](const Vector& a, const Vector& b) -> Vector {  // Eigen's own conjugates
    return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
            a.x() * b.y() - a.y() * b.x()};
  };
  const Vector p_in = cross(k_in, s), p_out = cross(k_out, s), p_through = cross(k_through, s);
  const auto tangential = [&](const Vector& k, const Vector& E) {
    const Vector H = cross(k, E);
    return Eigen::Vector4cd(E.x(), E.y(), H.x(), H.y());
  };
  Eigen::Matrix4cd
      unknowns;  // in + out = through, with columns out_s, out_p, through_s, through_p
  unknowns << -tangential(k_out, s), -tangential(k_out, p_out), tangential(k_through, s),
      tangential(k_through, p_through);
  const auto solver = unknowns.fullPivLu();
  return {solver.solve(tangential(k_in, s))(0), solver.solve(tangential(k_in, p_in))(1)};
}

struct Boundary {
  double theta, n, k;
};

Boundary anyBoundary() {
  return {*rc::gen::inRange(0, 9001) * 0.01 * degree, *rc::gen::inRange(50, 6000) * 1e-3,
          *rc::gen::inRange(0, 9000) * 1e-3};
}
}  // namespace

// Both sides round; amplitudes are of order one and the condition of Rp near grazing is about
// |e| <= 100, hence 100 times a few 1e-16.
constexpr double rounding = 1e-13;

RC_GTEST_PROP(FresnelIdentity, EqualsTheTextbookFormInComplexNumbers, ()) {
  const auto [theta, n, k] = anyBoundary();
  // within 1e-3 of a real index's critical angle the square root magnifies rounding
  RC_PRE(k > 0 || std::abs(std::sin(theta) - n) > 1e-3);
  RC_ASSERT(worstDifference(at(theta, n, k), textbook(theta, {n, k})) < rounding);
}

TEST(FresnelIdentity, NegativeControlTheOtherTimeConventionIsSeen) {
  EXPECT_GT(worstDifference(at(35 * degree, 0.405, 2.95),
                            {std::conj(textbook(35 * degree, {0.405, 2.95}).rs),
                             std::conj(textbook(35 * degree, {0.405, 2.95}).rp)}),
            0.1);
}

RC_GTEST_PROP(FresnelIdentity, SolvesMaxwellsBoundaryConditionsInTheFramesOfTheRays, ()) {
  const auto [theta, n, k] = anyBoundary();
  RC_PRE(k > 0 || std::abs(std::sin(theta) - n) > 1e-3);
  // the LU solution loses the condition number of a 4x4 system, below 1e4 here
  RC_ASSERT(worstDifference(at(theta, n, k), boundaryConditions(theta, {n, k})) < 1e-11);
}

TEST(FresnelIdentity, MatrixActsOnStokesVectorsAsTheAmplitudesActOnFields) {
  // S2 - i S3 = 2 Es Ep*: a field turning counter-clockwise for who looks back at the source,
  // s = cos wt, p = sin wt = Re (i e^{-iwt}), must have S3 > 0.
  const Complex Es = 1, turning = Complex(0, 1);
  EXPECT_GT(-(2. * Es * std::conj(turning)).imag(), 0);
  const double theta = 57 * degree;
  const Complex Ep(0.3, -0.7);
  const Amplitudes r = boundaryConditions(theta, {1.2, 3.4});
  const auto stokes = [](Complex s, Complex p) {
    const Complex cross = 2. * s * std::conj(p);
    return CDStokesVector(std::norm(s) + std::norm(p), std::norm(s) - std::norm(p),
                          cross.real(), -cross.imag());
  };
  const CDStokesVector seen = fresnelReflectionMatrix(theta, 1.2, 3.4) * stokes(Es, Ep);
  const CDStokesVector expected = stokes(r.rs * Es, r.rp * Ep);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(seen.getStokes(i), expected.getStokes(i), rounding);
}

TEST(FresnelIdentity, ExampleWorkedByHandInTheChapter) {
  const auto f = at(35 * degree, 0.405, 2.95);  // half a unit of the last digit printed there
  EXPECT_NEAR(f.sum, 0.8470, 5e-5);
  EXPECT_NEAR(f.diff, 0.0290, 5e-5);
  EXPECT_NEAR(f.re, -0.8178, 5e-5);
  EXPECT_NEAR(f.im, 0.2187, 5e-5);
}

TEST(FresnelIdentity, Eq376IsTheMatrixIfItsReflectedAngleIsTheRefractedOne) {
  for (const double n : {1.25, 1.5, 2.0}) {
    const double theta = 50 * degree, t = refractedAngle(theta, n);
    const double minus = theta - t, plus = theta + t;
    const double front = 0.5 * std::pow(std::tan(minus) / std::sin(plus), 2);
    const double cm = std::cos(minus), cp = std::cos(plus);
    const CDMuellerMatrix M = fresnelReflectionMatrix(theta, n);
    EXPECT_NEAR(M.getMueller(0, 0), front * (cm * cm + cp * cp), rounding);
    EXPECT_NEAR(M.getMueller(1, 0), front * (cm * cm - cp * cp), rounding);
    EXPECT_NEAR(M.getMueller(2, 2), front * -2 * cp * cm, rounding);
    EXPECT_NEAR(M.getMueller(3, 3), front * -2 * cp * cm, rounding);
    EXPECT_EQ(M.getMueller(2, 3), 0);
  }
}

TEST(FresnelIdentity, Eq378IsTheMatrixOfTransmission) {
  for (const double n : {1.25, 1.5, 2.0}) {
    const double theta = 50 * degree, t = refractedAngle(theta, n);
    const double cm = std::cos(theta - t), sp = std::sin(theta + t);
    const double front = std::sin(2 * theta) * std::sin(2 * t) / (2 * sp * sp * cm * cm);
    const CDMuellerMatrix M = fresnelTransmissionMatrix(theta, n);
    EXPECT_NEAR(M.getMueller(0, 0), front * (cm * cm + 1), rounding);
    EXPECT_NEAR(M.getMueller(0, 1), front * (cm * cm - 1), rounding);
    EXPECT_NEAR(M.getMueller(2, 2), front * 2 * cm, rounding);
    EXPECT_NEAR(M.getMueller(3, 3), front * 2 * cm, rounding);
  }
}

TEST(FresnelIdentity, NormalIncidenceKnowsNoPlane) {
  const auto f = at(0, 0.405, 2.95);
  const Complex N(0.405, 2.95);
  EXPECT_NEAR(f.sum, std::norm((1. - N) / (1. + N)), rounding);
  EXPECT_EQ(f.diff, 0);
  EXPECT_EQ(f.re, -f.sum);
  EXPECT_EQ(f.im, 0);
}

TEST(FresnelIdentity, GrazingIncidenceReflectsAllWhateverTheIndex) {
  for (const auto& [n, k] : {std::pair{1.5, 0.}, {1., 0.}, {0.5, 0.}, {0.405, 2.95}}) {
    const auto r = fresnelReflection(0., 1., n * n - k * k, 2 * n * k);
    EXPECT_EQ(r.sum, 1) << n;
    EXPECT_EQ(r.diff, 0) << n;
    EXPECT_EQ(r.re, 1) << n;
    EXPECT_EQ(r.im, 0) << n;
    EXPECT_EQ(fresnelTransmission(0., 1., n).sum, 0) << n;
  }
}

TEST(FresnelIdentity, NoBoundaryReflectsNothing) {
  const auto f = at(75 * degree, 1, 0);
  EXPECT_LT(f.sum, 1e-30);
  EXPECT_NEAR(fresnelTransmissionMatrix(75 * degree, 1).getScalar(), 1, rounding);
}

TEST(FresnelIdentity, TotalReflectionIsTotalAndAFieldOfPhaseOnly) {
  const double n = 1 / 1.51;
  for (const double theta_deg : {41.5, 45.0, 60.0, 89.0}) {
    const auto f = at(theta_deg * degree, n, 0);
    EXPECT_EQ(f.diff, 0);
    EXPECT_NEAR(f.sum, 1, 1e-15);
    EXPECT_NEAR(std::hypot(f.re, f.im), 1, 4e-16);
    EXPECT_EQ(fresnelTransmissionMatrix(theta_deg * degree, n),
              fresnelTransmissionMatrix(pi / 2, n) * 0.0);
  }
}

TEST(FresnelIdentity, ExactlyAtTheCriticalAngleBothRootsVanish) {
  // sin^2 = 1/4 = n^2 is exact in binary, so the square root is of exactly zero.
  const auto f = fresnelReflection(std::sqrt(0.75), 0.25, 0.25, 0.);
  EXPECT_EQ(f.sum, 1);
  EXPECT_EQ(f.diff, 0);
  EXPECT_EQ(f.re, 1);  // rs = 1, rp = 1
  EXPECT_EQ(f.im, 0);
}

TEST(FresnelIdentity, VanishingAbsorptionIsContinuous) {
  for (const double theta_deg : {10.0, 56.0, 80.0})
    for (const double n : {1.5, 0.5}) {
      if (std::abs(std::sin(theta_deg * degree) - n) < 0.01) continue;
      const auto f = at(theta_deg * degree, n, 0), g = at(theta_deg * degree, n, 1e-12);
      EXPECT_NEAR(f.sum, g.sum, 1e-10) << theta_deg << " " << n;  // slope in k is of order 10
      EXPECT_NEAR(f.re, g.re, 1e-10);
      EXPECT_NEAR(f.im, g.im, 1e-10);
      EXPECT_GE(g.im, 0);
    }
}

TEST(FresnelIdentity, SmallAbsorptionKeepsItsDigits) {
  // b = e2/(2a) must not be lost in m - t: Im rs rp* is linear in k for small k.
  const double one = at(0.5, 1.5, 1e-9).im, ten = at(0.5, 1.5, 1e-8).im;
  EXPECT_NEAR(ten / one, 10, 1e-6);  // next order k^2 / k = 1e-8, times ten
}

TEST(FresnelIdentity, SinglePrecisionFollowsDouble) {
  for (int i = 0; i <= 90; ++i) {
    const double s = std::sin(i * degree), c = std::cos(i * degree);
    const auto wide = fresnelReflection(c, s * s, -8.538475, 2.3895);
    const auto narrow = fresnelReflection(float(c), float(s * s), -8.538475f, 2.3895f);
    EXPECT_NEAR(narrow.sum, wide.sum, 2e-6);  // some ten roundings of 6e-8, times |e|^(1/2)
    EXPECT_NEAR(narrow.diff, wide.diff, 2e-6);
    EXPECT_NEAR(narrow.re, wide.re, 2e-6);
    EXPECT_NEAR(narrow.im, wide.im, 2e-6);
  }
}

TEST(FresnelIdentity, BrewstersAngleLeavesOnlyTheSComponent) {
  for (const double n : {0.7, 1.33, 1.5, 2.0}) {
    const Reflectances R = fresnelReflectances(brewsterAngle(n), n);
    EXPECT_NEAR(R.Rp, 0, 1e-16);
    EXPECT_NEAR(R.dop(), 1, rounding);
    EXPECT_NEAR(brewsterAngle(n) + refractedAngle(brewsterAngle(n), n), pi / 2, 1e-15);
    EXPECT_NEAR(pseudoBrewsterAngle(n, 0), brewsterAngle(n), 1e-15);
  }
}

RC_GTEST_PROP(FresnelIdentity, PseudoBrewsterAngleHasTheLeastRp, ()) {
  const auto [unused, n, k] = anyBoundary();
  const double found = pseudoBrewsterAngle(n, k), least = fresnelReflectances(found, n, k).Rp;
  for (int i = 0; i <= 900; ++i)  // everywhere, so that no second minimum is missed
    RC_ASSERT(fresnelReflectances(i * 0.1 * degree, n, k).Rp >= least - 1e-15);
  const double x = std::pow(std::sin(found), 2), e1 = n * n - k * k;
  const double e = n * n + k * k;  // |e|
  // The cubic that the literature prints, terms divided by |e|^2; near a real index the sine of
  // the phase that it represents is of order k, and so are the terms that it was divided by.
  RC_ASSERT(
      std::abs((1 - x) * (1 - x) * e * e - (3 - 2 * x) * x * x + 2 * e1 / (e * e) * x * x * x) <
      1e-12 * (1 + e * e) / std::min(1., 2 * n * k + (k == 0)));
}

TEST(FresnelIdentity, RefusesWhatIsNoBoundary) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fresnelReflectionMatrix(-0.1, 1.5), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(1.6, 1.5), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(nan, 1.5), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(0.1, nan), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(0.1, -1.5), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(0.1, 1.5, -1), MathError);
  EXPECT_THROW(fresnelReflectionMatrix(0.1, 0, 0), MathError);
  EXPECT_THROW(fresnelTransmissionMatrix(0.1, 0), MathError);
  EXPECT_THROW(refractedAngle(1.0, 0.5), MathError);
  EXPECT_THROW(criticalAngle(1.5), MathError);
  EXPECT_THROW(brewsterAngle(0), MathError);
  EXPECT_THROW(pseudoBrewsterAngle(0, 1), MathError);
  EXPECT_TRUE(std::isnan(at(nan, 1.5, 0).sum));  // the inner loop passes a NaN on
}

RC_GTEST_PROP(FresnelInvariant, ReflectedAndTransmittedPowerAddToOne, ()) {
  const double theta = *rc::gen::inRange(0, 9001) * 0.01 * degree;
  const double n = *rc::gen::inRange(100, 4000) * 1e-3;
  const CDMuellerMatrix R = fresnelReflectionMatrix(theta, n),
                        T = fresnelTransmissionMatrix(theta, n);
  RC_ASSERT(std::abs(R.getMueller(0, 0) + T.getMueller(0, 0) - 1) <
            1e-14);  // a dozen roundings
  RC_ASSERT(std::abs(R.getMueller(0, 1) + T.getMueller(0, 1)) < 1e-14);
}

TEST(FresnelInvariant, NegativeControlWithoutTheBeamsWidthPowerIsNotKept) {
  const double theta = 50 * degree, n = 1.5, t = refractedAngle(theta, n);
  const double ratio = n * std::cos(t) / std::cos(theta);
  const double T = fresnelTransmissionMatrix(theta, n).getScalar() / ratio;  // |t|^2 alone
  EXPECT_GT(std::abs(fresnelReflectionMatrix(theta, n).getScalar() + T - 1), 0.1);
}

RC_GTEST_PROP(FresnelInvariant, ABoundaryIsRealisableAndDoesNotDepolarise, ()) {
  const auto [theta, n, k] = anyBoundary();
  const auto f = at(theta, n, k);
  RC_ASSERT(f.sum <= 1 + 1e-15);
  RC_ASSERT(f.im >= 0);
  // Rs Rp = |rs rp*|^2
  RC_ASSERT(std::abs(f.sum * f.sum - f.diff * f.diff - f.re * f.re - f.im * f.im) < 1e-14);
  RC_ASSERT(isRealizable(fresnelReflectionMatrix(theta, n, k), 1e-12));
}

TEST(FresnelPublished, FresnelsRhombOfIndex151) {
  // Born & Wolf, sec. 1.5.4: n = 1.51, each total reflection retards by 45 deg at 48 deg 37' or
  // 54 deg 37'; the largest retardation is 45 deg 56', at 51 deg 20'. Printed to the minute;
  // the retardation changes by less than a third of a minute for each minute of the angle.
  const double n = 1 / 1.51;
  const auto retardation_deg = [&](double theta_deg) {
    const auto f = at(theta_deg * degree, n, 0);
    return std::atan2(f.im, f.re) / degree;
  };
  EXPECT_NEAR(retardation_deg(48 + 37 / 60.), 45, 0.6 / 60);
  EXPECT_NEAR(retardation_deg(54 + 37 / 60.), 45, 0.6 / 60);
  EXPECT_NEAR(retardation_deg(51 + 20 / 60.), 45 + 56 / 60., 0.6 / 60);
  EXPECT_GT(std::abs(retardation_deg(49 + 37 / 60.) - 45), 0.6 / 60);  // negative control
}

TEST(FresnelPublished, TheFactsOfFigure39) {
  // thesis sec. 3.2.1.3: n = 2, DoP nonzero except at normal and grazing, 1 at Brewster's angle
  EXPECT_EQ(fresnelReflectances(0, 2).dop(), 0);
  EXPECT_NEAR(fresnelReflectances(pi / 2, 2).dop(), 0, 1e-15);
  EXPECT_NEAR(fresnelReflectances(std::atan(2.0), 2).dop(), 1, rounding);
  for (int i = 1; i < 90; ++i) EXPECT_GT(fresnelReflectances(i * degree, 2).dop(), 0);
}

TEST(FresnelPublished, GlassAtNormalIncidenceReflectsFourPercent) {
  // Hecht, sec. 4.6.3: n = 1.5, R = 4 %; exactly ((1.5 - 1)/(1.5 + 1))^2.
  EXPECT_NEAR(fresnelReflectances(0, 1.5).Rs, 0.04, 1e-16);
}

TEST(FresnelRegression, NegativeControlAndOurFormerNumbers) {
  const auto f = at(35 * degree, 0.405, 2.95);
  EXPECT_NEAR(f.im / f.sum, 0.302611 / 1.17187, 2e-6);  // the inventory's six digits
  EXPECT_GT(std::abs(at(36 * degree, 0.405, 2.95).im / f.sum - 0.302611 / 1.17187), 2e-6);
}
