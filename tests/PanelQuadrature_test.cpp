// The rule that forgives roots (nw/base/PanelQuadrature.nw) against integrals in closed form.
#include "malus/base/PanelQuadrature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

using namespace malus;

namespace {
template <std::size_t N, class F>
double integral(double low, double high, const std::array<double, N>& breaks, const F& f) {
  double sum = 0;
  overPanels(low, high, breaks, [&](double x, double weight) { sum += weight * f(x); });
  return sum;
}
constexpr double no_break = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST(PanelQuadratureIdentity, Polynomials) {
  // x^n dx becomes a polynomial of degree 3n + 2 in u, and 16 points are exact up to degree 31
  for (int n = 0; n <= 9; ++n)
    EXPECT_NEAR(integral(0, 2, std::array{no_break}, [&](double x) { return std::pow(x, n); }),
                std::pow(2, n + 1) / (n + 1), 1e-12 * std::pow(2, n));
  EXPECT_GT(
      std::abs(integral(0, 2, std::array{no_break}, [](double x) { return std::pow(x, 40); }) /
                   (std::pow(2, 41) / 41) -
               1),
      1e-12);  // negative control: too high a degree for the rule
}

TEST(PanelQuadratureIdentity, RootsAtTheEnds) {
  // the remaining singularity of the substituted root lies at u = +-2; measured error 1e-15
  EXPECT_NEAR(integral(0, 1, std::array{no_break}, [](double x) { return std::sqrt(x); }),
              2.0 / 3, 1e-10);
  EXPECT_NEAR(
      integral(-1, 1, std::array{no_break}, [](double x) { return std::sqrt(1 - x * x); }),
      std::numbers::pi / 2, 1e-10);
}

TEST(PanelQuadratureIdentity, ABendMustBeTold) {
  const auto bent = [](double x) { return std::sqrt(std::abs(x - 0.3)); };
  const double expected = 2.0 / 3 * (std::pow(0.3, 1.5) + std::pow(0.7, 1.5));
  EXPECT_NEAR(integral(0, 1, std::array{0.3, 5.0, -1.0, no_break}, bent), expected, 1e-10);
  EXPECT_GT(std::abs(integral(0, 1, std::array{no_break}, bent) - expected), 1e-5);
}
