// Spectral vectors (nw/light/CDSpectralVector.nw).
#include "light/CDSpectralVector.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

using namespace malus;

namespace {
using Stokes = CDSpectralVector<CDStokesVector>;
using Mueller = CDSpectralVector<CDMuellerMatrix>;
using Scalars = CDSpectralVector<double>;
}  // namespace

// Section 6.1.2 word for word, with the two misprints of eq 6.11 corrected (7.52 for 5.02, 1.20 for 1.10).
TEST(CDSpectralVectorPublished, WorkedExampleOfSection612) {
  const auto grid = CDSpectralGrid::make({450, 550, 650});
  Stokes Ein(grid);
  Ein[0] = CDStokesVector(5, 2, -1, 0);
  Ein[1] = CDStokesVector(6, 0, -2.5, 1);
  Ein[2] = 7.0;
  Mueller brdf(grid);
  brdf[0] = CDMuellerMatrix({1.5, 0.01, 0, 0, 0.01, 1.7, 0, 0, 0, 0, -1.2, 0.4, 0, 0, -0.4, 1.2});
  brdf[1] = CDMuellerMatrix({1.6, 0.02, 0, 0, 0.02, 1.75, 0, 0, 0, 0, -1.15, 0.35, 0, 0, -0.35, 1.15});
  brdf[2] = CDMuellerMatrix({1.7, 0.03, 0, 0, 0.03, 1.8, 0, 0, 0, 0, -1.1, 0.3, 0, 0, -0.3, 1.1});
  auto Lout = brdf * Ein;
  EXPECT_TRUE(Ein[0].isPolarized());
  EXPECT_FALSE(Ein[2].isPolarized());
  EXPECT_TRUE(Lout[2].isPolarized());
  const double printed[3][4] = {{7.52, 3.45, 1.20, 0.40}, {9.600, 0.120, 3.225, 2.025}, {11.90, 0.21, 0, 0}};
  // the operands have few digits, so the products are those of the print up to rounding of sums near 10
  const double rounding = 4e-15;
  for (int band = 0; band < 3; ++band)
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(Lout[band].getStokes(i), printed[band][i], rounding) << band << " " << i;
  EXPECT_GT(std::abs(Lout[0].getStokes(0) - 5.02), rounding);  // as printed in eq 6.11: both are wrong
  EXPECT_GT(std::abs(Lout[0].getStokes(2) - 1.10), rounding);
  EXPECT_DOUBLE_EQ(Lout[2].getDOP(), 0.21 / 11.9);
}
