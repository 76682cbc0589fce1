// What an error costs: error, time and their product for every sampling, beside a peer's.
#include "Sampling.hpp"

#include <fmt/format.h>

#include <string>
#include <tuple>

#include "thesis/OwnSampling.hpp"

using namespace malus;

namespace {
constexpr int side = 128, rays = 64;

void print(CDSamplingTask task, const std::string& note) {
  task.side = side, task.rays = {rays};
  for (const CDSamplingRun& run : measureSamplings(task)) {
    if (run.sampler == "reference") continue;
    const double seconds = 4 * run.seconds;  // 256 x 256 pixels are four times as many
    const auto& e = run.errors;
    fmt::print("{:24} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:9.3f} {:10.4f}\n", run.sampler + note,
               e[0], e[1], e[2], e[3], seconds, e[0] * seconds);
  }
}
}  // namespace

void printSamplings() {
  fmt::print(
      "\nError x time: copper chunky bar, 1 polarised band, {} rays from the first surface, "
      "256 x 256 pixels "
      "(timed on {} x {})\n{:24} {:>8} {:>8} {:>8} {:>8} {:>9} {:>10}\n",
      rays, side, side, "rms error / mean S0", "S0", "S1", "S2", "S3", "seconds", "S0 x s");
  print({}, "");
  print({.second = 2, .reference_rays = 512, .only = "sobol"}, ", sky twice");
  print({.second = 2, .reference_rays = 256, .only = "sobol", .bands = 100}, ", 100 bands");
  fmt::print(
      "Mitsuba 3.8 (measured elsewhere on two cores; two reflections that see the sky, 64 "
      "paths):\n");
  for (const auto& [mode, error, seconds] : {std::tuple{"LLVM", 0.167, 2.1},
                                             {"LLVM, sun weighted", 0.116, 2.1},
                                             {"scalar", 0.167, 8.7},
                                             {"LLVM, 100 bands", 0.167, 64.0},
                                             {"scalar, 100 bands", 0.167, 219.0}})
    fmt::print("{:24} {:8.3f} {:26} {:9.3f} {:10.4f}\n", mode, error, "", seconds,
               error * seconds);
}
