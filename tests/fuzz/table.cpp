// The doors for tables: the first byte says what the rest is taken for; G is a scatterer by its Greek constants.
#include "malus/base/Table.hpp"

#include <sstream>

#include "Door.hpp"
#include "malus/air/Scatterer.hpp"
#include "malus/air/Sky.hpp"
#include "malus/air/TableSky.hpp"
#include "malus/files/OpticalConstants.hpp"
#include "malus/light/MeasuredSpectrum.hpp"
#include "malus/scene/Material.hpp"

using namespace malus;

namespace {
const SpectralGridPtr& grid() {
  static const SpectralGridPtr bands = SpectralGrid::make({450.0, 550.0, 650.0});
  return bands;
}

void asNumbers(const std::string& text) {
  std::istringstream stream(text);
  const Table table = Table::parse(stream, "table.csv");
  for (const std::string& column : table.columns())
    for (std::size_t row = 0; row < table.rows(); ++row) table.number(row, column);
}

void asSky(const std::string& text) {
  std::istringstream stream(text);
  const TableSky sky(Table::parse(stream, "sky.csv"), grid());
}

void asScatterer(const std::string& text) {
  std::istringstream stream(text);
  Scatterer::read(Table::parse(stream, "scatterer.csv"));
}
}  // namespace

MALUS_DOOR(table) {
  if (size == 0) return 0;
  const std::string text = fuzzing::textOf(data + 1, size - 1);
  return fuzzing::knock([&] {
    if (data[0] == 'G') return asScatterer(text);
    switch (data[0] % 5) {
      case 0:
        return asNumbers(text);
      case 1:
        readSpectrum(fuzzing::fileWith(text, ".csv"), "reflectance", grid());
        return;
      case 2:
        readOpticalConstants(fuzzing::fileWith(text, ".csv"), grid());
        return;
      case 3:
        readOpticalConstants(fuzzing::fileWith(text, ".yml"), grid());
        return;
      default:
        return asSky(text);
    }
  });
}
