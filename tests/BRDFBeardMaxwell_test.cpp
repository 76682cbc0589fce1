// The measured surface (nw/surface/BRDFBeardMaxwell.nw) against its scan, plain sums and Torrance-Sparrow.
#include "malus/surface/BRDFBeardMaxwell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "ModelChecks.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;

BeardMaxwellParameters aluminium(std::size_t bands = 1, double rho_d = 0.02,
                                 double rho_v = 0.01) {
  std::vector<double> nm;
  for (std::size_t j = 0; j < bands; ++j) nm.push_back(500 + 50 * double(j));
  const auto grid = SpectralGrid::make(nm);
  BeardMaxwellParameters p{{grid, 1.3},  {grid, 7.5},   {grid, 0.02},
                           {grid, 0.25}, {grid, rho_d}, {grid, rho_v}};
  for (std::size_t j = 0; j < bands; ++j) {
    p.n[j] += 0.1 * double(j), p.bias[j] += 0.001 * double(j);
    if (j > 1) p.sigma[j] = 0.2;
  }
  return p;
}

BeardMaxwellParameters paint() {
  auto p = aluminium();
  p.n[0] = 1.5, p.k[0] = 0, p.bias[0] = 0.01, p.sigma[0] = 0.2;
  return p;
}

double f00(const CDBRDFModel& model, const BRDFGeometry& g, std::size_t band = 0) {
  return model.getBRDF(g).at(band).getScalar();
}
}  // namespace

// The zero bistatic scan is recovered for every tilt, which decides the misprint of eq 5.8.
TEST(BRDFBeardMaxwellIdentity, TheScanComesBack) {
  auto p = aluminium(1, 0, 0);
  const BRDFBeardMaxwell model(p);
  const CauchyFit scan{p.bias[0], p.sigma[0]};
  for (double tilt = 0; tilt < 85; tilt += 5) {
    const double expected = scan(tilt * degree);
    const double got = f00(model, BRDFGeometry::fromDegrees(tilt, tilt, 0));
    EXPECT_NEAR(got / expected, 1, 1e-12) << tilt;  // rounding
    // as printed in 5.8, angles in degrees: far from one unless the tilt is zero
    const double printed = (1 + tilt) / (1 + tilt / 40);
    if (tilt > 0) {
      EXPECT_GT(std::abs(got * printed / expected - 1), 1);
    }
  }
}

TEST(BRDFBeardMaxwellPublished, ShadowingForMaxwellsParameters) {
  // by hand for tau = 15, Omega = 40: tilt 20 deg, beta 30 deg: (1 + 0.5 e^-4)/1.5
  EXPECT_NEAR(shadowingObscuration(30, 20, 15, 40), (1 + 0.5 * std::exp(-4.0)) / 1.5, 1e-15);
  EXPECT_EQ(shadowingObscuration(0, 55, 15, 40), 1);
  EXPECT_GT(std::abs(shadowingObscuration(30, 20, 0.2618, 0.6981) -
                     shadowingObscuration(30, 20, 15, 40)),
            0.1);
}

TEST(BRDFBeardMaxwellIdentity, ExampleByHand) {
  auto p = paint();
  const BRDFBeardMaxwell model(p);
  const auto g = BRDFGeometry::fromDegrees(30, 30, 180);
  const double R30 =
      0.5 * (std::pow((std::cos(30 * degree) - std::sqrt(2.25 - 0.25)) /
                          (std::cos(30 * degree) + std::sqrt(2.25 - 0.25)),
                      2) +
             std::pow((2.25 * std::cos(30 * degree) - std::sqrt(2.25 - 0.25)) /
                          (2.25 * std::cos(30 * degree) + std::sqrt(2.25 - 0.25)),
                      2));
  const double inside = 0.02 + 0.01 / std::cos(30 * degree);
  EXPECT_NEAR(f00(model, g), 0.25 / (0.04 * 0.75) * R30 + inside, 1e-14);
  EXPECT_NEAR(f00(model, g) - inside, 0.346, 0.0005);  // three digits, as in the chapter
}

// Both models send light by the same facets: their specular matrices are proportional.
TEST(BRDFBeardMaxwellIdentity, MatricesAreProportionalToTorranceAndSparrows) {
  const auto p = aluminium(1, 0, 0);
  TorranceSparrowOptions options;
  options.diffuse = DiffuseTerm::none, options.shadowing = Shadowing::none;
  const BRDFTorranceSparrow ts(1.3, 7.5, 0.4, options);
  const BRDFTorranceSparrow glass(1.5, 0, 0.4, options);
  const BRDFBeardMaxwell model(p);
  for (const double phi : {20.0, 120.0, 175.0}) {
    const auto g = BRDFGeometry::fromDegrees(50, 35, phi);
    const CDMuellerMatrix a = model.getBRDF(g).at(0), b = ts.at(g), c = glass.at(g);
    const double ratio = a.getScalar() / b.getScalar();
    double worst = 0, control = 0;
    for (int e = 0; e < 16; ++e) {
      worst = std::max(
          worst, std::abs(a.getMueller(e / 4, e % 4) - ratio * b.getMueller(e / 4, e % 4)));
      control = std::max(control,
                         std::abs(a.getMueller(e / 4, e % 4) -
                                  a.getScalar() / c.getScalar() * c.getMueller(e / 4, e % 4)));
    }
    EXPECT_LT(worst, 1e-13 * a.getScalar());
    EXPECT_GT(control, 1e-2 * a.getScalar());
  }
}

TEST(BRDFBeardMaxwellIdentity, TheInnerLightDepolarises) {
  const BRDFBeardMaxwell all(aluminium()), surface(aluminium(1, 0, 0));
  const auto g = BRDFGeometry::fromDegrees(50, 20, 70);
  const CDMuellerMatrix a = all.getBRDF(g).at(0), b = surface.getBRDF(g).at(0);
  EXPECT_NEAR(a.getScalar() - b.getScalar(),
              0.02 + 0.02 / (std::cos(50 * degree) + std::cos(20 * degree)), 1e-15);
  for (int e = 1; e < 16; ++e)
    EXPECT_EQ(a.getMueller(e / 4, e % 4), b.getMueller(e / 4, e % 4));
}

TEST(BRDFBeardMaxwellIdentity, FunctionsOfTheVolumeEnterIt) {
  auto p = aluminium(1, 0, 0.01);
  p.f = {{0, 90}, {1, 0}};            // falls to nothing at 90 degrees
  p.g = {{10, 20, 30}, {2, 1, 0.5}};  // constant beyond
  const BRDFBeardMaxwell model(p), surface(aluminium(1, 0, 0)), plain(aluminium(1, 0, 0.01));
  const auto g = BRDFGeometry::fromDegrees(40, 40, 180);  // beta 40, tilt 0
  const double volume = 0.01 / std::cos(40 * degree);
  EXPECT_NEAR(f00(model, g) - f00(surface, g), volume * (50. / 90) * 2, 1e-14);
  EXPECT_NEAR(f00(plain, g) - f00(surface, g), volume, 1e-14);
  const auto h = BRDFGeometry::fromDegrees(25, 25, 0);  // beta 0, tilt 25
  EXPECT_NEAR(f00(model, h) - f00(surface, h), 0.01 / std::cos(25 * degree) * 0.75, 1e-14);
}

// The DHR by tilts against the sum over directions that every model inherits.
TEST(BRDFBeardMaxwellIdentity, DHRIsTheIntegral) {
  auto p = aluminium(3);
  for (std::size_t j = 0; j < 3; ++j) p.sigma[j] += 0.3;  // wide enough for the plain rule
  const BRDFBeardMaxwell model(p);
  for (const double zenith : {0.0, 0.5, 1.1, 1.4}) {
    const auto fast = model.getDHR(zenith), plain = model.CDBRDFModel::getDHR(zenith);
    for (std::size_t j = 0; j < 3; ++j)
      // the plain rule, 60 x 128 points, meets the cone of the shadowing function at tilt 0
      EXPECT_NEAR(fast[j] / plain[j], 1, 2e-4) << zenith;
  }
  EXPECT_GT(std::abs(model.getDHR(0.5)[0] / model.CDBRDFModel::getDHR(0.7)[0] - 1), 2e-3);
}

TEST(BRDFBeardMaxwellIdentity, DHROfTheVolumeInClosedForm) {
  auto p = aluminium(1, 0.03, 0.02);
  p.bias[0] = 0;
  const BRDFBeardMaxwell closed(p);
  p.f = {{0, 90}, {1, 1}};  // one, but said as a function
  const BRDFBeardMaxwell summed(p);
  for (const double zenith : {0.0, 0.6, 1.5}) {
    const double c = std::cos(zenith);
    EXPECT_NEAR(closed.getDHR(zenith)[0],
                pi * 0.03 + 0.02 * 4 * pi * (1 - c * std::log((1 + c) / c)), 1e-12);
    EXPECT_NEAR(summed.getDHR(zenith)[0], closed.getDHR(zenith)[0],
                1e-9);  // panels of 16 points
  }
}

TEST(BRDFBeardMaxwellInvariant, TheSecondFactorOf510BreaksReciprocity) {
  // tilt 20, zeniths 10 and 60: the factor with source and viewer exchanged
  EXPECT_GT(std::abs(1 / (1 + 20. / 40 * 10. / 40) - 1 / (1 + 20. / 40 * 60. / 40)), 0.1);
}

TEST(BRDFBeardMaxwellInvariant, MatricesAreRealizable) {
  const BRDFBeardMaxwell metal(aluminium(4)), dielectric(paint());
  for (const double ti : {0.0, 0.7, 1.4})
    for (const double tr : {0.1, 0.9, 1.5})
      for (const double phi : {0.0, 0.9, 2.5, pi}) {
        const auto g = BRDFGeometry::fromAngles(ti, tr, phi);
        const auto f = metal.getBRDF(g);
        for (std::size_t j = 0; j < 4; ++j)
          EXPECT_TRUE(isRealizable(f.at(j), 1e-12 * (1 + f.at(j).getScalar())));
        EXPECT_TRUE(isRealizable(dielectric.getBRDF(g).at(0), 1e-12));
      }
  EXPECT_FALSE(
      isRealizable(CDMuellerMatrix({1, 0, 0, 0, 0, 1.1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), 1e-12));
}

// What all models pass, in 150 bands.
TEST(BRDFBeardMaxwellInvariant, PassesWhatEveryModelMust) {
  using namespace malus::testing;
  const auto grid = manyBands();
  const BRDFBeardMaxwell model({ramp(grid, 0.5, 2.5), ramp(grid, 1, 4), ramp(grid, 0.01, 0.02),
                                ramp(grid, 0.2, 0.3), ramp(grid, 0, 0.05),
                                ramp(grid, 0.03, 0)});
  EXPECT_LT(reciprocityError(model), 1e-11);
  EXPECT_GT(reciprocityError(model, {1, 1, 1, -1}), 1e-3);
  expectRealizable(model, 1e-11);
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
}

TEST(BRDFBeardMaxwellInvariant, EnergyIsNotPromised) {
  const BRDFBeardMaxwell model(aluminium());
  EXPECT_LT(model.getDHR(0)[0], 1);
  EXPECT_GT(model.getDHR(89.5 * degree)[0], 1);
}

TEST(BRDFBeardMaxwellInvariant, SamplesFollowTheirDensity) {
  constexpr double false_alarm = 1e-6;  // of one test; four are made
  const BRDFBeardMaxwell model(aluminium(4));
  for (const double zenith : {0.0, 0.7, 1.3}) {
    const auto drawn = malus::testing::draw(model, model, zenith);
    EXPECT_GT(drawn.p_value, false_alarm) << zenith;
    EXPECT_NEAR(drawn.rejected + drawn.density_integral, 1,
                5 * std::sqrt(0.25 / 200000) + 1e-3);
  }
  auto other = aluminium(4);
  for (std::size_t j = 0; j < 4; ++j) other.sigma[j] *= 1.05;
  EXPECT_LT(malus::testing::draw(model, BRDFBeardMaxwell(other), 0.7).p_value, false_alarm);
}

// A Monte-Carlo sum of f cos over the density is the DHR.
TEST(BRDFBeardMaxwellInvariant, SamplesGiveTheDHR) {
  const BRDFBeardMaxwell model(aluminium());
  const CDVector given = CDVector::fromAngles(0.6, 0.2);
  Random random(3);
  double sum = 0, square = 0;
  constexpr int draws = 100000;
  for (int i = 0; i < draws; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    const BRDFSample s = model.sample(given, u1, u2, u3);
    if (s.rejected()) continue;
    const double x = f00(model, BRDFGeometry::fromDirections(given, s.direction)) *
                     s.direction.z / s.density_per_sr;
    sum += x, square += x * x;
  }
  const double mean = sum / draws, error = std::sqrt((square / draws - mean * mean) / draws);
  EXPECT_NEAR(mean, model.getDHR(0.6)[0], 5 * error);  // five standard errors
  EXPECT_LT(error, 0.01 * mean);
}

TEST(BRDFBeardMaxwellIdentity, AFitFindsWhatWasPutIn) {
  std::vector<double> tilt, scan;
  const CauchyFit truth{0.013, 0.31};
  for (int i = 0; i < 40; ++i)
    tilt.push_back(2 * i * degree), scan.push_back(truth(tilt.back()));
  const CauchyFit fit = fitScan(tilt, scan);
  EXPECT_NEAR(fit.bias, truth.bias, 1e-6 * truth.bias);
  EXPECT_NEAR(fit.sigma, truth.sigma, 1e-6 * truth.sigma);
  for (double& value : scan) value += 0.01;  // not of the form any more
  EXPECT_GT(std::abs(fitScan(tilt, scan).sigma - truth.sigma), 1e-3);
  EXPECT_THROW(fitScan({0.1, 0.2}, {1, 2}), MathError);
}

TEST(BRDFBeardMaxwellInvariant, RefusesWhatCannotBe) {
  const auto with = [](auto change) {
    auto p = aluminium(2);
    change(p);
    return p;
  };
  EXPECT_NO_THROW(BRDFBeardMaxwell(with([](auto&) {})));
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.sigma[1] = 0; })), MathError);
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.bias[1] = -1; })), MathError);
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.rho_v[0] = std::nan(""); })), MathError);
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.tau_deg = 0; })), MathError);
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.n[0] = 1, p.k[0] = 0; })), MathError);
  EXPECT_THROW(BRDFBeardMaxwell(with([](auto& p) { p.rho_d = aluminium(3).rho_d; })),
               GridError);
}

TEST(BRDFBeardMaxwellInvariant, NoLightAtTheHorizon) {
  const BRDFBeardMaxwell model(aluminium());
  auto g = BRDFGeometry::fromDegrees(90, 90, 180);
  g.cos_i = g.cos_r = 0;
  EXPECT_EQ(f00(model, g), 0);
  EXPECT_GT(f00(model, BRDFGeometry::fromDegrees(89, 89, 180)), 1);
}

// Without facets all light comes from inside, and every direction is drawn by Lambert's law, however dark the paint.
TEST(BRDFBeardMaxwellIdentity, WithoutFacetsLambertsLawDraws) {
  for (const double rho_d : {0.2, 1e-4}) {
    auto p = aluminium(1, rho_d, 0);
    p.bias[0] = 0;
    const BRDFBeardMaxwell matt(p);
    const CDVector given = CDVector::fromAngles(0.6, 0);
    for (const double zenith : {0.0, 0.6, 1.4})
      EXPECT_NEAR(matt.density(given, CDVector::fromAngles(zenith, 2)), std::cos(zenith) / pi,
                  1e-12);
  }
  const CDVector up{0, 0,
                    1};  // negative control: with facets it is more in the mirror's direction
  EXPECT_GT(BRDFBeardMaxwell(aluminium()).density(up, up), 1.1 / pi);
}

// Widths are slopes from a millionth, a mirror's, to a thousand, nearly upright facets.
TEST(BRDFBeardMaxwellIdentity, WidthsAreTakenUpToTheirEnds) {
  const auto grid = SpectralGrid::make({550.0});
  const ModelEntry& entry = modelEntry("beard-maxwell", {});
  for (const char* good : {"sigma=1e-6", "sigma=1000"})
    EXPECT_NO_THROW(exampleModel(entry, grid, good)) << good;
  for (const char* bad : {"sigma=0.99e-6", "sigma=1001"})
    EXPECT_THROW(exampleModel(entry, grid, bad), InputError) << bad;
}
