// Scattering matrices as series (nw/air/Scatterer.nw).
#include "malus/air/Scatterer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
Table tableOf(const std::string& text) {
  std::istringstream stream(text);
  return Table::parse(stream, "constants.csv");
}
const std::string columns = "l,alpha1,alpha2,alpha3,alpha4,beta1,beta2\n";
double apart(const ScatteringMatrix& a, const ScatteringMatrix& b) {
  return std::max({std::abs(a.a1 - b.a1), std::abs(a.a2 - b.a2), std::abs(a.a3 - b.a3),
                   std::abs(a.a4 - b.a4), std::abs(a.b1 - b.b1), std::abs(a.b2 - b.b2)});
}
}  // namespace

// Orthogonality, and the elementary forms of d^2: a recurrence of 40 steps keeps 13 digits.
TEST(ScattererIdentity, TheFunctionsAreOrthogonal) {
  const GaussRule rule(60);
  std::vector<double> d(40);
  for (const auto& [m, n] : {std::pair{0, 0}, {0, 2}, {2, 2}, {2, -2}, {5, 2}, {7, -2}, {1, 0}})
    for (const std::size_t l : {2u, 8u, 39u})
      for (const std::size_t k : {2u, 8u, 39u}) {
        double sum = 0;
        for (std::size_t i = 0; i < rule.at.size(); ++i) {
          sphericalFunctions(m, n, 2 * rule.at[i] - 1, d);
          sum += 2 * rule.weight[i] * d[l] * d[k];
        }
        const bool there = static_cast<int>(l) >= std::max(std::abs(m), std::abs(n));
        EXPECT_NEAR(sum, l == k && there ? 2.0 / (2.0 * static_cast<double>(l) + 1) : 0.0,
                    1e-12)
            << m << n << l << k;
      }
}

TEST(ScattererIdentity, TheSecondOrderIsElementary) {
  std::vector<double> d(3);
  for (const double x : {-1.0, -0.3, 0.0, 0.7, 1.0}) {
    sphericalFunctions(0, 2, x, d);
    EXPECT_NEAR(d[2], std::sqrt(6.0) / 4 * (1 - x * x), 1e-14);
    sphericalFunctions(2, 2, x, d);
    EXPECT_NEAR(d[2], (1 + x) * (1 + x) / 4, 1e-14);
    sphericalFunctions(2, -2, x, d);
    EXPECT_NEAR(d[2], (1 - x) * (1 - x) / 4, 1e-14);
    if (std::abs(x) < 1) {
      EXPECT_GT(std::abs(d[2] - (1 + x) * (1 - x) / 4), x == 0 ? -1 : 1e-3);  // control
    }
  }
}

TEST(ScattererIdentity, GaussIntegratesPolynomials) {
  for (const int n : {1, 2, 7, 64}) {
    const GaussRule rule(n);
    for (const int power : {0, 1, 2 * n - 1, 2 * n}) {
      double sum = 0;
      for (std::size_t i = 0; i < rule.at.size(); ++i)
        sum += rule.weight[i] * std::pow(rule.at[i], power);
      if (power < 2 * n) {
        EXPECT_NEAR(sum, 1.0 / (power + 1), 1e-14) << n;
      } else if (n < 7) {
        EXPECT_GT(std::abs(sum - 1.0 / (power + 1)), 1e-4) << n;  // not beyond its degree
      }
    }
  }
}

TEST(ScattererIdentity, RayleighIsWhatTheChapterSays) {
  const double rho = 0.03, D = (1 - rho) / (1 + rho / 2);
  const Scatterer air = rayleighScatterer(rho);
  for (const double c : {-1.0, -0.5, 0.1, 0.8}) {
    const double even = 0.75 * D * (1 + c * c);
    const ScatteringMatrix wanted{
        even + 1 - D,           even, 1.5 * D * c, 1.5 * D * (1 - 2 * rho) / (1 - rho) * c,
        0.75 * D * (1 - c * c), 0};
    EXPECT_LT(apart(air.matrix(c), wanted), 1e-14);
    EXPECT_GT(apart(rayleighScatterer(0.04).matrix(c), wanted), 1e-3);
  }
  EXPECT_FALSE(air.makesCircular());
}

TEST(ScattererIdentity, FunctionsBecomeTermsAndFunctionsAgain) {
  const auto odd = [](double c) {
    ScatteringMatrix f = rayleighScatterer(0.2).matrix(c);
    f.a2 *= 0.4, f.a3 *= 0.4, f.a4 *= 0.4, f.b1 *= 0.4;  // leaves room for what follows
    f.a1 += 0.2 * c * c * c, f.b2 = 0.3 * (1 - c * c) * c;
    return f;
  };
  const Scatterer made(odd, 8);
  EXPECT_TRUE(made.makesCircular());
  for (const double c : {-0.9, -0.2, 0.4, 1.0}) EXPECT_LT(apart(made.matrix(c), odd(c)), 1e-12);
  const Scatterer cut(odd, 3);  // too few terms for a cube
  EXPECT_GT(apart(cut.matrix(0.4), odd(0.4)), 1e-3);
}

TEST(ScattererIdentity, HenyeyAndGreenstein) {
  const double g = 0.7;
  const Scatterer made = henyeyGreensteinScatterer(g);
  for (const double c : {-1.0, 0.0, 0.6, 1.0})
    EXPECT_NEAR(made.matrix(c).a1, (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5), 1e-7);
}

// Rayleigh scattering as both conventions print it: de Haan, Bosma and Hovenier 1987, Siewert 2000.
TEST(ScattererPublished, BothConventions) {
  const std::string rows = "0,1,0,0,0,0,0\n1,0,0,0,1.5,0,0\n2,0.5,3,0,0,";
  const auto read = [&](const std::string& convention, const std::string& beta) {
    return Scatterer::read(
        tableOf("# convention: " + convention + "\n" + columns + rows + beta + ",0\n"));
  };
  EXPECT_LT(
      apart(read("dehaan", "1.224744871391589").matrix(0.3), rayleighScatterer(0).matrix(0.3)),
      1e-14);
  EXPECT_LT(apart(read("siewert", "-1.224744871391589").matrix(0.3),
                  rayleighScatterer(0).matrix(0.3)),
            1e-14);
  EXPECT_GT(
      apart(read("siewert", "1.224744871391589").matrix(0.3), rayleighScatterer(0).matrix(0.3)),
      0.1);  // the wrong sign is seen
}

TEST(ScattererInvariant, RefusesWhatIsNoScatterer) {
  const auto refused = [](const std::string& text) {
    try {
      Scatterer::read(tableOf(text));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string first = "0,1,0,0,0,0,0\n";
  EXPECT_EQ(refused("# convention: siewert\n" + columns + first), "");
  const std::string none = refused(columns + first);
  EXPECT_NE(none.find("dehaan"), std::string::npos);
  EXPECT_NE(none.find("siewert"), std::string::npos);
  EXPECT_NE(refused("# convention: mine\n" + columns + first), "");
  EXPECT_NE(refused("# convention: dehaan\n" + columns), "");
  EXPECT_NE(refused("# convention: dehaan\n" + columns + "0,2,0,0,0,0,0\n"), "");
  EXPECT_NE(refused("# convention: dehaan\n" + columns + first + "2,0.5,3,0,0,0,0\n"), "");
  EXPECT_NE(refused("# convention: dehaan\n" + columns + first + "1,-3,0,0,0,0,0\n"), "");
  for (const double g : {1.0, 0.9501, -0.9501})
    EXPECT_THROW(henyeyGreensteinScatterer(g), MathError);
  for (const double g : {0.95, -0.95}) EXPECT_NO_THROW(henyeyGreensteinScatterer(g));
  EXPECT_THROW(Scatterer({}), MathError);
}

// Every constant is bounded, at its place: Rayleigh's with one of them changed, in its own row, to something finite that no
// particles have. The message names file, line and column, or file and angle.
TEST(ScattererInvariant, EveryConstantIsBounded) {
  const std::vector<std::string> names{"alpha1", "alpha2", "alpha3",
                                       "alpha4", "beta1",  "beta2"};
  const auto read = [&](std::size_t row, std::size_t column, const std::string& value) {
    std::vector<std::vector<std::string>> cells{
        {"1", "0", "0", "0", "0", "0"},
        {"0", "0", "0", "1.5", "0", "0"},
        {"0.5", "3", "0", "0", "1.224744871391589", "0"}};
    if (column < 6) cells[row][column] = value;
    std::string text = "# convention: dehaan\n" + columns;
    for (std::size_t l = 0; l < 3; ++l) {
      text += std::to_string(l);
      for (const std::string& cell : cells[l]) text += "," + cell;
      text += "\n";
    }
    try {
      Scatterer::read(tableOf(text));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(read(2, 6, ""), "");  // unchanged
  for (std::size_t column = 0; column < 6; ++column)
    for (const char* value : {"1e20", "-1e20", "1e30", "1e308", "5.1"}) {
      const std::string told = read(2, column, value);
      EXPECT_NE(told.find("constants.csv"), std::string::npos) << names[column] << value;
      EXPECT_NE(told.find("constants.csv:5: "), std::string::npos) << told;
      EXPECT_NE(told.find(names[column]), std::string::npos) << told;
    }
  // within 2 l + 1 each, but no particles': found at an angle
  for (const auto& [row, column, value] :
       std::vector<std::tuple<std::size_t, std::size_t, std::string>>{{2, 0, "-4"},
                                                                      {2, 1, "4.9"},
                                                                      {2, 2, "2"},
                                                                      {1, 3, "2.9"},
                                                                      {2, 4, "3"},
                                                                      {2, 4, "-3"},
                                                                      {2, 5, "2"}}) {
    const std::string told = read(row, column, value);
    EXPECT_NE(told.find("constants.csv"), std::string::npos) << names[column] << value;
    EXPECT_NE(told.find("degrees"), std::string::npos) << told;
  }
  // control: a small change of the same constants is accepted
  EXPECT_EQ(read(2, 5, "1e-4"), "");
  EXPECT_EQ(read(2, 1, "2.9995"), "");
}

// A dip between the degrees is found as well: a quarter of a degree wide at 90.5 degrees, in a phase function of mean one.
TEST(ScattererInvariant, ADipBetweenTheDegreesIsFound) {
  const auto refused = [](double depth) {
    constexpr double width_deg = 0.25, at_deg = 90.5;
    const double mean = depth * width_deg * degree * std::sqrt(std::numbers::pi) / 2;
    try {
      Scatterer(
          [&](double c) {
            const double x = (std::acos(c) / degree - at_deg) / width_deg;
            return ScatteringMatrix{1 + mean - depth * std::exp(-x * x), 0, 0, 0, 0, 0};
          },
          900);
    } catch (const MathError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused(1.2).find("degrees"), std::string::npos) << refused(1.2);
  EXPECT_EQ(refused(0.8), "");  // control
}

namespace {
/// Rayleigh's functions at so many angles, in a file; `change` may spoil the text of a row.
std::string functions(int steps, bool falling, double mean = 1) {
  std::string text = "angle_deg,a1,a2,a3,a4,b1,b2\n";
  for (int i = 0; i <= steps; ++i) {
    const double angle = 180.0 * (falling ? steps - i : i) / steps;
    const ScatteringMatrix f = rayleighScatterer(0.03).matrix(std::cos(angle * degree));
    text += std::to_string(angle);
    for (const double value : {f.a1, f.a2, f.a3, f.a4, f.b1, f.b2})
      text += "," + std::to_string(value * mean);
    text += "\n";
  }
  return text;
}
}  // namespace

// A quarter of a degree apart, straight lines in the cosine are off by 3e-6 at most, and terms by 2 l + 1 times as much.
TEST(ScattererInvariant, FunctionsFromAFileHaveTheirConstants) {
  const Scatterer exact = rayleighScatterer(0.03);
  for (const bool falling : {false, true}) {
    const Scatterer read = Scatterer::read(tableOf(functions(720, falling)));
    ASSERT_GE(read.terms().size(), 3u);
    for (std::size_t l = 0; l < 3; ++l) {
      EXPECT_NEAR(read.terms()[l].alpha1, exact.terms()[l].alpha1, 2e-5) << l;
      EXPECT_NEAR(read.terms()[l].alpha2, exact.terms()[l].alpha2, 2e-5) << l;
      EXPECT_NEAR(read.terms()[l].alpha4, exact.terms()[l].alpha4, 2e-5) << l;
      EXPECT_NEAR(read.terms()[l].beta1, exact.terms()[l].beta1, 2e-5) << l;
    }
    for (const double c : {-1.0, -0.3, 0.9999, 1.0})
      EXPECT_LT(apart(read.matrix(c), exact.matrix(c)), 2e-5) << c;
    EXPECT_FALSE(read.makesCircular());
  }
  const Scatterer coarse = Scatterer::read(tableOf(functions(9, false)));  // control
  EXPECT_GT(apart(coarse.matrix(0.5), exact.matrix(0.5)), 1e-3);
  const Scatterer copy = coarse;
  EXPECT_TRUE(copy.sameAs(coarse));
  EXPECT_FALSE(exact.sameAs(rayleighScatterer(0.03)));
}

TEST(ScattererRefusal, FunctionsThatAreNone) {
  const auto complaint = [](const std::string& text) {
    try {
      Scatterer::read(tableOf(text));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(complaint(functions(36, false, 1.01)), "");  // control: a per cent is accepted
  EXPECT_NE(complaint(functions(36, false, 1.1)).find("mean"), std::string::npos);
  std::string text = functions(36, false);
  EXPECT_NE(complaint(text.substr(0, text.rfind("180."))).find("180"), std::string::npos);
  std::string mixed = text;
  mixed.replace(mixed.find("\n10."), 4, "\n1.");
  EXPECT_NE(complaint(mixed).find("order"), std::string::npos) << complaint(mixed);
  std::string strong = text;
  strong.replace(strong.find("\n90.000000,0.7"), 14, "\n90.000000,0.3");
  EXPECT_NE(complaint(strong).find("no particles do"), std::string::npos) << complaint(strong);
}
