// Pearson's chi-squared test of counts against probabilities, for the tests of samplers.
#pragma once
#include <cstddef>
#include <vector>

namespace malus::testing {
/// Probability that counts drawn with these probabilities deviate at least as much as the given
/// ones. Cells that expect fewer than five counts are pooled into one, since the test is
/// asymptotic.
double chiSquaredPValue(const std::vector<std::size_t>& counts,
                        const std::vector<double>& probabilities, std::size_t draws);
}  // namespace malus::testing
