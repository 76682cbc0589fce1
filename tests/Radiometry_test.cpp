// The light that leaves surfaces (nw/render/Radiometry.nw, nw/render/HemisphereRays.nw,
// nw/render/TwoAndAHalfBounces.nw).
#include "malus/render/Radiometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "malus/air/RayleighSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/render/HemisphereRays.hpp"
#include "malus/surface/BRDFDiffuse.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/thesis/OldFaults.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const SpectralGridPtr one_band = SpectralGrid::make({CDSpectralLocation(550.0)});

struct Plate {  // a square in the plane z = 0 of its own axes, turned and moved by `place`
  Transform place;
  std::shared_ptr<const CDBRDFModel> brdf;
};

CDSpectralVector<CDStokesVector> light(const CDStokesVector& s) {
  CDSpectralVector<CDStokesVector> v(one_band);
  v[0] = s;
  return v;
}

World worldOf(const std::vector<Plate>& plates, double sky = 0) {
  World world;
  world.grid = one_band;
  GeometryBuilder builder;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    Mesh mesh;
    mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.facets = {"plate" + std::to_string(i)}, mesh.materials = {"m" + std::to_string(i)};
    mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
    builder.addMesh(mesh, plates[i].place);
    world.materials.push_back({"m" + std::to_string(i), plates[i].brdf});
  }
  world.geometry = std::move(builder).build();
  world.sky = std::make_shared<UniformSky>(light(sky));
  return world;
}

// A point: what one direction sends. The disk is in SunDisk_test.cpp.
void setSun(World& world, const CDVector& to_sun, const CDStokesVector& irradiance) {
  world.sun.emplace(Sun{normalized(to_sun), light(irradiance), 0});
}

std::shared_ptr<const CDBRDFModel> copper(double sigma = 0.2) {
  return std::make_shared<BRDFTorranceSparrow>(0.405, 2.95, sigma);
}

CDStokesVector seen(const World& world, const RadiometryOptions& options,
                    const Radiometry::Ray& ray, Radiometry::Truth* truth = nullptr) {
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  std::array<double, 4> out{};
  Radiometry::Truth met;
  radiometry.radiance({&ray, 1}, out, {&met, 1});
  if (truth) *truth = met;
  return {out[0], out[1], out[2], out[3]};
}

/// A ray that sees the point `at` from direction `to_viewer`, `up` of the image given by `horizontal`.
Radiometry::Ray looking(const CDVector& at, const CDVector& to_viewer,
                        const CDVector& horizontal) {
  const CDVector d = normalized(to_viewer);
  return {at + d * 5, -d, horizontal};
}

double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double largest = 0;
  for (int i = 0; i < 4; ++i)
    largest = std::max(largest, std::abs(a.getStokes(i) - b.getStokes(i)));
  return largest;
}
const RadiometryOptions sun_only{.rays = {1}};
}  // namespace

// f E cos(theta), all in frames of the plate: single precision has no part in the sun's light.
TEST(RadiometryIdentity, PlateReflectsWhatItsBRDFSays) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const double theta_i = 85 * degree * random.uniform(),
                 theta_r = 85 * degree * random.uniform();
    const double phi_i = 2 * pi * random.uniform(), phi_r = 2 * pi * random.uniform();
    const CDVector to_sun = CDVector::fromAngles(theta_i, phi_i),
                   to_viewer = CDVector::fromAngles(theta_r, phi_r);
    World world = worldOf({{{}, copper()}});
    const CDStokesVector E(100, 20, 30, 60);
    setSun(world, to_sun, E);
    const CDStokesVector expected =
        copper()->getBRDF(BRDFGeometry::fromAngles(theta_i, theta_r, phi_r - phi_i)).at(0) * E *
        std::cos(theta_i);
    const RayFrame frame = rayFrame(to_viewer, {0, 0, 1});
    const CDStokesVector got = seen(world, sun_only, looking({}, to_viewer, frame.s));
    EXPECT_LT(apart(got, expected), 1e-9 * expected.getScalar()) << i;
  }
}

TEST(RadiometryIdentity, NegativeControlATenthOfADegreeIsSeen) {
  World world = worldOf({{{}, copper()}});
  setSun(world, CDVector::fromAngles(30.1 * degree, pi), {100, 20, 30, 60});
  const CDVector viewer = CDVector::fromAngles(40 * degree, 0);
  const CDStokesVector expected =
      copper()->getBRDF(BRDFGeometry::fromDegrees(30, 40, 180)).at(0) *
      CDStokesVector(100, 20, 30, 60) * std::cos(30 * degree);
  EXPECT_GT(apart(seen(world, sun_only, looking({}, viewer, rayFrame(viewer, {0, 0, 1}).s)),
                  expected),
            1e-4 * expected.getScalar());
}

// Everything is turned together about any axis but for the directions that define frames: the sun's light is
// unpolarised, and the camera's horizontal turns along.
TEST(RadiometryInvariant, ATurnedWorldLooksTheSame) {
  Random random(2);
  const CDVector to_sun = CDVector::fromAngles(0.5, 1), viewer = CDVector::fromAngles(0.7, 3);
  CDStokesVector first;
  for (int i = 0; i < 20; ++i) {
    const Transform turn =
        i == 0 ? Transform{}
               : Transform::rotate(
                     CDVector::fromAngles(pi * random.uniform(), 6 * random.uniform()),
                     6 * random.uniform());
    const Transform steep =
        Transform::translate({0.9, 0, 0}).after(Transform::rotate({0, 1, 0}, -1.2));
    World world = worldOf({{turn, copper()}, {turn.after(steep), copper(0.1)}});
    setSun(world, turn.apply(to_sun), 1);
    const CDStokesVector got = seen(world, {.sampling = Sampling::grid, .rays = {1}},
                                    looking({}, turn.apply(viewer), turn.apply({0, 1, 0})));
    if (i == 0) first = got;
    EXPECT_LT(apart(got, first), 1e-9 * first.getScalar());
  }
}

TEST(RadiometryInvariant, ATurnedCameraTurnsTheStokesVector) {
  World world = worldOf({{{}, copper()}});
  setSun(world, CDVector::fromAngles(0.5, 1), {1, 0.2, -0.3, 0.4});
  const CDVector viewer = CDVector::fromAngles(0.7, 3);
  const RayFrame frame = rayFrame(viewer, {0, 0, 1});
  const CDStokesVector level = seen(world, sun_only, looking({}, viewer, frame.s));
  for (const double angle : {0.3, 1.0, 2.5}) {
    const CDVector horizontal = frame.s * std::cos(angle) + frame.p * std::sin(angle);
    CDStokesVector expected = level;
    expected.rotate(angle);
    EXPECT_LT(apart(seen(world, sun_only, looking({}, viewer, horizontal)), expected), 1e-12);
  }
}

// Lambertian plate under a uniform sky: rho L, exactly, when the weights sum to pi.
TEST(RadiometryIdentity, UniformSkyOnALambertianPlate) {
  const auto grey = std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(one_band, 0.5), 0.0);
  const World world = worldOf({{{}, grey}}, 2);
  for (const Sampling sampling : {Sampling::grid, Sampling::gridRotated}) {
    const CDStokesVector got = seen(world, {.sampling = sampling, .rays = {2001}},
                                    looking({}, {0.3, 0, 1}, {0, 1, 0}));
    EXPECT_NEAR(got.getScalar(), 1.0, 1e-3);  // midpoint rule over 22 zeniths
    EXPECT_FALSE(got.getDOP() > 1e-12);
  }
}

// Finding 10: with one reflection unpolarised light cannot become circular; with two it can.
TEST(RadiometryInvariant, CircularLightWantsTwoReflections) {
  const Transform wall =
      Transform::translate({1, 0.3, 0.6}).after(Transform::rotate({0.3, 1, 0}, -1.1));
  World world = worldOf({{{}, copper()}, {wall, copper()}}, 0.1);
  setSun(world, {-0.5, 0.2, 1}, 1);
  const Radiometry::Ray ray = looking({0.3, 0, 0}, {-0.4, 0.1, 1}, {0, 1, 0});
  const CDStokesVector single = seen(world, {.rays = {400}}, ray),
                       twice = seen(world, {.rays = {400, 1}}, ray);
  EXPECT_LT(std::abs(single.getStokes(3)), 1e-15);
  EXPECT_GT(std::abs(twice.getStokes(3)), 1e-6);
  EXPECT_GT(twice.getScalar(), single.getScalar());
}

// Two mirrors: with two rays at the first surface the one that is not the sun's leaves at 45 degrees towards +x (a grid of one
// cell). A wall reflects the sun. The product of matrices is written out, with rotations by angles.
TEST(RadiometryIdentity, PeriscopeIsAProductOfMatrices) {
  const CDVector wall_normal = normalized({-1, 0.35, -0.2}), d = normalized({1, 0, 1});
  const CDVector hit = d * 3, side = normalized(cross({0, 0, 1}, wall_normal));
  const Transform wall{side, cross(wall_normal, side), wall_normal, hit};
  World world = worldOf({{{}, copper()}, {wall, copper(0.3)}});
  const CDVector to_sun = normalized({-1, 0.8, 0.3});
  const CDStokesVector E(100, 20, 30, 60);
  setSun(world, to_sun, E);
  const CDVector to_viewer = normalized({-0.7, 0.4, 1});
  const RayFrame camera = rayFrame(to_viewer, {0, 1, 0});
  const auto product = [&](double slip) {
    const auto local = [](const CDVector& n,
                          const CDVector& v) {  // any axes with z = n will do: isotropic
      const CDVector x = normalized(cross({0.1, 1, 0.3}, n));
      return CDVector{dot(v, x), dot(v, cross(n, x)), dot(v, n)};
    };
    const auto matrix = [&](double sigma, const CDVector& n, const CDVector& in,
                            const CDVector& out) {
      return copper(sigma)
          ->getBRDF(BRDFGeometry::fromDirections(local(n, in), local(n, out)))
          .at(0);
    };
    const auto turned = [](CDStokesVector s, const RayFrame& from, const RayFrame& to,
                           double more = 0) {
      s.rotate(frameRotation(from, to) + more);
      return s;
    };
    CDStokesVector s = turned(E, rayFrame(-to_sun, {0, 0, 1}), rayFrame(-to_sun, wall_normal));
    s = dot(to_sun, wall_normal) * (matrix(0.3, wall_normal, to_sun, -d) * s);
    s = turned(s, rayFrame(-d, wall_normal), rayFrame(-d, {0, 0, 1}), slip);
    s = 2 * pi * std::sqrt(0.5) * (matrix(0.2, {0, 0, 1}, d, to_viewer) * s);
    const CDStokesVector sun =
        to_sun.z * (matrix(0.2, {0, 0, 1}, to_sun, to_viewer) *
                    turned(E, rayFrame(-to_sun, {0, 0, 1}), rayFrame(-to_sun, {0, 0, 1})));
    return turned(s + sun, rayFrame(to_viewer, {0, 0, 1}), camera);
  };
  const Radiometry::Ray ray{to_viewer * 2, -to_viewer, camera.s};
  const CDStokesVector got = seen(world, {.sampling = Sampling::grid, .rays = {2, 1}}, ray);
  const CDStokesVector alone = seen(world, sun_only, ray);
  EXPECT_GT(got.getScalar(), 1.0001 * alone.getScalar());     // the second mirror is there
  EXPECT_LT(apart(got, product(0)), 1e-6 * got.getScalar());  // directions are single precision
  EXPECT_GT(apart(got, product(0.01)),
            1e-5 * got.getScalar());  // negative control: one frame turned a little
}

// The same bits for a ray alone, among others, and in another order.
TEST(RadiometryInvariant, CompanyChangesNoBit) {
  const Transform wall =
      Transform::translate({1, 0.3, 0.6}).after(Transform::rotate({0.3, 1, 0}, -1.1));
  World world = worldOf({{{}, copper()}, {wall, copper()}}, 0.1);
  setSun(world, {-0.5, 0.2, 1}, 1);
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry),
                              {.rays = {30, 10}});
  std::vector<Radiometry::Ray> rays;
  for (std::uint64_t i = 0; i < 50; ++i) {
    rays.push_back(looking({0.02 * double(i) - 0.4, 0.1, 0}, {-0.4, 0.1, 1}, {0, 1, 0}));
    rays.back().pixel = i;
  }
  std::vector<double> all(rays.size() * 4), one(4);
  radiometry.radiance(rays, all);
  for (std::size_t i = rays.size(); i-- > 0;) {
    radiometry.radiance({&rays[i], 1}, one);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(one[c], all[4 * i + c]);
  }
}

// Surfaces at the end of a path are evaluated together, unless something emits. At 300 K a
// surface emits almost nothing at 550 nm (1e-30 of the sky's), but all surfaces go the other
// way then. 1e-12: the order of sums.
TEST(RadiometryInvariant, SurfacesThatAskTogetherAnswerAsEachByItself) {
  const Transform wall =
      Transform::translate({1, 0.3, 0.6}).after(Transform::rotate({0.3, 1, 0}, -1.1));
  const auto plate = copper(), other = copper(0.3);
  const auto glow = std::make_shared<Emission>(
      BRDFDiffuse(CDSpectralVector<double>(one_band, 0.5), 0.0), 300);
  const Radiometry::Ray ray = looking({0.3, 0.1, 0}, {-0.4, 0.1, 1}, {0, 1, 0});
  for (const bool clear : {false, true}) {
    World world = worldOf({{{}, plate}, {wall, other}}, 0.1);
    setSun(world, {-0.5, 0.2, 1}, 1);
    if (clear)
      world.sky =
          std::make_shared<RayleighSky>(*world.sun, RayleighSky::clearAir(one_band, 0.3));
    for (const Sampling sampling :
         {Sampling::random, Sampling::gridRotated, Sampling::importance}) {
      Radiometry::Truth together, alone;
      world.materials[1].emission = nullptr;
      const CDStokesVector a =
          seen(world, {.sampling = sampling, .rays = {30, 6}}, ray, &together);
      world.materials[1].emission = glow;
      const CDStokesVector b =
          seen(world, {.sampling = sampling, .rays = {30, 6}}, ray, &alone);
      EXPECT_LT(apart(a, b), 1e-12 * a.getScalar());
      EXPECT_EQ(together.rays, alone.rays);
      EXPECT_GT(together.rays, 40u) << "there are second surfaces";
      const CDStokesVector less = seen(world, {.sampling = sampling, .rays = {30, 4}}, ray);
      EXPECT_GT(apart(a, less), 1e-6 * a.getScalar()) << "negative control: fewer rays";
    }
  }
}

namespace {
/// A ground and an endless wall beside it that reflects so much, under a sky of 2.
World corner(double wall_reflectance, double sky = 2) {
  const auto matt = [](double reflectance) {
    return std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(one_band, reflectance), 0.0);
  };
  const Transform large = Transform::scale(1e4),
                  upright = Transform::rotate({0, 1, 0}, -pi / 2);
  const Transform wall = Transform::translate({1, 0, 0}).after(upright).after(large);
  return worldOf({{large, matt(0.5)}, {wall, matt(wall_reflectance)}}, sky);
}
/// By two and a half bounces with 48 directions for the sky; toward the wall the ground's mirror ray meets it.
CDStokesVector byTheOldTracer(const World& world, bool toward,
                              Radiometry::Truth* truth = nullptr) {
  return seen(world, {.sampling = Sampling::twoAndAHalf, .rays = {50, 1}},
              looking({0.5, 0, 0}, {toward ? -0.6 : 0.0, 0.1, 1}, {0, 1, 0}), truth);
}
const double secant = 1 / std::cos(15 * degree);  // of three zeniths, as below
}  // namespace

// A wall that reflects exactly the sky's radiance (its reflectance compensates the grid's
// secant) represents everything that hides the sky, so that ground beside it is as bright as
// without it. 1e-6: weights are single precision.
TEST(RadiometryPublished, TwoAndAHalfBouncesKeepAnEvenHemisphere) {
  const World even = corner(1 / secant);
  Radiometry::Truth truth;
  const double open = 0.5 * 2 * secant, found = byTheOldTracer(even, true, &truth).getScalar();
  EXPECT_NEAR(found, open, 1e-6 * open);
  EXPECT_EQ(truth.rays, 50u) << "the camera's, the mirror's, and 48 for the sky; no sun";
  const double missed = byTheOldTracer(even, false).getScalar();
  EXPECT_NEAR(missed, open / 2, 1e-3 * open)
      << "a mirror ray that meets nothing brings nothing";
  EXPECT_NEAR(byTheOldTracer(corner(0.2 / secant), true).getScalar(), 0.6 * open, 1e-3 * open);
}

// The sun on the second surface alone, and on both: f E cos of the wall for half of the ground's hemisphere.
TEST(RadiometryPublished, TwoAndAHalfBouncesLightTheSecondSurface) {
  World world = corner(0.8, 0);
  const CDVector to_sun = normalized({-1, 0, 1});
  setSun(world, to_sun, 3);
  const double direct = 0.5 / pi * 3 * to_sun.z, wall = 0.8 / pi * 3 * -to_sun.x;
  Radiometry::Truth truth;
  EXPECT_NEAR(byTheOldTracer(world, true, &truth).getScalar(), direct + 0.5 * secant * wall / 2,
              1e-3 * wall);
  EXPECT_EQ(truth.rays, 52u);
  EXPECT_NEAR(byTheOldTracer(world, false).getScalar(), direct, 1e-9);
}

// Rough copper by way of rough copper: circular light needs both, and is there only if the mirror ray finds the second.
TEST(RadiometryInvariant, TwoAndAHalfBouncesCarryPolarisation) {
  const Transform wall =
      Transform::translate({1, 0.3, 0.6}).after(Transform::rotate({0.3, 1, 0}, -1.1));
  World world = worldOf({{{}, copper()}, {wall, copper()}}, 0.1);
  setSun(world, {-0.5, 0.2, 1}, 1);
  const RadiometryOptions options{.sampling = Sampling::twoAndAHalf, .rays = {400, 1}};
  const auto circular = [&](const CDVector& to_viewer) {
    return std::abs(
        seen(world, options, looking({0.3, 0, 0}, to_viewer, {0, 1, 0})).getStokes(3));
  };
  EXPECT_GT(circular({-1, 0.1, 0.6}), 1e-6);
  EXPECT_LT(circular({0.3, 0.9, 0.6}), 1e-15) << "negative control: the mirror ray leads away";
}

TEST(RadiometryInvariant, TwoAndAHalfBouncesNeedTheirRays) {
  const World world = corner(0.5);
  const auto tracer = std::make_shared<RayTracer>(world.geometry);
  for (const std::vector<int>& rays :
       std::vector<std::vector<int>>{{91}, {2, 1}, {91, 2}, {91, 1, 1}})
    EXPECT_THROW(Radiometry(world, tracer, {.sampling = Sampling::twoAndAHalf, .rays = rays}),
                 MathError);
  EXPECT_NO_THROW(
      Radiometry(world, tracer, {.sampling = Sampling::twoAndAHalf, .rays = {3, 1}}));
}

// Ground and a wall, both endless, in a corner: each covers half of the other's hemisphere, so
// that under a uniform
// sky L_n = rho (L + L_{n-1}) / 2 after n reflections, times 1/cos(15 deg) for the three zeniths of the grid (see the chapter).
// 1e-3: sixteen azimuths, however turned, are halved by a plane, but for the little that the wall's finite size leaves open.
TEST(RadiometryPublished, LambertianCornerIsAGeometricSeries) {
  for (const double rho : {0.5, 1.0}) {
    const auto matt =
        std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(one_band, rho), 0.0);
    const Transform large = Transform::scale(1e4),
                    upright = Transform::rotate({0, 1, 0}, -pi / 2);
    const Transform wall = Transform::translate({1, 0, 0}).after(upright).after(large);
    const World world = worldOf({{large, matt}, {wall, matt}}, 2);
    const auto tracer = std::make_shared<RayTracer>(world.geometry);
    double expected = 0;
    for (std::vector<int> rays = {49}; rays.size() < 4; rays.push_back(49)) {
      expected = rho * (2 + expected) / 2 / std::cos(15 * degree);
      const Radiometry radiometry(world, tracer,
                                  {.sampling = Sampling::gridRotated, .rays = rays});
      double sum = 0;
      for (std::uint64_t pixel = 0; pixel < 10; ++pixel) {
        Radiometry::Ray ray = looking({0.5, 0, 0}, {-0.3, 0.1, 1}, {0, 1, 0});
        ray.pixel = pixel;
        std::array<double, 4> out{};
        radiometry.radiance({&ray, 1}, out);
        sum += out[0] / 10;
      }
      EXPECT_NEAR(sum, expected, 1e-3 * expected) << rays.size() << " reflections";
      EXPECT_GT(std::abs(sum - expected * std::cos(15 * degree)),
                1e-2 * expected);  // negative control: no secant
    }
  }
}

// White furnace: rough mirrors that lose nothing look like the sky around them (the reciprocal term returns what grooves hold
// back). 1 %: a grid of 4000 directions over a lobe of 0.3.
TEST(RadiometryPublished, WhiteFurnaceOfARoughMirror) {
  const TorranceSparrowOptions keeps{Shadowing::vGroove, DiffuseTerm::reciprocal, true};
  const auto mirror = std::make_shared<BRDFTorranceSparrow>(0.0, 1e4, 0.3, keeps);
  const World world = worldOf({{{}, mirror}}, 3);
  for (const double zenith : {0.1, 0.6, 1.1}) {
    const CDVector viewer = CDVector::fromAngles(zenith, 1);
    const CDStokesVector got = seen(world, {.sampling = Sampling::grid, .rays = {4001}},
                                    looking({}, viewer, rayFrame(viewer, {0, 0, 1}).s));
    EXPECT_NEAR(got.getScalar(), 3, 0.03) << zenith;
  }
}

// Five ways to one integral. 2 %: two thousand directions over a lobe of sigma 0.3, the adaptive grid's cells being the largest.
TEST(RadiometryInvariant, AllSamplingsMeanTheSame) {
  const World world = worldOf({{{}, copper(0.3)}}, 1);
  const Radiometry::Ray ray = looking({}, {0.5, 0.3, 1}, {0, 1, 0});
  const CDStokesVector first = seen(world, {.sampling = Sampling::grid, .rays = {20001}}, ray);
  for (const Sampling sampling :
       {Sampling::random, Sampling::gridRotated, Sampling::adaptive, Sampling::importance}) {
    const CDStokesVector got = seen(world, {.sampling = sampling, .rays = {2001}}, ray);
    EXPECT_LT(apart(got, first),
              0.02 * first.getScalar() * (sampling == Sampling::random ? 5 : 1))
        << int(sampling);
    EXPECT_GT(apart(got * 1.2, first), 0.06 * first.getScalar());  // negative control
  }
}

// The random numbers of a ray are those of its pixel, and of nothing else that the two rays differ in.
TEST(RadiometryIdentity, RandomNumbersBelongToThePixel) {
  World world = worldOf({{{}, copper()}}, 1);
  Radiometry::Ray one = looking({}, {0.5, 0.3, 1}, {0, 1, 0}), other = one;
  const RadiometryOptions options{.sampling = Sampling::random, .rays = {20}};
  EXPECT_EQ(apart(seen(world, options, one), seen(world, options, other)), 0.0);
  other.pixel = 7;
  EXPECT_GT(apart(seen(world, options, one), seen(world, options, other)), 1e-3);
}

TEST(RadiometryIdentity, ShadowAndTruth) {
  World world = worldOf({{{}, copper()}, {Transform::translate({0, 0, 2}), copper()}}, 0.1);
  setSun(world, {0, 0, 1}, 1);
  Radiometry::Truth truth;
  seen(world, sun_only, {{3, 0, 1}, normalized({-3, 0, -1}), {0, 1, 0}}, &truth);
  EXPECT_EQ(truth.facet, 0u);
  EXPECT_TRUE(truth.sun_shadow);
  EXPECT_NEAR(truth.range_m, std::sqrt(10), 1e-6);
  seen(world, sun_only, {{0, 0, 5}, {0, 0, -1}, {1, 0, 0}}, &truth);
  EXPECT_EQ(truth.facet, 1u);
  EXPECT_FALSE(truth.sun_shadow);
  const CDStokesVector sky = seen(world, sun_only, {{0, 0, 5}, {0, 0, 1}, {1, 0, 0}}, &truth);
  EXPECT_EQ(truth.facet, Hit::nothing);
  EXPECT_NEAR(sky.getScalar(), 0.1, 1e-15);
}

// The fault of the thesis: some of many pixels sample the disk of a sun that is in the sky as
// well, a thousand times too bright.
TEST(RadiometryIdentity, SunInTheSkyAsWellIsAFaultThatShows) {
  const auto grey = std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(one_band, 0.5), 0.0);
  World world = worldOf({{{}, grey}}, 0.05);
  setSun(world, CDVector::fromAngles(0.5, 1), 1);
  const auto tracer = std::make_shared<RayTracer>(world.geometry);
  const auto largest = [&](const World& lit) {
    const Radiometry radiometry(lit, tracer, {.sampling = Sampling::random, .rays = {91}});
    double most = 0;
    for (std::uint64_t pixel = 0; pixel < 4000; ++pixel) {
      Radiometry::Ray ray = looking({}, {0.1, 0.1, 1}, {1, 0, 0});
      ray.pixel = pixel;
      std::array<double, 4> out{};
      radiometry.radiance({&ray, 1}, out);
      most = std::max(most, out[0]);
    }
    return most;
  };
  EXPECT_LT(largest(world), 0.5);
  EXPECT_GT(largest(withSunInSky(world)), 10);
}

TEST(RadiometryIdentity, RefusesWhatDoesNotFit) {
  World world = worldOf({{{}, copper()}});
  const auto tracer = std::make_shared<RayTracer>(world.geometry);
  EXPECT_THROW(Radiometry(world, tracer, {.rays = {-1}}), MathError);
  EXPECT_THROW(Radiometry(world, tracer, {.rays = {4097, 2}}), MathError);
  EXPECT_NO_THROW(Radiometry(world, tracer, {.rays = {4097, 1}}));
  EXPECT_THROW(Radiometry(world, nullptr, {}), MathError);
  world.materials[0].brdf = nullptr;
  EXPECT_THROW(Radiometry(world, tracer, {}), MathError);
}

TEST(RadiometryIdentity, RefusesToWriteBeyondTheRoomForTheAnswer) {
  const SpectralGridPtr two =
      SpectralGrid::make({CDSpectralLocation(500.0), CDSpectralLocation(600.0)});
  World world;
  world.grid = two;
  world.geometry = GeometryBuilder().build();
  world.sky =
      std::make_shared<UniformSky>(CDSpectralVector<CDStokesVector>(two, CDStokesVector(1.0)));
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), {});
  const Radiometry::Ray up{{}, {0, 0, 1}, {1, 0, 0}};
  std::array<double, 8> out{};
  EXPECT_THROW(radiometry.radiance({&up, 1}, std::span(out).first(7)), MathError);
  EXPECT_NO_THROW(radiometry.radiance({&up, 1}, out));
  EXPECT_EQ(out[0] + out[1], 2) << "both bands of S0";
}

namespace {
/// A sky that shines from one eighth of the azimuths.
class WedgeSky : public Sky {
 public:
  explicit WedgeSky(int eighth) : Sky(one_band), eighth_(eighth) {}
  void radiance(const CDVector& d, CDSpectralVector<CDStokesVector>& out) const override {
    out[0] = CDStokesVector(int(d.getAzimuth() / (pi / 4)) % 8 == eighth_ ? 1 : 0);
  }
  bool polarized() const override { return false; }
  std::string description() const override { return "a wedge"; }

 private:
  int eighth_;
};
}  // namespace

// A matt plate sees an eighth of the light of an even sky in each eighth of the azimuths: a turned grid must be turned by
// every angle alike. The standard error comes from the spread of 4000 turns; a false alarm of eight is one in 200,000.
TEST(RadiometryInvariant, ATurnedGridLooksAtAllAzimuthsAlike) {
  World world = worldOf(
      {{{}, std::make_shared<BRDFDiffuse>(CDSpectralVector<double>(one_band, 1.0))}}, 1);
  const RadiometryOptions options{.sampling = Sampling::gridRotated, .rays = {7}};
  Radiometry::Ray ray = looking({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  const double all = seen(world, options, ray).getScalar();
  for (int eighth = 0; eighth < 8; ++eighth) {
    world.sky = std::make_shared<WedgeSky>(eighth);
    const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
    double sum = 0, squares = 0;
    constexpr int turns = 4000;
    for (ray.pixel = 0; ray.pixel < turns; ++ray.pixel) {
      std::array<double, 4> out{};
      radiometry.radiance({&ray, 1}, out);
      sum += out[0] / all, squares += out[0] * out[0] / all / all;
    }
    const double mean = sum / turns, error = std::sqrt((squares / turns - mean * mean) / turns);
    EXPECT_NEAR(mean, 1.0 / 8, 5 * error) << eighth;
    EXPECT_LT(5 * error, 0.1 / 8) << "negative control: a tenth of an eighth would be seen";
  }
}

// ---- a polarised sky: the sum written out in double precision, frames turned by angles
namespace {
/// A Rayleigh sky on the test's band; `sign` -1 turns its S2 round.
class TestSky : public Sky {
 public:
  explicit TestSky(double sign) : Sky(one_band), sign_(sign) {
    const Sun sun{CDVector::fromAngles(50 * degree, 1), light(1)};
    sky_.emplace(sun, RayleighSky::clearAir(one_band, 0.3));
  }
  void radiance(const CDVector& to_sky, CDSpectralVector<CDStokesVector>& out) const override {
    sky_->radiance(to_sky, out);
    out.plane(2)[0] *= sign_;
  }
  bool polarized() const override { return true; }
  std::string description() const override { return "test"; }

 private:
  double sign_;
  std::optional<RayleighSky> sky_;
};

/// Light towards a viewer from the thesis's grid of 90 directions, in the frame of the viewer's ray and the normal.
CDStokesVector skySum(const Sky& sky, const CDBRDFModel& brdf, const CDVector& normal,
                      const CDVector& to_viewer) {
  const SurfaceAxes axes(normal);
  CDStokesVector sum(0, 0, 0, 0);
  for (const SamplePoint& p : uniformGridSampling(18, 5, pi / 2)) {
    const CDVector local = CDVector::fromAngles(p.zenith_rad, p.azimuth_rad),
                   to_sky = axes.toWorld(local);
    CDSpectralVector<CDStokesVector> in(one_band);
    sky.radiance(to_sky, in);
    const double theta = frameRotation(rayFrame(-to_sky, {0, 0, 1}), rayFrame(-to_sky, normal));
    CDStokesVector turned = in[0];
    turned.rotate(std::cos(2 * theta), std::sin(2 * theta));
    const auto f = brdf.getBRDF(BRDFGeometry::fromDirections(local, axes.toLocal(to_viewer)));
    sum += local.z * p.solid_angle_sr * (CDMuellerMatrix(f.at(0)) * turned);
  }
  return sum;
}
}  // namespace

// 1e-5: single precision. The plate leans so far that the sky's frames and the plate's differ everywhere, and little enough
// that all ninety directions are sky.
TEST(RadiometryIdentity, PolarisedSkyIsTheSumOfItsDirections) {
  const CDVector normal = normalized({0.3, -0.2, 1}), to_viewer = normalized({0.5, 0.4, 0.9});
  const double tilt = std::acos(normal.z), towards = std::atan2(normal.y, normal.x);
  const CDVector across{-std::sin(towards), std::cos(towards), 0};
  World world = worldOf({{Transform::rotate(across, tilt), copper()}});
  const auto sky = std::make_shared<TestSky>(1), wrong = std::make_shared<TestSky>(-1);
  world.sky = sky;
  const CDVector horizontal = rayFrame(to_viewer, normal).s;
  const CDStokesVector found = seen(world, {.sampling = Sampling::grid, .rays = {91}},
                                    looking({0, 0, 0}, to_viewer, horizontal));
  const CDStokesVector expected = skySum(*sky, *copper(), normal, to_viewer);
  EXPECT_LT(apart(found, expected), 1e-5 * expected.getScalar());
  EXPECT_GT(std::abs(expected.getStokes(2)), 0.01 * expected.getScalar());
  EXPECT_GT(std::abs(expected.getStokes(3)), 0.01 * expected.getScalar());
  const CDStokesVector control = skySum(*wrong, *copper(), normal, to_viewer);
  EXPECT_GT(apart(found, control), 1e-3 * expected.getScalar())
      << "negative control: the other sign of S2";
}

// Directions of no weight fill a list up to whole bundles, and no further.
TEST(RadiometryIdentity, AListIsFilledUpToTheNextBundle) {
  for (const auto& [size, full] :
       {std::pair{1u, 16u}, {15u, 16u}, {16u, 16u}, {17u, 32u}, {32u, 32u}}) {
    HemisphereRays rays;
    for (unsigned i = 0; i < size; ++i) rays.add({0, 0, 1}, 0.5);
    rays.fillUp(16);
    EXPECT_EQ(rays.size(), full) << size;
    for (unsigned i = 0; i < full; ++i) EXPECT_EQ(rays.weight[i], i < size ? 0.5f : 0.0f);
  }
}
