// A model that gives f00 alone (nw/surface/BRDFUnpolarized.nw): its matrix is f00 times the identity in every band, also
// beyond the block of 64 in which the bands are worked through.
#include "malus/surface/BRDFUnpolarized.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <vector>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();

SpectralGridPtr gridOf(std::size_t bands) {
  std::vector<CDSpectralLocation> places;
  for (std::size_t i = 0; i < bands; ++i) places.emplace_back(400.0 + static_cast<double>(i));
  return SpectralGrid::make(places);
}

double expected(const BRDFGeometry& geometry, std::size_t band) {
  return (1 + 0.01 * static_cast<double>(band)) * (geometry.cos_i + 2 * geometry.cos_r);
}

/// Every band has a value that no other has, so that a block at the wrong place is seen.
struct Numbered final : BRDFUnpolarized {
  explicit Numbered(std::size_t bands) : BRDFUnpolarized(gridOf(bands)) {}
  std::string_view name() const override { return "numbered"; }
  void fill(const BRDFGeometry& geometry, std::size_t begin,
            std::span<double> f00) const override {
    for (std::size_t j = 0; j < f00.size(); ++j) f00[j] = expected(geometry, begin + j);
  }
};

const BRDFGeometry geometry = BRDFGeometry::fromDegrees(30, 50, 170);
const std::vector<std::size_t> sizes{1, 63, 64, 65, 128, 150};

CDSpectralVector<CDStokesVector> mixedLight(const SpectralGridPtr& grid) {
  CDSpectralVector<CDStokesVector> light(grid);
  for (std::size_t band = 0; band < grid->size(); ++band)
    light[band] = band % 3 ? CDStokesVector(2.0) : CDStokesVector(1.0, 0.3, -0.2, 0.1);
  return light;
}
}  // namespace

TEST(BRDFUnpolarizedIdentity, EveryBandHasItsOwnValueAndNoPolarization) {
  for (const std::size_t bands : sizes) {
    const Numbered model(bands);
    const CDSpectralVector<CDMuellerMatrix> f = model.getBRDF(geometry);
    ASSERT_EQ(f.size(), bands);
    EXPECT_FALSE(f.anyPolarized());
    for (std::size_t band = 0; band < bands; ++band)
      EXPECT_EQ(f.at(band).getScalar(), expected(geometry, band)) << bands << ' ' << band;
  }
  EXPECT_NE(expected(geometry, 64),
            expected(geometry, 0));  // negative control: a lost offset is seen
}

TEST(BRDFUnpolarizedIdentity, ALargerVectorIsDemoted) {
  const Numbered model(70);
  CDSpectralVector<CDMuellerMatrix> f(model.grid());
  f.polarize(5);
  model.evaluate(geometry, f);
  EXPECT_FALSE(f.anyPolarized());
}

TEST(BRDFUnpolarizedIdentity, LightKeepsItsPolarization) {
  for (const std::size_t bands : sizes) {
    const Numbered model(bands);
    const auto in = mixedLight(model.grid());
    CDSpectralVector<CDStokesVector> sum(model.grid());
    for (std::size_t band = 0; band < bands; ++band) sum[band] = CDStokesVector(0.5);
    model.scatter(geometry, 0.25, in, sum);
    for (std::size_t band = 0; band < bands; ++band) {
      EXPECT_EQ(sum.isPolarized(band), in.isPolarized(band)) << band;
      for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(sum.at(band).getStokes(k),
                    (k ? 0 : 0.5) + 0.25 * expected(geometry, band) * in.at(band).getStokes(k),
                    rounding * 10)
            << bands << ' ' << band << ' ' << k;
    }
  }
}

TEST(BRDFUnpolarizedIdentity, TheScoreIsTheMeanTimesTheCosine) {
  for (const std::size_t bands : sizes) {
    double sum = 0;
    for (std::size_t band = 0; band < bands; ++band) sum += expected(geometry, band);
    EXPECT_NEAR(Numbered(bands).getScore(geometry),
                sum / static_cast<double>(bands) * geometry.cos_i,
                rounding * sum);  // sums in two orders
  }
}

TEST(BRDFUnpolarizedIdentity, NothingIsScatteredBelowTheHorizon) {
  const Numbered model(70);
  for (const auto& [i, r] : {std::pair{100.0, 20.0}, std::pair{20.0, 100.0}}) {
    const BRDFGeometry below = BRDFGeometry::fromDegrees(i, r, 0);
    for (std::size_t band = 0; band < 70; ++band)
      EXPECT_EQ(model.getBRDF(below).at(band).getScalar(), 0);
    EXPECT_EQ(model.getScore(below), 0);
    CDSpectralVector<CDStokesVector> sum(model.grid());
    model.scatter(below, 1, mixedLight(model.grid()), sum);
    EXPECT_FALSE(sum.anyPolarized());
    EXPECT_EQ(sum.at(69).getStokes(0), 0);
  }
}

TEST(BRDFUnpolarizedIdentity, AnotherGridIsRefused) {
  const Numbered model(3);
  const SpectralGridPtr four = gridOf(4);
  CDSpectralVector<CDMuellerMatrix> matrices(four);
  EXPECT_THROW(model.evaluate(geometry, matrices), GridError);
  CDSpectralVector<CDStokesVector> sum(model.grid()), other(four);
  EXPECT_THROW(model.scatter(geometry, 1, mixedLight(four), sum), GridError);
  EXPECT_THROW(model.scatter(geometry, 1, mixedLight(model.grid()), other), GridError);
}
