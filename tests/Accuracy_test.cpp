// Rendering to an accuracy (nw/render/Accuracy.nw): batches that are decided by the other half.
#include "malus/render/Accuracy.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "Spread.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/Cube.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr std::size_t first = 16;

/// How many batches the halves of a pixel without neighbours get.
std::array<std::size_t, 2> neededOf(const HalvedMeans& means, const Aim& aim,
                                    std::uint64_t most_rays = 1'000'000) {
  Batches batches(first);
  batches.until = aim, batches.most_rays = most_rays;
  const FirstBatches own = means.first(aim);
  return neededBatches(batches, own, {&own, 1});
}

/// Means of many pixels whose batches all come from draw(), and what they claim.
struct Pixels {
  std::size_t count = 0;
  double sum = 0, squares = 0, claimed = 0, batches = 0;
  double mean() const { return sum / double(count); }
  double variance() const { return squares / double(count) - mean() * mean(); }
  double error() const { return std::sqrt(variance() / double(count)); }
  void add(double value, double standard_error, double used) {
    ++count, sum += value, squares += value * value, claimed += standard_error * standard_error;
    batches += used;
  }
};

/// `crossed`: each half decides for the other, as it should; otherwise for itself.
template <class Draw>
Pixels pixelsOf(Draw draw, const Aim& aim, bool crossed, std::size_t pixels) {
  Pixels made;
  for (std::size_t p = 0; p < pixels; ++p) {
    HalvedMeans means(1, first);
    for (std::size_t b = 0; b < first; ++b) means.add(b, std::array{draw(), 0.0, 0.0, 0.0}, 1);
    auto needed = neededOf(means, aim);
    if (!crossed) std::swap(needed[0], needed[1]);
    for (std::size_t b = first; b < 2 * std::max(needed[0], needed[1]); ++b)
      if (b / 2 < needed[b % 2]) means.add(b, std::array{draw(), 0.0, 0.0, 0.0}, 1);
    made.add(means.mean(0), means.errors(0).standard[0], double(needed[0] + needed[1]));
  }
  return made;
}
}  // namespace

// A path in twenty is ten times as bright as the others.
TEST(AccuracyInvariant, RareBrightBatchesLeaveTheMeanWhereItIs) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform;
  const auto draw = [&] { return uniform(engine) < 0.05 ? 10.0 : 1.0; };
  const double mean = 0.05 * 10 + 0.95;
  const Aim aim{Aim::Of::s0, 0.15};
  const Pixels crossed = pixelsOf(draw, aim, true, 100'000),
               own = pixelsOf(draw, aim, false, 100'000);
  EXPECT_LT(std::abs(crossed.mean() - mean), 4.5 * crossed.error());
  // What is claimed lacks c^2 / 2, and c is a sum over the number k of bright ones among the first eight.
  double decided = 0, both = 0, chance = std::pow(0.95, 8);
  for (int k = 0; k <= 8; chance *= 0.05 / 0.95 * (8 - k) / (k + 1), ++k) {
    HalvedMeans means(1, first);
    for (int b = 0; b < int(first); ++b)
      means.add(std::size_t(b), std::array{b / 2 < k ? 10.0 : 1.0, 0.0, 0.0, 0.0}, 1);
    const double share = 8 / double(neededOf(means, aim)[0]);
    decided += chance * share, both += chance * share * (1 + 9 * k / 8.0);
  }
  const double c = both - decided * mean;
  EXPECT_NEAR((crossed.variance() - crossed.claimed / double(crossed.count)) / (c * c / 2), 1,
              0.1);
  EXPECT_GT(crossed.batches / double(crossed.count), 1.5 * first) << "nothing was decided";
  EXPECT_LT(own.mean(), mean - 10 * own.error()) << "negative control: the trap";
  EXPECT_LT(own.claimed / double(own.count) / own.variance(), 0.9) << "negative control";
}

// Sixteen and more batches of normal numbers: errors, claimed and true, have the root mean square of the aim.
TEST(AccuracyInvariant, NormalBatchesMeetTheAim) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal(3, 0.6);
  for (const double aim : {0.01, 0.02}) {
    const Pixels made =
        pixelsOf([&] { return normal(engine); }, {Aim::Of::s0, aim}, true, 5'000);
    EXPECT_NEAR(std::sqrt(made.claimed / double(made.count)) / (3 * aim), 1, 0.02);
    EXPECT_NEAR(std::sqrt(made.variance()) / (3 * aim), 1, 0.03);
    EXPECT_LT(std::abs(made.mean() - 3), 4.5 * made.error());
    // by hand: 7/5 of sigma^2 / 2 a^2 for each half
    EXPECT_NEAR(made.batches / double(made.count), 1.4 * 0.04 / (aim * aim),
                0.05 * 1.4 * 0.04 / (aim * aim));
  }
}

// The example of the chapter, with an aim that gives no whole number: 1.4 * 0.01 / (2 *
// 0.0101^2) = 68.6.
TEST(AccuracyIdentity, BatchesNeededByHand) {
  // eight batches that scatter by a tenth about 1, in each half
  HalvedMeans means(1, first);
  const double step = 0.1 * std::sqrt(7.0 / 8);
  for (std::size_t b = 0; b < first; ++b)
    means.add(b, std::array{b / 2 % 2 ? 1 + step : 1 - step, 0.0, 0.0, 0.0}, 1);
  EXPECT_EQ(neededOf(means, {Aim::Of::s0, 0.0101}, 1000), (std::array<std::size_t, 2>{69, 69}));
  EXPECT_EQ(neededOf(means, {Aim::Of::s0, 0.2}, 1000), (std::array<std::size_t, 2>{8, 8}));
  // a ray a batch: 50 rays are 25 batches for each half, and 3 must not give fewer than the first
  EXPECT_EQ(neededOf(means, {Aim::Of::s0, 0.01}, 50), (std::array<std::size_t, 2>{25, 25}));
  EXPECT_EQ(neededOf(means, {Aim::Of::s0, 0.01}, 3), (std::array<std::size_t, 2>{8, 8}));
  // no polarisation, no light: nothing to be sure of
  EXPECT_EQ(neededOf(means, {Aim::Of::dolp, 0.01}, 1000), (std::array<std::size_t, 2>{8, 8}));
  EXPECT_THROW(HalvedMeans(1, 6), MathError);
  EXPECT_THROW(HalvedMeans(1, 9), MathError);
}

// Half the spread of one half decides for the other alone, and the band that needs most for all.
TEST(AccuracyIdentity, EachHalfDecidesForTheOther) {
  HalvedMeans means(2, first);
  for (std::size_t b = 0; b < first; ++b) {
    const double sign = b / 2 % 2 ? 1 : -1, spread = b % 2 ? 0.1 : 0.05;
    const double s0 = 1 + sign * spread * std::sqrt(7.0 / 8);
    means.add(b, std::array{1.0, 0.0, 0.0, 0.0, s0, 0.0, 0.0, 0.0}, 1);
  }
  EXPECT_EQ(neededOf(means, {Aim::Of::s0, 0.0101}, 1000), (std::array<std::size_t, 2>{69, 18}));
}

// Nine pixels around one, of which one has seen something: the same half of all of them decides, and the own one if it
// has seen more.
TEST(AccuracyIdentity, NeighboursDecideWithTheSameHalf) {
  Batches batches(first);
  batches.until = Aim{Aim::Of::s0, 0.01};
  std::vector<FirstBatches> around(9, FirstBatches{{0, 0}, {1, 1}});
  around[3].spread = {900, 90};
  EXPECT_EQ(neededBatches(batches, around[0], around), (std::array<std::size_t, 2>{8, 70}));
  EXPECT_EQ(neededBatches(batches, around[3], around), (std::array<std::size_t, 2>{63, 630}));
}

TEST(AccuracyInvariant, TheDegreeOfPolarisationMeetsItsAim) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const Aim aim{Aim::Of::dolp, 0.002};
  double claimed = 0, squares = 0;
  constexpr std::size_t pixels = 2000;
  for (std::size_t p = 0; p < pixels; ++p) {
    HalvedMeans means(1, first);
    std::array<std::size_t, 2> needed{first / 2, first / 2};
    for (std::size_t b = 0; b < 2 * std::max(needed[0], needed[1]); ++b) {
      if (b / 2 >= needed[b % 2]) continue;
      const double s0 = 1 + 0.03 * normal(engine);
      means.add(b, std::array{s0, 0.3 * s0 + 0.05 * normal(engine), 0.4 * s0, 0.0}, 1);
      if (b + 1 == first) needed = neededOf(means, aim);
    }
    const double dolp = std::hypot(means.mean(1), means.mean(2)) / means.mean(0);
    const CDStokesVector s(means.mean(0), means.mean(1), means.mean(2), means.mean(3));
    claimed += std::pow(productErrors(s, means.errors(0))[1], 2);
    squares += (dolp - 0.5) * (dolp - 0.5);
  }
  // the first order is good to a hundredth here
  EXPECT_NEAR(std::sqrt(claimed / pixels) / aim.error, 1, 0.03);
  EXPECT_NEAR(std::sqrt(squares / pixels) / aim.error, 1, 0.05);
}

// The errors of pictures with an aim are their spread over two hundred seeds, and their mean is that of other pictures.
TEST(AccuracyInvariant, PicturesClaimTheirSpreadAndKeepTheirMean) {
  Scene scene = sceneOf(copper());
  RenderOptions options;
  options.batches.least = 8, options.batches.until = Aim{Aim::Of::s0, 0.03};
  AllSeries all;
  std::size_t more = 0;
  for (std::size_t seed = 1; seed <= seeds; ++seed) {
    scene.radiometry.seed = seed;
    const RenderedImage image = renderScene(scene, 0, options);
    append(all, image.stokes, image.errors);
    more += image.rays;
  }
  for (const auto& judged : judge(all)) EXPECT_GT(judged.probability, by_chance);
  scene.radiometry.seed = 1;
  options.batches = 8;
  EXPECT_GT(double(more) / seeds, 1.5 * double(renderScene(scene, 0, options).rays))
      << "nothing was decided";
  options.batches = 2000;
  const RenderedImage truth = renderScene(scene, 0, options);
  double chi_squared = 0, pixels = 0;
  for (std::size_t i = 0; i < all.size(); i += 4) {
    double mean = 0, square = 0;
    for (const double v : all[i].values) mean += v / seeds, square += v * v / seeds;
    const double own = (square - mean * mean) / seeds,
                 other = std::pow(truth.errors[i / 4 * StokesErrors::numbers], 2);
    if (own + other <= 1e-20 * mean * mean) continue;
    chi_squared += (mean - truth.stokes[i]) * (mean - truth.stokes[i]) / (own + other),
        ++pixels;
  }
  EXPECT_GT(
      boost::math::cdf(boost::math::complement(boost::math::chi_squared(pixels), chi_squared)),
      by_chance);
}

TEST(AccuracyInvariant, TheSameBitsHoweverItIsMade) {
  const Workplace place(copper(40, 33));
  const std::string render = "render s.json --until 5% --batches 8 --at-most 3000 ";
  const auto same = [&](const std::string& other) {
    for (const char* name : {"s.img", "s.truth.img", "s.error.img", "s.error.img.hdr"}) {
      EXPECT_FALSE(place.file(std::string("a/") + name).empty()) << name;
      EXPECT_EQ(place.file(std::string("a/") + name), place.file(other + "/" + name)) << other;
    }
    EXPECT_EQ(json::parse(place.file("a/s.run.json"))["errors"],
              json::parse(place.file(other + "/s.run.json"))["errors"]);
  };
  ASSERT_EQ(place.malus(render + "--threads 1 --out a").code, 0);
  ASSERT_EQ(place.malus(render + "--threads 3 --out b").code, 0);
  same("b");
  for (const char* part : {"1/2", "2/2"})
    ASSERT_EQ(place.malus(render + "--out c --part " + part).code, 0);
  ASSERT_EQ(place.malus("merge c").code, 0);
  same("c");
  for (const char* part : {"0,0,21,33", "21,0,40,33"})
    ASSERT_EQ(place.malus(render + "--out d --part " + part).code, 0);
  ASSERT_EQ(place.malus("merge d").code, 0);
  same("d");
  const json info = json::parse(place.file("a/s.run.json"));
  EXPECT_EQ(info["until"], json({{"of", "s0"}, {"error", 0.05}, {"most_rays", 3000}}));
  EXPECT_EQ(info["batches"], 8);
  ASSERT_EQ(place.malus("render s.json --batches 8 --out e").code, 0);
  EXPECT_NE(place.file("a/s.error.img"), place.file("e/s.error.img")) << "negative control";
  EXPECT_TRUE(json::parse(place.file("e/s.run.json"))["until"].is_null());
}

TEST(AccuracyInvariant, AStoppedRenderIsResumedToTheSameBits) {
  const Workplace place(copper(80, 66));
  const std::string render = "render s.json --until 5% --at-most 3000 ";
  ASSERT_EQ(place.malus(render + "--out a").code, 0);
  runIn(place.scratch.path, "sh -c '\"" MALUS_PROGRAM "\" " + render +
                                "--threads 1 --out b & p=$!; while kill -0 $p && ! [ \"$(cat "
                                "b/s.error.img.tiles 2>/dev/null | wc -l)\" -ge 4 ]; do sleep "
                                "0.005; done; kill -9 $p; wait'");
  ASSERT_FALSE(std::filesystem::exists(place.scratch / "b/s.error.img"));
  EXPECT_EQ(place.malus("render s.json --until 4% --at-most 3000 --out b --resume").code, 2)
      << "another aim is another picture";
  EXPECT_EQ(place.malus(render + "--out b --resume").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.error.img"), place.file("b/s.error.img"));
}

// The record's errors are those of the cubes; a pixel without rays left is reported on the screen.
TEST(AccuracyIdentity, TheRecordTellsWhereTheAimWasMissed) {
  const Workplace place(copper());
  const Outcome outcome = place.malus("render s.json --until 0.5% --at-most 2000 --out a");
  ASSERT_EQ(outcome.code, 0);
  const Cube light = readCube(place.scratch / "a/s.img"),
             error = readCube(place.scratch / "a/s.error.img"),
             truth = readCube(place.scratch / "a/s.truth.img");
  const json told = json::parse(place.file("a/s.run.json"))["errors"];
  std::size_t beyond = 0;
  double worst = 0;
  for (std::size_t p = 0; p < 48; ++p) {
    const double relative = error.data[10 * p] / light.data[4 * p];
    beyond += relative > 0.01, worst = std::max(worst, relative);
  }
  EXPECT_GT(beyond, 0u);
  EXPECT_EQ(told["beyond_twice_the_aim"], beyond);
  EXPECT_NEAR(told["worst"].get<double>(), worst, 1e-6 * worst);
  const std::size_t at =
      told["worst_pixel"][1].get<std::size_t>() * 8 + told["worst_pixel"][0].get<std::size_t>();
  EXPECT_NEAR(error.data[10 * at] / light.data[4 * at], worst, 1e-6 * worst);
  EXPECT_NE(
      outcome.err.find(fmt::format("{} of 48 pixels exceed twice the aim of 0.005", beyond)),
      std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("--at-most 20000"), std::string::npos);
  const auto channels = truth.header.channels;
  const auto rays = std::size_t(std::ranges::find(channels, "rays") - channels.begin());
  for (std::size_t p = 0; p < 48; ++p)
    EXPECT_LE(truth.data[p * channels.size() + rays], 2200) << "a tenth for rays that vary";
}

// The example of the chapter: 4 tiles left, 10 seconds, 1 for first batches, 3 needed for the rest.
TEST(AccuracyIdentity, TimeIsDealtByHand) {
  double now = 0;
  TimeLimit limit(14, 6, 1, [&] { return now; });
  limit.leaveOut(1);
  now = 1;
  EXPECT_DOUBLE_EQ(limit.grant(1, {1.5, 1.5})[0], (14 - 1 - 4 * 1) / 2.0 / (5 * 1.5))
      << "nothing is known of the others but this one";
  now = 4;
  for (const double part : limit.grant(1, {1.5, 1.5})) EXPECT_DOUBLE_EQ(part, 7.0 / 12);
  now = 20;
  EXPECT_EQ(limit.grant(1, {1, 1}), (std::array{0.0, 0.0})) << "too late";
  TimeLimit two(14, 5, 2, [&] { return 4.0; });
  EXPECT_EQ(two.grant(1, {1.5, 1.5}), (std::array{1.0, 1.0})) << "28 seconds of two threads";
}

namespace {
/// Seconds that tiles take of one thread whose time is limited, in this order.
double secondsOf(const std::vector<double>& wishes, double limit_s) {
  double now = 0;
  TimeLimit limit(limit_s, wishes.size(), 1, [&] { return now; });
  for (const double wish : wishes) {
    now += 1;
    const auto part = limit.grant(1, {wish / 2, wish / 2});
    now += (part[0] + part[1]) * wish / 2;
  }
  return now;
}
}  // namespace

// A picture whose upper half is ten times as difficult as its lower one.
TEST(AccuracyInvariant, ScatteredTilesUseTheTimeThatThereIs) {
  std::vector<double> wishes(400, 20);
  std::fill_n(wishes.begin() + 200, 200, 2.0);
  const std::vector<double> mixed = scattered(wishes);
  const double all = 400 + 200 * 20 + 200 * 2;
  EXPECT_DOUBLE_EQ(secondsOf(mixed, 2 * all), all) << "enough for every wish";
  for (const double limit : {600.0, 1200.0, 2400.0})
    EXPECT_NEAR(secondsOf(mixed, limit) / limit, 1, 0.02);
  EXPECT_LT(secondsOf(wishes, 2400) / 2400, 0.9)
      << "negative control: row by row, time is left";
  EXPECT_EQ(secondsOf(mixed, 100), 400) << "first batches are not cut";
}

// The pixels of the test above, in tiles of 250 that get half of the batches that they need.
TEST(AccuracyInvariant, TimeThatLacksLeavesTheMeanWhereItIs) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform;
  const Aim aim{Aim::Of::s0, 0.15};
  const auto meanOf = [&](bool crossed) {
    Pixels made;
    double now = 0;
    TimeLimit limit(4'000'000, 400, 1, [&] { return now; });
    for (int tile = 0; tile < 400; ++tile) {
      std::vector<HalvedMeans> means(250, HalvedMeans(1, first));
      const auto add = [&](HalvedMeans& pixel, std::size_t b) {
        pixel.add(b, std::array{uniform(engine) < 0.05 ? 10.0 : 1.0, 0.0, 0.0, 0.0}, 1);
        now += 1;
      };
      std::vector<std::array<std::size_t, 2>> needed;
      for (HalvedMeans& pixel : means) {
        for (std::size_t b = 0; b < first; ++b) add(pixel, b);
        needed.push_back(neededOf(pixel, aim));
        if (!crossed) std::swap(needed.back()[0], needed.back()[1]);
      }
      const auto wanted = needed;
      cutToTime(limit, 250 * first, first, 250, needed);
      for (std::size_t p = 0; p < 250; ++p) {
        EXPECT_LE(needed[p][0], wanted[p][0]);
        EXPECT_GE(needed[p][0], std::min(wanted[p][0], first / 2));
        for (std::size_t b = first; b < 2 * std::max(needed[p][0], needed[p][1]); ++b)
          if (b / 2 < needed[p][b % 2]) add(means[p], b);
        made.add(means[p].mean(0), means[p].errors(0).standard[0], 0);
      }
    }
    EXPECT_NEAR(now / 4e6, 1, 0.03) << "the time was short and is used";
    return (made.mean() - 1.45) / made.error();
  };
  EXPECT_LT(std::abs(meanOf(true)), 4.5);
  EXPECT_GT(std::abs(meanOf(false)), 10) << "negative control";
}

// With no time at all every pixel has its first batches, and with a year nothing is cut.
TEST(AccuracyInvariant, MinutesCutBatchesAndNothingElse) {
  const Workplace place(copper());
  const std::string render = "render s.json --until 2% --batches 8 --write cube,truth,error ";
  for (const auto& [at_most, out] : {std::pair{"1", "first"},
                                     {"1e-9min", "none"},
                                     {"3000", "all"},
                                     {"3000,100000min", "year"}}) {
    const Outcome outcome =
        place.malus(render + fmt::format("--at-most {} --out {}", at_most, out));
    ASSERT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err.find("allowed, because the first 8 batches") != outcome.err.npos,
              std::string(out) == "none")
        << outcome.err;
  }
  EXPECT_EQ(place.file("first/s.img"), place.file("none/s.img"));
  EXPECT_EQ(place.file("first/s.error.img"), place.file("none/s.error.img"));
  EXPECT_EQ(place.file("all/s.img"), place.file("year/s.img"));
  EXPECT_NE(place.file("all/s.img"), place.file("none/s.img")) << "negative control";
  EXPECT_EQ(json::parse(place.file("none/s.run.json"))["until"]["most_minutes"], 1e-9);
  EXPECT_NE(place.file("none/s.img.hdr").find("in 1e-09 minutes"), std::string::npos);
}

TEST(AccuracyIdentity, WhatCannotBeIsRefusedWithTheRemedy) {
  const Workplace place(copper());
  json grid = copper();
  grid["radiometry"] = {{"sampling", "grid-rotated"}, {"rays", {91, 1}}};
  put(place.scratch / "grid.json", grid.dump());
  const std::vector<std::pair<std::string, std::string>> cases{
      {"s.json --until 0", "--until = 0: is not between 0 and 1; give 1% or 0.01"},
      {"s.json --until -1%", "--until = -1%: is not between 0 and 1"},
      {"s.json --until 100%", "is not between 0 and 1"},
      {"s.json --until dolp=1%",
       "--until = dolp=1%: is not an accuracy; give 1% or 0.01 for "
       "S0"},
      {"s.json --until nan", "is not between 0 and 1"},
      {"s.json --until little", "is not an accuracy"},
      {"s.json --until 1% --batches 6", "--batches = 6: is too few, or odd, for --until"},
      {"s.json --until 1% --batches 9", "give an even number from 8 on"},
      {"s.json --until 1% --at-most 0", "--at-most = 0: is not a number of rays"},
      {"s.json --at-most 100", "--at-most = 100: has no effect without --until"},
      {"s.json --until 1% --at-most 0min", "--at-most = 0min: is not a time; give min"},
      {"s.json --until 1% --at-most xmin", "--at-most"},
      {"s.json --until 1% --at-most infmin", "--at-most"},
      {"s.json --until 1% --at-most 1min,2min",
       "gives the same limit twice; give one number of rays"},
      {"s.json --until 1% --at-most 3,4", "gives the same limit twice"},
      {"s.json --until 1% --at-most 10m", "--at-most = 10m: is not a number of rays"},
      {"grid.json --until 1%",
       "--until = 1%: would make the same error in each batch, because the "
       "scene's sampling is grid-rotated; set radiometry.sampling"}};
  for (const auto& [arguments, words] : cases) {
    const Outcome outcome = place.malus("render " + arguments + " --out x");
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "x"));
}
