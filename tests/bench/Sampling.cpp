// What an error costs: error, time and their product for every sampling, beside a peer's.
#include "Sampling.hpp"

#include <fmt/format.h>

#include <string>
#include <tuple>

#include "thesis/OwnSampling.hpp"

using namespace malus;

namespace {
constexpr int side = 128, rays = 64;

void print(const CDSamplingRun& run, const std::string& note = "") {
  const double seconds = 4 * run.seconds;  // 256 x 256 pixels are four times as many
  fmt::print("{:24} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:9.3f} {:10.4f}\n", run.sampler + note,
             run.errors[0], run.errors[1], run.errors[2], run.errors[3], seconds,
             run.errors[0] * seconds);
}
}  // namespace

void printSamplings() {
  fmt::print(
      "\nError x time: copper chunky bar, 1 polarised band, {} rays from the first surface, "
      "256 x 256 pixels (timed on {} x {})\n"
      "{:24} {:>8} {:>8} {:>8} {:>8} {:>9} {:>10}\n",
      rays, side, side, "rms error / mean S0", "S0", "S1", "S2", "S3", "seconds", "S0 x s");
  for (const CDSamplingRun& run :
       measureSamplings(side, {rays}, 1, 1024, CDSamplingSky::uniform))
    print(run);
  for (const CDSamplingRun& run :
       measureSamplings(side, {rays}, 2, 512, CDSamplingSky::uniform, "sobol"))
    print(run, ", sky twice");
  fmt::print(
      "Mitsuba 3.8 (measured elsewhere on two cores, two reflections that see the sky, 64 "
      "paths):\n");
  for (const auto& [mode, error, seconds] : {std::tuple{"LLVM", 0.167, 2.1},
                                             {"LLVM, sun weighted", 0.116, 2.1},
                                             {"scalar", 0.167, 8.7}})
    fmt::print("{:24} {:8.3f} {:8} {:8} {:8} {:9.3f} {:10.4f}\n", mode, error, "", "", "",
               seconds, error * seconds);
}
