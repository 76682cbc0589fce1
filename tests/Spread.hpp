// What pictures of many seeds say of the errors that they claim (ErrorBars_test, Accuracy_test).
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "Program.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

namespace malus::testing {
using nlohmann::json;
constexpr std::size_t seeds = 200;

/// Copper chunks that reflect each other: a few pixels of the bar.
inline json copper(int width = 8, int height = 6) {
  const std::string scenes =
      std::filesystem::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";
  std::ifstream file(scenes + "chunky-bar-copper.json");
  json scene = json::parse(file, nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  scene["sensor"] = {
      {"kind", "framing"}, {"width", width}, {"height", height}, {"field_of_view_deg", 36.87}};
  scene["radiometry"] = {{"rays", {9, 2}}, {"seed", 5}};
  return scene;
}

inline Scene sceneOf(const json& text) { return readSceneText(text.dump(), "scene", "."); }

/// What pictures of many seeds say of one number: its values, and the variance that each claims.
struct Series {
  std::vector<double> values, variances;
};
using AllSeries = std::vector<Series>;  // [pixel][component]

inline void append(AllSeries& all, std::span<const double> stokes,
                   std::span<const double> errors) {
  all.resize(stokes.size());
  for (std::size_t i = 0; i < stokes.size(); ++i) {
    const double error = errors[i / 4 * StokesErrors::numbers + i % 4];
    all[i].values.push_back(stokes[i]), all[i].variances.push_back(error * error);
  }
}

/// How far the claimed variance is from the observed one, in standard errors of the difference, which are taken from
/// the same 200 pictures: the fourth moments of the pixel are in them.
inline double deviation(const Series& series) {
  const auto n = double(series.values.size());
  double mean = 0, sum = 0, squares = 0;
  for (const double v : series.values) mean += v / n;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    const double off = series.values[i] - mean,
                 difference = series.variances[i] - n / (n - 1) * off * off;
    sum += difference, squares += difference * difference;
  }
  return sum / n / std::sqrt((squares / n - sum / n * (sum / n)) / n);
}

/// For each component the probability of such deviations by chance, and of how many pixels.
struct Judgement {
  double probability = 1;
  std::size_t pixels = 0;
};
inline std::array<Judgement, 4> judge(const AllSeries& all) {
  std::array<Judgement, 4> judged;
  for (std::size_t c = 0; c < 4; ++c) {
    double chi_squared = 0;
    for (std::size_t i = c; i < all.size(); i += 4) {
      // What no seed changes by more than the rounding of sums as large as S0 (the tails of lobes reach down to 1e-200)
      // has no error, and must claim none.
      const auto& values = all[i].values;
      const double negligible = 1e-12 * std::abs(all[i - c].values[0]);
      if (std::ranges::all_of(
              values, [&](double v) { return std::abs(v - values[0]) <= negligible; })) {
        EXPECT_LE(*std::ranges::max_element(all[i].variances), negligible * negligible) << i;
        continue;
      }
      const double z = deviation(all[i]);
      chi_squared += z * z, ++judged[c].pixels;
    }
    if (judged[c].pixels > 0)
      judged[c].probability = boost::math::cdf(boost::math::complement(
          boost::math::chi_squared(double(judged[c].pixels)), chi_squared));
  }
  return judged;
}

// One in a million for each of about a dozen components. The sum of 200 skewed squares has wider wings than a normal
// distribution, which makes of this level about one in a hundred thousand: still no false alarm in a lifetime of runs.
constexpr double by_chance = 1e-6;

inline double ratioOf(const AllSeries& all,
                      std::size_t c) {  // claimed over observed, of the sums
  double claimed = 0, observed = 0;
  for (std::size_t i = c; i < all.size(); i += 4) {
    const auto n = double(all[i].values.size());
    double mean = 0;
    for (const double v : all[i].values) mean += v / n;
    for (std::size_t k = 0; k < all[i].values.size(); ++k)
      claimed += all[i].variances[k] / n,
          observed += (all[i].values[k] - mean) * (all[i].values[k] - mean) / (n - 1);
  }
  return claimed / observed;
}

/// A directory with a scene, in which the program runs.
struct Workplace {
  Scratch scratch;
  explicit Workplace(const json& scene) { put(scratch / "s.json", scene.dump(1)); }
  Outcome malus(const std::string& arguments) const { return malusIn(scratch.path, arguments); }
  std::string file(const std::string& name) const { return contents(scratch / name); }
};
}  // namespace malus::testing
