// In a separate file, because the header of the distribution takes three seconds to compile.
#include "ChiSquared.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace malus::testing {
double chiSquaredPValue(const std::vector<std::size_t>& counts,
                        const std::vector<double>& probabilities, std::size_t draws) {
  double statistic = 0, pooled_expected = 0, pooled_count = 0;
  int cells = 0;
  const auto add = [&](double count, double expected) {
    statistic += (count - expected) * (count - expected) / expected;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double expected = probabilities[i] * static_cast<double>(draws);
    if (expected >= 5) {
      add(static_cast<double>(counts[i]), expected);
    } else {
      pooled_expected += expected;
      pooled_count += static_cast<double>(counts[i]);
    }
  }
  if (pooled_expected >= 5)
    add(pooled_count, pooled_expected);
  else if (pooled_count > 10 * pooled_expected + 20)  // much where nothing should be
    return 0;
  return boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(cells - 1), statistic));
}
}  // namespace malus::testing
