// The door for meshes: any text as a Wavefront OBJ file, put into a scene twice.
#include "Door.hpp"
#include "world/CDGeometry.hpp"

using namespace malus;

MALUS_DOOR(mesh) {
  return fuzzing::knock([&] {
    const CDMesh mesh = readOBJ(fuzzing::fileWith(fuzzing::textOf(data, size), ".obj"));
    CDGeometryBuilder builder;
    builder.addMesh(mesh, {});
    builder.addMesh(mesh, CDTransform::translate({1, 2, 3}).after(CDTransform::scale(-2)),
                    "again.");
    const CDSceneGeometry scene = std::move(builder).build();
    for (const CDTriangle& t : scene.triangles())  // what has an area has a normal
      if (!(scene.normal(t).getLength() > 0.9)) std::abort();
  });
}
