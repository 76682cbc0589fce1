// Opening, sizes and names of files that come from others (nw/base/InputFiles.nw), and the spelling
// of their letters (nw/base/Error.nw).
#include "malus/base/InputFiles.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>

#include <string>
#include <vector>

#include "Scratch.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
template <class Do>
std::string complaint(const Do& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Every letter of Unicode, written by the table of RFC 3629 and not by arithmetic of the reader.
std::string encoded(std::uint32_t letter) {
  const auto byte = [](std::uint32_t bits) { return static_cast<char>(bits); };
  if (letter < 0x80) return {byte(letter)};
  const char last = byte(0x80 | (letter % 64));
  if (letter < 0x800) return {byte(0xC0 | (letter / 64)), last};
  const char third = byte(0x80 | (letter / 64 % 64));
  if (letter < 0x10000) return {byte(0xE0 | (letter / 4096)), third, last};
  return {byte(0xF0 | (letter / 262144)), byte(0x80 | (letter / 4096 % 64)), third, last};
}
}  // namespace

TEST(InputFilesIdentity, OnlyRegularFilesAreOpened) {
  const Scratch scratch;
  put(scratch / "a.csv", "n\n1\n");
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink(scratch / "a.csv", scratch / "link");
  std::filesystem::create_symlink(scratch / "loop", scratch / "loop");
  const auto why = [&](const std::string& name) { return whyNoInput(scratch / name); };
  EXPECT_EQ(why("a.csv"), "");
  EXPECT_EQ(why("link"), "");
  EXPECT_EQ(why("none"), "does not exist");
  EXPECT_EQ(why(""), "is a directory");
  EXPECT_EQ(why("pipe"), "is a pipe, a device or a socket, and not a regular file");
  EXPECT_EQ(whyNoInput("/dev/zero"), why("pipe"));
  EXPECT_TRUE(why("loop").starts_with("cannot be examined")) << why("loop");
  EXPECT_TRUE(why(std::string(5000, 'x')).starts_with("cannot be examined"));
  // a pipe without a writer would block a reader forever
  EXPECT_NE(complaint([&] { Table::read(scratch / "pipe"); }).find("is a pipe"),
            std::string::npos);
}

TEST(InputFilesIdentity, ATextIsReadWholeAndUpToItsLimit) {
  const Scratch scratch;
  put(scratch / "t", std::string("a\0b\r\n", 5));
  EXPECT_EQ(readWhole(scratch / "t", "x"), std::string("a\0b\r\n", 5));
  EXPECT_EQ(readWhole(scratch / "t", "x", 5).size(), 5u);
  EXPECT_NE(complaint([&] {
              readWhole(scratch / "t", "give a short one", 4);
            }).find("t: 5 bytes: is longer than 4 bytes; give a short one"),
            std::string::npos);
}

RC_GTEST_PROP(InputFilesIdentity, ProductsAreThoseOfWiderIntegers, ()) {
  std::vector<std::uint64_t> factors;
  const int count = *rc::gen::inRange(0, 5);
  for (int i = 0; i < count; ++i) {
    const auto bits = *rc::gen::inRange(0, 64);
    factors.push_back(*rc::gen::arbitrary<std::uint64_t>() >> bits);
  }
  const auto bound = *rc::gen::arbitrary<std::uint64_t>() >> *rc::gen::inRange(0, 64);
  __extension__ using Wide = unsigned __int128;
  Wide product = 1;
  bool beyond = false;
  for (const std::uint64_t factor : factors) {
    product *= factor;
    beyond = beyond || product > ~std::uint64_t{0};
    if (product > ~std::uint64_t{0}) product = Wide(1) << 64;  // stays beyond, whatever follows
    if (factor == 0) product = 0;
  }
  if (std::find(factors.begin(), factors.end(), std::uint64_t{0}) != factors.end()) product = 0;
  const auto made = productWithin(bound, factors);
  RC_ASSERT(made.has_value() == (product <= bound));
  if (made) RC_ASSERT(Wide(*made) == product);
}

TEST(InputFilesIdentity, NegativeControlAWrappedProductLooksSmall) {
  const std::vector<std::uint64_t> factors{std::uint64_t{1} << 33, std::uint64_t{1} << 31};
  EXPECT_EQ(factors[0] * factors[1],
            0u);  // the memory that a reader without checks would allocate
  EXPECT_FALSE(productWithin(1000, factors));
  EXPECT_EQ(productWithin(100, std::vector<std::uint64_t>{5, 20}), 100u);
  EXPECT_FALSE(productWithin(100, std::vector<std::uint64_t>{5, 21}));
}

TEST(InputFilesIdentity, EveryLetterOfUnicodeIsUTF8AndSurrogatesAreNot) {
  for (std::uint32_t letter = 0; letter <= 0x10FFFF; ++letter) {
    const bool surrogate = letter >= 0xD800 && letter <= 0xDFFF;
    ASSERT_EQ(endOfUTF8(encoded(letter)) == std::string::npos, !surrogate) << letter;
  }
}

TEST(InputFilesIdentity, MalformedSequencesEndWhereTheyBegin) {
  // beyond Unicode, longer than needed, cut short, a stray second byte, Latin-1
  for (const std::string bad :
       {"\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xC0\xAF", "\xC1\xBF", "\xE0\x9F\xBF",
        "\xF0\x8F\xBF\xBF", "\xE2\x82", "\x80", "\xFF", "\xFE", "\xE9"}) {
    EXPECT_EQ(endOfUTF8(bad), 0u);
    EXPECT_EQ(endOfUTF8("ab" + bad), 2u);
    EXPECT_EQ(endOfUTF8("\u00e9" + bad + "z"), 2u);
  }
}

TEST(InputFilesIdentity, NamesAreUTF8WithoutControlCharactersAndOfALine) {
  const InputPlace place{"m.obj", 3, "g"};
  const auto said = [&](const std::string& name) {
    return complaint([&] { requireName(name, place); });
  };
  EXPECT_EQ(said("Stra\u00dfe.001"), "accepted");
  EXPECT_EQ(said("Stra\xdf"
                 "e"),
            "m.obj:3: g = Stra\\xdfe: is not UTF-8 at byte 5 (0xdf); save it as UTF-8, or use "
            "ASCII letters");
  EXPECT_EQ(said("a\nb"),
            "m.obj:3: g = a\\nb: contains a control character; use letters, digits, spaces and "
            "punctuation");
  EXPECT_EQ(said(std::string(1000, 'x')), "accepted");
  EXPECT_NE(said(std::string(1001, 'x')).find("is longer than 1000 bytes"), std::string::npos);
}

TEST(InputFilesIdentity, ALongValueIsCutBetweenLettersAndEveryMessageIsUTF8) {
  const std::string long_value(10'000'000, '7');
  const std::string message =
      InputError({"f", 1, long_value}, long_value, long_value, "r").what();
  EXPECT_LT(message.size(), 3000u);
  for (std::size_t shift = 0; shift < 4; ++shift) {
    std::string letters(shift, 'a');
    for (int i = 0; i < 300; ++i) letters += "\U0001F30D";
    const std::string what = InputError({"f", 1, "k"}, letters, "is bad", "mend it").what();
    EXPECT_EQ(endOfUTF8(what), std::string::npos);
    EXPECT_EQ(what.find("\\x"), std::string::npos) << what;
    EXPECT_NE(what.find("...: is bad"), std::string::npos);
  }
}

TEST(InputFilesIdentity, AHundredThousandNamesAreNotAllListed) {
  std::vector<std::string> known;
  for (int i = 0; i < 100'000; ++i) known.push_back("facet-" + std::to_string(i));
  const std::string said = didYouMean("facet-4711x", known);
  EXPECT_TRUE(said.starts_with("did you mean facet-4711? choose from: facet-0, facet-1, "));
  EXPECT_TRUE(said.ends_with(", facet-99, ... (100000 in all)"));
  EXPECT_EQ(didYouMean(std::string(10'000'000, 'x'), known).find("did you"), std::string::npos);
}
