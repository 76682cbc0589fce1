// Degree of polarisation of the clear sky in the sun's meridian, 550 nm, sun 60 deg from the zenith.
#include <cmath>
#include <cstdio>
#include <malus/air/RayleighLight.hpp>
#include <malus/base/Angles.hpp>
#include <numbers>

int main() {
  using namespace malus;
  constexpr double tau_550nm = 0.09707, albedo = 0.2;
  const RayleighAtmosphere air(tau_550nm, 0.0279);  // optical depth, depolarisation factor
  const RayleighLight light(air, std::cos(60 * degree), albedo, 1.0);
  std::puts("zenith_deg,DoLP");
  for (int zenith = -80; zenith <= 80; zenith += 20) {
    // zenith angles below zero lie on the sun's side
    const auto azimuth = RayleighLight::Azimuth::fromRadians(zenith < 0 ? 0 : std::numbers::pi);
    const CDStokesVector s = light.down(std::cos(zenith * degree), azimuth);
    std::printf("%d,%.4f\n", zenith, s.getDOLP());
  }
}
