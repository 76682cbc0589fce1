// The sun's glint on the sea (nw/thesis/XGlint.nw) and the aerosol over it (nw/thesis/RuralAerosol.nw).

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "Items.hpp"
#include "Scratch.hpp"
#include "malus/air/ParticleFiles.hpp"
#include "malus/thesis/RuralAerosol.hpp"

using namespace malus;

TEST(XGlintInvariant, AsCommitted) {
  const Item item = ran("X.glint");
  auto verdicts = verdictsOf(item);
  for (const char* name :
       {"brewster", "closed", "thin", "width-bare", "width-clear", "wind", "height"})
    EXPECT_EQ(verdicts[name], Verdict::reproduced) << name;
  for (const char* name : {"dilution", "width-plane", "width-space", "width-corrected"})
    EXPECT_EQ(verdicts[name], Verdict::differs) << name;
  // what the chapter says of the order of the errors
  auto values = valuesOf(item);
  EXPECT_LT(std::stod(values["clear"]), std::stod(values["corrected"]));
  EXPECT_LT(std::stod(values["corrected"]), std::stod(values["space"]));
}

// A sky reads the aerosol as it was written; the other wavelength is another aerosol.
TEST(XGlintIdentity, TheRuralAerosolOfAFileIsTheComputedOne) {
  const Scratch scratch;
  put(scratch / "rural.csv", ruralGreek({450, 650}));
  const ParticleFile file(scratch / "rural.csv");
  const MiePowder blue = ruralAerosol(450), red = ruralAerosol(650);
  const Aerosol read = file.at(450);
  EXPECT_NEAR(read.albedo, blue.scattering_nm2 / blue.extinction_nm2, 1e-12);
  ASSERT_EQ(read.scatterer.terms().size(), blue.scatterer.terms().size());
  double off = 0, other = 0;
  for (std::size_t l = 0; l < 10; ++l) {
    const auto apart = [&](const MiePowder& powder) {
      return std::abs(read.scatterer.terms()[l].alpha1 - powder.scatterer.terms()[l].alpha1);
    };
    off = std::max(off, apart(blue)), other = std::max(other, apart(red));
  }
  EXPECT_LT(off, 1e-12);
  EXPECT_GT(other, 0.01) << "negative control";
}

// The small mode alone scatters less forward.
TEST(XGlintInvariant, LargeParticlesScatterForward) {
  const MiePowder both = ruralAerosol(550), small = ruralAerosol(550, RuralModes::small);
  EXPECT_LT(small.scatterer.terms()[1].alpha1, both.scatterer.terms()[1].alpha1);
  EXPECT_LT(small.extinction_nm2, both.extinction_nm2);
}
