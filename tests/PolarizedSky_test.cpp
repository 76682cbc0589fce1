// The polarised sky as surfaces see it: nw/air/RayleighSky.nw through nw/render/Radiometry.nw.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "malus/air/RayleighSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/render/Radiometry.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const CDVector up{0, 0, 1};
const SpectralGridPtr one_band = SpectralGrid::make({450.0});

std::shared_ptr<const CDBRDFModel> copper() {
  const CDSpectralVector<double> n(one_band, 1.165), k(one_band, 2.4), sigma(one_band, 0.3);
  return std::make_shared<BRDFTorranceSparrow>(n, k, sigma);
}

std::shared_ptr<const RayleighSky> skyWith(const CDVector& to_sun) {
  const Sun sun{to_sun, CDSpectralVector<CDStokesVector>(one_band, 1.0)};
  return std::make_shared<RayleighSky>(sun, RayleighSky::clearAir(one_band, 0.2));
}

World worldOf(const Transform& place, std::shared_ptr<const Sky> sky) {
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.facets = {"plate"}, mesh.materials = {"copper"};
  mesh.triangles = {{0, 1, 2, 0, 0}, {0, 2, 3, 0, 0}};
  World world;
  world.grid = one_band;
  GeometryBuilder builder;
  builder.addMesh(mesh, place);
  world.geometry = std::move(builder).build();
  world.materials.push_back({"copper", copper()});
  world.sky = std::move(sky);
  return world;
}

CDStokesVector seen(const World& world, const CDVector& to_viewer, const CDVector& horizontal) {
  const RadiometryOptions options{.sampling = Sampling::grid, .rays = {20001}};
  const Radiometry radiometry(world, std::make_shared<RayTracer>(world.geometry), options);
  const Radiometry::Ray ray{to_viewer * 5, -to_viewer, horizontal};
  std::array<double, 4> out{};
  radiometry.radiance({&ray, 1}, out, {});
  return {out[0], out[1], out[2], out[3]};
}

// The same by a separate midpoint rule and frames built from their definitions.
CDStokesVector integrated(const Sky& sky, const CDVector& normal, const CDVector& to_viewer,
                          const CDVector& horizontal) {
  const auto brdf = copper();
  const RayFrame local =
      rayFrame(-normal, {1, 2, 3});  // s, p across the normal, in some azimuth
  const int zones = 250, sectors = 300;
  CDStokesVector sum(0, 0, 0, 0);
  CDSpectralVector<CDStokesVector> light(one_band);
  const double cos_r = dot(to_viewer, normal);
  const CDVector across = to_viewer - cos_r * normal;
  for (int i = 0; i < zones; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double z = (i + 0.5) / zones, r = std::sqrt(1 - z * z),
                   turn = 2 * pi * (j + 0.5) / sectors;
      const CDVector d = z * normal + r * (std::cos(turn) * local.s + std::sin(turn) * local.p);
      sky.radiance(d, light);
      CDStokesVector in = std::as_const(light)[0];
      in.rotate(frameRotation(rayFrame(-d, up), rayFrame(-d, normal)));
      const CDVector flat = d - z * normal;
      const double phi = std::atan2(dot(cross(flat, across), normal), dot(flat, across));
      const auto f =
          brdf->getBRDF(BRDFGeometry::fromAngles(std::acos(z), std::acos(cos_r), phi)).at(0);
      sum += f * in * (z * 2 * pi / (zones * sectors));
    }
  RayFrame camera = rayFrame(to_viewer, normal);
  camera.s = normalized(horizontal - dot(horizontal, to_viewer) * to_viewer);
  camera.p = cross(to_viewer, camera.s);
  return sum.rotate(frameRotation(rayFrame(to_viewer, normal), camera));
}

double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a.getStokes(i) - b.getStokes(i)));
  return most / b.getScalar();
}
}  // namespace

// A rough copper plate reads the sky: level and tilted, from many azimuths, camera level and rolled. Both
// sums have about 10^5 directions over a lobe half a radian wide and a sky with a bright horizon: 1e-3.
TEST(PolarizedSkyInvariant, ARoughPlateReadsTheSky) {
  const auto sky = skyWith(compassDirection(60 * degree, 200 * degree));
  for (const bool tilted : {false, true}) {
    const Transform place = tilted ? Transform::rotate({0.6, 0.8, 0}, 0.7) : Transform{};
    const CDVector normal = place.apply(up);
    const World world = worldOf(place, sky);
    for (int azimuth = 0; azimuth < 360; azimuth += 120) {
      const CDVector viewer = place.apply(CDVector::fromAngles(50 * degree, azimuth * degree));
      const CDVector level = normalized(cross(up, viewer));
      const CDVector rolled = level * 0.8 + cross(viewer, level) * 0.6;
      for (const CDVector& horizontal : {level, rolled}) {
        const CDStokesVector ours = seen(world, viewer, horizontal),
                             theirs = integrated(*sky, normal, viewer, horizontal);
        EXPECT_LT(apart(ours, theirs), 1e-3) << tilted << ' ' << azimuth;
        if (std::abs(theirs.getStokes(2)) > 0.02 * theirs.getScalar()) {
          const CDStokesVector mirrored(theirs.getStokes(0), theirs.getStokes(1),
                                        -theirs.getStokes(2), theirs.getStokes(3));
          EXPECT_GT(apart(ours, mirrored), 1e-3);  // negative control
        }
      }
    }
  }
}

// Sun, sky, plate and camera turned about the vertical: the result does not change. The
// directions of the sampling
// stay with the east, and so differ by their step: 1e-3 as above.
TEST(PolarizedSkyInvariant, ATurnedWorldLooksTheSame) {
  CDStokesVector first;
  for (const double turn_deg : {0.0, 33.0, 145.0, 290.0}) {
    const Transform turn = Transform::rotate(up, turn_deg * degree);
    const auto sky = skyWith(turn.apply(compassDirection(60 * degree, 200 * degree)));
    const Transform place = turn.after(Transform::rotate({0.6, 0.8, 0}, 0.7));
    const CDVector viewer = turn.apply(normalized(CDVector{0.5, -0.3, 0.7}));
    const CDStokesVector got = seen(worldOf(place, sky), viewer, turn.apply({1, 0, 0}));
    if (turn_deg == 0)
      first = got;
    else
      EXPECT_LT(apart(got, first), 1e-3) << turn_deg;
    // turning the camera alone is seen
    EXPECT_GT(
        apart(seen(worldOf(place, sky), viewer, turn.apply(normalized(CDVector{1, 0.4, 0}))),
              first),
        1e-3);
  }
}
