// Band responses, grids, and the weights of interpolation and averaging
// (nw/light/CDSpectralLocation.nw).
#include "malus/light/CDSpectralLocation.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "malus/base/Table.hpp"

using namespace malus;

namespace {
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
const std::vector<Extrapolation> beyonds{Extrapolation::forbid, Extrapolation::hold,
                                         Extrapolation::zero, Extrapolation::linear};

double weighted(const std::vector<SpectralWeight>& weights, const std::vector<double>& values) {
  double sum = 0;
  for (const auto& [index, weight] : weights) sum += weight * values.at(index);
  return sum;
}

// The spectrum as the chapter defines it, evaluated directly.
double spectrum(const SpectralGrid& grid, const std::vector<double>& v, double nm,
                Extrapolation beyond) {
  const std::size_t n = grid.size();
  if (nm < grid.nm(0) || nm > grid.nm(n - 1)) {
    if (beyond == Extrapolation::zero) return 0;
    if (beyond == Extrapolation::hold) return nm < grid.nm(0) ? v.front() : v.back();
  }
  std::size_t j = 0;
  while (j + 2 < n && nm > grid.nm(j + 1)) ++j;
  return v[j] + (v[j + 1] - v[j]) / (grid.nm(j + 1) - grid.nm(j)) * (nm - grid.nm(j));
}

// Midpoint sums between all corners of the integrand.
double averageByQuadrature(const SpectralGrid& grid, const std::vector<double>& v,
                           const CDSpectralLocation& band, std::vector<double> corners,
                           Extrapolation beyond) {
  for (const double nm : grid.nm()) corners.push_back(nm);
  corners.push_back(band.lower_nm());
  corners.push_back(band.upper_nm());
  std::sort(corners.begin(), corners.end());
  double sum = 0, area = 0;
  for (std::size_t c = 0; c + 1 < corners.size(); ++c) {
    const double p = std::max(corners[c], band.lower_nm()),
                 q = std::min(corners[c + 1], band.upper_nm());
    if (!(p < q)) continue;
    constexpr int steps = 400;
    for (int i = 0; i < steps; ++i) {
      const double nm = p + (q - p) * (i + 0.5) / steps;
      const double r = band.getResponse().at(band.nm(), nm) * (q - p) / steps;
      sum += r * spectrum(grid, v, nm, beyond);
      area += r;
    }
  }
  return sum / area;
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const GridError& error) {
    return error.what();
  }
  return "no GridError";
}
}  // namespace

TEST(CDSpectralLocationIdentity, InterpolationWorkedExamples) {
  const auto grid = SpectralGrid::make({450, 550, 650});
  const std::vector<double> v{1, 5, -3};
  const auto at = [&](double nm, Extrapolation beyond = Extrapolation::forbid) {
    return weighted(grid->weights(CDSpectralLocation(nm), beyond), v);
  };
  EXPECT_EQ(at(450), 1);
  EXPECT_EQ(at(550), 5);
  EXPECT_EQ(at(650), -3);
  EXPECT_EQ(at(475), 2);  // 0.75 of the first and 0.25 of the second
  EXPECT_EQ(at(600), 1);
  EXPECT_EQ(at(400, Extrapolation::hold), 1);
  EXPECT_EQ(at(700, Extrapolation::hold), -3);
  EXPECT_EQ(at(400, Extrapolation::zero), 0);
  EXPECT_EQ(at(700, Extrapolation::zero), 0);
  EXPECT_EQ(at(400, Extrapolation::linear), -1);
  EXPECT_EQ(at(700, Extrapolation::linear), -7);
  EXPECT_THROW(at(449.9), GridError);
  EXPECT_THROW(at(650.1), GridError);
}

TEST(CDSpectralLocationIdentity, AnEntryOfTheGridIsTakenAlone) {
  // a NaN at a neighbour must not spoil it: the neighbour is not in the sum
  const auto grid = SpectralGrid::make({450, 550, 650});
  for (std::size_t i = 0; i < 3; ++i) {
    const auto weights = grid->weights((*grid)[i]);
    ASSERT_EQ(weights.size(), 1U);
    EXPECT_EQ(weights[0].index, i);
    EXPECT_EQ(weights[0].weight, 1);
  }
}

TEST(CDSpectralLocationIdentity, RectangleWorkedExample) {
  const auto grid = SpectralGrid::make({450, 550, 650});
  const auto weights = grid->weights(CDSpectralLocation(550, BandResponse::rectangular(100)));
  ASSERT_EQ(weights.size(), 3U);
  EXPECT_DOUBLE_EQ(weights[0].weight, 0.125);
  EXPECT_DOUBLE_EQ(weights[1].weight, 0.75);
  EXPECT_DOUBLE_EQ(weights[2].weight, 0.125);
}

TEST(CDSpectralLocationIdentity, GridOfOneEntry) {
  const auto grid = SpectralGrid::make({550});
  EXPECT_EQ(weighted(grid->weights(CDSpectralLocation(550)), {7}), 7);
  EXPECT_EQ(weighted(grid->weights(CDSpectralLocation(400), Extrapolation::hold), {7}), 7);
  EXPECT_EQ(weighted(grid->weights(CDSpectralLocation(400), Extrapolation::zero), {7}), 0);
  EXPECT_THROW(grid->weights(CDSpectralLocation(400)), GridError);
  EXPECT_THROW(grid->weights(CDSpectralLocation(400), Extrapolation::linear), GridError);
  const CDSpectralLocation wide(550, BandResponse::gaussian(20));
  EXPECT_DOUBLE_EQ(weighted(grid->weights(wide, Extrapolation::hold), {7}), 7);
  EXPECT_THROW(grid->weights(wide), GridError);
}

RC_GTEST_PROP(CDSpectralLocationIdentity, AveragesAgreeWithQuadrature, (unsigned seed)) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> nm{400 + 50 * unit(engine)}, v{unit(engine)};
  for (int i = 0; i < 6; ++i) {
    nm.push_back(nm.back() + 1 + 60 * unit(engine));
    v.push_back(unit(engine) - 0.3);
  }
  const auto grid = SpectralGrid::make(nm);
  std::vector<double> table_nm{380 + 100 * unit(engine)}, table{unit(engine)};
  for (int i = 0; i < 4; ++i) {
    table_nm.push_back(table_nm.back() + 1 + 50 * unit(engine));
    table.push_back(unit(engine));
  }
  const double centre = nm.front() + (nm.back() - nm.front()) * (1.2 * unit(engine) - 0.1);
  const double width = 1 + 80 * unit(engine);
  const std::vector<CDSpectralLocation> bands{
      CDSpectralLocation(centre, BandResponse::rectangular(width)),
      CDSpectralLocation(centre, BandResponse::gaussian(width)),
      CDSpectralLocation(table_nm[2], BandResponse::tabulated(table_nm, table))};
  for (const auto& band : bands)
    for (const auto beyond : beyonds) {
      const bool inside = band.lower_nm() >= nm.front() && band.upper_nm() <= nm.back();
      if (beyond == Extrapolation::forbid && !inside) {
        RC_ASSERT_THROWS_AS(grid->weights(band, beyond), GridError);
        continue;
      }
      const double ours = weighted(grid->weights(band, beyond), v);
      const double theirs = averageByQuadrature(*grid, v, band, table_nm, beyond);
      // 400 midpoints a piece: second derivative times (piece/400)^2 / 24; the steepest is the
      // Gaussian, 5.5/width^2 over pieces of at most 3 widths: 5.5 * 9 / 400^2 / 24 = 1.3e-5,
      // of values of order one; a linear extrapolation may reach a few tens
      RC_ASSERT(std::abs(ours - theirs) < 2e-5 * (1 + std::abs(theirs)));
      auto perturbed =
          v;  // negative control: the entry with most weight changes by a thousandth
      const auto weights = grid->weights(band, beyond);
      if (weights.empty()) continue;
      const auto most = std::max_element(weights.begin(), weights.end(), [](auto a, auto b) {
        return std::abs(a.weight) < std::abs(b.weight);
      });
      perturbed[most->index] += 1e-2 * (1 + std::abs(theirs)) / std::abs(most->weight);
      RC_ASSERT(std::abs(weighted(weights, perturbed) - theirs) >
                2e-5 * (1 + std::abs(theirs)));
    }
}

TEST(CDSpectralLocationInvariant, AStraightLineIsSeenAtTheCentroid) {
  const auto grid = SpectralGrid::make({300, 410, 415, 560, 700, 900});
  std::vector<double> line;
  for (const double nm : grid->nm()) line.push_back(3 - 0.01 * nm);
  const auto read = [&](const CDSpectralLocation& band) {
    return weighted(grid->weights(band), line);
  };
  // rounding of a dozen terms of size up to 10
  const double tolerance = 2e-14;
  EXPECT_NEAR(read(CDSpectralLocation(557.3, BandResponse::rectangular(44))), 3 - 5.573,
              tolerance);
  EXPECT_NEAR(read(CDSpectralLocation(557.3, BandResponse::gaussian(44))), 3 - 5.573,
              tolerance);
  // a triangle that rises from 400 to 550 and falls at once: its centroid is at 500
  EXPECT_NEAR(read(CDSpectralLocation(
                  520, BandResponse::tabulated({400, 550, 550.0000000001}, {0, 1, 0}))),
              3 - 5, 1e-11);  // the fall is 1e-10 nm wide
  EXPECT_GT(std::abs(read(CDSpectralLocation(557.4, BandResponse::gaussian(44))) - (3 - 5.573)),
            tolerance);  // negative control
}

TEST(CDSpectralLocationInvariant, ANarrowingBandTendsToInterpolation) {
  const auto grid = SpectralGrid::make({450, 550, 650});
  const std::vector<double> v{1, 5, -3};
  for (const double centre : {470.0, 550.0, 640.0}) {
    const double there = weighted(grid->weights(CDSpectralLocation(centre)), v);
    for (const double fwhm : {1.0, 1e-3, 1e-6})
      for (const auto& response :
           {BandResponse::rectangular(fwhm), BandResponse::gaussian(fwhm)})
        // at a corner the average differs by about the slope change times the width: 0.12 per
        // nm
        EXPECT_NEAR(
            weighted(grid->weights(CDSpectralLocation(centre, response)), v), there,
            0.12 * fwhm + 1e-9)  // 1e-9: end points near 550 rounded to 1e-13, over 1e-6 nm
            << centre << " " << fwhm;
  }
}

TEST(CDSpectralLocationPublished, GaussianHalfMaximum) {
  // the definition of the full width at half maximum; area of a Gaussian: fwhm sqrt(pi / ln 2)
  // / 2 (Abramowitz and Stegun 7.4.4), less the two tails, erfc(sqrt(ln 1000)) of it
  const auto response = BandResponse::gaussian(10);
  EXPECT_DOUBLE_EQ(response.at(500, 505), 0.5);
  EXPECT_DOUBLE_EQ(response.at(500, 495), 0.5);
  const double lower = response.lower_nm(500), upper = response.upper_nm(500);
  const double area = response.moments(500, lower, upper, 500).zeroth;
  const double whole = 5 * std::sqrt(std::acos(-1.0) / std::log(2.0));
  EXPECT_NEAR(area, whole * std::erf(std::sqrt(std::log(1000.0))), 1e-10);
  EXPECT_NEAR(response.moments(500, lower, upper, 500).first, 0, 1e-10);
  EXPECT_GT(std::abs(area - whole), 1e-10);  // negative control
}

// A band at 780 nm of 20 nm: cut at a thousandth of the peak, 10 sqrt(ln 1000 / ln 2) nm away.
TEST(CDSpectralLocationPublished, AGaussianIsCutAtAThousandth) {
  const CDSpectralLocation band(780, BandResponse::gaussian(20));
  const double reach = 10 * std::sqrt(std::log(1000.0) / std::log(2.0));
  EXPECT_NEAR(band.lower_nm(), 780 - reach, 1e-12);  // rounding of 780
  EXPECT_NEAR(band.upper_nm(), 780 + reach, 1e-12);
  EXPECT_GT(band.lower_nm(), 748);
  EXPECT_LT(band.upper_nm(), 812);
  EXPECT_NEAR(band.getResponse().at(780, 780 + reach - 1e-9), 1e-3, 1e-12);
  EXPECT_EQ(BandResponse::gaussian_cut, 1e-3);
  EXPECT_EQ(band.getResponse().at(780, 780 + reach + 1e-9), 0);
  // the weights sum to one all the same
  const auto weights = SpectralGrid::make({748, 770, 790, 812})->weights(band);
  double sum = 0;
  for (const auto& weight : weights) sum += weight.weight;
  EXPECT_NEAR(sum, 1, 1e-14);
  EXPECT_THROW(SpectralGrid::make({749, 812})->weights(band), GridError);
}

TEST(CDSpectralLocationIdentity, BandsComeInAnyOrderAndWithEqualCentres) {
  const CDSpectralLocation pan(550, BandResponse::gaussian(200)), green(550), blue(450);
  const auto bands = SpectralGrid::bands({pan, green, blue, green}, {"pan", "", "blue", ""});
  EXPECT_EQ(bands->name(0), "pan");
  EXPECT_EQ(bands->name(1), "");
  EXPECT_FALSE(bands->isOrdered());
  EXPECT_EQ(bands->nm(2), 450);
  EXPECT_EQ(labelsOf(*bands), (std::vector<std::string>{"pan", "550", "blue", "550-2"}));
  EXPECT_EQ(toString(*bands), "4 entries from 450 to 550 nm");
  EXPECT_THROW(bands->weights(green), GridError);
  EXPECT_THROW(SpectralGrid::bands({}), GridError);
  EXPECT_TRUE(SpectralGrid::bands({blue, pan})->isOrdered());
  // the name is not a property of the light
  EXPECT_TRUE(*SpectralGrid::bands({blue}, {"blue"}) == *SpectralGrid::make({450}));
  EXPECT_EQ(SpectralGrid::make({450})->name(0), "");
  EXPECT_THROW(SpectralGrid::bands({blue}, {"blue", "red"}), GridError);
}

// A narrow window of a long grid is found by bisection: the same weights as on a short one.
TEST(CDSpectralLocationInvariant, WeightsDoNotDependOnEntriesFarAway) {
  std::vector<double> near{500, 507, 513, 520}, far = near;
  for (int i = 1; i < 300; ++i) far.push_back(520 + i), far.insert(far.begin(), 500 - i);
  const auto small = SpectralGrid::make(near), large = SpectralGrid::make(far);
  for (const CDSpectralLocation& band :
       {CDSpectralLocation(510, BandResponse::rectangular(15)), CDSpectralLocation(507),
        CDSpectralLocation(511, BandResponse::gaussian(5))}) {
    const auto a = small->weights(band), b = large->weights(band);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].index + 299, b[i].index);
      EXPECT_EQ(a[i].weight, b[i].weight);
    }
  }
}

TEST(CDSpectralLocationIdentity, ShapesOfTheResponses) {
  EXPECT_EQ(BandResponse::narrow().at(500, 500), 1);
  EXPECT_EQ(BandResponse::narrow().at(500, 500.1), 0);
  const auto box = BandResponse::rectangular(10);
  EXPECT_EQ(box.at(500, 495), 1);
  EXPECT_EQ(box.at(500, 494.9), 0);
  EXPECT_EQ(box.getFWHM(), 10);
  EXPECT_EQ(box.getShape(), BandResponse::Shape::rectangular);
  const auto table = BandResponse::tabulated({400, 450, 460}, {0, 1, 0.5});
  EXPECT_EQ(table.at(450, 400), 0);
  EXPECT_EQ(table.at(450, 425), 0.5);
  EXPECT_EQ(table.at(450, 450), 1);
  EXPECT_EQ(table.at(450, 460), 0.5);
  EXPECT_EQ(table.at(450, 461), 0);
  EXPECT_EQ(table.at(450, not_a_number), 0);
}

TEST(CDSpectralLocationIdentity, ForbiddenBands) {
  for (const double bad : {0.0, -10.0, infinite, not_a_number}) {
    EXPECT_THROW(BandResponse::rectangular(bad), MathError) << bad;
    EXPECT_THROW(BandResponse::gaussian(bad), MathError) << bad;
    EXPECT_THROW(CDSpectralLocation{bad}, MathError) << bad;
  }
  using Table = std::vector<double>;
  EXPECT_THROW(BandResponse::tabulated(Table{400}, Table{1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, 500}, {1, 1, 1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, 400}, {1, 1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({-400, 400}, {1, 1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, infinite}, {1, 1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, not_a_number}, {1, 1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, 500}, {1, -1}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, 500}, {1, not_a_number}), MathError);
  EXPECT_THROW(BandResponse::tabulated({400, 500}, {0, 0}), MathError);
  EXPECT_THROW(CDSpectralLocation(100, BandResponse::rectangular(200)), MathError);
  EXPECT_THROW(CDSpectralLocation(550, BandResponse::gaussian(1e-9)), MathError);
  EXPECT_THROW(CDSpectralLocation(600, BandResponse::tabulated({400, 500}, {1, 1})), MathError);
}

TEST(CDSpectralLocationIdentity, GridsAreOrderedAndNotEmpty) {
  EXPECT_THROW(SpectralGrid::make(std::vector<double>{}), GridError);
  EXPECT_THROW(SpectralGrid::make({450, 450}), GridError);
  EXPECT_THROW(SpectralGrid::make({550, 450}), GridError);
  EXPECT_THROW(SpectralGrid::make({450, not_a_number}), MathError);
  EXPECT_EQ(message([] {
              SpectralGrid::make({450, 650, 550});
            }),
            "a spectral grid must increase in wavelength, but 550 nm follows 650 nm");
  // energies that fall are wavelengths that rise
  const auto grid = SpectralGrid::make(
      std::vector<CDSpectralLocation>{CDSpectralLocation({3, CDSpectralUnits::electronVolt}),
                                      CDSpectralLocation({2, CDSpectralUnits::electronVolt})});
  EXPECT_EQ(grid->in(CDSpectralUnits::electronVolt), (std::vector<double>{3, 2}));
  EXPECT_LT(grid->nm(0), grid->nm(1));
  EXPECT_EQ(grid->nm().size(), 2U);
}

TEST(CDSpectralLocationIdentity, DifferentGridsAreNamed) {
  const auto a = SpectralGrid::make({450, 550, 650}),
             same = SpectralGrid::make({450, 550, 650});
  EXPECT_NO_THROW(demandSameGrid(*a, *a));
  EXPECT_NO_THROW(demandSameGrid(*a, *same));
  const auto said = [&](const SpectralGridPtr& b) {
    return message([&] { demandSameGrid(*a, *b); });
  };
  const std::string remedy = "; resample one of them with resampled(grid)";
  EXPECT_EQ(said(SpectralGrid::make({450, 551, 650})),
            "the spectra have different grids (3 entries from 450 to 650 nm against 3 "
            "entries from "
            "450 to 650 nm, differing first at entry 1, 550 against 551 nm)" +
                remedy);
  EXPECT_EQ(said(SpectralGrid::make({450})),
            "the spectra have different grids (3 entries from 450 to 650 nm against 1 "
            "entry at 450 "
            "nm)" +
                remedy);
  const auto filtered = SpectralGrid::make(std::vector<CDSpectralLocation>{
      CDSpectralLocation(450), CDSpectralLocation(550, BandResponse::gaussian(10)),
      CDSpectralLocation(650)});
  EXPECT_EQ(said(filtered),
            "the spectra have different grids (3 entries from 450 to 650 nm against 3 "
            "entries from "
            "450 to 650 nm, with different band responses at 550 nm)" +
                remedy);
}
