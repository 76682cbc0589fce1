// What a programmer would write over Embree for one picture and no other: triangles with a copper of some roughness or
// a matt colour, a uniform or a Rayleigh sky, a sun, and loops. The renderer is measured against these.
#pragma once
#include <embree3/rtcore.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "malus/render/Scene.hpp"

namespace bare {
struct Material {
  float sigma = 0;        // 0: matt
  float reflectance = 0;  // of a matt one
};
struct Triangle {
  std::uint32_t a, b, c, material;
};

struct Scene {
  std::vector<std::array<float, 3>> vertices;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<float> e1, e2;  // squared index of the copper, for each band
  float sky = 0;              // radiance of the uniform sky
  std::vector<float> sun;     // irradiance of each band
  /// The Rayleigh sky in place of the uniform one, if not empty: of each node, even in the root of the cosine, and each
  /// eight bands the four functions of the chapter on this sky; of a single band [node][function].
  std::vector<float> rayleigh;
  static constexpr int rayleigh_steps = 256;
  std::array<float, 3> to_sun{};
  RTCDevice device = nullptr;
  RTCScene embree = nullptr;
  void build();
  ~Scene();
};

/// Looks down from (0, 0, height) at width x width metres of z = 0; renders the pixels of so many rows from `first`, each
/// `step` rows apart, into out[pixel][component][band]. rays: at the first surface, and at the second (0: none, 1: sun).
/// `polarized` false: S0 alone.
void render(const Scene& scene, std::size_t pixels, float height, float width, std::size_t step,
            int rays1, int rays2, bool polarized, std::vector<float>& out);
}  // namespace bare
