// The Rayleigh sky: what an atmosphere, a direction, and a sky of many bands cost. The counter "off" is the worst
// deviation of I, Q, U from a printed value (Natraj, Li and Yung 2009: tau 0.5, albedo 0.25, mu0 0.6, mu 0.4, 90 deg).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "malus/air/AddingDoubling.hpp"
#include "malus/air/AerosolSky.hpp"
#include "malus/air/LayeredLight.hpp"
#include "malus/air/RayleighAir.hpp"
#include "malus/air/RayleighSky.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const RayleighLight::Azimuth across{0, 1};

double off(const CDStokesVector& light) {
  return std::max({std::abs(light.getStokes(0) - 0.22239883),
                   std::abs(light.getStokes(1) + 0.05505941),
                   std::abs(light.getStokes(2) - 0.11112462)});
}

RayleighSky skyOf(int bands) {
  std::vector<double> nm;
  for (int b = 0; b < bands; ++b) nm.push_back(400 + 600.0 * b / bands);
  const auto grid = SpectralGrid::make(nm);
  const Sun sun{compassDirection(0.5, 2), CDSpectralVector<CDStokesVector>(grid, 1.0)};
  return RayleighSky(sun, RayleighSky::clearAir(grid, 0.2));
}
}  // namespace

static void rayleighAtmosphereAndSun(benchmark::State& state) {
  CDStokesVector light;
  for (auto _ : state) {
    const RayleighAtmosphere air(0.5);
    light = RayleighLight(air, 0.6, 0.25, pi).down(0.4, across);
    benchmark::DoNotOptimize(light);
  }
  state.counters["off"] = off(light);
}
BENCHMARK(rayleighAtmosphereAndSun)->Unit(benchmark::kMillisecond);

static void rayleighAnotherSun(benchmark::State& state) {
  const RayleighAtmosphere air(0.5);
  for (auto _ : state)
    benchmark::DoNotOptimize(RayleighLight(air, 0.6, 0.25, pi).groundRadiance());
}
BENCHMARK(rayleighAnotherSun)->Unit(benchmark::kMicrosecond);

static void rayleighExactDirection(benchmark::State& state) {
  const RayleighLight light(RayleighAtmosphere(0.5), 0.6, 0.25, pi);
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
  const RayleighSky sky = skyOf(static_cast<int>(state.range(0)));
  CDSpectralVector<CDStokesVector> out(sky.grid());
  CDVector direction = compassDirection(0.9, 4);
  for (auto _ : state) {
    benchmark::DoNotOptimize(direction);
    sky.radiance(direction, out);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(rayleighTableDirection)->Arg(1)->Arg(100)->Unit(benchmark::kNanosecond);

// As the renderer asks: 512 directions of a hemisphere at once, in single precision; the time is that of one of them.
static void rayleighManyDirections(benchmark::State& state) {
  const RayleighSky sky = skyOf(static_cast<int>(state.range(0)));
  std::vector<float> x, y, z;
  for (int i = 0; i < 512; ++i) {
    const CDVector d = CDVector::fromAngles(std::acos((i + 0.5) / 512), 2.4 * i);
    x.push_back(static_cast<float>(d.x)), y.push_back(static_cast<float>(d.y));
    z.push_back(static_cast<float>(d.z));
  }
  std::vector<float> out(512 * 4 * static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    sky.radiances({x.size(), x.data(), y.data(), z.data()}, out);
    benchmark::ClobberMemory();
  }
  state.counters["directions"] =
      benchmark::Counter(512, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(rayleighManyDirections)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);

// Adding and doubling: the same sky, by streams, 32 being the default; "off" as above, "flat" the largest deviation from the
// exact solution at mu = 0.02 and an optical depth of 0.01, where it is largest.
static void doublingRayleigh(benchmark::State& state) {
  const int streams = static_cast<int>(state.range(0));
  CDStokesVector light;
  for (auto _ : state) {
    light = AddingDoubling({{{rayleighScatterer(0), 0.5}}}, 0.6, 0.25, pi, {0.4}, {streams, -1})
                .down(0, pi / 2);
    benchmark::DoNotOptimize(light);
  }
  state.counters["off"] = off(light);
  const AddingDoubling thin({{{rayleighScatterer(0), 0.01}}}, 0.6, 0.25, pi, {0.02},
                            {streams, -1});
  const CDStokesVector exact =
      RayleighLight(RayleighAtmosphere(0.01), 0.6, 0.25, pi).down(0.02, across);
  double flat = 0;
  for (int k = 0; k < 3; ++k)
    flat = std::max(flat, std::abs(thin.down(0, pi / 2).getStokes(k) - exact.getStokes(k)));
  state.counters["flat"] = flat;
}
BENCHMARK(doublingRayleigh)
    ->Arg(8)
    ->Arg(12)
    ->Arg(16)
    ->Arg(24)
    ->Arg(32)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Air with an aerosol that has so many terms (Henyey and Greenstein): all harmonics, one line of sight.
static void doublingAerosol(benchmark::State& state) {
  const double g = static_cast<double>(state.range(0)) / 100;
  const Scatterer aerosol = henyeyGreensteinScatterer(g);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        AddingDoubling({{{rayleighScatterer(0.03), 0.2}, {aerosol, 0.1}}}, 0.6, 0.25, pi, {0.4})
            .down(0, pi / 2));
  state.counters["terms"] = static_cast<double>(aerosol.terms().size());
}
BENCHMARK(doublingAerosol)
    ->Arg(30)
    ->Arg(50)
    ->Arg(70)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// The same by successive orders (ch. LayeredLight), and its cost by streams and by layers, with the exponents that fit best.
static void layeredAerosol(benchmark::State& state) {
  const double g = static_cast<double>(state.range(0)) / 100;
  const Scatterer aerosol = henyeyGreensteinScatterer(g);
  int rounds = 0;
  for (auto _ : state) {
    const LayeredLight light({{{rayleighScatterer(0.03), 0.2}, {aerosol, 0.1}}}, 0.6, {0.25},
                             pi, {0.4}, {0.3});
    benchmark::DoNotOptimize(light.down(0, pi / 2, 0));
    rounds = light.rounds();
  }
  state.counters["terms"] = static_cast<double>(aerosol.terms().size());
  state.counters["rounds"] = rounds;
}
BENCHMARK(layeredAerosol)
    ->Arg(30)
    ->Arg(50)
    ->Arg(70)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

static void solveLayers(benchmark::State& state, int layers, int streams) {
  const Scatterer aerosol = henyeyGreensteinScatterer(0.7), air = rayleighScatterer(0.03);
  const std::vector<AirLayer> all(static_cast<std::size_t>(layers),
                                  {{air, 0.2 / layers}, {aerosol, 0.3 / layers}});
  for (auto _ : state)
    benchmark::DoNotOptimize(LayeredLight(all, 0.6, {0.25}, pi, {0.4}, {0},
                                          {.streams = streams, .terms = 32, .thinnest = 1e-4}));
  state.SetComplexityN(state.range(0));
}
static void layeredByStreams(benchmark::State& state) {
  solveLayers(state, 1, static_cast<int>(state.range(0)));
}
static void layeredByLayers(benchmark::State& state) {
  solveLayers(state, static_cast<int>(state.range(0)), 32);
}
BENCHMARK(layeredByStreams)
    ->RangeMultiplier(2)
    ->Range(32, 256)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Complexity();
BENCHMARK(layeredByLayers)
    ->RangeMultiplier(2)
    ->Range(4, 64)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Complexity();

// A table for a scene: a dome of 181 heights over hazy ground, one band.
static void layeredDome(benchmark::State& state) {
  std::vector<double> cosines;
  for (int i = 0; i <= 180; ++i) cosines.push_back(std::max(1e-6, std::cos(i * pi / 360)));
  const Scatterer aerosol = henyeyGreensteinScatterer(0.7);
  for (auto _ : state)
    benchmark::DoNotOptimize(LayeredLight({{{rayleighScatterer(0.03), 0.2}, {aerosol, 0.3}}},
                                          0.6, {0.25}, pi, cosines, {0.5}));
}
BENCHMARK(layeredDome)->Unit(benchmark::kMillisecond)->UseRealTime();

static void doublingDome(benchmark::State& state) {
  std::vector<double> cosines;
  for (int i = 0; i <= 180; ++i) cosines.push_back(std::max(1e-6, std::cos(i * pi / 360)));
  const Scatterer aerosol = henyeyGreensteinScatterer(0.7);
  for (auto _ : state)
    benchmark::DoNotOptimize(AddingDoubling({{{rayleighScatterer(0.03), 0.2}, {aerosol, 0.3}}},
                                            0.6, 0.25, pi, cosines));
}
BENCHMARK(doublingDome)->Unit(benchmark::kMillisecond)->UseRealTime();

// A band of a hazy scene as the renderer gets it: its dome, and path radiance and transmission before the camera; several bands
// share what does not depend on the wavelength. The counter is the time of one band, its aim one second.
static void hazyScene(benchmark::State& state) {
  const auto bands = static_cast<std::size_t>(state.range(0));
  std::vector<double> nm;
  for (std::size_t b = 0; b < bands; ++b)
    nm.push_back(400 + 600.0 * static_cast<double>(b) / static_cast<double>(bands));
  const auto grid = SpectralGrid::make(nm);
  const Sun sun{compassDirection(0.9, 2), CDSpectralVector<CDStokesVector>(grid, 1.0)};
  const auto aerosol =
      std::make_shared<const Aerosol>(Aerosol{henyeyGreensteinScatterer(0.7), 1, ""});
  std::vector<SkyAir> air;
  for (std::size_t b = 0; b < bands; ++b) {
    SkyAir one{rayleighOpticalDepth(nm[b]), rayleighDepolarization(nm[b]), 0.2};
    one.aerosol_depth = 0.3 * 550 / nm[b], one.aerosol = aerosol, one.aerosol_scale_m = 1500;
    air.push_back(std::move(one));
  }
  for (auto _ : state) benchmark::DoNotOptimize(aerosolSky(sun, air, true));
  state.counters["band"] = benchmark::Counter(
      static_cast<double>(bands),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(hazyScene)->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond)->UseRealTime();

BENCHMARK_MAIN();
