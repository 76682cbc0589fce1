// A layered paint (nw/surface/BRDFLayeredPaint.nw) against the glossy coating, Torrance-Sparrow facets, and what all
// models must pass. Its bodies are solved by nw/air/PaintScattering.nw, which has its own test.
#include "malus/surface/BRDFLayeredPaint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ModelChecks.hpp"
#include "malus/air/PaintScattering.hpp"
#include "malus/base/Error.hpp"
#include "malus/surface/BRDFGlossyCoating.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

// Bodies of two bands, a white coat over grey and a dark coat, mixed differently in each of the bands of a grid.
PaintVolume mixedBody(const CDSpectralVector<double>& n) {
  const auto two = SpectralGrid::make({500.0, 600.0});
  const PaintSurface face(CDSpectralVector<double>(two, 1.5), {}, 0);
  CDSpectralVector<double> pigment_n(two, 2.7), pigment_k(two, 0.0), ground(two, 0.4);
  pigment_n[1] = 1.8, pigment_k[1] = 0.4, ground[1] = 0;
  static const PaintVolume solved =
      paintVolume(face, {{{{pigment_n, pigment_k, {110, 1.2}, 0.1}}, 5}}, ground);
  PaintVolume body(n.size(), solved.orders());
  for (std::size_t m = 0; m < body.orders(); ++m)
    for (std::size_t out = 0; out < PaintVolume::nodes; ++out)
      for (std::size_t in = 0; in < PaintVolume::nodes; ++in)
        for (std::size_t e = 0; e < 16; ++e)
          for (std::size_t band = 0; band < n.size(); ++band) {
            const double share = static_cast<double>(band) / static_cast<double>(n.size());
            const double* from = solved.plane(m, out, in, e);
            body.plane(m, out, in, e)[band] = (1 - share) * from[0] + share * from[1];
          }
  return body;
}
BRDFLayeredPaint varied(double sigma, bool film) {
  const CDSpectralVector<double> n(manyBands(), 1.5);
  std::vector<PaintFilm> films;
  if (film) films.push_back({ramp(manyBands(), 1.35, 2.2), 140});
  return BRDFLayeredPaint(PaintSurface(n, films, sigma), mixedBody(n));
}
/// One band, so that many draws take little time.
BRDFLayeredPaint white(double sigma, bool film) {
  const CDSpectralVector<double> n(SpectralGrid::make({550.0}), 1.5);
  std::vector<PaintFilm> films;
  if (film) films.push_back({CDSpectralVector<double>(n.getGrid(), 2.0), 140});
  return BRDFLayeredPaint(PaintSurface(n, films, sigma), mixedBody(n));
}
BRDFLayeredPaint unpigmented(double n, double rho, double sigma) {
  const auto grid = SpectralGrid::make({550.0});
  const PaintSurface face(CDSpectralVector<double>(grid, n), {}, sigma);
  return BRDFLayeredPaint(face, paintVolume(face, {}, CDSpectralVector<double>(grid, rho)));
}
}  // namespace

// Without pigment it is the glossy coating, smooth and rough. Straight lines of tables over the cosine: 2e-4.
TEST(BRDFLayeredPaintIdentity, WithoutPigmentItIsTheGlossyCoating) {
  for (const double sigma : {0.0, 0.2})
    for (const double rho : {0.0, 0.5, 1.0}) {
      const auto grid = SpectralGrid::make({550.0});
      const BRDFGlossyCoating coating(CDSpectralVector<double>(grid, 1.5),
                                      CDSpectralVector<double>(grid, rho), sigma);
      const BRDFLayeredPaint paint = unpigmented(1.5, rho, sigma),
                             other = unpigmented(1.5, 0.8 * rho + 0.05, sigma);
      for (const Angles& a : someAngles(40)) {
        const auto ours = paint.getBRDF(a.there()).at(0),
                   theirs = coating.getBRDF(a.there()).at(0);
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j)
            EXPECT_NEAR(ours.getMueller(i, j), theirs.getMueller(i, j),
                        2e-4 * theirs.getScalar() + 1e-5)
                << sigma << ' ' << rho << ' ' << i << j;
      }
      for (const double zenith : {0.0, 0.7, 1.3}) {
        EXPECT_NEAR(paint.getDHR(zenith)[0], coating.getDHR(zenith)[0], 3e-4);
        EXPECT_GT(std::abs(other.getDHR(zenith)[0] - coating.getDHR(zenith)[0]),
                  3e-4);  // control
      }
    }
}

TEST(BRDFLayeredPaintInvariant, ReciprocalRealizableAndFast) {
  for (const double sigma : {0.0, 0.15})
    for (const bool film : {false, true}) {
      const BRDFLayeredPaint model = varied(sigma, film);
      EXPECT_LT(reciprocityError(model), 1e-10);               // rotations near the normal
      EXPECT_GT(reciprocityError(model, {1, 1, 1, 1}), 1e-4);  // negative control
      expectRealizable(model, 1e-4);                           // harmonics left out
      expectScatterIsTheMatrix(model, 1e-12);
      expectNoAllocation(model);
      expectScoreAndHorizon(model);
      EXPECT_LE(largestDHR(model), 1);
    }
}

TEST(BRDFLayeredPaintIdentity, DHRIsTheIntegral) {
  // the plain rule ignores the bends of the tables and the grooves
  expectDHRIsTheIntegral(white(0, false), 1e-3);
  expectDHRIsTheIntegral(white(0.2, true), 1e-3);
}

// What leaves the body is polarised by the face, along the plane of view: F-BEAM's assumption would be zero.
TEST(BRDFLayeredPaintPublished, LightFromInsideIsPolarised) {
  const auto f = unpigmented(1.5, 1, 0).getBRDF(BRDFGeometry::fromDegrees(0, 60, 0)).at(0);
  EXPECT_NEAR(f.getMueller(1, 0) / f.getScalar(), -0.0874 / 0.9108,
              3e-4);  // Ellis, by hand in ch. BRDFGlossyCoating
  const auto varied_f = varied(0, false).getBRDF(BRDFGeometry::fromDegrees(0, 60, 0));
  EXPECT_LT(varied_f.at(0).getMueller(1, 0), -0.05 * varied_f.at(0).getScalar());
}

TEST(BRDFLayeredPaintInvariant, TheSampler) {
  expectSamplesFollowDensity(varied(0.2, true));
  EXPECT_LT(draw(varied(0.2, true), varied(0.17, true), 0.6).p_value,
            false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(white(0.2, true)), 0.02);
  EXPECT_LT(expectSamplerGivesDHR(white(0, false)), 0.02);
}

TEST(BRDFLayeredPaintIdentity, FaceAndBodyMustFit) {
  const CDSpectralVector<double> n(manyBands(), 1.5);
  EXPECT_THROW(BRDFLayeredPaint(PaintSurface(n, {}, 0), PaintVolume(3, 1)), MathError);
}
