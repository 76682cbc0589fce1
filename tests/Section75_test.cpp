// The pictures of sections 7.1 and 7.5 to 7.8: scene, cheap items and their controls (nw/thesis/Section75.nw, FlatPlate.nw, CopperRays.nw,
// Section76.nw).
#include "malus/thesis/Section75.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "Items.hpp"
#include "malus/base/Error.hpp"
#include "malus/render/Scene.hpp"
#include "malus/thesis/OldFaults.hpp"
#include "malus/thesis/Pictures.hpp"

using namespace malus;

namespace {
Scene small(const std::string& name, std::vector<int> rays) {
  Scene scene = chunkyScene(name, 32);
  scene.radiometry.rays = std::move(rays);
  return scene;
}

/// scenes/ with one text of a file replaced by another, found by the program while this lives.
struct OtherScenes : Scratch {
  OtherScenes(const std::string& file, const std::string& from, const std::string& to) {
    std::filesystem::copy(scenesDirectory(), path,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::skip_symlinks);
    std::string text = contents(path / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from << " in " << file;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    put(path / file, text);
    ::setenv("MALUS_SCENES", path.c_str(), 1);
  }
  ~OtherScenes() { ::unsetenv("MALUS_SCENES"); }
};
}  // namespace

TEST(Section75Published, RoughnessesAreThoseOfTable75) {
  const Item item = ran("T7.5");
  EXPECT_EQ(named(item, Verdict::reproduced).size(), 8u);
  EXPECT_EQ(item.claims().size(), 8u);
}

TEST(Section75Published, NegativeControlAnotherRoughnessIsSeen) {
  const Corrupted table("T7.5.csv", "5,0.3", "5,0.25");
  EXPECT_EQ(named(ran("T7.5", table.data), Verdict::differs),
            (std::set<std::string>{"sigma.5", "elsewhere.5"}));
}

TEST(Section75Published, NegativeControlARoughnessChangedInASceneFileIsSeen) {
  const std::string was = R"("sigma": 0.3)", is = R"("sigma": 0.4)";
  {
    const OtherScenes scenes("chunky-bar-copper.json", was, is);
    EXPECT_EQ(named(ran("T7.5"), Verdict::differs), (std::set<std::string>{"sigma.5"}));
  }
  const OtherScenes scenes("rochester-day.json", was, is);
  EXPECT_EQ(named(ran("T7.5"), Verdict::differs), (std::set<std::string>{"elsewhere.5"}));
}

TEST(FlatPlatePublished, TheTracedColumnIsMetButForTheDigitsOfFinding3) {
  const Item item = ran("F7.1");
  EXPECT_EQ(named(item, Verdict::differs),
            (std::set<std::string>{"traced2.L0", "traced3.DoP"}));
  EXPECT_EQ(named(item, Verdict::erratum), (std::set<std::string>{"traced3.L3", "sides"}));
}

TEST(FlatPlatePublished, NegativeControlAChangedDigitIsSeen) {
  const Corrupted table("T7.1.csv", "34.07", "34.08");
  EXPECT_EQ(named(ran("F7.1", table.data), Verdict::differs),
            (std::set<std::string>{"traced2.L0", "traced2.L1", "traced3.DoP"}));
}

TEST(Section75Invariant, APictureIsTheSameWheneverItIsMade) {
  const Scene scene = small("chunky-bar-copper", {21, 1});
  const StokesImage one = renderImage(scene), two = renderImage(scene);
  EXPECT_EQ(one.stokes, two.stokes);
  EXPECT_EQ(one.facet, two.facet);
  EXPECT_EQ(one.rays, two.rays);
  Scene other = scene;  // negative control
  other.radiometry.seed = 2;
  EXPECT_NE(renderImage(other).stokes, one.stokes);
}

TEST(Section75Identity, LambertianTopsHaveTheRadianceOfSunAndSky) {
  // rho/pi (E cos 30 + 0.05 pi); the grid of 1000 rays sums the cosine to some 1e-3
  const StokesImage image = renderImage(small("chunky-bar-lambertian", {1001}));
  for (const auto& [top, reflectance] : {std::pair{"5.top", 0.6}, {"2.top", 0.2}}) {
    const double expected = reflectance / std::numbers::pi *
                            (std::cos(std::numbers::pi / 6) + 0.05 * std::numbers::pi);
    EXPECT_NEAR(meanOver(image.stokes[0], insideOf(image, top)), expected, 1e-3 * expected)
        << top;
    EXPECT_GT(std::abs(meanOver(image.stokes[0], insideOf(image, top)) - 1.01 * expected),
              1e-3 * expected);  // negative control
  }
}

// All rays of a matt top see the same sky, so that the pixels of a top differ by their random directions alone.
TEST(OldFaultsIdentity, ReseededPixelsAreAlike) {
  const Scene scene = small("chunky-bar-lambertian", {20});
  const auto spread = [](const StokesImage& image) {
    const Pixels top = insideOf(image, "5.top");
    EXPECT_GT(top.size(), 4u);
    const auto [least, most] =
        std::ranges::minmax(top, {}, [&](std::size_t pixel) { return image.stokes[0][pixel]; });
    return image.stokes[0][most] / image.stokes[0][least] - 1;
  };
  // one sum of 19 terms in the same order: no more than the hit points' rounding is left
  EXPECT_LT(spread(renderReseeded(scene, Sampling::random, {20})), 1e-12);
  EXPECT_GT(spread(renderWith(scene, Sampling::random, {20})), 1e-3);  // negative control
}

TEST(OldFaultsIdentity, OnlyThePixelsNumberIsTaken) {
  const Scene scene = small("chunky-bar-lambertian", {20});
  const StokesImage reseeded = renderReseeded(scene, Sampling::random, {20}),
                    seeded = renderWith(scene, Sampling::random, {20});
  EXPECT_EQ(reseeded.stokes[0][0], seeded.stokes[0][0]);  // pixel 0 is pixel 0
  EXPECT_EQ(reseeded.facet, seeded.facet);
  EXPECT_NE(reseeded.stokes[0], seeded.stokes[0]);
}

TEST(Section75Identity, OneReflectionMakesNoCircularLight) {
  const StokesImage image = renderImage(small("chunky-bar-copper", {21}));
  for (const double S3 : image.stokes[3]) ASSERT_EQ(S3, 0);
  const StokesImage twice = renderImage(small("chunky-bar-copper", {21, 1}));
  EXPECT_NE(twice.stokes[3], image.stokes[3]);  // negative control
}
