// `make bench`: whole pictures beside bare loops over Embree that make the same ones, in one process and by turns. Processor time
// of one thread; a picture of 256 x 256 pixels on two threads takes half of what is printed. Mean S0 of both must agree,
// or they were not the same work.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "BareImage.hpp"
#include "Scenes.hpp"
#include "malus/air/RayleighSky.hpp"
#include "malus/render/Radiometry.hpp"
#include "malus/render/Scene.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr std::size_t pixels = 256;
constexpr double height = 15, width = 10;

double processorSeconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Pair {  // one scene, for both
  World world;
  std::shared_ptr<const RayTracer> tracer;
  bare::Scene bare;
};

struct Shape {
  std::vector<CDVector> vertices;
  std::vector<Triangle> triangles;
  void quad(const CDVector& a, const CDVector& b, const CDVector& c, const CDVector& d,
            std::uint32_t material) {
    const auto n = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c, d});
    triangles.push_back({n, n + 1, n + 2, 0, material});
    triangles.push_back({n, n + 2, n + 3, 0, material});
  }
};

/// The chunky bar of section 7.5 on a large square of ground; materials 0..3 copper, 4 soil.
Shape chunkyBar() {
  Shape s;
  s.quad({-500, -500, 0}, {500, -500, 0}, {500, 500, 0}, {-500, 500, 0}, 4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double x = i & 1 ? 2 : -2, y = i & 2 ? 2 : -2;
    const auto corner = [&](int k, double half, double z) {
      return CDVector{x + (k == 1 || k == 2 ? half : -half), y + (k >= 2 ? half : -half), z};
    };
    s.quad(corner(0, 0.75, 1), corner(1, 0.75, 1), corner(2, 0.75, 1), corner(3, 0.75, 1), i);
    for (int k = 0; k < 4; ++k) {
      const int l = (k + 1) % 4;
      s.quad(corner(k, 1.5, 0), corner(l, 1.5, 0), corner(l, 0.75, 1), corner(k, 0.75, 1), i);
    }
  }
  return s;
}

/// Waves of copper, two triangles a cell.
Shape waves(std::uint32_t cells) {
  Shape s;
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = -10 + 20.0 * i / cells, y = -10 + 20.0 * j / cells;
      s.vertices.push_back(
          {x, y, 0.6 * std::sin(2.1 * x) * std::cos(1.7 * y) + 0.15 * std::sin(9 * x + 3 * y)});
    }
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, c = a + cells + 2;
      s.triangles.push_back({a, a + 1, c, 0, 2});
      s.triangles.push_back({a, c, c - 1, 0, 2});
    }
  return s;
}

std::unique_ptr<Pair> makePair(const Shape& shape, std::size_t bands, bool polarized) {
  auto pair = std::make_unique<Pair>();
  std::vector<double> nm, n, k;
  for (std::size_t j = 0; j < bands; ++j) {
    nm.push_back(400 + double(j)), n.push_back(0.4 + 0.001 * double(j)),
        k.push_back(2.95 + 0.002 * double(j));
    pair->bare.e1.push_back(float(n[j] * n[j] - k[j] * k[j])),
        pair->bare.e2.push_back(float(2 * n[j] * k[j]));
  }
  const auto grid = pair->world.grid = SpectralGrid::make(nm);
  Mesh mesh;
  mesh.vertices = shape.vertices, mesh.triangles = shape.triangles;
  mesh.facets = {"f"}, mesh.materials = {"c0", "c1", "c2", "c3", "soil"};
  GeometryBuilder builder;
  builder.addMesh(mesh, {});
  pair->world.geometry = std::move(builder).build();
  const std::array<double, 4> sigma{0.1, 0.15, 0.2, 0.3};
  for (const std::string& name : pair->world.geometry.materialNames()) {
    const bool soil = name == "soil";
    const double rough = soil ? 0 : sigma[static_cast<std::size_t>(name[1] - '0')];
    std::shared_ptr<const CDBRDFModel> model;
    if (soil)
      model = std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(grid, 0.2));
    else
      model = std::make_shared<BRDFTorranceSparrow>(
          CDSpectralVector<double>(grid, n), CDSpectralVector<double>(grid, k),
          CDSpectralVector<double>(grid, rough),
          TorranceSparrowOptions{Shadowing::vGroove, DiffuseTerm::none, polarized});
    pair->world.materials.push_back({name, model});
    pair->bare.materials.push_back({float(rough), soil ? 0.2f : 0});
  }
  const CDVector to_sun = CDVector::fromAngles(0.5236, -1.5708);
  pair->world.sun.emplace(
      Sun{to_sun, CDSpectralVector<CDStokesVector>(grid, CDStokesVector(1.0)), 0});
  pair->world.sky = std::make_shared<UniformSky>(
      CDSpectralVector<CDStokesVector>(grid, CDStokesVector(0.05)));
  pair->tracer = std::make_shared<RayTracer>(pair->world.geometry);
  for (const CDVector& v : pair->world.geometry.vertices())
    pair->bare.vertices.push_back({float(v.x), float(v.y), float(v.z)});
  for (const Triangle& t : pair->world.geometry.triangles())
    pair->bare.triangles.push_back({t.a, t.b, t.c, t.material});
  pair->bare.sky = 0.05f, pair->bare.sun.assign(bands, 1.0f);
  pair->bare.to_sun = {float(to_sun.x), float(to_sun.y), float(to_sun.z)};
  pair->bare.build();
  return pair;
}

/// Every step-th row, in strips of sixteen pixels as a tile of the renderer has them.
double renderProduct(const Radiometry& radiometry, std::size_t step, std::size_t bands,
                     std::vector<double>& out) {
  std::vector<Radiometry::Ray> rays(pixels);
  std::vector<Radiometry::Truth> truth(pixels);
  double sum = 0;
  for (std::size_t y = 0; y < pixels; y += step) {
    for (std::size_t x = 0; x < pixels; ++x) {
      const double f = width / height / pixels;
      rays[x] = {{0, 0, height},
                 normalized(CDVector{(double(x) + 0.5 - pixels / 2) * f,
                                     (pixels / 2 - double(y) - 0.5) * f, -1}),
                 {1, 0, 0},
                 y * pixels + x,
                 0,
                 0};
    }
    radiometry.radiance(rays, out, truth);
    for (std::size_t x = 0; x < pixels; ++x) sum += out[x * 4 * bands];
  }
  return sum;
}

/// A model without a fast way for many directions: what the renderer would be without gather().
class OneByOne : public CDBRDFModel {
 public:
  explicit OneByOne(std::shared_ptr<const CDBRDFModel> model)
      : CDBRDFModel(model->grid()), model_(std::move(model)) {}
  std::string_view name() const override { return model_->name(); }
  void evaluate(const BRDFGeometry& g, CDSpectralVector<CDMuellerMatrix>& out) const override {
    model_->evaluate(g, out);
  }
  void scatter(const BRDFGeometry& g, double weight, const CDSpectralVector<CDStokesVector>& in,
               CDSpectralVector<CDStokesVector>& sum) const override {
    model_->scatter(g, weight, in, sum);
  }

 private:
  std::shared_ptr<const CDBRDFModel> model_;
};

struct Case {
  std::string name;
  Shape shape;
  std::size_t bands;
  std::vector<int> rays;
  std::size_t step;  // one row in so many is rendered
  bool polarized = true, one_by_one = false;
  bool clear_sky = false;  // a Rayleigh sky
};

/// A Rayleigh sky for both: the bare loops get the same four functions of the zenith angle as a table.
void putRayleighSky(Pair& pair) {
  const Sun sun{pair.world.sun->to_sun,
                CDSpectralVector<CDStokesVector>(pair.world.grid, CDStokesVector(1.0)), 0};
  const auto sky =
      std::make_shared<RayleighSky>(sun, RayleighSky::clearAir(pair.world.grid, 0.3));
  pair.world.sky = sky, pair.world.sun = sky->sunAtGround();
  const std::size_t bands = pair.world.grid->size(), together = bands == 1 ? 1 : 8,
                    row = (bands + together - 1) / together * together * 4;
  pair.bare.rayleigh.resize((bare::Scene::rayleigh_steps + 1) * row);
  for (std::size_t b = 0; b < bands; ++b) {
    pair.bare.sun[b] = float(std::as_const(pair.world.sun->irradiance)[b].getScalar());
    const RayleighLight& light = sky->light(b);
    const double e = light.polarizedFactor(), twice_q = 1 - e / 1.5;
    for (std::size_t node = 0; node <= bare::Scene::rayleigh_steps; ++node) {
      const double w = double(node) / bare::Scene::rayleigh_steps, mu = w * w;
      const RayleighLight::Harmonics h = light.harmonics(mu, false);
      float* at = &pair.bare.rayleigh[node * row + b / together * 4 * together + b % together];
      at[0] =
          float(e * ((1 + mu * mu) * h.a + (1 - mu * mu) * h.c) + twice_q * (2 * h.a + h.c));
      at[together] = float(e * (h.a - h.c));
      at[2 * together] = float(e * h.b), at[3 * together] = float(e * h.d);
    }
  }
}

void measure(const Case& c) {
  const auto pair = makePair(c.shape, c.bands, c.polarized);
  if (c.one_by_one)
    for (Material& m : pair->world.materials) m.brdf = std::make_shared<OneByOne>(m.brdf);
  if (c.clear_sky) putRayleighSky(*pair);
  const Radiometry radiometry(pair->world, pair->tracer,
                              {.sampling = Sampling::gridRotated, .rays = c.rays});
  std::vector<double> out(pixels * 4 * c.bands);
  std::vector<float> bare_out(pixels * (pixels / c.step) * 4 * c.bands);
  std::vector<double> product, bare;
  double sum = 0, bare_sum = 0;
  for (int repeat = 0; repeat < 7; ++repeat) {
    const double begin = processorSeconds();
    sum = renderProduct(radiometry, c.step, c.bands, out);
    const double middle = processorSeconds();
    bare::render(pair->bare, pixels, float(height), float(width), c.step, c.rays[0],
                 c.rays.size() > 1 ? c.rays[1] : 0, c.polarized, bare_out);
    bare.push_back(processorSeconds() - middle), product.push_back(middle - begin);
  }
  for (std::size_t p = 0; p < pixels * (pixels / c.step); ++p)
    bare_sum += double(bare_out[p * 4 * c.bands]);
  const auto median = [](std::vector<double> t) {
    std::nth_element(t.begin(), t.begin() + long(t.size() / 2), t.end());
    return t[t.size() / 2];
  };
  const double scale = 1e3 * double(c.step), a = median(product) * scale,
               b = median(bare) * scale;
  fmt::print("{:<48} {:>9.0f} {:>9.0f} {:>7.2f}   {:+.2f} %\n", c.name, a, b, a / b,
             100 * (sum / bare_sum - 1));
}
/// The sun as a disk beside the same sun as a point, which is all that the bare loops know.
void measureDisk(const Case& c) {
  const auto pair = makePair(c.shape, c.bands, c.polarized);
  World soft = pair->world;
  soft.sun->half_angle_rad = solar_half_angle_rad;
  const RadiometryOptions options{.sampling = Sampling::gridRotated, .rays = c.rays};
  const Radiometry disk(soft, pair->tracer, options), point(pair->world, pair->tracer, options);
  std::vector<double> out(pixels * 4 * c.bands), times, others;
  double sum = 0, other = 0;
  for (int repeat = 0; repeat < 11; ++repeat) {
    const double begin = processorSeconds();
    sum = renderProduct(disk, c.step, c.bands, out);
    const double middle = processorSeconds();
    other = renderProduct(point, c.step, c.bands, out);
    times.push_back(middle - begin), others.push_back(processorSeconds() - middle);
  }
  std::sort(times.begin(), times.end()), std::sort(others.begin(), others.end());
  const double scale = 1e3 * double(c.step), a = times[5] * scale, b = others[5] * scale;
  fmt::print("{:<48} {:>9.0f} {:>9.0f} {:>7.2f}   {:+.2f} %\n", c.name, a, b, a / b,
             100 * (sum / other - 1));
}
}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  fmt::print("{:<48} {:>9} {:>9} {:>7}   {}\n", "256 x 256 pixels, ms of one thread", "malus",
             "bare", "ratio", "difference of mean S0");
  const Shape bar = chunkyBar();
  const auto run = [&](Case c) {
    if (only.empty() || c.name.find(only) != std::string::npos) measure(c);
  };
  run({"(a) chunky bar, 91 rays, 1 band", bar, 1, {91}, 4});
  run({"(a) the same, unpolarised", bar, 1, {91}, 4, false});
  run({"(a) the same, polarised, without gather()", bar, 1, {91}, 8, true, true});
  run({"(a) 91 rays, the sun at the second hit", bar, 1, {91, 1}, 8});
  run({"(b) double bounce, 120 x 120 rays", bar, 1, {120, 120}, 64});
  run({"(c) 91 rays, 100 bands", bar, 100, {91}, 16});
  run({"(c) 91 rays, 100 bands, unpolarised", bar, 100, {91}, 16, false});
  run({"(c) 91 rays, 400 bands", bar, 400, {91}, 32});
  run({"(c) 91 rays, 1 band, Rayleigh sky", bar, 1, {91}, 8, true, false, true});
  run({"(c) 91 rays, 100 bands, Rayleigh sky", bar, 100, {91}, 32, true, false, true});
  const auto runDisk = [&](Case c) {
    if (only.empty() || c.name.find(only) != std::string::npos) measureDisk(c);
  };
  runDisk({"(e) 91 rays, the sun a disk or a point", bar, 1, {91}, 4});
  runDisk({"(e) the same, and at the second hit", bar, 1, {91, 1}, 4});
  run({"(d) a million triangles, 91 rays, 1 band", waves(710), 1, {91}, 16});
  if (only.empty() || only == "scenes") printScenes();
  return 0;
}
