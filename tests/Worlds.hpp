// Small worlds of one band for the tests of the radiometry.
#pragma once
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "malus/render/Radiometry.hpp"
#include "malus/scene/SceneGeometry.hpp"
#include "malus/scene/World.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

namespace malus::testing {
inline const SpectralGridPtr& oneBand() {
  static const SpectralGridPtr grid = SpectralGrid::make({CDSpectralLocation(550.0)});
  return grid;
}

inline CDSpectralVector<CDStokesVector> spectrumOf(const CDStokesVector& value) {
  return CDSpectralVector<CDStokesVector>(oneBand(), value);
}

using Model = std::shared_ptr<const CDBRDFModel>;

inline Model matt(double reflectance) {
  return std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(oneBand(), reflectance));
}
inline Model facets(double n, double k, double sigma, DiffuseTerm diffuse = DiffuseTerm::none) {
  const auto all = [](double value) { return CDSpectralVector<double>(oneBand(), value); };
  return std::make_shared<BRDFTorranceSparrow>(all(n), all(k), all(sigma),
                                               TorranceSparrowOptions{.diffuse = diffuse});
}

// Quadrilaterals abcd, counter-clockwise seen from outside; facet and material "0", "1", ...
struct Quad {
  CDVector a, b, c, d;
  std::shared_ptr<const CDBRDFModel> brdf;
};

inline World worldOf(const std::vector<Quad>& quads, std::shared_ptr<const Sky> sky = nullptr) {
  World world;
  world.grid = oneBand();
  GeometryBuilder builder;
  for (std::size_t i = 0; i < quads.size(); ++i) {
    Mesh mesh;
    mesh.vertices = {quads[i].a, quads[i].b, quads[i].c, quads[i].d};
    mesh.facets = mesh.materials = {std::to_string(i)};
    mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
    builder.addMesh(mesh, {});
    world.materials.push_back({std::to_string(i), quads[i].brdf});
  }
  world.geometry = std::move(builder).build();
  world.sky = sky ? std::move(sky) : blackSky(oneBand());
  return world;
}

inline std::shared_ptr<const Sky> uniformSky(double radiance) {
  return std::make_shared<UniformSky>(spectrumOf(radiance));
}

// A square on the ground.
inline Quad floorOf(const Model& model, double half = 1) {
  return {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}, model};
}

// Inside of a globe, radius 1, whose cap above the opening is missing: all form factors are areas.
inline World globe(double opening_rad, const Model& model) {
  constexpr std::uint32_t rows = 60, columns = 120;
  Mesh mesh;
  mesh.facets = mesh.materials = {"globe"};
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j)
      mesh.vertices.push_back(
          CDVector::fromAngles(opening_rad + (std::numbers::pi - opening_rad) * i / rows,
                               2 * std::numbers::pi * j / columns));
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t a = i * columns + j, b = i * columns + (j + 1) % columns;
      mesh.triangles.push_back({a, b + columns, a + columns, 0, 0});
      mesh.triangles.push_back({a, b, b + columns, 0, 0});
    }
  GeometryBuilder builder;
  builder.addMesh(mesh, {});
  World world;
  world.grid = oneBand();
  world.geometry = std::move(builder).build();
  world.materials = {{"globe", model}};
  world.sky = uniformSky(1);
  return world;
}

// The box [low, high]^3 with normals inwards: bottom, top, west, east, south, north.
inline std::vector<Quad> boxOf(const std::array<std::shared_ptr<const CDBRDFModel>, 6>& brdf,
                               double low = -1, double high = 1) {
  const double l = low, h = high;
  return {{{l, l, l}, {h, l, l}, {h, h, l}, {l, h, l}, brdf[0]},
          {{l, l, h}, {l, h, h}, {h, h, h}, {h, l, h}, brdf[1]},
          {{l, l, l}, {l, h, l}, {l, h, h}, {l, l, h}, brdf[2]},
          {{h, l, l}, {h, l, h}, {h, h, h}, {h, h, l}, brdf[3]},
          {{l, l, l}, {l, l, h}, {h, l, h}, {h, l, l}, brdf[4]},
          {{l, h, l}, {h, h, l}, {h, h, h}, {l, h, h}, brdf[5]}};
}

// A ray that sees the point `at` from the direction `to_viewer`.
inline Radiometry::Ray looking(const CDVector& at, const CDVector& to_viewer,
                               const CDVector& horizontal, std::uint64_t pixel = 0,
                               double distance = 5) {
  const CDVector d = normalized(to_viewer);
  return {at + d * distance, -d, horizontal, pixel, 0, 0};
}

// Through the opening of the globe: a point of its bottom.
inline Radiometry::Ray intoGlobe() {
  return looking({0.3, 0.1, -0.9}, {0.1, 0.2, 1}, {1, 0, 0});
}

// Mean of each Stokes component over `pixels` keys, and the standard error of that mean.
struct Estimate {
  std::array<double, 4> mean{}, error{};
};

template <class RayOf>
Estimate estimateOver(const World& world, const RadiometryOptions& options, RayOf rayOf,
                      std::uint64_t pixels) {
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  std::array<double, 4> sum{}, squares{}, out{};
  for (std::uint64_t pixel = 0; pixel < pixels; ++pixel) {
    const Radiometry::Ray ray = rayOf(pixel);
    radiometry.radiance({&ray, 1}, out);
    for (std::size_t c = 0; c < 4; ++c) sum[c] += out[c], squares[c] += out[c] * out[c];
  }
  Estimate made;
  const auto n = static_cast<double>(pixels);
  for (std::size_t c = 0; c < 4; ++c) {
    made.mean[c] = sum[c] / n;
    made.error[c] = std::sqrt(std::max(0.0, squares[c] / n - made.mean[c] * made.mean[c]) / n);
  }
  return made;
}

inline Estimate estimate(const World& world, const RadiometryOptions& options,
                         Radiometry::Ray ray, std::uint64_t pixels) {
  const auto rayOf = [&](std::uint64_t pixel) {
    ray.pixel = pixel;
    return ray;
  };
  return estimateOver(world, options, rayOf, pixels);
}
}  // namespace malus::testing
