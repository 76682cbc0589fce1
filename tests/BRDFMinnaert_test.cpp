// ch. Adding a model: Minnaert's law against Lambert's, against the quadrature of the DHR, and refused.
#include "malus/surface/BRDFMinnaert.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "malus/base/Error.hpp"
#include "malus/surface/ModelRegistry.hpp"

namespace {
using namespace malus;

const SpectralGridPtr grid = SpectralGrid::make({450, 550, 650});
const CDSpectralVector<double> reflectance(grid, {0.1, 0.3, 0.7});

/// The base class's quadrature, which does not use the closed form.
double quadrature(const CDBRDFModel& model, double zenith_rad, std::size_t band) {
  return model.CDBRDFModel::getDHR(zenith_rad)[band];
}

TEST(BRDFMinnaertIdentity, ExponentOneIsLambert) {
  const BRDFMinnaert law(reflectance, 1);
  for (const double zenith_deg : {0.0, 30.0, 80.0}) {
    const auto f = law.getBRDF(BRDFGeometry::fromDegrees(zenith_deg, 50, 120));
    for (std::size_t band = 0; band < grid->size(); ++band)
      EXPECT_DOUBLE_EQ(f[band].getScalar(), reflectance[band] / std::numbers::pi);
  }
}

TEST(BRDFMinnaertInvariant, ClosedFormOfTheDHRIsTheIntegral) {
  // the product rule integrates a smooth power to about 1e-6
  for (const double exponent : {1.0, 1.3, 2.0, 4.0})
    for (const double zenith_deg : {0.0, 40.0, 75.0})
      for (std::size_t band = 0; band < grid->size(); ++band) {
        const BRDFMinnaert law(reflectance, exponent);
        const double zenith_rad = zenith_deg * std::numbers::pi / 180;
        const double closed = law.getDHR(zenith_rad)[band];
        EXPECT_NEAR(closed, quadrature(law, zenith_rad, band), 1e-5 * reflectance[band]);
        // the control: without the exponent in the norm the same comparison fails
        if (exponent > 1) {
          const double wrong = closed * 2 / (exponent + 1);
          EXPECT_GT(std::abs(wrong - quadrature(law, zenith_rad, band)),
                    1e-2 * quadrature(law, zenith_rad, band));
        }
      }
}

TEST(BRDFMinnaertInvariant, TheModelIsInTheList) {
  const ModelEntry& entry = modelEntry("minnaert", {});
  const auto model = exampleModel(entry, grid);
  EXPECT_NEAR(model->getDHR(0)[0], 0.3, 1e-15);
}

TEST(BRDFMinnaertRegression, RefusesWhatItCannotBe) {
  EXPECT_THROW(BRDFMinnaert(reflectance, 0.9), MathError);
  EXPECT_THROW(BRDFMinnaert(reflectance, NAN), MathError);
  EXPECT_THROW(BRDFMinnaert(CDSpectralVector<double>(grid, 1.1), 1), MathError);
}
}  // namespace
