// Pictures of other people's formats, looked at with nothing but the definitions of these formats.
#include "malus/files/PictureFiles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"

using namespace malus;

namespace {
/// Is a library of this name mapped into this process?
bool isLoaded(const std::string& name) {
  return contents("/proc/self/maps").find(name) != std::string::npos;
}

const std::vector<unsigned char> bytes(5 * 3 * 3, 77);
PictureFile picture() { return {5, 3, {"R", "G", "B"}, bytes}; }

unsigned bigEndian(const std::string& text, std::size_t at) {
  unsigned number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number = number << 8 | static_cast<unsigned char>(text[at + i]);
  return number;
}
}  // namespace

// Its two hundred libraries cost every picture a fifth of a second.
TEST(PictureFilesInvariant, OpenImageIOIsNotLoaded) {
  const Scratch scratch;
  savePicture(picture(), scratch / "x.png");
  EXPECT_TRUE(isLoaded("libpng"));  // the list works
  EXPECT_FALSE(isLoaded("libOpenImageIO"));
}

TEST(PictureFilesInvariant, AnyNumberOfThreadsWritesTheSameBytes) {
  const Scratch scratch;
  std::vector<float> floats(64 * 64);
  for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = static_cast<float>(i * i % 997);
  PictureFile many{64, 64, {"R"}, {}, floats};
  for (const int threads : {1, 3, 0}) {
    many.threads = threads;
    savePicture(many, scratch / fmt::format("{}.exr", threads));
    EXPECT_EQ(contents(scratch / fmt::format("{}.exr", threads)), contents(scratch / "1.exr"));
  }
  floats[5] = 0.5f;
  savePicture(many, scratch / "other.exr");
  EXPECT_NE(contents(scratch / "other.exr"), contents(scratch / "1.exr"));  // negative control
}

TEST(PictureFilesIdentity, RowsMadeOneAtATimeAreThePicture) {
  const Scratch scratch;
  std::vector<unsigned char> pixels(7 * 5 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<unsigned char>(i * i % 251);
  PictureFile rows{7, 5, {"R", "G", "B"}};
  rows.paint = [&](std::size_t y, std::span<unsigned char> row) {
    std::copy_n(&pixels[y * row.size()], row.size(), row.begin());
  };
  savePicture({7, 5, {"R", "G", "B"}, pixels}, scratch / "whole.png");
  savePicture(rows, scratch / "rows.png");
  EXPECT_EQ(contents(scratch / "rows.png"), contents(scratch / "whole.png"));
  pixels[9] ^= 1;
  savePicture(rows, scratch / "other.png");
  EXPECT_NE(contents(scratch / "other.png"), contents(scratch / "whole.png"));
  rows.paint = [](std::size_t y, std::span<unsigned char>) {
    if (y == 3) throw std::runtime_error("no fourth row");
  };
  EXPECT_THROW(savePicture(rows, scratch / "half.png"), InputError);
  EXPECT_EQ(filesBelow(scratch.path), 3u);
}

TEST(PictureFilesIdentity, ChannelsMayLieApart) {
  const Scratch scratch;
  const std::vector<float> by_pixel{1, 10, 2, 20, 3, 30, 4, 40, 5, 50, 6, 60},  // 3 x 2
      by_line{1, 2, 3, 10, 20, 30, 4, 5, 6, 40, 50, 60},
      by_channel{1, 2, 3, 4, 5, 6, 10, 20, 30, 40, 50, 60};
  PictureFile picture{3, 2, {"A", "B"}, {}, by_pixel};
  savePicture(picture, scratch / "pixel.exr");
  picture.floats = by_line, picture.steps = {1, 6, 3};
  savePicture(picture, scratch / "line.exr");
  picture.floats = by_channel, picture.steps = {1, 3, 6};
  savePicture(picture, scratch / "channel.exr");
  EXPECT_EQ(contents(scratch / "line.exr"), contents(scratch / "pixel.exr"));
  EXPECT_EQ(contents(scratch / "channel.exr"), contents(scratch / "pixel.exr"));
  picture.steps = {1, 6, 3};  // the negative control
  savePicture(picture, scratch / "wrong.exr");
  EXPECT_NE(contents(scratch / "wrong.exr"), contents(scratch / "pixel.exr"));
}

TEST(PictureFilesIdentity, WidePicturesHaveFewerThreads) {
  EXPECT_EQ(threadsOfEXR(256, 12, 16), 16);
  EXPECT_EQ(threadsOfEXR(4096, 1600, 16), 1);
  EXPECT_EQ(memoryOfEXR(4096, 1600, 1), 3 * 16 * 4096 * 1600 * 4.0);
  const int threads = threadsOfEXR(20000, 32, 64);
  EXPECT_GT(threads, 1);
  EXPECT_LE(memoryOfEXR(20000, 32, threads), 1e9);
  EXPECT_GT(memoryOfEXR(20000, 32, threads + 1), 1e9);
}

// One of 2.2 gigabytes for sixteen rows ended the program by a signal.
TEST(PictureFilesIdentity, RowsThatOpenEXRCannotCountAreRefused) {
  const Scratch scratch;
  const std::vector<float> row(most_row_numbers_of_EXR + 1);
  EXPECT_THROW(savePicture({row.size(), 1, {"R"}, {}, row}, scratch / "x.exr"), InputError);
  EXPECT_EQ(filesBelow(scratch.path), 0u);
}

// PNG (ISO/IEC 15948): signature, then the chunk IHDR with width, height, bits a channel and colour type 2 for RGB.
TEST(PictureFilesPublished, PngBeginsAsItsStandardSays) {
  const Scratch scratch;
  savePicture(picture(), scratch / "deep/x.png");
  const std::string png = contents(scratch / "deep/x.png");
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png.substr(12, 4), "IHDR");
  EXPECT_EQ(bigEndian(png, 16), 5u);
  EXPECT_EQ(bigEndian(png, 20), 3u);
  EXPECT_EQ(png.substr(24, 2), std::string("\x08\x02"));
  EXPECT_EQ(filesBelow(scratch / "deep"), 1u);
}

// OpenEXR: magic number 20000630, little-endian; channels and attributes by name in the header.
TEST(PictureFilesPublished, ExrHoldsChannelsAndWords) {
  const Scratch scratch;
  const std::vector<float> floats{1, 2, 3, 4};
  savePicture(
      {2, 1, {"S0.450,000000nm", "S1.450,000000nm"}, {}, floats, {{"emissiveUnits", "W"}}},
      scratch / "x.exr");
  const std::string exr = contents(scratch / "x.exr");
  EXPECT_EQ(exr.substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_NE(exr.find("S1.450,000000nm"), std::string::npos);
  EXPECT_NE(exr.find("emissiveUnits"), std::string::npos);
  EXPECT_EQ(exr.find("S2.450,000000nm"), std::string::npos);  // negative control
  // no clock: OpenEXR's attribute for the date
  EXPECT_EQ(exr.find("capDate"), std::string::npos);
}

TEST(PictureFilesInvariant, WhatCannotBeWrittenLeavesNothingBehind) {
  const Scratch scratch;
  put(scratch / "file", "no directory");
  EXPECT_THROW(savePicture(picture(), scratch / "file/x.png"), InputError);
  EXPECT_THROW(savePicture(picture(), scratch / "x.nonsense"), MathError);
  EXPECT_THROW(savePicture(picture(), scratch / "x.exr"), MathError);  // bytes
  PictureFile small = picture();
  small.width = 6;
  EXPECT_THROW(savePicture(small, scratch / "x.png"), MathError);
  EXPECT_EQ(filesBelow(scratch.path), 1u);
  try {
    savePicture({1, 1, {"R"}, {}, std::vector<float>{1}}, scratch / "file/x.exr");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (scratch / "file/x.exr").string() +
                                ": cannot be written: Not a directory; choose a file in a "
                                "writable directory with free space");
  }
}
