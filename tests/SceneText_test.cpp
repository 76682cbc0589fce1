// The positions of the values of a scene file, and the messages for a broken one
// (nw/files/SceneText.nw, nw/base/Refusal.nw).
#include "malus/files/SceneText.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

using namespace malus;

namespace {
/// Writes a random JSON text with blanks and comments between all tokens, and notes each value's line and column.
/// RapidCheck gives the seed alone: its own ranges are so small at first that hardly any tree would have a branch.
struct Writer {
  explicit Writer(std::uint32_t seed) : random(seed) {}
  std::mt19937 random;
  int pick(int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low));
  }
  const std::string& oneOf(const std::vector<std::string>& words) {
    return words[static_cast<std::size_t>(pick(0, static_cast<int>(words.size())))];
  }

  std::string text;
  int line = 1, column = 1;
  std::map<std::string, std::pair<int, int>> places;

  void write(const std::string& part) {
    for (const char letter : part) {
      text += letter;
      if (letter == '\n')
        ++line, column = 1;
      else if ((static_cast<unsigned char>(letter) & 0xC0) != 0x80)
        ++column;
    }
  }
  void gap() {
    static const std::vector<std::string> gaps{"",
                                               "",
                                               " ",
                                               "\n",
                                               "\t \r\n",
                                               "// note: {\"a\", 1}\n",
                                               "/* 1, [2]\n \"x */",
                                               "/**/",
                                               " // \"\n  "};
    write(oneOf(gaps));
  }
  void value(const std::string& path, int depth) {
    gap();
    places[path] = {line, column};
    const int kind = depth == 0 ? 5 : pick(0, depth > 3 ? 4 : 6);
    static const std::vector<std::string> leaves{"true", "null", "-12.5e+3",
                                                 "7",    "0.25", "false"};
    static const std::vector<std::string> texts{"\"\"", "\"a\\\"b\"", "\"\\\\\"", "\"{//\"",
                                                "\"\u00e9t\u00e9\""};
    if (kind < 2)
      write(oneOf(leaves));
    else if (kind < 4)
      write(oneOf(texts));
    else if (kind == 4)
      list(path, depth);
    else
      object(path, depth);
    gap();
  }
  void list(const std::string& path, int depth) {
    write("[");
    gap();
    const int size = pick(0, 4);
    for (int i = 0; i < size; ++i) {
      if (i > 0) write(",");
      value(path + '[' + std::to_string(i) + ']', depth + 1);
    }
    write("]");
  }
  void object(const std::string& path, int depth) {
    write("{");
    gap();
    const int size = pick(0, 4);
    for (int i = 0; i < size; ++i) {
      if (i > 0) write(",");
      gap();
      const std::string key = "key-" + std::to_string(i);
      write('"' + key + '"');
      gap();
      write(":");
      value(path.empty() ? key : path + '.' + key, depth + 1);
    }
    write("}");
  }
};

std::string complaint(const std::string& text) {
  try {
    const SceneText read(text, "s.json", ".");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
bool begins(const std::string& text, const std::string& beginning) {
  return text.starts_with(beginning);
}
}  // namespace

RC_GTEST_PROP(SceneTextIdentity, EveryValueStandsWhereItsWriterPutIt, ()) {
  Writer writer(*rc::gen::arbitrary<std::uint32_t>());
  writer.value("", 0);
  const SceneText text(writer.text, "s.json", ".");
  for (const auto& [path, place] : writer.places) {
    const InputPlace found = text.place(path);
    RC_ASSERT(std::pair(found.line, found.column) == place);
  }
}

TEST(SceneTextIdentity, TheRandomTreesHaveBranches) {
  std::size_t places = 0;
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Writer writer(seed);
    writer.value("", 0);
    places += writer.places.size();
  }
  EXPECT_GT(places, 300u);  // else the test above looks at nothing
}

TEST(SceneTextIdentity, NegativeControlAShiftedTextHasOtherPlaces) {
  const SceneText text("{\"a\": 1}", "s.json", "."), shifted(" {\"a\": 1}", "s.json", ".");
  EXPECT_EQ(text.place("a").column, 7);
  EXPECT_NE(shifted.place("a").column, text.place("a").column);
}

TEST(SceneTextIdentity, ANodeComplainsWithItsPlacePathAndValue) {
  const SceneText text("{\n  \"sun\": {\"zenith deg\": [1, -2]}\n}", "s.json", ".");
  const SceneNode node = text.root()["sun"]["zenith deg"][1];
  EXPECT_EQ(std::string(node.error("is negative", "give another").what()),
            "s.json:2:29: sun[\"zenith deg\"][1] = -2: is negative; give another");
}

TEST(SceneTextIdentity, BrokenTextsAreAnsweredWithLineAndColumn) {
  EXPECT_TRUE(begins(complaint("{\n \"a\": tru\n}"), "s.json:2:"))
      << complaint("{\n \"a\": tru\n}");
  EXPECT_TRUE(
      begins(complaint("{\"a\": 1,}"), "s.json:1:9: is not valid JSON: unexpected '}'"));
  EXPECT_TRUE(begins(complaint(""), "s.json:1:1: is not valid JSON: unexpected end of input"));
  EXPECT_TRUE(
      begins(complaint("{\"a\": 1e999}"), "s.json:1:11: is not valid JSON: number overflow"))
      << complaint("{\"a\": 1e999}");
  EXPECT_TRUE(begins(complaint("{\"a\": NaN}"), "s.json:1:"));
  EXPECT_TRUE(begins(complaint("{\"a\": 1} x"), "s.json:1:"));
  EXPECT_TRUE(begins(complaint("{\"a\": 1 /* no end"), "s.json:1:"));
  EXPECT_TRUE(begins(complaint("{\"a\": \"\xff\"}"), "s.json:1:"));
  EXPECT_EQ(complaint("{} // fine"), "accepted");
}

TEST(SceneTextIdentity, AKeyThatComesTwiceIsRefusedWhereItComesAgain) {
  EXPECT_TRUE(
      begins(complaint("{\"a\": 1,\n  \"a\": 2}"), "s.json:2:3: has the key \"a\" twice"));
  EXPECT_EQ(complaint("{\"a\": {\"a\": 2}}"), "accepted");
}

TEST(SceneTextIdentity, TextsAreLinesAndNotBooks) {
  EXPECT_TRUE(begins(complaint("{\n \"title\": \"a\\nb\"}"),
                     "s.json:2:11: has a control character in a text; write letters"))
      << complaint("{\n \"title\": \"a\\nb\"}");
  EXPECT_TRUE(begins(complaint("{\"a\\u0000b\": 1}"), "s.json:1:2: has a control character"));
  EXPECT_TRUE(
      begins(complaint("{\"a\": \"" + std::string(1001, 'x') + "\"}"),
             "s.json:1:7: has a text of 1001 bytes, more than 1000; give a shorter one"));
  EXPECT_EQ(complaint("{\"a\": \"" + std::string(1000, 'x') + "\"}"), "accepted");
  for (const std::string& text : {"{\"" + std::string(10'000'000, 'k') + "\": 1}",
                                  "{\"a\": 1" + std::string(10'000'000, '0') + "}",
                                  "{\"a\": " + std::string(10'000'000, 'x') + "}"}) {
    EXPECT_TRUE(begins(complaint(text), "s.json:1:")) << complaint(text).substr(0, 300);
    EXPECT_LT(complaint(text).size(), 500u);
  }
}

TEST(SceneTextIdentity, AMistakeInAFileSaysWhoNamedTheFile) {
  const SceneText text("{\n  \"file\": \"x.csv\"}", "s.json", ".");
  const SceneNode node = text.root()["file"];
  const auto said = [&](const InputPlace& place) {
    try {
      inFileOf(node, [&] { throw InputError(place, "7", "is bad", "mend it"); });
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(said({"x.csv", 3, "n"}),
            "x.csv:3: n = 7: is bad; mend it; the file is named at s.json:2:11: file");
  EXPECT_EQ(said({"s.json", 3, "n"}), "s.json:3: n = 7: is bad; mend it");
}

TEST(SceneTextIdentity, NestingBeyondUseIsRefused) {
  EXPECT_TRUE(begins(complaint(std::string(100000, '[')), "s.json:1:33: is nested too deeply"));
  EXPECT_EQ(complaint(std::string(30, '[') + std::string(30, ']')), "accepted");
}

TEST(SceneTextIdentity, APatchChangesValuesAndKeepsPlaces) {
  SceneText text("{\"radiometry\": {\"rays\": [91, 1], \"seed\": 3}}", "s.json", ".");
  text.patch("{\"radiometry\": {\"rays\": [46], \"seed\": null, \"sampling\": \"grid\"}}");
  const SceneNode node = text.root()["radiometry"];
  EXPECT_EQ(node["rays"].numbers(), std::vector<double>{46});
  EXPECT_FALSE(node.has("seed"));
  EXPECT_EQ(node["rays"].place().column, 25);
  EXPECT_EQ(node["sampling"].place().column, 16);  // nearest value around it
}

TEST(SceneTextIdentity, AKeyThatOnlyAPatchHasStandsWhereTheSceneBegins) {
  SceneText text("{\"radiometry\": {}}", "s.json", ".");
  text.patch("{\"sensr\": {\"width\": 3}, \"radiometry\": {\"seed\": 1}}");
  EXPECT_EQ(text.root()["sensr"].place().column,
            1);  // a name without a dot has no parent but the root
  EXPECT_EQ(text.root().keyPlace("sensr").column, 1);
  EXPECT_EQ(text.root()["radiometry"]["seed"].place().column, 16);  // negative control
}
