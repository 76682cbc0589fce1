// The copper bar under a polarised sky, and the checks of that sky (nw/thesis/Section77.nw, XSky.nw).

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "Items.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Scene.hpp"
#include "malus/thesis/Pictures.hpp"

using namespace malus;

namespace {}

TEST(Section77Identity, TheSceneFileHasTheSunAndTheBandsOfTheThesis) {
  const Scene scene = chunkyScene("chunky-bar-sky", 16);
  ASSERT_EQ(scene.world.grid->size(), 2u);
  EXPECT_EQ((*scene.world.grid)[0].nm(), 450);
  EXPECT_EQ((*scene.world.grid)[1].nm(), 650);
  EXPECT_NEAR(scene.world.sun->to_sun.getZenith() / degree, 20.67, 1e-9);
  EXPECT_NEAR(std::atan2(scene.world.sun->to_sun.x, scene.world.sun->to_sun.y) / degree, 175.66,
              1e-9);
  EXPECT_FALSE(scene.move_sun);
}

// The first reflection of polarised light by copper makes S3; that of unpolarised light does not.
TEST(Section77Identity, APolarisedSkyMakesCircularLightAtTheFirstReflection) {
  const auto largestS3 = [](const Scene& scene) {
    double most = 0;
    const StokesImage image = renderImage(scene);
    for (const std::size_t pixel : insideOf(image, "4.top"))
      most = std::max(most, std::abs(image.stokes[3][pixel]));
    return most;
  };
  EXPECT_GT(largestS3(chunkyScene("chunky-bar-sky", 32, R"({"radiometry": {"rays": [31]}})")),
            0);
  EXPECT_EQ(largestS3(chunkyScene("chunky-bar-sky", 32,  // negative control
                                  R"({"radiometry": {"rays": [31]},
                                      "sky": {"model": "uniform", "radiance_W_m2_sr_nm": 0.05, "albedo": null}})")),
            0);
}

// Symmetry: turned about the vertical, a scene of four equal chunks is the same scene. With the sun in the
// meridian and equal chunks, S0 of a picture's left half is that of its right half; S2 and S3 change their sign.
TEST(Section77Invariant, TheMeridianIsAMirror) {
  const char* const equal = R"({"sun": {"azimuth_deg": 180},
      "materials": {"copper-010": {"sigma": 0.2}, "copper-015": {"sigma": 0.2}, "copper-030": {"sigma": 0.2}},
      "radiometry": {"rays": [2001], "sampling": "importance"}})";
  const StokesImage image = renderImage(chunkyScene("chunky-bar-sky", 32, equal));
  const auto top = [&](const char* name, int k) {
    return meanOver(image.stokes[k], insideOf(image, name));
  };
  const double S0 = top("4.top", 0);
  for (const auto& [left, right] : {std::pair{"4.top", "5.top"}, std::pair{"3.top", "2.top"}})
    for (int k = 0; k < 4; ++k) {
      const double mirrored = (k >= 2 ? -1 : 1) * top(right, k);
      EXPECT_NEAR(top(left, k), mirrored, 5e-3 * S0)
          << left << " S" << k;  // noise of 2000 rays
    }
  // negative control: the sun off the meridian; two chunks are not mirror images any more
  const StokesImage askew = renderImage(
      chunkyScene("chunky-bar-sky", 32,
                  std::string(equal).replace(std::string(equal).find("180"), 3, "160")));
  EXPECT_GT(std::abs(meanOver(askew.stokes[0], insideOf(askew, "4.top")) -
                     meanOver(askew.stokes[0], insideOf(askew, "5.top"))),
            5e-3 * S0);
}

TEST(Section77Published, TheSkyMeetsWhatIsPrinted) {
  EXPECT_TRUE(named(ran("X.sky"), Verdict::differs).empty());
}

TEST(Section77Published, NegativeControlAChangedDigitOfAPrintedSkyIsSeen) {
  const Corrupted table("rayleigh.csv", "0.20888340", "0.20888342");
  EXPECT_EQ(named(ran("X.sky", table.data), Verdict::differs), std::set<std::string>{"natraj"});
}

TEST(Section77Invariant, CopperSeesThatTheSkyIsPolarisedAndMattChunksDoNot) {
  const Item item = ran("X.realsky");
  EXPECT_EQ(named(item, Verdict::reproduced), (std::set<std::string>{"copper", "matt"}));
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{});
}
