// Filters before pixels, the way back, noise (nw/render/Polarimeter.nw).
#include "malus/render/Polarimeter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "malus/base/Error.hpp"
#include "malus/render/ErrorBars.hpp"
#include "malus/render/Tile.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
constexpr double never = std::numeric_limits<double>::infinity();  // is a well full
constexpr double rounding =
    1e-13;  // a few operations on numbers near 1, condition number below 10
constexpr std::size_t width = 5, height = 4, bands = 2;

const std::vector<CDMuellerMatrix> four{linearPolarizer(0), linearPolarizer(pi / 4),
                                        linearPolarizer(pi / 2), circularPolarizer(+1)};
const std::array<CDMuellerMatrix, 4> polarsens{linearPolarizer(0), linearPolarizer(pi / 4),
                                               linearPolarizer(3 * pi / 4),
                                               linearPolarizer(pi / 2)};

std::vector<double> varied() {
  std::vector<double> s;
  for (std::size_t i = 0; i < width * height * bands; ++i) {
    const double t = double(i);
    s.insert(s.end(),
             {2 + std::sin(t), std::cos(t), 0.5 * std::sin(2 * t), 0.25 * std::cos(3 * t)});
  }
  return s;
}
std::vector<double> even(const std::array<double, 4>& stokes) {
  std::vector<double> s;
  for (std::size_t i = 0; i < width * height * bands; ++i)
    s.insert(s.end(), stokes.begin(), stokes.end());
  return s;
}
double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}
using Measured = std::array<bool, 4>;
std::vector<double> readAll(const Polarimeter& p, const std::vector<double>& stokes) {
  return p.read(stokes, p.whole());
}
std::vector<double> recoverAll(const Polarimeter& p, const std::vector<double>& readings) {
  return p.recover(readings, p.whole());
}
}  // namespace

TEST(PolarimeterIdentity, TheReadingsWorkedByHand) {
  const Polarimeter p(
      camerasBehind({linearPolarizer(pi / 4), linearPolarizer(0), linearPolarizer(pi / 2)}), 1,
      1, 1, 1, 1);
  const std::vector<double> light{2, 1, 0.5, 0};
  EXPECT_LT(farthest(readAll(p, light), {1.25, 1.5, 0.5}), rounding);
  EXPECT_GT(farthest(readAll(p, light), {0.75, 1.5, 0.5}),
            0.1);  // the polariser along -45 degrees
}

// Malus's own law: what a polariser passes of light that is polarised at an angle to it is cos^2.
TEST(PolarimeterPublished, MalussLaw) {
  for (int degrees = 0; degrees <= 180; degrees += 15) {
    const double angle = degrees * pi / 180;
    const Polarimeter p(camerasBehind({linearPolarizer(angle)}), 1, 1, 1, 1, 1);
    const std::vector<double> horizontal{1, 1, 0, 0};
    EXPECT_NEAR(readAll(p, horizontal)[0], std::cos(angle) * std::cos(angle), rounding);
  }
}

TEST(PolarimeterIdentity, FourCamerasGiveBackTheImage) {
  const Polarimeter p(camerasBehind(four), width, height, bands, 1, 1);
  EXPECT_EQ(p.measured(), (Measured{true, true, true, true}));
  EXPECT_LT(farthest(recoverAll(p, readAll(p, varied())), varied()), rounding);
  std::vector<double> spoilt = readAll(p, varied());  // the negative control
  spoilt[7] += 1e-6;
  EXPECT_GT(farthest(recoverAll(p, spoilt), varied()), 1e-7);
}

TEST(PolarimeterIdentity, SixCamerasAreLeastSquares) {
  std::vector<CDMuellerMatrix> six = four;
  six.push_back(linearPolarizer(3 * pi / 4));
  six.push_back(circularPolarizer(-1));
  const Polarimeter p(camerasBehind(six), 1, 1, 1, 1, 1);
  // Each pair of opposite filters sums to S0, so with readings d the normal equations give by hand
  // S0 = sum d / 3, S1 = d0 - d2, S2 = d1 - d4, S3 = d3 - d5.
  const std::vector<double> d{1.0, 0.7, 0.3, 0.9, 0.5, 0.2};
  EXPECT_LT(farthest(recoverAll(p, d), {3.6 / 3, 0.7, 0.2, 0.7}), rounding);
}

TEST(PolarimeterIdentity, AMosaicGivesBackAnEvenImageButNotS3) {
  const Polarimeter p(mosaicOf(polarsens), width, height, bands, 2, 2);
  EXPECT_EQ(p.measured(), (Measured{true, true, true, false}));
  EXPECT_EQ(readAll(p, varied()).size(),
            width * height * bands);  // one reading a pixel and band
  const std::vector<double> back = recoverAll(p, readAll(p, even({2, 0.5, -0.3, 0.7})));
  EXPECT_LT(farthest(back, even({2, 0.5, -0.3, 0})), rounding);
}

TEST(PolarimeterIdentity, AMosaicSeesFalsePolarisationAtAnEdge) {
  const Polarimeter p(mosaicOf(polarsens), 4, 2, 1, 2, 2);
  std::vector<double> edge(4 * 2 * 4, 0);
  for (std::size_t i = 0; i < 8; ++i)
    edge[4 * i] = i % 4 < 2 ? 1 : 3;  // unpolarised, brighter on the right
  const std::vector<double> back = recoverAll(p, readAll(p, edge));
  EXPECT_NEAR(back[1], 0, rounding);
  // pixel (1, 0): the window's left column reads 45 and 90 degrees of 1, its right 0 and 135 of 3
  EXPECT_NEAR(back[4 + 1], 1.0, rounding);
  EXPECT_NEAR(back[4 + 2], -1.0, rounding);
}

TEST(PolarimeterIdentity, ACalibrationIsAMatrixForEachPixel) {
  FilterPattern pattern{width, height, 1, 1, {}};
  for (std::size_t i = 0; i < width * height; ++i)
    pattern.filters.push_back(linearPolarizer(0.1 * double(i)));
  const Polarimeter p(pattern, width, height, bands, 2, 2);
  const double last = 0.1 * double(width * height - 1);
  const std::vector<double> read = readAll(p, even({2, 0.5, -0.3, 0.7}));
  EXPECT_NEAR(read.back(), 1 + 0.25 * std::cos(2 * last) - 0.15 * std::sin(2 * last), rounding);
  // rounding times the condition number, which p contains
  EXPECT_LT(farthest(recoverAll(p, read), even({2, 0.5, -0.3, 0})), 1e-14 * p.condition());
  EXPECT_GT(p.condition(), 10);  // or the limit above would be that of any polarimeter
}

// The best four analysers look at the corners of a tetrahedron (Sabatke et al. 2000): condition number sqrt(3).
TEST(PolarimeterPublished, ATetrahedronOfAnalysersHasTheConditionRootThree) {
  const auto analyser = [](double a, double b, double c) {
    const std::array<double, 16> row{0.5, 0.5 * a, 0.5 * b, 0.5 * c};
    return CDMuellerMatrix(row);
  };
  const double r = 1 / std::sqrt(3.0);
  const Polarimeter p(camerasBehind({analyser(r, r, r), analyser(r, -r, -r),
                                     analyser(-r, r, -r), analyser(-r, -r, r)}),
                      1, 1, 1, 1, 1);
  EXPECT_NEAR(p.condition(), std::sqrt(3.0), rounding);
  const Polarimeter other(camerasBehind(four), 1, 1, 1, 1, 1);
  EXPECT_GT(other.condition(), 1.8);
}

TEST(PolarimeterInvariant, PartsAreTheVeryNumbersOfTheWhole) {
  const std::vector<double> light = varied();
  const auto cut = [&](const Tile& t) {
    std::vector<double> some;
    for (std::size_t y = t.y0; y < t.y1; ++y)
      some.insert(some.end(), light.begin() + std::ptrdiff_t((y * width + t.x0) * bands * 4),
                  light.begin() + std::ptrdiff_t((y * width + t.x1) * bands * 4));
    return some;
  };
  const Instrument instrument{
      Polarimeter(mosaicOf(polarsens), width, height, bands, 2, 2), {"I"}, {40, 2, 70, 9}};
  const Measurement whole = measure(instrument, light, {0, 0, width, height}, 3);
  std::size_t full = 0, bits = 0;
  for (const Tile& t : {Tile{0, 0, 3, 3}, Tile{3, 0, 5, 3}, Tile{0, 3, 5, 4}}) {
    const Measurement part = measure(instrument, cut(instrument.polarimeter.around(t)), t, 3);
    full += part.clipped.full_wells;
    std::size_t i = 0;
    for (std::size_t y = t.y0; y < t.y1; ++y)
      for (std::size_t x = t.x0; x < t.x1; ++x, ++i)
        for (std::size_t b = 0; b < bands; ++b) {
          const std::size_t at = (y * width + x) * bands + b;
          ASSERT_EQ(part.readings[i * bands + b], whole.readings[at]);
          for (std::size_t c = 0; c < 4; ++c, ++bits)
            ASSERT_EQ(part.stokes[(i * bands + b) * 4 + c], whole.stokes[at * 4 + c]);
        }
  }
  EXPECT_EQ(bits, light.size());
  EXPECT_EQ(full, whole.clipped.full_wells);
  EXPECT_GT(full, 0u);
  EXPECT_NE(measure(instrument, light, {0, 0, width, height}, 4).readings, whole.readings);
}

TEST(PolarimeterIdentity, EveryBandMayHaveItsOwnFilter) {
  FilterPattern pattern = camerasBehind({linearPolarizer(0), linearPolarizer(pi / 2)});
  pattern.channels = 1, pattern.bands = 2;
  const Polarimeter p(pattern, 1, 1, 2, 1, 1);
  EXPECT_LT(farthest(readAll(p, std::vector<double>{1, 1, 0, 0, 1, 1, 0, 0}), {1, 0}),
            rounding);
}

TEST(PolarimeterIdentity, WhatDoesNotFitIsRefused) {
  FilterPattern pattern = camerasBehind(four);
  EXPECT_THROW(Polarimeter(pattern, 0, 0, 1, 1, 1), MathError);
  EXPECT_THROW(Polarimeter(pattern, 4, 4, 1, 5, 1), MathError);
  pattern.bands = 3;
  EXPECT_THROW(Polarimeter(pattern, 4, 4, 1, 1, 1), MathError);
  EXPECT_THROW(Polarimeter(camerasBehind({}), 4, 4, 1, 1, 1), MathError);
  EXPECT_THROW(Polarimeter(camerasBehind({CDMuellerMatrix(std::nan(""))}), 4, 4, 1, 1, 1),
               MathError);
  const Polarimeter p(camerasBehind(four), 4, 4, 1, 1, 1);
  EXPECT_THROW(readAll(p, std::vector<double>(7)), MathError);
  EXPECT_THROW(recoverAll(p, std::vector<double>(7)), MathError);
}

TEST(PolarimeterInvariant, NoiseHasItsMeanAndVariance) {
  constexpr std::size_t n = 20000;
  struct Case {
    double reading, gain, sigma;
  };
  for (const Case& c : {Case{0.5, 6, 0}, Case{0.5, 400, 5}, Case{0.5, 1e8, 0}}) {
    std::vector<double> readings(n, c.reading);
    addNoise(readings, {c.gain, c.sigma, never, 3});
    double sum = 0, squares = 0;
    for (const double r : readings) sum += r, squares += (r - c.reading) * (r - c.reading);
    const double mean = c.reading * c.gain,
                 variance = (mean + c.sigma * c.sigma) / (c.gain * c.gain);
    // five standard errors: 1 in 3e5 for each of six comparisons; the kurtosis of Poisson adds 1/mean
    EXPECT_NEAR(sum / n, c.reading, 5 * std::sqrt(variance / n));
    EXPECT_NEAR(squares / n, variance, 5 * variance * std::sqrt((2 + 1 / mean) / n));
    EXPECT_GT(std::abs(squares / n - 1.2 * variance),
              5 * variance * std::sqrt((2 + 1 / mean) / n));
  }
}

namespace {
constexpr std::size_t each = bands * StokesErrors::numbers;

/// Eight batches of an image whose components vary together, pixel by pixel.
std::vector<std::vector<double>> batchesOfAnImage() {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> made(8, varied());
  for (auto& batch : made)
    for (std::size_t i = 0; i < batch.size(); i += 4) {
      const double common = normal(engine);
      for (std::size_t c = 0; c < 4; ++c)
        batch[i + c] += 0.1 * common + 0.02 * double(c) * normal(engine);
    }
  return made;
}

/// Means of [vector] and their errors, [pixel] StokesErrors of all bands.
std::pair<std::vector<double>, std::vector<double>> meansOf(
    const std::vector<std::vector<double>>& all) {
  BatchMeans means(all[0].size() / 4);
  for (const auto& batch : all) means.add(batch);
  std::vector<double> errors(all[0].size() / 4 * StokesErrors::numbers);
  for (std::size_t v = 0; v < all[0].size() / 4; ++v)
    means.errors(v).put(std::span(errors).subspan(v / bands * each, each), v % bands);
  return {{means.mean().begin(), means.mean().end()}, errors};
}
const std::vector<std::string> names4{"a", "b", "c", "d"};
}  // namespace

// Without noise the errors behind cameras are those of the batches, each recovered by itself.
TEST(PolarimeterIdentity, ErrorsBehindCamerasAreThoseOfRecoveredBatches) {
  std::vector<CDMuellerMatrix> six = four;
  six.push_back(linearPolarizer(3 * pi / 4)), six.push_back(circularPolarizer(-1));
  for (const auto& filters : {four, six}) {
    const Polarimeter p(camerasBehind(filters), width, height, bands, 1, 1);
    const auto all = batchesOfAnImage();
    std::vector<std::vector<double>> recovered;
    for (const auto& batch : all) recovered.push_back(recoverAll(p, readAll(p, batch)));
    const auto [light, errors] = meansOf(all);
    const Measurement made = measure({p, names4, {}, true}, light, p.whole(), 0, errors);
    EXPECT_LT(farthest(made.errors, meansOf(recovered).second), 1e-12);
    EXPECT_GT(farthest(made.errors, std::vector<double>(made.errors.size())), 0.05);
    EXPECT_TRUE(measure({p, names4, {}, true}, light, p.whole()).errors.empty());
    EXPECT_TRUE(measure({p, names4, {}, false}, light, p.whole(), 0, errors).errors.empty());
  }
}

// The chapter's example: four linear polarisers, 10,000 electrons, exact light; two rows of each sign by hand.
TEST(PolarimeterIdentity, NoiseOfRecoveredLightByHand) {
  const Polarimeter p(mosaicOf(polarsens), 2, 2, 1, 2, 2);
  std::vector<double> light, none(4 * StokesErrors::numbers);
  for (int i = 0; i < 4; ++i) light.insert(light.end(), {1, 0, 0, 0});
  const Instrument noisy{p, {"a"}, {10'000, 0, never, 1}, true};
  const Measurement shot = measure(noisy, light, p.whole(), 0, none);
  const auto errors = StokesErrors::of(std::span(shot.errors).first(10), 0);
  EXPECT_NEAR(errors.standard[0], std::sqrt(0.5e-4), 1e-15);
  EXPECT_NEAR(errors.standard[1], std::sqrt(1e-4), 1e-15);
  EXPECT_NEAR(errors.standard[2], std::sqrt(1e-4), 1e-15);
  EXPECT_LT(errors.standard[3], 1e-15) << "not measured";
  const Instrument read{
      p, {"a"}, {10'000, 100, never, 1}, true};  // twice the variance, and more
  const Measurement both = measure(read, light, p.whole(), 0, none);
  const auto more = StokesErrors::of(std::span(both.errors).first(10), 0);
  EXPECT_NEAR(more.standard[0], std::sqrt(0.5e-4 + 1e-4), 1e-15);
  // a full well has no error, and neither has what is recovered with it
  light[4 * 3] = 1.5;
  const Instrument full{p, {"a"}, {10'000, 0, 6500, 1}, true};
  const Measurement made = measure(full, light, p.whole(), 0, none);
  EXPECT_EQ(made.clipped.full_wells, 1u);
  EXPECT_TRUE(std::isnan(made.errors[0]));
}

TEST(PolarimeterInvariant, ErrorsOfPartsAreTheVeryNumbersOfTheWhole) {
  const Polarimeter p(mosaicOf(polarsens), width, height, bands, 2, 2);
  const auto [light, errors] = meansOf(batchesOfAnImage());
  const Instrument noisy{p, {"a"}, {500, 3, never, 2}, true};
  const Measurement whole = measure(noisy, light, p.whole(), 0, errors);
  for (const Tile& part : {Tile{0, 0, 3, 2}, Tile{3, 0, 5, 4}, Tile{1, 2, 3, 4}}) {
    const Tile from = p.around(part);
    std::vector<double> lit, sure;
    for (std::size_t y = from.y0; y < from.y1; ++y) {
      const std::size_t first = y * width + from.x0, count = from.x1 - from.x0;
      const auto add = [&](auto& to, const auto& all, std::size_t numbers) {
        to.insert(to.end(), all.begin() + std::ptrdiff_t(first * numbers),
                  all.begin() + std::ptrdiff_t((first + count) * numbers));
      };
      add(lit, light, 4 * bands), add(sure, errors, each);
    }
    const Measurement made = measure(noisy, lit, part, 0, sure);
    std::size_t at = 0;
    for (std::size_t y = part.y0; y < part.y1; ++y)
      for (std::size_t x = part.x0; x < part.x1; ++x)
        for (std::size_t i = 0; i < each; ++i)
          ASSERT_EQ(made.errors[at++], whole.errors[(y * width + x) * each + i]);
  }
  EXPECT_THROW(measure(noisy, light, p.whole(), 0, std::vector<double>(7)), MathError);
}

TEST(PolarimeterInvariant, NoiseDependsOnSeedAndFrameAlone) {
  const auto noisy = [](std::uint64_t seed, std::uint64_t frame) {
    std::vector<double> readings(100, 1.0);
    addNoise(readings, {50, 2, never, seed}, frame);
    return readings;
  };
  EXPECT_EQ(noisy(1, 0), noisy(1, 0));
  EXPECT_NE(noisy(1, 0), noisy(2, 0));
  EXPECT_NE(noisy(1, 0), noisy(1, 1));
}

TEST(PolarimeterIdentity, NoiseThatCannotBeIsRefused) {
  std::vector<double> readings{1.0, -1e-9};
  addNoise(readings, {});
  EXPECT_EQ(readings[0], 1.0);  // none requested, none added
  EXPECT_THROW(addNoise(readings, {0, 1, never, 1}), MathError);
  EXPECT_THROW(addNoise(readings, {-1, 0, never, 1}), MathError);
  addNoise(readings, {100, 0, never, 1});
  EXPECT_NEAR(readings[1], -1e-9, 1e-24);  // no photons: as it was
  EXPECT_THROW(addNoise(readings, {0, 0, 5, 1}), MathError);
  EXPECT_THROW(addNoise(readings, {10, 0, 0, 1}), MathError);
  readings[0] = std::nan("");
  EXPECT_THROW(addNoise(readings, {100, 0, never, 1}), MathError);
}

TEST(PolarimeterIdentity, AFullWellHoldsNoMore) {
  std::vector<double> readings{1, 100, 3};
  EXPECT_EQ(addNoise(readings, {10, 0, 200, 1}).full_wells, 1u);
  EXPECT_EQ(readings[1], 20.0);
  EXPECT_LT(readings[2], 20.0);
}

// Poisson's probabilities summed by hand: a well of as many electrons as come on average is full in 53 % of all readings. One
// that were full only when more came would be in 44 %.
TEST(PolarimeterInvariant, AWellIsFullFromItsLastElectronOn) {
  constexpr double mean = 20;
  constexpr std::size_t n = 20000;
  double below = 0, term = std::exp(-mean);
  for (int k = 0; k < 20; term *= mean / ++k) below += term;
  std::vector<double> readings(n, 1.0);
  const auto full = double(addNoise(readings, {mean, 0, mean, 5}).full_wells);
  const double error = std::sqrt(below * (1 - below) / n);
  EXPECT_NEAR(full / n, 1 - below, 5 * error);
  EXPECT_GT(term, 10 * error) << "negative control: the well's last electron is seen";
  for (const double r : readings) EXPECT_LE(r, 1.0);
}

// By hand in the chapter: twelve bits, ten electrons a count, an offset of 64, 1e5 electrons for a unit.
TEST(PolarimeterIdentity, CountsAreThoseOfTheChapter) {
  DetectorNoise noise{1e5, 0, never, 1};
  noise.converter = Converter{12, 10, 64};
  std::vector<double> readings{0.5, 0.5, -1};
  const Clipped clipped = addNoise(readings, noise);
  EXPECT_NEAR(readings[0], 0.4031, 1e-12);
  EXPECT_EQ(clipped.saturated, 2u);
  EXPECT_NEAR(readings[2], -64e-4, 1e-12);  // -1e5 electrons: below count 0
  EXPECT_EQ(clipped.below_zero, 1u);
  EXPECT_EQ(clipped.full_wells, 0u);
  std::vector<double> fine(1000, 0.2);
  EXPECT_FALSE(addNoise(fine, noise).any());
  for (const double r : fine)
    EXPECT_NEAR(r / 1e-4, std::round(r / 1e-4), 1e-8) << "a whole count";
  noise.converter->bits = 0;
  EXPECT_THROW(addNoise(fine, noise), MathError);
  noise = {0, 0, never, 1};
  noise.dark_electrons = 5;
  EXPECT_THROW(addNoise(fine, noise), MathError);
}

// Equation (covariance): light and dark electrons, read noise and the twelfth of a step. The noise of 20 electrons exceeds half
// a step of 30 only just, and the harmonic of the rounding's error is below exp(-2 (pi 20 / 30)^2) = 2e-4 of a step.
TEST(PolarimeterInvariant, CountsHaveTheirMeanAndVariance) {
  constexpr std::size_t n = 40000;
  DetectorNoise noise{1e4, 10, never, 7};
  noise.dark_electrons = 140, noise.converter = Converter{16, 30, 100};
  std::vector<double> readings(n, 0.016);  // 160 electrons
  EXPECT_FALSE(addNoise(readings, noise).any());
  double sum = 0, squares = 0;
  for (const double r : readings) sum += r, squares += (r - 0.016) * (r - 0.016);
  const double variance = (160 + 140 + 100 + 900.0 / 12) / 1e8;
  EXPECT_NEAR(sum / n, 0.016, 5 * std::sqrt(variance / n));
  EXPECT_NEAR(squares / n, variance, 5 * variance * std::sqrt(2.1 / n));
  EXPECT_GT(std::abs(squares / n - (variance - 75e-8)), 5 * variance * std::sqrt(2.1 / n))
      << "the negative control: without the rounding";
  EXPECT_GT(std::abs(squares / n - (variance - 140e-8)), 5 * variance * std::sqrt(2.1 / n))
      << "the negative control: without the dark electrons";
}

TEST(PolarimeterIdentity, ABadPixelIsFlaggedInEachWindowThatHasIt) {
  const Polarimeter p(mosaicOf(polarsens), width, height, bands, 2, 2);
  Instrument instrument{p, {"I"}, {500, 3, never, 2}, true};
  const Measurement good = measure(instrument, varied(), p.whole());
  instrument.bad_pixels = {1 * width + 2};
  const Measurement made = measure(instrument, varied(), p.whole());
  EXPECT_EQ(made.flagged, bands);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = y * width + x;
      const bool window = x >= 1 && x <= 2 && y <= 1;
      for (std::size_t b = 0; b < bands; ++b) {
        EXPECT_EQ(std::isnan(made.readings[at * bands + b]), x == 2 && y == 1);
        EXPECT_EQ(std::isnan(made.stokes[4 * (at * bands + b)]), window) << x << ' ' << y;
        if (!window) {
          EXPECT_EQ(made.stokes[4 * (at * bands + b)], good.stokes[4 * (at * bands + b)]);
        }
      }
    }
}
