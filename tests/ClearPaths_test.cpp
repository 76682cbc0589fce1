// Light through panes and bodies of glass (nw/render/ClearPaths.nw, nw/surface/ClearSurface.nw).
#include "malus/render/ClearPaths.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "Worlds.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/surface/Panes.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
constexpr double pi = std::numbers::pi;

CDSpectralVector<double> same(double value) { return {oneBand(), value}; }
Model pane(double n, double absorption_per_m = 0, double thickness_mm = 4) {
  return std::make_shared<ClearSurface>(
      ClearSurface::pane(same(n), same(absorption_per_m), thickness_mm));
}
Model body(double n, double absorption_per_m = 0) {
  return std::make_shared<ClearSurface>(ClearSurface::body(same(n), same(absorption_per_m)));
}

/// Convex, with fronts outwards; faces: corners counter-clockwise from outside.
Mesh solid(std::vector<CDVector> vertices,
           const std::vector<std::vector<std::uint32_t>>& faces) {
  Mesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.facets = mesh.materials = {"solid"};
  for (const auto& face : faces)
    for (std::size_t i = 2; i < face.size(); ++i)
      mesh.triangles.push_back({face[0], face[i - 1], face[i], 0, 0});
  return mesh;
}
Mesh box(const CDVector& l, const CDVector& h) {
  return solid(
      {{l.x, l.y, l.z},
       {h.x, l.y, l.z},
       {h.x, h.y, l.z},
       {l.x, h.y, l.z},
       {l.x, l.y, h.z},
       {h.x, l.y, h.z},
       {h.x, h.y, h.z},
       {l.x, h.y, h.z}},
      {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}});
}
/// Apex of this angle along y at the origin, symmetric about the plane x = 0, opening downwards.
Mesh prism(double apex_rad) {
  const double half = std::tan(apex_rad / 2);
  return solid(
      {{0, -5, 0}, {0, 5, 0}, {-half, -5, -1}, {-half, 5, -1}, {half, -5, -1}, {half, 5, -1}},
      {{0, 2, 4}, {1, 5, 3}, {0, 1, 3, 2}, {0, 4, 5, 1}, {2, 3, 5, 4}});
}

/// The quads, and a solid of this model.
World worldWith(const std::vector<Quad>& quads, const Mesh& mesh, const Model& model,
                std::shared_ptr<const Sky> sky = nullptr,
                const SpectralGridPtr& grid = oneBand()) {
  World world;
  world.grid = grid;
  GeometryBuilder builder;
  for (std::size_t i = 0; i < quads.size(); ++i) {
    Mesh quad;
    quad.vertices = {quads[i].a, quads[i].b, quads[i].c, quads[i].d};
    quad.facets = quad.materials = {std::to_string(i)};
    quad.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
    builder.addMesh(quad, {});
    world.materials.push_back({std::to_string(i), quads[i].brdf});
  }
  builder.addMesh(mesh, {});
  world.materials.push_back({"solid", model});
  world.geometry = std::move(builder).build();
  world.sky = sky ? std::move(sky) : blackSky(grid);
  return world;
}
void setSun(World& world, const CDVector& to_sun, const CDStokesVector& irradiance = 1.0) {
  world.sun.emplace(Sun{normalized(to_sun), spectrumOf(irradiance), 0});
}
CDStokesVector seen(const World& world, const RadiometryOptions& options,
                    const Radiometry::Ray& ray) {
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  std::array<double, 4> out{};
  radiometry.radiance({&ray, 1}, out);
  return {out[0], out[1], out[2], out[3]};
}
CDMuellerMatrix matrix(const FresnelTerms<double>& f) {
  return CDMuellerMatrix(
      {f.sum, f.diff, 0, 0, f.diff, f.sum, 0, 0, 0, 0, f.re, f.im, 0, 0, -f.im, f.re});
}
const RadiometryOptions sun_only{.rays = {1}};
/// Of a mean; five standard errors, for some dozen comparisons with a false alarm in 10^5.
void expectNear(const Estimate& got, const std::array<double, 4>& expected, const char* what) {
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(got.mean[c], expected[c], 5 * got.error[c] + 1e-9) << what << ", S" << c;
}
}  // namespace

// A matt floor in the sun, seen through m upright panes at Brewster's angle: Stokes's formula.
// The panes are close together, so that light between them still reaches the floor; in front of
// the camera nothing is lit.
TEST(ClearPathsPublished, APileOfPlatesPolarises) {
  const double theta = brewsterAngle(1.5);
  const Reflectances face = fresnelReflectances(theta, 1.5);
  for (const int plates : {1, 3}) {
    std::vector<Quad> quads{{{0, -50, 0}, {100, -50, 0}, {100, 50, 0}, {0, 50, 0}, matt(0.5)}};
    for (int i = 0; i < plates; ++i) {
      const double x = -1 - 0.001 * i;
      quads.push_back({{x, -90, 0}, {x, 90, 0}, {x, 90, 90}, {x, -90, 90}, pane(1.5)});
    }
    World world = worldOf(quads);
    setSun(world, {1, 0, 1});
    const double floor = 0.5 / pi * std::sqrt(0.5);
    const CDVector from = normalized(CDVector{-std::cos(theta), 0, std::sin(theta)});
    const auto got =
        estimate(world, sun_only, looking({10, 0, 0}, from, {0, 1, 0}, 0, 40), 4000);
    const auto passed = [&](double r) { return (1 - r) / (1 + (2 * plates - 1) * r); };
    // the plane of incidence is that of x and z, so s is horizontal
    expectNear(got,
               {floor * (passed(face.Rs) + passed(face.Rp)) / 2,
                floor * (passed(face.Rs) - passed(face.Rp)) / 2, 0, 0},
               "through a pile");
    EXPECT_LT(got.error[0], 0.01 * floor);  // the camera's ways are split
    EXPECT_GT(std::abs(got.mean[1] / got.mean[0]), 0.1 * plates);
  }
}

// The floor's frame and the pane's are one, so the expected light is a product of matrices.
TEST(ClearPathsIdentity, TheSunThroughAPane) {
  for (const double absorption : {0.0, 40.0}) {
    World world =
        worldOf({floorOf(facets(1.5, 0, 0.3), 10),
                 {{-9, -9, 1}, {9, -9, 1}, {9, 9, 1}, {-9, 9, 1}, pane(1.52, absorption, 5)}});
    const CDStokesVector E(2, 0.3, 0.4, 0.5);
    const double theta = 0.9, view = 0.4;
    const CDVector to_sun = CDVector::fromAngles(theta, 0);
    setSun(world, to_sun, E);
    const FresnelTerms<double> t =
        paneTerms(std::cos(theta), std::sin(theta) * std::sin(theta), 1.52, absorption * 5e-3)
            .transmission;
    const CDVector to_viewer = CDVector::fromAngles(view, 2);
    const CDStokesVector expected =
        world.materials[0].brdf->getBRDF(BRDFGeometry::fromAngles(theta, view, 2)).at(0) *
        (matrix(t) * E) * std::cos(theta);
    const CDStokesVector got =
        seen(world, sun_only, looking({}, to_viewer, rayFrame(to_viewer, {0, 0, 1}).s, 0, 0.9));
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(got.getStokes(i), expected.getStokes(i), 1e-9 * expected.getScalar());
  }
}

// Diffuse light under a pane: L = rho (T + R L), with the pane's means over the cosine. Four reflections leave less than
// (0.5 * 0.25)^4 = 2e-4 of it out.
TEST(ClearPathsIdentity, TheSkyThroughAPane) {
  double T = 0, R = 0;
  const int rings = 4000;
  for (int i = 0; i < rings; ++i) {
    const double x = (i + 0.5) / rings;
    const PaneTerms terms = paneTerms(std::sqrt(1 - x), x, 1.5);
    T += terms.transmission.sum / rings, R += terms.reflection.sum / rings;
  }
  const World world = worldOf(
      {floorOf(matt(0.5), 400),
       {{-400, -400, 0.1}, {400, -400, 0.1}, {400, 400, 0.1}, {-400, 400, 0.1}, pane(1.5)}},
      uniformSky(1));
  const auto got = estimate(world, {.rays = {17, 3, 2, 2}},
                            looking({}, {0.1, 0.2, 1}, {1, 0, 0}, 0, 0.05), 4000);
  const double expected = 0.5 * T / (1 - 0.5 * R);
  EXPECT_NEAR(got.mean[0], expected, 5 * got.error[0] + 2e-4);
  EXPECT_LT(got.error[0], 2e-3);
  EXPECT_GT(std::abs(got.mean[0] - 0.5 * T),
            20 * got.error[0]);  // negative control: no light comes back
}

// What a body mirrors, refracts and reflects totally inside adds up to the uniform sky, unpolarised, wherever one looks.
TEST(ClearPathsInvariant, AGlassBoxInAUniformSkyCannotBeSeen) {
  const World clear = worldWith({}, box({-1, -1, -1}, {1, 1, 1}), body(1.5), uniformSky(1)),
              smoky =
                  worldWith({}, box({-1, -1, -1}, {1, 1, 1}), body(1.5, 0.2), uniformSky(1));
  for (int i = 0; i < 8; ++i) {
    const CDVector from = CDVector::fromAngles(0.3 + 0.17 * i, 0.4 + 0.9 * i);
    const auto ray = looking({0.3, -0.2 + 0.1 * i, 0.1}, from, {-from.y, from.x, 0});
    expectNear(estimate(clear, sun_only, ray, 2000), {1, 0, 0, 0}, "clear");
    EXPECT_LT(estimate(smoky, sun_only, ray, 2000).mean[0], 0.95);
  }
}

// From within, the sky is n^2 times as bright in all directions that get out.
TEST(ClearPathsInvariant, InsideTheSkyIsBrighterByTheSquareOfTheIndex) {
  const double n = 4 / 3.0;
  const World world = worldWith({}, box({-1, -1, -1}, {1, 1, 1}), body(n), uniformSky(1));
  for (const CDVector& d :
       {CDVector{0, 0, 1}, {0.1, 0.2, 0.9}, {0.6, 0.1, 0.75}, {-0.9, 0.3, -0.1}}) {
    const CDVector direction = normalized(d);
    const auto rayOf = [&](std::uint64_t pixel) {
      return Radiometry::Ray{{0.1, 0.2, -0.3}, direction, {0.3, 1, 0}, pixel, 0, 0};
    };
    expectNear(estimateOver(world, sun_only, rayOf, 2000), {n * n, 0, 0, 0}, "inside");
  }
}

// Over a black bed the diver sees the sky in a cone of 48.6 degrees, and beyond it the bed's image.
TEST(ClearPathsPublished, SnellsWindow) {
  const double n = 4 / 3.0;
  const World world =
      worldWith({{{-400, -400, -2}, {400, -400, -2}, {400, 400, -2}, {-400, 400, -2}, matt(0)}},
                box({-500, -500, -9}, {500, 500, 0}), body(n), uniformSky(1));
  for (double deg = 1; deg < 85; deg += 4) {
    const CDVector up = CDVector::fromAngles(toRadians(deg), 0.7);
    const Radiometry::Ray ray{{0, 0, -1}, up, {-up.y, up.x, 0}, 0, 0, 0};
    const CDStokesVector got = seen(world, sun_only, ray);
    if (deg > toDegrees(std::asin(1 / n))) {
      EXPECT_EQ(got.getScalar(), 0) << deg;
      continue;
    }
    const double sine = n * std::sin(toRadians(deg)), cosine = std::sqrt(1 - sine * sine);
    const FresnelTerms<double> t = radianceTransmission(cosine, sine * sine, n);
    EXPECT_NEAR(got.getScalar(), t.sum, 1e-9) << deg;
    EXPECT_NEAR(got.getStokes(1), t.diff, 1e-9) << deg;
  }
}

// The bed in the sun: down along the refracted way, up along the viewer's, Beer's law on both. The way is shorter by the
// offset of the rays' start, 2^-16 of the scene's half width, beside a depth of two metres.
TEST(ClearPathsIdentity, TheBottomOfALakeInTheSun) {
  const double n = 4 / 3.0, a = 0.3, theta = 0.8, view = 0.5, depth = 2;
  World world = worldWith({{{-8, -8, -2}, {8, -8, -2}, {8, 8, -2}, {-8, 8, -2}, matt(0.4)}},
                          box({-9, -9, -3}, {9, 9, 0}), body(n, a));
  setSun(world, CDVector::fromAngles(theta, 1));
  const double within = refractedAngle(theta, n), back = refractedAngle(view, n);
  const double s2 = std::sin(theta) * std::sin(theta), v2 = std::sin(view) * std::sin(view);
  const double bed = 0.4 / pi * std::cos(theta) *
                     fresnelTransmission(std::cos(theta), s2, n).sum *
                     std::exp(-a * depth / std::cos(within));
  const FresnelTerms<double> out = fresnelTransmission(std::cos(view), v2, n);
  const double up = bed * std::exp(-a * depth / std::cos(back)) / (n * n);
  const CDVector to_viewer = CDVector::fromAngles(view, 2.5);
  const CDStokesVector got =
      seen(world, sun_only, looking({}, to_viewer, rayFrame(to_viewer, {0, 0, 1}).s));
  EXPECT_NEAR(got.getScalar(), up * out.sum, 2e-4 * up);
  EXPECT_NEAR(got.getStokes(1), up * out.diff, 2e-4 * up);
  EXPECT_GT(std::abs(got.getScalar() - up * n * n), 0.3 * up);  // negative control: without n^2
}

// Least deviation: n = sin((delta + alpha)/2)/sin(alpha/2), for each band by its own index.
TEST(ClearPathsPublished, APrismDeviatesEachBandByItsIndex) {
  const double apex = toRadians(60);
  const SpectralGridPtr grid = SpectralGrid::make({450.0, 650.0});
  CDSpectralVector<double> n(grid);
  n[0] = 1.60, n[1] = 1.50;
  const World world = worldWith({}, prism(apex),
                                std::make_shared<ClearSurface>(
                                    ClearSurface::body(n, CDSpectralVector<double>(grid, 0.0))),
                                nullptr, grid);
  const RayTracer tracer(world.geometry);
  const auto paths = ClearPaths::of(world, tracer);
  ASSERT_TRUE(paths);
  for (std::size_t band = 0; band < 2; ++band) {
    const double least = 2 * std::asin(n[band] * std::sin(apex / 2)) - apex;
    // symmetric: the ray inside is level, so outside it rises by half of the deviation and falls by as much
    const CDVector direction{std::cos(least / 2), 0, std::sin(least / 2)};
    const CDVector at{-0.5 * std::tan(apex / 2), 0.1, -0.5}, origin = at - direction * 3;
    Random random(1);
    int through = 0;
    for (const ClearPath& path :
         paths->all(origin, direction, tracer.intersect(origin, direction), random)) {
      if (path.crossings.size() != 2 || path.crossings[1].mirrored || path.band != band)
        continue;
      ++through;
      EXPECT_NEAR(std::acos(dot(path.direction, direction)), least, 1e-9);
      EXPECT_NEAR(path.direction.z, -direction.z, 1e-9);
    }
    EXPECT_EQ(through, 1) << band;
  }
}

// Half of the light that a lens of colours sends is red, half blue: each band's mean is that of a body of its index alone.
TEST(ClearPathsInvariant, LotsOfColoursHaveTheRightMean) {
  const SpectralGridPtr grid = SpectralGrid::make({450.0, 650.0});
  CDSpectralVector<double> n(grid);
  n[0] = 1.9, n[1] = 1.2;
  const Model glass = std::make_shared<ClearSurface>(
      ClearSurface::body(n, CDSpectralVector<double>(grid, 0.1)));
  const Model ground = std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(grid, 0.5));
  const auto sky = std::make_shared<UniformSky>(CDSpectralVector<CDStokesVector>(grid, 1.0));
  const World world =
      worldWith({floorOf(ground, 3)}, box({-1, -1, 0.2}, {1, 1, 1}), glass, sky, grid);
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              {.rays = {17}});
  std::array<double, 2> sum{}, squares{};
  const int pixels = 4000;
  for (int i = 0; i < pixels; ++i) {
    std::array<double, 8> out{};
    const auto ray = looking({0.2, 0.1, 0}, {3, 0, 0.2}, {0, 1, 0}, std::uint64_t(i), 0.5);
    radiometry.radiance({&ray, 1}, out);
    for (std::size_t b = 0; b < 2; ++b) sum[b] += out[b], squares[b] += out[b] * out[b];
  }
  for (std::size_t b = 0; b < 2; ++b) {
    const World alone = worldWith({floorOf(matt(0.5), 3)}, box({-1, -1, 0.2}, {1, 1, 1}),
                                  body(n[b], 0.1), uniformSky(1));
    const auto one = estimate(alone, {.rays = {17}},
                              looking({0.2, 0.1, 0}, {3, 0, 0.2}, {0, 1, 0}, 0, 0.5), pixels);
    const double mean = sum[b] / pixels,
                 error = std::sqrt((squares[b] / pixels - mean * mean) / pixels);
    EXPECT_NEAR(mean, one.mean[0], 5 * std::hypot(error, one.error[0])) << b;
  }
}

TEST(ClearPathsInvariant, ARaysLightDoesNotDependOnItsCompany) {
  World world = worldWith({floorOf(facets(0.4, 2.9, 0.2), 3),
                           {{-3, -3, 1.5}, {3, -3, 1.5}, {3, 3, 1.5}, {-3, 3, 1.5}, pane(1.5)}},
                          box({-1, -1, 0.2}, {1, 1, 1}), body(1.5), uniformSky(1));
  setSun(world, {1, 2, 3});
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              {.rays = {9, 3}});
  std::vector<Radiometry::Ray> rays;
  for (int i = 0; i < 6; ++i)
    rays.push_back(looking({0.4 * i - 1, 0.1, 0}, {1, 1, 2}, {1, -1, 0}, std::uint64_t(i)));
  std::vector<double> all(24), one(4);
  radiometry.radiance(rays, all);
  for (std::size_t i = 6; i-- > 0;) {
    radiometry.radiance({&rays[i], 1}, one);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(one[c], all[4 * i + c]);
  }
}

TEST(ClearPathsRefusal, SaysWhatIsWrongWithABody) {
  const auto faultOf = [](const Mesh& mesh) {
    GeometryBuilder builder;
    builder.addMesh(mesh, {});
    return bodyFault(std::move(builder).build(), 0).what;
  };
  Mesh mesh = box({-1, -1, -1}, {1, 1, 1});
  EXPECT_EQ(faultOf(mesh), "");
  Mesh open = mesh;
  open.triangles.resize(10);
  EXPECT_EQ(
      faultOf(open),
      "bounds no closed body: 4 of its edges do not belong to two facets with fronts on one "
      "side, one of them at (-1, -1, -1) m");
  for (Triangle& t : mesh.triangles) std::swap(t.b, t.c);
  EXPECT_EQ(faultOf(mesh), "bounds a body whose fronts face inwards");
  GeometryBuilder builder;
  builder.addGround(0, "water", "ground");
  EXPECT_NE(bodyFault(std::move(builder).build(), 0).what.find("has no end"),
            std::string::npos);
  const World world = worldWith({}, open, body(1.5));
  EXPECT_THROW(Radiometry(world, std::make_shared<RayTracer>(world.geometry), sun_only),
               Refusal);
}
