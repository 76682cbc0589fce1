// The Rayleigh sky: what an atmosphere, a direction, and a sky of many bands cost. The counter "off" is the worst
// deviation of I, Q, U from a printed value (Natraj, Li and Yung 2009: tau 0.5, albedo 0.25, mu0 0.6, mu 0.4, 90 deg).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "world/CDRayleighSky.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const CDRayleighLight::Azimuth across{0, 1};

double off(const CDStokesVector& light) {
  return std::max({std::abs(light.getStokes(0) - 0.22239883),
                   std::abs(light.getStokes(1) + 0.05505941),
                   std::abs(light.getStokes(2) - 0.11112462)});
}

CDRayleighSky skyOf(int bands) {
  std::vector<double> nm;
  for (int b = 0; b < bands; ++b) nm.push_back(400 + 600.0 * b / bands);
  const auto grid = CDSpectralGrid::make(nm);
  const CDSun sun{compassDirection(0.5, 2), CDSpectralVector<CDStokesVector>(grid, 1.0)};
  return CDRayleighSky(sun, CDRayleighSky::clearAir(grid, 0.2));
}
}  // namespace

static void rayleighAtmosphereAndSun(benchmark::State& state) {
  CDStokesVector light;
  for (auto _ : state) {
    const CDRayleighAtmosphere air(0.5);
    light = CDRayleighLight(air, 0.6, 0.25, pi).down(0.4, across);
    benchmark::DoNotOptimize(light);
  }
  state.counters["off"] = off(light);
}
BENCHMARK(rayleighAtmosphereAndSun)->Unit(benchmark::kMillisecond);

static void rayleighAnotherSun(benchmark::State& state) {
  const CDRayleighAtmosphere air(0.5);
  for (auto _ : state)
    benchmark::DoNotOptimize(CDRayleighLight(air, 0.6, 0.25, pi).groundRadiance());
}
BENCHMARK(rayleighAnotherSun)->Unit(benchmark::kMicrosecond);

static void rayleighExactDirection(benchmark::State& state) {
  const CDRayleighLight light(CDRayleighAtmosphere(0.5), 0.6, 0.25, pi);
  double mu = 0.4;
  for (auto _ : state) {
    benchmark::DoNotOptimize(mu);
    benchmark::DoNotOptimize(light.down(mu, across));
  }
  state.counters["off"] = off(light.down(0.4, across));
}
BENCHMARK(rayleighExactDirection)->Unit(benchmark::kNanosecond);

static void rayleighTabulate(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(skyOf(static_cast<int>(state.range(0))).toSun());
}
BENCHMARK(rayleighTabulate)->Arg(1)->Arg(100)->Unit(benchmark::kMillisecond)->UseRealTime();

static void rayleighTableDirection(benchmark::State& state) {
  const CDRayleighSky sky = skyOf(static_cast<int>(state.range(0)));
  CDSpectralVector<CDStokesVector> out(sky.grid());
  CDVector direction = compassDirection(0.9, 4);
  for (auto _ : state) {
    benchmark::DoNotOptimize(direction);
    sky.radiance(direction, out);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(rayleighTableDirection)->Arg(1)->Arg(100)->Unit(benchmark::kNanosecond);

BENCHMARK_MAIN();
