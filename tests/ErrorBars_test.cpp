// Standard errors of pixels (nw/render/ErrorBars.nw), and the cube, the pictures and the products that are made of them.
#include "malus/render/ErrorBars.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "Spread.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using namespace malus::testing;
using nlohmann::json;

namespace {
constexpr std::size_t batches = 8;

/// A ball of gloss paint over matt ground, under the clear sky and a sun that is a disk; pixels are sampled at random.
json ball(const std::filesystem::path& directory) {
  std::string obj;
  constexpr int rows = 12, columns = 24;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double zenith = std::numbers::pi * i / rows,
                   azimuth = 2 * std::numbers::pi * j / columns;
      obj += fmt::format("v {} {} {}\n", std::sin(zenith) * std::cos(azimuth),
                         std::sin(zenith) * std::sin(azimuth), 1.5 + std::cos(zenith));
    }
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j + 1, b = i * columns + (j + 1) % columns + 1;
      if (i + 1 < rows) obj += fmt::format("f {} {} {}\n", a, a + columns, b + columns);
      if (i > 0) obj += fmt::format("f {} {} {}\n", a, b + columns, b);
    }
  put(directory / "ball.obj", obj);
  return {{"malus", 1},
          {"bands", {{"wavelength_nm", {450}}}},
          {"geometry",
           {{{"obj", (directory / "ball.obj").string()}, {"material", "gloss"}},
            {{"ground", {{"material", "matt"}}}}}},
          {"materials",
           {{"gloss", {{"model", "torrance-sparrow"}, {"n", 1.5}, {"k", 0}, {"sigma", 0.1}}},
            {"matt", {{"model", "lambertian"}, {"reflectance", 0.3}}}}},
          {"sun", {{"zenith_deg", 40}, {"azimuth_deg", 120}}},
          {"sky", {{"model", "rayleigh"}}},
          {"sensor",
           {{"kind", "framing"},
            {"width", 6},
            {"height", 5},
            {"field_of_view_deg", 20},
            {"samples_per_pixel", 4},
            {"jitter", true}}},
          {"platform", {{"position_m", {0, 0, 15}}, {"look_at_m", {0, 0, 0}}}},
          {"radiometry", {{"rays", {5, 2}}}}};
}

/// Nothing but the place in the pixel is random: two paints, a sun that is a point, no rays but those to it.
json edge(const std::filesystem::path& directory) {
  json scene = ball(directory);
  scene["sun"]["half_angle_deg"] = 0;
  scene["sky"] = {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0}};
  scene["radiometry"] = {{"rays", {1}}};
  scene["sensor"]["samples_per_pixel"] = 1;
  return scene;
}

/// Nothing but the point of the sun's disk is random: the shadow of a ball that is high above the ground.
json penumbra(const std::filesystem::path& directory) {
  json scene = edge(directory);
  scene["sun"] = {{"zenith_deg", 40}, {"azimuth_deg", 120}, {"half_angle_deg", 9}};
  scene["sensor"]["jitter"] = false;
  return scene;
}

RenderOptions with(int threads, std::size_t count = 1) {
  RenderOptions options;
  options.threads = threads, options.batches = count;
  return options;
}

AllSeries renderSeeds(Scene scene) {
  AllSeries all;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    scene.radiometry.seed = seed;
    const RenderedImage image = renderScene(scene, 0, with(2, batches));
    append(all, image.stokes, image.errors);
  }
  return all;
}

/// The same with batches of one's own: batch b has the seed of batch alike(b).
template <class Alike>
AllSeries renderAlike(Scene scene, Alike alike) {
  AllSeries all;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    std::vector<double> errors;
    std::optional<BatchMeans> means;
    for (std::size_t b = 0; b < batches; ++b) {
      scene.radiometry.seed = batchSeed(seed, alike(b));
      const RenderedImage image = renderScene(scene, 0, with(2));
      if (!means)
        means.emplace(image.stokes.size() / 4),
            errors.resize(image.stokes.size() / 4 * StokesErrors::numbers);
      means->add(image.stokes);
    }
    for (std::size_t v = 0; v < means->mean().size() / 4; ++v)
      means->errors(v).put(
          std::span(errors).subspan(v * StokesErrors::numbers, StokesErrors::numbers), 0);
    append(all, means->mean(), errors);
  }
  return all;
}

}  // namespace

TEST(ErrorBarsIdentity, TheRecursionIsTheSumOfTheSquares) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  for (const double offset : {0.0, 1e6}) {
    std::vector<std::array<double, 4>> drawn(batches);
    BatchMeans means(1);
    for (auto& s : drawn) {
      for (double& v : s) v = offset + normal(engine);
      s[1] += s[0], s[3] = 7;  // correlated; does not vary
      means.add(s);
    }
    std::array<double, 4> mean{};
    for (const auto& s : drawn)
      for (std::size_t i = 0; i < 4; ++i) mean[i] += s[i] / double(batches);
    const auto moment = [&](std::size_t i, std::size_t j) {
      double sum = 0;
      for (const auto& s : drawn) sum += (s[i] - mean[i]) * (s[j] - mean[j]);
      return sum / double(batches * (batches - 1));
    };
    const double rounding = 1e-15 * std::max(1.0, offset) * 100;  // of some tens of operations
    const StokesErrors errors = means.errors(0);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(means.mean()[i], mean[i], rounding);
      EXPECT_NEAR(errors.standard[i], std::sqrt(moment(i, i)), rounding);
    }
    EXPECT_EQ(errors.standard[3], 0);
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [i, j] = StokesErrors::pairs[k];
      const double both = std::sqrt(moment(i, i) * moment(j, j));
      EXPECT_NEAR(errors.correlation[k], j == 3 ? 0 : moment(i, j) / both, rounding) << k;
    }
  }
  BatchMeans by_hand(1);  // the two batches of the chapter
  by_hand.add(std::array{1.0, 0.0, 0.0, 0.0}), by_hand.add(std::array{1.2, 0.0, 0.0, 0.0});
  EXPECT_NEAR(by_hand.mean()[0], 1.1, 1e-15);
  EXPECT_NEAR(by_hand.errors(0).standard[0], 0.1, 1e-15);
}

TEST(ErrorBarsInvariant, SeedsOfBatchesAreNobodyElses) {
  std::set<std::uint64_t> drawn;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    EXPECT_EQ(batchSeed(seed, 0), seed);
    for (std::uint64_t batch = 0; batch < 50; ++batch) drawn.insert(batchSeed(seed, batch));
  }
  EXPECT_EQ(drawn.size(), 2500u);
}

TEST(ErrorBarsInvariant, OneBatchIsThePictureOfBefore) {
  Scene scene = sceneOf(copper());
  const RenderedImage one = renderScene(scene, 0, with(1)),
                      two = renderScene(scene, 0, with(1, 2));
  EXPECT_TRUE(one.errors.empty());
  scene.radiometry.seed = batchSeed(scene.radiometry.seed, 1);
  const RenderedImage other = renderScene(scene, 0, with(1));
  for (std::size_t i = 0; i < one.stokes.size(); ++i) {
    const double mean = (one.stokes[i] + other.stokes[i]) / 2,
                 rounding = 4e-16 * (std::abs(one.stokes[i]) + std::abs(other.stokes[i]));
    ASSERT_NEAR(two.stokes[i], mean, rounding);
    ASSERT_NEAR(two.errors[i / 4 * StokesErrors::numbers + i % 4],
                std::abs(one.stokes[i] - other.stokes[i]) / 2, rounding);
  }
  EXPECT_EQ(two.rays, one.rays + other.rays);
}

TEST(ErrorBarsInvariant, WhatAPictureClaimsIsItsSpreadOverTwoHundredSeeds) {
  const Scratch scratch;
  const std::vector<std::pair<std::string, AllSeries>> all{
      {"copper", renderSeeds(sceneOf(copper()))},
      {"ball", renderSeeds(sceneOf(ball(scratch.path)))},
      {"edge", renderSeeds(sceneOf(edge(scratch.path)))},
      {"penumbra", renderSeeds(sceneOf(penumbra(scratch.path)))}};
  for (const auto& [name, series] : all) {
    const auto judged = judge(series);
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_GT(judged[c].probability, by_chance) << name << " S" << c;
      if (judged[c].pixels > 0)
        fmt::print("{} S{}: {} pixels, p = {:.3g}, claimed over observed {:.3f}\n", name, c,
                   judged[c].pixels, judged[c].probability, ratioOf(series, c));
    }
    EXPECT_GE(judged[0].pixels, 3u) << name << ": too few pixels vary to tell anything";
  }
}

TEST(ErrorBarsInvariant, NegativeControlBatchesThatShareTheirPointsClaimTooLittle) {
  const Scene scene = sceneOf(copper());
  for (const std::size_t alike : {2u, 8u}) {
    const auto judged = judge(renderAlike(scene, [=](std::size_t b) { return b / alike; }));
    EXPECT_LT(judged[0].probability, by_chance) << alike;
  }
}

namespace {
/// Copper behind filters before detectors whose noise is of the size of the light's own error.
json filtered(bool mosaic) {
  json scene = copper();
  const auto polarizer = [](double deg) { return json{{"polarizer_deg", deg}}; };
  json& filters = scene["sensor"]["polarimeter"];
  if (mosaic)
    filters = {{"mosaic", {{polarizer(90), polarizer(45)}, {polarizer(135), polarizer(0)}}},
               {"recover", {"S0", "S1", "S2"}}};
  else
    filters = {{"cameras",
                {{{"name", "a"}, {"polarizer_deg", 0}},
                 {{"name", "b"}, {"polarizer_deg", 60}},
                 {{"name", "c"}, {"polarizer_deg", 120}},
                 {{"name", "d"},
                  {"retarder_deg", 45},
                  {"retardance_deg", 90},
                  {"polarizer_deg", 0}}}}};
  filters["noise"] = {{"electrons_per_unit", 3000}, {"read_noise_electrons", 6}};
  return scene;
}

/// What is left out of the errors.
enum class Without { nothing, noise, light, neighbours };

/// Light recovered from pictures of two hundred seeds; of a mosaic, pixels whose windows share none.
AllSeries recoverSeeds(bool mosaic, Without without) {
  Scene scene = sceneOf(filtered(mosaic));
  const std::size_t step = mosaic ? 2 : 1, numbers = StokesErrors::numbers;
  AllSeries all;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    scene.radiometry.seed = scene.instrument->noise.seed = seed;
    RenderedImage image = renderScene(scene, 0, with(2, batches));
    if (without == Without::light) std::ranges::fill(image.errors, 0);
    const Tile whole = scene.instrument->polarimeter.whole();
    Measurement made = measure(*scene.instrument, image.stokes, whole, 0, image.errors);
    if (without == Without::noise) {
      Instrument silent = *scene.instrument;
      silent.noise = {};
      made.errors = measure(silent, image.stokes, whole, 0, image.errors).errors;
    }
    if (without == Without::neighbours) made.errors = image.errors;
    for (std::size_t i = 3; without == Without::neighbours && i < made.errors.size();
         i += numbers)
      made.errors[i] = 0;  // S3 is not measured
    std::vector<double> stokes, errors;
    for (std::size_t y = 0; y < image.height; y += step)
      for (std::size_t x = 0; x < image.width; x += step) {
        const auto p = std::ptrdiff_t(y * image.width + x), n = std::ptrdiff_t(numbers);
        stokes.insert(stokes.end(), &made.stokes[4 * std::size_t(p)],
                      &made.stokes[4 * std::size_t(p)] + 4);
        errors.insert(errors.end(), made.errors.begin() + p * n,
                      made.errors.begin() + (p + 1) * n);
      }
    append(all, stokes, errors);
  }
  return all;
}
}  // namespace

// The light and its noise have other seeds in each picture, and their spread is what each picture claims.
TEST(ErrorBarsInvariant, LightBehindFiltersClaimsItsSpreadOverTwoHundredSeeds) {
  for (const bool mosaic : {false, true}) {
    const AllSeries all = recoverSeeds(mosaic, Without::nothing);
    const auto judged = judge(all);
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_GT(judged[c].probability, by_chance) << mosaic << " S" << c;
      EXPECT_EQ(judged[c].pixels, mosaic ? (c < 3 ? 12u : 0u) : 48u) << mosaic << " S" << c;
      if (judged[c].pixels > 0)
        fmt::print("{} S{}: p = {:.3g}, claimed over observed {:.3f}\n",
                   mosaic ? "mosaic" : "cameras", c, judged[c].probability, ratioOf(all, c));
    }
  }
}

TEST(ErrorBarsInvariant, NegativeControlsBehindFiltersClaimTheWrongSpread) {
  for (const bool mosaic : {false, true})
    for (const Without without : {Without::noise, Without::light, Without::neighbours}) {
      if (without == Without::neighbours && !mosaic) continue;
      const auto judged = judge(recoverSeeds(mosaic, without));
      double least = 1;
      for (const Judgement& one : judged) least = std::min(least, one.probability);
      EXPECT_LT(least, by_chance) << mosaic << ' ' << int(without);
    }
}

// Cube, picture and products of readings behind filters, with the same bits however they are made.
TEST(ErrorBarsIdentity, FilesBehindFiltersHaveTheirErrors) {
  json text = filtered(true);
  text["sensor"]["width"] = 40, text["sensor"]["height"] = 33;
  text["bands"]["wavelength_nm"] = {500, 600};
  const Workplace place(text);
  const std::string render = "render s.json --batches 3 --write cube,truth,error,pictures ";
  ASSERT_EQ(place.malus(render + "--threads 1 --out a").code, 0);
  ASSERT_EQ(place.malus(render + "--threads 3 --out b").code, 0);
  for (const char* part : {"1/2", "2/2"})
    ASSERT_EQ(place.malus(render + "--out c --part " + part).code, 0);
  ASSERT_EQ(place.malus("merge c").code, 0);
  for (const char* part : {"0,0,21,33", "21,0,40,33"})
    ASSERT_EQ(place.malus(render + "--out d --part " + part).code, 0);
  ASSERT_EQ(place.malus("merge d").code, 0);
  for (const char* name : {"s.recovered.img", "s.recovered.error.img",
                           "s.recovered.error.img.hdr", "s.recovered.error.png"})
    for (const char* other : {"b/", "c/", "d/"}) {
      EXPECT_FALSE(place.file(std::string("a/") + name).empty()) << name;
      EXPECT_EQ(place.file(std::string("a/") + name), place.file(std::string(other) + name))
          << other << name;
    }
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "a/s.recovered.rays.png"));
  const Cube light = readCube(place.scratch / "a/s.img"),
             errors = readCube(place.scratch / "a/s.error.img"),
             back = readCube(place.scratch / "a/s.recovered.img"),
             sure = readCube(place.scratch / "a/s.recovered.error.img");
  EXPECT_EQ(sure.header.channels,
            (std::vector<std::string>{"S0 500", "S1 500", "S2 500", "S0 600", "S1 600",
                                      "S2 600", "S0S1 500", "S0S2 500", "S1S2 500", "S0S1 600",
                                      "S0S2 600", "S1S2 600"}));
  const Scene scene = sceneOf(text);
  const std::vector<double> lit(light.data.begin(), light.data.end()),
      known(errors.data.begin(), errors.data.end());
  const Measurement made =
      measure(*scene.instrument, lit, scene.instrument->polarimeter.whole(), 0, known);
  const std::array<std::size_t, 3> components{0, 1, 2};
  ASSERT_EQ(place.malus("products a/s.recovered.img").code, 0);
  const Cube products = readCube(place.scratch / "a/s.recovered.products.img"),
             unsure = readCube(place.scratch / "a/s.recovered.products.error.img");
  EXPECT_EQ(unsure.header.channels, products.header.channels);
  ASSERT_EQ(place.malus("products a/s.recovered.img --debias").code, 0);
  const Cube debiased = readCube(place.scratch / "a/s.recovered.products.img");
  std::size_t smaller = 0;
  for (std::size_t p = 0; p < 40 * 33; ++p)
    for (std::size_t band = 0; band < 2; ++band) {
      const auto wanted = StokesErrors::of(std::span(made.errors).subspan(p * 20, 20), band);
      const auto found =
          StokesErrors::of(std::span(sure.data).subspan(p * 12, 12), band, components);
      for (const std::size_t c : components)
        ASSERT_EQ(float(found.standard[c]), float(wanted.standard[c]));
      for (const std::size_t k : {0u, 1u, 3u})
        ASSERT_EQ(float(found.correlation[k]), float(wanted.correlation[k]));
      const float* s = &back.data[p * 6 + band * 3];
      const CDStokesVector stokes(s[0], s[1], s[2], 0);
      const auto expected = productErrors(stokes, found);
      ASSERT_EQ(unsure.data[p * 4 + band * 2], float(expected[1]));
      ASSERT_EQ(unsure.data[p * 4 + band * 2 + 1], float(expected[3]));
      ASSERT_EQ(debiased.data[p * 4 + band * 2], float(debiasedDoLP(stokes, found)));
      smaller += debiased.data[p * 4 + band * 2] < products.data[p * 4 + band * 2];
    }
  EXPECT_GT(smaller, 1000u);
  EXPECT_FALSE(place.file("a/s.recovered.550.error.png").empty() &&
               place.file("a/s.recovered.600.error.png").empty());
  ASSERT_EQ(place.malus("render s.json --out one").code, 0);
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "one/s.recovered.error.img"));
}

// Random samplings measure their error, and the thesis's grids are refused.
TEST(ErrorBarsInvariant, RandomDirectionsTellTheirErrorAndGridsAreRefused) {
  json text = copper(4, 3);
  text["radiometry"]["sampling"] = "random";
  const auto judged = judge(renderSeeds(sceneOf(text)));
  for (std::size_t c = 0; c < 4; ++c) EXPECT_GT(judged[c].probability, by_chance) << c;
  for (const std::string sampling : {"grid", "grid-rotated", "adaptive"}) {
    text["radiometry"] = {{"sampling", sampling}, {"rays", {91, 1}}};
    const Scene scene = sceneOf(text);
    EXPECT_THROW(Renderer(scene, 0, 2), MathError) << sampling;
    EXPECT_NO_THROW(Renderer(scene, 0, 1));
  }
}

namespace {
/// Normal Stokes numbers about a mean: S1 follows S0, S2 follows S1.
struct Noise {
  std::array<double, 4> mean, standard;
  double r01, r12;
  std::mt19937_64 engine{7};
  std::normal_distribution<double> normal{};

  StokesErrors errors() const { return {standard, {r01, r01 * r12, 0, r12, 0, 0}}; }
  CDStokesVector draw() {
    const double a = normal(engine), b = r01 * a + std::sqrt(1 - r01 * r01) * normal(engine),
                 c = r12 * b + std::sqrt(1 - r12 * r12) * normal(engine), d = normal(engine);
    return {mean[0] + standard[0] * a, mean[1] + standard[1] * b, mean[2] + standard[2] * c,
            mean[3] + standard[3] * d};
  }
};

double spreadOf(const std::vector<double>& values) {
  double mean = 0, sum = 0;
  for (const double v : values) mean += v / double(values.size());
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / double(values.size() - 1));
}

/// Largest relative difference of the propagated errors of DoP, DoLP, DoCP and AoLP from the spread of draws.
double worstOf(Noise noise, const StokesErrors& claimed) {
  constexpr std::size_t draws = 200'000;
  std::array<std::vector<double>, 4> made;
  for (std::size_t i = 0; i < draws; ++i) {
    const CDStokesVector s = noise.draw();
    made[0].push_back(s.getDOP()), made[1].push_back(s.getDOLP());
    made[2].push_back(s.getDOCP());
    made[3].push_back(s.getAoLP() * 180 / std::numbers::pi);
  }
  const auto& m = noise.mean;
  const auto errors = productErrors(CDStokesVector(m[0], m[1], m[2], m[3]), claimed);
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i)
    worst = std::max(worst, std::abs(errors[i] / spreadOf(made[i]) - 1));
  return worst;
}
}  // namespace

// A hundredth for the second order, which for errors of a twentieth is some four hundredths squared; and another for
// 200 000 draws, whose spread is good to 0.0016, five times over.
TEST(ErrorBarsIdentity, ErrorsOfProductsAreTheSpreadOfProducts) {
  for (const auto& [r01, r12] : {std::pair{0.0, 0.0}, {0.9, 0.0}, {-0.8, 0.5}, {0.95, 0.95}}) {
    const Noise noise{{1, 0.4, 0.3, 0.2}, {0.02, 0.02, 0.01, 0.008}, r01, r12};
    EXPECT_LT(worstOf(noise, noise.errors()), 0.02) << r01 << ' ' << r12;
    StokesErrors without = noise.errors();  // the negative control
    without.correlation = {};
    EXPECT_EQ(worstOf(noise, without) > 0.05, r01 != 0) << r01 << ' ' << r12;
  }
  // by hand in the chapter
  const StokesErrors errors{{0, 0.005, 0.005, 0}, {}};
  const auto by_hand = productErrors(CDStokesVector(1, 0.03, 0.04, 0), errors);
  EXPECT_NEAR(by_hand[1], 0.005, 1e-15);
  EXPECT_NEAR(by_hand[3], 0.05 * 180 / std::numbers::pi, 1e-12);
  EXPECT_TRUE(std::isnan(by_hand[2])) << "light without S3 has no gradient of its DoCP";
  EXPECT_NEAR(debiasedDoLP(CDStokesVector(1, 0.03, 0.04, 0), errors), 0.05 - 0.00025, 1e-15);
}

// A length of noise is too long by b^2 / 2p; what is left must be a fifth of that at most, from three times the larger error on. The mean of
// a million draws is good to a seventh of the smallest such fifth.
TEST(ErrorBarsIdentity, TheBiasOfADegreeOfPolarisationIsTakenOff) {
  for (const double ratio : {3.0, 5.0})
    for (const auto& [s1, s2, r12, angle_deg] : {std::array{0.01, 0.01, 0.0, 20.0},
                                                 {0.01, 0.006, 0.0, 0.0},
                                                 {0.006, 0.01, 0.0, 60.0},
                                                 {0.01, 0.01, 0.6, 75.0}}) {
      const double p = ratio * 0.01, twice = 2 * angle_deg * std::numbers::pi / 180;
      Noise noise{{1, p * std::cos(twice), p * std::sin(twice), 0}, {0, s1, s2, 0}, 0, r12};
      constexpr std::size_t draws = 1'000'000;
      double length = 0, debiased = 0;
      for (std::size_t i = 0; i < draws; ++i) {
        const CDStokesVector s = noise.draw();
        length += (s.getDOLP() - p) / draws;
        debiased += (debiasedDoLP(s, noise.errors()) - p) / draws;
      }
      const auto& m = noise.mean;
      const double across = p * 2 * std::numbers::pi / 180 *
                            productErrors(CDStokesVector(1, m[1], m[2], 0), noise.errors())[3];
      const double expected = across * across / (2 * p);
      EXPECT_GT(length, 0.75 * expected) << "negative control: nothing taken off";
      EXPECT_LT(std::abs(debiased), length / 5)
          << ratio << ' ' << s1 << ' ' << s2 << ' ' << r12;
    }
}

TEST(ErrorBarsInvariant, TheCubeOfErrorsIsTheSameBitsHoweverItIsMade) {
  const Workplace place(copper(40, 33));
  const auto same = [&](const std::string& other) {
    for (const char* name : {"s.img", "s.truth.img", "s.error.img", "s.img.hdr",
                             "s.error.img.hdr", "s.error.png", "s.rays.png"}) {
      EXPECT_FALSE(place.file(std::string("a/") + name).empty()) << name;
      EXPECT_EQ(place.file(std::string("a/") + name), place.file(other + "/" + name))
          << other << ' ' << name;
    }
  };
  ASSERT_EQ(place.malus("render s.json --batches 3 --threads 1 --out a").code, 0);
  ASSERT_EQ(place.malus("render s.json --batches 3 --threads 3 --out b").code, 0);
  same("b");
  for (const char* part : {"1/2", "2/2"})
    ASSERT_EQ(
        place.malus(fmt::format("render s.json --batches 3 --part {} --out c", part)).code, 0);
  ASSERT_EQ(place.malus("merge c").code, 0);
  same("c");
  for (const char* part : {"0,0,21,33", "21,0,40,33"})
    ASSERT_EQ(
        place.malus(fmt::format("render s.json --batches 3 --part {} --out d", part)).code, 0);
  ASSERT_EQ(place.malus("merge d").code, 0);
  same("d");
  EXPECT_EQ(json::parse(place.file("a/s.run.json"))["batches"], 3);
  EXPECT_EQ(json::parse(place.file("d/s.run.json"))["batches"], 3);
  ASSERT_EQ(place.malus("render s.json --batches 3 --seed 6 --out e").code, 0);
  EXPECT_NE(place.file("a/s.error.img"), place.file("e/s.error.img")) << "negative control";
}

TEST(ErrorBarsInvariant, AKilledRenderIsResumedToTheSameErrors) {
  const Workplace place(copper(80, 66));
  ASSERT_EQ(place.malus("render s.json --batches 20 --out a").code, 0);
  const Outcome killed =
      runIn(place.scratch.path, "sh -c '\"" MALUS_PROGRAM
                                "\" render s.json --batches 20 --threads 1 --out b & p=$!; "
                                "while kill -0 $p && ! [ \"$(cat "
                                "b/s.error.img.tiles 2>/dev/null | wc -l)\" -ge 4 ]; do sleep "
                                "0.005; done; kill -9 $p; wait'");
  ASSERT_FALSE(std::filesystem::exists(place.scratch / "b/s.error.img")) << killed.err;
  const Outcome other = place.malus("render s.json --batches 21 --out b --resume");
  EXPECT_EQ(other.code, 2) << "another number of batches is another picture";
  const Outcome resumed = place.malus("render s.json --batches 20 --out b --resume");
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.error.img"), place.file("b/s.error.img"));
  EXPECT_NE(
      place.malus("render s.json --batches 20 --out b --resume").err.find("exists already"),
      std::string::npos);
}

TEST(ErrorBarsIdentity, TheCubeHoldsWhatTheRendererSays) {
  const Workplace place(copper());
  ASSERT_EQ(place.malus("render s.json --batches 4 --interleave bsq --out a").code, 0);
  const Cube error = readCube(place.scratch / "a/s.error.img"),
             light = readCube(place.scratch / "a/s.img");
  const std::vector<std::string> names{"S0 550",   "S1 550",   "S2 550",   "S3 550",
                                       "S0S1 550", "S0S2 550", "S0S3 550", "S1S2 550",
                                       "S1S3 550", "S2S3 550"};
  EXPECT_EQ(error.header.channels, names);
  EXPECT_EQ(error.header.interleave, Interleave::bsq);
  EXPECT_NE(error.header.description.find("mean of 4 batches"), std::string::npos);
  const RenderedImage image = renderScene(sceneOf(copper()), 0, with(2, 4));
  ASSERT_EQ(error.data.size(), image.errors.size());
  for (std::size_t i = 0; i < image.errors.size(); ++i)
    ASSERT_EQ(error.data[i], float(image.errors[i]));
  for (std::size_t i = 0; i < image.stokes.size(); ++i)
    ASSERT_EQ(light.data[i], float(image.stokes[i]));
  ASSERT_EQ(place.malus("render s.json --out one").code, 0);
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "one/s.error.img"));
  EXPECT_EQ(place.malus("render s.json --batches 4 --write cube --out mean").code, 0);
  EXPECT_EQ(place.file("mean/s.img").size(), place.file("a/s.img").size());
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "mean/s.error.img"));
}

TEST(ErrorBarsIdentity, ProductsHaveTheirErrors) {
  const Workplace place(copper());
  ASSERT_EQ(place.malus("render s.json --batches 4 --out a").code, 0);
  ASSERT_EQ(place.malus("products a/s.img").code, 0);
  const Cube light = readCube(place.scratch / "a/s.img"),
             error = readCube(place.scratch / "a/s.error.img"),
             plain = readCube(place.scratch / "a/s.products.img"),
             made = readCube(place.scratch / "a/s.products.error.img");
  EXPECT_EQ(made.header.channels, plain.header.channels);
  EXPECT_FALSE(place.file("a/s.550.error.png").empty());
  ASSERT_EQ(place.malus("products a/s.img --debias").code, 0);
  const Cube debiased = readCube(place.scratch / "a/s.products.img");
  std::size_t smaller = 0;
  for (std::size_t i = 0; i < light.data.size(); i += 4) {
    const StokesErrors errors =
        StokesErrors::of(std::span(error.data).subspan(i / 4 * 10, 10), 0);
    const CDStokesVector s(light.data[i], light.data[i + 1], light.data[i + 2],
                           light.data[i + 3]);
    const auto expected = productErrors(s, errors);
    const auto same = [](float a, float b) {
      return a == b || (std::isnan(a) && std::isnan(b));
    };
    for (std::size_t c = 0; c < 4; ++c)
      ASSERT_PRED2(same, made.data[i + c], float(expected[c])) << c;
    ASSERT_PRED2(same, debiased.data[i + 3], plain.data[i + 3]) << "the angle has no bias";
    ASSERT_PRED2(same, debiased.data[i + 1], float(debiasedDoLP(s, errors)));
    smaller += debiased.data[i + 1] < plain.data[i + 1];
  }
  EXPECT_GT(smaller, 10u);
}

TEST(ErrorBarsIdentity, WhatCannotBeIsRefusedWithTheRemedy) {
  const Workplace place(copper());
  json grid = copper();
  grid["radiometry"]["sampling"] = "grid-rotated";
  put(place.scratch / "grid.json", grid.dump());
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Outcome outcome = place.malus(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  for (const char* none : {"0", "4097"})
    refused(fmt::format("render s.json --batches {} --out a", none),
            fmt::format("--batches = {}: is not a number of batches; give a number from 1 to "
                        "4096",
                        none));
  refused("render s.json --batches 2.5 --out a", "is not a number of batches");
  refused("render s.json --batches -2 --out a", "--batches");
  refused("render grid.json --batches 8 --out a",
          "sampling is grid-rotated; set radiometry.sampling to importance or random");
  refused("render s.json --write error --out a",
          "--write = error: needs two batches, and there is one; add --batches 8");
  refused("render s.json --write cube,error --batches 1 --out a", "add --batches 8");
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "a"));
  EXPECT_EQ(place.malus("render grid.json --batches 1 --out g").code, 0);
  ASSERT_EQ(place.malus("render s.json --batches 2 --out a").code, 0);
  ASSERT_EQ(place.malus("render s.json --out b").code, 0);
  refused("products b/s.img --debias",
          "needs b/s.error.img, which does not exist; render "
          "with");
  std::filesystem::copy(place.scratch / "a/s.error.img", place.scratch / "b/s.error.img");
  std::filesystem::copy(place.scratch / "a/s.error.img.hdr",
                        place.scratch / "b/s.error.img.hdr");
  refused("products b/s.img", "does not hold the errors of b/s.img; render both in one run");
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "b/s.products.img"));
  // parts with other numbers of batches are parts of other pictures
  ASSERT_EQ(place.malus("render s.json --batches 2 --part 0,0,4,6 --out m").code, 0);
  ASSERT_EQ(place.malus("render s.json --batches 3 --part 4,0,8,6 --out m").code, 0);
  refused("merge m", "batches");
}
