// Spectral vectors (nw/light/CDSpectralVector.nw). The reference is plain 4x4 algebra on
// promoted numbers, written out here. Its operands are small multiples of 1/8, so that every
// sum of products is exact in a double and results must agree to the last bit, however they
// were ordered or fused.
#include "malus/light/CDSpectralVector.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <complex>
#include <functional>
#include <limits>
#include <random>
#include <string>

using namespace malus;

namespace {
using Stokes = CDSpectralVector<CDStokesVector>;
using Mueller = CDSpectralVector<CDMuellerMatrix>;
using Scalars = CDSpectralVector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// ------------------------------------------------------------------ plain algebra
template <std::size_t K>
struct Plain {
  std::array<double, K> v{};  // promoted
  bool polarized = false;
};
using S = Plain<4>;
using M = Plain<16>;

template <std::size_t K>
Plain<K> plus(const Plain<K>& a, const Plain<K>& b, double weight) {
  Plain<K> sum{{}, a.polarized || b.polarized};
  for (std::size_t k = 0; k < K; ++k) sum.v[k] = a.v[k] + weight * b.v[k];
  return sum;
}
template <std::size_t K>
Plain<K> times(const Plain<K>& a, double factor) {
  return plus(Plain<K>{}, a, factor);
}
S times(const M& m, const S& s) {
  S product{{}, m.polarized || s.polarized};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) product.v[i] += m.v[4 * i + j] * s.v[j];
  return product;
}
M times(const M& a, const M& b) {
  M product{{}, a.polarized || b.polarized};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k)
        product.v[4 * i + j] += a.v[4 * i + k] * b.v[4 * k + j];
  return product;
}
M rotation(double theta) {  // eq 3.48
  const double c = std::cos(2 * theta), s = std::sin(2 * theta);
  return {{1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, 0, 1}, true};
}

// ------------------------------------------------------------------ random mixtures
struct Draw {
  std::mt19937_64 engine;
  explicit Draw(unsigned seed) : engine(seed) {}
  double eighths() { return (static_cast<int>(engine() % 65) - 32) / 8.0; }
  bool coin() { return engine() % 2 == 0; }
  template <std::size_t K>
  Plain<K> value(bool polarized) {
    Plain<K> p{{}, polarized};
    const double scalar = eighths();
    for (std::size_t k = 0; k < K; ++k)
      p.v[k] = polarized    ? eighths()
               : k % 5 == 0 ? scalar
                            : 0;  // eq (s,0,0,0) and m times identity
    return p;
  }
  // none, all, or some of the bands polarised
  template <std::size_t K>
  std::vector<Plain<K>> mixture(std::size_t bands) {
    const auto kind = engine() % 4;
    std::vector<Plain<K>> mixed;
    for (std::size_t i = 0; i < bands; ++i)
      mixed.push_back(value<K>(kind == 0 ? false : kind == 1 ? true : coin()));
    return mixed;
  }
};

SpectralGridPtr gridOf(std::size_t bands) {
  std::vector<double> nm;
  for (std::size_t i = 0; i < bands; ++i) nm.push_back(400 + 2.5 * static_cast<double>(i));
  return SpectralGrid::make(nm);
}
CDStokesVector asValue(const S& p) {
  return p.polarized ? CDStokesVector(p.v[0], p.v[1], p.v[2], p.v[3]) : CDStokesVector(p.v[0]);
}
CDMuellerMatrix asValue(const M& p) {
  return p.polarized ? CDMuellerMatrix(p.v) : CDMuellerMatrix(p.v[0]);
}
Stokes spectrumOf(const SpectralGridPtr& grid, const std::vector<S>& values) {
  Stokes v(grid);
  for (std::size_t i = 0; i < values.size(); ++i) v[i] = asValue(values[i]);
  return v;
}
Mueller spectrumOf(const SpectralGridPtr& grid, const std::vector<M>& values) {
  Mueller v(grid);
  for (std::size_t i = 0; i < values.size(); ++i) v[i] = asValue(values[i]);
  return v;
}

// Values, states, and the three rules of the planes.
template <class T, std::size_t K>
bool agrees(const CDSpectralVector<T>& ours, const std::vector<Plain<K>>& plain,
            double tolerance = 0) {
  bool any = false;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    any = any || plain[i].polarized;
    const T value = ours[i];
    if (value.isPolarized() != plain[i].polarized || ours.isPolarized(i) != plain[i].polarized)
      return false;
    for (std::size_t k = 0; k < K; ++k)
      if (!(std::abs(value.data()[k] - plain[i].v[k]) <= tolerance)) return false;
    for (std::size_t k = 0; k < (ours.anyPolarized() ? K : 1); ++k) {
      const double number = ours.plane(static_cast<int>(k))[i];
      if (!(std::abs(number - plain[i].v[k]) <= tolerance)) return false;
      if (!plain[i].polarized && number != (k % 5 == 0 ? ours.plane(0)[i] : 0)) return false;
    }
  }
  return any == ours.anyPolarized();
}
template <std::size_t K>
std::vector<Plain<K>> perturbed(std::vector<Plain<K>> plain) {
  plain.back().v[0] += 0.125;
  return plain;
}
template <std::size_t K>
std::vector<Plain<K>> otherState(std::vector<Plain<K>> plain) {
  plain.back().polarized = !plain.back().polarized;
  return plain;
}
// a result agrees, and neither a changed number nor a changed state would
template <class T, std::size_t K>
void demand(const CDSpectralVector<T>& ours, const std::vector<Plain<K>>& plain,
            double tolerance = 0) {
  RC_ASSERT(agrees(ours, plain, tolerance));
  RC_ASSERT(!agrees(ours, perturbed(plain), tolerance));
  RC_ASSERT(!agrees(ours, otherState(plain), tolerance));
}
template <std::size_t K, class Operation>
std::vector<Plain<K>> each(std::size_t bands, Operation operation) {
  std::vector<Plain<K>> results;
  for (std::size_t i = 0; i < bands; ++i) results.push_back(operation(i));
  return results;
}

// four bands as asked, and lengths below, at and above the width of the vector instructions
const std::vector<std::size_t> lengths{4, 1, 2, 3, 5, 7, 8, 9, 64, 256};
std::size_t anyLength() {
  return *rc::gen::weightedOneOf<std::size_t>(
      {{3, rc::gen::just<std::size_t>(4)}, {1, rc::gen::elementOf(lengths)}});
}
}  // namespace

// ---------------------------------------------------------------------------------- published
// Section 6.1.2 word for word, with the two misprints of eq 6.11 corrected (7.52 for 5.02, 1.20
// for 1.10).
TEST(CDSpectralVectorPublished, WorkedExampleOfSection612) {
  const auto grid = SpectralGrid::make({450, 550, 650});
  Stokes Ein(grid);
  Ein[0] = CDStokesVector(5, 2, -1, 0);
  Ein[1] = CDStokesVector(6, 0, -2.5, 1);
  Ein[2] = 7.0;
  Mueller brdf(grid);
  brdf[0] =
      CDMuellerMatrix({1.5, 0.01, 0, 0, 0.01, 1.7, 0, 0, 0, 0, -1.2, 0.4, 0, 0, -0.4, 1.2});
  brdf[1] = CDMuellerMatrix(
      {1.6, 0.02, 0, 0, 0.02, 1.75, 0, 0, 0, 0, -1.15, 0.35, 0, 0, -0.35, 1.15});
  brdf[2] =
      CDMuellerMatrix({1.7, 0.03, 0, 0, 0.03, 1.8, 0, 0, 0, 0, -1.1, 0.3, 0, 0, -0.3, 1.1});
  auto Lout = brdf * Ein;
  EXPECT_TRUE(Ein[0].isPolarized());
  EXPECT_FALSE(Ein[2].isPolarized());
  EXPECT_TRUE(Lout[2].isPolarized());
  const double printed[3][4] = {
      {7.52, 3.45, 1.20, 0.40}, {9.600, 0.120, 3.225, 2.025}, {11.90, 0.21, 0, 0}};
  // the operands have few digits, so the products are those of the print up to rounding of sums
  // near 10
  const double rounding = 4e-15;
  for (int band = 0; band < 3; ++band)
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(Lout[band].getStokes(i), printed[band][i], rounding) << band << " " << i;
  EXPECT_GT(std::abs(Lout[0].getStokes(0) - 5.02),
            rounding);  // as printed in eq 6.11: both are wrong
  EXPECT_GT(std::abs(Lout[0].getStokes(2) - 1.10), rounding);
  EXPECT_DOUBLE_EQ(Lout[0].getDOP(), std::sqrt(3.45 * 3.45 + 1.2 * 1.2 + 0.4 * 0.4) / 7.52);
  EXPECT_DOUBLE_EQ(Lout[2].getDOP(), 0.21 / 11.9);
}

// ---------------------------------------------------------------------------------- mixtures
RC_GTEST_PROP(CDSpectralVectorIdentity, StokesSumsOfMixtures, (unsigned seed)) {
  Draw draw(seed);
  const auto n = anyLength();
  const auto grid = gridOf(n);
  const auto a = draw.mixture<4>(n), b = draw.mixture<4>(n);
  const Stokes va = spectrumOf(grid, a), vb = spectrumOf(grid, b);
  const double w = draw.eighths();
  demand(va, a);
  demand(va + vb, each<4>(n, [&](auto i) { return plus(a[i], b[i], 1); }));
  demand(va - vb, each<4>(n, [&](auto i) { return plus(a[i], b[i], -1); }));
  demand(vb - va, each<4>(n, [&](auto i) { return plus(b[i], a[i], -1); }));
  demand(Stokes(va).addScaled(vb, w), each<4>(n, [&](auto i) { return plus(a[i], b[i], w); }));
  demand(-va, each<4>(n, [&](auto i) { return times(a[i], -1); }));
  demand(va * w, each<4>(n, [&](auto i) { return times(a[i], w); }));
  demand(w * va, each<4>(n, [&](auto i) { return times(a[i], w); }));
  demand(va / 0.25, each<4>(n, [&](auto i) { return times(a[i], 4); }));
  Stokes self = va;
  const Stokes& alias = self;
  self += alias;
  demand(self, each<4>(n, [&](auto i) { return times(a[i], 2); }));
  self -= alias;
  demand(self, each<4>(n, [&](auto i) { return times(a[i], 0); }));
}

RC_GTEST_PROP(CDSpectralVectorIdentity, MuellerSumsOfMixtures, (unsigned seed)) {
  Draw draw(seed);
  const auto n = anyLength();
  const auto grid = gridOf(n);
  const auto a = draw.mixture<16>(n), b = draw.mixture<16>(n);
  const Mueller va = spectrumOf(grid, a), vb = spectrumOf(grid, b);
  const double w = draw.eighths();
  demand(va, a);
  demand(va + vb, each<16>(n, [&](auto i) { return plus(a[i], b[i], 1); }));
  demand(va - vb, each<16>(n, [&](auto i) { return plus(a[i], b[i], -1); }));
  demand(vb - va, each<16>(n, [&](auto i) { return plus(b[i], a[i], -1); }));
  demand(Mueller(va).addScaled(vb, w),
         each<16>(n, [&](auto i) { return plus(a[i], b[i], w); }));
  demand(w * va, each<16>(n, [&](auto i) { return times(a[i], w); }));
  demand(va / 0.25, each<16>(n, [&](auto i) { return times(a[i], 4); }));
}

RC_GTEST_PROP(CDSpectralVectorIdentity, ProductsOfMixtures, (unsigned seed)) {
  Draw draw(seed);
  const auto n = anyLength();
  const auto grid = gridOf(n);
  const auto a = draw.mixture<16>(n), b = draw.mixture<16>(n);
  const auto s = draw.mixture<4>(n), t = draw.mixture<4>(n);
  const Mueller va = spectrumOf(grid, a), vb = spectrumOf(grid, b);
  const Stokes vs = spectrumOf(grid, s), vt = spectrumOf(grid, t);
  const double w = draw.eighths();
  const auto ab = each<16>(n, [&](auto i) { return times(a[i], b[i]); });
  const auto as = each<4>(n, [&](auto i) { return times(a[i], s[i]); });
  demand(va * vb, ab);
  demand(va * vs, as);
  demand(Stokes(vt).multiplyAdd(va, vs, w),
         each<4>(n, [&](auto i) { return plus(t[i], as[i], w); }));
  demand(Mueller(vb).multiplyAdd(va, vb, w),
         each<16>(n, [&](auto i) { return plus(b[i], ab[i], w); }));
  // the sum may be one of the operands
  Stokes sum = vs;
  demand(sum.multiplyAdd(va, sum, w), each<4>(n, [&](auto i) { return plus(s[i], as[i], w); }));
  Mueller left = va, right = vb;
  demand(left.multiplyAdd(left, vb, w),
         each<16>(n, [&](auto i) { return plus(a[i], ab[i], w); }));
  demand(right.multiplyAdd(va, right, w),
         each<16>(n, [&](auto i) { return plus(b[i], ab[i], w); }));
}

RC_GTEST_PROP(CDSpectralVectorIdentity, SpectralScalarsTimesMixtures, (unsigned seed)) {
  Draw draw(seed);
  const auto n = anyLength();
  const auto grid = gridOf(n);
  const auto m = draw.mixture<16>(n), o = draw.mixture<16>(n);
  const auto s = draw.mixture<4>(n), t = draw.mixture<4>(n);
  Scalars f(grid);
  for (std::size_t i = 0; i < n; ++i) f[i] = draw.eighths();
  const Mueller vm = spectrumOf(grid, m);
  const Stokes vs = spectrumOf(grid, s);
  const auto fs = each<4>(n, [&](auto i) { return times(s[i], f.at(i)); });
  const auto fm = each<16>(n, [&](auto i) { return times(m[i], f.at(i)); });
  demand(f * vs, fs);
  demand(vs * f, fs);
  demand(Stokes(vs) *= f, fs);
  demand(f * vm, fm);
  demand(vm * f, fm);
  demand(Mueller(vm) *= f, fm);
  demand(spectrumOf(grid, t).multiplyAdd(f, vs, 0.5),
         each<4>(n, [&](auto i) { return plus(t[i], fs[i], 0.5); }));
  demand(spectrumOf(grid, o).multiplyAdd(f, vm, 0.5),
         each<16>(n, [&](auto i) { return plus(o[i], fm[i], 0.5); }));
  Stokes self = vs;
  demand(self.multiplyAdd(f, self), each<4>(n, [&](auto i) { return plus(s[i], fs[i], 1); }));
  const Scalars product = f * f;
  for (std::size_t i = 0; i < n; ++i) RC_ASSERT(product[i] == f[i] * f[i]);
}

RC_GTEST_PROP(CDSpectralVectorIdentity, RotationsOfMixtures, (unsigned seed)) {
  Draw draw(seed);
  const auto n = anyLength();
  const auto grid = gridOf(n);
  const auto m = draw.mixture<16>(n);
  const auto s = draw.mixture<4>(n);
  const double theta = draw.eighths();
  const M r = rotation(theta), back = rotation(-theta);
  const double rounding = 2e-14;  // a dozen roundings of numbers up to 16
  const auto keepState = [](auto turned, const auto& old) {
    return old.polarized ? turned : old;
  };
  demand(spectrumOf(grid, s).rotate(theta),
         each<4>(n, [&](auto i) { return keepState(times(r, s[i]), s[i]); }), rounding);
  demand(spectrumOf(grid, m).rotate(theta),
         each<16>(n, [&](auto i) { return keepState(times(times(r, m[i]), back), m[i]); }),
         rounding);
}

// What single values do, whole spectra do: against nw/light/CDPolarimetricMath.nw, band by
// band.
RC_GTEST_PROP(CDSpectralVectorInvariant, SpectraAgreeWithSingleValues, (unsigned seed)) {
  Draw draw(seed);
  const auto grid = gridOf(4);
  const Mueller m = spectrumOf(grid, draw.mixture<16>(4));
  const Stokes s = spectrumOf(grid, draw.mixture<4>(4));
  const Stokes product = m * s;
  const auto dop = getDOP(s), dolp = getDOLP(s), docp = getDOCP(s), s0 = getScalar(s),
             m0 = getScalar(m);
  const auto same = [](double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
  };
  for (std::size_t i = 0; i < 4; ++i) {
    RC_ASSERT(product[i] == m[i] * s[i]);
    RC_ASSERT(product[i].isPolarized() == (m[i] * s[i]).isPolarized());
    RC_ASSERT(!(product[i] == m[i] * s[i] + CDStokesVector(0.125)));  // negative control
    RC_ASSERT(same(dop[i], s[i].getDOP()));
    RC_ASSERT(same(dolp[i], s[i].getDOLP()));
    RC_ASSERT(same(docp[i], s[i].getDOCP()));
    RC_ASSERT(s0[i] == s[i].getScalar());
    RC_ASSERT(m0[i] == m[i].getScalar());
  }
}

// ---------------------------------------------------------------------------------- one band
TEST(CDSpectralVectorIdentity, ReferencesReadAndWrite) {
  const auto grid = SpectralGrid::make({450, 550});
  Stokes v(grid);
  v[0] = {4, 1, 2, 2};
  EXPECT_EQ(v[0].getDOP(), 0.75);
  EXPECT_EQ(v[0].getScalar(), 4);
  v[0] += CDStokesVector(1, 0, 0, 0);
  EXPECT_EQ(v[0], CDStokesVector(5, 1, 2, 2));
  v[0] -= 1.0;  // an unpolarised value, by conversion
  v[0] *= 2.0;
  EXPECT_EQ(v[0], CDStokesVector(8, 2, 4, 4));
  v[0] /= 2.0;
  EXPECT_THROW(v[0] /= 0.0, MathError);
  EXPECT_EQ(v[0], CDStokesVector(4, 1, 2, 2));
  v[1] = v[0];
  EXPECT_EQ(v[1], v[0]);
  EXPECT_TRUE(v[1].isPolarized());
  v[1].rotate(std::acos(-1.0) / 4);  // eq 3.48 at 45 degrees: S1' = S2, S2' = -S1
  EXPECT_NEAR(v[1].getStokes(1), 2, 4e-16);
  EXPECT_NEAR(v[1].getStokes(2), -1, 4e-16);
  v[1].demote();
  EXPECT_FALSE(v[1].isPolarized());
  EXPECT_EQ(v.plane(1)[1], 0);
  EXPECT_EQ(v[0] + v[1], CDStokesVector(8, 1, 2, 2));
  EXPECT_EQ(2.0 * v[0], CDStokesVector(8, 2, 4, 4));
  const CDStokesVector kept = v[0].copy();
  v[0] = 1.0;
  EXPECT_EQ(kept.getScalar(), 4);
  EXPECT_EQ(v[0].getScalar(), 1);

  Mueller m(grid, 0.5);
  EXPECT_FALSE(m.anyPolarized());
  m[1] = linearPolarizer(0);
  m[1] *= m[0];
  EXPECT_EQ(m[1], linearPolarizer(0) * 0.5);
  EXPECT_EQ(m[1] * CDStokesVector(4, 0, 0, 0), CDStokesVector(1, 1, 0, 0));
}

TEST(CDSpectralVectorIdentity, PlanesComeAndGoWithPolarisation) {
  Stokes v(gridOf(8), 3.0);
  const double* before = v.plane(0);
  EXPECT_THROW(v.plane(1), MathError);
  v[2] = {1, 0.5, 0, 0};
  EXPECT_TRUE(v.anyPolarized());
  EXPECT_TRUE(v.isPolarized(2));
  EXPECT_FALSE(v.isPolarized(1));
  for (int k = 1; k < 4; ++k)
    EXPECT_EQ(v.plane(k), v.plane(0) + 8 * k);  // one behind the other
  v[2] = 7.0;  // the last polarised band goes, and the planes with it
  EXPECT_FALSE(v.anyPolarized());
  EXPECT_THROW(v.plane(1), MathError);
  v.polarize();
  for (std::size_t i = 0; i < 8; ++i) EXPECT_TRUE(v.isPolarized(i));
  EXPECT_EQ(v[2], CDStokesVector(7.0));  // the same value, in four numbers
  v.plane(3)[2] = 5;
  EXPECT_EQ(v[2], CDStokesVector(7, 0, 0, 5));
  v.demote();
  EXPECT_FALSE(v.anyPolarized());
  v.polarize(2);
  EXPECT_EQ(v[2], CDStokesVector(7.0));  // nothing of the old S3 is left behind
  EXPECT_NE(before, nullptr);
  EXPECT_THROW(v.plane(4), std::out_of_range);
  EXPECT_THROW(v.plane(-1), std::out_of_range);
  Mueller m(gridOf(8), 3.0);
  m.polarize(5);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(m.plane(15)[i], 3);  // promoted: m times identity
  EXPECT_THROW(m.plane(16), std::out_of_range);
}

TEST(CDSpectralVectorIdentity, APolarisedZeroIsPolarised) {
  const Stokes v(gridOf(2), CDStokesVector(0, 0, 0, 0));
  EXPECT_TRUE(v.isPolarized(0));
  EXPECT_TRUE(v.isPolarized(1));
}

TEST(CDSpectralVectorInvariant, AnAccumulatorIsAllocatedOnce) {
  const auto grid = gridOf(64);
  const Mueller m(grid, linearPolarizer(0.3));
  const Stokes s(grid, CDStokesVector(1, 0.5, 0, 0));
  Stokes sum(grid);
  sum.multiplyAdd(m, s);
  const double* home = sum.plane(0);
  for (int i = 0; i < 10; ++i) {
    sum.demote();  // as between two pixels
    sum.multiplyAdd(m, s, 0.25);
    EXPECT_EQ(sum.plane(0), home);
  }
}

// ---------------------------------------------------------------------------------- not finite
TEST(CDSpectralVectorInvariant, WhatIsNotFiniteStaysInItsBand) {
  const auto grid = gridOf(5);
  for (const double bad : {not_a_number, infinite, -infinite})
    for (const bool polarized : {true, false}) {
      Stokes s(grid, CDStokesVector(1, 0.5, 0, 0));
      s[3] = polarized ? CDStokesVector(bad, bad, 1, 1) : CDStokesVector(bad);
      Mueller m(grid, linearPolarizer(0.2));
      m[3] = 2.0;
      Stokes clean = s;
      clean[3] = 1.0;
      const auto check = [&](const Stokes& ours, const Stokes& without) {
        for (std::size_t i = 0; i < 5; ++i) {
          if (i == 3)
            EXPECT_FALSE(ours[i].isFinite());
          else
            EXPECT_EQ(ours[i], without[i]);
        }
        EXPECT_EQ(ours.isPolarized(3), polarized);
        // rule 3: an unpolarised band has nothing but zeros beside its scalar
        EXPECT_TRUE(polarized || ours.plane(1)[3] == 0);
      };
      check(s + s, clean + clean);
      check(s * 2.0, clean * 2.0);
      check(m * s, m * clean);
      check(Stokes(s).rotate(0.3), Stokes(clean).rotate(0.3));
      check(Scalars(grid, 0.5) * s, Scalars(grid, 0.5) * clean);
      EXPECT_FALSE(s == clean);
    }
  Stokes nothing(grid, not_a_number);
  EXPECT_FALSE(nothing == nothing);  // as NaN has it
  EXPECT_FALSE(nothing.anyPolarized());
}

TEST(CDSpectralVectorIdentity, UnphysicalValuesAreKept) {
  const Stokes v(gridOf(2), CDStokesVector(-1, 2, 0, 0));
  EXPECT_EQ((v + v)[0], CDStokesVector(-2, 4, 0, 0));
  EXPECT_TRUE(std::isnan(getDOP(v)[0]));
  const Stokes dark(gridOf(2));
  EXPECT_EQ(getDOP(dark)[1], 0);
}

// ---------------------------------------------------------------------------------- grids
TEST(CDSpectralVectorIdentity, DifferentGridsDoNotCombine) {
  const auto a = SpectralGrid::make({450, 550}), b = SpectralGrid::make({450, 551});
  const auto same = SpectralGrid::make({450, 550});
  Stokes s(a), t(b);
  Mueller m(a), n(b);
  const Scalars f(b);
  EXPECT_THROW(s + t, GridError);
  EXPECT_THROW(s - t, GridError);
  EXPECT_THROW(s += t, GridError);
  EXPECT_THROW(s.addScaled(t, 2), GridError);
  EXPECT_THROW(m * t, GridError);
  EXPECT_THROW(m * n, GridError);
  EXPECT_THROW(f * s, GridError);
  EXPECT_THROW(s * f, GridError);
  EXPECT_THROW(s *= f, GridError);
  EXPECT_THROW(s.multiplyAdd(m, t), GridError);
  EXPECT_THROW(t.multiplyAdd(m, s), GridError);
  EXPECT_FALSE(s == t);
  EXPECT_TRUE(s == Stokes(same));
  EXPECT_NO_THROW(s + Stokes(same));
  try {
    s + t;
    FAIL() << "different grids were added";
  } catch (const GridError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("2 entries from 450 to 550 nm"), std::string::npos) << said;
    EXPECT_NE(said.find("2 entries from 450 to 551 nm"), std::string::npos) << said;
    EXPECT_NE(said.find("resampled"), std::string::npos) << said;
  }
  EXPECT_NO_THROW(s + t.resampled(a));  // the remedy works
}

TEST(CDSpectralVectorIdentity, ForbiddenOperations) {
  const auto grid = gridOf(3);
  Scalars v(grid, {1, 2, 3});
  EXPECT_THROW(v / 0.0, MathError);
  EXPECT_THROW(v / -0.0, MathError);
  EXPECT_THROW(Stokes(grid) / 0.0, MathError);
  EXPECT_THROW(v.at(3), std::out_of_range);
  EXPECT_THROW(Stokes(grid).at(3), std::out_of_range);
  EXPECT_THROW(std::as_const(v).at(17), std::out_of_range);
  EXPECT_THROW(Scalars(grid, {1, 2}), GridError);
  EXPECT_THROW(Scalars(grid, std::vector<double>{}), GridError);
  EXPECT_THROW(Scalars(nullptr), GridError);
  EXPECT_THROW((void)v.resampled(nullptr), GridError);
  EXPECT_EQ(v.at(2), 3);
}

// A quotient is rounded once. No tolerance: the reference is the division of single values.
TEST(CDSpectralVectorIdentity, AQuotientIsThatOfEachBand) {
  const auto grid = gridOf(9);
  Scalars v(grid);
  Stokes s(grid);
  CDSpectralVector<CDMuellerMatrix> m(grid);
  for (std::size_t i = 0; i < 9; ++i) {
    const double x = static_cast<double>(i) + 1;
    v[i] = x;
    s[i] = i % 3 ? CDStokesVector(x, x / 2, -3, .5) : CDStokesVector(x);
    m[i] = i % 2 ? CDMuellerMatrix(x) * rotationMatrix(x) : CDMuellerMatrix(x);
  }
  int reciprocal_differs = 0;
  for (const double x : {3.0, 7.0, -49.0, 0.1, 1e300, 1e-320}) {
    const auto v_x = v / x;
    const auto s_x = s / x;
    const auto m_x = m / x;
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_EQ(v_x[i], v[i] / x);
      EXPECT_EQ(s_x[i], std::as_const(s)[i] / x);
      EXPECT_EQ(m_x[i], std::as_const(m)[i] / x);
      EXPECT_EQ(s_x.isPolarized(i), s.isPolarized(i));
      reciprocal_differs += v_x[i] != v[i] * (1 / x);
    }
  }
  EXPECT_GT(reciprocal_differs, 0);  // negative control: a reciprocal would be noticed
}

// ---------------------------------------------------------------------------------- between
// bands
TEST(CDSpectralVectorIdentity, InterpolationOfMixtures) {
  const auto grid = SpectralGrid::make({450, 550, 650});
  Stokes v(grid);
  v[0] = {4, 2, 0, 0};
  v[1] = 8.0;
  v[2] = 16.0;
  EXPECT_EQ(v.interpolate(500), CDStokesVector(6, 1, 0, 0));  // the mean of promoted values
  EXPECT_TRUE(v.interpolate(500).isPolarized());
  EXPECT_FALSE(v.interpolate(550).isPolarized());  // at an entry, that entry alone
  EXPECT_EQ(v.interpolate(600), CDStokesVector(12.0));
  EXPECT_FALSE(v.interpolate(600).isPolarized());
  EXPECT_EQ(v.interpolate({0.5, CDSpectralUnits::micrometre}), v.interpolate(500));
  EXPECT_THROW(v.interpolate(700), GridError);
  EXPECT_EQ(v.interpolate(700, Extrapolation::hold), CDStokesVector(16.0));
  EXPECT_EQ(v.interpolate(700, Extrapolation::zero), CDStokesVector());
  EXPECT_EQ(v.interpolate(700, Extrapolation::linear), CDStokesVector(20.0));
  EXPECT_EQ(v.interpolate(400, Extrapolation::linear), CDStokesVector(2, 3, 0, 0));
  // the triangle weights 1/8, 3/4, 1/8 of the chapter on locations
  EXPECT_EQ(v.average(CDSpectralLocation(550, BandResponse::rectangular(100))),
            CDStokesVector(8.5, 0.25, 0, 0));
  v[2] = not_a_number;
  EXPECT_EQ(v.interpolate(500), CDStokesVector(6, 1, 0, 0));  // what is not used does no harm
  EXPECT_FALSE(v.interpolate(600).isFinite());
}

RC_GTEST_PROP(CDSpectralVectorInvariant, ResamplingCommutesWithAddition, (unsigned seed)) {
  Draw draw(seed);
  const auto from = gridOf(5);  // 400 ... 410 nm
  const auto to = SpectralGrid::make(std::vector<CDSpectralLocation>{
      CDSpectralLocation(401), CDSpectralLocation(404.3, BandResponse::gaussian(1)),
      CDSpectralLocation(407, BandResponse::rectangular(4)), CDSpectralLocation(410)});
  const Stokes a = spectrumOf(from, draw.mixture<4>(5)),
               b = spectrumOf(from, draw.mixture<4>(5));
  const Stokes first = (a + b).resampled(to), second = a.resampled(to) + b.resampled(to);
  for (std::size_t i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) {
      // rounding of five terms up to 4
      RC_ASSERT(std::abs(first[i].getStokes(k) - second[i].getStokes(k)) < 1e-14);
      RC_ASSERT(std::abs(first[i].getStokes(k) + 1e-13 - second[i].getStokes(k)) > 1e-14);
    }
  RC_ASSERT(a.resampled(from) == a);
}

// The energy between two wavelengths does not depend on the units of the density.
TEST(CDSpectralVectorInvariant, DensityConversionConservesTheIntegral) {
  std::vector<double> nm;
  for (int i = 0; i <= 2000; ++i) nm.push_back(400 + 0.15 * i);
  const auto grid = SpectralGrid::make(nm);
  Stokes v(grid);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double x = (nm[i] - 550) / 100;
    v[i] = i % 2 ? CDStokesVector(2 + x, 1 - x * x, 0, 0)
                 : CDStokesVector(2 + x, 1 - x * x, 0, 0.5);
  }
  const auto integral = [](const Stokes& s, CDSpectralUnits units, int k) {
    const auto x = s.grid().in(units);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      sum += (s[i].getStokes(k) + s[i + 1].getStokes(k)) / 2 * std::abs(x[i + 1] - x[i]);
    return sum;
  };
  for (const auto units : {CDSpectralUnits::micrometre, CDSpectralUnits::perCentimetre,
                           CDSpectralUnits::electronVolt, CDSpectralUnits::hertz}) {
    // the centres are given in nanometres; grid().in() converts each
    const Stokes converted = convertDensity(v, CDSpectralUnits::nanometre, units);
    for (int k : {0, 1}) {
      const double exact = k == 0 ? 600 : 300 * (1 - 0.75);  // in closed form
      // trapezia: step^2/12 = 0.0019 nm^2 times the change of the slope from end to end, which
      // is 0.06 per nm for S1 and a little more over the reciprocal axes
      EXPECT_NEAR(integral(converted, units, k), exact, 2e-4) << symbolOf(units) << k;
      EXPECT_GT(std::abs(integral(v, units, k) - exact),
                2e-4);  // negative control: not converted
    }
    const Stokes back = convertDensity(converted, units, CDSpectralUnits::nanometre);
    EXPECT_NEAR(back[77].getStokes(1), v[77].getStokes(1), 1e-15);
  }
}

// ---------------------------------------------------------------------------------- other
// types
namespace {
struct Colour {  // a type of a user's own: addition, multiples, equality
  double r = 0, g = 0;
  friend Colour operator+(Colour a, Colour b) { return {a.r + b.r, a.g + b.g}; }
  friend Colour operator*(Colour a, double w) { return {a.r * w, a.g * w}; }
  friend bool operator==(const Colour&, const Colour&) = default;
};
template <class A, class B>
concept Multiplies = requires(CDSpectralVector<A> a, CDSpectralVector<B> b) {
  a* b;
};
}  // namespace

static_assert(SpectralValue<double> && SpectralValue<float> &&
              SpectralValue<std::complex<double>>);
static_assert(SpectralValue<CDStokesVector> && SpectralValue<CDMuellerMatrix>);
static_assert(SpectralValue<Colour>);
static_assert(!SpectralValue<int> && !SpectralValue<bool> && !SpectralValue<std::string>);
static_assert(Multiplies<CDMuellerMatrix, CDStokesVector> &&
              Multiplies<CDMuellerMatrix, CDMuellerMatrix>);
static_assert(Multiplies<double, CDStokesVector> && Multiplies<Colour, double>);
// operations that Mueller calculus does not have do not compile
static_assert(!Multiplies<CDStokesVector, CDStokesVector> &&
              !Multiplies<Colour, CDStokesVector>);

TEST(CDSpectralVectorIdentity, AnyTypeWithTheArithmetic) {
  const auto grid = SpectralGrid::make({450, 550});
  CDSpectralVector<Colour> v(grid);
  v[0] = {1, 2};
  v[1].g = 4;
  EXPECT_EQ((v + v)[0], (Colour{2, 4}));
  EXPECT_EQ((v - v)[1], Colour{});
  EXPECT_EQ((v * 0.5)[1], (Colour{0, 2}));
  EXPECT_EQ((v / 2.0)[1], (Colour{0, 2}));  // has no separate quotient
  EXPECT_EQ((v * Scalars(grid, {2, 3}))[1], (Colour{0, 12}));
  EXPECT_EQ(v.interpolate(500), (Colour{0.5, 3}));

  using Complex = std::complex<double>;
  const CDSpectralVector<Complex> n(grid, std::vector<Complex>{{1, 2}, {3, -1}});
  EXPECT_EQ((n * n)[0], Complex(-3, 4));
  EXPECT_EQ(n.interpolate(500), Complex(2, 0.5));
  EXPECT_EQ(n.data()[1], Complex(3, -1));

  const CDSpectralVector<float> f(grid, {1.5F, 2.5F});
  EXPECT_EQ((f * 2.0)[1], 5.0F);
  EXPECT_EQ(f.interpolate(500), 2.0F);
}
