#include "Scenes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "malus/thesis/XSampling.hpp"

using namespace malus;

void printScenes() {
  constexpr int side = 64;
  fmt::print(
      "\nImages of the sun: {0} x {0} pixels of 33, 3 and 2 rays, CPU seconds of the fastest "
      "of 16\n"
      "{1:18} {2:^26} {3:^26} {4:^23}\n"
      "{5:18} {6:>8} {7:>7} {8:>9} {6:>8} {7:>7} {8:>9} {9:>7} {10:>7} {11:>7} {12:>7}\n",
      side, "", "without images", "with images", "ratio of error^2 x s", "scene", "error", "s",
      "product", "picture", "pixels", "median", "means");
  for (const char* name :
       {"chunky-bar-copper", "chunky-bar-sky", "varnish", "copper-bowl", "canyon"}) {
    const Scene scene = sceneWithMirrors(name, side);
    const ImagesTrial without = tryImages(scene, false), with = tryImages(scene, true);
    fmt::print("{:18}", name);
    for (const ImagesTrial& trial : {without, with})
      fmt::print(" {:8.4f} {:7.3f} {:9.2e}", trial.picture, trial.seconds,
                 trial.picture * trial.picture * trial.seconds);
    const auto ratio = [&](double ImagesTrial::*error) {
      return std::pow(with.*error / without.*error, 2) * with.seconds / without.seconds;
    };
    fmt::print(" {:7.2f} {:7.2f} {:7.2f} {:7.1f}\n", ratio(&ImagesTrial::picture),
               ratio(&ImagesTrial::pixels), ratio(&ImagesTrial::median),
               standardErrorsApart(without, with));
  }
  fmt::print(
      "error: standard deviation of S0, rms over the surfaces, over their mean (picture) or "
      "each pixel's own (pixels; "
      "median)\nratio: time to the same error, with over without; means: standard errors "
      "between the pictures' means\n");
}
