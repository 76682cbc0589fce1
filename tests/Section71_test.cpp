// The plate and the sensor of section 7.1 (nw/thesis/Section71.nw).
#include "malus/thesis/Section71.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "Items.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
Table printed(const std::string& name) {
  return Table::read("validation/printed/" + name + ".csv");
}

// The matrix of eq 7.8 typed from the thesis, with the sign of f33 that its table 7.1 needs.
const CDMuellerMatrix paper(std::array<double, 16>{1.18, 0.04, 0, 0, 0.04, 1.172, 0, 0, 0, 0,
                                                   -1.131, 0.3026, 0, 0, -0.3026, -1.131});
constexpr double cos30 = 0.86602540378443865;
}  // namespace

TEST(Section71Published, OurMatrixRoundsToThePaperMatrix) {
  const CDMuellerMatrix rounded = roundedAsPrinted(copperPlateBRDF(), printed("E7.8"));
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)  // 1e-15: a decimal has no exact double
      EXPECT_NEAR(rounded.getMueller(row, column), paper.getMueller(row, column), 1e-15);
}

TEST(Section71Published, FacetTermOfFindingOne) {
  const CDMuellerMatrix f =
      copperPlateBRDF(DiffuseTerm::none);  // numbers of finding 1, six digits
  EXPECT_NEAR(f.getMueller(0, 0), 1.17187, 5e-6);
  EXPECT_NEAR(f.getMueller(0, 1), 0.040058, 5e-7);
  EXPECT_NEAR(f.getMueller(3, 3), -1.131418, 5e-7);
  EXPECT_NEAR(f.getMueller(2, 3), 0.302611, 5e-7);
}

TEST(Section71Published, HandCalculationFollowsFromPlainProducts) {
  const CDStokesVector L = reflectedRadiance(paper, {100, 20, 30, 60});
  EXPECT_NEAR(L.getStokes(0), (1.18 * 100 + 0.04 * 20) * cos30, 1e-12);
  EXPECT_NEAR(L.getStokes(3), (-0.3026 * 30 - 1.131 * 60) * cos30, 1e-12);
  EXPECT_NEAR(L.getStokes(3), -66.63, 0.005);  // table 7.1, two decimals
}

TEST(Section71Identity, SpreadIrradianceHasItsDegreeOfPolarisation) {
  for (const double dop : {0.0, 0.3, 1.0})
    EXPECT_NEAR(spreadIrradiance(dop).getDOP(), dop, 1e-15);  // eq 7.15; rounding
}

TEST(Section71Published, SensorRowsAtFullPolarisation) {
  // 104.19 + 0.05 (62.06 - 41.42 - 71.68) and 104.19 + 0.05 (62.06 + 71.68), inputs of two decimals
  EXPECT_NEAR(detect(paper, 1, 0.05, row_of_eq_7_16).detected, 101.64, 0.006);
  EXPECT_NEAR(detect(paper, 1, 0.05, row_of_the_tables).detected, 110.88, 0.006);
}

TEST(Section71Identity, ErrorColumnsMendAPlantedMisprint) {
  std::istringstream text(
      "DoP,unpolarized_L0,polarized_L0,detected_L0,unpolarized_error,polarized_error\n"
      "0.2,102.19,102.59,102.07,1.84,1.44\n"
      "0.2,102.19,102.59,104.07,1.84,1.44\n");
  const Table table = Table::parse(text, "planted");
  EXPECT_EQ(mendedByErrors(table, 0), "104.07");
  EXPECT_EQ(mendedByErrors(table, 1), "104.07");
}

TEST(Section71Published, EveryPrintedNumberIsMetOrIsAnErratum) {
  struct {
    const char* id;
    std::size_t errata;
  } const items[] = {{"T7.1", 1}, {"T7.2", 1}, {"T7.3", 1}, {"T7.4", 11}, {"C1", 0}, {"C2", 0}};
  for (const auto& [id, errata] : items) {
    const Item item = ran(id);
    EXPECT_EQ(named(item, Verdict::differs).size(), 0u) << id;
    EXPECT_EQ(named(item, Verdict::erratum).size(), errata) << id;
  }
}

TEST(Section71Published, NegativeControlAnotherInputOfThePlateIsSeen) {
  const Corrupted text("text.csv", "copper.k,2.950", "copper.k,2.951");
  EXPECT_EQ(named(ran("T7.1", text.data), Verdict::differs), (std::set<std::string>{"inputs"}));
  const Item item("T7.1", ".", "validation");
  EXPECT_THROW(printedInText(item, "copper.colour"), InputError);
}

TEST(Section71Published, NegativeControlOneDigitChangedIsSeen) {
  const Corrupted table("T7.2.csv", "103.58", "103.59");
  EXPECT_EQ(named(ran("T7.2", table.data), Verdict::differs).size(), 1u);
}
