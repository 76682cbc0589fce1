// Tables of measured matrices and the surface made of one (nw/surface/MuellerTable.nw, BRDFMeasured.nw).
#include "malus/surface/BRDFMeasured.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include "ModelChecks.hpp"
#include "Scratch.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

/// Rough metal of two bands, without grooves: smooth in all directions.
BRDFTorranceSparrow metal(double sigma = 0.3, std::vector<double> nm = {500, 600}) {
  const auto grid = SpectralGrid::make(nm);
  return BRDFTorranceSparrow(ramp(grid, 0.4, 1.2), ramp(grid, 2.9, 3.5), {grid, sigma},
                             {Shadowing::smith, DiffuseTerm::none});
}
/// 150 bands out of a table of two wavelengths.
BRDFMeasured varied(int steps, double sigma = 0.3) {
  return BRDFMeasured(manyBands(), tabulate(metal(sigma, {390, 720}), steps));
}
BRDFMeasured own(const MuellerTable& table) {
  return BRDFMeasured(SpectralGrid::make(table.wavelength_nm), table);
}

/// Largest difference of matrices over geometries, in units of f00.
double apart(const CDBRDFModel& a, const CDBRDFModel& b, double most_rad) {
  double worst = 0;
  for (const Angles& angles : someAngles(200, most_rad)) {
    const auto f = a.getBRDF(angles.there()), g = b.getBRDF(angles.there());
    for (std::size_t band = 0; band < f.size(); ++band) {
      const CDMuellerMatrix m = f.at(band), n = g.at(band);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          worst = std::max(
              worst, std::abs(m.getMueller(i, j) - n.getMueller(i, j)) / (0.1 + n.getScalar()));
    }
  }
  return worst;
}

MuellerTable from(const Scratch& scratch, const std::string& text) {
  put(scratch / "t", text);
  return readMuellerTable(scratch / "t");
}
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void append(std::string& bytes, const auto& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}
}  // namespace

// At the nodes, the model to single precision (6e-8, and 8 planes turned twice).
TEST(BRDFMeasuredIdentity, NodesAreTheModel) {
  const auto model = metal();
  const MuellerTable table = tabulate(model, 12);
  const BRDFMeasured measured = own(table);
  int checked = 0;
  for (const double theta_h : table.theta_h.nodes)
    for (const double theta_d : table.theta_d.nodes)
      for (const double phi_d : {table.phi_d.nodes[1], table.phi_d.nodes[15]}) {
        if (theta_d == 0 || theta_h + theta_d > 80 * degree) continue;
        const auto g = brdfGeometry(RusinkiewiczAngles::fromAngles(theta_h, theta_d, phi_d));
        for (std::size_t band = 0; band < 2; ++band) {
          const CDMuellerMatrix f = model.getBRDF(g).at(band), m = measured.getBRDF(g).at(band);
          for (int k = 0; k < 16; ++k)
            ASSERT_NEAR(m.data()[k], f.data()[k], 1e-6 * f.getScalar());
        }
        ++checked;
      }
  EXPECT_GT(checked, 100);
}

// Straight lines: four times nearer with half the step. The geometries stay away from the horizon, where nodes are missing.
TEST(BRDFMeasuredInvariant, TheErrorFallsWithTheSquareOfTheStep) {
  const auto model = metal();
  const double coarse = apart(own(tabulate(model, 12)), model, 1.1);
  const double fine = apart(own(tabulate(model, 24)), model, 1.1);
  EXPECT_LT(coarse, 0.3);
  EXPECT_LT(fine, coarse / 2.5);
  EXPECT_GT(apart(own(tabulate(metal(0.31), 24)), model, 1.1), fine);  // negative control
}

// cos^2(theta_d) f00 linear in the angles, everything known: no error but that of single precision; and nearest known nodes elsewhere.
TEST(BRDFMeasuredIdentity, LinearTablesAreMetExactly) {
  const auto cos2 = [](double angle) { return std::cos(angle) * std::cos(angle); };
  MuellerTable table;
  table.theta_h = {{0, 0.3, 1.6}, 0, 1.6, 0}, table.theta_d = {{0, 1.0, 1.5}, 0, 1.6, 0};
  table.phi_d = {{-3, -1, 2}, 0, 0, 2 * pi};
  table.wavelength_nm = {400, 500, 700}, table.elements = 1;
  table.clear();
  for (std::size_t p = 0; p < 3; ++p)
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t h = 0; h < 3; ++h)
        for (std::size_t band = 0; band < 3; ++band)
          table.values[table.at(p, d, h) + band] =
              static_cast<float>((1 + table.theta_h.nodes[h] + 2 * table.theta_d.nodes[d] +
                                  0.01 * table.wavelength_nm[band]) /
                                 cos2(table.theta_d.nodes[d]));
  const BRDFMeasured model(SpectralGrid::make({450, 480, 600}), table);
  for (const Angles& a : someAngles(100)) {
    const auto angles = halfDifference(a.there());
    const auto f = model.getBRDF(a.there());
    const double expected = 1 + angles.getThetaH() + 2 * angles.getThetaD();
    const double c = cos2(angles.getThetaD());
    if (angles.getThetaD() > 1.5) continue;
    EXPECT_NEAR(c * f.at(0).getScalar(), expected + 4.5, 1e-5);
    EXPECT_NEAR(c * f.at(1).getScalar(), expected + 4.8, 1e-5);
    EXPECT_NEAR(c * f.at(2).getMueller(2, 2), expected + 6, 1e-5);  // neutral
  }
  // phi_d between 2 and -3 goes through pi
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t h = 0; h < 3; ++h)
      table.values[table.at(2, d, h) + 1] =
          static_cast<float>(100 / cos2(table.theta_d.nodes[d]));
  const auto angles = RusinkiewiczAngles::fromAngles(0.4, 0.6, 2 + 0.25 * (2 * pi - 5));
  const double expected = 0.75 * 100 + 0.25 * (1 + 0.4 + 1.2 + 5);
  EXPECT_NEAR(cos2(0.6) * own(table).getBRDF(brdfGeometry(angles)).at(1).getScalar(), expected,
              1e-4);
}

TEST(BRDFMeasuredInvariant, ReciprocalRealizableAndFast) {
  const BRDFMeasured model = varied(16);
  EXPECT_LT(reciprocityError(model), 1e-5);                // single precision, weighed
  EXPECT_GT(reciprocityError(model, {1, 1, 1, 1}), 1e-2);  // negative control
  expectRealizable(model, 1e-6);                           // single precision
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
}

TEST(BRDFMeasuredInvariant, AnUnpolarisedTableIsNeutral) {
  MuellerTable table = tabulate(metal(0.3, {390, 720}), 8);
  const std::size_t bands = table.wavelength_nm.size();
  std::vector<float> f00;
  for (std::size_t node = 0; node < table.nodes(); ++node)
    f00.insert(f00.end(), &table.values[node * 16 * bands],
               &table.values[node * 16 * bands] + bands);
  table.values = f00, table.elements = 1;
  const BRDFMeasured model(manyBands(), table);
  EXPECT_FALSE(model.getBRDF(BRDFGeometry::fromDegrees(30, 40, 170)).anyPolarized());
  expectScatterIsTheMatrix(model, 1e-13);
  expectNoAllocation(model);
  expectScoreAndHorizon(model);
}

TEST(BRDFMeasuredInvariant, ReflectanceAndSampler) {
  expectDHRIsTheIntegral(varied(16),
                         4e-3);  // the plain rule's 60 by 128 points over kinks of the table
  EXPECT_NEAR(varied(40).getDHR(0.6)[0], metal(0.3, {390, 720}).getDHR(0.6)[0], 0.01);
  EXPECT_LE(largestDHR(varied(16)), 1);
  // 1.6 times the light at 10 steps, were it not for cos^2 theta_d (see the chapter)
  const auto grid = SpectralGrid::make({550.0});
  const BRDFTorranceSparrow glass({grid, 1.5}, {grid, 0.0}, {grid, 0.3},
                                  {Shadowing::vGroove, DiffuseTerm::reciprocal});
  EXPECT_LE(largestDHR(own(tabulate(glass, 10))), 1);
  expectSamplesFollowDensity(varied(16));
  EXPECT_LT(draw(varied(16), varied(16, 0.28), 0.6).p_value, false_alarm);  // negative control
  EXPECT_LT(expectSamplerGivesDHR(varied(24, 0.1)), 0.02);
}

TEST(BRDFMeasuredIdentity, BandsOutsideTheTableAreRefused) {
  const MuellerTable table = tabulate(metal(), 4);
  EXPECT_THROW(BRDFMeasured(SpectralGrid::make({450, 550}), table), GridError);
  EXPECT_THROW(BRDFMeasured(SpectralGrid::make({550}), MuellerTable{}), MathError);
  const BRDFMeasured middle(SpectralGrid::make({550.0}), table);
  const auto g = BRDFGeometry::fromDegrees(30, 40, 170);
  const auto both = own(table).getBRDF(g);
  EXPECT_NEAR(middle.getBRDF(g).at(0).getScalar(),
              (both.at(0).getScalar() + both.at(1).getScalar()) / 2, 1e-12);
}

// Written, read, and the same surface: text in nine digits of a float, tensor bit for bit.
TEST(BRDFMeasuredIdentity, FilesGoRoundTrip) {
  const Scratch scratch;
  const MuellerTable table = tabulate(metal(), 6);
  for (const std::string& text : {muellerCSV(table), tensorFile(table)}) {
    const MuellerTable back = from(scratch, text);
    EXPECT_EQ(back.wavelength_nm, table.wavelength_nm);
    EXPECT_LT(apart(own(back), own(table), 1.5), 1e-5);  // angles of single precision
  }
  EXPECT_GT(apart(own(tabulate(metal(0.31), 6)), own(table), 1.5), 1e-3);  // negative control
}

// The chapter's own example: nodes at 0, 10 and 30 (here hundredths of a radian, so that a period may be short). Without a
// period there is nothing beyond the ends; with one, 40 lies half way in the gap from 30 to 50.
TEST(BRDFMeasuredIdentity, AnAxisIsClosedByItsPeriodWhateverThatIs) {
  const TableAxis open{{0, 0.1, 0.3}, 0, 0.3, 0}, closed{{0, 0.1, 0.3}, 0, 0, 0.5};
  const auto is = [](const TableAxis::Cell& cell, std::size_t lower, std::size_t upper,
                     double share) {
    return cell.lower == lower && cell.upper == upper && std::abs(cell.share - share) < 1e-12;
  };
  EXPECT_TRUE(is(open.find(0.15), 1, 2, 0.25));
  EXPECT_TRUE(is(open.find(0.4), 2, 2, 0));
  EXPECT_TRUE(is(closed.find(0.15), 1, 2, 0.25));
  for (const double turns : {-2, 0, 3}) {
    EXPECT_TRUE(is(closed.find(0.4 + 0.5 * turns), 2, 0, 0.5)) << turns;
    EXPECT_TRUE(closed.covers(0.4 + 0.5 * turns));
  }
  EXPECT_TRUE(open.covers(0.3));
  EXPECT_FALSE(open.covers(0.31));  // negative control
  EXPECT_FALSE(open.covers(-0.01));
}

// The float before half of pi is what a file has where 90 degrees were meant; light along the surface is then known, too.
TEST(BRDFMeasuredIdentity, AQuarterTurnInSinglePrecisionIsAQuarterTurn) {
  const Scratch scratch;
  MuellerTable table = tabulate(metal(), 4);
  table.theta_h.nodes.back() = std::nextafter(float(pi / 2), 0.0f);
  ASSERT_LT(table.theta_h.nodes.back(), pi / 2);
  EXPECT_TRUE(from(scratch, tensorFile(table)).theta_h.covers(pi / 2));
  table.theta_h.nodes.back() = 89.9 * degree;  // negative control: a table that ends earlier
  EXPECT_FALSE(from(scratch, tensorFile(table)).theta_h.covers(pi / 2));
}

// The layout as the chapter describes it, laid down by hand: one matrix, f23 and f32 with the other handedness.
TEST(BRDFMeasuredPublished, ATensorFileLaidDownByHand) {
  const Scratch scratch;
  std::string bytes("tensor_file\0\1\0", 14);
  append(bytes, std::uint32_t{5});
  std::string data;
  const auto field = [&](const std::string& name, char type, std::vector<std::uint64_t> shape) {
    append(bytes, static_cast<std::uint16_t>(name.size()));
    bytes += name;
    append(bytes, static_cast<std::uint16_t>(shape.size()));
    bytes += type;
    append(bytes, std::uint64_t{4096 + data.size()});
    for (const std::uint64_t count : shape) append(bytes, count);
  };
  field("wvls", 4, {2});  // the other number for 16 bits
  append(data, std::uint16_t{450}), append(data, std::uint16_t{650});
  field("M", 10, {1, 2, 1, 2, 4, 4});
  for (int i = 0; i < 64; ++i)
    append(data, static_cast<float>(i % 16 == 0 ? 20 : i % 16) / 100);
  for (const char* name : {"phi_d", "theta_h"}) {
    field(name, 10, {1, 1});
    append(data, 0.0f);
  }
  field("theta_d", 10, {1, 2});
  append(data, 0.0f), append(data, 1.5f);
  bytes.resize(4096, '\0');
  const MuellerTable table = from(scratch, bytes + data);
  ASSERT_EQ(table.wavelength_nm, (std::vector<double>{450, 650}));
  ASSERT_EQ(table.theta_d.nodes, (std::vector<double>{0, 1.5}));
  const CDMuellerMatrix f =
      own(table).getBRDF(BRDFGeometry::fromDegrees(40, 40, 180)).at(1);  // axes agree there
  const double share = 40 * degree / 1.5, c = std::cos(40 * degree);     // both nodes alike
  const double between = (1 - share + share * std::pow(std::cos(1.5), 2)) / (c * c);
  for (int k = 0; k < 16; ++k) {
    const int row = k / 4, column = k % 4;
    const double sign = (row == 3) != (column == 3) ? -1 : 1;
    EXPECT_NEAR(f.data()[k] / between, sign * (k == 0 ? 20 : k) / 100.0, 1e-7) << k;
  }
  for (const auto& [name, other] : {std::pair{"theta_h", "theta_x"}, {"wvls", "wvlz"}}) {
    std::string broken = bytes + data;
    broken.replace(broken.find(name), std::strlen(name), other);
    const std::string problem = refusal([&] { from(scratch, broken); });
    EXPECT_NE(problem.find(fmt::format("lacks the field {}", name)), std::string::npos)
        << problem;
  }
  const auto refusedWith = [&](std::size_t at, const auto& number, const char* problem) {
    std::string other = bytes + data;
    std::memcpy(&other[at], &number, sizeof number);
    EXPECT_NE(refusal([&] { from(scratch, other); }).find(problem), std::string::npos)
        << problem;
  };
  const std::size_t end = bytes.size() + data.size();
  refusedWith(end - 8, 1.6f, "has nodes of theta_d that do not ascend");
  refusedWith(end - 4, std::nanf(""), "has nodes of theta_d that do not ascend");
  refusedWith(4096 + 2, std::uint16_t{450},
              "has wavelengths that do not ascend from above zero");
  const std::size_t shape =
      bytes.find("M\x06") + 12;  // behind 2 bytes of 6, 1 of 10, 8 of offset
  refusedWith(shape, std::uint64_t{2}, "has a field M whose shape is not that of its axes");
  for (const std::size_t length : {13u, 17u, 60u, 200u, 4100u, 4200u}) {
    const std::string cut = refusal([&] { from(scratch, (bytes + data).substr(0, length)); });
    EXPECT_NE(cut.find("; give a complete file of measured reflection"), std::string::npos)
        << length << cut;
  }
}

// Sizes that a file cannot hold. Three axes that claim the same 2 MB have 2^19 nodes each; with 2^7 wavelengths and 2^4 elements their
// product is 2^68, which is 0 in 64 bits: room would be made for nothing, and then be written to.
TEST(BRDFMeasuredIdentity, SizesThatOverflowAreRefusedBeforeAnythingIsAllocated) {
  const Scratch scratch;
  const auto tensor = [&](std::uint64_t nodes, std::uint64_t wavelengths,
                          std::vector<std::uint64_t> shape) {
    std::string head("tensor_file\0\1\0", 14), data;
    append(head, std::uint32_t{5});
    const auto field = [&](const std::string& name, char type,
                           const std::vector<std::uint64_t>& sizes, std::uint64_t offset) {
      append(head, static_cast<std::uint16_t>(name.size()));
      head += name;
      append(head, static_cast<std::uint16_t>(sizes.size()));
      head += type;
      append(head, std::uint64_t{4096 + offset});
      for (const std::uint64_t size : sizes) append(head, size);
    };
    for (const char* name : {"phi_d", "theta_d", "theta_h"}) field(name, 10, {1, nodes}, 0);
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(nodes, 1 << 19); ++i)
      append(data, static_cast<float>(i) * 6.2f * 0x1p-19f);  // all round, for phi_d
    field("wvls", 3, {wavelengths}, data.size());
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(wavelengths, 1 << 12); ++i)
      append(data, static_cast<std::uint16_t>(400 + i));
    field("M", 10, shape, data.size());
    data += std::string(64 * sizeof(float), '\0');
    head.resize(4096, '\0');
    return refusal([&] { from(scratch, head + data); });
  };
  constexpr std::uint64_t many = 1 << 19, all = ~std::uint64_t{0};
  EXPECT_NE(tensor(many, 1 << 7, {many, many, many, 1 << 7, 4, 4}).find("whose shape is not"),
            std::string::npos);
  EXPECT_NE(tensor(many, 1 << 11, {many, many, many, 1 << 11, 4, 4}).find("whose shape is not"),
            std::string::npos);
  for (const std::uint64_t count :
       {all, all / 2 + 1, std::uint64_t{1} << 62, std::uint64_t{1} << 40}) {
    EXPECT_NE(tensor(count, 1, {1, 1, 1, 1, 4, 4}).find("ends too early"), std::string::npos)
        << count;
    EXPECT_NE(tensor(1, count, {1, 1, 1, 1, 4, 4}).find("ends too early"), std::string::npos)
        << count;
  }
  EXPECT_EQ(tensor(1, 1, {1, 1, 1, 1, 4, 4}), "accepted");  // negative control
}

TEST(BRDFMeasuredIdentity, NumbersThatNoSurfaceReflectsAreRefused) {
  const Scratch scratch;
  std::string merl;
  for (const std::int32_t size : {2, 2, 2}) append(merl, size);
  for (int i = 0; i < 24; ++i) append(merl, 100.0);
  const auto spoilt = [&](double number) {
    std::string bytes = merl;
    std::memcpy(&bytes[12 + 8 * 13], &number, 8);
    put(scratch / "m", bytes);
    return refusal([&] { readMERL(scratch / "m", {450, 550, 650}); });
  };
  EXPECT_EQ(spoilt(-1), "accepted");  // negative control: unknown
  EXPECT_NE(spoilt(1e100).find("in cell 5, beyond any reflection"), std::string::npos);
  EXPECT_NE(spoilt(std::numeric_limits<double>::infinity()).find("beyond any reflection"),
            std::string::npos);
  EXPECT_NE(spoilt(std::nan("")).find("beyond any reflection"), std::string::npos);
  EXPECT_NE(refusal([&] {
              from(scratch,
                   "theta_h_deg,theta_d_deg,phi_d_deg,wavelength_nm,f00\n0,0,0,550,1e39\n");
            }).find("f00 = 1e+39 /sr: is beyond any reflection"),
            std::string::npos);
  std::string rows = "theta_h_deg,theta_d_deg,phi_d_deg,wavelength_nm,f00\n";
  for (int i = 0; i < 3000; ++i)
    rows += fmt::format("{0},{0},{1},{2},1\n", i * 0.03, i * 0.1, 400 + i);
  EXPECT_NE(refusal([&] {
              from(scratch, rows);
            }).find("do not form a grid, which would have 3000 x 3000 x"),
            std::string::npos);
}

// 90, 90, 180, then red, green, blue as doubles; the cell of phi_d runs fastest.
TEST(BRDFMeasuredPublished, AMERLFileLaidDownByHand) {
  const Scratch scratch;
  std::string bytes;
  for (const std::int32_t size : {90, 90, 180}) append(bytes, size);
  std::vector<double> cells(3 * 90 * 90 * 180, -1.0);
  const auto cell = [](int colour, int h, int d, int phi) {
    return static_cast<std::size_t>(((colour * 90 + h) * 90 + d) * 180 + phi);
  };
  cells[cell(0, 10, 20, 30)] = 1500, cells[cell(1, 10, 20, 30)] = 3000 / 1.15;
  cells[cell(2, 10, 20, 30)] = 4500 / 1.66;
  bytes.append(reinterpret_cast<const char*>(cells.data()), 8 * cells.size());
  put(scratch / "m", bytes);
  const BRDFMeasured model = own(readMERL(scratch / "m", {450, 550, 650}));
  const double theta_h = std::pow(10.5 / 90, 2) * 90 * degree;
  for (const double turn : {0.0, pi}) {  // half a turn of phi_d is the other way round
    const auto f = model.getBRDF(brdfGeometry(
        RusinkiewiczAngles::fromAngles(theta_h, 20.5 * degree, 30.5 * degree + turn)));
    EXPECT_NEAR(f.at(2).getScalar(), 1, 1e-6);
    EXPECT_NEAR(f.at(1).getScalar(), 2, 1e-6);
    EXPECT_NEAR(f.at(0).getScalar(), 3, 1e-6);
  }
  EXPECT_EQ(model.getBRDF(BRDFGeometry::fromDegrees(30, 60, 90)).at(0).getScalar(), 0);
  const TableReport report = examine(readMERL(scratch / "m", {450, 550, 650}));
  EXPECT_EQ(report.matrices - report.unknown, 3u);
  EXPECT_THROW(readMERL(scratch / "m", {550, 450, 650}), MathError);
  put(scratch / "m", bytes.substr(0, 1000));
  EXPECT_NE(refusal([&] {
              readMERL(scratch / "m", {450, 550, 650});
            }).find("is longer or shorter than its MERL sizes say"),
            std::string::npos);
  put(scratch / "m", "no binary at all");
  EXPECT_NE(refusal([&] {
              readMERL(scratch / "m", {450, 550, 650});
            }).find("does not begin with the sizes of a MERL file"),
            std::string::npos);
}

// A round trip of f00; between the cells' middles, interpolation.
TEST(BRDFMeasuredInvariant, AModelThroughMERLAndBack) {
  const Scratch scratch;
  const auto model = metal(0.3, {450, 550, 650});
  put(scratch / "m", merlFile(model, {60, 45, 40}));  // other sizes, same rules
  const BRDFMeasured back = own(readMERL(scratch / "m", {450, 550, 650}));
  EXPECT_LT(reciprocityError(back), 1e-12);  // by the layout
  for (const Angles& a : someAngles(100, 1.2))
    for (std::size_t band = 0; band < 3; ++band) {
      const double f = model.getBRDF(a.there()).at(band).getScalar();
      ASSERT_NEAR(back.getBRDF(a.there()).at(band).getScalar(), f, 0.02 * (0.1 + f));
    }
}

// The sizes of MERL's own files are those that a reader elsewhere expects.
TEST(BRDFMeasuredPublished, AMERLFileHasTheSizesOfMERL) {
  const auto grid = SpectralGrid::make({550});
  const std::string bytes = merlFile(BRDFDiffuse(CDSpectralVector<double>(grid, 0.5)));
  ASSERT_EQ(bytes.size(), 12 + 8 * 3 * 90 * 90 * 180u);
  std::array<std::int32_t, 3> sizes{};
  std::memcpy(sizes.data(), bytes.data(), 12);
  EXPECT_EQ(sizes, (std::array<std::int32_t, 3>{90, 90, 180}));
}

// One cell of an angle is a table too: the reflection does not depend on it.
TEST(BRDFMeasuredIdentity, AMERLFileMayHaveOneCellOfAnAngle) {
  const Scratch scratch;
  std::string bytes;
  for (const std::int32_t size : {2, 2, 1}) append(bytes, size);
  for (int i = 0; i < 12; ++i) append(bytes, 100.0);
  put(scratch / "m", bytes);
  EXPECT_NO_THROW(readMERL(scratch / "m", {450, 550, 650}));
}

// Another program's reader goes by the types in the head: 3 are whole numbers of 16 bits, 10 are floats of 32.
TEST(BRDFMeasuredPublished, ATensorFileNamesItsTypes) {
  const std::string bytes = tensorFile(tabulate(metal(), 4));
  const auto typeOf = [&](const std::string& name) {
    return int(bytes.at(bytes.find(name) + name.size() + 2));
  };
  EXPECT_EQ(typeOf("wvls"), 3);
  for (const char* name : {"phi_d", "theta_d", "theta_h"}) EXPECT_EQ(typeOf(name), 10) << name;
}

TEST(BRDFMeasuredIdentity, WhatNoSurfaceCouldDoIsCounted) {
  MuellerTable table = tabulate(metal(), 6);
  const TableReport good = examine(table);
  EXPECT_EQ(good.unrealizable, 0u);
  EXPECT_EQ(good.unknown, 0u);
  EXPECT_GT(good.matrices, 200u);
  float* node = &table.values[table.at(3, 2, 1)];
  node[2] = 2 * node[0];  // f01 of the first band: more polarised light than light
  table.values[table.at(4, 2, 1) + 1] = std::nanf("");
  const TableReport bad = examine(table);
  EXPECT_EQ(bad.unrealizable, 1u);
  EXPECT_EQ(bad.unknown, 1u);
  EXPECT_LT(bad.worst, -0.1);
  EXPECT_NE(toText(bad).find("1 of them unknown, 1 not realisable (worst eigenvalue -"),
            std::string::npos);
}

// Unknown corners leave their weight to the others; where nothing is known, nothing is scattered.
TEST(BRDFMeasuredIdentity, UnknownNodes) {
  const Scratch scratch;
  const std::string head = "theta_h_deg,theta_d_deg,phi_d_deg,wavelength_nm,f00\n";
  const BRDFMeasured model =
      own(from(scratch, head + "0,0,0,550,1\n0,40,0,550,1\n20,0,0,550,3\n"));
  const auto f = [&](double h, double d) {
    return model
        .getBRDF(brdfGeometry(RusinkiewiczAngles::fromAngles(h * degree, d * degree, 1)))
        .at(0)
        .getScalar();
  };
  EXPECT_NEAR(f(10, 0), 2, 1e-6);
  const double c20 = std::pow(std::cos(20 * degree), 2),
               c40 = std::pow(std::cos(40 * degree), 2);
  EXPECT_NEAR(f(10, 20), (1 * 0.25 + c40 * 0.25 + 3 * 0.25) / 0.75 / c20, 1e-6);
  EXPECT_NEAR(f(0, 20), (1 + c40) / 2 / c20, 1e-6);
  EXPECT_EQ(f(0, 41), 0);  // beyond the table
  EXPECT_EQ(f(21, 0), 0);
}

TEST(BRDFMeasuredIdentity, BrokenTextIsRefused) {
  const Scratch scratch;
  const std::string head = "theta_h_deg,theta_d_deg,phi_d_deg,wavelength_nm,f00\n";
  for (const auto& [rows, problem] :
       {std::pair{"", "holds no matrix"},
        {"0,0,0,550,1\n0,0,0,550,1\n", ":3: theta_h_deg: repeats a node"},
        {"-5,0,0,550,1\n", "theta_h: is negative"},
        {"95,0,0,550,1\n", "theta_h_deg = 95 deg: exceeds the range of this angle"},
        {"0,0,0,0,1\n", "wavelength_nm = 0 nm: must be above zero"},
        {"0,0,0,550,x\n", "f00 = x: is not a number"},
        {"0,0,0,550,1\n0,0,90,550,1\n", "phi_d: leaves out more than 120 deg of the circle"},
        {"0,0,0,550,1\n1,1,100,551,1\n2,2,200,552,1\n3,3,300,553,1\n",
         "4 rows: do not form a grid, which would have 4 x 4 x 4 x 4"}}) {
    const std::string text = head + rows;
    const std::string message = refusal([&] { from(scratch, text); });
    EXPECT_NE(message.find(problem), std::string::npos) << message;
  }
  EXPECT_NE(refusal([&] {
              from(scratch, "theta_h_deg,f00\n0,1\n");
            }).find("phi_d_deg: is not among the columns"),
            std::string::npos);
}
