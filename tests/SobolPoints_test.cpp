// Scrambled Sobol points (nw/base/SobolPoints.nw).
#include "malus/base/SobolPoints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <vector>

#include "ChiSquared.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/DirectionSampling.hpp"

using namespace malus;
using malus::testing::chiSquaredPValue;

namespace {
constexpr double false_alarm = 1e-6;
using Net = std::vector<SobolWords>;

Net sobolNet(unsigned m, std::uint32_t first = 0) {
  Net net;
  for (std::uint32_t i = 0; i < 1u << m; ++i) net.push_back(sobolWords(first + i));
  return net;
}

SobolWords wordsOf(const std::array<double, 4>& point) {
  SobolWords words;
  for (std::size_t d = 0; d < 4; ++d) words[d] = static_cast<std::uint32_t>(point[d] * 0x1p32);
  return words;
}

// Whether every elementary interval of volume 2^(t-m) in the first s dimensions holds 2^t points.
bool isNet(const Net& net, unsigned m, unsigned t, unsigned s) {
  std::vector<unsigned> d(s, 0);
  std::function<bool(unsigned, unsigned)> try_all = [&](unsigned dimension, unsigned left) {
    if (dimension + 1 < s) {
      for (unsigned take = 0; take <= left; ++take) {
        d[dimension] = take;
        if (!try_all(dimension + 1, left - take)) return false;
      }
      return true;
    }
    d[dimension] = left;
    std::vector<unsigned> counts(std::size_t{1} << (m - t), 0);
    for (const SobolWords& x : net) {
      std::size_t cell = 0;
      for (unsigned i = 0; i < s; ++i)
        cell = cell << d[i] | (std::uint64_t{x[i]} >> (32 - d[i]));
      ++counts[cell];
    }
    return std::all_of(counts.begin(), counts.end(), [&](unsigned n) { return n == 1u << t; });
  };
  return m < t || try_all(0, m - t);
}

// The permutation of Laine and Karras with the constants of Burley's paper, on mirrored digits.
std::uint32_t mirrored(std::uint32_t x) {
  std::uint32_t y = 0;
  for (int b = 0; b < 32; ++b) y |= (x >> b & 1u) << (31 - b);
  return y;
}
std::uint32_t laineKarras(std::uint32_t x, std::uint32_t key) {
  x = mirrored(x) + key;
  for (const std::uint32_t c : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u}) x ^= x * c;
  return mirrored(x);
}

// p-value that the coins of a node and of its two halves show their eight outcomes alike.
template <class Scramble>
double threeCoins(const Scramble& scramble, std::uint32_t prefix, unsigned depth) {
  std::vector<std::size_t> counts(8, 0);
  constexpr std::size_t draws = 1 << 15;
  Random random(depth, prefix);
  const std::uint32_t left = prefix, right = prefix | 1u << (31 - depth);
  const auto coin = [&](std::uint32_t x, std::uint32_t key, unsigned b) {
    return (scramble(x, key) ^ x) >> (31 - b) & 1u;
  };
  for (std::size_t i = 0; i < draws; ++i) {
    const auto key = static_cast<std::uint32_t>(random());
    ++counts[coin(left, key, depth) << 2 | coin(left, key, depth + 1) << 1 |
             coin(right, key, depth + 1)];
  }
  return chiSquaredPValue(counts, std::vector<double>(8, 0.125), draws);
}

double smooth(double x, double y) {
  return 1.25 * (1 - x * x * std::sqrt(1 - y * y) * 0.5) + x * y;
}

// Root mean square over 64 keys of the error of an average of n values of smooth().
template <class Draw>
double errorOf(std::uint32_t n, const Draw& draw) {
  double exact = 0, sum = 0;
  constexpr int fine = 1 << 10, keys = 64;
  for (int i = 0; i < fine; ++i)
    for (int j = 0; j < fine; ++j) exact += smooth((i + 0.5) / fine, (j + 0.5) / fine);
  exact /= double(fine) * fine;
  for (std::uint64_t key = 0; key < keys; ++key) {
    const double error = draw(key, n) - exact;
    sum += error * error;
  }
  return std::sqrt(sum / keys);
}

double sobolAverage(std::uint64_t key, std::uint32_t n) {
  const SobolPoints points(key);
  double sum = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto u = points(i);
    sum += smooth(u[0], u[1]);
  }
  return sum / n;
}

double randomAverage(std::uint64_t key, std::uint32_t n) {
  Random random(key);
  double sum = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = random.uniform(), y = random.uniform();
    sum += smooth(x, y);
  }
  return sum / n;
}
}  // namespace

// The first ten points of three dimensions as Joe and Kuo print them in the notes to their table
// ("Notes on generating Sobol' sequences", 2008), there in Gray's order.
TEST(SobolPointsPublished, FirstPointsOfJoeAndKuo) {
  const double printed[10][3] = {{0, 0, 0},
                                 {0.5, 0.5, 0.5},
                                 {0.75, 0.25, 0.25},
                                 {0.25, 0.75, 0.75},
                                 {0.375, 0.375, 0.625},
                                 {0.875, 0.875, 0.125},
                                 {0.625, 0.125, 0.875},
                                 {0.125, 0.625, 0.375},
                                 {0.1875, 0.3125, 0.9375},
                                 {0.6875, 0.8125, 0.4375}};
  for (std::uint32_t i = 0; i < 10; ++i)
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_EQ(sobolWords(i ^ i >> 1)[d] * 0x1p-32, printed[i][d]) << i << " " << d;
  EXPECT_NE(sobolWords(2)[1] * 0x1p-32, printed[2][1])
      << "negative control: not in binary order";
}

TEST(SobolPointsIdentity, SixIsThreeEighths) {
  EXPECT_EQ(sobolWords(6)[0], std::uint32_t{3} << 29);
}

TEST(SobolPointsIdentity, SobolPointsAreNets) {
  for (unsigned m = 0; m <= 10; ++m) {
    EXPECT_TRUE(isNet(sobolNet(m), m, 0, 2)) << m;
    EXPECT_TRUE(isNet(sobolNet(m), m, 3, 4)) << m;
  }
  EXPECT_TRUE(isNet(sobolNet(8, 7u << 8), 8, 0, 2)) << "an aligned block that is not the first";
  EXPECT_FALSE(isNet(sobolNet(8, 100), 8, 0, 2))
      << "negative control: a block that is not aligned";
}

TEST(SobolPointsInvariant, ScrambledPointsAreNets) {
  for (std::uint64_t key = 0; key < 20; ++key) {
    const SobolPoints points(key, 1, 2, 3, 4);
    for (const unsigned m : {1u, 4u, 7u, 10u}) {
      Net net;
      const std::uint32_t first = static_cast<std::uint32_t>(key) << m;
      for (std::uint32_t i = 0; i < 1u << m; ++i) net.push_back(wordsOf(points(first + i)));
      EXPECT_TRUE(isNet(net, m, 0, 2)) << key << " " << m;
      EXPECT_TRUE(isNet(net, m, 3, 4)) << key << " " << m;
      net[0][1] ^= 1u << 31;
      EXPECT_FALSE(isNet(net, m, 0, 2)) << "negative control";
      net.clear();
      const SobolPoints shallow(key, 1, 2, 3, 4, 1u << m);
      for (std::uint32_t i = 0; i < 1u << m; ++i) net.push_back(wordsOf(shallow(first + i)));
      EXPECT_TRUE(isNet(net, m, 0, 2)) << key << " " << m << ", no deeper than needed";
      EXPECT_TRUE(isNet(net, m, 3, 4)) << key << " " << m << ", no deeper than needed";
    }
  }
}

TEST(SobolPointsInvariant, ScramblingIsOneToOneAtEveryScale) {
  for (const std::uint32_t spacing : {1u, 1u << 10, 1u << 20}) {
    std::set<std::uint32_t> seen;
    for (std::uint32_t i = 0; i < 4096; ++i)
      seen.insert(owenScrambled(i * spacing, 0x1234567u));
    EXPECT_EQ(seen.size(), 4096u) << spacing;
  }
}

// Beyond 65536 points, where the shuffling of the index changes its key.
TEST(SobolPointsInvariant, NoPointComesTwice) {
  const SobolPoints points(5);
  std::set<double> seen;
  for (std::uint32_t i = 0; i < 1u << 18; ++i) seen.insert(points(i)[0]);
  EXPECT_EQ(seen.size(), std::size_t{1} << 18);
}

TEST(SobolPointsInvariant, EveryPointIsUniform) {
  constexpr std::size_t cells = 64, draws = 20000;
  for (const std::uint32_t index : {0u, 1u, 17u, 90u, 70000u})
    for (std::size_t d = 0; d < 4; ++d) {
      std::vector<std::size_t> counts(cells, 0), lattice(cells, 0);
      for (std::uint64_t key = 0; key < draws; ++key) {
        ++counts[static_cast<std::size_t>(SobolPoints(7, 0, key)(index)[d] * cells)];
        ++lattice[static_cast<std::size_t>(SobolPoints(7, 0, key % 16)(index)[d] * cells)];
      }
      const std::vector<double> alike(cells, 1.0 / cells);
      EXPECT_GT(chiSquaredPValue(counts, alike, draws), false_alarm) << index << " " << d;
      EXPECT_LT(chiSquaredPValue(lattice, alike, draws), false_alarm)
          << "negative control: sixteen keys only";
    }
}

TEST(SobolPointsInvariant, CoinsAreIndependent) {
  const auto deep = [](std::uint32_t x, std::uint32_t key) { return owenScrambled(x, key); };
  for (const auto& [prefix, depth] : {std::pair{0u, 0u}, {1u << 31, 1u}, {0xa5a50000u, 12u}}) {
    EXPECT_GT(threeCoins(deep, prefix, depth), false_alarm) << depth;
  }
  EXPECT_LT(threeCoins(laineKarras, 0, 0), false_alarm)
      << "negative control: the coins of Laine's and Karras's permutation depend on each other";
}

// A set of four points is scrambled two levels deep. Its points lie in different cells of that depth, and so their third
// digits must be independent coins, as they are in a set that is scrambled sixteen levels deep.
TEST(SobolPointsInvariant, AsDeepAsTheirNumberCanShow) {
  const auto together = [](std::uint64_t count) {
    constexpr std::uint64_t draws = 20000;
    std::vector<std::size_t> alike(2, 0);
    for (std::uint64_t key = 0; key < draws; ++key) {
      const SobolPoints points(11, 0, key, 0, 0, count);
      for (const auto& [i, j] : {std::pair{0u, 1u}, {2u, 3u}}) {
        const auto third = [&](std::uint32_t n) {
          return static_cast<int>(points(n)[0] * 8) & 1;
        };
        ++alike[static_cast<std::size_t>(third(i) ^ third(j))];
      }
    }
    return chiSquaredPValue(alike, std::vector<double>(2, 0.5), 2 * draws);
  };
  EXPECT_GT(together(4), false_alarm);
  EXPECT_GT(together(65536), false_alarm);
  EXPECT_LT(together(1), false_alarm) << "negative control: not deep enough";
}

TEST(SobolPointsInvariant, BouncesAreIndependent) {
  constexpr std::size_t side = 8, draws = 400, points = 64;
  std::vector<std::size_t> counts(side * side, 0), diagonal(side * side, 0);
  for (std::uint64_t key = 0; key < draws; ++key) {
    // one pair of a set only, because the points of a set are not independent
    const std::uint32_t index = static_cast<std::uint32_t>(key % points);
    const auto cell = [](double u) { return static_cast<std::size_t>(u * side); };
    for (std::size_t repeat = 0; repeat < 16; ++repeat) {
      const SobolPoints a(3, repeat, key, 0, 0), b(3, repeat, key, 0, 1);
      ++counts[cell(a(index)[0]) * side + cell(b(index)[0])];
      ++diagonal[cell(a(index)[0]) * side + cell(a(index)[0])];
    }
  }
  const std::vector<double> alike(side * side, 1.0 / (side * side));
  EXPECT_GT(chiSquaredPValue(counts, alike, draws * 16), false_alarm);
  EXPECT_LT(chiSquaredPValue(diagonal, alike, draws * 16), false_alarm) << "negative control";
}

// Within one set of 256 points the order is shuffled differently at each bounce: the pairs of
// (first bounce, second bounce) must not keep to a diagonal. With the shuffling the number of
// occupied cells of a 16 x 16 square is that of 256 random throws, 256 (1 - 1/e) = 162 with a
// standard deviation of 6; without it the 256 pairs meet in 16 cells.
TEST(SobolPointsInvariant, OrderIsShuffledBetweenBounces) {
  std::size_t occupied = 0;
  constexpr std::uint64_t sets = 50;
  for (std::uint64_t key = 0; key < sets; ++key) {
    const SobolPoints a(3, 0, key, 0, 0), b(3, 0, key, 0, 1);
    std::set<int> cells;
    for (std::uint32_t i = 0; i < 256; ++i)
      cells.insert(static_cast<int>(a(i)[0] * 16) * 16 + static_cast<int>(b(i)[0] * 16));
    occupied += cells.size();
  }
  const double mean = static_cast<double>(occupied) / sets;
  EXPECT_GT(mean, 130);
  EXPECT_LT(mean, 200);
}

TEST(SobolPointsInvariant, KeysAloneDecide) {
  EXPECT_EQ(SobolPoints(1, 2, 3, 4, 5)(6), SobolPoints(1, 2, 3, 4, 5)(6));
  const auto point = SobolPoints(1, 2, 3, 4, 5)(6);
  for (const SobolPoints& other :
       {SobolPoints(0, 2, 3, 4, 5), SobolPoints(1, 0, 3, 4, 5), SobolPoints(1, 2, 0, 4, 5),
        SobolPoints(1, 2, 3, 0, 5), SobolPoints(1, 2, 3, 4, 0)})
    EXPECT_NE(other(6), point);
}

// The slopes of log error over log n from 16 to 1024 points. Scrambled nets: -1.5 for smooth
// integrands, up to the logarithm; random numbers: -0.5. With 64 keys an error is known to a tenth,
// so a slope to 0.15 / log(64) = 0.04.
TEST(SobolPointsInvariant, ErrorFallsFasterThanThatOfRandomNumbers) {
  const auto slope = [](const auto& draw) {
    return std::log(errorOf(1024, draw) / errorOf(16, draw)) / std::log(64.0);
  };
  EXPECT_LT(slope(sobolAverage), -1.2);
  EXPECT_NEAR(slope(randomAverage), -0.5, 0.2) << "negative control";
}

// A block of points has the bits of so many single points, wherever it begins.
TEST(SobolPointsIdentity, ABlockOfPointsIsThePointsOneByOne) {
  for (const std::uint32_t first : {0u, 16u, 1000u, 65530u, 4000000u}) {
    const SobolPoints points(3, 1, first);
    const SobolPoints::Block block = points.points(first);
    for (std::uint32_t i = 0; i < SobolPoints::block; ++i)
      for (std::size_t d = 0; d < SobolPoints::dimensions; ++d) {
        EXPECT_EQ(block[i][d], points(first + i)[d]) << first + i;
        EXPECT_NE(block[i][d], points(first + i + 1)[d]) << "negative control: the next point";
      }
  }
}

// A reader keeps a block, and must notice when another one is needed: forwards, back, and again.
TEST(SobolPointsIdentity, AReaderGivesThePointsInAnyOrder) {
  const SobolPoints points(3, 1, 4);
  SobolReader all(points, 4), three(points, 3);
  for (const std::uint32_t index : {0u, 1u, 7u, 8u, 3u, 3u, 65535u, 65536u, 65543u, 1u}) {
    EXPECT_EQ(all(index), points(index)) << index;
    EXPECT_NE(all(index), points(index + 1)) << "negative control: the next point";
    for (std::size_t d = 0; d < 3; ++d) EXPECT_EQ(three(index)[d], points(index)[d]) << index;
    EXPECT_EQ(three(index)[3], 0) << "nobody wanted it";
  }
}
