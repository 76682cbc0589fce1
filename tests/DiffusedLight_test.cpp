// Light that diffuses through panels, against the equation solved by hand (nw/air/DiffusedLight.nw).
#include "malus/air/DiffusedLight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "malus/air/Scatterer.hpp"

using namespace malus;
using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

namespace {
const DepthPanels panels({8}, {}, {0.05, 1, {0.5}});
VectorXd depths() {
  const GaussRule rule(DepthPanels::nodes);
  VectorXd at(static_cast<Index>(panels.size()));
  Index node = 0;
  for (const auto& panel : panels.panels)
    for (const double x : rule.at) at[node++] = panel.top + panel.thickness * x;
  return at;
}
struct Completed {
  RowVectorXd even, odd;  // without the source itself
};
Completed complete(double albedo, double g, double ground, double even, double odd) {
  const VectorXd at = depths();
  const DiffusedLight light(panels, VectorXd::Constant(at.size(), albedo / 2),
                            VectorXd::Constant(at.size(), 1.5 * albedo * g), ground);
  Completed sources{RowVectorXd::Constant(at.size(), even),
                    RowVectorXd::Constant(at.size(), odd)};
  light.complete(sources.even, sources.odd);
  return {sources.even.array() - even, sources.odd.array() - odd};
}
}  // namespace

// An even source of 1/2 everywhere, nothing absorbed, white ground: q1 = 8 - t rises, and q0 = 2 q1(0) + 3 (1 - g) of its
// integral from the top. 1e-3: nodes are not the middles of their pieces.
TEST(DiffusedLightByHand, WhatRisesFromAWhiteGround) {
  const VectorXd at = depths();
  for (const double g : {0.0, 0.8}) {
    const Completed light = complete(1, g, 1, 0.5, 0);
    for (Index i = 0; i < at.size(); ++i) {
      const double q1 = 8 - at[i], q0 = 16 + 3 * (1 - g) * (8 * at[i] - at[i] * at[i] / 2);
      EXPECT_NEAR(light.even[i] / (q0 / 2), 1, 1e-3) << at[i];
      EXPECT_NEAR(light.odd[i], 1.5 * g * q1, 0.1 * g)
          << at[i];  // flows between nodes, averaged
    }
  }
}

// With absorption and a black ground: q0 = 2 r0 / (1 - albedo) less hyperbolic cosines about the middle, with what leaves
// both sides; 2e-3.
TEST(DiffusedLightByHand, AbsorptionAndABlackGround) {
  const VectorXd at = depths();
  const double albedo = 0.9, g = 0.5, c = 1 - albedo * g, k = std::sqrt(3 * (1 - albedo) * c),
               far = 2 * 0.5 / (1 - albedo);
  // at the top q1 = q0' / 3 c = q0 / 2, with q0 = far - a cosh(k (t - 4))
  const double a = far / 2 / (std::cosh(4 * k) / 2 + k * std::sinh(4 * k) / (3 * c));
  const Completed light = complete(albedo, g, 0, 0.5, 0);
  for (Index i = 0; i < at.size(); ++i)
    EXPECT_NEAR(light.even[i] / (albedo / 2 * (far - a * std::cosh(k * (at[i] - 4)))), 1, 2e-3);
  const Completed grey = complete(albedo, g, 0.5, 0.5, 0);  // control: the ground is seen
  EXPECT_GT(grey.even[at.size() - 1] / light.even[at.size() - 1], 1.1);
}

// A source that sends its light up alone drives a flow: the same everywhere, so that nothing but both ends makes it uneven.
TEST(DiffusedLightByHand, ASourceThatSendsUp) {
  const Completed light = complete(1, 0, 0, 0, 0.75);
  // q1 = 1/2 + q0' / 3 is constant, q0(0) = 2 q1, q0(8) = -2 q1: q0' = -q1 / 2
  const double q1 = 0.5 / (1 + 1.0 / 6);
  EXPECT_NEAR(light.even[0], q1, 2e-3);
  EXPECT_NEAR(light.even[light.even.size() - 1], -q1, 2e-3);
}
