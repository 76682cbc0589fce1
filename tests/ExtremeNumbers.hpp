// Every numeric flag of a command at extreme numbers (nw/app/Command*.nw): the result is finite, or
// one line with exit code 2 and nothing else. Include after Program.hpp.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "Program.hpp"
#include "malus/base/Table.hpp"

inline const std::vector<std::string>& extremeNumbers() {
  static const std::vector<std::string> all{
      "0",     "-0",   "5e-324", "1e-310", "1e-300",
      "1e-16", "1e16", "1e300",  "1e308",  "1e309",
      "-1",    "nan",  "inf",    "-inf",   "18446744073709551615"};
  return all;
}

/// `question` without the flag, which is given in turn each of the numbers above.
inline void expectFiniteOrRefused(const std::filesystem::path& directory,
                                  const std::string& question, const std::string& flag) {
  int answered = 0;
  for (const std::string& number : extremeNumbers()) {
    const Outcome outcome = malusIn(directory, question + " " + flag + "=" + number);
    SCOPED_TRACE(question + " " + flag + "=" + number + "\n" + outcome.out.substr(0, 2000) +
                 outcome.err);
    if (outcome.code == 0) {
      ++answered;
      std::istringstream stream(outcome.out);
      const malus::Table table = malus::Table::parse(stream, "answer");
      for (std::size_t row = 0; row < table.rows(); ++row)
        for (const std::string& column : table.columns()) {
          std::string cell = table.cell(row, column);
          std::transform(cell.begin(), cell.end(), cell.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
          EXPECT_TRUE(cell != "nan" && cell != "-nan" && cell != "inf" && cell != "-inf")
              << column;
        }
      EXPECT_GT(table.rows(), 0u);
      continue;
    }
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
    EXPECT_NE(outcome.err.find(flag), std::string::npos);
  }
  EXPECT_LT(answered,
            static_cast<int>(extremeNumbers().size()));  // nan and inf are not numbers
}
