// Five wavelengths and a measured spectrum (nw/surface/BRDFNEFDS.nw).
#include "malus/surface/BRDFNEFDS.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "ModelChecks.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

namespace {
constexpr double sphere = 20 * degree;

BeardMaxwellParameters lasers() {
  const auto grid = SpectralGrid::make({350.0, 647.0, 1060.0, 3390.0, 10600.0});
  BeardMaxwellParameters p{{grid, 1.3},  {grid, 7.5},  {grid, 0.01},
                           {grid, 0.25}, {grid, 0.02}, {grid, 0.01}};
  for (std::size_t j = 0; j < 5; ++j)
    p.n[j] += 0.3 * double(j), p.k[j] += double(j), p.bias[j] += 0.004 * double(j),
        p.sigma[j] -= 0.03 * double(j);
  return p;
}

CDSpectralVector<double> measured() {
  const auto grid = SpectralGrid::make({350.0, 400.0, 500.0, 647.0, 900.0, 5000.0, 10600.0});
  CDSpectralVector<double> dhr(grid, 0.0);
  for (std::size_t j = 0; j < dhr.size(); ++j) dhr[j] = 0.3 + 0.05 * double(j);
  return dhr;
}
}  // namespace

TEST(BRDFNEFDSIdentity, TheMeasuredDHRComesBack) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  const auto at_sphere = model.getDHR(sphere), elsewhere = model.getDHR(75 * degree);
  for (std::size_t j = 0; j < at_sphere.size(); ++j) {
    EXPECT_NEAR(at_sphere[j], measured()[j], 1e-14);  // rounding of a quotient
    EXPECT_GT(std::abs(elsewhere[j] - measured()[j]), 1e-3);
  }
}

// The same closure by the plain sum over directions, with the solid angle and without its sine.
TEST(BRDFNEFDSIdentity, TheDifferentialsAsPrintedDoNotClose) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  const BRDFBeardMaxwell reference(lasers());
  constexpr int zeniths = 300, azimuths = 180;
  const auto integral = [&](const CDBRDFModel& m, std::size_t band, bool sine) {
    double sum = 0;
    CDSpectralVector<CDMuellerMatrix> f(m.grid());
    for (int z = 0; z < zeniths; ++z)
      for (int a = 0; a < azimuths; ++a) {
        const double zenith = 90 * degree * (z + 0.5) / zeniths;
        m.evaluate(
            BRDFGeometry::fromAngles(sphere, zenith, 180 * degree * (a + 0.5) / azimuths), f);
        sum += f.at(band).getScalar() * std::cos(zenith) * (sine ? std::sin(zenith) : 1);
      }
    return sum * 2 * 90 * degree / zeniths * 180 * degree / azimuths;
  };
  // at 500 nm, between the first two lasers; midpoints in a lobe of a quarter radian, 0.5 degrees apart
  EXPECT_NEAR(integral(model, 2, true), measured()[2], 1e-3 * measured()[2]);
  const double A = (647.0 - 500) / (647 - 350), B = 1 - A;
  const double printed =
      measured()[2] * (A * integral(reference, 0, true) / integral(reference, 0, false) +
                       B * integral(reference, 1, true) / integral(reference, 1, false));
  EXPECT_GT(std::abs(printed / measured()[2] - 1), 0.1);
}

TEST(BRDFNEFDSIdentity, AtALaserItIsBeardAndMaxwell) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  const BRDFBeardMaxwell reference(lasers());
  const auto g = BRDFGeometry::fromDegrees(30, 55, 130);
  const auto f = model.getBRDF(g), r = reference.getBRDF(g);
  const double scale = measured()[3] / reference.getDHR(sphere)[1];
  for (int e = 0; e < 16; ++e) {
    EXPECT_NEAR(f.at(3).getMueller(e / 4, e % 4), scale * r.at(1).getMueller(e / 4, e % 4),
                1e-13);
  }
  EXPECT_GT(std::abs(f.at(4).getScalar() - scale * r.at(1).getScalar()),
            1e-3);  // 900 nm is not a laser's wavelength
}

TEST(BRDFNEFDSIdentity, LambertsShapeIsTheSameAtAllLasers) {
  const auto grid = SpectralGrid::make({500.0, 600.0});
  BeardMaxwellParameters p{{grid, 1.5}, {grid, 0.0}, {grid, 0.0},
                           {grid, 0.3}, {grid, 0.0}, {grid, 0.0}};
  p.rho_d[0] = 0.10, p.rho_d[1] = 0.12;  // amounts differ, shapes do not
  CDSpectralVector<double> dhr(SpectralGrid::make({550.0}), 0.40);
  const BRDFNEFDS model(p, dhr, sphere);
  EXPECT_NEAR(model.getBRDF(BRDFGeometry::fromDegrees(10, 20, 30)).at(0).getScalar(),
              0.40 / std::numbers::pi, 1e-14);
}

TEST(BRDFNEFDSIdentity, TheLightIsTheMatrixTimesTheLight) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  const auto g = BRDFGeometry::fromDegrees(20, 60, 140);
  for (const bool polarized : {true, false}) {
    const CDSpectralVector<CDStokesVector> in(
        model.grid(), polarized ? CDStokesVector(1, .4, -.3, .2) : CDStokesVector(1));
    CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
    model.scatter(g, 0.8, in, fast);
    model.CDBRDFModel::scatter(g, 0.8, in, plain);
    for (std::size_t j = 0; j < in.size(); ++j)
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(fast.at(j).getStokes(c), plain.at(j).getStokes(c), 1e-14);
    model.scatter(g, 0.8, in, fast);
    EXPECT_GT(std::abs(fast.at(1).getScalar() - plain.at(1).getScalar()), 1e-3);  // it adds
  }
}

TEST(BRDFNEFDSInvariant, MatricesAreRealizable) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  for (const double phi : {0.0, 1.0, 2.0, 3.0}) {
    const auto f = model.getBRDF(BRDFGeometry::fromAngles(0.5, 1.2, phi));
    for (std::size_t j = 0; j < f.size(); ++j) EXPECT_TRUE(isRealizable(f.at(j), 1e-12));
  }
  EXPECT_FALSE(
      isRealizable(CDMuellerMatrix({1, 0, 0, 0, 0, 1.1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), 1e-12));
}

TEST(BRDFNEFDSInvariant, SamplesFollowTheirDensity) {
  const BRDFNEFDS model(lasers(), measured(), sphere);
  auto other = lasers();
  for (std::size_t j = 0; j < 5; ++j) other.sigma[j] *= 1.06;
  EXPECT_GT(malus::testing::draw(model, model, 0.7).p_value, 1e-6);
  EXPECT_LT(malus::testing::draw(model, BRDFNEFDS(other, measured(), sphere), 0.7).p_value,
            1e-6);
}

TEST(BRDFNEFDSInvariant, PassesWhatEveryModelMust) {
  using namespace malus::testing;
  const BRDFNEFDS model(lasers(), ramp(manyBands(), 0.2, 0.6), sphere);
  EXPECT_LT(reciprocityError(model), 1e-11);
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
}

TEST(BRDFNEFDSInvariant, RefusesWhatCannotBe) {
  EXPECT_NO_THROW(BRDFNEFDS(lasers(), measured(), sphere));
  const CDSpectralVector<double> beyond(SpectralGrid::make({300.0, 500.0}), 0.5);
  EXPECT_THROW(BRDFNEFDS(lasers(), beyond, sphere), GridError);
  auto dhr = measured();
  dhr[2] = 1.01;
  EXPECT_THROW(BRDFNEFDS(lasers(), dhr, sphere), MathError);
  auto dark = lasers();
  dark.bias[1] = dark.rho_d[1] = dark.rho_v[1] = 0;
  EXPECT_THROW(BRDFNEFDS(dark, measured(), sphere), MathError);
}

// A reflectance lies between nothing and all.
TEST(BRDFNEFDSIdentity, ReflectancesAreTakenUpToTheirEnds) {
  const auto grid = SpectralGrid::make({550.0});
  const ModelEntry& entry = modelEntry("nefds", {});
  for (const char* good : {"dhr=0", "dhr=0.5", "dhr=1"})
    EXPECT_NO_THROW(exampleModel(entry, grid, good)) << good;
  for (const char* bad : {"dhr=-0.01", "dhr=1.01"})
    EXPECT_THROW(exampleModel(entry, grid, bad), InputError) << bad;
}
