// Light among pigment (nw/air/PaintScattering.nw) against adding and doubling without a face, single scattering
// turned by vectors, and the conservation of light.
#include "malus/air/PaintScattering.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ScatteredOnce.hpp"
#include "malus/air/AddingDoubling.hpp"
#include "malus/base/Error.hpp"

using namespace malus;
using malus::testing::scattered;

namespace {
constexpr double pi = std::numbers::pi;
const SpectralGridPtr& grid() {
  static const SpectralGridPtr it = SpectralGrid::make({550.0});
  return it;
}
CDSpectralVector<double> flat(double value) { return {grid(), value}; }
PaintLayer coat(double n, double k, double thickness_um, double concentration = 0.15,
                double radius_nm = 110, double spread = 1.3) {
  return {{{flat(n), flat(k), {radius_nm, spread}, concentration}}, thickness_um};
}
BRDFLayeredPaint paint(double binder, const std::vector<PaintLayer>& layers, double substrate,
                       double sigma = 0, int streams = 0) {
  const PaintSurface face(flat(binder), {}, sigma);
  return BRDFLayeredPaint(face, paintVolume(face, layers, flat(substrate), streams));
}
}  // namespace

// A binder of air has no face: the light of chapter AddingDoubling must come out, at nodes of the table.
TEST(PaintScatteringInvariant, WithoutAFaceItIsAddingDoubling) {
  const std::vector<PaintLayer> layers{coat(1.5, 0.01, 0.8), coat(1.8, 0, 1.5, 0.1, 200)};
  const BRDFLayeredPaint body = paint(1, layers, 0.3, 0, 24);
  std::vector<AirLayer> air;
  for (const PaintLayer& layer : layers) {
    const Pigment& p = layer.pigments[0];
    const MiePowder powder = miePowder(p.n[0], p.k[0], p.sizes, 550);
    air.push_back({{powder.scatterer,
                    p.concentration * layer.thickness_um * 1e3 * powder.extinction_nm2 /
                        powder.volume_nm3,
                    powder.scattering_nm2 / powder.extinction_nm2}});
  }
  const double sun = PaintVolume::nodeCosine(3);
  const std::vector<double> views{PaintVolume::nodeCosine(2), PaintVolume::nodeCosine(6)};
  const AddingDoubling light(air, sun, 0.3, 1, views);
  for (std::size_t v = 0; v < 2; ++v)
    for (const double phi : {0.3, 1.5, 3.0, 5.0}) {  // from the beam's, clockwise
      const auto f =
          body.getBRDF(BRDFGeometry::fromAngles(std::acos(sun), std::acos(views[v]), pi - phi))
              .at(0);
      const CDStokesVector there = light.up(v, phi);
      for (int k = 0; k < 4; ++k)  // the polynomial, and harmonics left out
        EXPECT_NEAR(f.getMueller(k, 0) * sun, there.getStokes(k), 1e-4 * there.getStokes(0))
            << v << phi << k;
      EXPECT_GT(std::abs(f.getMueller(2, 0) * sun - light.up(v, -phi).getStokes(2)),
                1e-4 * there.getStokes(0));
    }
}

// A thin coat on black scatters once: the grains' own matrix between the directions inside, for light of four
// polarisations, passed by the face on both ways.
TEST(PaintScatteringIdentity, AThinCoatScattersOnceInAllSixteenElements) {
  const double n = 1.5;
  const PaintLayer thin = coat(2.4, 0.45, 1e-4, 0.1, 150, 1);
  const MiePowder powder = miePowder(2.4 / n, 0.45 / n, {150, 1}, 550 / n);
  const double depth = 0.1 * 0.1 * powder.extinction_nm2 / powder.volume_nm3,
               albedo = powder.scattering_nm2 / powder.extinction_nm2;
  const PaintSurface face(flat(n), {}, 0);
  const BRDFLayeredPaint body = paint(n, {thin}, 0, 0, 24);
  const auto passing = [&](double cosine) {
    const auto T = face.transmission(cosine, 0);
    return CDMuellerMatrix(std::array<double, 16>{T.sum, T.diff, 0, 0, T.diff, T.sum, 0, 0, 0,
                                                  0, T.re, T.im, 0, 0, -T.im, T.re});
  };
  double largest_lower = 0;
  for (const double phi : {0.4, 2.0, 4.0}) {
    const double o_i = PaintVolume::nodeCosine(5), o_r = PaintVolume::nodeCosine(2);
    const auto f =
        body.getBRDF(BRDFGeometry::fromAngles(std::acos(o_i), std::acos(o_r), phi)).at(0);
    const double mu_i = std::sqrt(1 - (1 - o_i * o_i) / (n * n)),
                 mu_r = std::sqrt(1 - (1 - o_r * o_r) / (n * n));
    const CDVector from = -CDVector::fromAngles(std::acos(mu_i), 0.7),
                   to = CDVector::fromAngles(std::acos(mu_r), 0.7 + phi);
    const double once = albedo / (4 * pi * (mu_i + mu_r)) *
                        -std::expm1(-depth * (1 / mu_i + 1 / mu_r)) / (n * n);
    const auto seen = [&](CDStokesVector light) {
      return passing(o_r) * scattered(powder.scatterer, passing(o_i) * light, from, to);
    };
    for (int column = 0; column < 4; ++column) {
      std::array<double, 4> pure{1, 0, 0, 0};
      pure[static_cast<std::size_t>(column)] = 1;
      const CDStokesVector light = seen({pure[0], pure[1], pure[2], pure[3]}),
                           plain = seen({1, 0, 0, 0});
      for (int row = 0; row < 4; ++row) {
        const double expected =
            once * (light.getStokes(row) - (column > 0 ? plain.getStokes(row) : 0));
        // scattering twice, and harmonics left out
        EXPECT_NEAR(f.getMueller(row, column), expected, 2e-3 * f.getScalar())
            << phi << row << column;
        if ((row == 3) != (column == 3))
          largest_lower = std::max(largest_lower, std::abs(expected / f.getScalar()));
      }
    }
  }
  EXPECT_GT(largest_lower, 0.02);  // a wrong sign would have been seen
}

// No absorption, all light returned by the ground or by depth: what enters comes out.
TEST(PaintScatteringInvariant, AWhiteBodyReturnsWhatEnters) {
  const BRDFLayeredPaint over_white = paint(1.5, {coat(2.75, 0, 20)}, 1),
                         rough = paint(1.5, {coat(2.75, 0, 20)}, 1, 0.3);
  const PaintSurface face(flat(1.5), {}, 0), rough_face(flat(1.5), {}, 0.3);
  for (const double cosine : {0.1, 0.3, 0.5, 0.8, 1.0}) {
    // straight lines of the table between nodes; the normal has a node
    EXPECT_NEAR(
        over_white.getVolumeDHR(std::acos(cosine))[0] / face.transmission(cosine, 0).sum, 1,
        2e-3)
        << cosine;
    EXPECT_NEAR(
        rough.getVolumeDHR(std::acos(cosine))[0] / rough_face.transmission(cosine, 0).sum, 1,
        2e-3)
        << cosine;
  }
  EXPECT_LT(paint(1.5, {coat(2.75, 1e-4, 20)}, 1).getVolumeDHR(0)[0],
            0.95);  // negative control
  // infinitely thick: one minus what gets through, which goes with 1/depth
  const double d100 = 0.96 - paint(1.5, {coat(2.75, 0, 100)}, 0).getVolumeDHR(0)[0],
               d1000 = 0.96 - paint(1.5, {coat(2.75, 0, 1000)}, 0).getVolumeDHR(0)[0];
  EXPECT_LT(d1000, 0.01);
  EXPECT_NEAR(d100 / d1000, 10, 1.5);
}

TEST(PaintScatteringInvariant, ThickerIsWhiterAndStreamsDoNotMatter) {
  double before = 0;
  for (const double um : {0.0, 1.0, 3.0, 10.0, 30.0}) {
    const double dhr = paint(1.5, {coat(2.75, 0, um)}, 0).getVolumeDHR(0.8)[0];
    EXPECT_GT(dhr, um > 0 ? before + 1e-3 : -1);
    before = dhr;
  }
  const auto g = BRDFGeometry::fromDegrees(50, 70, 130);
  const auto few = paint(1.5, {coat(2.75, 0.01, 10)}, 0.2).getBRDF(g).at(0),
             many = paint(1.5, {coat(2.75, 0.01, 10)}, 0.2, 0, 32).getBRDF(g).at(0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(few.getMueller(i, j), many.getMueller(i, j), 2e-4 * few.getScalar())
          << i << j;  // harmonics left out
}

// Views a hair to both sides of the normal are the same view: odd harmonics must vanish there like the sine.
TEST(PaintScatteringIdentity, NothingJumpsAcrossTheNormal) {
  const BRDFLayeredPaint dark = paint(1.5, {coat(1.8, 0.4, 50)}, 0);
  const auto at = [&](double degrees) {
    const auto g = BRDFGeometry::fromDegrees(45, std::abs(degrees), degrees < 0 ? 0 : 180);
    return dark.getBRDF(g).at(0);
  };
  for (const auto& [row, column] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
    EXPECT_NEAR(at(-1e-4).getMueller(row, column), at(1e-4).getMueller(row, column),
                1e-5 * at(0).getScalar());
  EXPECT_GT(std::abs(at(-5).getMueller(1, 0) - at(5).getMueller(1, 0)),
            1e-3 * at(0).getScalar());
}

// Large grains, whose forward peak needs many streams: still no light lost or made.
TEST(PaintScatteringInvariant, LargeGrainsKeepEnergyToo) {
  const BRDFLayeredPaint large = paint(1.5, {coat(1.7, 0, 10, 0.15, 500, 1.2)}, 1);
  const PaintSurface face(flat(1.5), {}, 0);
  for (const double cosine : {0.3, 0.8, 1.0})
    EXPECT_NEAR(large.getVolumeDHR(std::acos(cosine))[0] / face.transmission(cosine, 0).sum, 1,
                2e-3)
        << cosine;
}

TEST(PaintScatteringIdentity, ImpossibleRecipesAreRefused) {
  EXPECT_THROW(paint(1.5, {coat(2.75, 0, -1)}, 0), MathError);
  EXPECT_THROW(paint(1.5, {coat(2.75, 0, 1, 0.6)}, 0), MathError);
  EXPECT_THROW(paint(1.5, {coat(2.75, -0.1, 1)}, 0), MathError);
  EXPECT_THROW(paint(1.5, {coat(2.75, 0, 1, 0.1, 1e5)}, 0), MathError);
  EXPECT_THROW(paint(1.5, {}, 1.1), MathError);
  EXPECT_THROW(paint(1.5, {}, 1, 0, 15), MathError);
}
