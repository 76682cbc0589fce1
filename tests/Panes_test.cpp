// Transmission through boundaries and panes (nw/surface/Panes.nw).
#include "malus/surface/Panes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "malus/base/Angles.hpp"
#include "malus/light/CDPolarimetricMath.hpp"

using namespace malus;
using std::numbers::pi;

namespace {
CDMuellerMatrix matrix(const FresnelTerms<double>& f) {
  return CDMuellerMatrix(
      {f.sum, f.diff, 0, 0, f.diff, f.sum, 0, 0, 0, 0, f.re, f.im, 0, 0, -f.im, f.re});
}
double apart(const CDMuellerMatrix& a, const CDMuellerMatrix& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      most = std::max(most, std::abs(a.getMueller(i, j) - b.getMueller(i, j)));
  return most;
}
double sine2(double theta) { return std::sin(theta) * std::sin(theta); }
PaneTerms paneAt(double theta, double n, double depth = 0) {
  return paneTerms(std::cos(theta), sine2(theta), n, depth);
}
/// Stokes 1862: the transmittance of m plates whose faces reflect r.
double pile(double r, int m) { return (1 - r) / (1 + (2 * m - 1) * r); }
const double angles_deg[] = {0, 20, 40, 56.3, 70, 85, 89};
}  // namespace

// Forty passages to and fro, each a product of the boundary's Mueller matrices; the last has the share r^80 < 1e-12 below
// 85 degrees, and the sums agree to rounding.
TEST(PanesIdentity, APaneIsTheSumOfItsReflections) {
  for (const double n : {1.33, 1.5, 2.4})
    for (const double depth : {0.0, 0.3})
      for (const double deg : {0.0, 20.0, 40.0, 56.3, 70.0}) {
        const double outside = toRadians(deg), inside = refractedAngle(outside, n);
        const double passage = std::exp(-depth / std::cos(inside));
        const CDMuellerMatrix in = fresnelTransmissionMatrix(outside, n),
                              out = fresnelTransmissionMatrix(inside, 1 / n),
                              back = fresnelReflectionMatrix(inside, 1 / n);
        CDMuellerMatrix through = CDMuellerMatrix() * 0.0,
                        mirrored = fresnelReflectionMatrix(outside, n);
        CDMuellerMatrix within = in * passage;
        for (int i = 0; i < 40; ++i) {
          through = through + out * within;
          within = back * within * passage;
          mirrored = mirrored + out * within;
          within = back * within * passage;
        }
        const PaneTerms pane = paneAt(outside, n, depth);
        EXPECT_LT(apart(matrix(pane.transmission), through), 1e-13) << n << ' ' << deg;
        EXPECT_LT(apart(matrix(pane.reflection), mirrored), 1e-13) << n << ' ' << deg;
      }
}

TEST(PanesIdentity, APileIsStokessFormula) {
  for (const double deg : angles_deg) {
    const double theta = toRadians(deg);
    const Reflectances face = fresnelReflectances(theta, 1.5);
    const PaneTerms one = paneAt(theta, 1.5);
    PaneTerms all = one;
    for (int m = 1; m <= 20; ++m) {
      const FresnelTerms<double>& t = all.transmission;
      EXPECT_NEAR(t.sum + t.diff, pile(face.Rs, m), 1e-14) << m << " at " << deg;
      EXPECT_NEAR(t.sum - t.diff, pile(face.Rp, m), 1e-14) << m << " at " << deg;
      EXPECT_NEAR(t.sum + all.reflection.sum, 1, 1e-14);
      all = behindEachOther(all, one);
    }
  }
}

TEST(PanesIdentity, NegativeControlAPileWithoutOneFace) {
  const Reflectances face = fresnelReflectances(toRadians(56.3), 1.5);
  const FresnelTerms<double> t = paneAt(toRadians(56.3), 1.5).transmission;
  EXPECT_GT(std::abs(t.sum + t.diff - (1 - face.Rs) / (1 + 0 * face.Rs)), 0.05);
}

// The numbers of the text.
TEST(PanesIdentity, NumbersOfTheText) {
  const FresnelTerms<double> straight = paneAt(0, 1.5).transmission;
  EXPECT_NEAR(straight.sum, 0.96 / 1.04, 1e-15);
  const FresnelTerms<double> brewster = paneAt(brewsterAngle(1.5), 1.5).transmission;
  EXPECT_NEAR(brewster.sum - brewster.diff, 1, 1e-15);
  EXPECT_NEAR(brewster.sum + brewster.diff, 0.742, 0.0005);
  EXPECT_NEAR(-brewster.diff / brewster.sum, 0.148, 0.0005);
  const double ten = pile(fresnelReflectances(brewsterAngle(1.5), 1.5).Rs, 10);
  EXPECT_NEAR(ten, 0.224, 0.0005);
  EXPECT_NEAR((1 - ten) / (1 + ten), 0.635, 0.0005);
  EXPECT_NEAR(radianceTransmission(1.0, 0.0, 4 / 3.0).sum, 1.74, 0.005);
}

TEST(PanesInvariant, NothingIsLostWithoutAbsorption) {
  for (const double n : {0.75, 1.0, 1.33, 1.5, 4.0})
    for (double deg = 0; deg <= 90; deg += 0.5) {
      const PaneTerms pane = paneAt(toRadians(deg), n);
      EXPECT_NEAR(pane.reflection.sum + pane.transmission.sum, 1, 1e-14) << n << ' ' << deg;
      EXPECT_NEAR(pane.reflection.diff + pane.transmission.diff, 0, 1e-14) << n << ' ' << deg;
    }
}

TEST(PanesInvariant, MatricesAreRealisable) {
  for (const double n : {0.75, 1.33, 1.5, 4.0})
    for (const double depth : {0.0, 0.1, 3.0})
      for (double deg = 0; deg <= 90; deg += 1.5) {
        const PaneTerms pane = paneAt(toRadians(deg), n, depth);
        for (const FresnelTerms<double>& f : {pane.reflection, pane.transmission}) {
          // positive powers, and |x|^2 <= Rs Rp: what a mixture of Jones matrices of this shape has
          EXPECT_GE(f.sum - std::abs(f.diff), -1e-15) << n << ' ' << depth << ' ' << deg;
          EXPECT_LE(f.re * f.re + f.im * f.im, f.sum * f.sum - f.diff * f.diff + 1e-15)
              << n << ' ' << depth << ' ' << deg;
        }
      }
}

TEST(PanesInvariant, AbsorptionTakesFromBothSides) {
  const PaneTerms clear = paneAt(0.7, 1.5), smoky = paneAt(0.7, 1.5, 0.5);
  EXPECT_LT(smoky.transmission.sum, clear.transmission.sum * std::exp(-0.5));
  EXPECT_LT(smoky.reflection.sum, clear.reflection.sum);
  EXPECT_GT(smoky.reflection.sum, fresnelReflectances(0.7, 1.5).Rp);
}

// A uniform sky of one: the irradiance beneath the boundary is that above it, less what is reflected. The product rule has
// 20000 rings; its error is that of the kink at the rim of Snell's window, 1/20000 squared, and the step at grazing light.
TEST(PanesInvariant, IrradianceInSnellsWindow) {
  const double n = 4 / 3.0;
  const int rings = 20000;
  double above = 0, beneath = 0, window = 0;
  for (int i = 0; i < rings; ++i) {
    const double x =
        (i + 0.5) / rings;  // squared sine of the angle, uniform in projected solid angle
    above += pi / rings *
             (1 - fresnelReflectances(std::asin(std::sqrt(x)), n).Rs / 2 -
              fresnelReflectances(std::asin(std::sqrt(x)), n).Rp / 2);
    const auto up = refractedDirection({std::sqrt(x), 0, std::sqrt(1 - x)}, {0, 0, -1}, 1 / n);
    if (!up) continue;
    window += pi / rings;
    beneath += pi / rings * radianceTransmission(up->z, 1 - up->z * up->z, n).sum;
  }
  EXPECT_NEAR(beneath, above, 1e-4);
  EXPECT_NEAR(window, pi / (n * n), 1e-3);
  EXPECT_GT(std::abs(beneath / (n * n) - above), 1);  // negative control: without n^2
}

TEST(PanesIdentity, RefractionObeysSnellAndIsUndone) {
  const CDVector normal = CDVector::fromAngles(0.3, 1.1);
  for (const double n : {0.7, 1.33, 2.0})
    for (int i = 0; i < 50; ++i) {
      const CDVector direction = -CDVector::fromAngles(0.3 + 0.02 * i, 1.1 + 0.3 * i);
      const double cosine = -dot(direction, normal);
      if (cosine <= 0) continue;
      const double sine = cross(direction, normal).getLength();
      const auto beyond = refractedDirection(direction, normal, n);
      ASSERT_EQ(beyond.has_value(), sine < n);
      if (!beyond) continue;
      EXPECT_NEAR(cross(*beyond, normal).getLength() * n, sine, 1e-14);
      EXPECT_NEAR(dot(*beyond, cross(direction, normal)), 0, 1e-15);
      const auto back = refractedDirection(-*beyond, -normal, 1 / n);
      ASSERT_TRUE(back);
      EXPECT_NEAR((*back + direction).getLength(), 0, 1e-7);
      EXPECT_NEAR(dot(mirroredDirection(direction, normal), normal), cosine, 1e-15);
    }
}

namespace {
/// The angle from the antisolar point at which light leaves a drop of index n that it met at this angle of incidence, after
/// one reflection inside; and the powers of s and p. Traced in a plane, from the boundary's own functions.
struct Drop {
  double angle_deg, s, p;
};
Drop leavingDrop(double incidence, double n) {
  const CDVector sunlight{0, 0, -1};
  CDVector normal = CDVector::fromAngles(incidence, 0), at = normal;
  CDVector d = *refractedDirection(sunlight, normal, n);
  Reflectances face = fresnelReflectances(incidence, n);
  double s = 1 - face.Rs, p = 1 - face.Rp;
  for (int leg = 0; leg < 2; ++leg) {
    at = at + d * (-2 * dot(at, d));  // the other end of the chord
    const CDVector inward = -at;
    const double theta = std::acos(-dot(d, inward));
    const Reflectances inner = fresnelReflectances(theta, 1 / n);
    if (leg == 0)
      d = mirroredDirection(d, inward), s *= inner.Rs, p *= inner.Rp;
    else
      d = *refractedDirection(d, inward, 1 / n), s *= 1 - inner.Rs, p *= 1 - inner.Rp;
  }
  return {toDegrees(std::acos(std::clamp(dot(d, -sunlight), -1.0, 1.0))), s, p};
}
}  // namespace

// Of all rays through a drop the rainbow's leave farthest from the antisolar point. Descartes: cos^2 = (n^2 - 1)/3.
TEST(PanesPublished, TheRainbowStandsAt42Degrees) {
  const double n = 1.333;
  Drop bow{0, 0, 0};
  double at = 0;
  for (double incidence = 0; incidence < pi / 2; incidence += 1e-4)
    if (const Drop drop = leavingDrop(incidence, n); drop.angle_deg > bow.angle_deg)
      bow = drop, at = incidence;
  EXPECT_NEAR(bow.angle_deg, 42.08, 0.01);
  EXPECT_NEAR(std::cos(at) * std::cos(at), (n * n - 1) / 3, 2e-3);
  EXPECT_NEAR(bow.s / (bow.s + bow.p), 0.96, 0.005);
  EXPECT_LT(leavingDrop(at, 1.343).angle_deg,
            bow.angle_deg - 1);  // blue is inside, red outside
}
