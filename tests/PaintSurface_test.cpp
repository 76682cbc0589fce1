// The face of a paint (nw/surface/PaintSurface.nw) against Fresnel, the glossy coating and Torrance-Sparrow facets.
#include "malus/surface/PaintSurface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "malus/base/Error.hpp"
#include "malus/surface/BRDFGlossyCoating.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const SpectralGridPtr& grid() {
  static const SpectralGridPtr it = SpectralGrid::make({450.0, 550.0, 650.0});
  return it;
}
CDSpectralVector<double> flat(double value) { return {grid(), value}; }
PaintSurface face(double sigma, bool film) {
  return PaintSurface(flat(1.5),
                      film ? std::vector<PaintFilm>{{flat(1.38), 120}, {flat(2.1), 60}}
                           : std::vector<PaintFilm>{},
                      sigma);
}
}  // namespace

TEST(PaintSurfaceIdentity, BareAndSmoothIsFresnel) {
  const PaintSurface bare = face(0, false);
  for (const double c : {0.05, 0.3, 0.55, 0.8, 1.0}) {
    const auto T = bare.transmission(c, 1), exact = fresnelTransmission(c, 1 - c * c, 1.5);
    EXPECT_NEAR(T.sum, exact.sum, 1e-4) << c;  // straight lines between 128 nodes
    EXPECT_NEAR(T.diff, exact.diff, 1e-4) << c;
    EXPECT_NEAR(T.re, exact.re, 1e-4) << c;
    PaintSurface::Terms R;
    bare.reflect(c, 1 - c * c, 0, 3, R);
    EXPECT_NEAR(R.sum[2] + exact.sum, 1, 1e-14);
  }
  EXPECT_GT(std::abs(bare.transmission(0.3, 1).sum - bare.transmission(0.32, 1).sum), 1e-4);
}

// The coating's volume over a white substrate returns just T0, by its own integration over facets.
TEST(PaintSurfaceIdentity, RoughTransmissionIsTheGlossyCoatings) {
  for (const double sigma : {0.1, 0.4}) {
    const PaintSurface rough = face(sigma, false);
    const BRDFGlossyCoating coating(flat(1.5), flat(1), sigma);
    for (const double zenith : {0.0, 0.5, 1.0, 1.4})
      EXPECT_NEAR(rough.transmission(std::cos(zenith), 0).sum, coating.getVolumeDHR(zenith)[0],
                  1e-4)
          << sigma << ' ' << zenith;  // straight lines, twice
    EXPECT_GT(std::abs(rough.transmission(std::cos(1.4), 0).sum -
                       face(sigma + 0.05, false).transmission(std::cos(1.4), 0).sum),
              1e-4);  // negative control
  }
}

TEST(PaintSurfaceIdentity, FacetsReflectLikeTorranceAndSparrows) {
  for (const double sigma : {0.05, 0.2, 0.5}) {
    const PaintSurface rough = face(sigma, false);
    const BRDFTorranceSparrow facets(flat(1.5), flat(0), flat(sigma),
                                     {Shadowing::vGroove, DiffuseTerm::none, true});
    for (const double zenith : {0.0, 0.4, 0.9, 1.3})
      EXPECT_NEAR(rough.facetDHR(zenith)[1] / facets.getDHR(zenith)[1], 1, 1e-5)
          << sigma << ' ' << zenith;
    EXPECT_GT(std::abs(rough.facetDHR(1.3)[0] / facets.getDHR(1.32)[0] - 1), 1e-3);
  }
  EXPECT_EQ(face(0, false).facetDHR(0.5)[0], 0);
}

TEST(PaintSurfaceInvariant, WhatDoesNotPassIsReturned) {
  for (const double sigma : {0.0, 0.3})
    for (const bool film : {false, true}) {
      const PaintSurface surface = face(sigma, film);
      for (std::size_t band = 0; band < 3; ++band)
        for (const double inside : {0.1, 0.5, 0.74, 0.76, 0.85, 0.99, 1.0}) {
          const auto R = surface.insideReflection(inside, band);
          const double outside2 = 1 - 2.25 * (1 - inside * inside);
          const double passed =
              outside2 > 0 ? surface.transmission(std::sqrt(outside2), band).sum : 0;
          EXPECT_NEAR(R.sum + passed, 1, 1e-12);
          EXPECT_LE(R.re * R.re + R.im * R.im, R.sum * R.sum - R.diff * R.diff + 1e-12);
          if (outside2 > 0) {
            const auto T = surface.transmission(std::sqrt(outside2), band);
            EXPECT_LE(T.re * T.re + T.im * T.im, T.sum * T.sum - T.diff * T.diff + 1e-9);
          }
        }
    }
  // a quarter wave of 1.225 is a good face, and seen from below as well
  const PaintSurface good(flat(1.5), {{flat(1.2247449), 550.0 / 4 / 1.2247449}}, 0);
  EXPECT_NEAR(good.insideReflection(1, 1).sum, 0, 1e-6);
  EXPECT_GT(good.insideReflection(1, 0).sum, 1e-4);  // at another wavelength not
}

TEST(PaintSurfaceIdentity, ImpossibleFacesAreRefused) {
  EXPECT_THROW(PaintSurface(flat(0.9), {}, 0), MathError);
  EXPECT_THROW(PaintSurface(flat(1.5), {}, -0.1), MathError);
  EXPECT_THROW(PaintSurface(flat(1.5), {{flat(11), 10}}, 0), MathError);
  EXPECT_THROW(PaintSurface(flat(1.5), {{flat(1.4), 2100}}, 0), MathError);
  EXPECT_THROW(PaintSurface(flat(1.5), {{flat(1.4), -5}}, 0), MathError);
}
