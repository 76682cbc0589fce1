// `make bench`: the inner loops of the product beside bare loops that do the same, in one process, their
// repetitions interleaved so that both meet the same machine; at the end the ratio of the medians.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Bare.hpp"
#include "Sampling.hpp"
#include "malus/air/Sun.hpp"
#include "malus/base/Random.hpp"
#include "malus/base/Table.hpp"
#include "malus/light/CDSpectralVector.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/DirectionSampling.hpp"
#include "malus/surface/ModelRegistry.hpp"
#include "malus/surface/MuellerTable.hpp"

using namespace malus;

namespace {
constexpr double sigma = 0.2;
constexpr std::size_t directions = 256;

/// Pairs of unit vectors over a surface, at most 80 degrees from its normal.
struct Rays {
  std::vector<CDVector> to_source, to_viewer;
  Rays() {
    Random random(2002);
    for (std::size_t i = 0; i < directions; ++i)
      for (auto* list : {&to_source, &to_viewer}) {
        const double zenith = 1.4 * random.uniform();
        list->push_back(CDVector::fromAngles(zenith, 6.28 * random.uniform()));
      }
  }
};
const Rays& rays() {
  static const Rays the_rays;
  return the_rays;
}

/// A metal and light on so many bands, as spectra and as bare arrays.
struct Bands {
  SpectralGridPtr grid;
  std::vector<double> n, k, e1, e2, s, out;
  CDSpectralVector<CDStokesVector> polarized, unpolarized, sum;

  explicit Bands(std::size_t count)
      : grid(gridOf(count)),
        s(4 * count),
        out(4 * count),
        polarized(grid),
        unpolarized(grid),
        sum(grid) {
    for (std::size_t j = 0; j < count; ++j) {
      const double x = static_cast<double>(j) / static_cast<double>(count);
      n.push_back(0.4 + x), k.push_back(2.9 + 2 * x);
      e1.push_back(n[j] * n[j] - k[j] * k[j]), e2.push_back(2 * n[j] * k[j]);
      s[j] = 1, s[count + j] = 0.3 * x, s[2 * count + j] = 0.2, s[3 * count + j] = -0.1;
      polarized[j] = CDStokesVector(1, 0.3 * x, 0.2, -0.1);
      unpolarized[j] = CDStokesVector(1);
    }
    sum.polarize();
  }
  static SpectralGridPtr gridOf(std::size_t count) {
    std::vector<double> nm;
    for (std::size_t j = 0; j < count; ++j) nm.push_back(400 + static_cast<double>(j));
    return SpectralGrid::make(nm);
  }
  BRDFTorranceSparrow model(TorranceSparrowOptions options) const {
    return {CDSpectralVector<double>(grid, n), CDSpectralVector<double>(grid, k),
            CDSpectralVector<double>(grid, sigma), options};
  }
};

const TorranceSparrowOptions full{Shadowing::vGroove, DiffuseTerm::none, true};
const TorranceSparrowOptions with_diffuse{Shadowing::vGroove, DiffuseTerm::thesis, true};
const TorranceSparrowOptions scalar{Shadowing::vGroove, DiffuseTerm::none, false};

/// Runs body(i) for one pair of directions after another.
template <class Body>
void loop(benchmark::State& state, Body body) {
  std::size_t i = 0;
  for (auto _ : state) {
    body(i);
    benchmark::ClobberMemory();
    i = (i + 1) % directions;
  }
}

void productScatter(benchmark::State& state, TorranceSparrowOptions options, bool polarized) {
  Bands bands(static_cast<std::size_t>(state.range(0)));
  const BRDFTorranceSparrow model = bands.model(options);
  const CDBRDFModel& brdf = model;  // through the abstract interface, as a renderer does
  const auto& in = polarized ? bands.polarized : bands.unpolarized;
  if (!options.polarized) bands.sum.demote();
  loop(state, [&](std::size_t i) {
    const auto g = BRDFGeometry::fromDirections(rays().to_source[i], rays().to_viewer[i]);
    brdf.scatter(g, 0.01, in, bands.sum);
  });
}

template <class Bare>
void bareScatter(benchmark::State& state, Bare bare) {
  Bands bands(static_cast<std::size_t>(state.range(0)));
  loop(state, [&](std::size_t i) {
    auto g = bare::facet(&rays().to_source[i].x, &rays().to_viewer[i].x, sigma);
    g.factor *= 0.01;
    bare(g, bands.n.size(), bands.e1.data(), bands.e2.data(), bands.s.data(), bands.out.data());
  });
}

// ---- single precision: the kernels alone, all of one geometry
struct FloatBands {
  std::vector<float> e1, e2, s, out;
  explicit FloatBands(const Bands& b)
      : e1(b.e1.begin(), b.e1.end()),
        e2(b.e2.begin(), b.e2.end()),
        s(b.s.begin(), b.s.end()),
        out(b.out.begin(), b.out.end()) {}
};
void productFloat(benchmark::State& state) {
  const std::size_t n = static_cast<std::size_t>(state.range(0));
  FloatBands b{Bands(n)};
  const FacetLight<float> g{0.01f, 0, 0.8f, 0.36f, 0.6f, 0.8f, 0.8f, -0.6f};
  loop(state, [&](std::size_t) {
    scatterPolarized<float>(g, n, b.e1.data(), b.e2.data(), b.s.data(), b.out.data(), n);
  });
}
void bareFloat(benchmark::State& state) {
  const std::size_t n = static_cast<std::size_t>(state.range(0));
  FloatBands b{Bands(n)};
  const bare::Facet<float> g{0.01f, 0.8f, 0.36f, 0.6f, 0.8f, 0.8f, -0.6f};
  loop(state, [&](std::size_t) {
    bare::scatter(g, n, b.e1.data(), b.e2.data(), b.s.data(), b.out.data());
  });
}

// ---- Mueller times Stokes
void productMueller(benchmark::State& state, bool by_operator) {
  Bands bands(static_cast<std::size_t>(state.range(0)));
  const auto m = bands.model(full).getBRDF(BRDFGeometry::fromDegrees(30, 40, 150));
  loop(state, [&](std::size_t) {
    if (by_operator)
      bands.sum = m * bands.polarized;
    else
      bands.sum.multiplyAdd(m, bands.polarized);
  });
}
void bareMueller(benchmark::State& state) {
  Bands bands(static_cast<std::size_t>(state.range(0)));
  const auto m = bands.model(full).getBRDF(BRDFGeometry::fromDegrees(30, 40, 150));
  loop(state, [&](std::size_t) {
    bare::multiplyAdd(bands.n.size(), m.plane(0), bands.s.data(), bands.out.data());
  });
}

// ---- models by name, as a user asks for them: one geometry and all its bands in one call of scatter()
/// Files for the models that are made from one: the lasers of nefds, and rough metal at five
/// wavelengths as a table. They go with the process.
struct Tables {
  std::filesystem::path directory =
      std::filesystem::temp_directory_path() / fmt::format("malus-bench-{}", ::getpid());
  std::string lasers = (directory / "lasers.csv").string(),
              matrices = (directory / "metal.pbsdf").string();
  Tables() {
    std::filesystem::create_directory(directory);
    writeWhole(lasers, "wavelength_nm,n,k,bias,sigma\n400,1.5,0,.02,.2\n700,1.5,0,.03,.2\n");
    const auto grid = SpectralGrid::make({400, 470, 540, 610, 680});
    const BRDFTorranceSparrow metal({grid, 0.4}, {grid, 2.9}, {grid, sigma});
    writeWhole(matrices, tensorFile(tabulate(metal, 24)));
  }
  ~Tables() { std::filesystem::remove_all(directory); }
};
const Tables& tables() {
  static const Tables the_tables;
  return the_tables;
}
struct NamedModel {
  const char* name;
  std::map<std::string, std::string> parameters;  // those without a default
};
const std::vector<NamedModel>& namedModels() {
  static const std::vector<NamedModel> models{
      {"torrance-sparrow", {{"n", "1.5"}, {"k", "2"}, {"sigma", "0.2"}}},
      {"lambertian", {{"reflectance", "0.5"}}},
      {"dirsig", {{"reflectance", "0.1"}, {"height", "1"}, {"width", "20"}}},
      {"glossy-coating", {{"n", "1.5"}, {"reflectance", "0.5"}, {"sigma", "0.1"}}},
      {"layered-paint",
       {{"pigment_n", "2.75"},
        {"radius_nm", "110"},
        {"pvc", "0.1"},
        {"thickness_um", "5"},
        {"sigma", "0.1"}}},
      {"rough-water", {{"wind_m_s", "5"}, {"reflectance", "0.02"}}},
      {"beard-maxwell",
       {{"n", "1.5"}, {"k", "0"}, {"bias", "0.002"}, {"sigma", "0.2"}, {"rho_v", "0.01"}}},
      {"nadal-breon", {{"reflectance", "0.1"}, {"rho", "0.03"}, {"beta", "8"}}},
      {"robertson-sandford",
       {{"emissivity", "0.5"}, {"diffuse", "0.3"}, {"b", "0.2"}, {"e", "0.3"}}},
      {"nefds", {{"file", tables().lasers}, {"dhr", "0.4"}, {"dhr_zenith_deg", "20"}}},
      {"measured", {{"file", tables().matrices}}},
      {"basis", {{"file", (solarSpectrumFile().parent_path() / "basis-coating.csv").string()}}},
  };
  return models;
}
const std::vector<int> named_model_bands{1, 256};

void scatterByName(benchmark::State& state, const NamedModel& named) {
  Bands bands(static_cast<std::size_t>(state.range(0)));
  const ModelEntry& entry = modelEntry(named.name, {});
  Arguments arguments;
  for (const auto& [name, text] : named.parameters) arguments[name] = {text, {}};
  // made once: the benchmark is run several times, and a paint takes a tenth of a second a band
  static std::map<std::pair<std::string, std::size_t>, std::shared_ptr<const CDBRDFModel>> made;
  auto& brdf = made[{named.name, bands.grid->size()}];
  if (!brdf) brdf = entry.make(checkedSettings(entry, arguments, bands.grid));
  loop(state, [&](std::size_t i) {
    const auto g = BRDFGeometry::fromDirections(rays().to_source[i], rays().to_viewer[i]);
    brdf->scatter(g, 0.01, bands.polarized, bands.sum);
  });
}

// ---- the list of pairs; the name before the last slash is what is compared
void add(const std::string& name, const std::vector<int>& bands,
         const std::function<void(benchmark::State&)>& product,
         const std::function<void(benchmark::State&)>& bare) {
  for (const int n : bands) {
    benchmark::RegisterBenchmark(fmt::format("{}/{}/product", name, n).c_str(), product)
        ->Arg(n);
    benchmark::RegisterBenchmark(fmt::format("{}/{}/bare", name, n).c_str(), bare)->Arg(n);
  }
}

void registerAll() {
  using State = benchmark::State;
  add(
      "polarised light", {1, 8, 64, 256}, [](State& s) { productScatter(s, full, true); },
      [](State& s) { bareScatter(s, bare::scatter<double>); });
  add(
      "polarised light, with the diffuse term", {1, 256},
      [](State& s) { productScatter(s, with_diffuse, true); },
      [](State& s) { bareScatter(s, bare::scatter<double>); });
  add(
      "unpolarised light", {1, 256}, [](State& s) { productScatter(s, full, false); },
      [](State& s) { bareScatter(s, bare::scatterUnpolarized<double>); });
  add(
      "unpolarised model", {1, 256}, [](State& s) { productScatter(s, scalar, false); },
      [](State& s) { bareScatter(s, bare::scatterScalar<double>); });
  add("single precision, one geometry", {256}, productFloat, bareFloat);
  add(
      "Mueller x Stokes added", {1, 8, 64, 256}, [](State& s) { productMueller(s, false); },
      bareMueller);
  add(
      "Mueller x Stokes as a new spectrum", {1, 8, 64, 256},
      [](State& s) { productMueller(s, true); }, bareMueller);
}

void registerModels() {
  for (const NamedModel& named : namedModels())
    for (const int n : named_model_bands)
      benchmark::RegisterBenchmark(fmt::format("{}/{}/model", named.name, n).c_str(),
                                   [&named](benchmark::State& s) { scatterByName(s, named); })
          ->Arg(n);
}

/// Prints as the console reporter does, keeps every repetition, and compares medians at the end.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  RatioReporter() : ConsoleReporter(OO_Tabular) {}
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred)
        times_[run.run_name.function_name].push_back(run.GetAdjustedCPUTime());
  }
  void Finalize() override;
  void printModels() const;

 private:
  double median(const std::string& name) const {
    const auto found = times_.find(name);
    if (found == times_.end()) return std::nan("");
    std::vector<double> t = found->second;
    std::nth_element(t.begin(), t.begin() + static_cast<long>(t.size() / 2), t.end());
    return t[t.size() / 2];
  }
  std::map<std::string, std::vector<double>> times_;
};

void row(const std::string& name, double product, double bare) {
  fmt::print("{:<52} {:>10.2f} {:>10.2f} {:>8.2f}{}\n", name, product, bare, product / bare,
             product > 2 * bare ? "  above 2" : "");
}

void RatioReporter::Finalize() {
  fmt::print("\n{:<52} {:>10} {:>10} {:>8}\n", "median CPU time of one call [ns]", "product",
             "bare", "ratio");
  std::map<std::string, std::array<std::map<int, double>, 2>> curves;
  for (const auto& [name, times] : times_) {
    if (name.ends_with("/model")) continue;
    const std::size_t slash = name.rfind('/'), before = name.rfind('/', slash - 1);
    const int bands = std::stoi(name.substr(before + 1, slash - before - 1));
    curves[name.substr(0, before)][name.substr(slash + 1) == "bare"][bands] = median(name);
  }
  for (const auto& [name, pair] : curves)
    for (const auto& [bands, time] : pair[0])
      if (pair[1].count(bands))
        row(fmt::format("{}, {} band{}", name, bands, bands == 1 ? "" : "s"), time,
            pair[1].at(bands));
  fmt::print("\n{:<52} {:>10} {:>10} {:>8}\n", "each further band [ns]", "product", "bare",
             "ratio");
  for (const auto& [name, pair] : curves) {
    const auto slope = [](const std::map<int, double>& t) {
      const int first = t.begin()->first, last = t.rbegin()->first;
      return first == last ? t.begin()->second / first
                           : (t.rbegin()->second - t.begin()->second) / (last - first);
    };
    if (!pair[0].empty() && !pair[1].empty()) row(name, slope(pair[0]), slope(pair[1]));
  }
  printModels();
}

void RatioReporter::printModels() const {
  fmt::print("\n{:<52} {:>10} {:>10}\n", "every model, polarised light [ns]", "1 band",
             "each more");
  const int few = named_model_bands.front(), many = named_model_bands.back();
  for (const NamedModel& named : namedModels()) {
    const double one = median(fmt::format("{}/{}/model", named.name, few));
    const double all = median(fmt::format("{}/{}/model", named.name, many));
    if (!std::isnan(one))
      fmt::print("{:<52} {:>10.2f} {:>10.2f}\n", named.name, one, (all - one) / (many - few));
  }
}
}  // namespace

int main(int argc, char** argv) {
  // the user's own flags come last and win
  std::vector<std::string> arguments{argv[0], "--benchmark_repetitions=9",
                                     "--benchmark_min_time=0.03",
                                     "--benchmark_enable_random_interleaving=true"};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(count, pointers.data())) return 2;
  registerAll();
  registerModels();
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  printSamplings();
  return 0;
}
