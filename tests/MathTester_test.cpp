// The tester of appendix A is itself tested here (nw/light/MathTester.nw,
// nw/app/mathtester.nw).
#include "malus/light/MathTester.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

using namespace malus;

namespace {
// The numbers of a result: one for an unpolarised value, four or sixteen otherwise.
std::vector<double> carried(const MathValue& value) {
  if (const auto* s = std::get_if<CDStokesVector>(&value))
    return {s->data(), s->data() + (s->isPolarized() ? 4 : 1)};
  if (const auto* m = std::get_if<CDMuellerMatrix>(&value))
    return {m->data(), m->data() + (m->isPolarized() ? 16 : 1)};
  return {};
}

// The rule of section A.1: no two elements equal, no zeros.
bool obeysTheRule(const std::vector<double>& numbers) {
  return std::set<double>(numbers.begin(), numbers.end()).size() == numbers.size() &&
         std::count(numbers.begin(), numbers.end(), 0.0) == 0;
}

// ------------------------------------------------ plain algebra: 1, 4 or 16 extended doubles
struct Plain {
  char kind;  // f, s or m
  std::array<long double, 16> v{};
};

Plain plain(const MathValue& value) {
  if (const auto* f = std::get_if<double>(&value)) return {'f', {*f}};
  const bool vector = std::holds_alternative<CDStokesVector>(value);
  const std::vector<double> all = carried(value);
  Plain p{vector ? 's' : 'm'};
  if (!vector && all.size() == 1)
    for (int i = 0; i < 16; i += 5) p.v[i] = all[0];
  else
    std::copy(all.begin(), all.end(), p.v.begin());
  return p;
}

Plain compute(const Plain& a, char sign, const Plain& b) {
  Plain r{a.kind == 'f' ? b.kind : a.kind};
  if (sign == '+' || sign == '-') {
    for (int i = 0; i < 16; ++i) r.v[i] = sign == '+' ? a.v[i] + b.v[i] : a.v[i] - b.v[i];
  } else if (a.kind == 'f' || b.kind == 'f') {
    const Plain& whole = a.kind == 'f' ? b : a;
    const long double factor = (a.kind == 'f' ? a : b).v[0];
    for (int i = 0; i < 16; ++i)
      r.v[i] = sign == '*' ? whole.v[i] * factor : whole.v[i] / factor;
  } else {
    r.kind = b.kind;
    const int columns = b.kind == 's' ? 1 : 4;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < columns; ++j)
        for (int k = 0; k < 4; ++k)
          r.v[columns * i + j] += a.v[4 * i + k] * b.v[columns * k + j];
  }
  return r;
}

// The expected result of "x op y" agrees with plain algebra to a unit of its 17th digit.
bool agreesWithPlainAlgebra(const MathTest& test, char sign, const std::string& x,
                            const std::string& y) {
  const auto operand = [&](const std::string& name) {
    for (const auto& [known, value] : test.operands)
      if (known == name) return plain(value);
    throw std::logic_error("operand not found: " + name);
  };
  const Plain ours = compute(operand(x), sign, operand(y)), theirs = plain(test.expected);
  bool same = ours.kind == theirs.kind;
  for (int i = 0; i < 16; ++i)  // binary form of the decimal literals: 4 products of up to 100
    same = same && std::abs(ours.v[i] - theirs.v[i]) < 1e-13L;
  return same;
}

struct Answer {
  int code;
  std::string out;
};

Answer run(const std::string& arguments) {
  FILE* pipe = popen((std::string(MALUS_MATHTESTER) + " " + arguments + " 2>&1").c_str(), "r");
  std::string out;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) out += static_cast<char>(c);
  return {WEXITSTATUS(pclose(pipe)), out};
}
}  // namespace

TEST(MathTesterPublished, EveryTestOfTheAppendixPasses) {
  for (const MathTest& test : runMathTests())
    EXPECT_TRUE(test.passed) << test.number << ' ' << test.operation << ": expected "
                             << toText(test.expected) << ", computed " << toText(test.computed);
}

TEST(MathTesterPublished, EveryOperationPrintedInTheAppendixIsThere) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> appendix{
      {"A.2.1",
       {"upsv1 * f1", "f1 * upsv1", "psv1 * f1", "f1 * psv1", "upmm1 * f1", "f1 * upmm1",
        "pmm1 * f1", "f1 * pmm1"}},
      {"A.2.3",
       {"upsv1 - upsv2", "upsv2 - upsv1", "upmm1 - upmm2", "upmm2 - upmm1", "psv1 - upsv2",
        "upsv2 - psv1", "pmm1 - upmm2", "upmm2 - pmm1", "psv1 - psv2", "psv2 - psv1",
        "pmm1 - pmm2", "pmm2 - pmm1"}},
      {"A.2.4",
       {"upmm1 * upsv1", "upmm1 * psv2", "pmm1 * upsv2", "pmm1 * psv2", "upmm1 * upmm2",
        "upmm1 * pmm2", "pmm1 * upmm2", "pmm1 * pmm2"}},
      {"A.2.5", {"upsv1 / f1", "psv1 / f1", "upmm1 / f1", "pmm1 / f1"}}};
  const auto tests = runMathTests();
  for (const auto& [section, operations] : appendix) {
    std::vector<std::string> ours;
    for (const MathTest& test : tests)
      if (test.section == section && test.origin == MathOrigin::listed)
        ours.push_back(test.operation);
    EXPECT_TRUE(
        std::is_permutation(ours.begin(), ours.end(), operations.begin(), operations.end()))
        << section;
  }
  for (const char* function : {"getDOP()", "getDOLP()", "getDOCP()", "==", "!=", "getScalar()",
                               "getStokes(", "getMueller(", "demote()", "rotate("})
    EXPECT_TRUE(std::any_of(tests.begin(), tests.end(), [&](const MathTest& test) {
      return test.section == "A.2.6" && test.operation.find(function) != std::string::npos;
    })) << function;
}

TEST(MathTesterPublished, TheAdditionsAreTheSubtractionsWithAnotherSign) {
  std::set<std::string> sums, differences;
  for (const MathTest& test : runMathTests()) {
    if (test.section == "A.2.2") sums.insert(test.operation);
    if (test.section == "A.2.3")
      differences.insert(std::regex_replace(test.operation, std::regex("-"), "+"));
  }
  EXPECT_EQ(sums, differences);
  EXPECT_EQ(sums.size(), 12u);
}

TEST(MathTesterPublished, TheDataAreThoseOfSectionA1) {
  using namespace math_tester_data;
  EXPECT_EQ(carried(upsv1), std::vector<double>({5.7}));
  EXPECT_EQ(carried(psv1), std::vector<double>({8.7, 6.5, 4.3, 2.1}));
  EXPECT_EQ(carried(upsv2), std::vector<double>({7.2}));
  EXPECT_EQ(carried(psv2), std::vector<double>({19, 13, 11, 7}));
  EXPECT_EQ(f1, 3.5);
  EXPECT_EQ(f2, -4.7);
}

TEST(MathTesterInvariant, EveryAnswerObeysTheRuleOfSectionA1) {
  for (const MathTest& test : runMathTests()) {
    EXPECT_TRUE(obeysTheRule(carried(test.expected)))
        << test.operation << toText(test.expected);
    for (const auto& operand : test.operands)
      EXPECT_TRUE(obeysTheRule(carried(operand.second))) << operand.first;
  }
}

TEST(MathTesterInvariant, NegativeControlTheRuleIsBrokenByEqualElementsAndZeros) {
  EXPECT_FALSE(obeysTheRule(carried(CDStokesVector(1, 2, 3, 2))));
  EXPECT_FALSE(obeysTheRule(carried(CDStokesVector(1, 2, 3, 0))));
  EXPECT_FALSE(obeysTheRule(carried(math_tester_data::pmm1 - math_tester_data::pmm1)));
}

TEST(MathTesterInvariant, TheTwoOrdersOfTheProductShareNoElement) {
  using namespace math_tester_data;
  const auto one = carried(pmm1 * pmm2), other = carried(pmm2 * pmm1);
  for (double x : one)
    for (double y : other) EXPECT_GT(std::abs(x - y), 0.005);
}

TEST(MathTesterIdentity, ExpectedAnswersAgreeWithPlainAlgebra) {
  const std::regex binary(R"((\w+) ([-+*/]) (\w+))");
  int checked = 0;
  for (const MathTest& test : runMathTests()) {
    std::smatch match;
    if (!std::regex_match(test.operation, match, binary)) continue;
    ++checked;
    EXPECT_TRUE(agreesWithPlainAlgebra(test, match[2].str()[0], match[1], match[3]))
        << test.operation;
  }
  EXPECT_EQ(checked, 16 + 12 + 12 + 12 + 4);
}

TEST(MathTesterIdentity, NegativeControlPlainAlgebraSeesAnotherSign) {
  for (const MathTest& test : runMathTests())
    if (test.operation == "psv1 - psv2") {
      EXPECT_TRUE(agreesWithPlainAlgebra(test, '-', "psv1", "psv2"));
      EXPECT_FALSE(agreesWithPlainAlgebra(test, '+', "psv1", "psv2"));
    }
}

TEST(MathTesterIdentity, EachCorruptedExpectationIsTheOneThatFails) {
  const int count = static_cast<int>(runMathTests().size());
  for (int n = 1; n <= count; ++n) {
    const auto tests = runMathTests(n);
    for (const MathTest& test : tests)
      EXPECT_EQ(test.passed, test.number != n) << test.operation;
  }
  EXPECT_THROW(runMathTests(0), std::out_of_range);
  EXPECT_THROW(runMathTests(count + 1), std::out_of_range);
}

TEST(MathTesterIdentity, AnswersAreComparedByTypeStateAndValue) {
  EXPECT_TRUE(isSameAnswer(1.0, 1.0 + 1e-15));
  EXPECT_FALSE(isSameAnswer(1.0, 1.0 + 1e-13));
  EXPECT_FALSE(isSameAnswer(0.0, 1e-300)) << "zero has no rounding";
  EXPECT_FALSE(isSameAnswer(1.0, std::nan("")));
  EXPECT_FALSE(isSameAnswer(1.0, true));
  EXPECT_FALSE(isSameAnswer(CDStokesVector(1), CDStokesVector(1, 0, 0, 0))) << "other state";
  EXPECT_FALSE(isSameAnswer(CDMuellerMatrix(1), CDStokesVector(1)));
  EXPECT_FALSE(isSameAnswer(math_tester_data::pmm1, math_tester_data::pmm1.transposed()));
}

TEST(MathTesterIdentity, TheProgramPrintsEachTestAndATotal) {
  const Answer all = run("");
  EXPECT_EQ(all.code, 0);
  EXPECT_NE(all.out.find("A.2.4 Multiplication operations\n"), std::string::npos);
  EXPECT_NE(
      all.out.find("psv1 * f1\n        psv1     (8.7, 6.5, 4.3, 2.1)\n        f1       3.5\n"
                   "        expected (30.45, 22.75, 15.05, 7.35)\n"
                   "        computed (30.45, 22.75, 15.05, 7.35)\n        passed\n"),
      std::string::npos);
  const std::string n = std::to_string(runMathTests().size());
  EXPECT_EQ(run("--quiet").out, n + " tests, " + n + " passed, 0 failed\n");
}

TEST(MathTesterIdentity, TheProgramFailsWhenAnExpectationIsCorrupted) {
  const Answer first = run("--quiet --corrupt"), other = run("--corrupt 33 --quiet");
  EXPECT_EQ(first.code, 1);
  EXPECT_NE(first.out.find("   1  upsv1 * f1"), std::string::npos);
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.out.find("  33  "), std::string::npos);
  EXPECT_NE(other.out.find("FAILED"), std::string::npos);
  EXPECT_NE(other.out.find(" 1 failed"), std::string::npos);
}

TEST(MathTesterIdentity, TheProgramSpeaksJSON) {
  const Answer good = run("--json"), bad = run("--json --corrupt=2");
  const auto all = nlohmann::json::parse(good.out), spoilt = nlohmann::json::parse(bad.out);
  EXPECT_EQ(good.code, 0);
  EXPECT_EQ(bad.code, 1);
  EXPECT_EQ(all["failed"], 0);
  EXPECT_EQ(all["total"], all["tests"].size());
  EXPECT_EQ(spoilt["failed"], 1);
  EXPECT_EQ(spoilt["tests"][1]["passed"], false);
  EXPECT_EQ(all["tests"][2]["operands"]["psv1"], nlohmann::json({8.7, 6.5, 4.3, 2.1}));
  EXPECT_EQ(all["tests"][6]["expected"].size(), 4u) << "four rows of a Mueller matrix";
}

TEST(MathTesterIdentity, TheProgramAnswersAWrongCommandLineInOneLine) {
  for (const char* wrong :
       {"--foo", "--corrupt 0", "--corrupt 100000", "--corrupt x", "stray"}) {
    const Answer answer = run(wrong);
    EXPECT_EQ(answer.code, 2) << wrong;
    EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 1) << answer.out;
  }
  EXPECT_EQ(run("--help").code, 0);
}
