// The doors for binary files. The first byte says which: K a table of matrices (tensor file or text), M a MERL file, E an ENVI cube (header, zero
// byte, numbers). A small letter begins with a valid file of the kind, in which the rest of the bytes exchange numbers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "Choices.hpp"
#include "Door.hpp"
#include "malus/base/Table.hpp"
#include "malus/files/Cube.hpp"
#include "malus/surface/BRDFMeasured.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

namespace malus::fuzzing::measured {
inline const BRDFTorranceSparrow& metal() {
  static const SpectralGridPtr bands = SpectralGrid::make({450.0, 550.0, 650.0});
  static const BRDFTorranceSparrow model(CDSpectralVector<double>(bands, 0.4),
                                         CDSpectralVector<double>(bands, 3.0),
                                         CDSpectralVector<double>(bands, 0.3));
  return model;
}

inline std::string valid(char kind) {
  static const std::string tensor = tensorFile(tabulate(metal(), 3));
  static const std::string text = muellerCSV(tabulate(metal(), 2));
  static const std::string merl = merlFile(metal(), {3, 3, 4});
  static const std::string cube = std::string(
                                      "ENVI\nsamples = 3\nlines = 2\nbands = 2\nheader offset "
                                      "= 0\ndata type = 4\ninterleave = bip\n"
                                      "byte order = 0\nband names = {S0 450, S0 "
                                      "550}\nwavelength = {450, 550}\nfwhm = {1, 1}\n") +
                                  '\0' + std::string(48, '\0');
  return kind == 'k' ? tensor : kind == 'c' ? text : kind == 'm' ? merl : cube;
}

/// Exchanges 1 to 8 bytes runs for numbers of a kind, cuts or lengthens.
inline std::string changed(std::string bytes, Choices& choices) {
  for (std::size_t left = 1 + choices.below(6); left > 0 && !bytes.empty(); --left) {
    const bool head = choices.byte() % 2;
    const std::size_t at =
        choices.below(head ? std::min<std::size_t>(bytes.size(), 300) : bytes.size());
    switch (choices.below(7)) {
      case 0:
        bytes[at] = static_cast<char>(choices.byte());
        break;
      case 1:
        bytes.resize(at);
        break;
      case 2:
        bytes.insert(at, std::string(choices.below(64), static_cast<char>(choices.byte())));
        break;
      case 3: {
        static const std::vector<std::uint64_t> sizes{0,
                                                      1,
                                                      2,
                                                      3,
                                                      7,
                                                      255,
                                                      65535,
                                                      1u << 19,
                                                      1u << 31,
                                                      0xFFFFFFFFu,
                                                      std::uint64_t{1} << 32,
                                                      std::uint64_t{1} << 33,
                                                      std::uint64_t{1} << 60,
                                                      std::uint64_t{1} << 62,
                                                      std::uint64_t{1} << 63,
                                                      ~std::uint64_t{0}};
        const std::uint64_t size = choices.of(sizes);
        const std::size_t width = std::size_t{1} << choices.below(4);
        if (at + width <= bytes.size()) std::memcpy(&bytes[at], &size, width);
        break;
      }
      case 4: {
        const double number = choices.number();
        if (at + 8 <= bytes.size()) std::memcpy(&bytes[at], &number, 8);
        break;
      }
      case 5: {
        const double number = choices.number();
        const float single = std::abs(number) < 3e38 ? static_cast<float>(number)
                                                     : std::numeric_limits<float>::infinity();
        if (at + 4 <= bytes.size()) std::memcpy(&bytes[at], &single, 4);
        break;
      }
      default: {  // a number in a text
        const std::size_t digit = bytes.find_first_of("0123456789", at);
        if (digit == bytes.npos) break;
        const std::size_t end =
            std::min(bytes.find_first_not_of("0123456789.e", digit), bytes.size());
        bytes.replace(digit, end - digit, fmt::format("{}", choices.number()));
      }
    }
  }
  return bytes;
}

/// What was taken must be a surface: its matrices are numbers.
inline void use(MuellerTable table) {
  const SpectralGridPtr bands = SpectralGrid::make(std::vector<double>{table.wavelength_nm[0]});
  examine(table);
  if (table.values.size() > 100'000) return;
  const BRDFMeasured surface(bands, std::move(table));
  for (const double theta : {0.0, 30.0, 89.0})
    for (const double phi : {0.0, 90.0, 180.0})
      if (!std::isfinite(
              surface.getBRDF(BRDFGeometry::fromDegrees(theta, 40, phi)).at(0).getScalar()))
        std::abort();
  surface.getDHR(0.5);
}
}  // namespace malus::fuzzing::measured

using namespace malus;

MALUS_DOOR(measured) {
  if (size == 0) return 0;
  const char kind = static_cast<char>(data[0]);
  std::string bytes = fuzzing::textOf(data + 1, size - 1);
  if (kind == 'k' || kind == 'c' || kind == 'm' || kind == 'e') {
    fuzzing::Choices choices(data + 1, size - 1);
    bytes = fuzzing::measured::changed(fuzzing::measured::valid(kind), choices);
  }
  return fuzzing::knock([&] {
    if (kind == 'M' || kind == 'm') {
      fuzzing::measured::use(readMERL(fuzzing::fileWith(bytes, ".binary"), {450, 550, 650}));
    } else if (kind == 'E' || kind == 'e') {
      const std::size_t zero = std::min(bytes.find('\0'), bytes.size());
      fuzzing::fileWith(bytes.substr(0, zero), ".img.hdr");
      readCube(fuzzing::fileWith(bytes.substr(std::min(zero + 1, bytes.size())), ".img"));
    } else {
      fuzzing::measured::use(readMuellerTable(fuzzing::fileWith(bytes, ".pbsdf")));
    }
  });
}
