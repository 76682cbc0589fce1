// The door through which numbers come and go (nw/base/Table.nw).
#include "malus/base/Table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

#include "Scratch.hpp"

using namespace malus;

namespace {
Table parsed(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "t.csv");
}

/// The sentence that a faulty table is answered with; "" when it is accepted.
std::string complaint(const std::string& text, const std::string& column = "") {
  try {
    const Table table = parsed(text);
    if (!column.empty()) table.column(column);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const std::string copper =
    "# title: Copper\n# source: a handbook,\n#   page "
    "12-95\nwavelength_nm,n,k\n590.40,0.47,2.81\n619.92,.27,3.24\n";
}  // namespace

TEST(TableIdentity, ReadsHeaderColumnsAndRows) {
  const Table table = parsed(copper);
  EXPECT_EQ(table.header("source"), "a handbook, page 12-95");
  EXPECT_EQ(table.header("uncertainty"), "");
  EXPECT_EQ(table.columns(), (std::vector<std::string>{"wavelength_nm", "n", "k"}));
  EXPECT_EQ(table.column("n"), (std::vector<double>{0.47, 0.27}));
  EXPECT_EQ(table.text("n"), (std::vector<std::string>{"0.47", ".27"}));
  EXPECT_EQ(table.cell(0, "wavelength_nm"), "590.40");
  EXPECT_EQ(table.number(1, "k"), 3.24);
  EXPECT_EQ(table.place(1, "k").line, 6);
  EXPECT_TRUE(table.has("k"));
  EXPECT_FALSE(table.has("K"));
}

TEST(TableIdentity, CarriageReturnsByteOrderMarkBlanksAndQuotesAreTolerated) {
  const Table table =
      parsed("\xEF\xBB\xBF# title: x\r\na , \"b, c\"\r\n\r\n +1 ,\"say \"\"no\"\"\" \r\n");
  EXPECT_EQ(table.columns(), (std::vector<std::string>{"a", "b, c"}));
  EXPECT_EQ(table.number(0, "a"), 1.0);
  EXPECT_EQ(table.cell(0, "b, c"), "say \"no\"");
  EXPECT_EQ(table.place(0, "a").line, 4);
}

TEST(TableIdentity, AnEmptyLastCellIsACell) {
  EXPECT_EQ(parsed("a,b\n1,\n").cell(0, "b"), "");
  EXPECT_EQ(complaint("a,b\n1,\n", "b"),
            "t.csv:2: b: the number is missing; write a number such as 0.2");
}

TEST(TableIdentity, AFaultIsNamedByLineAndColumn) {
  EXPECT_EQ(complaint("a,b\n1,2\n1,2x\n", "b"),
            "t.csv:3: b = 2x: is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(complaint("a\n0;5\n", "a"),
            "t.csv:2: a = 0;5: is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(complaint("a\n1e999\n", "a"),
            "t.csv:2: a = 1e999: is beyond the range of a double; stay within 1e-307..1e308");
  EXPECT_EQ(complaint("a,b\n1,2,3\n"),
            "t.csv:2: 3 cells: but line 1 names 2 columns; give one cell for each column");
  EXPECT_EQ(
      complaint("a,,c\n"),
      "t.csv:1: column 2 has no name; name every column, with its unit, e.g. theta_i_deg");
  EXPECT_EQ(complaint("a,b,a\n"),
            "t.csv:1: a: names two columns; give each column its own name");
  EXPECT_EQ(complaint("a\n\"1\n"),
            "t.csv:2: \"1: has no closing quote; close the quote in the same line");
  EXPECT_EQ(
      complaint("a\n\"1\"2\n"),
      "t.csv:2: 1: is followed by text after its closing quote; write a quote inside quotes "
      "twice, and a comma between cells");
  EXPECT_EQ(complaint("# title: nothing\n"),
            "t.csv: has no line of column names; begin with a line such as "
            "theta_i_deg,theta_r_deg,phi_deg");
  EXPECT_EQ(complaint("theta_deg,n\n1,2\n", "teta_deg"),
            "t.csv:1: teta_deg: is not among the columns; did you mean theta_deg? choose from: "
            "theta_deg, n");
}

TEST(TableIdentity, ASignIsNoNumber) {
  for (const std::string word : {"+", "-", "+-1", "++1", "."})
    EXPECT_EQ(
        complaint("a\n" + word + "\n", "a"),
        "t.csv:2: a = " + word + ": is not a number; write a number such as 0.2 or 1.5e-3");
  EXPECT_EQ(parsed("a\n+.5\n").number(0, "a"), 0.5);
}

TEST(TableIdentity, AMissingFileAndADirectoryCannotBeOpened) {
  EXPECT_THROW(Table::read("no/such/file.csv"), InputError);
  EXPECT_THROW(Table::read(std::filesystem::temp_directory_path()), InputError);
}

TEST(TableIdentity, NonFiniteNumbersAreRefusedUnlessAllowed) {
  for (const std::string word : {"nan", "inf", "-inf"}) {
    EXPECT_EQ(complaint("a\n" + word + "\n", "a"),
              "t.csv:2: a = " + word + ": is not a finite number; write a number such as 0.2");
    EXPECT_FALSE(std::isfinite(parsed("a\n" + word + "\n").column("a", NonFinite::allow)[0]));
  }
}

TEST(TableIdentity, NoLocaleChangesANumber) {
  // not every machine has this locale; without it the test still checks the C locale
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(parsed("a\n0.5\n").number(0, "a"), 0.5);
  EXPECT_EQ(TableCell(0.5).text(), "0.5");
  std::setlocale(LC_ALL, "C");
}

// The check value of CRC-32 (ISO 3309, ITU-T V.42): "123456789" -> cbf43926. A table's lines end in
// a line feed, which the value below includes: computed by zlib in Python, zlib.crc32(b"123456789\\n").
TEST(TablePublished, TheChecksumIsTheCRC32OfEverybodyElse) {
  EXPECT_NE(sealTable("123456789\n", "t.csv").find("# crc32: e0117757"), std::string::npos);
}

TEST(TableInvariant, ASealedTableIsReadAndAChangedOneIsNot) {
  const std::string sealed = sealTable(copper, "t.csv");
  EXPECT_NE(sealed.find("# rows: 2\n"), std::string::npos);
  EXPECT_EQ(complaint(sealed), "");
  EXPECT_EQ(sealTable(sealed, "t.csv"), sealed);
  EXPECT_TRUE(sealed.starts_with("# title: Copper\n# source: a handbook,\n#   page 12-95\n"));
  EXPECT_TRUE(sealed.ends_with(copper.substr(copper.find("wavelength_nm"))));
  std::string windows;
  for (const char letter : sealed) windows += letter == '\n' ? "\r\n" : std::string(1, letter);
  EXPECT_EQ(complaint(windows), "");
}

TEST(TableInvariant, NegativeControlOneDigitOrOneRowBreaksTheSeal) {
  std::string changed = sealTable(copper, "t.csv");
  changed.replace(changed.find("2.81"), 4, "2.18");
  EXPECT_NE(complaint(changed).find("crc32"), std::string::npos);
  std::string shorter = sealTable(copper, "t.csv");
  shorter.resize(shorter.find("619.92"));
  EXPECT_NE(complaint(shorter).find("rows = 2: but the table holds 1 rows"), std::string::npos);
}

RC_GTEST_PROP(TableInvariant, EveryDoubleComesBackBitForBit, ()) {
  const double value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  TableWriter writer({"a"});
  writer.row({value});
  const double back = parsed(writer.text()).number(0, "a", NonFinite::allow);
  if (std::isnan(value))
    RC_ASSERT(std::isnan(back));
  else
    RC_ASSERT(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(value));
}

RC_GTEST_PROP(TableInvariant, EveryTextOfOneLineComesBack, ()) {
  const auto text =
      *rc::gen::container<std::string>(rc::gen::elementOf(std::string("a ,\"#;x")));
  TableWriter writer({"a", "b"});
  writer.row({text, 1});
  RC_ASSERT(parsed(writer.text()).cell(0, "a") == text);
}

TEST(TableIdentity, TheWriterChecksWidthAndMixesNumbersAndText) {
  TableWriter writer({"id", "value"});
  writer.header("title", "t").row({"x, y", 0.1}).row({"z", 3});
  writer.row(std::vector<double>{1, 2});
  EXPECT_EQ(writer.text(), "# title: t\nid,value\n\"x, y\",0.10000000000000001\nz,3\n1,2\n");
  EXPECT_EQ(writer.rows(), 3u);
  EXPECT_THROW(writer.row({1.0}), MathError);
  EXPECT_THROW(writer.row({"two\nlines", 1}), MathError);
}

TEST(TableInvariant, AFileIsWrittenWholeOrNotAtAll) {
  const auto directory =
      std::filesystem::temp_directory_path() / ("Table_test" + std::to_string(::getpid()));
  TableWriter writer({"a"});
  writer.row({1.0}).save(directory / "deep" / "t.csv");
  EXPECT_EQ(Table::read(directory / "deep" / "t.csv").number(0, "a"), 1.0);
  EXPECT_THROW(writer.save(directory / "deep"), InputError);  // a directory has this name
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 1u);
  std::filesystem::remove_all(directory);
}

// Only regular files are replaced: behind a link the file is, and a pipe takes the text and
// stays a pipe.
TEST(TableInvariant, LinksAndPipesStayWhatTheyAre) {
  const Scratch scratch;
  put(scratch / "file", "old\n");
  std::filesystem::create_symlink(scratch / "file", scratch / "link");
  writeWhole(scratch / "link", "new\n");
  EXPECT_TRUE(std::filesystem::is_symlink(scratch / "link"));
  EXPECT_EQ(contents(scratch / "file"), "new\n");
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = contents(scratch / "pipe"); });
  writeWhole(scratch / "pipe", "through\n");
  reader.join();
  EXPECT_EQ(read, "through\n");
  EXPECT_TRUE(std::filesystem::is_fifo(scratch / "pipe"));
  EXPECT_EQ(filesBelow(scratch.path), 2u);  // the file and the link to it: nothing is left over
}
