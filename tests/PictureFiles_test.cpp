// Pictures of other people's formats, looked at with nothing but the definitions of these formats.
#include "malus/files/PictureFiles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

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
                                ": cannot be written: Not a directory; name a file in a "
                                "directory with room that you may write to");
  }
}
