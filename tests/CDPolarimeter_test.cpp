// Filters before pixels, the way back, noise (nw/imaging/CDPolarimeter.nw).
#include "imaging/CDPolarimeter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "light/CDError.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
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
}  // namespace

TEST(CDPolarimeterIdentity, TheReadingsWorkedByHand) {
  const CDPolarimeter p(
      camerasBehind({linearPolarizer(pi / 4), linearPolarizer(0), linearPolarizer(pi / 2)}), 1,
      1, 1, 1, 1);
  const std::vector<double> light{2, 1, 0.5, 0};
  EXPECT_LT(farthest(p.read(light), {1.25, 1.5, 0.5}), rounding);
  EXPECT_GT(farthest(p.read(light), {0.75, 1.5, 0.5}), 0.1);  // the polariser along -45 degrees
}

// Malus's own law: what a polariser passes of light that is polarised at an angle to it is cos^2.
TEST(CDPolarimeterPublished, MalussLaw) {
  for (int degrees = 0; degrees <= 180; degrees += 15) {
    const double angle = degrees * pi / 180;
    const CDPolarimeter p(camerasBehind({linearPolarizer(angle)}), 1, 1, 1, 1, 1);
    const std::vector<double> horizontal{1, 1, 0, 0};
    EXPECT_NEAR(p.read(horizontal)[0], std::cos(angle) * std::cos(angle), rounding);
  }
}

TEST(CDPolarimeterIdentity, FourCamerasGiveBackTheImage) {
  const CDPolarimeter p(camerasBehind(four), width, height, bands, 1, 1);
  EXPECT_EQ(p.measured(), (Measured{true, true, true, true}));
  EXPECT_LT(farthest(p.recover(p.read(varied())), varied()), rounding);
  std::vector<double> spoilt = p.read(varied());  // the negative control
  spoilt[7] += 1e-6;
  EXPECT_GT(farthest(p.recover(spoilt), varied()), 1e-7);
}

TEST(CDPolarimeterIdentity, SixCamerasAreLeastSquares) {
  std::vector<CDMuellerMatrix> six = four;
  six.push_back(linearPolarizer(3 * pi / 4));
  six.push_back(circularPolarizer(-1));
  const CDPolarimeter p(camerasBehind(six), 1, 1, 1, 1, 1);
  // Each pair of opposite filters sums to S0, so with readings d the normal equations give by hand
  // S0 = sum d / 3, S1 = d0 - d2, S2 = d1 - d4, S3 = d3 - d5.
  const std::vector<double> d{1.0, 0.7, 0.3, 0.9, 0.5, 0.2};
  EXPECT_LT(farthest(p.recover(d), {3.6 / 3, 0.7, 0.2, 0.7}), rounding);
}

TEST(CDPolarimeterIdentity, AMosaicGivesBackAnEvenImageButNotS3) {
  const CDPolarimeter p(mosaicOf(polarsens), width, height, bands, 2, 2);
  EXPECT_EQ(p.measured(), (Measured{true, true, true, false}));
  EXPECT_EQ(p.read(varied()).size(), width * height * bands);  // one reading a pixel and band
  const std::vector<double> back = p.recover(p.read(even({2, 0.5, -0.3, 0.7})));
  EXPECT_LT(farthest(back, even({2, 0.5, -0.3, 0})), rounding);
}

TEST(CDPolarimeterIdentity, AMosaicSeesFalsePolarisationAtAnEdge) {
  const CDPolarimeter p(mosaicOf(polarsens), 4, 2, 1, 2, 2);
  std::vector<double> edge(4 * 2 * 4, 0);
  for (std::size_t i = 0; i < 8; ++i)
    edge[4 * i] = i % 4 < 2 ? 1 : 3;  // unpolarised, brighter on the right
  const std::vector<double> back = p.recover(p.read(edge));
  EXPECT_NEAR(back[1], 0, rounding);
  // pixel (1, 0): the window's left column reads 45 and 90 degrees of 1, its right 0 and 135 of 3
  EXPECT_NEAR(back[4 + 1], 1.0, rounding);
  EXPECT_NEAR(back[4 + 2], -1.0, rounding);
}

TEST(CDPolarimeterIdentity, ACalibrationIsAMatrixForEachPixel) {
  CDCube cube;
  cube.header.width = width, cube.header.height = height, cube.header.channels.resize(16);
  for (std::size_t i = 0; i < width * height; ++i) {
    const CDMuellerMatrix m = linearPolarizer(0.1 * double(i));
    cube.data.insert(cube.data.end(), m.data(), m.data() + 16);
  }
  const CDPolarimeter p(calibrationFrom(cube), width, height, bands, 2, 2);
  const double last = 0.1 * double(width * height - 1);
  const std::vector<double> read = p.read(even({2, 0.5, -0.3, 0.7}));
  // the cube holds float numbers: 2^-24 of 1 in each
  EXPECT_NEAR(read.back(), 1 + 0.25 * std::cos(2 * last) - 0.15 * std::sin(2 * last), 4e-7);
  // the same matrices go there and back, so nothing is lost but rounding times the condition number, below 1e3
  EXPECT_LT(farthest(p.recover(read), even({2, 0.5, -0.3, 0})), 1e-11);
  cube.header.channels.pop_back();
  EXPECT_THROW(calibrationFrom(cube), CDMathError);
}

TEST(CDPolarimeterIdentity, EveryBandMayHaveItsOwnFilter) {
  CDFilterPattern pattern = camerasBehind({linearPolarizer(0), linearPolarizer(pi / 2)});
  pattern.channels = 1, pattern.bands = 2;
  const CDPolarimeter p(pattern, 1, 1, 2, 1, 1);
  EXPECT_LT(farthest(p.read(std::vector<double>{1, 1, 0, 0, 1, 1, 0, 0}), {1, 0}), rounding);
}

TEST(CDPolarimeterIdentity, WhatDoesNotFitIsRefused) {
  CDFilterPattern pattern = camerasBehind(four);
  EXPECT_THROW(CDPolarimeter(pattern, 0, 0, 1, 1, 1), CDMathError);
  EXPECT_THROW(CDPolarimeter(pattern, 4, 4, 1, 5, 1), CDMathError);
  pattern.bands = 3;
  EXPECT_THROW(CDPolarimeter(pattern, 4, 4, 1, 1, 1), CDMathError);
  EXPECT_THROW(CDPolarimeter(camerasBehind({}), 4, 4, 1, 1, 1), CDMathError);
  EXPECT_THROW(CDPolarimeter(camerasBehind({CDMuellerMatrix(std::nan(""))}), 4, 4, 1, 1, 1),
               CDMathError);
  const CDPolarimeter p(camerasBehind(four), 4, 4, 1, 1, 1);
  EXPECT_THROW(p.read(std::vector<double>(7)), CDMathError);
  EXPECT_THROW(p.recover(std::vector<double>(7)), CDMathError);
}

TEST(CDPolarimeterInvariant, NoiseHasItsMeanAndVariance) {
  constexpr std::size_t n = 20000;
  struct Case {
    double reading, gain, sigma;
  };
  for (const Case& c : {Case{0.5, 6, 0}, Case{0.5, 400, 5}, Case{0.5, 1e8, 0}}) {
    std::vector<double> readings(n, c.reading);
    addNoise(readings, {c.gain, c.sigma, 3});
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

TEST(CDPolarimeterInvariant, NoiseDependsOnSeedAndFrameAlone) {
  const auto noisy = [](std::uint64_t seed, std::uint64_t frame) {
    std::vector<double> readings(100, 1.0);
    addNoise(readings, {50, 2, seed}, frame);
    return readings;
  };
  EXPECT_EQ(noisy(1, 0), noisy(1, 0));
  EXPECT_NE(noisy(1, 0), noisy(2, 0));
  EXPECT_NE(noisy(1, 0), noisy(1, 1));
}

TEST(CDPolarimeterIdentity, NoiseThatCannotBeIsRefused) {
  std::vector<double> readings{1.0, -1e-9};
  addNoise(readings, {});
  EXPECT_EQ(readings[0], 1.0);  // none asked for, none added
  EXPECT_THROW(addNoise(readings, {0, 1, 1}), CDMathError);
  EXPECT_THROW(addNoise(readings, {-1, 0, 1}), CDMathError);
  addNoise(readings, {100, 0, 1});
  EXPECT_NEAR(readings[1], -1e-9, 1e-24);  // no photons: as it was
  readings[0] = std::nan("");
  EXPECT_THROW(addNoise(readings, {100, 0, 1}), CDMathError);
}
