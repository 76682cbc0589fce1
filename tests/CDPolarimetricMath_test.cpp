// Stokes vectors and Mueller matrices (nw/light/CDPolarimetricMath.nw).
#include "light/CDPolarimetricMath.hpp"

#include <gtest/gtest.h>

using namespace malus;

TEST(CDPolarimetricMathIdentity, MixedStatesPromote) {
  const CDStokesVector s(8.7, 6.5, 4.3, 2.1);
  EXPECT_EQ(s + CDStokesVector(5.7), CDStokesVector(8.7 + 5.7, 6.5, 4.3, 2.1));
  EXPECT_EQ(CDMuellerMatrix(2.0) * s, 2.0 * s);
  EXPECT_FALSE((CDMuellerMatrix(2.0) * CDStokesVector(3.0)).isPolarized());
}
