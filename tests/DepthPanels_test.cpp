// Panels of optical depth and the passage of light through them (nw/air/DepthPanels.nw).
#include "malus/air/DepthPanels.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "malus/air/Scatterer.hpp"

using namespace malus;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {
constexpr auto nodes = static_cast<Index>(DepthPanels::nodes);
/// A function of the depth at all nodes, for one direction.
template <class Function>
MatrixXd atNodes(const DepthPanels& depth, const Function& f) {
  const GaussRule rule(DepthPanels::nodes);
  MatrixXd values(1, static_cast<Index>(depth.size()));
  for (std::size_t q = 0; q < depth.panels.size(); ++q)
    for (Index k = 0; k < nodes; ++k)
      values(0, static_cast<Index>(q) * nodes + k) =
          f(depth.panels[q].top +
            depth.panels[q].thickness * rule.at[static_cast<std::size_t>(k)]);
  return values;
}
/// t^n and what it makes of light after the depth t along mu, by repeated integration by parts.
double passed(int n, double t, double mu) {
  double sum = 1 - std::exp(-t / mu);
  for (int i = 1; i <= n; ++i) sum = std::pow(t, i) - i * mu * sum;
  return sum;
}
}  // namespace

TEST(DepthPanelsByHand, EightPanelsOfTheExample) {
  const DepthPanels depth({1.0}, {}, {0.1, 1, {1}});
  ASSERT_EQ(depth.panels.size(), 8u);
  EXPECT_DOUBLE_EQ(depth.panels[0].thickness, 0.0625);
  EXPECT_DOUBLE_EQ(depth.panels[2].thickness, 0.125);
  EXPECT_DOUBLE_EQ(depth.panels[3].thickness, 0.25);
  EXPECT_DOUBLE_EQ(depth.panels[7].thickness, 0.0625);
}

TEST(DepthPanelsInvariant, EndsAreEdgesAndLayersKnown) {
  const DepthPanels depth({0.2, 0.5, 2.0}, {0.7, 0.2}, {1e-3, 0.1, {0.5}});
  for (const double end : {0.0, 0.2, 0.5, 0.7})
    EXPECT_NEAR(depth.panels.at(depth.edgeAt(end)).top, end, 1e-15);
  EXPECT_EQ(depth.edgeAt(2.0), depth.panels.size());
  double sum = 0;
  for (const auto& panel : depth.panels) {
    EXPECT_NEAR(panel.top, sum, 1e-14);
    EXPECT_EQ(panel.layer, panel.top < 0.2 - 1e-9 ? 0u : panel.top < 0.5 - 1e-9 ? 1u : 2u);
    sum += panel.thickness;
  }
  EXPECT_NEAR(sum, 2, 1e-14);
  EXPECT_NEAR(depth.whole(), 2, 1e-14);
}

// Each layer has its own limit, and in the dark there is none.
TEST(DepthPanelsInvariant, PanelsAreAsThickAsTheirLayerAllows) {
  const DepthPanels depth({10, 110}, {}, {1, 1, {0.5, 20}});
  double first = 0, second = 0;
  for (const auto& panel : depth.panels) {
    double& most = panel.layer == 0 ? first : second;
    most = std::max(most, panel.thickness);
  }
  EXPECT_LE(first, 0.5);
  EXPECT_GT(first, 0.25);
  EXPECT_LE(second, 20);
  EXPECT_GT(second, 10);
  const auto panels = [](double dark) {
    return DepthPanels({1000}, {}, {1, 1, {0.5}, dark}).panels;
  };
  EXPECT_EQ(panels(2000).size(), 2048u);
  EXPECT_LT(panels(10).size(), 60u);
  for (const auto& panel : panels(10)) EXPECT_LE(panel.thickness, panel.top < 10 ? 0.5 : 1000);
}

// Polynomials up to the seventh degree are exact, up and down, for all cosines; the eighth in one thick panel is not.
TEST(PassageInvariant, PolynomialsAreIntegratedExactly) {
  const DepthPanels depth({0.9}, {0.3}, {0.4, 1, {1}});
  for (const double mu : {1.0, 0.3, 0.02, 1e-3, 1e-6})
    for (const int n : {0, 1, 4, 7}) {
      const Passage passage(depth, {mu});
      MatrixXd light, edges = MatrixXd::Zero(1, static_cast<Index>(depth.panels.size()) + 1);
      passage.fall(atNodes(depth, [n](double t) { return std::pow(t, n); }), light, edges);
      const MatrixXd exact = atNodes(depth, [&](double t) { return passed(n, t, mu); });
      EXPECT_LT((light - exact).cwiseAbs().maxCoeff(), 2e-11) << mu << ' ' << n;
      EXPECT_NEAR(edges(0, edges.cols() - 1), passed(n, 0.9, mu), 2e-11);
      edges.setZero();
      passage.rise(atNodes(depth, [n](double t) { return std::pow(0.9 - t, n); }), light,
                   edges);
      EXPECT_LT((light - atNodes(depth, [&](double t) { return passed(n, 0.9 - t, mu); }))
                    .cwiseAbs()
                    .maxCoeff(),
                2e-11)
          << mu << ' ' << n;
      EXPECT_NEAR(edges(0, 0), passed(n, 0.9, mu), 2e-11);
    }
  const DepthPanels one({4.0}, {}, {4, 4, {4}});  // control
  const Passage passage(one, {1.0});
  MatrixXd light, edges = MatrixXd::Zero(1, 2);
  passage.fall(atNodes(one, [](double t) { return std::pow(t, 8); }), light, edges);
  EXPECT_GT(std::abs(edges(0, 1) - passed(8, 4, 1)), 1e-6);
}

TEST(PassageInvariant, LightDiesAwayOrKeepsUpWithItsSource) {
  const DepthPanels depth({3.0}, {1.1}, {1e-4, 0.1, {0.5}});
  const Passage passage(depth, {0.7, 0.01});
  const auto panels = static_cast<Index>(depth.panels.size());
  MatrixXd light, edges = MatrixXd::Zero(2, panels + 1);
  edges.col(0).setConstant(5);
  passage.fall(MatrixXd::Zero(2, static_cast<Index>(depth.size())), light, edges);
  EXPECT_NEAR(edges(0, panels), 5 * std::exp(-3 / 0.7), 1e-14);
  edges.setZero(), edges.col(panels).setConstant(5);
  passage.rise(MatrixXd::Constant(2, static_cast<Index>(depth.size()), 5), light, edges);
  EXPECT_LT((light.array() - 5).abs().maxCoeff(), 1e-12);
}
