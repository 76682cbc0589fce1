// What an error costs: error, time and their product for every sampling, and the time to a peer's error.
#include "Sampling.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "malus/thesis/XSampling.hpp"
#include "malus/thesis/XSpeed.hpp"

using namespace malus;

namespace {
constexpr int side = 128;
// 256 x 256 pixels are four times as many; two processors share the work
constexpr double scale = 4 / 2.0;

/// Mitsuba 3.8, measured elsewhere on two cores: two reflections that see the sky; 256 paths for one band, 64 for a hundred.
struct Peer {
  const char* mode;
  double error, seconds;
};
constexpr Peer one_band[] = {
    {"LLVM", 0.167, 1.95}, {"LLVM, sun weighted", 0.116, 1.95}, {"scalar", 0.167, 8.7}};
constexpr Peer hundred_bands[] = {{"LLVM, 100 bands", 0.327, 64},
                                  {"scalar, 100 bands", 0.327, 219}};

std::vector<SamplingRun> measure(SamplingTask task) {
  task.side = side;
  std::vector<SamplingRun> runs;
  for (SamplingRun& run : measureSamplings(task))
    if (run.sampler != "reference") runs.push_back(std::move(run));
  return runs;
}

void print(const std::vector<SamplingRun>& runs, const std::string& note) {
  for (const SamplingRun& run : runs)
    fmt::print("{:28} {:4} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:9.3f} {:10.4f}\n",
               run.sampler + note, run.rays, run.errors[0], run.errors[1], run.errors[2],
               run.errors[3], scale * run.seconds, run.errors[0] * scale * run.seconds);
}

/// Seconds to an error of S0: between neighbours a line on logarithmic axes, from the fewest rays on.
double secondsTo(double error, const std::vector<SamplingRun>& runs) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].errors[0] > error) continue;
    if (i == 0) return scale * runs[0].seconds;
    const SamplingRun &before = runs[i - 1], &after = runs[i];
    const double t =
        std::log(before.errors[0] / error) / std::log(before.errors[0] / after.errors[0]);
    return scale * before.seconds * std::pow(after.seconds / before.seconds, t);
  }
  return std::nan("");
}

template <std::size_t N>
void compare(const Peer (&peers)[N], const std::vector<SamplingRun>& runs) {
  for (const Peer& peer : peers) {
    const double ours = secondsTo(peer.error, runs);
    fmt::print(
        "{:28}      {:8.3f} {:26} {:9.3f} {:10.4f}   ours {:.3f} s to this error: {:.0f} times "
        "faster\n",
        peer.mode, peer.error, "", peer.seconds, peer.error * peer.seconds, ours,
        peer.seconds / ours);
  }
}
}  // namespace

void printSamplings() {
  fmt::print(
      "\nError x time: copper chunky bar, polarised, 256 x 256 pixels (timed on {0} x {0}; "
      "processor time over two)\n"
      "{1:28} {2:>4} {3:>8} {4:>8} {5:>8} {6:>8} {7:>9} {8:>10}\n",
      side, "rms error / mean S0", "rays", "S0", "S1", "S2", "S3", "seconds", "S0 x s");
  print(measure({}), "");
  const std::vector<int> rays{1, 2, 4, 8, 16, 32, 64};
  const auto one =
      measure({.rays = rays, .second = 2, .reference_rays = 512, .only = "images"});
  const auto hundred = measure(
      {.rays = rays, .second = 2, .reference_rays = 256, .only = "images", .bands = 100});
  print(one, ", sky twice");
  print(hundred, ", 100 bands");
  fmt::print(
      "Mitsuba 3.8 (measured elsewhere on two cores; two reflections that see the sky):\n");
  compare(one_band, one);
  compare(hundred_bands, hundred);
  const ScalarRatio scalar = timeAgainstScalar();
  fmt::print(
      "\nC5: an unpolarised picture takes {:.2f} ({:.2f} to {:.2f}) of a scalar renderer's "
      "time\n",
      scalar.ratio, scalar.lowest, scalar.highest);
}
