// The radiometry against independent results: furnaces, form factors, cavities, an image plane,
// and the
// program malus brdf (explained in nw/render/ImportanceSampling.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "Program.hpp"
#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Random.hpp"
#include "malus/base/Table.hpp"
#include "malus/render/Sensor.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
Model copper(double sigma, DiffuseTerm diffuse) { return facets(0.405, 2.95, sigma, diffuse); }
// A metal whose index is purely imaginary reflects everything at any angle.
Model lossless(double sigma) { return facets(0, 2.95, sigma, DiffuseTerm::thesis); }

RadiometryOptions importance(std::vector<int> rays) {
  RadiometryOptions options;
  options.sampling = Sampling::importance, options.rays = std::move(rays);
  return options;
}
RadiometryOptions gridOf(int rays) {
  RadiometryOptions options;
  options.sampling = Sampling::grid, options.rays = {rays};
  return options;
}

// Form factor from a surface element to a parallel rectangle a by b at the height h whose
// corner is above it (Siegel and Howell, Thermal Radiation Heat Transfer, configuration factors
// of elements to rectangles).
double cornerFactor(double a, double b, double h) {
  const double A = a / h, B = b / h, p = std::sqrt(1 + A * A), q = std::sqrt(1 + B * B);
  return (A / p * std::atan(B / p) + B / q * std::atan(A / q)) / (2 * pi);
}

double s0(const World& world, const RadiometryOptions& options, const Radiometry::Ray& ray,
          std::uint64_t pixels = 1) {
  return estimate(world, options, ray, pixels).mean[0];
}
}  // namespace

// A white body in a uniform world cannot be seen. With directions of the cosine lobe every weight is pi/n, and the
// only error is that of single precision, 6e-8 a ray.
TEST(RadiometryChecksInvariant, WhiteFurnaceOfAPlate) {
  for (const double zenith : {0.0, 0.5, 1.2, 1.5}) {
    const auto ray = looking({0.1, 0.2, 0}, CDVector::fromAngles(zenith, 1), {0, 1, 0.3});
    EXPECT_NEAR(s0(worldOf({floorOf(matt(1))}, uniformSky(2)), importance({200}), ray), 2,
                1e-6);
    EXPECT_GT(
        std::abs(s0(worldOf({floorOf(matt(0.999))}, uniformSky(2)), importance({200}), ray) -
                 2),
        1e-3)
        << "negative control: a thousandth of absorption";
  }
}

// The grid of midpoints in the zenith angle integrates cos(theta) sin(theta) with a relative error of the order of
// (pi/2m)^2/6 for m zeniths; 10 zeniths of 400 directions: 0.4 per cent.
TEST(RadiometryChecksInvariant, WhiteFurnaceOnTheGrid) {
  const auto ray = looking({0.1, 0.2, 0}, {0.5, 0, 1}, {0, 1, 0});
  EXPECT_NEAR(s0(worldOf({floorOf(matt(1))}, uniformSky(1)), gridOf(401), ray), 1, 5e-3);
  EXPECT_NEAR(s0(worldOf({floorOf(matt(1))}, uniformSky(1)), gridOf(4001), ray), 1, 5e-4);
}

// The thesis's diffuse term returns the light that one reflection by the facets loses behind
// others: a metal that does not
// absorb is white, from every side.
TEST(RadiometryChecksInvariant, LosslessMetalIsWhite) {
  for (const double zenith : {0.2, 0.8, 1.3}) {
    const auto ray = looking({0, 0, 0}, CDVector::fromAngles(zenith, 1), {0, 1, 0});
    const auto measured =
        estimate(worldOf({floorOf(lossless(0.2))}, uniformSky(1)), importance({257}), ray, 200);
    // 5 standard errors, and the tabulated remainder's interpolation
    EXPECT_NEAR(measured.mean[0], 1, 5 * measured.error[0] + 1e-4) << zenith;
    const double absorbing =
        s0(worldOf({floorOf(copper(0.2, DiffuseTerm::none))}, uniformSky(1)), importance({257}),
           ray, 200);
    EXPECT_LT(absorbing, 0.95) << "negative control";
  }
}

// Helmholtz: what a viewer sees of a plate under a sky of radiance one is the fraction of the light that the plate
// would reflect if it came from there. getDHR is a separate quadrature.
TEST(RadiometryChecksIdentity, PlateUnderAUniformSkyShowsItsReflectance) {
  const Model model = copper(0.2, DiffuseTerm::reciprocal);
  for (const double zenith : {0.2, 0.8, 1.2}) {
    const auto measured =
        estimate(worldOf({floorOf(model)}, uniformSky(1)), importance({257}),
                 looking({0, 0, 0}, CDVector::fromAngles(zenith, 1), {0, 1, 0}), 300);
    const double expected = std::as_const(model)->getDHR(zenith).at(0);
    EXPECT_NEAR(measured.mean[0], expected, 5 * measured.error[0] + 1e-4) << zenith;
    EXPECT_GT(std::abs(measured.mean[0] - 1.01 * expected), 5 * measured.error[0] + 1e-4)
        << "negative control";
  }
}

// No light gets into a closed box, however bright it is outside: not a millimetre from the edges either. (Nearer than
// the offset at which rays start, 2^-16 m, a point belongs to both walls, and rays of one may start behind the other.)
TEST(RadiometryChecksInvariant, NothingLeaksIntoAClosedBox) {
  std::array<Model, 6> walls;
  walls.fill(matt(1));
  World world = worldOf(boxOf(walls), uniformSky(1e9));
  world.sun.emplace(Sun{normalized(CDVector{0.3, 0.2, 0.8}), spectrumOf(1e9)});
  Random random(4);
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              importance({40, 3, 2}));
  std::array<double, 4> out{};
  for (std::uint64_t i = 0; i < 300; ++i) {
    const auto u = [&] { return 2 * random.uniform() - 1; };
    const CDVector towards =
        i % 3 ? CDVector{u(), u(), u()} : CDVector{1, u(), 0.999};  // every third near an edge
    const Radiometry::Ray ray{{0.1, 0.2, 0.3},
                              normalized(towards - CDVector{0.1, 0.2, 0.3}),
                              {0.1, 0.7, 0.2},
                              i,
                              0,
                              0};
    radiometry.radiance({&ray, 1}, out);
    ASSERT_EQ(out[0], 0) << i;
  }
  auto open = boxOf(walls);
  open.erase(open.begin() + 1);
  EXPECT_GT(s0(worldOf(open, uniformSky(1)), importance({40, 3, 2}),
               looking({0, 0, -1}, {0.1, 0.2, 1}, {1, 0, 0}, 0, 1)),
            0.1)
      << "negative control: without its lid";
}

// A black ceiling over a matt floor hides its form factor of the sky.
TEST(RadiometryChecksPublished, CeilingHidesItsFormFactor) {
  for (const double height : {0.5, 1.0, 3.0}) {
    std::vector<Quad> quads{floorOf(matt(0.7))};
    quads.push_back(
        {{-1, -1, height}, {-1, 1, height}, {1, 1, height}, {1, -1, height}, matt(0)});
    const double x = 0.3, y = -0.2;
    double factor = 0;
    for (const double a : {1 - x, 1 + x})
      for (const double b : {1 - y, 1 + y}) factor += cornerFactor(a, b, height);
    const auto ray = looking({x, y, 0}, {1, 0, 0.05}, {0, 1, 0});
    // the integrand is a step function: N^-3/4 for scrambled nets, 4000 points and 30 pixels
    const auto measured = estimate(worldOf(quads, uniformSky(1)), importance({4001}), ray, 30);
    EXPECT_NEAR(measured.mean[0], 0.7 * (1 - factor), 5 * measured.error[0] + 1e-6) << height;
    EXPECT_LT(measured.error[0], 1e-3);
    EXPECT_GT(std::abs(measured.mean[0] - 0.7 * (1 - 1.05 * factor)),
              5 * measured.error[0] + 1e-6)
        << "negative control: a factor wrong by a twentieth";
  }
}

// Inside of a globe all form factors are areas. With the share a of its area open and walls of albedo rho, the light
// that has been reflected j + 1 times is rho a (rho (1 - a))^j of the sky's. 7200 flat facets
// approximate the globe:
// their normals are off by up to 1/40, the albedo seen by 3e-4 of itself; tolerance 2e-3 with 5 standard errors.
TEST(RadiometryChecksPublished, GlobeWithAnOpeningReflectionByReflection) {
  const double opening = 70 * degree, open_share = (1 - std::cos(opening)) / 2, rho = 0.8;
  const World world = globe(opening, matt(rho));
  const std::vector<std::vector<int>> depths{{65}, {65, 3}, {65, 3, 3}, {65, 3, 3, 3}};
  double expected = 0, term = rho * open_share;
  for (const auto& rays : depths) {
    expected += term, term *= rho * (1 - open_share);
    const auto measured = estimate(world, importance(rays), intoGlobe(), 200);
    EXPECT_NEAR(measured.mean[0], expected, 5 * measured.error[0] + 2e-3 * expected)
        << rays.size();
    EXPECT_GT(std::abs(measured.mean[0] - expected - term),
              5 * measured.error[0] + 2e-3 * expected)
        << "negative control: one reflection more";
  }
}

// The same globe of metal. Without absorption nothing is lost in it, so what is seen through the opening rises to the
// sky's radiance as more reflections are followed, and never above. Copper keeps some: each reflection returns between
// the least and the largest of its reflectances, R = 0.84 (near 75 degrees) and 1, so not less than 0.84 / (n + 1)...
TEST(RadiometryChecksInvariant, MetalCavityGivesBackAllEnergy) {
  const World world = globe(80 * degree, lossless(0.3));
  double before = 0;
  for (const std::size_t depth : {1u, 2u, 4u, 8u, 16u}) {
    std::vector<int> rays(depth, 2);
    rays[0] = 17;
    const auto measured = estimate(world, importance(rays), intoGlobe(), 400);
    EXPECT_GT(measured.mean[0], before - 5 * measured.error[0]);
    EXPECT_LT(measured.mean[0], 1 + 5 * measured.error[0] + 2e-3);
    before = measured.mean[0];
  }
  EXPECT_NEAR(before, 1, 0.01) << "after sixteen reflections";
  const World lossy = globe(80 * degree, copper(0.3, DiffuseTerm::thesis));
  EXPECT_LT(s0(lossy, importance(std::vector<int>(16, 2)), intoGlobe(), 400), 0.95)
      << "negative control";
}

// The irradiance on an image plane behind a pinhole is the sum over the pixels of radiance times cos^4/f^2, and under
// a uniform sky it is pi times the form factor of the plane's window. Midpoints: relative error of 1/N^2.
TEST(RadiometryChecksPublished, ImagePlaneUnderAUniformSky) {
  const World world = worldOf({floorOf(matt(0))}, uniformSky(1));
  SensorGeometry geometry;
  geometry.width = geometry.height = 100;
  geometry.focal_length_px = 40, geometry.principal_x = 50, geometry.principal_y = 50;
  const Sensor sensor(geometry, oneBand(), oneBand());
  const Platform platform = Platform::fixed(Pose::looking({0, 0, 1}, {0, 0, 9}, {0, 1, 0}));
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              importance({2}));
  double sum = 0;
  std::array<double, 4> out{};
  for (std::size_t y = 0; y < 100; ++y)
    for (std::size_t x = 0; x < 100; ++x) {
      const Radiometry::Ray ray = sensor.ray(x, y, 0, platform, 0, 1);
      radiometry.radiance({&ray, 1}, out);
      sum += out[0] * std::pow(ray.direction.z, 4) / (40.0 * 40.0);
    }
  const double expected = 4 * pi * cornerFactor(50, 50, 40);
  EXPECT_NEAR(sum, expected, 1e-4 * expected);
  EXPECT_GT(std::abs(sum - 4 * pi * cornerFactor(50, 50, 40.1)), 1e-4 * expected)
      << "negative control";
}

// A hundred geometries of the copper plate in unpolarised sunlight, against the first column of the matrices that the
// program prints. The sun's ray is followed in double precision.
TEST(RadiometryChecksIdentity, PlateIsWhatTheProgramPrints) {
  std::string text = "theta_i_deg,theta_r_deg,phi_deg\n";
  Random random(11);
  std::vector<std::array<double, 3>> angles;
  for (int i = 0; i < 100; ++i) {
    angles.push_back({80 * random.uniform(), 80 * random.uniform(), 360 * random.uniform()});
    text += fmt::format("{:.17g},{:.17g},{:.17g}\n", angles[i][0], angles[i][1], angles[i][2]);
  }
  const Scratch scratch;
  put(scratch / "angles.csv", text);
  const Outcome outcome =
      malusIn(scratch.path,
              "brdf --model torrance-sparrow --param n=0.405 --param k=2.95 --param sigma=0.2 "
              "--input angles.csv --format csv");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream stream(outcome.out);
  const Table printed = Table::parse(stream, "answer");
  ASSERT_EQ(printed.rows(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    World world = worldOf({floorOf(copper(0.2, DiffuseTerm::thesis))});
    const double azimuth = 1, cos_i = std::cos(angles[i][0] * degree);
    world.sun.emplace(
        Sun{CDVector::fromAngles(angles[i][0] * degree, azimuth), spectrumOf(1), 0});
    const CDVector viewer =
        CDVector::fromAngles(angles[i][1] * degree, azimuth + angles[i][2] * degree);
    const auto seen = estimate(world, RadiometryOptions{.rays = {1}},
                               looking({0, 0, 0}, viewer, rayFrame(viewer, {0, 0, 1}).s), 1);
    const double size = printed.number(i, "f00") * cos_i;
    for (std::size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(seen.mean[c], printed.number(i, fmt::format("f{}0", c)) * cos_i, 1e-6 * size)
          << i << " " << c;
    EXPECT_GT(std::abs(seen.mean[0] - size * (1 + 1e-5)), 1e-6 * size) << "negative control";
  }
}
