// Matrices of many geometries at once are those of each alone (nw/surface/ManyMatrices.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;

namespace {
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// At random; and where formulas have their limits.
std::vector<BRDFGeometry> everyKindOfGeometry() {
  std::vector<BRDFGeometry> all;
  for (const double i : {0.0, 1e-7, 30.0, 45.0, 89.9999, 90.0, 91.0, 180.0, not_a_number})
    for (const double r : {0.0, 1e-7, 30.0, 45.000001, 90.0, 120.0})
      for (const double phi : {0.0, 90.0, 179.9999999, 180.0, 360.0, not_a_number})
        all.push_back(BRDFGeometry::fromDegrees(i, r, phi));
  Random random(2002);
  for (int n = 0; n < 5000; ++n)
    all.push_back(BRDFGeometry::fromDegrees(90 * random.uniform(), 90 * random.uniform(),
                                            720 * random.uniform() - 360));
  return all;
}

/// By evaluateMany(), in blocks of so many.
std::vector<double> inBlocks(const CDBRDFModel& model, const std::vector<BRDFGeometry>& all,
                             std::size_t size) {
  const std::size_t each = 16 * model.grid()->size();
  std::vector<double> out(all.size() * each);
  BRDFGeometries block;
  for (std::size_t begin = 0; begin < all.size(); begin += block.count) {
    block.count = std::min(size, all.size() - begin);
    for (std::size_t j = 0; j < block.count; ++j) {
      const BRDFGeometry& g = all[begin + j];
      block.cos_i[j] = g.cos_i, block.sin_i[j] = g.sin_i;
      block.cos_r[j] = g.cos_r, block.sin_r[j] = g.sin_r;
      block.cos_phi[j] = g.cos_phi, block.sin_phi[j] = g.sin_phi;
    }
    model.evaluateMany(block, std::span(out).subspan(begin * each, block.count * each));
  }
  return out;
}

/// By getBRDF(), one after the other.
std::vector<double> oneByOne(const CDBRDFModel& model, const std::vector<BRDFGeometry>& all) {
  std::vector<double> out;
  for (const BRDFGeometry& g : all) {
    const CDSpectralVector<CDMuellerMatrix> f = model.getBRDF(g);
    for (std::size_t band = 0; band < f.size(); ++band) {
      const CDMuellerMatrix m = f.at(band);
      for (int k = 0; k < 16; ++k) out.push_back(m.getMueller(k / 4, k % 4));
    }
  }
  return out;
}

/// How many numbers differ in a bit; two that are none do not differ.
std::size_t differences(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return a.size() + b.size();
  return std::transform_reduce(a.begin(), a.end(), b.begin(), std::size_t{0}, std::plus<>{},
                               [](double x, double y) -> std::size_t {
                                 if (std::isnan(x) && std::isnan(y)) return 0;
                                 return std::bit_cast<std::uint64_t>(x) !=
                                        std::bit_cast<std::uint64_t>(y);
                               });
}
}  // namespace

// Bit by bit: each operation is rounded as IEEE 754 says.
TEST(ManyMatricesIdentity, EveryModelGivesTheBitsOfOneAfterTheOther) {
  const auto all = everyKindOfGeometry();
  for (const ModelEntry& entry : modelEntries())
    for (const SpectralGridPtr& grid :
         {SpectralGrid::make({550}), SpectralGrid::make({550, 551, 552})}) {
      // a file of measurements has its own bands
      if (grid->size() > 1 && std::ranges::any_of(entry.parameters, &Parameter::file)) continue;
      const auto model = exampleModel(entry, grid);
      EXPECT_EQ(differences(inBlocks(*model, all, BRDFGeometries::most), oneByOne(*model, all)),
                0u)
          << entry.name << " with " << grid->size() << " bands";
    }
}

TEST(ManyMatricesIdentity, BlocksOfEverySizeGiveTheSame) {
  const BRDFTorranceSparrow copper(0.405, 2.95, 0.2);
  auto all = everyKindOfGeometry();
  all.resize(400);
  const auto expected = oneByOne(copper, all);
  for (std::size_t size = 1; size <= BRDFGeometries::most; ++size)
    EXPECT_EQ(differences(inBlocks(copper, all, size), expected), 0u) << size;
  BRDFGeometries none;
  copper.evaluateMany(none, {});  // nothing to write, and nowhere
}

TEST(ManyMatricesIdentity, TheRoomIsThatOfTheMatrices) {
  const BRDFTorranceSparrow fast(0.405, 2.950, 0.2);
  const BRDFDiffuse plain({SpectralGrid::make({500.0, 600.0}), 0.5});
  BRDFGeometries three;
  three.count = 3;
  for (std::size_t j = 0; j < 3; ++j) {
    three.cos_i[j] = three.cos_r[j] = 1, three.cos_phi[j] = -1;
    three.sin_i[j] = three.sin_r[j] = three.sin_phi[j] = 0;
  }
  for (const CDBRDFModel* model : std::initializer_list<const CDBRDFModel*>{&fast, &plain}) {
    std::vector<double> out(3 * 16 * model->grid()->size() + 1);
    const std::span<double> more(out), all = more.first(out.size() - 1);
    EXPECT_NO_THROW(model->evaluateMany(three, all));
    EXPECT_THROW(model->evaluateMany(three, more), MathError);
    EXPECT_THROW(model->evaluateMany(three, all.first(all.size() - 1)), MathError);
  }
}

// Metals and glasses, smooth and rough, with every diffuse term, with other kinds of shadowing, and without polarisation.
TEST(ManyMatricesIdentity, EveryRoughSurfaceGivesTheBitsOfOneAfterTheOther) {
  const auto all = everyKindOfGeometry();
  std::vector<TorranceSparrowOptions> kinds(5);
  kinds[1].diffuse = DiffuseTerm::none, kinds[2].diffuse = DiffuseTerm::reciprocal;
  kinds[3].diffuse = DiffuseTerm::none, kinds[3].shadowing = Shadowing::smith;
  kinds[4].polarized = false;
  for (const auto& [n, k] : {std::pair{0.405, 2.95}, {1.5, 0.0}, {0.66, 0.0}, {8.31, 63.0}})
    for (const double sigma : {1e-6, 0.01, 0.2, 2.0})
      for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        const BRDFTorranceSparrow model(n, k, sigma, kinds[kind]);
        EXPECT_EQ(differences(inBlocks(model, all, BRDFGeometries::most), oneByOne(model, all)),
                  0u)
            << n << ' ' << k << ' ' << sigma << ' ' << kind;
      }
}

// Half a unit in the last place for the last sum, and of what is added to the angle or to one, at most 0.103 of the whole: three
// roundings, each of which may count double below a power of two, 0.31. Of an angle in degrees nothing is lost before.
TEST(ManyMatricesIdentity, CosinesAndSinesAreRightToTheLastPlace) {
  constexpr long double degree = 3.14159265358979323846264338327950288L / 180;
  const auto off = [](double ours, long double exact) {
    return std::abs(static_cast<double>(ours - exact)) /
           std::ldexp(1.0, std::ilogb(static_cast<double>(exact)) - 52);
  };
  Random random(1670);
  double worst = 0, without_the_rest = 0;
  for (int n = 0; n < 100'000; ++n) {
    const double deg = 90 * random.uniform() - 45;
    double c = 0, s = 0;
    cosinesAndSines({&deg, 1}, &c, &s);
    worst = std::max({worst, off(c, std::cos(deg * degree)), off(s, std::sin(deg * degree))});
    const double rounded = deg * static_cast<double>(degree);
    without_the_rest =
        std::max(without_the_rest, off(std::sin(rounded), std::sin(deg * degree)));
  }
  EXPECT_LT(worst, 0.82);
  EXPECT_GT(without_the_rest, 0.82);  // negative control: radians rounded to a double lose more
}

TEST(ManyMatricesIdentity, CosinesAndSinesAreThoseOfOneGeometry) {
  std::vector<double> degrees{-0.0, 0,   30,  45,  90,    135,
                              180,  270, 360, 1e9, 1e300, not_a_number};
  Random random(1954);
  for (int n = 0; n < 1000; ++n) degrees.push_back(2000 * random.uniform() - 1000);
  std::vector<double> cosines(degrees.size()), sines(degrees.size()), one_cosine, one_sine;
  cosinesAndSines(degrees, cosines.data(), sines.data());
  for (const double deg : degrees) {
    const BRDFGeometry g = BRDFGeometry::fromDegrees(0, 0, deg);
    one_cosine.push_back(g.cos_phi), one_sine.push_back(g.sin_phi);
  }
  EXPECT_EQ(differences(cosines, one_cosine), 0u);
  EXPECT_EQ(differences(sines, one_sine), 0u);
}

// A roughness or a direction that differs in its last digit gives other bits.
TEST(ManyMatricesIdentity, NegativeControlOtherSurfacesGiveOtherBits) {
  const auto all = everyKindOfGeometry();
  const BRDFTorranceSparrow copper(0.405, 2.95, 0.2),
      other(0.405, 2.95, std::nextafter(0.2, 1));
  EXPECT_GT(differences(inBlocks(copper, all, 64), oneByOne(other, all)), 10'000u);
  auto turned = all;
  for (BRDFGeometry& g : turned) std::swap(g.cos_i, g.cos_r);
  EXPECT_GT(differences(inBlocks(copper, all, 64), oneByOne(copper, turned)), 10'000u);
}
