// The door for scenes: any text as a scene file in scenes/.
#include "program/Scene.hpp"

#include "Door.hpp"

using namespace malus;

MALUS_DOOR(scene) {
  return fuzzing::knock(
      [&] { readSceneText(fuzzing::textOf(data, size), "scene.json", MALUS_SCENES); });
}
