// The door for meshes: any text as a Wavefront OBJ file, put into a scene twice.
#include "Door.hpp"
#include "malus/scene/SceneGeometry.hpp"

using namespace malus;

MALUS_DOOR(mesh) {
  return fuzzing::knock([&] {
    const Mesh mesh = readOBJ(fuzzing::fileWith(fuzzing::textOf(data, size), ".obj"));
    GeometryBuilder builder;
    builder.addMesh(mesh, {});
    builder.addMesh(mesh, Transform::translate({1, 2, 3}).after(Transform::scale(-2)),
                    "again.");
    const SceneGeometry scene = std::move(builder).build();
    for (const Triangle& t : scene.triangles())  // what has an area has a normal
      if (!(scene.normal(t).getLength() > 0.9)) std::abort();
  });
}
