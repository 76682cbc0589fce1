// Facets with a weight for each band (nw/surface/BRDFFacets.nw) against Torrance and Sparrow's class.
#include "malus/surface/BRDFFacets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <span>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
// Torrance-Sparrow once more, by its weights; `slope` makes them grow with the band.
class Twin : public BRDFFacets {
 public:
  Twin(const CDSpectralVector<double>& n, const CDSpectralVector<double>& k, double sigma,
       double slope = 0)
      : BRDFFacets(n, k), sigma_(sigma), slope_(slope) {}
  std::string_view name() const override { return "twin"; }

 protected:
  void weigh(const BRDFGeometry& g, const FacetGeometry& facet, std::size_t first,
             std::span<double> facets, std::span<double> diffuse) const override {
    EXPECT_EQ(facets.size(), diffuse.size());
    EXPECT_LE(first + facets.size(), bands());
    for (std::size_t j = 0; j < facets.size(); ++j) {
      const double grow = 1 + slope_ * static_cast<double>(first + j);
      facets[j] = grow * facetFactor(Shadowing::vGroove, g, facet, sigma_);
      diffuse[j] = 0.01 * g.cos_r * grow;
    }
  }

 private:
  double sigma_, slope_;
};

struct Spectra {
  SpectralGridPtr grid;
  CDSpectralVector<double> n, k, sigma;
};

Spectra spectra(std::size_t bands) {
  std::vector<double> nm(bands);
  std::iota(nm.begin(), nm.end(), 400.0);
  const auto grid = SpectralGrid::make(nm);
  Spectra s{grid, {grid, 1.0}, {grid, 1.0}, {grid, 0.2}};
  for (std::size_t j = 0; j < bands; ++j)
    s.n[j] = 0.3 + 0.01 * double(j), s.k[j] = 1 + double(j % 7);
  return s;
}

CDSpectralVector<CDStokesVector> lightOf(const SpectralGridPtr& grid, bool polarized) {
  CDSpectralVector<CDStokesVector> light(grid);
  for (std::size_t j = 0; j < light.size(); ++j) {
    const double s0 = 1 + 0.1 * double(j % 5);
    light[j] =
        polarized && j % 3 != 1 ? CDStokesVector(s0, 0.4, -0.3, 0.2) : CDStokesVector(s0);
  }
  return light;
}

double largestDifference(const CDSpectralVector<CDStokesVector>& a,
                         const CDSpectralVector<CDStokesVector>& b) {
  double largest = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    for (int c = 0; c < 4; ++c) {
      const double d = std::abs(a.at(j).getStokes(c) - b.at(j).getStokes(c));
      if (!(d <= largest)) largest = d;
    }
  return largest;
}

TorranceSparrowOptions specular() {
  TorranceSparrowOptions options;
  options.diffuse = DiffuseTerm::none;
  return options;
}
}  // namespace

TEST(BRDFFacetsIdentity, AgreesWithTorranceSparrow) {
  for (const std::size_t bands : {1u, 63u, 64u, 65u, 200u}) {
    const Spectra s = spectra(bands);
    const BRDFTorranceSparrow model(s.n, s.k, s.sigma, specular());
    const Twin twin(s.n, s.k, 0.2), other(s.n, s.k, 0.2, 1e-3);
    for (const double phi : {0.0, 100.0, 180.0}) {
      const auto g = BRDFGeometry::fromDegrees(35, 50, phi);
      const auto f = twin.getBRDF(g), expected = model.getBRDF(g);
      for (std::size_t j = 0; j < bands; ++j)
        for (int e = 0; e < 16; ++e) {
          const double rest = e == 0 ? 0.01 * g.cos_r : 0;
          EXPECT_NEAR(f.at(j).getMueller(e / 4, e % 4),
                      expected.at(j).getMueller(e / 4, e % 4) + rest, 1e-14);
        }
      EXPECT_NEAR(twin.getScore(g), model.getScore(g) + 0.01 * g.cos_r * g.cos_i, 1e-13);
      // the negative control: weights that differ from band to band
      if (bands > 1) {
        EXPECT_GT(std::abs(other.getScore(g) / twin.getScore(g) - 1), 1e-5);
      }
    }
  }
}

TEST(BRDFFacetsIdentity, TheLightIsTheMatrixTimesTheLight) {
  for (const std::size_t bands : {1u, 70u})
    for (const bool polarized : {false, true}) {
      const Spectra s = spectra(bands);
      const Twin twin(s.n, s.k, 0.3, 0.01);
      const auto in = lightOf(s.grid, polarized);
      const auto g = BRDFGeometry::fromDegrees(20, 60, 140);
      CDSpectralVector<CDStokesVector> fast(s.grid), plain(s.grid), wrong(s.grid);
      twin.scatter(g, 0.7, in, fast);
      twin.scatter(g, 0.1, in, fast);  // adds
      twin.CDBRDFModel::scatter(g, 0.8, in, plain);
      twin.CDBRDFModel::scatter(BRDFGeometry::fromDegrees(20, 60, -140), 0.8, in, wrong);
      EXPECT_LT(largestDifference(fast, plain), 1e-13);  // rounding of sums of numbers near one
      EXPECT_GT(largestDifference(wrong, plain),
                1e-4);  // the other side of the plane of incidence
    }
}

TEST(BRDFFacetsInvariant, NothingBelowTheHorizon) {
  const Spectra s = spectra(3);
  const Twin twin(s.n, s.k, 0.3);
  auto g = BRDFGeometry::fromDegrees(20, 60, 140);
  g.cos_r = -g.cos_r;
  EXPECT_EQ(twin.getScore(g), 0);
  EXPECT_EQ(twin.getBRDF(g).at(1).getMueller(0, 0), 0);
  CDSpectralVector<CDStokesVector> out(s.grid);
  twin.scatter(g, 1, lightOf(s.grid, true), out);
  EXPECT_EQ(out.at(2).getScalar(), 0);
  g.cos_r = -g.cos_r;
  EXPECT_GT(twin.getScore(g), 0);
}

TEST(BRDFFacetsInvariant, RefusesWhatIsNoIndex) {
  Spectra s = spectra(2);
  s.k[1] = -1;
  EXPECT_THROW(Twin(s.n, s.k, 0.3), MathError);
  s.k[1] = std::nan("");
  EXPECT_THROW(Twin(s.n, s.k, 0.3), MathError);
  const Spectra other = spectra(3);
  EXPECT_THROW(Twin(other.n, spectra(2).k, 0.3), GridError);
  EXPECT_NO_THROW(Twin(other.n, other.k, 0.3));
}
