// The item of the layered paint (nw/thesis/XPaint.nw).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "Items.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
const Item& paint() {
  static const Item item = ran("X.paint");
  return item;
}
Table tableOf(const std::string& name) {
  for (const auto& [file, table] : paint().tables())
    if (file == name) {
      std::istringstream text(table.text());
      return Table::parse(text, name);
    }
  throw std::out_of_range(name);
}
double valueOf(const std::string& name) { return std::stod(valuesOf(paint()).at(name)); }
}  // namespace

void checkClaims() {
  const Item& item = paint();
  EXPECT_EQ(named(item, Verdict::differs), std::set<std::string>{});
  for (const char* claim :
       {"energy", "reciprocity", "realizable", "white", "coats", "body", "lossless"})
    EXPECT_TRUE(named(item, Verdict::reproduced).contains(claim)) << claim;
  EXPECT_EQ(item.tables().size(), 11u);
  // negative control: the thin coat is not as white as the thick one
  EXPECT_LT(valueOf("thin"), valueOf("white") - 0.05);
}

// A quarter wave of 1.38 on 1.52 reflects ((1.52 - 1.38^2) / (1.52 + 1.38^2))^2, and thicker films lie between that and
// the bare glass. Rounding, except where the dispersion-free fringes are met by steps of a nanometre.
void checkFilms() {
  const Table films = tableOf("films");
  const double bare = std::pow(0.52 / 2.52, 2), quarter = std::pow((1.52 - 1.9044) / 3.4244, 2);
  double least = 1, most = 0;
  for (std::size_t row = 0; row < films.rows(); ++row) {
    EXPECT_NEAR(films.number(row, "bare"), bare, 1e-14);
    least = std::min(least, films.number(row, "2 um"));
    most = std::max(most, films.number(row, "2 um"));
    if (films.number(row, "wavelength_nm") == 550) {
      EXPECT_NEAR(films.number(row, "quarter wave"), quarter, 1e-14);
      EXPECT_GT(std::abs(films.number(row + 20, "quarter wave") - quarter), 1e-6);  // control
    }
  }
  EXPECT_NEAR(least, quarter, 1e-4);
  EXPECT_NEAR(most, bare, 1e-4);
}

// Straight down a bare face of 1.5 passes 0.96; inside, all is returned beyond the critical angle, 41.81 degrees.
void checkFace() {
  const Table passed = tableOf("face"), returned = tableOf("face-inside");
  EXPECT_NEAR(passed.number(0, "smooth_T0"), 0.96, 1e-12);
  EXPECT_GT(passed.number(0, "film_T0"), 0.97);  // control: the film passes more
  for (std::size_t row = 0; row < returned.rows(); ++row)
    for (const char* column : {"smooth", "rough"}) {
      const bool total = returned.number(row, "inside_deg") > 41.82;
      EXPECT_EQ(returned.number(row, column) > 1 - 1e-9, total) << row << column;
    }
}

// Small grains turn back light like the cube of their diameter (Rayleigh: the sixth power over the volume), and rutile
// hides best at about 0.2 um, as makers of pigment say.
void checkGrains() {
  const Table hiding = tableOf("grains"), angles = tableOf("grains-angle");
  // from 20 to 24 nm; the next power of the size, x = 0.2, adds a few per cent
  EXPECT_NEAR(hiding.number(2, "650 nm") / hiding.number(0, "650 nm") / std::pow(1.2, 3), 1,
              0.03);
  EXPECT_GT(hiding.number(2, "650 nm") / hiding.number(0, "650 nm") / std::pow(1.2, 2), 1.1);
  EXPECT_NEAR(valueOf("hiding"), 200, 50);
  EXPECT_GT(angles.number(90, "20 nm"), 0.99);
  EXPECT_LT(angles.number(90, "powder"), 0);
}

// Lossless paint over black whitens with each step and meets the one over white; straight through almost nothing, the
// white primer under the face is Judd's: 0.96 * 0.8 * (1 - 0.596) / (1 - 0.8 * 0.596).
void checkCoats() {
  const Table coats = tableOf("coats");
  const std::size_t last = coats.rows() - 1;
  EXPECT_NEAR(coats.number(0, "over white"), 0.96 * 0.8 * 0.404 / (1 - 0.8 * 0.596),
              3e-3);  // Judd's three digits, and a tenth of a micrometre of paint
  EXPECT_GT(coats.number(8, "over white"), 0.6);  // control: a micrometre and a half is seen
  for (std::size_t row = 1; row <= last; ++row)
    EXPECT_GT(coats.number(row, "over black"), coats.number(row - 1, "over black"));
  EXPECT_NEAR(coats.number(last, "over black"), coats.number(last, "over white"), 1e-3);
  EXPECT_LT(coats.number(last, "stained over black"), 0.7);
}

// One test, because each test is a process that runs the item.
TEST(XPaintPublished, ClaimsAndPicturesOfTheParts) {
  checkClaims();
  checkFilms();
  checkFace();
  checkGrains();
  checkCoats();
}
