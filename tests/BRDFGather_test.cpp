// The light of many directions at once: the models that have a fast way (nw/surface/TorranceSparrowGather.nw,
// nw/surface/BRDFDiffuse.nw) beside the plain one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
constexpr TorranceSparrowOptions with(Shadowing shadowing, DiffuseTerm diffuse,
                                      bool polarized = true) {
  return {shadowing, diffuse, polarized};
}
constexpr TorranceSparrowOptions specular_only = with(Shadowing::vGroove, DiffuseTerm::none);
constexpr TorranceSparrowOptions as_thesis = with(Shadowing::vGroove, DiffuseTerm::thesis);
constexpr TorranceSparrowOptions reciprocal = with(Shadowing::vGroove, DiffuseTerm::reciprocal);
}  // namespace

// ---- many directions at once, in single precision, against the plain sum in double precision
namespace {
struct Directions {
  std::vector<float> x, y, z, weight;
  explicit Directions(std::size_t count, std::uint64_t seed = 1) {
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
      const CDVector d =
          CDVector::fromAngles(0.5 * pi * random.uniform(), 2 * pi * random.uniform());
      x.push_back(float(d.x)), y.push_back(float(d.y)), z.push_back(float(d.z));
      weight.push_back(float(d.z * 2 * pi / double(count)));
    }
  }
  LightDirections view() const {
    return {x.size(), x.data(), y.data(), z.data(), weight.data()};
  }
};

/// Copper and glass, smooth and rough, in runs of equal roughness.
BRDFTorranceSparrow mixture(std::size_t bands, const TorranceSparrowOptions& options) {
  std::vector<double> nm, n, k, sigma;
  for (std::size_t j = 0; j < bands; ++j) {
    nm.push_back(400 + double(j));
    const bool glass = j % 5 == 4;
    n.push_back(glass ? 1.5 : 0.4 + 0.01 * double(j)),
        k.push_back(glass ? 0 : 2.9 + 0.01 * double(j));
    sigma.push_back(j < bands / 2 ? 0.1 : 0.3);
  }
  const auto grid = SpectralGrid::make(nm);
  return {CDSpectralVector<double>(grid, n), CDSpectralVector<double>(grid, k),
          CDSpectralVector<double>(grid, sigma), options};
}

CDSpectralVector<CDStokesVector> whiteLight(const SpectralGridPtr& grid) {
  CDSpectralVector<CDStokesVector> light(grid);
  for (std::size_t j = 0; j < light.size(); ++j)
    light[j] = CDStokesVector(1 + 0.01 * double(j));
  return light;
}

/// Largest difference of any component, in units of S0.
double apart(const CDSpectralVector<CDStokesVector>& a,
             const CDSpectralVector<CDStokesVector>& b) {
  double largest = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    for (int c = 0; c < 4; ++c) {
      const double difference =
          std::abs(CDStokesVector(a.at(j)).getStokes(c) - CDStokesVector(b.at(j)).getStokes(c));
      if (!(difference <= largest * CDStokesVector(b.at(j)).getScalar()))
        largest = difference / CDStokesVector(b.at(j)).getScalar();
    }
  return largest;
}
}  // namespace

// 3e-6: single precision's 6e-8 through an exponent of up to some tens.
TEST(BRDFGatherIdentity, GatherIsTheSumOfScatter) {
  for (const auto& options :
       {specular_only, as_thesis, reciprocal, with(Shadowing::smith, DiffuseTerm::thesis),
        with(Shadowing::vGroove, DiffuseTerm::thesis, false)})
    for (const std::size_t bands : {1u, 2u, 11u, 300u})
      for (const std::size_t count : {90u, 128u, 333u}) {
        const BRDFTorranceSparrow model = mixture(bands, options);
        const auto light = whiteLight(model.grid());
        const Directions from(count, bands + count);
        for (const double zenith : {0.0, 0.01, 0.7, 1.4}) {
          CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
          const CDVector viewer = CDVector::fromAngles(zenith, 2);
          model.gather(viewer, from.view(), light, fast);
          model.CDBRDFModel::gather(viewer, from.view(), light, plain);
          EXPECT_LT(apart(fast, plain), 3e-6)
              << bands << " bands " << count << " directions at " << zenith;
        }
      }
}

// With the viewer's own direction, the mirror's, both, and the horizon.
TEST(BRDFGatherIdentity, GatherAtSingularDirections) {
  const BRDFTorranceSparrow model = mixture(2, as_thesis);
  const auto light = whiteLight(model.grid());
  for (const double zenith : {0.0, 1e-4, 0.5, 1.5}) {
    const CDVector v = CDVector::fromAngles(zenith, 1);
    Directions from(0);
    for (const CDVector& d : {v, CDVector{-v.x, -v.y, v.z}, CDVector{0, 0, 1},
                              CDVector{1, 0, 0}, CDVector{0, 0.6, -0.8}})
      from.x.push_back(float(d.x)), from.y.push_back(float(d.y)), from.z.push_back(float(d.z)),
          from.weight.push_back(0.1f);
    CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
    model.gather(v, from.view(), light, fast);
    model.CDBRDFModel::gather(v, from.view(), light, plain);
    EXPECT_LT(apart(fast, plain), 3e-6) << zenith;
  }
}

TEST(BRDFGatherIdentity, NegativeControlGatherSeesATurnedViewer) {
  const BRDFTorranceSparrow model = mixture(11, as_thesis);
  const auto light = whiteLight(model.grid());
  const Directions from(90);
  CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
  model.gather(CDVector::fromAngles(0.7, 2), from.view(), light, fast);
  model.CDBRDFModel::gather(CDVector::fromAngles(0.7, 2.001), from.view(), light, plain);
  EXPECT_GT(apart(fast, plain), 3e-5);
}

TEST(BRDFGatherIdentity, GatherRefusesPolarisedLight) {
  const BRDFTorranceSparrow model = mixture(2, as_thesis);
  auto light = whiteLight(model.grid());
  light[1] = CDStokesVector(1, 0.5, 0, 0);
  auto out = whiteLight(model.grid());
  EXPECT_THROW(model.gather({0, 0, 1}, Directions(3).view(), light, out), MathError);
}

// Sums in another order: rounding only.
TEST(BRDFGatherIdentity, OfLambertsSurface) {
  const auto grid = SpectralGrid::make({450.0, 550.0, 650.0});
  const BRDFDiffuse model(CDSpectralVector<double>(grid, std::vector<double>{0.1, 0.5, 1.0}),
                          0.5);
  const Directions from(90);
  CDSpectralVector<CDStokesVector> fast(grid), plain(grid);
  model.gather({0, 0, 1}, from.view(), whiteLight(grid), fast);
  model.CDBRDFModel::gather({0, 0, 1}, from.view(), whiteLight(grid), plain);
  EXPECT_LT(apart(fast, plain), 1e-14);
  EXPECT_FALSE(fast.anyPolarized());
}

// ---- light that differs from direction to direction
namespace {
/// Random polarised light of so many directions and bands, [direction][component][band].
std::vector<float> unlikeLight(std::size_t directions, std::size_t bands, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> light;
  for (std::size_t i = 0; i < directions; ++i)
    for (int component = 0; component < 4; ++component)
      for (std::size_t band = 0; band < bands; ++band)
        light.push_back(
            float(component == 0 ? 1 + random.uniform() : 0.5 * (2 * random.uniform() - 1)));
  return light;
}
}  // namespace

// 5e-6: as above, and the two rotations, whose cosines and sines have single precision's digits.
TEST(BRDFGatherIdentity, GatherEachIsTheSumOfScatter) {
  for (const auto& options :
       {specular_only, as_thesis, reciprocal, with(Shadowing::smith, DiffuseTerm::thesis),
        with(Shadowing::vGroove, DiffuseTerm::thesis, false)})
    for (const std::size_t bands : {1u, 2u, 11u, 300u})
      for (const std::size_t count : {16u, 90u, 144u}) {
        const BRDFTorranceSparrow model = mixture(bands, options);
        const Directions from(count, bands + count);
        const auto light = unlikeLight(count, bands, count);
        for (const double zenith : {0.0, 0.01, 0.7, 1.4}) {
          CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
          const CDVector viewer = CDVector::fromAngles(zenith, 2);
          model.gatherEach(viewer, from.view(), light, fast);
          model.CDBRDFModel::gatherEach(viewer, from.view(), light, plain);
          EXPECT_LT(apart(fast, plain), 5e-6)
              << bands << " bands " << count << " directions at " << zenith;
        }
      }
}

// Source and viewer in one direction leave each rotation undetermined, but not what both do together; along the normal
// the azimuth is a convention. 2e-5: half a dozen directions with their errors unaveraged.
TEST(BRDFGatherIdentity, GatherEachAtSingularDirections) {
  const BRDFTorranceSparrow model = mixture(2, as_thesis);
  for (const double zenith : {0.0, 1e-6, 1e-4, 0.01, 0.5, 1.2, 1.5}) {
    const CDVector v = CDVector::fromAngles(zenith, 1);
    for (const double off : {0.0, 1e-6, 1e-4, 1e-2})
      for (const CDVector& d :
           {CDVector::fromAngles(zenith + off, 1 + off), CDVector{-v.x, -v.y, v.z},
            CDVector{0, 0, 1}, CDVector::fromAngles(1.57, 4)}) {
        Directions from(0);
        for (int i = 0; i < 16; ++i)
          from.x.push_back(float(d.x)), from.y.push_back(float(d.y)),
              from.z.push_back(float(d.z)), from.weight.push_back(0.1f);
        const auto light = unlikeLight(16, 2, 7);
        CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
        model.gatherEach(v, from.view(), light, fast);
        model.CDBRDFModel::gatherEach(v, from.view(), light, plain);
        EXPECT_LT(apart(fast, plain), 2e-5)
            << zenith << " off " << off << " towards " << d.x << " " << d.y << " " << d.z;
      }
  }
}

TEST(BRDFGatherIdentity, NegativeControlGatherEachSeesATurnedFrame) {
  const BRDFTorranceSparrow model = mixture(3, as_thesis);
  const Directions from(96);
  auto light = unlikeLight(96, 3, 1);
  CDSpectralVector<CDStokesVector> fast(model.grid()), plain(model.grid());
  model.gatherEach(CDVector::fromAngles(0.7, 2), from.view(), light, fast);
  for (std::size_t i = 0; i < 96; ++i)  // each by a thousandth of a radian, to first order
    for (std::size_t j = 0; j < 3; ++j)
      light[(4 * i + 1) * 3 + j] += 2e-3f * light[(4 * i + 2) * 3 + j];
  model.CDBRDFModel::gatherEach(CDVector::fromAngles(0.7, 2), from.view(), light, plain);
  EXPECT_GT(apart(fast, plain), 2e-5);
}

// Sums in double precision of the same numbers: rounding only.
TEST(BRDFGatherIdentity, GatherEachOfLambertsSurface) {
  const auto grid = SpectralGrid::make({450.0, 550.0, 650.0});
  const Directions from(90);
  const auto light = unlikeLight(90, 3, 5);
  for (const double s : {0.0, 0.5, 1.0}) {
    const BRDFDiffuse model(CDSpectralVector<double>(grid, std::vector<double>{0.1, 0.5, 1.0}),
                            s);
    CDSpectralVector<CDStokesVector> fast(grid), plain(grid);
    model.gatherEach({0, 0, 1}, from.view(), light, fast);
    model.CDBRDFModel::gatherEach({0, 0, 1}, from.view(), light, plain);
    EXPECT_LT(apart(fast, plain), 1e-14) << s;
    EXPECT_EQ(fast.anyPolarized(), s > 0);
  }
}

// Who says that it reads S0 alone must not look at the others; who does not say it looks, and the control sees that.
TEST(BRDFGatherIdentity, WhoReadsOnlyS0LeavesTheOthersAlone) {
  const auto grid = SpectralGrid::make({450.0, 550.0, 650.0});
  const CDSpectralVector<double> grey(grid, 0.4);
  const Directions from(90);
  const auto light = unlikeLight(90, 3, 5);
  std::vector<float> without = light;
  for (std::size_t i = 0; i < without.size(); ++i)
    if (i % 12 >= 3) without[i] = std::numeric_limits<float>::quiet_NaN();
  const BRDFDiffuse matt(grey, 0), keeps(grey, 0.5);
  const BRDFTorranceSparrow copper = mixture(3, as_thesis);
  EXPECT_TRUE(matt.readsOnlyS0());
  for (const CDBRDFModel* model :
       std::initializer_list<const CDBRDFModel*>{&matt, &keeps, &copper}) {
    CDSpectralVector<CDStokesVector> whole(model->grid()), part(model->grid());
    model->gatherEach({0, 0, 1}, from.view(), light, whole);
    model->gatherEach({0, 0, 1}, from.view(), without, part);
    bool same = true;
    for (std::size_t b = 0; b < 3; ++b)
      for (int c = 0; c < 4; ++c)
        same = same &&
               CDStokesVector(part[b]).getStokes(c) == CDStokesVector(whole[b]).getStokes(c);
    EXPECT_EQ(same, model->readsOnlyS0()) << model->name();
  }
}

// Light for one direction less, or one number more, is a mistake of the caller, by every way to gather.
TEST(BRDFGatherIdentity, GatherEachRefusesLightOfAnotherLength) {
  const auto grid = SpectralGrid::make({450.0, 550.0});
  const BRDFTorranceSparrow rough = mixture(2, as_thesis);
  const BRDFDiffuse diffuse(CDSpectralVector<double>(grid, std::vector<double>{0.1, 0.5}), 0);
  const Directions from(16);
  const auto light = unlikeLight(16, 2, 5);
  const std::span<const float> all(light);
  const auto gathers = [&](const CDBRDFModel& model, std::span<const float> stokes) {
    CDSpectralVector<CDStokesVector> out(model.grid());
    model.gatherEach({0, 0, 1}, from.view(), stokes, out);
    model.CDBRDFModel::gatherEach({0, 0, 1}, from.view(), stokes, out);
  };
  for (const CDBRDFModel* model :
       {static_cast<const CDBRDFModel*>(&rough), static_cast<const CDBRDFModel*>(&diffuse)}) {
    EXPECT_NO_THROW(gathers(*model, all));
    EXPECT_THROW(gathers(*model, all.first(all.size() - 8)), MathError);
    EXPECT_THROW(gathers(*model, all.first(all.size() - 1)), MathError);
  }
}
