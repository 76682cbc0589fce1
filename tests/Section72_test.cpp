// Curves through the BRDF and the direct evaluation of sections 7.2 to 7.4 (nw/thesis/Section72.nw,
// LobeShapes.nw).
#include "malus/thesis/Section72.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "Items.hpp"
#include "malus/base/Angles.hpp"

using namespace malus;

namespace {
double drawn(double low, double high) {
  return low + (high - low) * (*rc::gen::inRange(0, 1000001)) * 1e-6;
}

/// Largest difference of an element, relative to f00.
double apart(const CDMuellerMatrix& a, const CDMuellerMatrix& b) {
  double worst = 0;
  for (int i = 0; i < 16; ++i) worst = std::max(worst, std::abs(a.data()[i] - b.data()[i]));
  return worst / b.getMueller(0, 0);
}
}  // namespace

TEST(Section72Published, DirectEvaluationOfTheCopperPlate) {
  const CDMuellerMatrix f =
      directBRDF(CDVector::fromAngles(30 * degree, 0),
                 CDVector::fromAngles(40 * degree, std::numbers::pi), 0.405, 2.950, 0.2);
  EXPECT_NEAR(f.getMueller(0, 0), 1.17187, 5e-6);  // digits of finding 1
  EXPECT_NEAR(f.getMueller(1, 0), 0.040058, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 2), -1.131418, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 3), 0.302611, 5e-7);
  EXPECT_NEAR(f.getMueller(3, 2), -0.302611, 5e-7);
}

RC_GTEST_PROP(Section72Identity, ModelAgreesWithDirectEvaluation, ()) {
  const double theta_i = drawn(1, 85) * degree, theta_r = drawn(1, 85) * degree;
  const double phi = drawn(0, 360) * degree, n = drawn(0.1, 3), k = drawn(0, 8),
               sigma = drawn(0.1, 0.6);
  const BRDFTorranceSparrow model(n, k, sigma, {Shadowing::vGroove, DiffuseTerm::none});
  const CDMuellerMatrix ours = model.at(BRDFGeometry::fromAngles(theta_i, theta_r, phi));
  const CDMuellerMatrix direct = directBRDF(CDVector::fromAngles(theta_i, 0),
                                            CDVector::fromAngles(theta_r, phi), n, k, sigma);
  RC_PRE(direct.getMueller(0, 0) > 1e-200);
  // acos of a cosine near 1, and near-parallel rays, cost the direct evaluation half of its digits
  RC_ASSERT(apart(ours, direct) < 1e-6);
}

TEST(Section72Identity, NegativeControlThirdDigitOfTheIndexIsSeen) {
  const auto geometry = BRDFGeometry::fromDegrees(30, 40, 120);
  const BRDFTorranceSparrow model(0.406, 2.95, 0.2, {Shadowing::vGroove, DiffuseTerm::none});
  EXPECT_GT(
      apart(model.at(geometry),
            directBRDF(CDVector::fromAngles(30 * degree, 0),
                       CDVector::fromAngles(40 * degree, 120 * degree), 0.405, 2.95, 0.2)),
      1e-6);
}

TEST(Section72Identity, CurvesRunFromBackwardToForward) {
  const BRDFTorranceSparrow brdf(1.5, 0, 0.1);
  EXPECT_EQ(inPlane(brdf, 30)(20),
            brdf.at(BRDFGeometry::fromDegrees(30, 20, 180)).getMueller(0, 0));
  EXPECT_EQ(inPlane(brdf, 30)(-20),
            brdf.at(BRDFGeometry::fromDegrees(30, 20, 0)).getMueller(0, 0));
  EXPECT_GT(inPlane(brdf, 30)(30), inPlane(brdf, 30)(-30));
}

TEST(Section72Published, WhatDiffersIsWhatTheChapterTells) {
  // sec 5.2.1, significant at 45 deg; sec 7.3.1, linear shift; sec 7.3.2: widths at half maximum, forward peaks and their overlay
  struct {
    const char* id;
    std::size_t differs;
  } const items[] = {{"F7.2", 0},  {"F7.3", 0}, {"F7.4", 1}, {"F7.5", 0},
                     {"F7.6", 1},  {"F7.7", 3}, {"F7.8", 1}, {"F7.10", 0},
                     {"F7.11", 0}, {"C3", 1},   {"C4", 2}};
  for (const auto& [id, differs] : items) {
    EXPECT_EQ(named(ran(id), Verdict::differs).size(), differs) << id;
  }
}
