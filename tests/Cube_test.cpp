// Cubes on disk, views of them and pictures to look at (nw/files/Cube.nw, nw/files/CubeView.nw, nw/files/Quicklooks.nw,
// nw/files/SpectralEXR.nw).
#include "malus/files/Cube.hpp"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>

#include "Memory.hpp"
#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/CubeView.hpp"
#include "malus/files/Quicklooks.hpp"
#include "malus/files/SpectralEXR.hpp"
#include "malus/render/Tile.hpp"

using namespace malus;

namespace {
constexpr std::size_t width = 6, height = 4;
const SpectralGridPtr bands = SpectralGrid::make(
    {CDSpectralLocation(CDSpectralPoint(450), BandResponse::gaussian(20)),
     CDSpectralLocation(CDSpectralPoint(550)), CDSpectralLocation(CDSpectralPoint(650.5))});
const CubeHeader header = stokesHeader(width, height, *bands, "W m^-2 sr^-1 nm^-1");

float number(std::size_t x, std::size_t y, std::size_t channel) {
  return float(100 * y + 10 * x) + float(channel) / 16;
}
std::vector<float> tileOf(const Tile& t) {
  std::vector<float> numbers;
  for (std::size_t y = t.y0; y < t.y1; ++y)
    for (std::size_t x = t.x0; x < t.x1; ++x)
      for (std::size_t c = 0; c < header.channels.size(); ++c)
        numbers.push_back(number(x, y, c));
  return numbers;
}
const std::vector<Tile> tiles{{0, 0, 4, 2}, {4, 0, 6, 2}, {0, 2, 6, 4}};

void writeAll(const std::filesystem::path& path, const CubeHeader& as = header,
              bool keep_journal = false) {
  CubeWriter writer(path, as);
  for (const Tile& t : tiles) writer.write(t, tileOf(t));
  writer.finish(keep_journal);
}
std::string complaint(const std::filesystem::path& path) {
  try {
    readCube(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}
int python(const std::string& program, const std::filesystem::path& path) {
  return std::system(("/usr/bin/python3 -c '" + program + "' " + path.string()).c_str());
}
}  // namespace

TEST(CubeIdentity, ComesBackAsItWasWritten) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  const Cube cube = readCube(scratch / "x.img");
  EXPECT_EQ(cube.header, header);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 12; ++c) ASSERT_EQ(cube.at(x, y, c), number(x, y, c));
  EXPECT_EQ(readCube(scratch / "x.img.hdr").data, cube.data);
  EXPECT_EQ(filesBelow(scratch.path), 2u);  // no .part, no journal
}

namespace {
CubeHeader inOrder(Interleave order) {
  CubeHeader made = header;
  made.interleave = order;
  return made;
}
}  // namespace

TEST(CubeIdentity, TheOrderOfTheFileIsNotThatOfTheMemory) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  const Cube cube = readCube(scratch / "x.img");
  for (const Interleave order : {Interleave::bil, Interleave::bsq}) {
    const std::string name = std::string(nameOf(order)) + ".img";
    writeAll(scratch / name, inOrder(order));
    EXPECT_EQ(readCube(scratch / name).header, inOrder(order));
    EXPECT_EQ(readCube(scratch / name).data, cube.data);
    EXPECT_NE(contents(scratch / name), contents(scratch / "x.img"));
  }
  EXPECT_EQ(interleaveOf("bsq"), Interleave::bsq);
  EXPECT_FALSE(interleaveOf("BSQ?"));
}

TEST(CubeInvariant, ACubeOfAnotherOrderIsResumedToo) {
  const Scratch scratch;
  for (const Interleave order : {Interleave::bil, Interleave::bsq}) {
    const CubeHeader as = inOrder(order);
    writeAll(scratch / "whole.img", as);
    { CubeWriter(scratch / "x.img", as).write(tiles[1], tileOf(tiles[1])); }
    EXPECT_THROW(CubeWriter(scratch / "x.img", header, true), InputError);
    CubeWriter again(scratch / "x.img", as, true);
    EXPECT_TRUE(again.finished(tiles[1]));
    for (const std::size_t i : {0, 2}) again.write(tiles[i], tileOf(tiles[i]));
    again.finish();
    EXPECT_EQ(contents(scratch / "x.img"), contents(scratch / "whole.img"));
  }
}

// ---------------------------------------------------------------- views

TEST(CubeViewIdentity, AViewHoldsTheNumbersOfItsFileInAnyOrder) {
  const Scratch scratch;
  for (const Interleave order : {Interleave::bip, Interleave::bil, Interleave::bsq}) {
    writeAll(scratch / "x.img", inOrder(order));
    const CubeView view = openCube(scratch / "x.img");
    EXPECT_EQ(view.header, inOrder(order));
    EXPECT_EQ(view.isByPixel(), order == Interleave::bip);
    std::vector<float> room;
    for (std::size_t y = 0; y < height; ++y) {
      const auto row = view.row(y, room);
      ASSERT_EQ(std::vector(row.begin(), row.end()), tileOf({0, y, width, y + 1}));
      const auto some = view.pixels(y, 2, 5, room);
      ASSERT_EQ(std::vector(some.begin(), some.end()), tileOf({2, y, 5, y + 1}));
      for (std::size_t x = 0; x < width; ++x)
        for (std::size_t c = 0; c < 12; ++c) ASSERT_EQ(view.at(x, y, c), number(x, y, c));
    }
  }
}

TEST(CubeViewIdentity, ACubeInMemoryIsByPixelWhateverItsFileWas) {
  const Scratch scratch;
  writeAll(scratch / "x.img", inOrder(Interleave::bsq));
  Cube cube = readCube(scratch / "x.img");
  const CubeView view = cube;
  EXPECT_EQ(view.at(4, 3, 7), number(4, 3, 7));
  EXPECT_EQ(view.numbers().data(), cube.data.data());  // nothing is copied
  const CubeView kept = std::move(cube);
  EXPECT_EQ(kept.at(4, 3, 7), number(4, 3, 7));
  EXPECT_THROW(CubeView(header, view.numbers().first(5), nullptr), MathError);
}

TEST(CubeViewIdentity, WhatIsWrittenByRowsIsWhatIsWrittenByTiles) {
  const Scratch scratch;
  for (const Interleave order : {Interleave::bip, Interleave::bil, Interleave::bsq}) {
    writeAll(scratch / "x.img", inOrder(order));
    writeRows(scratch / "y.img", inOrder(order), [](std::size_t y, std::vector<float>& row) {
      const std::vector<float> made = tileOf({0, y, width, y + 1});
      row.insert(row.end(), made.begin(), made.end());
    });
    EXPECT_EQ(contents(scratch / "y.img"), contents(scratch / "x.img"));
    EXPECT_EQ(contents(scratch / "y.img.hdr"), contents(scratch / "x.img.hdr"));
  }
}

TEST(CubeViewIdentity, ABadCubeIsRefusedAsByItsReader) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  std::filesystem::resize_file(scratch / "x.img", 100);
  const std::string said = complaint(scratch / "x.img");
  EXPECT_NE(said, "none");
  try {
    openCube(scratch / "x.img");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), said);
  }
}

// A file with holes imitates a large cube: 1024 x 1024 pixels of 96 channels are 403 MB.
TEST(CubeViewInvariant, ACubeMayBeLargerThanTheMemoryOfAProcess) {
  if (!memory_can_be_limited) GTEST_SKIP() << "a sanitizer holds more memory than the limit";
  constexpr std::size_t side = 1024, many = 96;
  constexpr rlim_t enough = 150'000'000;
  const Scratch scratch;
  for (const Interleave order : {Interleave::bip, Interleave::bsq}) {
    put(scratch / "x.img.hdr",
        fmt::format("ENVI\nsamples = {}\nlines = {}\nbands = {}\ndata type = 4\n"
                    "interleave = {}\nbyte order = 0\n",
                    side, side, many, nameOf(order)));
    put(scratch / "x.img", "");
    std::filesystem::resize_file(scratch / "x.img", side * side * many * 4 - 4);
    const float last = 7;
    std::ofstream(scratch / "x.img", std::ios::binary | std::ios::app)
        .write(reinterpret_cast<const char*>(&last), 4);
    const auto look = [&] {
      const CubeView cube = openCube(scratch / "x.img");
      std::vector<float> room;
      double sum = 0;
      for (std::size_t y = 0; y < side; ++y)
        for (const float number : cube.row(y, room)) sum += number;
      quicklook(cube, many - 1, scratch / "x.png");
      return sum == 7;
    };
    EXPECT_EQ(endingWithin(enough, look), Ending::good);
    EXPECT_TRUE(std::filesystem::exists(scratch / "x.png"));
    const auto read = [&] { return readCube(scratch / "x.img").data.back() == 7; };
    EXPECT_EQ(endingWithin(enough, read), Ending::out_of_memory);  // the negative control
  }
}

// ---------------------------------------------------------------- headers

// What a user calls a file must not end a value of the header.
TEST(CubeIdentity, BracesAndLineBreaksStayInsideOfTheirValue) {
  const Scratch scratch;
  CubeHeader odd = header;
  odd.description = "scene a}\nbands = 1\n{b";
  writeAll(scratch / "x.img", odd, true);
  const Cube cube = readCube(scratch / "x.img");
  EXPECT_EQ(cube.header.description, "scene a%7D%0Abands = 1%0A%7Bb");
  EXPECT_EQ(cube.header.channels, header.channels);
  CubeWriter again(scratch / "x.img", odd, true);
  EXPECT_TRUE(again.finished(tiles[0]));  // the header is known again
}

TEST(CubeIdentity, TimePlaceAndIgnoreValueComeBack) {
  const Scratch scratch;
  CubeHeader full = header;
  full.acquisition_time = "2001-06-10T17:06:00Z";
  full.map_info = "Arbitrary, 1, 1, -3, 2, 1, 1, units=Meters";
  writeAll(scratch / "x.img", full);
  EXPECT_EQ(readCube(scratch / "x.img").header, full);
  EXPECT_EQ(header.ignore_value, "nan");
}

// 400 000 wavelengths, one a line: as long as the list, not as its square, or this test never ends.
TEST(CubeIdentity, ALongListMayHaveManyLines) {
  const Scratch scratch;
  constexpr std::size_t many = 400000;
  std::string text =
      "ENVI\nsamples = 1\nlines = 1\nbands = 400000\ndata type = 4\n"
      "interleave = bip\nbyte order = 0\nwavelength = {\n";
  for (std::size_t i = 0; i < many; ++i) text += std::to_string(400 + i) + ",\n";
  text.replace(text.size() - 2, 2, "}\n");
  put(scratch / "x.img.hdr", text);
  put(scratch / "x.img", std::string(many * sizeof(float), '\0'));
  EXPECT_EQ(readCube(scratch / "x.img").header.wavelength_nm.size(), many);
}

TEST(CubeInvariant, AnInterruptedCubeEndsInTheSameBits) {
  const Scratch scratch;
  writeAll(scratch / "whole.img");
  {
    CubeWriter writer(scratch / "x.img", header);
    writer.write(tiles[0], tileOf(tiles[0]));
    writer.write(tiles[2], tileOf(tiles[2]));
    EXPECT_THROW(writer.finish(), MathError);
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "x.img"));
  {  // one of the two is damaged on disk: its checksum finds it out
    std::fstream file(scratch / "x.img.part", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4);
    file.put('?');
  }
  CubeWriter again(scratch / "x.img", header, true);
  EXPECT_FALSE(again.finished(tiles[0]));
  EXPECT_FALSE(again.finished(tiles[1]));
  EXPECT_TRUE(again.finished(tiles[2]));
  again.write(tiles[1], tileOf(tiles[1]));
  again.write(tiles[0], tileOf(tiles[0]));
  again.finish();
  EXPECT_EQ(contents(scratch / "x.img"), contents(scratch / "whole.img"));
}

TEST(CubeIdentity, AWholeCubeOfTheSameHeaderIsLeftAsItIs) {
  const Scratch scratch;
  writeAll(scratch / "x.img", header, true);
  const std::string before = contents(scratch / "x.img");
  CubeWriter again(scratch / "x.img", header, true);
  EXPECT_TRUE(again.finished(tiles[1]));
  again.finish();
  again.removeJournal();
  EXPECT_EQ(contents(scratch / "x.img"), before);
  EXPECT_EQ(filesBelow(scratch.path), 2u);
  EXPECT_FALSE(CubeWriter(scratch / "x.img", header, true).finished(tiles[1]))
      << "negative control: without its journal nothing vouches for the cube";
  writeAll(scratch / "x.img", header, true);
  CubeHeader other = header;
  other.description += " of another scene";
  EXPECT_FALSE(CubeWriter(scratch / "x.img", other, true).finished(tiles[1]));
}

TEST(CubeIdentity, AnotherCubeIsNotGoneOnWith) {
  const Scratch scratch;
  { CubeWriter writer(scratch / "x.img", header); }
  CubeHeader other = header;
  other.wavelength_nm[0] = 451;
  EXPECT_THROW(CubeWriter(scratch / "x.img", other, true), InputError);
  EXPECT_NO_THROW(CubeWriter(scratch / "x.img", header, true));
  EXPECT_THROW(CubeWriter("/dev/null/x.img", header), InputError);
}

TEST(CubeIdentity, BadCubesAreNamed) {
  const Scratch scratch;
  EXPECT_NE(complaint(scratch / "none.img").find("none.img: does not exist"),
            std::string::npos);
  EXPECT_NE(complaint(scratch.path).find("is a directory"), std::string::npos);
  put(scratch / "alone.img", "numbers");
  EXPECT_NE(complaint(scratch / "alone.img").find("alone.img: has no .hdr beside it"),
            std::string::npos);
  writeAll(scratch / "x.img");
  EXPECT_EQ(complaint(scratch / "x.img"), "none");
  const std::string text = contents(scratch / "x.img.hdr");
  const auto spoil = [&](const std::string& from, const std::string& to) {
    std::string bad = text;
    bad.replace(bad.find(from), from.size(), to);
    put(scratch / "x.img.hdr", bad);
    return complaint(scratch / "x.img");
  };
  EXPECT_NE(spoil("data type = 4", "data type = 5").find("data type = 5: is not supported"),
            std::string::npos);
  EXPECT_NE(spoil("samples = 6", "samples = 7").find("should hold"), std::string::npos);
  EXPECT_NE(spoil("samples = 6", "samples = six").find("samples"), std::string::npos);
  EXPECT_NE(spoil("ENVI", "IVNE").find("not the header of an ENVI cube"), std::string::npos);
  EXPECT_NE(spoil("S0 450, ", "").find("11 names"), std::string::npos);
  EXPECT_NE(spoil("wavelength = {450, ", "wavelength = {").find("11 wavelengths"),
            std::string::npos);
  EXPECT_NE(spoil("fwhm = {20, ", "fwhm = {").find("11 widths"), std::string::npos);
  EXPECT_NE(spoil("interleave = bip", "interleave = big").find("bip, bil or bsq"),
            std::string::npos);
  // sizes that no file holds, and a list that is too short for its bands
  std::string huge = text;
  for (const auto& [key, size] :
       {std::pair{"samples = 6", "samples = 1000000"}, {"lines = 4", "lines = 1000000"}})
    if (const auto at = huge.find(key); at != huge.npos)
      huge.replace(at, std::string(key).size(), size);
  put(scratch / "x.img.hdr", huge);
  EXPECT_NE(complaint(scratch / "x.img").find("should hold 1000000 x"), std::string::npos);
}

// One wavelength a line, as many programs write them; each line is looked at once.
TEST(CubeIdentity, AHeaderOfManyLinesIsRead) {
  const Scratch scratch;
  constexpr int wavelengths = 100'000;
  std::string text = fmt::format(
      "ENVI\nsamples = 1\nlines = 1\nbands = {}\ndata type = 4\ninterleave = bip\nbyte order = "
      "0\n"
      "wavelength = {{\n",
      wavelengths);
  for (int i = 0; i < wavelengths; ++i)
    text += fmt::format("{}{}\n", 400 + i * 0.01, i + 1 < wavelengths ? "," : "}");
  put(scratch / "x.img", std::string(4 * wavelengths, '\0'));
  put(scratch / "x.img.hdr", text);
  const Cube cube = readCube(scratch / "x.img");
  ASSERT_EQ(cube.header.wavelength_nm.size(), std::size_t{wavelengths});
  EXPECT_DOUBLE_EQ(cube.header.wavelength_nm[4711], 400 + 4711 * 0.01);
}

// Other people's readers: GDAL and Spectral Python, as Debian ships them.
TEST(CubePublished, GdalReadsNamesWavelengthsAndNumbers) {
  const Scratch scratch;
  for (const Interleave order : {Interleave::bip, Interleave::bil, Interleave::bsq}) {
    writeAll(scratch / "x.img", inOrder(order));
    EXPECT_EQ(python("import sys, math\nfrom osgeo import gdal\nd = gdal.Open(sys.argv[1])\n"
                     "assert (d.RasterXSize, d.RasterYSize, d.RasterCount) == (6, 4, 12)\n"
                     "b = d.GetRasterBand(12)\n"
                     "assert b.GetDescription().startswith(\"S3 650.5\"), b.GetDescription()\n"
                     "assert float(b.GetMetadataItem(\"wavelength\")) == 650.5\n"
                     "assert math.isnan(b.GetNoDataValue())\n"
                     "assert b.ReadAsArray()[3, 5] == 350.6875\n",
                     scratch / "x.img"),
              0)
        << nameOf(order);
  }
}

TEST(CubePublished, SpectralPythonReadsNamesWavelengthsAndNumbers) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  const std::string program =
      "import sys, spectral\nd = spectral.open_image(sys.argv[1] + \".hdr\")\n"
      "assert d.shape == (4, 6, 12), d.shape\n"
      "assert d.bands.centers[0] == 450 and d.bands.bandwidths[0] == 20 and d.bands.band_unit "
      "== \"Nanometers\"\n"
      "assert d.metadata[\"band names\"][5] == \"S1 550\"\n"
      "assert d[2, 3, 1] == ";
  for (const Interleave order : {Interleave::bip, Interleave::bil, Interleave::bsq}) {
    writeAll(scratch / "x.img", inOrder(order));
    EXPECT_EQ(python(program + "230.0625\n", scratch / "x.img"), 0) << nameOf(order);
  }
  EXPECT_NE(python(program + "230\n", scratch / "x.img"), 0);  // the negative control
}

TEST(CubePublished, SpectralExrHasTheNamesOfItsConvention) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  writeSpectralEXR(readCube(scratch / "x.img"), scratch / "x.exr");
  const auto in = OIIO::ImageInput::open((scratch / "x.exr").string());
  ASSERT_TRUE(in) << OIIO::geterror();
  const OIIO::ImageSpec& spec = in->spec();
  EXPECT_EQ(spec.get_string_attribute("spectralLayoutVersion"), "1.0");
  EXPECT_EQ(spec.get_string_attribute("polarisationHandedness"), "right");
  EXPECT_EQ(spec.get_string_attribute("emissiveUnits"), "W.m^-2.sr^-1");
  const int channel = spec.channelindex("S2.650,500000nm");
  ASSERT_GE(channel, 0);
  std::vector<float> numbers(width * height * 12);
  ASSERT_TRUE(in->read_image(0, 0, 0, 12, OIIO::TypeDesc::FLOAT, numbers.data()));
  EXPECT_EQ(numbers[(1 * width + 2) * 12 + std::size_t(channel)], number(2, 1, 10));
}

// Named bands, two of them with one centre: an attribute, and a layer for the second.
TEST(CubeIdentity, NamesOfBandsAreInTheSpectralPicture) {
  const Scratch scratch;
  const auto named = SpectralGrid::bands(
      {CDSpectralLocation(550.0), CDSpectralLocation(550, BandResponse::gaussian(200)),
       CDSpectralLocation(450.0)},
      {"green", "pan", ""});
  Cube cube{stokesHeader(1, 1, *named, "1"), std::vector<float>(12)};
  EXPECT_EQ(cube.header.channels[4], "S0 pan");
  EXPECT_EQ(cube.header.channels[8], "S0 450");
  for (std::size_t i = 0; i < 12; ++i) cube.data[i] = float(i);
  writeSpectralEXR(cube, scratch / "x.exr");
  const auto in = OIIO::ImageInput::open((scratch / "x.exr").string());
  ASSERT_TRUE(in);
  EXPECT_EQ(in->spec().get_string_attribute("bandNames"), "green, pan, 450");
  std::vector<float> numbers(12);
  ASSERT_TRUE(in->read_image(0, 0, 0, 12, OIIO::TypeDesc::FLOAT, numbers.data()));
  const auto channel = [&](const char* name) {
    const int at = in->spec().channelindex(name);
    return at < 0 ? -1 : numbers[std::size_t(at)];
  };
  EXPECT_EQ(channel("S1.550,000000nm"), 1);
  EXPECT_EQ(channel("pan.S1.550,000000nm"), 5);
  EXPECT_EQ(channel("S1.450,000000nm"), 9);
}

TEST(QuicklooksIdentity, DrawsEveryQuantityWithItsScale) {
  const Scratch scratch;
  writeAll(scratch / "x.img");
  Cube cube = readCube(scratch / "x.img");
  cube.data[5] = std::numeric_limits<float>::quiet_NaN();  // S1 of the second band, first pixel
  const auto made = quicklooks(cube, 1, scratch / "q");
  ASSERT_EQ(made.size(), 8u);
  const auto in = OIIO::ImageInput::open((scratch / "q.S1.png").string());
  ASSERT_TRUE(in);
  EXPECT_EQ(in->spec().width, int(width) + 84);
  std::vector<unsigned char> rgb((width + 84) * height * 3);
  ASSERT_TRUE(in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, rgb.data()));
  EXPECT_EQ(rgb[1], 255);  // the green of NaN
  EXPECT_EQ(rgb[0], 0);
  EXPECT_THROW(quicklooks(cube, 3, scratch / "q"), MathError);
}

namespace {
/// The red, green and blue of a picture's first row.
std::vector<std::array<int, 3>> firstRow(const std::filesystem::path& path,
                                         std::size_t pixels) {
  const auto in = OIIO::ImageInput::open(path.string());
  std::vector<unsigned char> rgb(std::size_t(in->spec().width * in->spec().height * 3));
  in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, rgb.data());
  std::vector<std::array<int, 3>> row;
  for (std::size_t i = 0; i < pixels; ++i)
    row.push_back({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]});
  return row;
}
int distance(const std::array<int, 3>& a, const std::array<int, 3>& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}
}  // namespace

TEST(QuicklooksIdentity, ScalesMeanWhatTheChapterSays) {
  const Scratch scratch;
  Cube cube;
  cube.header.width = 4, cube.header.height = 1;
  cube.header.channels = {"S0 550", "S1 550", "S2 550", "S3 550"};
  const float almost = -std::sin(2 * 0.1f * 3.14159f / 180);  // along 179.9 degrees
  cube.data = {1, 0.5f, 0, 0, 2, -0.5f, 0, 0, 3, 0, 0, 0, 4, 0.5f, 0.5f * almost, 0};
  quicklooks(cube, 0, scratch / "q");
  const auto s1 = firstRow(scratch / "q.S1.png", 4), s0 = firstRow(scratch / "q.S0.png", 4);
  EXPECT_GT(s1[0][0], s1[0][2] + 100);  // positive: red
  EXPECT_GT(s1[1][2], s1[1][0] + 100);  // negative: blue
  EXPECT_LT(distance(s1[2], {247, 247, 247}), 4);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(s0[i][0], s0[i - 1][0]);
  quicklook(cube, 0, scratch / "one.png");
  EXPECT_EQ(firstRow(scratch / "one.png", 4), s0);
  const auto dolp = firstRow(scratch / "q.DoLP.png", 4);  // 1/2, 1/4, 0, 1/8
  EXPECT_GT(dolp[0][0], dolp[1][0]);
  EXPECT_GT(dolp[1][0], dolp[3][0]);
  EXPECT_GT(dolp[3][0], dolp[2][0]);
  for (float& s : cube.data)
    s = s > 1 ? 1 : s;  // the same degree for the angles that are compared
  quicklooks(cube, 0, scratch / "a");
  const auto angle = firstRow(scratch / "a.AoLP.png", 4);
  EXPECT_LT(distance(angle[0], angle[3]), 12);
  EXPECT_GT(distance(angle[0], angle[1]), 200);
  EXPECT_LT(distance(angle[2], {0, 0, 0}), 4);  // no polarisation, no angle
}

// Two frames of a film: the same light, once beside brighter light. With given ends it has the same colour, and by itself it has not.
TEST(QuicklooksIdentity, OnGivenScalesEqualLightHasEqualColours) {
  const Scratch scratch;
  const auto three = SpectralGrid::make({450, 550, 650});
  Cube dim{stokesHeader(2, 1, *three, "1"), {}}, bright = dim;
  for (int band = 0; band < 3; ++band)
    dim.data.insert(dim.data.end(), {1, 0.5f, 0.25f, 0.125f});
  bright.data = dim.data;
  for (int band = 0; band < 3; ++band) {
    dim.data.insert(dim.data.end(), {1, 0.25f, 0, 0});
    bright.data.insert(bright.data.end(), {4, 3, 0, 2});
  }
  const PictureScales own = scalesOf(dim, 1);
  EXPECT_EQ(own, (PictureScales{{"S0", 1},
                                {"S1", 0.5f},
                                {"S2", 0.25f},
                                {"S3", 0.125f},
                                {"DoLP", std::hypot(0.5f, 0.25f)},
                                {"DoCP", 0.125f},
                                {"red", 1},
                                {"green", 1},
                                {"blue", 1}}));
  PictureScales film = own;
  widen(film, scalesOf(bright, 1));
  EXPECT_EQ(film, (PictureScales{{"S0", 4},
                                 {"S1", 3},
                                 {"S2", 0.25f},
                                 {"S3", 2},
                                 {"DoLP", 0.75f},
                                 {"DoCP", 0.5f},
                                 {"red", 4},
                                 {"green", 4},
                                 {"blue", 4}}));
  Cube night = dim;
  std::ranges::fill(night.data, 0.f);
  EXPECT_EQ(scalesOf(night, 1), PictureScales{});  // darkness sets no scale
  EXPECT_EQ(scalesOfChannel(night, 0), PictureScales{});
  quicklooks(dim, 1, scratch / "dim"), quicklooks(bright, 1, scratch / "bright");
  quicklooks(dim, 1, scratch / "film-dim", {}, film);
  quicklooks(bright, 1, scratch / "film-bright", {}, film);
  for (const std::string name : {"S0", "S1", "S3", "DoLP", "AoLP", "rgb"}) {
    const auto first = [&](const std::string& of) {
      return firstRow(scratch / fmt::format("{}.{}.png", of, name), 1)[0];
    };
    EXPECT_EQ(first("film-dim"), first("film-bright")) << name;
    EXPECT_NE(first("dim"), first("bright")) << name;
  }
  quicklook(dim, 0, scratch / "a.png", {{"readings", 4.f}});
  EXPECT_EQ(firstRow(scratch / "a.png", 2), firstRow(scratch / "film-dim.S0.png", 2));
}

TEST(QuicklooksIdentity, ScalesAreReadOrRefused) {
  const InputPlace place{"command line", 0, "--scale"};
  EXPECT_EQ(readScales("S0=0.25,DoLP=1", place), (PictureScales{{"S0", 0.25f}, {"DoLP", 1}}));
  for (const char* bad : {"", "S0", "S0=", "S9=1", "S0=0", "S0=-1", "S0=nan", "S0=1e39",
                          "S0=1e-60", "S0=1,S0=2", "S0=1,", "fil"})
    EXPECT_THROW(readScales(bad, place), InputError) << bad;
}

// A black pixel has no degree and no angle: grey, which no scale holds; and no part in the stretch.
TEST(QuicklooksIdentity, ABlackPixelIsNeitherAFaultNorUnpolarised) {
  const Scratch scratch;
  Cube cube{stokesHeader(3, 1, *SpectralGrid::make({550}), "1"),
            {0, 0, 0, 0, 2, 1, 0, 0.5f, 0, 1, 0, 0}};
  quicklooks(cube, 0, scratch / "q");
  for (const char* name : {"q.DoLP.png", "q.DoCP.png", "q.AoLP.png"})
    EXPECT_EQ(firstRow(scratch / name, 1)[0], (std::array<int, 3>{128, 128, 128})) << name;
  EXPECT_EQ(firstRow(scratch / "q.DoLP.png", 3)[2][1],
            255);  // polarised without light: a fault
  EXPECT_LT(firstRow(scratch / "q.S0.png", 1)[0][0], 4);
}

TEST(QuicklooksIdentity, AnAbsentComponentHasNoPictureAndFalseColoursNoBar) {
  const Scratch scratch;
  // bands in no order: red must be 650 nm all the same
  const auto three = SpectralGrid::bands(
      {CDSpectralLocation(550.0), CDSpectralLocation(650.0), CDSpectralLocation(450.0)});
  Cube cube{bandHeader(2, 1, *three, {"S0", "S1", "S2"}, "1"),
            {0.1f, 0, 0, 1, 0, 0, 0.1f, 0, 0, 1, 0, 0, 0.1f, 0, 0, 1, 0, 0}};
  EXPECT_EQ(stokesComponents(cube.header), (std::vector<std::size_t>{0, 1, 2}));
  const auto made = quicklooks(cube, 1, scratch / "q");
  EXPECT_EQ(made.size(), 6u);  // S0, S1, S2, DoLP, AoLP, rgb
  EXPECT_FALSE(std::filesystem::exists(scratch / "q.S3.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "q.DoCP.png"));
  const auto in = OIIO::ImageInput::open((scratch / "q.rgb.png").string());
  ASSERT_TRUE(in);
  EXPECT_EQ(in->spec().width, 2);
  const auto rgb = firstRow(scratch / "q.rgb.png", 2);
  EXPECT_GT(rgb[0][0], rgb[0][2] + 100);
  EXPECT_GT(rgb[1][2], rgb[1][0] + 100);
  cube.header.channels[5] = "S3 650";
  EXPECT_FALSE(stokesComponents(cube.header));
}

// The end of a scale is the number that sorting finds, to the bit, although nothing is sorted.
TEST(QuicklooksIdentity, TheStretchIsThatOfSortedMagnitudes) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::uint32_t> bits;
  std::uniform_real_distribution<float> narrow(1, 1.001f);
  for (const bool alike : {false, true})
    for (const std::size_t count : {1u, 2u, 199u, 200u, 401u, 5000u}) {
      Cube cube{bandHeader(count, 1, *bands, {"S0"}, ""), {}};
      std::vector<float> finite;
      for (std::size_t i = 0; i < count; ++i) {
        const float v = alike ? -narrow(random) : std::bit_cast<float>(bits(random));
        cube.data.insert(cube.data.end(), {v, 0, 0});
        if (std::isfinite(v)) finite.push_back(std::abs(v));
      }
      std::ranges::sort(finite);
      ASSERT_FALSE(finite.empty());
      const float expected = finite[finite.size() - 1 - finite.size() / 200];
      EXPECT_EQ(scalesOfChannel(cube, 0, "one"), (PictureScales{{"one", expected}})) << count;
    }
}
