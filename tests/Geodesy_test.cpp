// Places on the earth, rational polynomials and GeoTIFF (nw/scene/Geodesy.nw, nw/render/RationalCamera.nw, nw/files/GeoTIFF.nw).
#include "malus/scene/Geodesy.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "Scratch.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/GeoTIFF.hpp"
#include "malus/render/RationalCamera.hpp"

using namespace malus;

namespace {
const GeodeticPlace rochester{43.0845, -77.6749, 168};

// Exit code of a program in Debian's Python, which has GDAL.
int python(const std::string& program, const std::string& argument) {
  return std::system(("/usr/bin/python3 -c '" + program + "' '" + argument + "'").c_str());
}
}  // namespace

TEST(GeodesyInvariant, PlacesGoThereAndBack) {
  for (const double latitude : {-90.0, -45.3, 0.0, 12.5, 43.0845, 89.9999, 90.0})
    for (const double longitude : {-179.5, -77.7, 0.0, 120.25})
      for (const double height : {-400.0, 0.0, 8848.0, 7e5}) {
        const LocalFrame frame({latitude, longitude, height});
        for (const CDVector& p :
             {CDVector{0, 0, 0}, CDVector{1234.5, -987.6, 55.5}, CDVector{-4e4, 3e4, 2e4}}) {
          const GeodeticPlace place = frame.geodetic(p);
          // doubles hold 7e6 m to 1e-9 m; the latitude's sine loses some digits near a pole
          EXPECT_LT((frame.local(place) - p).getLength(), 1e-6) << latitude << ' ' << height;
        }
      }
}

// By hand in the chapter: the plane leaves the ellipsoid by d^2 / 2a, 8 cm at 1 km; a turns into the earth's radii of
// curvature, which differ from a by less than a hundredth.
TEST(GeodesyIdentity, APlaneLeavesTheEarth) {
  const LocalFrame frame(rochester);
  for (const double azimuth : {0.0, 1.0, 2.0}) {
    const GeodeticPlace far =
        frame.geodetic({1000 * std::sin(azimuth), 1000 * std::cos(azimuth), 0});
    EXPECT_NEAR(far.height_m - 168, 1e6 / (2 * 6378137), 1e-3);
  }
  const GeodeticPlace north = frame.geodetic({0, 100, 0}), east = frame.geodetic({100, 0, 0});
  EXPECT_GT(north.latitude_deg, rochester.latitude_deg);
  EXPECT_NEAR(north.longitude_deg, rochester.longitude_deg, 1e-12);
  EXPECT_GT(east.longitude_deg, rochester.longitude_deg);
}

// A metre of a plane at 168 m, by brute force: the ellipsoid's metres between the same latitudes and longitudes.
TEST(GeodesyIdentity, AMetreOfAPlaneIsLessOnTheMap) {
  const LocalFrame frame(rochester),
      below({rochester.latitude_deg, rochester.longitude_deg, 0});
  for (const CDVector& p : {CDVector{100, 0, 2}, CDVector{0, 100, 2}}) {
    GeodeticPlace place = frame.geodetic(p);
    place.height_m = 0;
    const CDVector on_map = below.local(place);
    const double metres = std::hypot(on_map.x, on_map.y);
    // the radii differ by 0.3 %, so that each is off by half of that from their mean
    EXPECT_NEAR(metres / 100, frame.mapScale(2), 0.0018 * 170 / 6.37e6);
    EXPECT_GT(std::abs(metres / 100 - 1), 20 * 0.0018 * 170 / 6.37e6) << "the negative control";
  }
}

// PROJ's geocentric coordinates, and its x and y in our projection, of points on the ellipsoid.
TEST(GeodesyPublished, ProjComputesTheSame) {
  const LocalFrame frame({rochester.latitude_deg, rochester.longitude_deg, 0});
  std::string points;
  for (const auto& [north, east] : {std::pair{0.01, 0.02}, {-0.005, 0.001}, {0.03, -0.02}}) {
    const GeodeticPlace place{rochester.latitude_deg + north, rochester.longitude_deg + east,
                              0};
    const CDVector p = frame.local(place);
    points += fmt::format("({:.12f}, {:.12f}, {:.9f}, {:.9f}),", place.longitude_deg,
                          place.latitude_deg, p.x, p.y);
  }
  const auto program = [&](double shift) {
    return fmt::format(R"(
import sys
from osgeo import osr
ours, world = osr.SpatialReference(), osr.SpatialReference()
assert ours.ImportFromWkt(sys.argv[1]) == 0
world.ImportFromEPSG(4326)
for s in (ours, world): s.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
change = osr.CoordinateTransformation(world, ours)
for longitude, latitude, x, y in [{}]:
    u, v, w = change.TransformPoint(longitude, latitude, 0)
    assert abs(u - x) < 1e-6 and abs(v - y - {}) < 1e-6, (u - x, v - y)
)",
                       points, shift);
  };
  EXPECT_EQ(python(program(0), projectionOf(rochester)), 0);
  EXPECT_NE(python(program(1e-3), projectionOf(rochester)), 0) << "the negative control";
}

namespace {
const SpectralGridPtr band = SpectralGrid::make({550});
SensorGeometry camera(double focal_px) {
  SensorGeometry g;
  g.width = 120, g.height = 80, g.focal_length_px = focal_px;
  g.principal_x = 60, g.principal_y = 40;
  return g;
}
}  // namespace

// Cameras 3 km above the ground, of 40 degrees: none may be off by a hundredth of a pixel, which no control point is known to.
TEST(RationalCameraInvariant, CamerasAreFittedToAHundredthOfAPixel) {
  constexpr double tolerance_px = 0.01;
  const LocalFrame earth(rochester);
  SensorGeometry lens = camera(160), line = camera(160);
  lens.distortion = {-0.05, 0.01, 0, 0.0005, -0.0003};
  line.kind = SensorKind::pushbroom, line.row_time_s = 0.1;
  const Platform down = Platform::fixed(Pose::looking({100, 50, 3000}, {0, 0, -1}, {0, 1, 0}));
  const Platform aslant =
      Platform::fixed(Pose::looking({-1000, 50, 3000}, {0.5, 0.2, -1}, {0, 0, 1}, 0.3));
  const Platform flight = Platform::straight(
      Pose::looking({0, 0, 3000}, {0.2, 0, -1}, {0, 1, 0}), {0, 187, 0}, 1, 0);
  for (const auto& [name, geometry, platform] : {std::tuple{"down", camera(160), down},
                                                 {"aslant", camera(160), aslant},
                                                 {"lens", lens, aslant},
                                                 {"pushbroom", line, flight}}) {
    const Sensor sensor(geometry, band, band);
    const auto fit = fitRational(sensor, platform, 0, earth, -10, 120);
    ASSERT_TRUE(fit) << name;
    EXPECT_LT(fit->worst_px, tolerance_px) << name;
    EXPECT_LE(fit->rms_px, fit->worst_px);
    RecordProperty(name, fmt::format("{:.3g}", fit->worst_px));
    // a separate point, by the camera alone
    const auto ray = sensor.rayAt(33.3, 61.7, platform, 0);
    const CDVector p = ray.origin + ray.direction * ((47.0 - ray.origin.z) / ray.direction.z);
    const auto [x, y] = fit->pixel(earth.geodetic(p));
    EXPECT_NEAR(x, 33.3, tolerance_px) << name;
    EXPECT_NEAR(y, 61.7, tolerance_px) << name;
    const auto [u, v] = fit->pixel(earth.geodetic(p + CDVector{30, 30, 0}));
    EXPECT_GT(std::hypot(u - 33.3, v - 61.7), 0.5) << "the negative control: 30 m aside";
    ASSERT_EQ(fit->coefficients().size(), 92u);
    EXPECT_EQ(fit->coefficients(5, 7)[2], fit->coefficients()[2] - 7);
    EXPECT_EQ(fit->coefficients(5, 7)[3], fit->coefficients()[3] - 5);
  }
  const Platform level = Platform::fixed(Pose::looking({0, 0, 3000}, {1, 0, -0.1}, {0, 0, 1}));
  EXPECT_FALSE(fitRational(Sensor(camera(160), band, band), level, 0, earth, 0, 100))
      << "it sees the horizon";
  EXPECT_FALSE(fitRational(Sensor(camera(160), band, band), down, 0, earth, 0, 4000))
      << "it stands below the highest point";
}

namespace {
GeoTIFF sample(bool doubles, std::size_t width = 5, std::size_t height = 4) {
  GeoTIFF picture{width, height, {"S0 450", "a<b & c"}, false, doubles, "two & more", {}, {}};
  picture.row = [width](std::size_t y, std::span<double> row) {
    for (std::size_t x = 0; x < width; ++x)
      row[2 * x] = double(x) + 10 * double(y), row[2 * x + 1] = -0.1 * double(x);
    if (y == 1) row[0] = std::numeric_limits<double>::quiet_NaN();
  };
  return picture;
}
}  // namespace

TEST(GeoTIFFPublished, GdalReadsWhatWasWritten) {
  const Scratch scratch;
  for (const auto& [doubles, big] : {std::pair{false, false}, {true, false}, {true, true}}) {
    GeoTIFF picture = sample(doubles);
    picture.big = big;
    picture.place.transform = {100, 0.5, 0.25, 200, 0.25, -0.5};
    picture.place.origin = rochester;
    for (int i = 0; i < 92; ++i) picture.place.rational.push_back(i + 0.5);
    writeGeoTIFF(picture, scratch / "a.tif");
    const std::string program =
        fmt::format(R"(
import sys, math
from osgeo import gdal, osr
d = gdal.Open(sys.argv[1])
assert (d.RasterXSize, d.RasterYSize, d.RasterCount) == (5, 4, 2)
b = d.GetRasterBand(2)
assert b.GetDescription() == "a<b & c", b.GetDescription()
assert gdal.GetDataTypeName(b.DataType) == "{}"
assert abs(b.ReadAsArray()[2][3] + 0.3) < {}
a = d.GetRasterBand(1).ReadAsArray()
assert a[3][4] == 34 and math.isnan(a[1][0]) and math.isnan(b.GetNoDataValue())
assert d.GetGeoTransform() == (100, 0.5, 0.25, 200, 0.25, -0.5), d.GetGeoTransform()
s = d.GetSpatialRef()
assert s.GetAttrValue("PROJECTION") == "Orthographic", s.ExportToWkt()
assert s.GetProjParm("latitude_of_origin") == 43.0845
assert s.GetProjParm("central_meridian") == -77.6749
assert s.GetAttrValue("DATUM") == "WGS_1984" and s.GetLinearUnits() == 1
r = d.GetMetadata("RPC")
assert float(r["LINE_OFF"]) == 2.5 and float(r["HEIGHT_SCALE"]) == 11.5, r
assert [float(c) for c in r["SAMP_DEN_COEFF"].split()] == [72.5 + i for i in range(20)]
)",
                    doubles ? "Float64" : "Float32", doubles ? "1e-15" : "1e-7");
    EXPECT_EQ(python(program, (scratch / "a.tif").string()), 0);
    EXPECT_EQ(contents(scratch / "a.tif")[2], big ? 43 : 42);
  }
  GeoTIFF one = sample(true);
  one.channels.clear();
  EXPECT_THROW(writeGeoTIFF(one, scratch / "b.tif"), MathError);
}

TEST(GeoTIFFInvariant, AFileThatCannotBeWrittenIsToldAndLeavesNothing) {
  const Scratch scratch;
  put(scratch / "file", "x");
  EXPECT_THROW(writeGeoTIFF(sample(false), scratch / "file/a.tif"), InputError);
  GeoTIFF fails = sample(false);
  fails.row = [](std::size_t y, std::span<double>) {
    if (y == 2) throw MathError("half way");
  };
  EXPECT_THROW(writeGeoTIFF(fails, scratch / "half.tif"), InputError);
  EXPECT_FALSE(std::filesystem::exists(scratch / "half.tif"));
}
