// The door for scenes: any text as a scene file in scenes/.
#include "program/Scene.hpp"

#include "Door.hpp"

using namespace malus;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzzing::knock(
      [&] { readSceneText(fuzzing::textOf(data, size), "scene.json", MALUS_SCENES); });
}
