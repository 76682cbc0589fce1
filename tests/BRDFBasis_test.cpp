// A BRDF as a sum of basis functions (nw/surface/BRDFBasis.nw).
#include "malus/surface/BRDFBasis.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "ModelChecks.hpp"
#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/base/Table.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

BRDFTorranceSparrow copper(double sigma = 0.3) {
  return {0.405, 2.950, sigma, {Shadowing::vGroove, DiffuseTerm::reciprocal}};
}
BRDFTorranceSparrow manyMetals() {
  const auto grid = manyBands();
  return {ramp(grid, 0.4, 1.2),
          ramp(grid, 3, 2),
          ramp(grid, 0.3, 0.3),
          {Shadowing::vGroove, DiffuseTerm::reciprocal}};
}

BasisCoefficients readText(const Scratch& scratch, const std::string& text) {
  put(scratch / "basis.csv", text);
  return readBasis(scratch / "basis.csv");
}

/// All sixteen parts with random coefficients, f00 well above them.
BasisCoefficients randomCoefficients(int order, double width, const SpectralGridPtr& grid) {
  Random random(7);
  BasisCoefficients c{BasisFunctions(order, width), grid, true, {}};
  for (std::size_t p = 0; p < 16; ++p)
    for (std::size_t i = 0; i < c.functions.terms(basis_parts[p].kind).size() * grid->size();
         ++i)
      c.parts[p].push_back(0.02 * (random.uniform() - 0.5));
  for (std::size_t band = 0; band < grid->size(); ++band) c.parts[0][band] += 1;
  return c;
}
}  // namespace

// Over the box of u, v and phi the functions times v^2 have unit squares and no overlap. Cosine and sine kinds apart:
// a sine of zero times phi is nothing.
TEST(BRDFBasisIdentity, TheFunctionsAreOrthonormal) {
  const BasisFunctions functions(4, 0.3);
  using Rule = boost::math::quadrature::gauss<double, 20>;
  std::vector<std::pair<double, double>> nodes;
  for (std::size_t i = 0; i < 10; ++i)
    for (const double sign : {-1.0, 1.0})
      nodes.emplace_back(0.5 + 0.5 * sign * Rule::abscissa()[i], 0.5 * Rule::weights()[i]);
  for (const int kind : {0, 1, 2, 3}) {
    const auto& terms = functions.terms(kind);
    std::vector<double> gram(terms.size() * terms.size());
    for (const auto& [u, weight_u] : nodes)
      for (const auto& [v, weight_v] : nodes)
        for (int step = 0; step < 32; ++step) {
          BasisFunctions::Values values;
          functions.evaluate(
              RusinkiewiczAngles::fromAngles(std::atan(std::sqrt(0.3 * u / (1 - u))),
                                             std::acos(v), 2 * pi * step / 32),
              values);
          const double growth = std::pow(std::max(v, 0.02), 4);
          for (std::size_t i = 0; i < terms.size(); ++i)
            for (std::size_t j = 0; j < terms.size(); ++j)
              gram[i * terms.size() + j] +=
                  weight_u * weight_v / 32 * growth * values[kind][i] * values[kind][j];
        }
    for (std::size_t i = 0; i < terms.size(); ++i)
      for (std::size_t j = 0; j < terms.size(); ++j)  // the rules are exact: rounding
        EXPECT_NEAR(gram[i * terms.size() + j],
                    i == j && (kind < 2 || terms[i].m > 0) ? 1.0 : 0.0, 1e-11)
            << kind << ' ' << i << ' ' << j;
  }
}

// sqrt(3) (2u - 1), sqrt(6) u cos 2phi and sqrt(8) u^(1/2) (3u - 2) cos phi, at v = 1.
TEST(BRDFBasisPublished, ZernikePolynomials) {
  const BasisFunctions functions(2, 0.25);
  BasisFunctions::Values values;
  functions.evaluate(RusinkiewiczAngles::fromAngles(std::atan(std::sqrt(0.75)), 0, 0.4),
                     values);
  const double u = 0.75;  // t = 0.75, w = 0.25
  const auto value = [&](int kind, int m, int a, int b) {
    const auto& terms = functions.terms(kind);
    for (std::size_t i = 0; i < terms.size(); ++i)
      if (terms[i].m == m && terms[i].a == a && terms[i].b == b) return values[kind][i];
    return std::nan("");
  };
  EXPECT_NEAR(value(0, 0, 1, 0), std::sqrt(3) * (2 * u - 1), 1e-13);  // rounding, all of them
  EXPECT_NEAR(value(0, 0, 0, 1), std::sqrt(3), 1e-13);
  EXPECT_NEAR(value(0, 2, 0, 0), std::sqrt(6) * u * std::cos(0.8), 1e-13);
  EXPECT_NEAR(value(2, 2, 0, 0), std::sqrt(6) * u * std::sin(0.8), 1e-13);
  EXPECT_NEAR(value(1, 1, 1, 0), std::sqrt(8 * u) * (3 * u - 2) * std::cos(0.4), 1e-13);
  EXPECT_NEAR(value(3, 1, 1, 0), std::sqrt(8 * u) * (3 * u - 2) * std::sin(0.4), 1e-13);
  EXPECT_GT(std::abs(value(0, 2, 0, 0) - value(2, 2, 0, 0)), 1e-3);  // negative control
}

TEST(BRDFBasisIdentity, LambertIsThreeTerms) {
  const auto grid = SpectralGrid::make({550.0});
  const BRDFDiffuse lambert(CDSpectralVector<double>(grid, 0.5), 0);
  const BRDFBasis sum(fitBasis(lambert, 2, 1));
  EXPECT_LT(compareModels(lambert, sum).error, 1e-6);  // the ridge of 1e-11 and the condition
  EXPECT_GT(compareModels(lambert, BRDFBasis(fitBasis(lambert, 1, 1))).error, 1e-2);  // control
  EXPECT_NEAR(sum.getDHR(0.5)[0], 0.5, 1e-5);
}

// What is in the span comes back.
TEST(BRDFBasisInvariant, ASumFitsItself) {
  const BRDFBasis truth(randomCoefficients(3, 0.2, SpectralGrid::make({500.0, 600.0})));
  EXPECT_LT(compareModels(truth, BRDFBasis(fitBasis(truth, 3, 0.2))).error, 1e-5);
  EXPECT_GT(compareModels(truth, BRDFBasis(fitBasis(truth, 2, 0.2))).error, 1e-4);  // control
}

TEST(BRDFBasisInvariant, ReciprocalWhateverTheCoefficients) {
  const BRDFBasis model(randomCoefficients(4, 0.2, SpectralGrid::make({500.0})));
  const auto violation =
      [](const CDBRDFModel& sum) {  // where f00 is not small against the rest
        double worst = 0;
        for (const Angles& angles : someAngles(60, 1.2)) {
          const auto f = sum.getBRDF(angles.there()).at(0),
                     b = sum.getBRDF(angles.back()).at(0);
          for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
              worst = std::max(worst,
                               std::abs(f.getMueller(i, j) -
                                        ((i == 2) == (j == 2) ? 1 : -1) * b.getMueller(j, i)));
        }
        return worst;
      };
  EXPECT_LT(violation(model), 1e-10);  // azimuths of nearby directions
  // negative control: a model that breaks the law, and its sum, which cannot
  const BRDFTorranceSparrow thesis(0.405, 2.950, 0.3);
  EXPECT_GT(violation(thesis), 1e-3);
  EXPECT_LT(violation(BRDFBasis(fitBasis(thesis, 4, 0.3))), 1e-10);
}

TEST(BRDFBasisInvariant, OrdersConverge) {
  const BRDFTorranceSparrow metal = copper();
  double before = 1;
  for (const int order : {2, 4, 6, 8}) {
    const double error = compareModels(metal, BRDFBasis(fitBasis(metal, order, 0.3))).error;
    EXPECT_LT(error, before) << order;
    before = error;
  }
  EXPECT_LT(before, 0.02);
  EXPECT_EQ(compareModels(metal, metal).error, 0);
  EXPECT_EQ(compareModels(metal, metal).unrealizable, 0);
  EXPECT_GT(compareModels(metal, copper(0.35)).error, 0.02);  // control
}

TEST(BRDFBasisIdentity, AllBandsInOneCall) {
  const BRDFBasis model(fitBasis(manyMetals(), 4, 0.3));
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
  EXPECT_LT(compareModels(manyMetals(), model).error, 0.06);
  EXPECT_NEAR(model.getDHR(0.5)[70] / manyMetals().getDHR(0.5)[70], 1, 0.03);
}

TEST(BRDFBasisIdentity, UnpolarisedStaysUnpolarised) {
  const auto grid = manyBands();
  const BRDFDiffuse lambert(ramp(grid, 0.2, 0.7), 1);
  const BRDFBasis model(fitBasis(lambert, 2, 1));
  EXPECT_FALSE(model.coefficients().polarized);
  EXPECT_FALSE(model.getBRDF(BRDFGeometry::fromDegrees(30, 40, 170)).anyPolarized());
  expectScatterIsTheMatrix(model, 1e-13);
}

TEST(BRDFBasisInvariant, TheSampler) {
  const BRDFBasis model(fitBasis(copper(), 6, 0.3));
  expectSamplesFollowDensity(model);
  EXPECT_LT(draw(model, BRDFBasis(fitBasis(copper(0.2), 6, 0.3)), 0.6).p_value,
            false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(model), 0.02);
}

TEST(BRDFBasisIdentity, BetweenWavelengths) {
  const BasisCoefficients two = randomCoefficients(2, 0.2, SpectralGrid::make({500.0, 600.0}));
  const auto g = BRDFGeometry::fromDegrees(30, 50, 160);
  const auto ends = BRDFBasis(two).getBRDF(g);
  const auto middle = BRDFBasis(two.resampled(SpectralGrid::make({525.0}))).getBRDF(g);
  for (int k = 0; k < 16; ++k)
    EXPECT_NEAR(middle.at(0).data()[k],
                0.75 * ends.at(0).data()[k] + 0.25 * ends.at(1).data()[k], 1e-13);
  EXPECT_THROW((void)two.resampled(SpectralGrid::make({601.0})), GridError);
}

TEST(BRDFBasisIdentity, TheFileGoesRound) {
  const Scratch scratch;
  const BasisCoefficients c = randomCoefficients(2, 0.2, SpectralGrid::make({500.0, 600.0}));
  const BasisCoefficients back = readText(scratch, basisTable(c));
  EXPECT_EQ(back.parts, c.parts);
  EXPECT_EQ(back.functions.width(), 0.2);
  EXPECT_EQ(back.functions.order(), 2);
  EXPECT_EQ(back.count(), c.count());
  const std::string whole = basisTable(c);
  EXPECT_THROW(readText(scratch, whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1)),
               InputError);  // a row less
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = basisTable(c);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    // sealed again, or the checksum would notice before the reader does
    text = sealTable(text.replace(at, from.size(), to), "basis");
    EXPECT_THROW(readText(scratch, text), InputError) << from << " -> " << to;
  };
  refused("order: 2", "order: 2.5");
  refused("order: 2", "order: 99");
  refused("width: 0.2", "width: 0");
  refused("width: 0.2", "width: wide");
  refused("polarized: yes", "polarized: perhaps");
  refused("polarized: yes", "polarized: no");
  refused("500,00,0,", "500,0x,0,");
  refused("500,00,0,0,0,", "500,00,1,0,0,");
  refused("500,00,0,0,0,", "500,00,0,0,7,");
}

TEST(BRDFBasisIdentity, ImpossibleSumsAreRefused) {
  EXPECT_THROW(BasisFunctions(-1, 1), MathError);
  EXPECT_THROW(BasisFunctions(13, 1), MathError);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()})
    EXPECT_THROW(BasisFunctions(2, bad), MathError);
  const auto grid = SpectralGrid::make({550.0});
  EXPECT_THROW(BRDFBasis({BasisFunctions(2, 1), grid, false, {}}), MathError);
  EXPECT_THROW(fitBasis(BRDFDiffuse(CDSpectralVector<double>(grid, 0.0), 0), 2), MathError);
  EXPECT_THROW(fitBasis(copper(), 13), MathError);
}

// The name of a part gives its elements of the matrix: "02-" the elements 02 and 20, and no
// others. A number along a diagonal
// is alone there. (A sine is nothing in the plane of incidence, so the geometries lie outside of it.)
TEST(BRDFBasisIdentity, APartIsWhereItsNameSays) {
  const auto grid = SpectralGrid::make({500.0});
  const BasisCoefficients all = randomCoefficients(3, 0.2, grid);
  for (std::size_t p = 0; p < 16; ++p) {
    BasisCoefficients one = all;
    for (std::size_t q = 0; q < 16; ++q)
      if (q != p) std::fill(one.parts[q].begin(), one.parts[q].end(), 0.0f);
    const BRDFBasis model(one);
    const std::string name = basis_parts[p].name;
    const int j = name[0] - '0', k = name[1] - '0';
    std::array<double, 16> most{};
    for (const Angles& angles : someAngles(20, 1.2)) {
      const CDMuellerMatrix f = model.getBRDF(angles.there()).at(0);
      for (int i = 0; i < 16; ++i)
        most[i] = std::max(most[i], std::abs(f.getMueller(i / 4, i % 4)));
    }
    for (int i = 0; i < 16; ++i) {
      const bool named = i == 4 * j + k || i == 4 * k + j;
      // the axes of incidence turn: elements of rows and columns 1 and 2 mix with each other, 0 and 3 do not
      const auto kind = [](int row) { return row == 0 || row == 3 ? row : 1; };
      if (kind(i / 4) == kind(j) && kind(i % 4) == kind(k)) continue;
      if (kind(i / 4) == kind(k) && kind(i % 4) == kind(j)) continue;
      EXPECT_FALSE(named);
      EXPECT_LT(most[i], 1e-9) << name << " is seen in " << i / 4 << i % 4;
    }
    EXPECT_GT(std::max(most[4 * j + k], most[4 * k + j]), 1e-6) << name;
  }
}
