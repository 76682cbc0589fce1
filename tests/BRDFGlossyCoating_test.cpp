// A clear layer over a matt substrate (nw/surface/BRDFGlossyCoating.nw) against published numbers, the series
// summed term by term, and facets drawn at random.
#include "malus/surface/BRDFGlossyCoating.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ModelChecks.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

BRDFGlossyCoating coating(double n, double rho, double sigma) {
  const auto grid = SpectralGrid::make({550.0});
  return BRDFGlossyCoating(CDSpectralVector<double>(grid, n),
                           CDSpectralVector<double>(grid, rho), sigma);
}
BRDFGlossyCoating varied(double sigma) {
  const auto grid = manyBands();
  return BRDFGlossyCoating(ramp(grid, 1.3, 1.7), ramp(grid, 0.0, 0.9), sigma);
}
CDMuellerMatrix at(const BRDFGlossyCoating& model, double theta_i, double theta_r, double phi) {
  return model.getBRDF(BRDFGeometry::fromDegrees(theta_i, theta_r, phi)).at(0);
}

/// Power that a smooth boundary passes, by Snell's angle as in a textbook.
struct Passed {
  double s, p;
};
Passed passed(double theta, double n) {
  const double inside = std::asin(std::sin(theta) / n);
  if (theta < 1e-9) return {4 * n / ((n + 1) * (n + 1)), 4 * n / ((n + 1) * (n + 1))};
  const double s = std::sin(theta - inside) / std::sin(theta + inside);
  const double p = std::tan(theta - inside) / std::tan(theta + inside);
  return {1 - s * s, 1 - p * p};
}
/// T0 and T1 of a rough boundary by facets drawn at random, with the plane of incidence from vectors.
struct Mean {
  double value, error;
};
std::array<Mean, 2> drawnTransmission(double zenith, double n, double sigma, int draws) {
  const CDVector source = CDVector::fromAngles(zenith, 0.4), k = -source;
  const CDVector s = normalized(cross({0, 0, 1}, k)), p = cross(k, s);
  Random random(7);
  std::array<double, 2> sum{}, squares{};
  for (int i = 0; i < draws; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    const CDVector m = sampleVGrooveNormal(source, sigma, u1, u2, u3);
    const Passed t = passed(std::acos(std::min(dot(m, source), 1.0)), n);
    const CDVector sm = normalized(cross(m, k));
    const double c = dot(s, sm), d = dot(p, sm);
    const std::array<double, 2> x{(t.s + t.p) / 2, (t.s - t.p) / 2 * (c * c - d * d)};
    for (int j = 0; j < 2; ++j) sum[j] += x[j], squares[j] += x[j] * x[j];
  }
  std::array<Mean, 2> out;
  for (int j = 0; j < 2; ++j) {
    const double mean = sum[j] / draws;
    out[j] = {mean, std::sqrt((squares[j] / draws - mean * mean) / draws)};
  }
  return out;
}
}  // namespace

// A viewer in the plane of the surface still counts as above it, by both ways of adding light; 1e-5: single precision.
TEST(BRDFGlossyCoatingIdentity, GatherAlongTheSurfaceIsScatter) {
  const auto grid = SpectralGrid::make({550.0});
  const BRDFGlossyCoating model = coating(1.5, 0.5, 0.2);
  const CDVector along{1, 0, 0}, source = CDVector::fromAngles(0.7, 2);
  const CDSpectralVector<CDStokesVector> light(grid, CDStokesVector(3.0));
  const float x = float(source.x), y = float(source.y), z = float(source.z), weight = 0.25f;
  CDSpectralVector<CDStokesVector> gathered(grid), scattered(grid);
  model.gather(along, {1, &x, &y, &z, &weight}, light, gathered);
  model.scatter(BRDFGeometry::fromDirections(source, along), 0.25, light, scattered);
  const double expected = CDStokesVector(scattered.at(0)).getScalar();
  EXPECT_GT(expected, 0) << "negative control: there is something to see";
  EXPECT_NEAR(CDStokesVector(gathered.at(0)).getScalar(), expected, 1e-5 * expected);
}

// Diffuse reflection inside and outside of n = 1.5: .596 and .092 (Judd 1942), to the digits printed.
TEST(BRDFGlossyCoatingPublished, ReflectanceForDiffuseLight) {
  const double inner = coating(1.5, 0.5, 0).getInnerReflectance(0);
  EXPECT_NEAR(inner, 0.596, 5e-4);
  EXPECT_NEAR(1 - 2.25 * (1 - inner), 0.092, 5e-4);
  EXPECT_GT(std::abs(coating(1.51, 0.5, 0).getInnerReflectance(0) - 0.596), 5e-4);  // control
}

// Polarisation of diffuse light that leaves a smooth dielectric, in closed form (Atkinson and Hancock 2006, eq 10).
TEST(BRDFGlossyCoatingPublished, PolarizationOfTheMattPart) {
  for (const double n : {1.2, 1.5, 2.0})
    for (const double view : {10.0, 45.0, 60.0, 80.0, 89.0}) {
      const double s2 = std::pow(std::sin(view * degree), 2), c = std::cos(view * degree);
      const double published =
          std::pow(n - 1 / n, 2) * s2 /
          (2 + 2 * n * n - std::pow(n + 1 / n, 2) * s2 + 4 * c * std::sqrt(n * n - s2));
      const CDMuellerMatrix f = at(coating(n, 0.5, 0), 20, view, 77);
      EXPECT_NEAR(-f.getMueller(1, 0) / f.getMueller(0, 0), published, 1e-13);  // along p
      EXPECT_EQ(f.getMueller(2, 0), 0);
      if (view > 50) {  // negative control: the other sign
        EXPECT_GT(std::abs(f.getMueller(1, 0) / f.getMueller(0, 0) - published), 1e-2);
      }
    }
}

// The numbers of the chapter, to the digits that it shows.
TEST(BRDFGlossyCoatingIdentity, TheExampleOfTheChapter) {
  const CDMuellerMatrix f = at(coating(1.5, 0.5, 0), 0, 60, 180);
  EXPECT_NEAR(f.getMueller(0, 0), 0.0881, 5e-5);
  EXPECT_NEAR(f.getMueller(1, 0) / f.getMueller(0, 0), -0.096, 5e-4);
}

// The bounces one after another: down through the boundary, up, out or back, as in figure 5.3 of the thesis.
TEST(BRDFGlossyCoatingIdentity, TheSeriesSummedTermByTerm) {
  for (const double n : {1.1, 1.5, 2.5})
    for (const double rho : {0.1, 0.9}) {
      // share that returns inside, by a sum over inner angles; beyond the critical angle all of it
      constexpr int steps = 200000;
      double inner = 0;
      for (int i = 0; i < steps; ++i) {
        const double sin2 = (i + 0.5) / steps;  // uniform in sin^2: weighs with the cosine
        const double outside = n * std::sqrt(sin2);
        const Passed t = outside < 1 ? passed(std::asin(outside), n) : Passed{0, 0};
        inner += (1 - (t.s + t.p) / 2) / steps;
      }
      const Passed in = passed(0.5, n), out = passed(1.1, n);
      double upward = 0, bounce = rho * (in.s + in.p) / 2;
      for (int i = 0; i < 400; ++i) upward += bounce, bounce *= inner * rho;
      const double expected = upward / pi / (n * n) * (out.s + out.p) / 2;
      const double ours =
          coating(n, rho, 0).getBRDF(BRDFGeometry::fromAngles(0.5, 1.1, 2)).at(0).getScalar();
      EXPECT_NEAR(ours / expected, 1, 1e-5);  // the root at the critical angle, in steps
      EXPECT_GT(std::abs(ours / (expected * (1 - rho * inner)) - 1),
                1e-2);  // control: no series
    }
}

TEST(BRDFGlossyCoatingIdentity, WithoutABoundaryTheSubstrateIsBare) {
  const CDMuellerMatrix f = at(coating(1, 0.5, 0), 30, 70, 100);
  EXPECT_NEAR(f.getScalar(), 0.5 / pi, 1e-12);
  EXPECT_NEAR(f.getMueller(1, 1), 0, 1e-12);
}

TEST(BRDFGlossyCoatingInvariant, AWhiteSubstrateLosesNothing) {
  for (const double zenith : {0.0, 0.7, 1.5}) {
    const Passed t = passed(zenith, 1.5);
    EXPECT_NEAR(coating(1.5, 1, 0).getVolumeDHR(zenith)[0], (t.s + t.p) / 2, 1e-12);
  }
  // with facets the sum lacks what their neighbours block, and never exceeds one
  for (const double sigma : {0.01, 0.05, 0.2, 0.5, 1.5})
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0, 89.9}) {
      const double dhr = coating(1.5, 1, sigma).getDHR(degrees * degree)[0];
      EXPECT_LE(dhr, 1 + 1e-9) << sigma << ' ' << degrees;
      EXPECT_GE(dhr, sigma < 0.1 ? 0.9 : 0.6) << sigma << ' ' << degrees;
    }
  EXPECT_NEAR(coating(1.5, 1, 0.01).getDHR(0.5)[0], 1, 1e-4);  // hardly any are blocked
}

TEST(BRDFGlossyCoatingIdentity, TheRoughBoundaryPassesWhatItsFacetsPass) {
  for (const double sigma : {0.1, 0.4})
    for (const double zenith : {0.3, 1.0, 1.4, 1.55}) {
      const auto drawn = drawnTransmission(zenith, 1.5, sigma, 200000);
      const BRDFGlossyCoating model = coating(1.5, 1, sigma);
      const double ours0 = model.getVolumeDHR(zenith)[0];  // all that enters a white substrate
      EXPECT_NEAR(ours0, drawn[0].value,
                  5 * drawn[0].error + 5e-5);  // straight lines in the table
      // T1 from a matrix: f10/f00 of the volume alone is T1/T0 of the viewer; take it behind the lobe
      const BRDFGeometry g = BRDFGeometry::fromAngles(0.0, zenith, 0);
      const auto facets =
          BRDFTorranceSparrow(1.5, 0, sigma, {Shadowing::vGroove, DiffuseTerm::none, true})
              .at(g);
      const CDMuellerMatrix f = model.getBRDF(g).at(0);
      const double ours1 = ours0 * (f.getMueller(1, 0) - facets.getMueller(1, 0)) /
                           (f.getMueller(0, 0) - facets.getMueller(0, 0));
      EXPECT_NEAR(ours1, drawn[1].value, 5 * drawn[1].error + 5e-5) << sigma << ' ' << zenith;
      if (zenith > 0.9) {  // negative control
        const auto rougher = drawnTransmission(zenith, 1.5, 1.5 * sigma, 200000);
        EXPECT_GT(std::abs(ours1 - rougher[1].value), 5 * rougher[1].error);
      }
    }
}

TEST(BRDFGlossyCoatingIdentity, ASmoothLimitIsFresnels) {
  const auto rough = coating(1.5, 0.5, 1e-4), smooth = coating(1.5, 0.5, 0);
  for (const double zenith : {0.0, 0.5, 1.0, 1.4, 1.55})  // straight lines between 129 nodes
    EXPECT_NEAR(rough.getVolumeDHR(zenith)[0], smooth.getVolumeDHR(zenith)[0], 5e-5);
}

TEST(BRDFGlossyCoatingIdentity, DHRAgreesWithThePlainIntegration) {
  expectDHRIsTheIntegral(varied(0), 1e-5);    // bends of the table, seen by 60 points
  expectDHRIsTheIntegral(varied(0.4), 2e-4);  // and the kinks of the grooves
}

TEST(BRDFGlossyCoatingInvariant, ReciprocalRealizableAndFast) {
  for (const double sigma : {0.0, 0.2}) {
    const BRDFGlossyCoating model = varied(sigma);
    EXPECT_LT(reciprocityError(model), 1e-10);                // rotations near the normal
    EXPECT_GT(reciprocityError(model, {1, -1, 1, 1}), 1e-3);  // negative control
    expectRealizable(model, 1e-9);
    expectScatterIsTheMatrix(model, 1e-13);
    expectNoAllocation(model);
    expectScoreAndHorizon(model);
    EXPECT_LE(largestDHR(model), 1);
  }
}

TEST(BRDFGlossyCoatingIdentity, GatherIsTheSumOfScatter) {
  for (const double sigma : {0.0, 0.3}) {
    const BRDFGlossyCoating model = varied(sigma);
    constexpr std::size_t count = 40;
    std::array<float, count> x, y, z, w;
    Random random(3);
    for (std::size_t i = 0; i < count; ++i) {
      const CDVector v = CDVector::fromAngles(1.7 * random.uniform(), 6 * random.uniform());
      x[i] = float(v.x), y[i] = float(v.y), z[i] = float(v.z), w[i] = 0.05f;
    }
    const CDVector viewer = CDVector::fromAngles(0.8, 1.0);
    CDSpectralVector<CDStokesVector> light(model.grid(), CDStokesVector(2.0)),
        fast(model.grid()), plain(model.grid());
    fast.polarize(), plain.polarize();
    const LightDirections from{count, x.data(), y.data(), z.data(), w.data()};
    model.gather(viewer, from, light, fast);
    model.CDBRDFModel::gather(viewer, from, light, plain);
    for (std::size_t band = 0; band < light.size(); ++band)
      for (int k = 0; k < 4; ++k)  // single precision of directions and facets
        EXPECT_NEAR(fast.at(band).getStokes(k), plain.at(band).getStokes(k),
                    2e-5 * plain.at(band).getScalar() + 1e-9);
    EXPECT_GT(plain.at(149).getScalar(), 0.1);
  }
}

TEST(BRDFGlossyCoatingInvariant, SamplesFollowTheirDensity) {
  expectSamplesFollowDensity(varied(0.3));
  expectSamplesFollowDensity(varied(0));
  EXPECT_LT(draw(varied(0.3), varied(0.4), 0.6).p_value, false_alarm);  // negative control
}

TEST(BRDFGlossyCoatingInvariant, TheSamplerGivesTheDHR) {
  EXPECT_LT(expectSamplerGivesDHR(coating(1.5, 0.3, 0.1)), 0.01);
  EXPECT_LT(expectSamplerGivesDHR(coating(1.5, 0.0, 0.02)), 0.01);
}

TEST(BRDFGlossyCoatingIdentity, ImpossibleCoatingsAreRefused) {
  for (const double bad : {-0.1, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_THROW(coating(bad, 0.5, 0.1), MathError);
    EXPECT_THROW(coating(1.5, bad, 0.1), MathError);
    EXPECT_THROW(coating(1.5, 0.5, bad), MathError);
  }
  EXPECT_THROW(coating(0.99, 0.5, 0.1), MathError);
  EXPECT_THROW(coating(1.5, 0.5, 1e-7), MathError);
  EXPECT_THROW(coating(1.5, 0.5, 0.1).getDHR(pi / 2), MathError);
  EXPECT_THROW(coating(1.5, 0.5, 0).sample({0, 0, -1}, 0.1, 0.2, 0.3), MathError);
}
