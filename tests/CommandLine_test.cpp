// The program malus from outside: exit codes, the one line of bad input, files left behind
// (nw/app/CommandLine.nw, CommandReproduce.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "Program.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
const std::filesystem::path source_data = MALUS_SOURCE_DATA;

/// A copy of the committed validation directory, to be corrupted.
struct Copy : Scratch {
  Copy() {
    std::filesystem::copy(source_data, path / "validation",
                          std::filesystem::copy_options::recursive);
  }
  Outcome run(const std::string& arguments) const {
    return malusIn(path, arguments, "MALUS_DATA=" + (path / "validation").string());
  }
};

void replaceIn(const std::filesystem::path& file, const std::string& from,
               const std::string& to) {
  std::string text = contents(file);
  ASSERT_NE(text.find(from), std::string::npos) << file;
  put(file, text.replace(text.find(from), from.size(), to));
}
}  // namespace

TEST(CommandLineIdentity, HelpVersionAndNoArguments) {
  const Scratch scratch;
  EXPECT_EQ(malusIn(scratch.path, "--version").out, "malus " MALUS_VERSION "\n");
  const Outcome help = malusIn(scratch.path, "--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_EQ(malusIn(scratch.path, "").out, help.out);
  for (const std::string command : {"reproduce", "brdf", "table"}) {
    EXPECT_NE(help.out.find(command), std::string::npos);
    const Outcome own = malusIn(scratch.path, command + " --help");
    EXPECT_EQ(own.code, 0);
    EXPECT_NE(own.out.find("Examples:\n  malus " + command), std::string::npos) << own.out;
  }
}

TEST(CommandLineIdentity, BadInputIsOneLineAndLeavesNothing) {
  const Scratch scratch;
  const std::pair<std::string, std::string> cases[] = {
      {"reprodce",
       "command line: command = reprodce: is not a command of malus; did you mean reproduce? "
       "choose from: "
       "reproduce, brdf, fit, sun, sky, mie, render, merge, products, info, schema, table\n"},
      {"reproduce F3.99",
       "command line: ID = F3.99: is not in the inventory; did you mean F3.9? malus reproduce "
       "--list shows all\n"},
      {"reproduce --lst",
       "command line: --lst: is not an option of malus reproduce; did you mean --list? choose "
       "from: "
       "--help, "
       "--list, --out, --json, --update-verdicts\n"},
      {"sun --lat 43 --longitude-deg -77.61",
       "command line: --lat: is now called --latitude-deg; write --latitude-deg\n"},
      {"sun -latitude-deg 43 --longitude-deg -77.61",
       "command line: -latitude-deg: is not an option of malus sun; did you mean "
       "--latitude-deg? "
       "choose from: --help, "
       "--latitude-deg, "
       "--longitude-deg, --time, --until, --step-min, --input, --out\n"},
      {"--vesion",
       "command line: --vesion: is not an option of malus; did you mean --version? choose "
       "from: "
       "--help, --version, --describe\n"},
      {"schema surplus",
       "command line: The following argument was not expected: surplus; malus schema --help "
       "shows the options\n"},
      {"info ''",
       "command line: FILE: must not be empty; malus info --help shows the options\n"},
      {"table none.csv", "none.csv: does not exist; give the name of a readable CSV file\n"},
      {"table --write-checksum none.csv",
       "none.csv: does not exist; give the name of a readable CSV file\n"}};
  for (const auto& [arguments, line] : cases) {
    const Outcome outcome = malusIn(scratch.path, arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.err, line) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
    EXPECT_EQ(filesBelow(scratch.path), 0u) << arguments;
  }
}

// An ID of the inventory without a function.
TEST(CommandLineIdentity, WhatIsNotYetBuiltIsSaidSo) {
  const Copy copy;
  const auto inventory = copy / "validation" / "inventory.csv";
  put(inventory, contents(inventory) + "F9.9,figure,A figure of no chapter,nowhere\n");
  const Outcome outcome = copy.run("reproduce F9.9 --out out");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(
      outcome.err,
      "command line: ID = F9.9: is not yet built; malus reproduce --list shows what is\n");
  EXPECT_FALSE(std::filesystem::exists(copy / "out"));
}

TEST(ReproduceIdentity, AFileIsNoOutputDirectory) {
  const Scratch scratch;
  put(scratch / "file", "precious\n");
  for (const std::string out : {"file", "file/below"}) {
    const Outcome outcome = malusIn(scratch.path, "reproduce T3.1 --out " + out);
    EXPECT_EQ(outcome.code, 2) << out;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("command line: --out = " + out + ": ")) << outcome.err;
  }
  EXPECT_EQ(contents(scratch / "file"), "precious\n");
  EXPECT_EQ(filesBelow(scratch.path), 1u);
}

TEST(CommandLineIdentity, TheDataDirectoryMustBeOne) {
  const Scratch scratch;
  const Outcome outcome =
      malusIn(scratch.path, "reproduce --list", "MALUS_DATA=/no/such/place");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "environment: MALUS_DATA = /no/such/place: is not a directory; give the directory "
            "validation of malus's source\n");
}

TEST(CommandLineIdentity, ATableIsCheckedAndSealed) {
  const Scratch scratch;
  put(scratch / "t.csv", "a,b\n1,2\n");
  EXPECT_EQ(malusIn(scratch.path, "table t.csv").out, "t.csv: 1 rows of a, b\n");
  EXPECT_EQ(malusIn(scratch.path, "table --write-checksum t.csv").code, 0);
  EXPECT_NE(contents(scratch / "t.csv").find("# crc32: "), std::string::npos);
  replaceIn(scratch / "t.csv", "1,2", "1,3");
  const Outcome outcome = malusIn(scratch.path, "table t.csv");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("t.csv: crc32 = "), std::string::npos) << outcome.err;
}

// The IDs of the thesis: its tables, the figures from formulas and of scenes, the claims, and our eleven findings.
TEST(CommandLineIdentity, TheListHoldsEveryId) {
  std::set<std::string> expected{"T3.1", "T3.2", "T3.3", "T6.1", "E6.1", "T7.1", "T7.2",
                                 "T7.3", "T7.4", "T7.5", "A.2",  "F3.1", "F3.2", "F3.3",
                                 "F3.4", "F3.7", "F3.9", "F5.1", "F5.5", "F5.6", "F6.3"};
  for (int i = 1; i <= 44; ++i) expected.insert(fmt::format("F7.{}", i));
  for (int i = 1; i <= 7; ++i) expected.insert(fmt::format("C{}", i));
  for (int i = 1; i <= 11; ++i) expected.insert(fmt::format("N{}", i));
  const Scratch scratch;
  std::istringstream lines(malusIn(scratch.path, "reproduce --list").out);
  std::set<std::string> listed;
  std::string line;
  while (std::getline(lines, line)) {
    const std::string id = line.substr(0, line.find(' '));
    EXPECT_TRUE(listed.insert(id).second) << id << " is listed twice";
    EXPECT_TRUE(expected.erase(id) == 1 || id.starts_with("X.")) << id;
    EXPECT_TRUE(line.find("built") != std::string::npos) << line;
  }
  EXPECT_TRUE(expected.empty()) << *expected.begin() << " is not listed";
  EXPECT_EQ(filesBelow(scratch.path), 0u);
}

// A partial run, with numbers, tables and a picture; the report of all items has no other writer.
TEST(ReproduceInvariant, TwoRunsLeaveTheSameBytes) {
  const Scratch scratch;
  const auto report = [&](const std::string& out) {
    EXPECT_EQ(malusIn(scratch.path, "reproduce E6.1 F3.9 --out " + out).code, 0);
    return contents(scratch / out / "partial.json") +
           contents(scratch / out / "F3.9" / "fresnel.csv") +
           contents(scratch / out / "F3.9" / "fresnel.svg");
  };
  const std::string one = report("one");
  EXPECT_GT(one.size(), 10000u);
  EXPECT_EQ(one, report("two"));
}

TEST(ReproduceInvariant, NegativeControlACorruptedVerdictMakesTheRunFail) {
  const Copy copy;
  replaceIn(copy / "validation" / "claims.csv", "T3.1,S1.positive,thesis,choice,reproduced",
            "T3.1,S1.positive,thesis,choice,differs");
  const Outcome outcome = copy.run("reproduce T3.1 --out out");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("CHANGED T3.1 S1.positive: committed differs, now reproduced\n"),
            std::string::npos)
      << outcome.out;
  EXPECT_EQ(copy.run("reproduce F3.9 --out out").code,
            0);  // a partial run looks only at its own items
  EXPECT_EQ(copy.run("reproduce T3.1 --update-verdicts --out out").code, 0);
  EXPECT_EQ(contents(copy / "validation" / "claims.csv"), contents(source_data / "claims.csv"));
}

// First the checksum notices; then the corrupted number is sealed, and the verdict notices.
TEST(ReproduceInvariant, NegativeControlACorruptedPrintedValueMakesTheRunFail) {
  const Copy copy;
  const auto printed = copy / "validation" / "printed" / "E6.1-radiance.csv";
  replaceIn(printed, "9.600", "9.700");
  const Outcome broken_seal = copy.run("reproduce E6.1 --out out");
  EXPECT_EQ(broken_seal.code, 1);
  EXPECT_NE(broken_seal.out.find("FAILED E6.1: "), std::string::npos) << broken_seal.out;
  EXPECT_EQ(copy.run("table --write-checksum '" + printed.string() + "'").code, 0);
  const Outcome outcome = copy.run("reproduce E6.1 --out out");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("CHANGED E6.1"), std::string::npos) << outcome.out;
}

TEST(ReproduceInvariant, JsonOnTheStreamIsTheReport) {
  const Copy copy;
  const Outcome outcome = copy.run("reproduce E6.1 --json --out out");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, contents(copy / "out" / "partial.json"));
  EXPECT_EQ(copy.run("reproduce E6.1 --out out").out, contents(copy / "out" / "partial.txt"));
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["items"][0]["id"], "E6.1");
  EXPECT_FALSE(std::filesystem::exists(copy / "out" / "values.tex"));
}
