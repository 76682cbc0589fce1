// The lobe of the older DIRSIG (nw/surface/BRDFDIRSIG.nw) against sums over fine steps.
#include "malus/surface/BRDFDIRSIG.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "ModelChecks.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/surface/ModelRegistry.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
constexpr auto shapes = {LobeShape::cone, LobeShape::cosine, LobeShape::exponential};

BRDFDIRSIG surface(double rho, double height, double width_deg, LobeShape shape) {
  const auto grid = SpectralGrid::make({550.0});
  const auto of = [&](double x) { return CDSpectralVector<double>(grid, x); };
  return BRDFDIRSIG(of(rho), of(height), of(width_deg * degree), shape);
}
double f00(const BRDFDIRSIG& model, double theta_i, double theta_r, double phi) {
  return model.getBRDF(BRDFGeometry::fromDegrees(theta_i, theta_r, phi)).at(0).getScalar();
}
/// Bands of two widths and changing heights.
BRDFDIRSIG varied(LobeShape shape, bool wide = true) {
  const auto grid = manyBands();
  auto width = ramp(grid, 0.4, 0.4);
  if (wide)
    for (std::size_t i = 70; i < width.size(); ++i) width[i] = 0.7;
  return BRDFDIRSIG(ramp(grid, 0.1, 0.4), ramp(grid, 0.3, 0.1), width, shape);
}
}  // namespace

// The example of the chapter: half of the height half a width off the mirror direction.
TEST(BRDFDIRSIGIdentity, TheExampleOfTheChapter) {
  for (const auto shape : shapes) {
    const BRDFDIRSIG model = surface(0.1, 2, 20, shape);
    EXPECT_NEAR(f00(model, 40, 40, 180), 0.1 / pi + 2, 1e-14);
    EXPECT_NEAR(f00(model, 40, 50, 180), 0.1 / pi + 1, 1e-13);
    EXPECT_NEAR(f00(model, 40, 30, 180), 0.1 / pi + 1, 1e-13);
    EXPECT_NEAR(f00(model, 40, 60, 180), 0.1 / pi + (shape == LobeShape::exponential ? 0.5 : 0),
                1e-13);
    EXPECT_GT(std::abs(f00(model, 40, 50.1, 180) - 0.1 / pi - 1), 1e-3);  // negative control
  }
}

// Out of the plane: the angle between vectors, by the arc cosine of their product.
TEST(BRDFDIRSIGIdentity, TheAngleIsThatBetweenVectors) {
  const BRDFDIRSIG model = surface(0, 0.2, 80, LobeShape::exponential);
  for (const Angles& a : someAngles(50)) {
    const CDVector mirror = CDVector::fromAngles(a.theta_i, pi),
                   viewer = CDVector::fromAngles(a.theta_r, a.phi);
    const double x = std::acos(std::min(dot(mirror, viewer), 1.0)) / (80 * degree);
    EXPECT_NEAR(model.getBRDF(a.there()).at(0).getScalar(), 0.2 * std::exp2(-2 * x), 1e-9);
  }
}

TEST(BRDFDIRSIGIdentity, AlbedosAreSumsOverFineSteps) {
  for (const auto shape : shapes)
    for (const double width : {0.01, 0.3, pi / 3, pi / 2}) {  // at pi/3 a denominator vanishes
      constexpr int steps = 400000;
      const double end = std::min(pi / 2, 30 * width);
      double sum = 0;
      for (int i = 0; i < steps; ++i) {
        const double t = end * (i + 0.5) / steps;
        sum += lobeShape(shape, t / width) * std::sin(2 * t);
      }
      sum *= pi * end / steps;
      EXPECT_NEAR(lobeAlbedo(shape, width) / sum, 1, 1e-8) << int(shape) << ' ' << width;
      EXPECT_GT(std::abs(lobeAlbedo(shape, 0.999 * width) / sum - 1),
                1e-4);  // negative control
    }
}

TEST(BRDFDIRSIGIdentity, DHRAgreesWithThePlainIntegration) {
  for (const auto shape : shapes)  // the plain rule does not see the tip and the edge of a lobe
    expectDHRIsTheIntegral(varied(shape), 1e-3);
}

// Riesz: no angle reflects more than normal incidence. And that one is the formula.
TEST(BRDFDIRSIGInvariant, NormalIncidenceReflectsMost) {
  for (const auto shape : shapes)
    for (const double width : {0.02, 0.3, 1.0, 1.5}) {
      const BRDFDIRSIG model = surface(0, 0.1, width / degree, shape);
      const double normal = model.getDHR(0)[0];
      EXPECT_NEAR(normal / (0.1 * lobeAlbedo(shape, width)), 1, 1e-9);
      for (double zenith = 0.05; zenith < 1.57; zenith += 0.05)
        EXPECT_LE(model.getDHR(zenith)[0], normal * (1 + 1e-9)) << zenith;
    }
}

TEST(BRDFDIRSIGInvariant, EnergyIsDemanded) {
  for (const auto shape : shapes) {
    const double most = 0.9 / lobeAlbedo(shape, 20 * degree);
    EXPECT_NEAR(largestDHR(surface(0.1, most, 20, shape)), 1, 1e-9);
    EXPECT_THROW(surface(0.1, 1.001 * most, 20, shape), MathError);
    EXPECT_THROW(surface(0.101, most, 20, shape), MathError);
  }
}

TEST(BRDFDIRSIGInvariant, ReciprocalRealizableAndFast) {
  for (const auto shape : shapes) {
    const BRDFDIRSIG model = varied(shape);
    EXPECT_LT(reciprocityError(model), 1e-14);  // the same sum of squares
    expectRealizable(model, 1e-12);
    expectScatterIsTheMatrix(model, 1e-14);  // three roundings
    expectNoAllocation(model);
    expectScoreAndHorizon(model);
    EXPECT_FALSE(model.getBRDF(BRDFGeometry::fromDegrees(30, 40, 180)).anyPolarized());
  }
}

TEST(BRDFDIRSIGInvariant, SamplesFollowTheirDensity) {
  for (const auto shape : shapes) expectSamplesFollowDensity(varied(shape));
  EXPECT_LT(draw(varied(LobeShape::cone), varied(LobeShape::cone, false), 0.6).p_value,
            false_alarm);  // negative control: another width
}

TEST(BRDFDIRSIGInvariant, TheSamplerGivesTheDHR) {
  for (const auto shape : shapes)
    EXPECT_LT(expectSamplerGivesDHR(surface(0.2, 2, 20, shape)), 0.01);
  // all light in a narrow peak: rings of equal share keep the noise low
  EXPECT_LT(expectSamplerGivesDHR(surface(0, 1000, 1, LobeShape::exponential)), 0.01);
  EXPECT_EQ(surface(0, 0, 1, LobeShape::cone).sample({0, 0, 1}, 0.5, 0.5, 0.5).direction.z > 0,
            true);  // black: still a direction
}

TEST(BRDFDIRSIGIdentity, ImpossibleSurfacesAreRefused) {
  const auto cone = LobeShape::cone;
  for (const double bad : {-0.1, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(surface(bad, 0.1, 20, cone), MathError);
    EXPECT_THROW(surface(0.1, bad, 20, cone), MathError);
    EXPECT_THROW(surface(0.1, 0.1, bad, cone), MathError);
  }
  EXPECT_THROW(surface(0.1, 0.1, 0, cone), MathError);
  EXPECT_THROW(surface(0.1, 0.1, 91, cone), MathError);
  EXPECT_THROW(surface(0.1, 0.1, 20, cone).getDHR(pi / 2), MathError);
  EXPECT_THROW(surface(0.1, 0.1, 20, cone).sample({0, 0, -1}, 0.5, 0.5, 0.5), MathError);
}

// A height in 1/sr of up to a thousand million is taken: a lobe of a few seconds of arc. More
// is not a surface.
TEST(BRDFDIRSIGIdentity, TheHeightOfTheLobeHasALimit) {
  const ModelEntry& entry = modelEntry("dirsig", {});
  const auto grid = SpectralGrid::make({550.0});
  const auto settings = [&](const std::string& height) {
    return checkedSettings(
        entry,
        {{"reflectance", {"0", {}}}, {"height", {height, {}}}, {"width_deg", {"20", {}}}},
        grid);
  };
  EXPECT_NO_THROW(settings("1e9"));
  EXPECT_THROW(settings("1.001e9"), InputError);
}
