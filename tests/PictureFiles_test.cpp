// Pictures of other people's formats, looked at with nothing but the definitions of these formats.
#include "malus/files/PictureFiles.hpp"

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

// The promise of the chapter. Each test is a process of its own under ctest; in one run of all, this one comes first.
TEST(PictureFilesIdentity, ALibraryIsLoadedWithTheFirstPicture) {
  const Scratch scratch;
  EXPECT_TRUE(isLoaded("libc.so"));  // the list works
  EXPECT_FALSE(isLoaded("libOpenImageIO"));
  savePicture(picture(), scratch / "x.png");
  EXPECT_TRUE(isLoaded("libOpenImageIO"));
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
  // no clock: OpenEXR's attribute for the date, which OpenImageIO would add
  EXPECT_EQ(exr.find("capDate"), std::string::npos);
}

TEST(PictureFilesInvariant, WhatCannotBeWrittenLeavesNothingBehind) {
  const Scratch scratch;
  put(scratch / "file", "no directory");
  EXPECT_THROW(savePicture(picture(), scratch / "file/x.png"), InputError);
  EXPECT_THROW(savePicture(picture(), scratch / "x.nonsense"), InputError);
  PictureFile small = picture();
  small.width = 6;
  EXPECT_THROW(savePicture(small, scratch / "x.png"), MathError);
  EXPECT_EQ(filesBelow(scratch.path), 1u);
  try {
    savePicture(picture(), scratch / "x.nonsense");
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("x.nonsense"), std::string::npos);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}
