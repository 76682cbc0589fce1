// A picture that improves while a render runs (nw/app/Preview.nw).
#include "malus/app/Preview.hpp"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "Program.hpp"
#include "Spread.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/Quicklooks.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
struct Pixels {
  std::size_t width = 0, height = 0;
  std::vector<unsigned char> rgb;
  std::span<const unsigned char> at(std::size_t x, std::size_t y) const {
    return std::span(rgb).subspan(3 * (y * width + x), 3);
  }
};

Pixels pictureIn(const std::filesystem::path& file) {
  const auto in = OIIO::ImageInput::open(file.string());
  if (!in) throw std::runtime_error("no picture " + file.string());
  Pixels made{std::size_t(in->spec().width), std::size_t(in->spec().height), {}};
  made.rgb.resize(3 * made.width * made.height);
  in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, made.rgb.data());
  return made;
}

/// Root mean square difference of two pictures of one size.
double differenceOf(const Pixels& a, const Pixels& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i)
    sum += std::pow(double(a.rgb[i]) - double(b.rgb[i]), 2);
  return std::sqrt(sum / double(a.rgb.size()));
}

Plan planIn(const Workplace& place, const std::string& part = "") {
  RenderFlags flags;
  flags.scene = (place.scratch / "s.json").string(), flags.part = part;
  flags.out = (place.scratch / "out").string();
  std::filesystem::create_directories(flags.out);
  return planOf(flags);
}
}  // namespace

// The preview of a frame is there before its first tile, and each half of the tiles brings it
// closer to the final picture.
TEST(PreviewInvariant, EveryTileImprovesIt) {
  const Workplace place(copper(64, 48));
  const Plan plan = planIn(place);
  const Renderer renderer(plan.scene, 0);
  Cube light{stokesHeader(64, 48, *plan.scene.sensor.bands(), ""), {}};
  light.data.resize(64 * 48 * 4);
  std::vector<std::pair<Tile, std::vector<float>>> tiles;
  renderTiles(renderer, plan.scene, tilesOf(plan.part), {1, {}, nullptr},
              [&](const Tile& tile, std::span<const double> stokes,
                  std::span<const Radiometry::Truth>) {
                tiles.emplace_back(tile, std::vector<float>(stokes.begin(), stokes.end()));
                for (std::size_t i = 0; i < stokes.size(); ++i) {
                  const std::size_t x = tile.x0 + i / 4 % 16, y = tile.y0 + i / 64;
                  light.data[4 * (y * 64 + x) + i % 4] = float(stokes[i]);
                }
              });
  ASSERT_EQ(tiles.size(), 12u);
  const std::filesystem::path file = Preview::fileOf(plan);
  EXPECT_EQ(file.filename(), "s.preview.png");
  drawPair(light, place.scratch / "end.png");
  const Pixels end = pictureIn(place.scratch / "end.png");
  std::vector<double> off;
  for (const std::size_t some : {0u, 6u, 12u}) {  // tiles that have come
    Preview preview(plan, 0, renderer.world(), 1);
    for (std::size_t i = 0; i < some; ++i) preview.put(tiles[i].first, tiles[i].second);
    std::filesystem::remove(file);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // after which a tile draws
    if (some > 0) preview.put(tiles[0].first, tiles[0].second);
    if (some == 0) Preview(plan, 0, renderer.world(), 3);
    off.push_back(differenceOf(pictureIn(file), end));
  }
  EXPECT_GT(off[0], 5);
  EXPECT_LT(off[1], 0.9 * off[0]);
  EXPECT_EQ(off[2], 0);
  Preview(plan, 0, renderer.world(), 1).end(light);
  EXPECT_EQ(differenceOf(pictureIn(file), end), 0);
}

// The two halves are the quick looks of S0 and DoLP, which are left of their bars.
TEST(PreviewIdentity, ItsColoursAreThoseOfTheQuickLooks) {
  const Workplace place(copper(40, 24));
  ASSERT_EQ(place.malus("render s.json --out a --progressive --write pictures").code, 0);
  const Pixels both = pictureIn(place.scratch / "a/s.preview.png");
  ASSERT_EQ(both.width, 80u);
  ASSERT_EQ(both.height, 24u);
  for (const auto& [name, first] : {std::pair{"S0", 0u}, {"DoLP", 40u}}) {
    const Pixels alone = pictureIn(place.scratch / fmt::format("a/s.{}.png", name));
    for (std::size_t y = 0; y < 24; ++y)
      for (std::size_t x = 0; x < 40; ++x)
        EXPECT_TRUE(std::ranges::equal(both.at(first + x, y), alone.at(x, y)))
            << name << ' ' << x << ' ' << y;
  }
  EXPECT_FALSE(std::ranges::equal(both.at(20, 12), both.at(60, 12))) << "negative control";
}

// 3000 x 2000 pixels by hand: every tenth. With 400 wavelengths there are fewer.
TEST(PreviewIdentity, ALargePictureHasASmallPreview) {
  const Workplace place(copper(3000, 2000));
  EXPECT_EQ(Preview::stepOf(planIn(place)), 10u);
  EXPECT_EQ(Preview::stepOf(planIn(place, "16,16,272,272")), 1u);
  json many = copper(256, 256);
  many["bands"] = {{"wavelength_nm", json::array()}};
  for (int i = 0; i < 400; ++i) many["bands"]["wavelength_nm"].push_back(400 + i);
  const Workplace bands(many);
  EXPECT_EQ(Preview::stepOf(planIn(bands)), 4u) << "65536 / 5242 pixels is 12.5";
}

// Parts, threads and a run that goes on: a preview, and cubes with the bits that they have without it.
TEST(PreviewInvariant, CubesHaveTheSameBits) {
  const Workplace place(copper(50, 40));
  const std::string render = "render s.json --write cube,truth ";
  ASSERT_EQ(place.malus(render + "--out a").code, 0);
  ASSERT_EQ(place.malus(render + "--out b --progressive --threads 1").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "a/s.preview.png"));
  const Pixels whole = pictureIn(place.scratch / "b/s.preview.png");
  EXPECT_EQ(whole.width, 100u);
  ASSERT_EQ(place.malus(render + "--out c --progressive --part 10,6,45,30").code, 0);
  EXPECT_EQ(pictureIn(place.scratch / "c/s.10-6-45-30.preview.png").height, 24u);
  ASSERT_EQ(place.malus(render + "--out d --progressive --part 2/3").code, 0);
  EXPECT_EQ(pictureIn(place.scratch / "d/s.part-2-of-3.preview.png").height, 40u)
      << "of the whole picture, with the part's tiles in it";
}
