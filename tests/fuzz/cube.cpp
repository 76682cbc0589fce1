// The door for cubes: the header of an ENVI cube up to a byte that is zero, and its numbers behind it.
#include "Door.hpp"
#include "malus/files/CubeView.hpp"
#include "malus/files/Quicklooks.hpp"

using namespace malus;

MALUS_DOOR(cube) {
  const std::string text = fuzzing::textOf(data, size),
                    header = text.substr(0, text.find('\0'));
  const auto path =
      fuzzing::fileWith(text.substr(std::min(text.size(), header.size() + 1)), ".img");
  std::ofstream(path.string() + ".hdr", std::ios::binary | std::ios::trunc) << header;
  return fuzzing::knock([&] {
    const Cube cube = readCube(path);
    const CubeHeader& h = cube.header;
    if (cube.data.size() != h.width * h.height * h.channels.size()) std::abort();
    if (openCube(path).numbers().size() != cube.data.size()) std::abort();
    stokesComponents(h);
  });
}
