// Light that particles scatter once, turned into and out of the plane of scattering by vectors.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "malus/air/Scatterer.hpp"
#include "malus/base/CDVector.hpp"
#include "malus/light/CDPolarimetricMath.hpp"

namespace malus::testing {
/// Largest difference of a component.
inline double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a.getStokes(i) - b.getStokes(i)));
  return most;
}

inline CDMuellerMatrix muellerOf(const ScatteringMatrix& f) {
  return CDMuellerMatrix(std::array<double, 16>{f.a1, f.b1, 0, 0, f.b1, f.a2, 0, 0, 0, 0, f.a3,
                                                f.b2, 0, 0, -f.b2, f.a4});
}

/// From one direction of travel into another, both in the axes of rayFrame(k, +z).
inline CDStokesVector scattered(const Scatterer& scatterer, CDStokesVector light,
                                const CDVector& from, const CDVector& to) {
  const CDVector up{0, 0, 1}, s = normalized(cross(from, to));
  const RayFrame in{s, cross(from, s), from}, out{s, cross(to, s), to};
  light.rotate(frameRotation(rayFrame(from, up), in));
  light = muellerOf(scatterer.matrix(dot(from, to))) * light;
  return light.rotate(frameRotation(out, rayFrame(to, up)));
}
}  // namespace malus::testing
