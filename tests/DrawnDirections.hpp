// Counts the directions that a model's sampler draws, for chi-squared tests of all models.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "ChiSquared.hpp"
#include "malus/base/Random.hpp"
#include "malus/surface/CDBRDFModel.hpp"

namespace malus::testing {
struct Drawn {
  double p_value, rejected, density_integral;
};

/// Counts samples in 8 x 16 cells of the hemisphere and one for the rejected, against the
/// density integrated over each cell by the midpoint rule.
inline Drawn draw(const CDBRDFModel& sampler, const CDBRDFModel& claimed, double zenith,
                  std::size_t draws = 200000) {
  constexpr int rows = 8, columns = 16, fine = 64;
  constexpr double pi = std::numbers::pi;
  const CDVector given = CDVector::fromAngles(zenith, 0.3);
  std::vector<double> probability(rows * columns + 1);
  double total = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      double& cell = probability[row * columns + column];
      for (int a = 0; a < fine; ++a)
        for (int b = 0; b < fine; ++b) {
          const double mu = (row + (a + 0.5) / fine) / rows;
          const double phi = 2 * pi * (column + (b + 0.5) / fine) / columns;
          cell += claimed.density(given, CDVector::fromAngles(std::acos(mu), phi));
        }
      cell *= 2 * pi / (rows * columns * fine * fine);
      total += cell;
    }
  probability.back() = std::max(1 - total, 0.0);
  std::vector<std::size_t> counts(probability.size());
  Random random(17);
  for (std::size_t i = 0; i < draws; ++i) {
    const double u1 = random.uniform(), u2 = random.uniform(), u3 = random.uniform();
    const BRDFSample s = sampler.sample(given, u1, u2, u3);
    if (s.rejected()) {
      ++counts.back();
      continue;
    }
    const int row = std::min(rows - 1, static_cast<int>(rows * s.direction.z));
    const int column =
        std::min(columns - 1, static_cast<int>(columns * s.direction.getAzimuth() / (2 * pi)));
    ++counts[row * columns + column];
  }
  return {chiSquaredPValue(counts, probability, draws),
          static_cast<double>(counts.back()) / static_cast<double>(draws), total};
}
}  // namespace malus::testing
