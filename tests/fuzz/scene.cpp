// The door for scenes: any text as a scene file in scenes/.
#include "Door.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;

MALUS_DOOR(scene) {
  return fuzzing::knock(
      [&] { readSceneText(fuzzing::textOf(data, size), "scene.json", MALUS_SCENES); });
}
