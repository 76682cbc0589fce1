// Tiles that are distributed to several runs (nw/files/Deal.nw).
#include "malus/files/Deal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

using namespace malus;

namespace {
/// A row of so many tiles; only their corners matter here.
std::vector<Tile> row(std::size_t tiles) {
  std::vector<Tile> made;
  for (std::size_t i = 0; i < tiles; ++i) made.push_back({i, 0, i + 1, 1});
  return made;
}

std::vector<std::size_t> numbers(const Deal& deal, std::size_t frame, std::size_t tiles) {
  std::vector<std::size_t> made;
  for (const Tile& tile : dealtTiles(deal, frame, row(tiles))) made.push_back(tile.x0);
  return made;
}

/// How many parts have each tile, [frame][tile].
std::map<std::size_t, std::vector<int>> owners(const std::vector<Deal>& deals,
                                               std::size_t tiles) {
  std::map<std::size_t, std::vector<int>> made;
  for (const Deal& deal : deals)
    for (std::size_t f = deal.first_frame; f <= deal.last_frame; ++f) {
      made[f].resize(tiles);
      for (const std::size_t i : numbers(deal, f, tiles)) ++made[f][i];
    }
  return made;
}

bool eachOnce(const std::vector<Deal>& deals, std::size_t tiles) {
  const auto made = owners(deals, tiles);
  return std::all_of(made.begin(), made.end(), [](const auto& frame) {
    return std::all_of(frame.second.begin(), frame.second.end(), [](int n) { return n == 1; });
  });
}
}  // namespace

TEST(DealIdentity, TwelveTilesInThreePartsAreThoseOfTheChapter) {
  using List = std::vector<std::size_t>;
  EXPECT_EQ(numbers({1, 3, 0, 0}, 0, 12), (List{0, 3, 7, 10}));
  EXPECT_EQ(numbers({2, 3, 0, 0}, 0, 12), (List{1, 4, 5, 8}));
  EXPECT_EQ(numbers({3, 3, 0, 0}, 0, 12), (List{2, 6, 9, 11}));
  EXPECT_EQ(numbers({3, 3, 7, 7}, 7, 12), (List{2, 6, 9, 11}));  // whatever the frame's number
}

TEST(DealInvariant, EachTileBelongsToOnePartAndPartsDifferByOne) {
  for (const std::size_t frames : {1, 2, 5})
    for (std::size_t tiles = 1; tiles <= 24; ++tiles)
      for (std::size_t parts = 1; parts <= tiles * frames; ++parts) {
        std::vector<Deal> deals;
        std::vector<std::size_t> sizes;
        for (std::size_t k = 1; k <= parts; ++k) {
          const Deal deal{k, parts, 3, 2 + frames};
          const auto [first, last] = framesOf(deal, tiles);
          std::size_t size = 0;
          for (std::size_t f = 3; f <= 2 + frames; ++f) {
            const std::size_t here = numbers(deal, f, tiles).size();
            ASSERT_EQ(here > 0, first <= f && f <= last) << tiles << ' ' << parts << ' ' << k;
            size += here;
          }
          deals.push_back(deal), sizes.push_back(size);
        }
        ASSERT_TRUE(eachOnce(deals, tiles)) << frames << ' ' << tiles << ' ' << parts;
        const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
        ASSERT_LE(*most - *least, 1u);
      }
}

TEST(DealInvariant, NegativeControlPartsOfTwoDealsAreNoWhole) {
  EXPECT_TRUE(eachOnce({{1, 2, 0, 0}, {2, 2, 0, 0}}, 12));
  EXPECT_FALSE(eachOnce({{1, 2, 0, 0}, {2, 3, 0, 0}}, 12));
}

// Neighbours in a piece of the golden ratio's sequence are at most 2.618 times as far apart as the closest ones are
// (the theorem of the three gaps), so less than 2.618 mean gaps. Of all tiles, as many lie between them as this share
// of the picture has, but for the sequence's discrepancy, which is at most 3 + (1 / ln 1.618 + 1 / ln 2) ln n tiles
// (Kuipers and Niederreiter, theorem 2.3.4 for partial quotients of 1).
TEST(DealInvariant, APartIsScatteredOverItsFrame) {
  const auto farthest = [](std::vector<std::size_t> own, std::size_t tiles) {
    own.push_back(own.front() + tiles);
    std::size_t gap = 0;
    for (std::size_t i = 1; i < own.size(); ++i) gap = std::max(gap, own[i] - own[i - 1]);
    return double(gap);
  };
  const auto bound = [](std::size_t parts, std::size_t tiles) {
    return 2.618 * double(parts) + 3 +
           (1 / std::log(1.618) + 1 / std::log(2)) * std::log(double(tiles));
  };
  for (const std::size_t tiles : {100, 256, 1024, 4096})
    for (const std::size_t parts : {2, 8, 10, 25})
      for (std::size_t k = 1; k <= parts; ++k)
        EXPECT_LE(farthest(numbers({k, parts, 0, 0}, 0, tiles), tiles), bound(parts, tiles))
            << tiles << ' ' << parts << ' ' << k;
  std::vector<std::size_t> piece(32);  // the negative control: the upper eighth of a picture
  std::iota(piece.begin(), piece.end(), 0u);
  EXPECT_GT(farthest(piece, 256), bound(8, 256));
}

TEST(DealIdentity, ATileComesOutOfItsSlotAsItWentIn) {
  const Tile fits{32, 16, 40, 32};  // half as wide as a slot
  std::vector<float> values(8 * 16 * 3);
  std::iota(values.begin(), values.end(), 1.0f);
  Cube strip;
  strip.header.width = tile_side, strip.header.height = 2 * tile_side;
  strip.header.channels = {"a", "b", "c"};
  strip.data.assign(tile_side * tile_side * 3, -1.0f);
  const std::vector<float> slot = intoSlot(fits, values);
  ASSERT_EQ(slot.size(), tile_side * tile_side * 3);
  strip.data.insert(strip.data.end(), slot.begin(), slot.end());
  EXPECT_EQ(fromSlot(strip, 1, fits), values);
  EXPECT_NE(fromSlot(strip, 0, fits), values);  // the negative control
  EXPECT_EQ(slotOf(1), (Tile{0, 16, 16, 32}));
  EXPECT_EQ(std::count(slot.begin(), slot.end(), 0.0f), 8 * 16 * 3);  // filled up with zeros
}
