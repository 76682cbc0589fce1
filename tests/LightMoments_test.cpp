// Moments of light by parity, and sources from moments (nw/air/LightMoments.nw).
#include "malus/air/LightMoments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "malus/air/Scatterer.hpp"

using namespace malus;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {
constexpr std::size_t terms = 12;
/// Equation rotations at any u, from its definition.
std::array<double, 16> rotation(int m, std::size_t l, double u) {
  std::vector<double> d(terms), plus(terms), minus(terms);
  sphericalFunctions(m, 0, u, d), sphericalFunctions(m, 2, u, plus);
  sphericalFunctions(m, -2, u, minus);
  const double r = (minus[l] + plus[l]) / 2, t = (minus[l] - plus[l]) / 2;
  return {d[l], 0, 0, 0, 0, r, t, 0, 0, t, r, 0, 0, 0, 0, d[l]};
}
struct Half {  // of the interval of u: Gauss's nodes from 0 to 1
  GaussRule rule{40};
  std::vector<double> cosines = rule.at;
};
/// One moment of one component.
Moments single(int m, const Components& c, std::size_t l, std::size_t component) {
  Moments q;
  for (std::size_t s = 0; s < 2; ++s) {
    const auto rows = static_cast<Index>((terms - std::size_t(m) - s + 1) / 2);
    q.plain[s] = MatrixXd::Zero(rows, c.plain), q.turned[s] = MatrixXd::Zero(rows, c.turned);
  }
  const std::size_t s = (l - std::size_t(m)) % 2;
  const auto row = static_cast<Index>((l - std::size_t(m)) / 2);
  if (component == 0 || component == 3)
    q.plain[s](row, component == 0 ? 0 : 1) = 1;
  else
    q.turned[s](row, component == 1 ? 0 : 1) = 1;
  return q;
}
}  // namespace

TEST(LightMomentsInvariant, ASourceIsTheFunctionOfItsTerm) {
  const std::vector<double> cosines{0.1, 0.5, 0.93};
  for (const int m : {0, 1, 2, 5})
    for (std::size_t l = std::size_t(m); l < terms; ++l) {
      const Components c(m, true);
      for (const std::size_t component : c.list()) {
        Flow j;
        synthesize(Rotations(cosines, m, terms), single(m, c, l, component), c, 1, j);
        for (std::size_t i = 0; i < cosines.size(); ++i)
          for (const std::size_t k : c.list()) {
            const auto row = static_cast<Index>(i);
            EXPECT_NEAR(j.up[k](row, 0), rotation(m, l, cosines[i])[4 * k + component], 1e-13)
                << m << l << k;
            EXPECT_NEAR(j.down[k](row, 0), rotation(m, l, -cosines[i])[4 * k + component],
                        1e-13)
                << m << l << k;
          }
      }
    }
}

// The functions are orthogonal on the whole interval: the integral of Pi_l Pi_l' is 2 / (2 l + 1) where l = l', for matrices too.
TEST(LightMomentsInvariant, LightOfOneTermHasOneMoment) {
  const Half half;
  for (const int m : {0, 1, 3})
    for (const std::size_t l : {3u, 4u, 9u})
      for (const std::size_t component : Components(m, true).list()) {
        const Components c(m, true);
        const Rotations along(half.cosines, m, terms);
        Flow light;
        synthesize(along, single(m, c, l, component), c, 1, light);
        const Eigen::Map<const Eigen::VectorXd> weight(half.rule.weight.data(), 40);
        for (const std::size_t k : c.list()) {
          light.up[k] = weight.asDiagonal() * light.up[k];
          light.down[k] = weight.asDiagonal() * light.down[k];
        }
        Moments q;
        analyze(along, light, c, 1, q);
        const double size = 2 / (2 * double(l) + 1);
        q.add(-size, single(m, c, l, component));
        EXPECT_LT(q.dot(q), 1e-24) << m << l << component;
        q.add(0.01 * size, single(m, c, l, component));  // control
        EXPECT_GT(q.dot(q), 1e-8);
      }
}

TEST(LightMomentsByHand, ScatteringMixesThePairs) {
  const Components c(1, true);
  std::vector<Eigen::ArrayXXd> greek(1, Eigen::ArrayXXd::Zero(terms, 6));
  greek[0].row(4) << 1, 2, 3, 4, 5, 6;  // alpha1 .. alpha4, beta1, beta2
  const std::array<std::array<double, 4>, 4> expected{
      {{1, 5, 0, 0}, {5, 2, 0, 0}, {0, 0, 3, -6}, {0, 0, 6, 4}}};
  for (std::size_t from = 0; from < 4; ++from) {
    Moments q = single(1, c, 4, from);
    scatterMoments(greek, {0}, 1, c, q);
    for (std::size_t to = 0; to < 4; ++to)
      EXPECT_EQ(q.dot(single(1, c, 4, to)), expected[from][to]) << from << to;
  }
}
