// Lambert's surface in its three polarised forms (nw/surface/BRDFDiffuse.nw).
#include "malus/surface/BRDFDiffuse.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const BRDFGeometry anywhere = BRDFGeometry::fromDegrees(20, 70, 33);

const SpectralGridPtr& grid() {
  static const SpectralGridPtr three = SpectralGrid::make({450.0, 550.0, 650.0});
  return three;
}
CDSpectralVector<double> reflectance() {
  return CDSpectralVector<double>(grid(), std::vector<double>{0.1, 0.5, 1.0});
}
double fraction() { return *rc::gen::inRange(0, 1001) / 1000.0; }
}  // namespace

// Eqs 6.14, 6.15, 6.16, element by element; f00 = reflectance / pi.
TEST(BRDFDiffusePublished, TheThreeMatrices) {
  for (const double s : {0.0, 0.4, 1.0}) {
    const auto f = BRDFDiffuse(reflectance(), s).getBRDF(anywhere);
    for (std::size_t band = 0; band < 3; ++band)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const double rho_d = reflectance()[band] / pi;
          const double expected = i != j ? 0 : i == 0 ? rho_d : s * rho_d;
          EXPECT_NEAR(f.at(band).getMueller(i, j), expected, 1e-16);  // one rounding
          EXPECT_NE(f.at(band).getMueller(0, 0), 0.99 * rho_d);       // negative control
        }
  }
  EXPECT_EQ(BRDFDiffuse::depolarizing(reflectance()).getBRDF(anywhere),
            BRDFDiffuse(reflectance()).getBRDF(anywhere));
  const auto neutral = BRDFDiffuse::neutral(reflectance()).getBRDF(anywhere);
  EXPECT_EQ(neutral, BRDFDiffuse(reflectance(), 1).getBRDF(anywhere));
  EXPECT_FALSE(neutral.anyPolarized());
}

TEST(BRDFDiffuseIdentity, TheExampleOfTheChapter) {
  const auto scattered = [](double s) {
    CDSpectralVector<CDStokesVector> in(grid(), CDStokesVector(100, 30, 40, 0)), out(grid());
    BRDFDiffuse(CDSpectralVector<double>(grid(), 1.0), s).scatter(anywhere, pi, in, out);
    return out.at(1);
  };
  const CDStokesVector none = scattered(0), half = scattered(0.5), all = scattered(1);
  EXPECT_NEAR(none.getScalar(), 100, 1e-13);  // pi times 1/pi
  EXPECT_EQ(none.getDOP(), 0);
  EXPECT_NEAR(half.getStokes(1), 15, 1e-13);
  EXPECT_NEAR(half.getStokes(2), 20, 1e-13);
  EXPECT_NEAR(half.getDOP(), 0.25, 1e-15);
  EXPECT_NEAR(all.getStokes(1), 30, 1e-13);
  EXPECT_NEAR(all.getStokes(2), 40, 1e-13);
}

RC_GTEST_PROP(BRDFDiffuseIdentity, FastScatteringEqualsTheMatrixTimesTheVector, ()) {
  const BRDFDiffuse model(reflectance(), *rc::gen::element(0.0, fraction(), 1.0));
  CDSpectralVector<CDStokesVector> in(grid()), fast(grid()), plain(grid());
  for (std::size_t band = 0; band < 3; ++band) {
    const double s0 = fraction();
    if (*rc::gen::arbitrary<bool>())
      in[band] = CDStokesVector(s0, s0 * fraction(), -s0 * fraction(), fraction());
    else
      in[band] = CDStokesVector(s0);
    if (*rc::gen::arbitrary<bool>()) {
      fast[band] = CDStokesVector(1, 0.5, 0.25, -0.5);
      plain[band] = CDStokesVector(1, 0.5, 0.25, -0.5);
    }
  }
  model.scatter(anywhere, 0.7, in, fast);
  model.CDBRDFModel::scatter(anywhere, 0.7, in, plain);
  for (std::size_t band = 0; band < 3; ++band)
    for (int i = 0; i < 4; ++i)  // three roundings of numbers below two
      RC_ASSERT(std::abs(fast.at(band).getStokes(i) - plain.at(band).getStokes(i)) <= 1e-15);
}

RC_GTEST_PROP(BRDFDiffuseInvariant, EveryMatrixIsRealizableAndReciprocal, ()) {
  const BRDFDiffuse model(reflectance(), fraction());
  const double i = fraction() * 1.5, r = fraction() * 1.5, phi = fraction() * 6;
  const auto forth = model.getBRDF(BRDFGeometry::fromAngles(i, r, phi));
  const auto back = model.getBRDF(BRDFGeometry::fromAngles(r, i, -phi));
  RC_ASSERT(forth == back);  // diagonal: the signs of the reciprocity drop out
  for (std::size_t band = 0; band < 3; ++band)
    RC_ASSERT(isRealizable(forth.at(band), 1e-15));  // rounding of eigenvalues
}

TEST(BRDFDiffuseInvariant, DHRIsTheReflectanceAndAgreesWithThePlainIntegration) {
  const BRDFDiffuse model(reflectance(), 0.3);
  for (const double zenith : {0.0, 1.5}) {
    const auto dhr = model.getDHR(zenith), plain = model.CDBRDFModel::getDHR(zenith);
    for (std::size_t band = 0; band < 3; ++band) {
      EXPECT_EQ(dhr[band], reflectance()[band]);
      EXPECT_NEAR(plain[band], dhr[band], 1e-13);  // exact rule, 7680 terms
    }
  }
  EXPECT_THROW(model.getDHR(pi / 2), MathError);
}

TEST(BRDFDiffuseIdentity, ScoreIsThatOfTheBaseClassAndNothingComesFromBelow) {
  const BRDFDiffuse model(reflectance(), 0.3);
  EXPECT_NEAR(model.getScore(anywhere), model.CDBRDFModel::getScore(anywhere), 1e-16);
  const auto below = BRDFGeometry::fromDegrees(20, 91, 0);
  EXPECT_EQ(model.getScore(below), 0);
  EXPECT_EQ(model.getBRDF(below).at(2).getScalar(), 0);
  CDSpectralVector<CDStokesVector> in(grid(), CDStokesVector(1)), out(grid());
  model.scatter(below, 1, in, out);
  EXPECT_EQ(out.at(2).getScalar(), 0);
  // light along the surface falls on nothing, whatever its weight says
  const std::vector<float> light(12, 1.0f);
  const float one = 1, zero = 0, above = 0.5f;
  model.gatherEach({0, 0, 1}, {1, &one, &zero, &zero, &one}, light, out);
  EXPECT_EQ(out.at(2).getScalar(), 0);
  model.gatherEach({0, 0, 1}, {1, &one, &zero, &above, &one}, light, out);
  EXPECT_GT(out.at(2).getScalar(), 0) << "negative control";
}

TEST(BRDFDiffuseIdentity, ImpossibleSurfacesAreRefused) {
  for (const double bad : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(BRDFDiffuse(CDSpectralVector<double>(grid(), bad)), MathError);
    EXPECT_THROW(BRDFDiffuse(reflectance(), bad), MathError);
  }
}
