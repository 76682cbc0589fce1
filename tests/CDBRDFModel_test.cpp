// The interface of all reflections and its default implementations (nw/surface/CDBRDFModel.nw).
#include "malus/surface/CDBRDFModel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "ChiSquared.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;

/// f00 = a + b mu_i mu_r + c sin_i sin_r cos phi: polynomial in the direction cosines,
/// reciprocal.
class Polynomial : public CDBRDFModel {
 public:
  explicit Polynomial(SpectralGridPtr grid) : CDBRDFModel(std::move(grid)) {}
  std::string_view name() const override { return "polynomial"; }
  void evaluate(const BRDFGeometry& g, CDSpectralVector<CDMuellerMatrix>& out) const override {
    requireGrid(out);
    for (std::size_t band = 0; band < out.size(); ++band) {
      const double x = static_cast<double>(band);
      const double m = !aboveHorizon(g) ? 0
                                        : 0.1 + 0.2 * x * g.cos_i * g.cos_r +
                                              0.05 * g.sin_i * g.sin_r * (1 - g.cos_phi);
      if (band == 1)
        out[band] = CDMuellerMatrix(m);
      else
        out[band] = m * diattenuator(1.0, 0.5, 0.3);
    }
  }
};

const SpectralGridPtr& grid() {
  static const SpectralGridPtr three = SpectralGrid::make({450.0, 550.0, 650.0});
  return three;
}
}  // namespace

// By hand: int a mu = pi a; int b mu_i mu^2 = 2 pi b mu_i/3; int c sin_i (1 - cos phi) sin mu =
// 2 pi c sin_i/3. The rule is exact for the polynomial; sin_r is a root, smooth enough but at
// mu = 1: 1e-7.
TEST(CDBRDFModelIdentity, ProductRuleGivesTheDHRWorkedByHand) {
  const Polynomial model(grid());
  for (const double zenith : {0.0, 0.4, 1.5}) {
    const auto dhr = model.getDHR(zenith);
    for (std::size_t band = 0; band < 3; ++band) {
      const double x = static_cast<double>(band),
                   t = band == 1 ? 1 : 0.75;  // mean of 1 and 0.5
      const double byhand = pi * 0.1 + 2 * pi / 3 * 0.2 * x * std::cos(zenith) +
                            2 * pi / 3 * 0.05 * std::sin(zenith);
      EXPECT_NEAR(dhr[band], t * byhand, 1e-6);
      EXPECT_GT(std::abs(dhr[band] - t * byhand * 1.001), 1e-5);  // negative control
    }
  }
  for (const double zenith : {-0.1, pi / 2, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(model.getDHR(zenith), MathError);
}

TEST(CDBRDFModelIdentity, ScatterIsTheMatrixTimesTheVectorAdded) {
  const Polynomial model(grid());
  const auto g = BRDFGeometry::fromDegrees(30, 40, 120);
  CDSpectralVector<CDStokesVector> in(grid(), CDStokesVector(2)),
      sum(grid(), CDStokesVector(1));
  in[1] = CDStokesVector(3, 1, -1, 0.5);
  model.scatter(g, 0.5, in, sum);
  const auto f = model.getBRDF(g);
  for (std::size_t band = 0; band < 3; ++band) {
    for (int i = 0; i < 4; ++i) {  // plain algebra, element by element; a few roundings
      double row = 0;
      for (int j = 0; j < 4; ++j) row += f.at(band).getMueller(i, j) * in.at(band).getStokes(j);
      EXPECT_NEAR(sum.at(band).getStokes(i), (i == 0) + 0.5 * row, 1e-15);
    }
    EXPECT_TRUE(sum.isPolarized(band));  // by the matrix, by the light, by the matrix
  }
}

// Where a model does not override gather(), it is the sum of scatter(); nothing comes from
// below, and unpolarised light stays unpolarised where the matrix allows it.
TEST(CDBRDFModelIdentity, GatheringIsTheSumOfScatter) {
  const Polynomial model(grid());
  const CDVector viewer = CDVector::fromAngles(0.6, 0);
  const std::vector<CDVector> sources{CDVector::fromAngles(0.5, 2),
                                      CDVector::fromAngles(1.2, 4),
                                      CDVector::fromAngles(2, 1)};  // the last from below
  std::vector<float> x, y, z, weight{0.5f, 0.25f, 1};
  std::vector<float> stokes(3 * 4 * 3, 0.0f), polarized = stokes;
  for (std::size_t i = 0; i < 3; ++i) {
    x.push_back(float(sources[i].x)), y.push_back(float(sources[i].y));
    z.push_back(float(sources[i].z));
    for (std::size_t band = 0; band < 3; ++band) stokes[i * 12 + band] = float(1 + i + band);
  }
  polarized = stokes, polarized[3] = 0.5f;
  const LightDirections from{3, x.data(), y.data(), z.data(), weight.data()};
  for (const auto& light : {stokes, polarized}) {
    CDSpectralVector<CDStokesVector> sum(grid()), byhand(grid());
    model.gatherEach(viewer, from, light, sum);
    for (std::size_t i = 0; i < 2; ++i) {
      CDSpectralVector<CDStokesVector> one(grid());
      for (std::size_t band = 0; band < 3; ++band)
        one[band] = CDStokesVector(light[i * 12 + band], light[i * 12 + 3 + band], 0, 0);
      model.scatter(BRDFGeometry::fromDirections({x[i], y[i], z[i]}, viewer), weight[i], one,
                    byhand);
    }
    for (std::size_t band = 0; band < 3; ++band) {
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(sum.at(band).getStokes(c), byhand.at(band).getStokes(c), 1e-14);
      EXPECT_GT(sum.at(band).getScalar(), 0.05) << "negative control";
    }
    EXPECT_EQ(sum.isPolarized(1), light[3] != 0) << "the second band's matrix is a number";
  }
}

TEST(CDBRDFModelIdentity, ScoreIsTheMeanTimesTheCosine) {
  const Polynomial model(grid());
  const auto g = BRDFGeometry::fromDegrees(30, 40, 120);
  const auto f = model.getBRDF(g);
  const double mean = (f.at(0).getScalar() + f.at(1).getScalar() + f.at(2).getScalar()) / 3;
  EXPECT_NEAR(model.getScore(g), mean * std::cos(pi / 6), 1e-15);
}

TEST(CDBRDFModelIdentity, OtherGridsAreRefused) {
  const Polynomial model(grid());
  const auto other = SpectralGrid::make({450.0, 550.0, 651.0});
  const auto same = SpectralGrid::make({450.0, 550.0, 650.0});
  const auto g = BRDFGeometry::fromDegrees(30, 40, 120);
  CDSpectralVector<CDStokesVector> a(grid()), b(other), c(same);
  EXPECT_THROW(model.scatter(g, 1, b, a), GridError);
  EXPECT_THROW(model.scatter(g, 1, a, b), GridError);
  EXPECT_NO_THROW(model.scatter(g, 1, c, a));  // equal, though another object
  EXPECT_THROW(Polynomial(nullptr), MathError);
}

TEST(CDBRDFModelInvariant, TheCosineLobeIsDrawnAsItsDensitySays) {
  const Polynomial model(grid());
  Random random(31);
  const CDVector given{0, 0, 1};
  std::vector<std::size_t> counts(100), wrong(100);
  constexpr std::size_t draws = 1000000;
  for (std::size_t i = 0; i < draws; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform();
    const BRDFSample s = model.sample(given, u1, u2, 0.5);
    ASSERT_FALSE(s.rejected());
    EXPECT_NEAR(s.density_per_sr, s.direction.z / pi, 1e-15);
    EXPECT_EQ(s.density_per_sr, model.density(given, s.direction));
    const double mu = s.direction.z, phi = s.direction.getAzimuth() / (2 * pi);
    const auto column = std::min<std::size_t>(9, static_cast<std::size_t>(10 * phi));
    // the cosine lobe is uniform in mu^2
    ++counts[10 * std::min<std::size_t>(9, static_cast<std::size_t>(10 * mu * mu)) + column];
    ++wrong[10 * std::min<std::size_t>(9, static_cast<std::size_t>(10 * mu)) + column];
  }
  const std::vector<double> equal(100, 0.01);
  // false alarm once in a million changes of the seed
  EXPECT_GT(malus::testing::chiSquaredPValue(counts, equal, draws), 1e-6);
  EXPECT_LT(malus::testing::chiSquaredPValue(wrong, equal, draws), 1e-6);  // negative control
  EXPECT_EQ(cosineDensity({0, 0, -1}), 0);
  EXPECT_EQ(cosineDensity({1, 0, 0}), 0);
}

TEST(CDBRDFModelIdentity, AdaptiveSamplingLooksOppositeTheViewer) {
  const Polynomial model(SpectralGrid::make({550.0}));
  const double azimuth = 1.1;
  const auto points = adaptiveSampling(model, 1.2, azimuth, 32, pi / 2);
  ASSERT_EQ(points.size(), 32u);
  double sum = 0;
  for (const SamplePoint& p : points) {
    sum += p.solid_angle_sr;
    EXPECT_GE(p.azimuth_rad, 0);
    EXPECT_LT(p.azimuth_rad, 2 * pi);
  }
  EXPECT_NEAR(sum, 2 * pi, 1e-14);                     // a sum of 32 terms
  EXPECT_NEAR(points[0].azimuth_rad, azimuth, 1e-15);  // a column holds the viewer ...
  for (std::size_t i = 24; i < 32; ++i)                // ... and the opposite one is refined
    EXPECT_LT(std::abs(points[i].azimuth_rad - (azimuth + pi)), pi / 8);
}
