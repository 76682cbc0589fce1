// Stokes vectors and Mueller matrices (nw/light/CDPolarimetricMath.nw, nw/light/LuChipman.nw), seen from outside:
// against plain 4x4 algebra, against electric fields traced in time, against Jones matrices,
// against print.
#include "malus/light/CDPolarimetricMath.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <numbers>
#include <sstream>
#include <vector>

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

using Four = std::array<double, 4>;
using Sixteen = std::array<double, 16>;

// ------------------------------------------------------------------ plain algebra to compare
// with
Four numbers(const CDStokesVector& s) {
  return {s.getStokes(0), s.getStokes(1), s.getStokes(2), s.getStokes(3)};
}
Sixteen numbers(const CDMuellerMatrix& m) {
  Sixteen all{};
  for (int i = 0; i < 16; ++i) all[i] = m.getMueller(i / 4, i % 4);
  return all;
}
Four plainProduct(const Sixteen& m, const Four& s) {
  Four out{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i] += m[4 * i + j] * s[j];
  return out;
}
Sixteen plainProduct(const Sixteen& a, const Sixteen& b) {
  Sixteen out{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) out[4 * i + j] += a[4 * i + k] * b[4 * k + j];
  return out;
}
template <std::size_t N>
bool agree(const std::array<double, N>& a, const std::array<double, N>& b, double tolerance) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [=](double x, double y) { return std::abs(x - y) <= tolerance; });
}
template <class T>
bool agree(const T& a, const T& b, double tolerance) {
  return agree(numbers(a), numbers(b), tolerance);
}

// ------------------------------------------------------------------ a field, traced in time
// A monochromatic beam coming towards the observer: x to the right, y up. Phases as
// eqs. 3.2, 3.3.
struct Field {
  double e0x, delta_x, e0y, delta_y;
  std::array<double, 2> at(double tau) const {
    return {e0x * std::cos(tau + delta_x), e0y * std::cos(tau + delta_y)};
  }
};

// Stokes parameters from what the tip of the field does: mean squares, and the area it sweeps
// counter-clockwise. Sampled at 64 instants of a period; averages of sinusoids are then exact.
CDStokesVector traced(const std::function<std::array<double, 2>(double)>& field) {
  const int samples = 64;
  const double step = 2.0 * pi / samples;
  double xx = 0, yy = 0, xy = 0, swept = 0;
  for (int i = 0; i < samples; ++i) {
    const auto [x, y] = field(i * step);
    const auto [next_x, next_y] = field((i + 1) * step);
    xx += x * x / samples, yy += y * y / samples, xy += x * y / samples;
    swept += (x * next_y - y * next_x) / samples;
  }
  return {2.0 * (xx + yy), 2.0 * (xx - yy), 4.0 * xy, 2.0 * swept / std::sin(step)};
}
CDStokesVector traced(const Field& f) {
  return traced([&](double tau) { return f.at(tau); });
}

// The field behind an element with axes at `angle`: the component along the axis passes with
// amplitude t_along and its clock put forward by `advance`, the one across with t_across.
std::function<std::array<double, 2>(double)> behind(const Field& f, double angle,
                                                    double t_along, double t_across,
                                                    double advance) {
  return [=](double tau) -> std::array<double, 2> {
    const double c = std::cos(angle), s = std::sin(angle);
    const auto [early_x, early_y] = f.at(tau + advance);
    const auto [x, y] = f.at(tau);
    const double along = t_along * (c * early_x + s * early_y);
    const double across = t_across * (c * y - s * x);
    return {c * along - s * across, s * along + c * across};
  };
}

// ------------------------------------------------------------------ Jones matrices
using Complex = std::complex<double>;
using Jones = std::array<Complex, 4>;  // row order

// m_ij = 1/2 trace(sigma_i T sigma_j T^+), written out with the 2x2 products.
CDMuellerMatrix muellerOf(const Jones& t) {
  const Complex i(0, 1);
  const std::array<Jones, 4> sigma{Jones{1, 0, 0, 1}, Jones{1, 0, 0, -1}, Jones{0, 1, 1, 0},
                                   Jones{0, -i, i, 0}};
  const auto times = [](const Jones& a, const Jones& b) {
    return Jones{a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3],
                 a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]};
  };
  const Jones dagger{std::conj(t[0]), std::conj(t[2]), std::conj(t[1]), std::conj(t[3])};
  Sixteen m;
  for (int r = 0; r < 4; ++r)
    for (int s = 0; s < 4; ++s) {
      const Jones product = times(times(sigma[r], t), times(sigma[s], dagger));
      m[4 * r + s] = 0.5 * (product[0] + product[3]).real();
    }
  return m;
}

// ------------------------------------------------------------------ arbitrary values
rc::Gen<double> numbersBetween(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1000001),
                      [=](int i) { return low + (high - low) * i * 1e-6; });
}
rc::Gen<double> angles() { return numbersBetween(-2.0 * pi, 2.0 * pi); }
rc::Gen<CDStokesVector> stokesVectors() {
  return rc::gen::apply(
      [](bool polarized, const std::vector<double>& v) {
        return polarized ? CDStokesVector(v[0], v[1], v[2], v[3]) : CDStokesVector(v[0]);
      },
      rc::gen::arbitrary<bool>(),
      rc::gen::container<std::vector<double>>(4, numbersBetween(-9, 9)));
}
rc::Gen<CDMuellerMatrix> muellerMatrices() {
  return rc::gen::apply(
      [](bool polarized, const std::vector<double>& v) {
        Sixteen all{};
        std::copy(v.begin(), v.end(), all.begin());
        return polarized ? CDMuellerMatrix(all) : CDMuellerMatrix(v[0]);
      },
      rc::gen::arbitrary<bool>(),
      rc::gen::container<std::vector<double>>(16, numbersBetween(-9, 9)));
}
rc::Gen<CDMuellerMatrix> jonesElements() {
  return rc::gen::map(rc::gen::container<std::vector<double>>(8, numbersBetween(-1, 1)),
                      [](const std::vector<double>& v) {
                        return muellerOf(Jones{Complex{v[0], v[1]}, Complex{v[2], v[3]},
                                               Complex{v[4], v[5]}, Complex{v[6], v[7]}});
                      });
}
// A mixture of two non-depolarising elements, with the second weight often zero.
rc::Gen<CDMuellerMatrix> realisableElements() {
  return rc::gen::apply(
      [](const CDMuellerMatrix& a, const CDMuellerMatrix& b, double w) { return a + w * b; },
      jonesElements(), jonesElements(),
      rc::gen::oneOf(rc::gen::just(0.0), numbersBetween(0, 1)));
}
rc::Gen<CDStokesVector> physicalStates() {
  return rc::gen::apply(
      [](double s0, double p, double chi, double psi) {
        const CDStokesVector pure = stokesFromEllipse(chi, psi);
        return s0 * ((1.0 - p) * random_light + p * pure);
      },
      numbersBetween(0.01, 100), numbersBetween(0, 1), numbersBetween(-pi / 4, pi / 4),
      angles());
}

// Rounding of a sum of four products of numbers up to 9, three products deep at the most:
// 4 * 9^3 * a dozen roundings of 1.1e-16 each.
constexpr double product_rounding = 1e-12 * 9;
// Rounding of cosines, sines and four-term sums of numbers of order one.
constexpr double rounding = 1e-14;
}  // namespace

// ================================================================== identity: mixed arithmetic

TEST(CDPolarimetricMathIdentity, TheDefaultIsNothingUnpolarised) {
  EXPECT_EQ(CDStokesVector(), CDStokesVector(0.0));
  EXPECT_EQ(CDMuellerMatrix(), CDMuellerMatrix(0.0));
  EXPECT_FALSE(CDStokesVector().isPolarized());
  EXPECT_FALSE(CDMuellerMatrix().isPolarized());
}

TEST(CDPolarimetricMathIdentity, EqualityComparesPromotedValues) {
  EXPECT_EQ(CDStokesVector(5.7), CDStokesVector(5.7, 0, 0, 0));
  EXPECT_NE(CDStokesVector(5.7), CDStokesVector(5.7, 0, 1e-300, 0));
  EXPECT_EQ(CDMuellerMatrix(2),
            CDMuellerMatrix({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2}));
  EXPECT_NE(CDMuellerMatrix(2),
            CDMuellerMatrix({2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3}));
  EXPECT_FALSE(CDStokesVector(not_a_number) == CDStokesVector(not_a_number));
  EXPECT_FALSE(CDMuellerMatrix(not_a_number) == CDMuellerMatrix(not_a_number));
}

TEST(CDPolarimetricMathIdentity, ArithmeticIsConstexpr) {
  constexpr CDStokesVector s(8, 6, 4, 2);
  constexpr CDMuellerMatrix m({1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4});
  static_assert(m * s + 2.0 == CDStokesVector(10, 12, 12, 8));
  static_assert((-s / 2.0).getStokes(1) == -3);
  static_assert(!(CDMuellerMatrix(2) * CDStokesVector(3)).isPolarized());
  static_assert((m * CDStokesVector(3)).isPolarized());
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, ScalingEqualsScalingTheFourNumbers, ()) {
  const CDStokesVector s = *stokesVectors();
  const double f = *numbersBetween(0.5, 9);
  Four scaled = numbers(s), divided = scaled;
  for (double& x : scaled) x *= f;
  for (double& x : divided) x /= f;
  RC_ASSERT(numbers(s * f) == scaled && numbers(f * s) == scaled && numbers(s / f) == divided);
  RC_ASSERT((s * f).isPolarized() == s.isPolarized());
  RC_ASSERT(-s == s * -1.0);
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, ScalingEqualsScalingTheSixteenNumbers, ()) {
  const CDMuellerMatrix m = *muellerMatrices();
  const double f = *numbersBetween(0.5, 9);
  Sixteen scaled = numbers(m), divided = scaled;
  for (double& x : scaled) x *= f;
  for (double& x : divided) x /= f;
  RC_ASSERT(numbers(m * f) == scaled && numbers(f * m) == scaled && numbers(m / f) == divided);
  RC_ASSERT((m / f).isPolarized() == m.isPolarized());
  RC_ASSERT(-m == m * -1.0);
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, SumsEqualPlainSumsAndArePolarisedIfATermIs, ()) {
  const CDStokesVector a = *stokesVectors(), b = *stokesVectors();
  const CDMuellerMatrix m = *muellerMatrices(), n = *muellerMatrices();
  for (int i = 0; i < 4; ++i) {
    RC_ASSERT((a + b).getStokes(i) == a.getStokes(i) + b.getStokes(i));
    RC_ASSERT((a - b).getStokes(i) == a.getStokes(i) - b.getStokes(i));
    for (int j = 0; j < 4; ++j) {
      RC_ASSERT((m + n).getMueller(i, j) == m.getMueller(i, j) + n.getMueller(i, j));
      RC_ASSERT((m - n).getMueller(i, j) == m.getMueller(i, j) - n.getMueller(i, j));
    }
  }
  RC_ASSERT((a + b).isPolarized() == (a.isPolarized() || b.isPolarized()));
  RC_ASSERT((m - n).isPolarized() == (m.isPolarized() || n.isPolarized()));
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, ProductsEqualPlainProducts, ()) {
  const CDStokesVector s = *stokesVectors();
  const CDMuellerMatrix a = *muellerMatrices(), b = *muellerMatrices();
  RC_ASSERT(agree(numbers(a * s), plainProduct(numbers(a), numbers(s)), product_rounding));
  RC_ASSERT(agree(numbers(a * b), plainProduct(numbers(a), numbers(b)), product_rounding));
  RC_ASSERT((a * s).isPolarized() == (a.isPolarized() || s.isPolarized()));
  RC_ASSERT((a * b).isPolarized() == (a.isPolarized() || b.isPolarized()));
  CDMuellerMatrix c = a;
  RC_ASSERT((c *= b) == a * b);
}

TEST(CDPolarimetricMathIdentity, NegativeControlTheOtherOrderIsAnotherProduct) {
  const CDMuellerMatrix a = linearPolarizer(0.3), b = retarder(1.0, 0.9);
  EXPECT_TRUE(agree(numbers(a * b), plainProduct(numbers(a), numbers(b)), rounding));
  EXPECT_FALSE(agree(numbers(b * a), plainProduct(numbers(a), numbers(b)), rounding));
}

TEST(CDPolarimetricMathIdentity, AnOperandMayBeTheResult) {
  CDStokesVector s(1, 2, 3, 4);
  s += s;
  EXPECT_EQ(s, CDStokesVector(2, 4, 6, 8));
  const CDStokesVector& itself = s;
  s -= itself;
  EXPECT_EQ(s, CDStokesVector(0));
  const CDMuellerMatrix m = retarder(1.0, 0.3) * linearPolarizer(0.2);
  CDMuellerMatrix square = m;
  square *= square;
  EXPECT_EQ(square, m * m);
}

TEST(CDPolarimetricMathIdentity, PromoteAndDemote) {
  CDStokesVector s(3);
  s.promote()[2] = 0.5;
  EXPECT_EQ(s, CDStokesVector(3, 0, 0.5, 0));
  EXPECT_TRUE(s.isPolarized());
  EXPECT_EQ(s.demote(), CDStokesVector(3));
  EXPECT_FALSE(s.isPolarized());
  CDMuellerMatrix m(3);
  m.promote()[6] = 0.5;
  EXPECT_TRUE(m.isPolarized());
  EXPECT_EQ(m.getMueller(1, 2), 0.5);
  EXPECT_EQ(m.demote(), CDMuellerMatrix(3));
  EXPECT_FALSE(m.isPolarized());
  EXPECT_EQ(idealDepolarizer().demote(), CDMuellerMatrix(1))
      << "what demotion of a matrix means";
}

// ================================================================== identity: what is
// undefined

TEST(CDPolarimetricMathIdentity, DivisionByZeroAndIndexOutOfRangeAreRefused) {
  CDStokesVector s(1, 0, 0, 0);
  CDMuellerMatrix m(1);
  EXPECT_THROW(s / 0.0, MathError);
  EXPECT_THROW(s / -0.0, MathError);
  EXPECT_THROW(m / 0.0, MathError);
  EXPECT_THROW(s /= 0.0, MathError);
  EXPECT_EQ(s, CDStokesVector(1)) << "a refused operation leaves its operand as it was";
  for (int i : {-1, 4, 1000}) {
    EXPECT_THROW(s.getStokes(i), std::out_of_range);
    EXPECT_THROW(m.getMueller(i, 0), std::out_of_range);
    EXPECT_THROW(m.getMueller(0, i), std::out_of_range);
  }
  EXPECT_THROW(circularPolarizer(0), MathError);
  try {
    m.getMueller(0, 4);
    FAIL();
  } catch (const std::out_of_range& error) {
    EXPECT_STREQ(error.what(), "Mueller matrix column 4 is outside 0..3");
  }
}

TEST(CDPolarimetricMathIdentity, InfinityAndNaNStayWhereTheyBelong) {
  const CDStokesVector s = CDStokesVector(2) * infinite;
  EXPECT_EQ(s.getStokes(0), infinite);
  EXPECT_EQ(s.getStokes(1), 0.0);
  const CDMuellerMatrix m = CDMuellerMatrix(2) * not_a_number;
  EXPECT_TRUE(std::isnan(m.getScalar()));
  EXPECT_EQ(m.getMueller(0, 1), 0.0);
  EXPECT_FALSE(s.isFinite());
  EXPECT_FALSE(m.isFinite());
  EXPECT_TRUE(CDStokesVector(1, 2, 3, 4).isFinite());
  EXPECT_TRUE(
      std::isnan((linearPolarizer(0) * CDStokesVector(1, not_a_number, 0, 0)).getScalar()));
}

TEST(CDPolarimetricMathIdentity, DegreesOfPolarisationOfStrangeValues) {
  EXPECT_EQ(CDStokesVector().getDOP(), 0.0);
  EXPECT_EQ(CDStokesVector(0, 0, 0, 0).getDOCP(), 0.0);
  EXPECT_EQ(CDStokesVector(0, 1, 0, 0).getDOP(), infinite);
  EXPECT_EQ(CDStokesVector(-0.0, 0, 1, 0).getDOLP(), infinite);
  EXPECT_EQ(CDStokesVector(0, 1, 0, 0).getDOCP(), 0.0);
  EXPECT_TRUE(std::isnan(CDStokesVector(-1).getDOP()));
  EXPECT_TRUE(std::isnan(CDStokesVector(-1, 0.5, 0, 0.5).getDOCP()));
  EXPECT_TRUE(std::isnan(CDStokesVector(1, not_a_number, 0, 0).getDOP()));
  EXPECT_TRUE(std::isnan(CDStokesVector(not_a_number).getDOP()));
  EXPECT_EQ(CDStokesVector(1, 2, 0, 0).getDOP(), 2.0) << "unphysical, but not hidden";
}

TEST(CDPolarimetricMathIdentity, PhysicalOrNot) {
  EXPECT_TRUE(CDStokesVector().isPhysical());
  EXPECT_TRUE(CDStokesVector(1, 0.6, 0, 0.8).isPhysical());
  EXPECT_FALSE(CDStokesVector(1, 0.6, 0, 0.81).isPhysical());
  EXPECT_TRUE(CDStokesVector(1, 0.6, 0, 0.81).isPhysical(0.01));
  EXPECT_FALSE(CDStokesVector(-1).isPhysical());
  EXPECT_FALSE(CDStokesVector(0, 0, 0, 1).isPhysical());
  EXPECT_FALSE(CDStokesVector(not_a_number).isPhysical());
  EXPECT_FALSE(CDStokesVector(infinite).isPhysical());
}

TEST(CDPolarimetricMathIdentity, PrintsTheStateItIsIn) {
  std::ostringstream out;
  out << CDStokesVector(8.7, 6.5, 4.3, 2.1) << CDStokesVector(5.7) << CDMuellerMatrix(2.5)
      << idealDepolarizer();
  EXPECT_EQ(out.str(),
            "(8.7, 6.5, 4.3, 2.1)(5.7)(2.5)"
            "((1, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0))");
}

// ================================================================== identity: light and
// elements

RC_GTEST_PROP(CDPolarimetricMathIdentity, AFieldsStokesVectorIsWhatItsTipDoes, ()) {
  const Field f{*numbersBetween(0, 2), *angles(), *numbersBetween(0, 2), *angles()};
  const CDStokesVector s = stokesFromField(f.e0x, f.e0y, f.delta_x - f.delta_y);
  RC_ASSERT(agree(s, traced(f), 1e-13));  // 64 samples of numbers below 8
  const Field mirrored{f.e0x, f.delta_y, f.e0y, f.delta_x};
  if (std::abs(s.getStokes(3)) > 1e-6) RC_ASSERT(!agree(s, traced(mirrored), 1e-6));
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, PolarisersAndRetardersActAsOnTracedFields, ()) {
  const Field f{*numbersBetween(0, 2), *angles(), *numbersBetween(0, 2), *angles()};
  const double angle = *angles(), retardance = *angles(), t = *numbersBetween(0, 1);
  const CDStokesVector s = traced(f);
  // 64 samples of numbers below 8, and the element's own cosines
  const double tolerance = 2e-13;
  RC_ASSERT(agree(linearPolarizer(angle) * s, traced(behind(f, angle, 1, 0, 0)), tolerance));
  RC_ASSERT(
      agree(diattenuator(1, t * t, angle) * s, traced(behind(f, angle, 1, t, 0)), tolerance));
  RC_ASSERT(agree(retarder(retardance, angle) * s, traced(behind(f, angle, 1, 1, retardance)),
                  tolerance));
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, TurnedAxesSeeATurnedField, ()) {
  const Field f{*numbersBetween(0, 2), *angles(), *numbersBetween(0, 2), *angles()};
  const double theta = *angles();
  const auto seen = [&](double tau) -> std::array<double, 2> {
    const auto [x, y] = f.at(tau);
    return {std::cos(theta) * x + std::sin(theta) * y,
            std::cos(theta) * y - std::sin(theta) * x};
  };
  CDStokesVector s = traced(f);
  RC_ASSERT(agree(rotationMatrix(theta) * s, traced(seen), 2e-13));  // as above
  RC_ASSERT(agree(s.rotate(theta), traced(seen), 2e-13));
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, EllipseParametersFulfilThesisEquations, ()) {
  const double e0x = *numbersBetween(0.1, 2), e0y = *numbersBetween(0.1, 2);
  const double delta = *numbersBetween(-3.1, 3.1);
  const Ellipse e = stokesFromField(e0x, e0y, delta).getEllipse();
  const double c = std::cos(e.psi_rad), s = std::sin(e.psi_rad),
               cross = 2 * e0x * e0y * std::cos(delta);
  // rounding of order-one numbers; b is the root of a difference, so it is compared squared
  RC_ASSERT(std::abs(std::tan(e.alpha_rad) * e0x - e0y) < 1e-13);  // 3.9
  RC_ASSERT(std::abs(e.delta_rad - delta) < 1e-13);                // 3.6
  RC_ASSERT(std::abs(std::sin(2 * e.psi_rad) * (e0x * e0x - e0y * e0y) -
                     std::cos(2 * e.psi_rad) * cross) < 1e-13);  // 3.16
  RC_ASSERT(std::abs(e.a * e.a - (e0x * e0x * c * c + e0y * e0y * s * s + cross * c * s)) <
            1e-13);  // 3.20
  RC_ASSERT(std::abs(e.b * e.b - (e0x * e0x * s * s + e0y * e0y * c * c - cross * c * s)) <
            1e-13);                                                                    // 3.21
  RC_ASSERT(std::abs(std::tan(e.chi_rad) * e.a - std::copysign(e.b, delta)) < 1e-13);  // 3.19
  RC_ASSERT(std::abs(std::sin(2 * e.chi_rad) -
                     std::sin(2 * e.alpha_rad) * std::sin(e.delta_rad)) < 1e-13);  // 3.22
  RC_ASSERT(e.psi_rad >= 0.0 && e.psi_rad < pi && e.a >= e.b);
}

RC_GTEST_PROP(CDPolarimetricMathIdentity, EllipseParametersGiveTheirStateBack, ()) {
  const CDStokesVector s = *physicalStates();
  const Ellipse e = s.getEllipse();
  const double polarized = s.getDOP() * s.getScalar();
  const CDStokesVector again = polarized * stokesFromEllipse(e.chi_rad, e.psi_rad);
  const CDStokesVector third = polarized * stokesFromAlphaDelta(e.alpha_rad, e.delta_rad);
  for (int i = 1; i < 4; ++i) {  // rounding of numbers up to 100
    RC_ASSERT(std::abs(again.getStokes(i) - s.getStokes(i)) < 1e-12);
    RC_ASSERT(std::abs(third.getStokes(i) - s.getStokes(i)) < 1e-12);
  }
  RC_ASSERT(std::abs(e.a * e.a + e.b * e.b - polarized) < 1e-12);
}

TEST(CDPolarimetricMathIdentity, AnglesAtTheSeams) {
  EXPECT_EQ(CDStokesVector(5).getAoLP(), 0.0);
  EXPECT_EQ(CDStokesVector(1, 0, 0, 1).getAoLP(), 0.0) << "circular: undetermined, so 0";
  EXPECT_EQ(CDStokesVector(1, -0.0, 0, 1).getAoLP(), 0.0);
  EXPECT_FALSE(std::signbit(CDStokesVector(1, 1, -0.0, 0).getAoLP())) << "would print as -0";
  EXPECT_EQ(CDStokesVector(1, -1, 0, 0).getAoLP(), pi / 2);
  EXPECT_EQ(CDStokesVector(1, -1, -0.0, 0).getAoLP(), pi / 2);
  EXPECT_EQ(CDStokesVector(1, 1, -1e-300, 0).getAoLP(), 0.0) << "just below pi rounds to 0";
  EXPECT_LT(CDStokesVector(1, 1, -1e-15, 0).getAoLP(), pi);
  EXPECT_TRUE(std::isnan(CDStokesVector(1, not_a_number, 0, 0).getAoLP()));
  const Ellipse none = CDStokesVector(5).getEllipse();
  EXPECT_EQ(none.a, 0.0);
  EXPECT_EQ(none.chi_rad, 0.0);
  EXPECT_EQ(none.delta_rad, 0.0);
}

TEST(CDPolarimetricMathIdentity, TheFourFiltersOfFigure35MeasureTheState) {
  const CDStokesVector s(8.7, 6.5, 4.3, 2.1);
  const double i0 = (neutralFilter(0.5) * s).getScalar();
  EXPECT_NEAR(2 * i0, 8.7, rounding);  // eqs. 3.23-3.26; rounding of numbers below 10
  EXPECT_NEAR(2 * ((linearPolarizer(0) * s).getScalar() - i0), 6.5, rounding);
  EXPECT_NEAR(2 * ((linearPolarizer(pi / 4) * s).getScalar() - i0), 4.3, rounding);
  EXPECT_NEAR(2 * ((circularPolarizer(+1) * s).getScalar() - i0), 2.1, rounding);
  EXPECT_GT(std::abs(2 * ((circularPolarizer(-1) * s).getScalar() - i0) - 2.1), 1.0)
      << "negative control: the left-hand filter measures -S3";
}

// ================================================================== invariants

RC_GTEST_PROP(CDPolarimetricMathInvariant, RotationsCompose, ()) {
  const double a = *angles(), b = *angles();
  RC_ASSERT(
      agree(rotationMatrix(a) * rotationMatrix(b), rotationMatrix(a + b), 1e-14));  // rounding
  RC_ASSERT(agree(rotationMatrix(a) * rotationMatrix(-a), CDMuellerMatrix(1), 1e-14));
  RC_ASSERT(agree(rotationMatrix(a).transposed(), rotationMatrix(-a), 0.0));
}

TEST(CDPolarimetricMathInvariant, NegativeControlRotationsDoNotComposeBackwards) {
  EXPECT_FALSE(agree(rotationMatrix(0.3) * rotationMatrix(-0.2), rotationMatrix(0.5), 1e-3));
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, ProductsAssociate, ()) {
  const CDMuellerMatrix a = *muellerMatrices(), b = *muellerMatrices(), c = *muellerMatrices();
  const CDStokesVector s = *stokesVectors();
  RC_ASSERT(
      agree((a * b) * c, a * (b * c), 16 * product_rounding));  // sums of 16 triple products
  RC_ASSERT(agree((a * b) * s, a * (b * s), 16 * product_rounding));
  RC_ASSERT((a * b).transposed() == b.transposed() * a.transposed() ||
            agree((a * b).transposed(), b.transposed() * a.transposed(), product_rounding));
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, PhysicsDoesNotDependOnTheAxes, ()) {
  CDMuellerMatrix m = *muellerMatrices();
  CDStokesVector s = *stokesVectors();
  const double theta = *angles();
  const CDStokesVector then_turned = (m * s).rotate(theta);
  const CDMuellerMatrix sandwich = rotationMatrix(theta) * m * rotationMatrix(-theta);
  m.rotate(theta);
  RC_ASSERT(agree(m, sandwich, product_rounding));
  s.rotate(theta);
  RC_ASSERT(agree(m * s, then_turned, 4 * product_rounding));
  RC_ASSERT(std::abs(s.getDOCP() - CDStokesVector(s).rotate(-theta).getDOCP()) <= 0.0 ||
            s.getScalar() < 0.0);
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, ElementsAtAnAngleAreTurnedElements, ()) {
  const double angle = *angles(), retardance = *angles();
  const auto turned = [&](CDMuellerMatrix m) {
    return rotationMatrix(-angle) * m * rotationMatrix(angle);
  };
  RC_ASSERT(agree(linearPolarizer(angle), turned(linearPolarizer(0)), rounding));
  RC_ASSERT(agree(retarder(retardance, angle), turned(retarder(retardance, 0)), rounding));
  RC_ASSERT(agree(circularPolarizer(1), turned(circularPolarizer(1)), rounding));
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, EigenvaluesSumToM00AndOneIsLeftWithoutDepolarisation,
              ()) {
  const CDMuellerMatrix m = *jonesElements();
  const auto e = coherencyEigenvalues(m);
  const double tolerance = 1e-13 * m.getScalar() + 1e-300;  // an eigenvalue solver's rounding
  RC_ASSERT(std::abs(e[0] - m.getScalar()) <= tolerance);
  RC_ASSERT(std::abs(e[1]) <= tolerance && std::abs(e[3]) <= tolerance);
  const CDMuellerMatrix any = *muellerMatrices();
  const auto f = coherencyEigenvalues(any);
  RC_ASSERT(std::abs(f[0] + f[1] + f[2] + f[3] - any.getScalar()) < 1e-12);
  RC_ASSERT(f[0] >= f[1] && f[1] >= f[2] && f[2] >= f[3]);
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, RealisabilitySurvivesProductsSumsAndTurns, ()) {
  CDMuellerMatrix a = *realisableElements(), b = *realisableElements();
  RC_PRE(a.getScalar() > 1e-3 && b.getScalar() > 1e-3);
  RC_ASSERT(isRealizable(a) && isRealizable(b));
  RC_ASSERT(isRealizable(a * b) ||
            (a * b).getScalar() < 1e-6);  // crossed: only rounding is left
  RC_ASSERT(isRealizable(a + b));
  RC_ASSERT(isRealizable(a.transposed()));
  RC_ASSERT(isRealizable(a.rotate(*angles())));
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, ReflectionsAreRealisable, ()) {
  // any pair of complex amplitude reflectances r_s, r_p: the Fresnel form of eq. 3.76
  const Complex rs = std::polar(*numbersBetween(0, 1), *angles());
  const Complex rp = std::polar(*numbersBetween(0, 1), *angles());
  const double sum = (std::norm(rs) + std::norm(rp)) / 2,
               diff = (std::norm(rs) - std::norm(rp)) / 2;
  const Complex x = rs * std::conj(rp);
  const CDMuellerMatrix m(
      {sum, diff, 0, 0, diff, sum, 0, 0, 0, 0, x.real(), x.imag(), 0, 0, -x.imag(), x.real()});
  RC_ASSERT(isRealizable(m));
  RC_ASSERT(
      agree(m, muellerOf(Jones{rs, 0, 0, rp}), 1e-15 * 4));  // rounding of numbers below 1
  if (sum > 1e-3) {
    CDMuellerMatrix flipped = m;  // negative control: no surface reflects like this
    flipped.promote()[15] = -x.real();
    RC_ASSERT(std::abs(x.real()) < 1e-6 || !isRealizable(flipped));
  }
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, RealisableElementsMakePhysicalLight, ()) {
  const CDMuellerMatrix m = *realisableElements();
  const CDStokesVector s = *physicalStates();
  const CDStokesVector out = m * s;
  RC_PRE(out.getScalar() > 1e-9 * m.getScalar() * s.getScalar());  // not crossed out
  RC_ASSERT(out.isPhysical(1e-6));  // rounding, magnified by the ratio above
  RC_ASSERT(out.getDOP() <= 1.0 + 1e-6);
  RC_ASSERT(out.getDOLP() <= out.getDOP() && out.getDOCP() <= out.getDOP());
}

TEST(CDPolarimetricMathInvariant, NegativeControlAnImpossibleElementIsSeen) {
  EXPECT_FALSE(
      isRealizable(CDMuellerMatrix({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1})));
  EXPECT_FALSE(isRealizable(CDMuellerMatrix(-1)));
  EXPECT_FALSE(isRealizable(CDMuellerMatrix(not_a_number)));
  EXPECT_FALSE(isRealizable(CDMuellerMatrix({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_FALSE(isRealizable(1.01 * CDMuellerMatrix(1) - 0.02 * idealDepolarizer()));
  EXPECT_TRUE(isRealizable(CDMuellerMatrix(0)));
  EXPECT_TRUE(isRealizable(CDMuellerMatrix(3.7))) << "a BRDF may exceed 1";
  EXPECT_TRUE(std::isnan(coherencyEigenvalues(CDMuellerMatrix(infinite))[0]));
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, LuChipmanPartsMakeTheWhole, ()) {
  const CDMuellerMatrix m = *realisableElements();
  const auto e = coherencyEigenvalues(m);
  const double diattenuation =
      std::hypot(m.getMueller(0, 1), m.getMueller(0, 2), m.getMueller(0, 3));
  RC_PRE(m.getScalar() > 1e-3 && diattenuation < 0.999 * m.getScalar());
  const LuChipman p = luChipman(m);
  // dividing by 1 - D^2 magnifies rounding at most 500 times
  RC_ASSERT(agree(p.depolarizer * p.retarder * p.diattenuator, m, 1e-12));
  RC_ASSERT(agree(p.retarder * p.retarder.transposed(), CDMuellerMatrix(1), 1e-12));
  RC_ASSERT(isRealizable(p.retarder, 1e-9));
  RC_ASSERT(agree(p.diattenuator, p.diattenuator.transposed(), 1e-14));
  RC_ASSERT(std::abs(p.diattenuation - diattenuation / m.getScalar()) < 1e-14);
  RC_ASSERT(p.retardance_rad >= 0.0 && p.retardance_rad <= pi);
  if (e[1] < 1e-14) {  // no depolarisation: the depolariser is the identity
    RC_ASSERT(agree(p.depolarizer, CDMuellerMatrix(1), 1e-9));
    RC_ASSERT(std::abs(p.depolarization_power) < 1e-9);
    RC_ASSERT(std::abs(p.depolarization_index - 1.0) < 1e-9);
  }
}

RC_GTEST_PROP(CDPolarimetricMathInvariant, LuChipmanFindsThePartsAnElementWasMadeOf, ()) {
  const double retardance = *numbersBetween(0.01, 3.13), t_min = *numbersBetween(0.05, 1);
  const double s = *numbersBetween(0.1, 1);
  const CDMuellerMatrix r = retarder(retardance, *angles()),
                        d = diattenuator(1, t_min, *angles());
  const LuChipman p = luChipman(depolarizer(s) * r * d);
  // dividing by 1 - D^2 and by s magnifies rounding at most 100 times
  RC_ASSERT(agree(p.depolarizer, depolarizer(s), 1e-12));
  RC_ASSERT(agree(p.retarder, r, 1e-12));
  RC_ASSERT(agree(p.diattenuator, d, 1e-12));
  RC_ASSERT(std::abs(p.retardance_rad - retardance) < 1e-12);
  RC_ASSERT(std::abs(p.diattenuation - (1 - t_min) / (1 + t_min)) < 1e-12);
  RC_ASSERT(std::abs(p.depolarization_power - (1 - s)) < 1e-12);
}

TEST(CDPolarimetricMathInvariant, LuChipmanOfSingularElements) {
  const auto rebuilt = [](const CDMuellerMatrix& m) {
    const LuChipman p = luChipman(m);
    return p.depolarizer * p.retarder * p.diattenuator;
  };
  const CDMuellerMatrix quarter = retarder(pi / 2, 0.2);
  const std::vector<CDMuellerMatrix> singular{
      0.0,
      2.5,
      linearPolarizer(0.7),            // D = 1
      quarter * linearPolarizer(0.7),  // what comes out differs from D
      circularPolarizer(-1),
      linearPolarizer(0) * quarter * linearPolarizer(0.7),
      idealDepolarizer() * linearPolarizer(0.7),  // nothing polarised comes out
      linearPolarizer(0.7) * idealDepolarizer(),  // D = 0 and P = 1
      idealDepolarizer(),                         // rank 0
      CDMuellerMatrix({1, 0, 0, 0, 0, 0.3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}),   // rank 1
      CDMuellerMatrix({1, 0, 0, 0, 0, 0, 0, -0.3, 0, 0, 0, 0, 0, 0, 0, 0}),  // rank 1, turning
      CDMuellerMatrix({1, 0, 0, 0, 0, 0.3, 0, 0, 0, 0, -0.2, 0, 0, 0, 0, 0}),  // rank 2
      CDMuellerMatrix(
          {1, 0, 0, 0, 0, -0.3, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 0.1}),  // determinant < 0
      CDMuellerMatrix({1, 0, 0, 0, 0, -0.3, 0, 0, 0, 0, -0.2, 0, 0, 0, 0, -0.1})};
  for (const CDMuellerMatrix& m : singular) {
    EXPECT_TRUE(isRealizable(m)) << m;
    EXPECT_TRUE(agree(rebuilt(m), m, 1e-14)) << m << " became " << rebuilt(m);  // rounding
    const CDMuellerMatrix r = luChipman(m).retarder;
    EXPECT_TRUE(agree(r * r.transposed(), CDMuellerMatrix(1), 1e-14)) << m;
    EXPECT_TRUE(isRealizable(r)) << m << " has the retarder " << r;
  }
}

TEST(CDPolarimetricMathInvariant, LuChipmanSingularElementsGetTheStatedNumbers) {
  EXPECT_EQ(luChipman(0.0).depolarizer, CDMuellerMatrix(1));
  EXPECT_NEAR(luChipman(linearPolarizer(0.7)).diattenuation, 1.0, rounding);
  EXPECT_NEAR(luChipman(linearPolarizer(0.7)).retardance_rad, 0.0, 1e-7);  // root of rounding
  EXPECT_NEAR(luChipman(idealDepolarizer()).depolarization_power, 1.0, 0.0);
  EXPECT_NEAR(luChipman(idealDepolarizer()).depolarization_index, 0.0, 0.0);
  EXPECT_NEAR(luChipman(retarder(pi, 0.4)).retardance_rad, pi, 1e-14);
  EXPECT_NEAR(luChipman(circularPolarizer(1) * linearPolarizer(0)).retardance_rad, pi / 2,
              1e-14)
      << "the least turn from horizontal to circular";
  // diag(1, -.3, -.2, -.1): no turn, a depolariser of negative determinant
  const LuChipman p =
      luChipman(CDMuellerMatrix({1, 0, 0, 0, 0, -0.3, 0, 0, 0, 0, -0.2, 0, 0, 0, 0, -0.1}));
  EXPECT_TRUE(agree(p.retarder, CDMuellerMatrix(1), rounding));
  EXPECT_NEAR(p.depolarization_power, 0.8, rounding);
}

TEST(CDPolarimetricMathInvariant, LuChipmanRefusesWhatCannotBe) {
  EXPECT_THROW(luChipman(-1.0), MathError);
  EXPECT_THROW(luChipman(not_a_number), MathError);
  EXPECT_THROW(luChipman(CDMuellerMatrix({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})),
               MathError);
  EXPECT_THROW(luChipman(CDMuellerMatrix({1, 1.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})),
               MathError);
  EXPECT_THROW(luChipman(CDMuellerMatrix({1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})),
               MathError);
}

// ================================================================== published values

TEST(CDPolarimetricMathPublished, Table32StatesFromBothFormsOfEquation340) {
  const struct {
    CDStokesVector printed;
    double chi, psi, alpha, delta;
  } table[] = {{{1, 1, 0, 0}, 0, 0, 0, 0},
               {{1, -1, 0, 0}, 0, pi / 2, pi / 2, 0},
               {{1, 0, 1, 0}, 0, pi / 4, pi / 4, 0},
               {{1, 0, -1, 0}, 0, 3 * pi / 4, pi / 4, pi},
               {{1, 0, 0, 1}, pi / 4, 0, pi / 4, pi / 2},
               {{1, 0, 0, -1}, -pi / 4, 0, pi / 4, -pi / 2}};
  for (const auto& row : table) {  // cos(pi/2) is 6e-17, not 0
    EXPECT_TRUE(agree(stokesFromEllipse(row.chi, row.psi), row.printed, 1e-15)) << row.printed;
    EXPECT_TRUE(agree(stokesFromAlphaDelta(row.alpha, row.delta), row.printed, 1e-15))
        << row.printed;
    EXPECT_EQ(row.printed.getDOP(), 1.0);
  }
  EXPECT_EQ(horizontal_light, table[0].printed);
  EXPECT_EQ(vertical_light, table[1].printed);
  EXPECT_EQ(plus_45_light, table[2].printed);
  EXPECT_EQ(minus_45_light, table[3].printed);
  EXPECT_EQ(right_circular_light, table[4].printed);
  EXPECT_EQ(left_circular_light, table[5].printed);
  EXPECT_EQ(random_light, CDStokesVector(1, 0, 0, 0));
}

namespace {
const CDMuellerMatrix printed_fast_vertical({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0});
const CDMuellerMatrix printed_fast_horizontal({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1,
                                               0});
}  // namespace

TEST(CDPolarimetricMathPublished, Table33PolarisersAsPrinted) {
  const auto half = [](const Sixteen& m) { return 0.5 * CDMuellerMatrix(m); };
  const std::vector<std::pair<CDMuellerMatrix, CDMuellerMatrix>> table{
      {linearPolarizer(0), half({1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})},
      {linearPolarizer(pi / 2), half({1, -1, 0, 0, -1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})},
      {linearPolarizer(pi / 4), half({1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0})},
      {linearPolarizer(-pi / 4), half({1, 0, -1, 0, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0})},
      {circularPolarizer(+1), half({1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1})},
      {circularPolarizer(-1), half({1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 1})}};
  for (const auto& [ours, printed] : table) {
    EXPECT_TRUE(agree(ours, printed, 1e-15))
        << ours << " against " << printed;  // cos(pi/2) = 6e-17
    EXPECT_TRUE(isRealizable(printed)) << printed;
  }
}

TEST(CDPolarimetricMathPublished, Table33QuarterWavePlatesCarryTheOppositeHandedness) {
  // What the thesis itself says decides: +45 light whose x component is put a quarter period
  // forward turns, looking back at the source, counter-clockwise: right-handed.
  const Field plus_45{std::sqrt(0.5), 0, std::sqrt(0.5), 0};
  const CDStokesVector behind_horizontal = traced(behind(plus_45, 0, 1, 1, pi / 2));
  EXPECT_TRUE(agree(behind_horizontal, right_circular_light, rounding));
  EXPECT_TRUE(agree(retarder(pi / 2, 0) * plus_45_light, behind_horizontal, rounding));
  EXPECT_TRUE(agree(retarder(pi / 2, pi / 2) * plus_45_light, left_circular_light, rounding));
  // as printed, the names are exchanged
  EXPECT_EQ(printed_fast_horizontal * plus_45_light, left_circular_light);
  EXPECT_TRUE(agree(retarder(pi / 2, 0), printed_fast_vertical, 1e-15));  // cos(pi/2) = 6e-17
  EXPECT_TRUE(agree(retarder(pi / 2, pi / 2), printed_fast_horizontal, 1e-15 * 4));
  EXPECT_FALSE(agree(retarder(pi / 2, 0), printed_fast_horizontal, 1e-3));
  EXPECT_TRUE(isRealizable(printed_fast_horizontal) && isRealizable(printed_fast_vertical));
}

namespace {
// The example of section 6.1.2, eqs. 6.5-6.7.
CDMuellerMatrix exampleBRDF(double m00, double m01, double m11, double m22, double m23) {
  return CDMuellerMatrix({m00, m01, 0, 0, m01, m11, 0, 0, 0, 0, m22, m23, 0, 0, -m23, -m22});
}
}  // namespace

TEST(CDPolarimetricMathPublished, WorkedExampleOfSection612) {
  const CDStokesVector out550 =
      exampleBRDF(1.6, 0.02, 1.75, -1.15, 0.35) * CDStokesVector(6, 0, -2.5, 1);
  EXPECT_TRUE(agree(out550, CDStokesVector(9.600, 0.120, 3.225, 2.025), rounding));  // eq. 6.12
  const CDStokesVector out650 = exampleBRDF(1.7, 0.03, 1.8, -1.1, 0.3) * CDStokesVector(7);
  EXPECT_TRUE(agree(out650, CDStokesVector(11.90, 0.21, 0, 0), rounding));  // eq. 6.13
  EXPECT_TRUE(out650.isPolarized());
}

TEST(CDPolarimetricMathPublished, NegativeControlOneMisprintedDigitIsSeen) {
  const CDStokesVector out450 =
      exampleBRDF(1.5, 0.01, 1.7, -1.2, 0.4) * CDStokesVector(5, 2, -1, 0);
  EXPECT_FALSE(agree(out450, CDStokesVector(5.02, 3.45, 1.10, 0.40), 0.005))
      << "eq. 6.11 as printed";
  EXPECT_TRUE(agree(out450, CDStokesVector(7.52, 3.45, 1.20, 0.40), rounding))
      << "as corrected";
}

TEST(CDPolarimetricMathPublished, NoSurfaceReflectsLikeTheExampleOfSection612) {
  EXPECT_FALSE(isRealizable(exampleBRDF(1.5, 0.01, 1.7, -1.2, 0.4), 0.1)) << "m11 exceeds m00";
}

// ================================================================== regression

TEST(CDPolarimetricMathRegression, ThePlateOfSection71TakenApart) {
  // The specular matrix of section 7.1 (errata: f33 is -1.131418), as our code computes it.
  const CDMuellerMatrix plate({1.17187, 0.040058, 0, 0, 0.040058, 1.17187, 0, 0,  //
                               0, 0, -1.131418, 0.302611, 0, 0, -0.302611, -1.131418});
  const LuChipman p = luChipman(plate);
  EXPECT_NEAR(p.diattenuation, 0.040058 / 1.17187, rounding);
  // six-digit input: the matrix is non-depolarising to 1e-6
  EXPECT_NEAR(p.depolarization_power, 0.0, 2e-6);
  EXPECT_NEAR(p.retardance_rad, pi - std::atan(0.302611 / 1.131418), 1e-12);
  EXPECT_GT(std::abs(p.retardance_rad - std::atan(0.302611 / 1.131418)), 1.0)
      << "negative control: with the printed sign of f33 the retardance would be this";
}
