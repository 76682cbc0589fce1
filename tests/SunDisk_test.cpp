// The sun's disk against independent results: segments and lenses of circles, Fresnel's
// reflectance, and sums over the disk (nw/render/SunDisk.nw).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Sensor.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFGlossyCoating.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/Fresnel.hpp"
#include "malus/thesis/OldFaults.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;
constexpr double alpha = solar_half_angle_rad;
RadiometryOptions rays(Sampling sampling, std::vector<int> counts) {
  RadiometryOptions options;
  options.sampling = sampling, options.rays = std::move(counts);
  return options;
}

std::vector<Quad> plate(const Model& model, double half = 50) { return {floorOf(model, half)}; }

World sunlit(World world, const CDVector& to_sun, double half_angle_rad = alpha,
             const CDStokesVector& irradiance = 1.0) {
  world.sun.emplace(Sun{normalized(to_sun), spectrumOf(irradiance), half_angle_rad});
  return world;
}

// White matt ground and something above it. The edge between the ground's triangles does not run through the origin:
// rays start clear of edges (nw/render/RayTracer.nw), and so beside the point that is looked at.
World groundUnder(const Mesh& above) {
  World world;
  world.grid = oneBand();
  GeometryBuilder builder;
  Mesh ground;
  ground.vertices = {{-5, -5, 0}, {5, -5, 0}, {5, 8, 0}, {-5, 8, 0}};
  ground.facets = ground.materials = {"ground"};
  ground.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
  builder.addMesh(ground, {});
  builder.addMesh(above, {});
  world.geometry = std::move(builder).build();
  world.materials = {{"ground", matt(1)}, {"above", matt(0)}};
  world.sky = blackSky(oneBand());
  return world;
}

Mesh above(std::vector<CDVector> vertices, std::vector<std::array<std::uint32_t, 3>> corners) {
  Mesh mesh;
  mesh.facets = mesh.materials = {"above"};
  mesh.vertices = std::move(vertices);
  for (const auto& c : corners) mesh.triangles.push_back({c[0], c[1], c[2], 0, 0});
  return mesh;
}

Mesh horizontalDisk(double radius, double height) {
  constexpr std::uint32_t sides = 720;
  std::vector<CDVector> vertices{{0, 0, height}};
  std::vector<std::array<std::uint32_t, 3>> corners;
  for (std::uint32_t i = 0; i < sides; ++i) {
    vertices.push_back(
        {radius * std::cos(2 * pi * i / sides), radius * std::sin(2 * pi * i / sides), height});
    corners.push_back({0, i + 1, (i + 1) % sides + 1});
  }
  return above(std::move(vertices), std::move(corners));
}

Mesh sphere(double radius, const CDVector& centre) {
  constexpr std::uint32_t rows = 90, columns = 360;
  std::vector<CDVector> vertices;
  std::vector<std::array<std::uint32_t, 3>> corners;
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j)
      vertices.push_back(centre +
                         CDVector::fromAngles(pi * i / rows, 2 * pi * j / columns) * radius);
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t a = i * columns + j, b = i * columns + (j + 1) % columns;
      corners.push_back({a, a + columns, b});
      corners.push_back({b, a + columns, b + columns});
    }
  return above(std::move(vertices), std::move(corners));
}

// Part of a disk of radius 1 on the near side of a line at the distance u from its middle, -1 to 1.
double segment(double u) {
  u = std::clamp(u, -1.0, 1.0);
  return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / pi;
}

// Part of a disk of radius 1 that another of radius r at the distance d covers.
double lens(double r, double d) {
  if (d >= 1 + r) return 0;
  if (d <= std::abs(1 - r)) return r < 1 ? r * r : 1;
  const double a = std::acos((d * d + 1 - r * r) / (2 * d)),
               b = std::acos((d * d + r * r - 1) / (2 * d * r));
  const double kite = std::sqrt((1 + r - d) * (d + 1 - r) * (d - 1 + r) * (d + 1 + r)) / 2;
  return (a + r * r * b - kite) / pi;
}

// Share of the unhindered irradiance at a point of the ground, and its standard error.
struct Share {
  double mean, error;
};
Share lit(const World& world, const CDVector& at, std::uint64_t pixels = 20000) {
  const CDVector view = normalized(CDVector{1, 0.1, 0.5});
  const Estimate e = estimate(world, rays(Sampling::importance, {1}),
                              looking(at, view, {0, 1, 0}, 0, 1), pixels);
  const double full = world.sun->to_sun.z / pi;
  return {e.mean[0] / full, e.error[0] / full};
}

// Statistical tolerance: 5.5 standard errors are passed by chance once in ten million. A share
// of exactly 0 or 1 has no error; one miss in all is allowed.
void expectShare(const Share& share, double expected, const std::string& where) {
  EXPECT_NEAR(share.mean, expected, 5.5 * share.error + 1e-4) << where;
}

struct Mirror {
  double sum, diff;  // Fresnel's (Rs + Rp)/2 and (Rs - Rp)/2
};
Mirror mirrorOf(double n, double k, double theta) {
  const double c = std::cos(theta), s = std::sin(theta);
  const auto f = fresnelReflection(c, s * s, n * n - k * k, 2 * n * k);
  return {f.sum, f.diff};
}

// The plate at the origin, seen at the angle theta so that the mirror's direction is `off` from the disk's middle.
struct Glint {
  double theta, off;
  CDVector toSun() const { return CDVector::fromAngles(theta, 0); }
  CDVector toViewer() const { return CDVector::fromAngles(theta + off, pi); }
  Radiometry::Ray ray(std::uint64_t pixel = 0) const {
    return looking({}, toViewer(), rayFrame(toViewer(), {0, 0, 1}).s, pixel);
  }
};

// f cos(theta) L summed over the disk by midpoints, 400 rings of 400: the lobes below are at least as wide as eighty of them.
double summed(const CDBRDFModel& brdf, const Glint& glint) {
  constexpr int rings = 400;
  const double radiance = 1 / (pi * std::sin(alpha) * std::sin(alpha)),
               half = std::sin(alpha / 2);
  const CDVector sun = glint.toSun(), x = normalized(cross({0, 1, 0}, sun)), y = cross(sun, x);
  double sum = 0;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < rings; ++j) {
      const double t = (i + 0.5) / rings * half * half, across = 2 * std::sqrt(t * (1 - t)),
                   turn = 2 * pi * (j + 0.5) / rings;
      const CDVector d =
          x * (across * std::cos(turn)) + y * (across * std::sin(turn)) + sun * (1 - 2 * t);
      sum += brdf.getScore(BRDFGeometry::fromDirections(d, glint.toViewer()));
    }
  return sum * radiance * 4 * pi * half * half / (rings * rings);
}
}  // namespace

// The shadow of a straight edge ten metres up, under a sun in the zenith and one that leans along the edge: the part of the
// disk on one side of a line. First-order terms in the half angle cancel by symmetry, its square is 2e-5.
TEST(SunDiskPublished, PenumbraOfAStraightEdge) {
  const double h = 10;
  const World roof = groundUnder(
      above({{-5, -50, h}, {0, -50, h}, {0, 50, h}, {-5, 50, h}}, {{0, 1, 2}, {0, 2, 3}}));
  for (const double zenith : {0.0, 50 * degree}) {
    const World world = sunlit(roof, CDVector::fromAngles(zenith, pi / 2));
    const double width = h * std::tan(alpha) / std::cos(zenith);
    for (const double u : {-1.2, -0.8, -0.3, 0.0, 0.5, 0.9, 1.2})
      expectShare(lit(world, {u * width, 0, 0}), segment(u), std::to_string(u));
    const World wider = sunlit(roof, CDVector::fromAngles(zenith, pi / 2), 1.2 * alpha);
    const Share control = lit(wider, {0.5 * width, 0, 0});
    EXPECT_GT(std::abs(control.mean - segment(0.5)), 5.5 * control.error + 1e-4)
        << "negative control";
  }
}

// A pixel as wide as the penumbra, whose ray starts anywhere in it: the mean over the pixel of what each of its points
// sees. The place in the pixel and the point of the sun must not move together.
TEST(SunDiskPublished, PixelsAverageThePenumbra) {
  const double h = 10, width = h * std::tan(alpha), turned = 1e-4;
  SensorGeometry geometry;
  geometry.width = geometry.height = 1, geometry.jitter = true;
  geometry.principal_x = geometry.principal_y = 0.5;
  geometry.focal_length_px = 1 / (2 * width);  // seen from the height of 1
  const auto bands = SpectralGrid::make({550.0});
  const Sensor sensor(geometry, bands, bands);
  const Pose down = Pose::looking({turned, turned, 1}, {0, 0, -1}, {0, 1, 0});
  const std::uint64_t pixels = 20000;
  const Platform platform = Platform::fixed(down, pixels);
  const auto rayOf = [&](std::uint64_t n) { return sensor.ray(0, 0, 0, platform, n, 1); };
  for (const double edge : {-0.6, -0.3, 0.0, 0.4, 0.7})
    for (const bool across : {true, false}) {
      const double x = edge * width;
      const auto roof =
          across ? std::vector<CDVector>{{-5, -50, h}, {x, -50, h}, {x, 50, h}, {-5, 50, h}}
                 : std::vector<CDVector>{{-50, -5, h}, {50, -5, h}, {50, x, h}, {-50, x, h}};
      const World world = sunlit(groundUnder(above(roof, {{0, 1, 2}, {0, 2, 3}})), {0, 0, 1});
      const Estimate e = estimateOver(world, rays(Sampling::importance, {1}), rayOf, pixels);
      double expected = 0;
      for (int i = 0; i < 1000; ++i)
        expected += segment((i - 499.5) / 500 + turned / width - edge) / 1000;
      expectShare({e.mean[0] * pi, e.error[0] * pi}, expected, std::to_string(edge));
    }
}

// A disk below the sun's: partial, annular and total shadow.
TEST(SunDiskPublished, PenumbraOfADisk) {
  const double h = 10, unit = h * std::tan(alpha);
  for (const double r : {0.6, 1.0, 1.7}) {
    const World world = sunlit(groundUnder(horizontalDisk(r * unit, h)), {0, 0, 1});
    for (const double d : {0.0, 0.3, 0.8, 1.5, 2.9})
      expectShare(lit(world, {d * unit, 0, 0}), 1 - lens(r, d),
                  std::to_string(r) + " " + std::to_string(d));
    const Share control = lit(world, {0.8 * unit, 0, 0});
    EXPECT_GT(std::abs(control.mean - 1 + lens(1.1 * r, 0.8)), 5.5 * control.error + 1e-4)
        << "negative control";
  }
}

// A sphere before the sun is a disk of the angle asin(r / distance): an eclipse.
TEST(SunDiskPublished, EclipseByASphere) {
  const double distance = 20;
  for (const double r : {0.7, 1.06}) {
    const double radius = distance * std::sin(r * alpha);
    const World world = sunlit(groundUnder(sphere(radius, {0, 0, distance})), {0, 0, 1});
    for (const double d : {0.0, 0.5, 1.2, 1.9})
      expectShare(lit(world, {distance * std::tan(d * alpha), 0, 0}), 1 - lens(r, d),
                  std::to_string(r) + " " + std::to_string(d));
  }
}

// The samples of one pixel are spread evenly: the error of 256 of them in a penumbra is at
// least three times smaller than that of independent ones, sqrt(F (1 - F) / 256) = 0.031.
TEST(SunDiskInvariant, SamplesOfAPixelAvoidEachOther) {
  const double h = 10, u = 0.2;
  const World world =
      sunlit(groundUnder(above({{-5, -50, h}, {0, -50, h}, {0, 50, h}, {-5, 50, h}},
                               {{0, 1, 2}, {0, 2, 3}})),
             {0, 0, 1});
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              rays(Sampling::importance, {1}));
  double squares = 0, independent = 0;
  for (std::uint64_t pixel = 0; pixel < 100; ++pixel) {
    double mean = 0, other = 0;
    for (std::uint32_t sample = 0; sample < 256; ++sample) {
      Radiometry::Ray ray =
          looking({u * h * std::tan(alpha), 0, 0}, {1, 0.1, 0.5}, {0, 1, 0}, pixel, 1);
      std::array<double, 4> out{};
      ray.sample = sample;
      radiometry.radiance({&ray, 1}, out);
      mean += out[0] * pi / 256;
      ray.sample = 0, ray.pixel = 1000 + pixel * 256 + sample;
      radiometry.radiance({&ray, 1}, out);
      other += out[0] * pi / 256;
    }
    squares += (mean - segment(u)) * (mean - segment(u));
    independent += (other - segment(u)) * (other - segment(u));
  }
  EXPECT_LT(std::sqrt(squares / 100), 0.031 / 3);
  EXPECT_GT(std::sqrt(independent / 100), 0.031 / 1.5) << "negative control";
}

// A surface receives the sun's irradiance times the cosine, at any tilt. At a right angle half of the disk is above the
// surface: 2 sin(alpha) / (3 pi) of the irradiance, to the square of the half angle. A point has no light there.
TEST(SunDiskInvariant, IrradianceIsTheSuns) {
  for (const double zenith_deg : {0.0, 40.0, 75.0, 89.0}) {
    const World world =
        sunlit(worldOf(plate(matt(1))), CDVector::fromAngles(zenith_deg * degree, 1));
    expectShare(lit(world, {}, 4000), 1, std::to_string(zenith_deg));
  }
  const Radiometry::Ray ray = looking({}, {0.1, 0.2, 1}, {1, 0, 0});
  const auto one = rays(Sampling::grid, {1});
  const World flat = worldOf(plate(matt(1)));
  const Estimate half = estimate(sunlit(flat, {1, 0, 0}), one, ray, 40000);
  const double expected = 2 * std::sin(alpha) / (3 * pi) / pi;
  EXPECT_NEAR(half.mean[0], expected, 5.5 * half.error[0]);
  EXPECT_LT(half.error[0], 0.01 * expected);
  EXPECT_EQ(estimate(sunlit(flat, {1, 0, 0}, 0), one, ray, 10).mean[0], 0)
      << "negative control";
}

// An image of the sun: the sum over its pixels of L cos^4 / f^2 is the irradiance. A circle of a radius of 80 pixels is
// counted by the middles of pixels to better than a part in 500 (Gauss's circle problem). Sunlight that is polarised is so
// in the picture.
TEST(SunDiskInvariant, TheCameraSeesTheDisk) {
  const CDVector to_sun = CDVector::fromAngles(65 * degree, 2);
  const CDStokesVector light(1, 0.5, 0, 0.1);
  const auto picture = [&](double half_angle_rad) {
    const World world = sunlit(worldOf(plate(matt(0))), to_sun, half_angle_rad, light);
    const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                                rays(Sampling::importance, {2}));
    const CDVector s = rayFrame(-to_sun, {0, 0, 1}).s, up = cross(to_sun, s);
    const double f = 80 / std::tan(alpha);
    std::array<double, 4> sum{}, out{};
    for (int y = -100; y < 100; ++y)
      for (int x = -100; x < 100; ++x) {
        const CDVector d = to_sun * f + s * (x + 0.5) + up * (y + 0.5);
        const Radiometry::Ray ray{{0, 0, 1}, normalized(d), s};
        radiometry.radiance({&ray, 1}, out);
        const double cosine = dot(ray.direction, to_sun);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += out[c] * std::pow(cosine, 4) / (f * f);
      }
    return sum;
  };
  const auto seen = picture(alpha);
  for (int c = 0; c < 4; ++c)
    EXPECT_NEAR(seen[static_cast<std::size_t>(c)], light.getStokes(c), 2e-3) << c;
  EXPECT_EQ(picture(0)[0], 0) << "a point is not seen";
}

// Facets so flat that the plate is a mirror show the disk with Fresnel's reflectance times its radiance, polarised as Fresnel
// says, and nothing beside the disk. Tolerance: the half vector has seven digits, so at sigma =
// 1e-6 a ray of 64 is off by about a tenth; with 50 pixels the mean is off by 2e-3. Wider
// lobes: the reflectance over the lobe differs by less.
TEST(SunDiskPublished, SmoothSurfacesMirrorTheSun) {
  for (const auto& [n, k] : {std::pair{0.405, 2.95}, std::pair{1.5, 0.0}})
    for (const double theta_deg : {20.0, 60.0})
      for (const double sigma : {1e-6, 1e-5, 1e-4}) {
        const Glint inside{theta_deg * degree, 0.7 * alpha},
            outside{theta_deg * degree, 1.3 * alpha};
        const World world = sunlit(worldOf(plate(facets(n, k, sigma), 1)), inside.toSun());
        const auto options = rays(Sampling::importance, {65});
        const double radiance = 1 / (pi * std::sin(alpha) * std::sin(alpha));
        const Mirror mirror = mirrorOf(n, k, inside.theta + inside.off);
        const Estimate seen = estimate(world, options, inside.ray(), 50);
        EXPECT_NEAR(seen.mean[0] / radiance, mirror.sum, 0.01 * mirror.sum)
            << n << " " << sigma;
        EXPECT_NEAR(seen.mean[1] / radiance, mirror.diff, 0.01 * mirror.sum)
            << n << " " << sigma;
        EXPECT_LT(estimate(world, options, outside.ray(), 50).mean[0], 1e-6 * radiance);
        // the last surface, whose only ray is the sun's
        const Estimate single =
            estimate(world, rays(Sampling::gridRotated, {1}), inside.ray(), 50);
        EXPECT_NEAR(single.mean[0] / radiance, mirror.sum, 0.02 * mirror.sum)
            << n << " " << sigma;
      }
}

// From mirrors to matt metal: the glint is the sum over the disk, with 64 rays of importance, with one, and with the
// thesis's samplings; and no single result exceeds 1.5 (the sun's ray and all others) or 1.12
// (the sun's ray alone) times
// reflectance times radiance. The reflectance varies by less than 3 % over the disk.
TEST(SunDiskInvariant, GlintsOfEveryRoughnessAreTheSumOverTheDisk) {
  const double radiance = 1 / (pi * std::sin(alpha) * std::sin(alpha));
  for (const double sigma : {1e-3, 3e-3, 1e-2, 3e-2, 1e-1})
    for (const double off : {0.0, 0.6 * alpha, 1.5 * alpha}) {
      const Model glass = facets(1.5, 0, sigma);
      const Glint glint{60 * degree, off};
      const World world = sunlit(worldOf(plate(glass, 1)), glint.toSun());
      const double expected = summed(*glass, glint);
      const double most = 1.03 * mirrorOf(1.5, 0, glint.theta + off / 2).sum * radiance;
      EXPECT_LT(expected, most);
      const auto check = [&](const RadiometryOptions& options, std::uint64_t pixels,
                             double bound, const char* what) {
        const Estimate seen = estimate(world, options, glint.ray(), pixels);
        EXPECT_NEAR(seen.mean[0], expected, 5.5 * seen.error[0] + 1e-4 * expected)
            << what << " " << sigma << " " << off;
        const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                                    options);
        for (std::uint64_t pixel = 0; pixel < pixels; ++pixel) {
          const Radiometry::Ray ray = glint.ray(pixel);
          std::array<double, 4> out{};
          radiometry.radiance({&ray, 1}, out);
          ASSERT_LT(out[0], bound * most) << what << " " << sigma << " " << off;
        }
      };
      check(rays(Sampling::importance, {65}), 1000, 1.5, "importance");
      check(rays(Sampling::importance, {1}), 20000, 1.12, "the sun's ray");
      check(rays(Sampling::gridRotated, {1}), 20000, 1.12, "the sun's ray on a grid");
    }
}

// Negative controls of the sum: the sun as a point is far off where the lobe is narrow, the sun met twice is too bright.
TEST(SunDiskInvariant, NegativeControlsOfTheGlint) {
  const Model glass = facets(1.5, 0, 3e-3);
  const Glint glint{60 * degree, 0};
  const double expected = summed(*glass, glint);
  const auto options = rays(Sampling::importance, {65});
  const World point = sunlit(worldOf(plate(glass, 1)), glint.toSun(), 0);
  EXPECT_GT(estimate(point, options, glint.ray(), 10).mean[0], 1.3 * expected);
  const World twice = withSunInSky(sunlit(worldOf(plate(glass, 1)), glint.toSun()));
  EXPECT_GT(estimate(twice, options, glint.ray(), 500).mean[0], 1.8 * expected);
}

// Paint that is matt under a smooth gloss, looked at beside the sun's image: the matt part is lit as by a point, and no
// sample is far from it, with one ray and with many. The gloss draws its rays where the sun is not.
TEST(SunDiskInvariant, MattPaintUnderASmoothGloss) {
  const auto all = [](double value) { return CDSpectralVector<double>(oneBand(), value); };
  const auto paint = std::make_shared<BRDFGlossyCoating>(all(1.5), all(0.5), 1e-6);
  const Glint beside{50 * degree, 4 * degree};
  const World world = sunlit(worldOf(plate(paint, 1)), beside.toSun());
  const double expected =
      paint->getScore(BRDFGeometry::fromDirections(beside.toSun(), beside.toViewer()));
  EXPECT_GT(expected, 0.05) << "negative control: there is a matt part";
  for (const auto& options : {rays(Sampling::importance, {1}), rays(Sampling::gridRotated, {1}),
                              rays(Sampling::importance, {33})}) {
    const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
    for (std::uint64_t pixel = 0; pixel < 1000; ++pixel) {
      const Radiometry::Ray ray = beside.ray(pixel);
      std::array<double, 4> out{};
      radiometry.radiance({&ray, 1}, out);
      ASSERT_NEAR(out[0], expected,
                  0.01 * expected);  // the cosine varies by 0.6 % over the disk
    }
  }
}

// The result depends on the ray alone: alone, or among others in another order.
TEST(SunDiskInvariant, CompanyChangesNoBit) {
  const World world = sunlit(
      worldOf({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, facets(0.4, 2.9, 0.01)},
               {{-1, -1, 0}, {-1, 1, 0}, {-1, 1, 2}, {-1, -1, 2}, facets(0.4, 2.9, 0.2)}},
              uniformSky(0.1)),
      {0.5, 0.1, 0.8});
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              rays(Sampling::importance, {17, 3, 1}));
  std::vector<Radiometry::Ray> all;
  for (std::uint64_t pixel = 0; pixel < 20; ++pixel)
    all.push_back(looking({-0.3, 0.01 * static_cast<double>(pixel), 0}, {0.6, 0.1, 0.5},
                          {0, 1, 0}, pixel));
  std::vector<double> together(all.size() * 4);
  radiometry.radiance(all, together);
  for (std::size_t i = all.size(); i-- > 0;) {
    std::array<double, 4> out{};
    radiometry.radiance({&all[i], 1}, out);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(out[c], together[4 * i + c]);
  }
}
