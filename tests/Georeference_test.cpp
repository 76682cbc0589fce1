// Pictures on the map, and sensors as they are, through the program (nw/app/RenderGround.nw, nw/files/SceneCamera.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "Program.hpp"
#include "malus/files/Cube.hpp"

using namespace malus;
using nlohmann::json;

namespace {
json sceneAboveRochester() {
  return json::parse(R"({
    "malus": 1, "bands": {"wavelength_nm": [550]},
    "georeference": {"latitude_deg": 43.0845, "longitude_deg": -77.6749, "height_m": 168},
    "geometry": [{"ground": {"z_m": 2, "material": "paint"}}],
    "materials": {"paint": {"model": "lambertian", "reflectance": 0.3}},
    "sky": {"model": "uniform", "radiance_W_m2_sr_nm": 0.05},
    "sensor": {"kind": "framing", "width": 30, "height": 20, "field_of_view_deg": 40},
    "platform": {"position_m": [100, 50, 502], "look": [0, 0, -1], "up": [1, 2, 0]},
    "radiometry": {"sampling": "importance", "rays": [2], "seed": 1}
  })");
}

struct Workplace {
  Scratch scratch;
  explicit Workplace(const json& scene) { put(scratch / "s.json", scene.dump(1)); }
  Outcome render(const std::string& more = "") const {
    return malusIn(scratch.path, "render s.json --out a --threads 1 " + more);
  }
  json record(const std::string& stem = "s") const {
    return json::parse(contents(scratch / ("a/" + stem + ".run.json")));
  }
  int python(const std::string& program) const {
    return std::system(
        ("cd '" + (scratch / "a").string() + "' && /usr/bin/python3 -c '" + program + "'")
            .c_str());
  }
};

void expectRefusal(const json& scene, const std::string& fragment) {
  const Workplace place(scene);
  const Outcome outcome = place.render();
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find(fragment), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(place.scratch / "a"));
}

json with(const std::string& pointer, const json& value) {
  json scene = sceneAboveRochester();
  scene[json::json_pointer(pointer)] = value;
  return scene;
}
}  // namespace

// GDAL takes the middles of the pixels by transform and projection to where the table has them: a hundredth of a millimetre is
// 1e-10 degrees; the two radii of curvature make ten of them. The table's points must be on the ground, one lattice step apart.
TEST(GeoreferenceIdentity, GdalPutsAMapWhereTheTableHasIt) {
  const Workplace place(sceneAboveRochester());
  for (const char* part : {"", " --part 5,3,20,11"}) {
    const std::string stem = *part ? "s.5-3-20-11" : "s";
    ASSERT_EQ(place.render(std::string("--write cube,truth,geotiff,ground") + part).code, 0);
    for (const char* picture : {".tif", ".img"})
      EXPECT_EQ(place.python(fmt::format(R"(
from osgeo import gdal, osr
picture, table = gdal.Open("{0}{1}"), gdal.Open("{0}.ground.tif")
x, y, z, latitude, longitude, height = table.ReadAsArray()
t = picture.GetGeoTransform()
ours, world = osr.SpatialReference(picture.GetProjection()), osr.SpatialReference()
world.ImportFromEPSG(4326)
for s in (ours, world): s.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
change = osr.CoordinateTransformation(ours, world)
assert x.shape == (picture.RasterYSize, picture.RasterXSize)
for j in range(x.shape[0]):
    for i in range(x.shape[1]):
        u = t[0] + t[1] * (i + 0.5) + t[2] * (j + 0.5)
        v = t[3] + t[4] * (i + 0.5) + t[5] * (j + 0.5)
        k = 1 - 170 / 6.378e6
        assert abs(u - k * x[j][i]) < 1e-4 and abs(v - k * y[j][i]) < 1e-4
        assert abs(z[j][i] - 2) < 1e-9
        place = change.TransformPoint(u, v, 0)
        assert abs(place[0] - longitude[j][i]) < 1e-9 and abs(place[1] - latitude[j][i]) < 1e-9
        assert abs(height[j][i] - 170 - (u * u + v * v) / 2 / 6.378e6) < 1e-3
assert abs(x[0][1] - x[0][0]) > 1, "negative control: a pixel is more than a metre"
)",
                                         stem, picture)),
                0)
          << stem << picture;
  }
}

// From an oblique view and through a lens there is no map, and GDAL takes latitude, longitude
// and height back to the pixel.
TEST(GeoreferenceIdentity, GdalFindsThePixelsOfALensByTheirPolynomials) {
  json scene = with("/platform", {{"position_m", {-300, 50, 502}}, {"look", {0.5, 0.1, -1}}});
  scene["sensor"]["distortion"] = {{"k1", -0.1}, {"k2", 0.02}, {"p1", 0.001}};
  scene["geometry"].push_back(
      {{"obj", "t.obj"}, {"material", "paint"}, {"translate_m", {0, 0, 3}}});
  const Workplace place(scene);
  put(place.scratch / "t.obj",
      "g one\nusemtl paint\nv -90 -90 30\nv 90 -90 0\nv 0 90 30\nf 1 2 3\n");
  for (const char* part : {"", " --part 5,3,20,11"}) {
    const std::string stem = *part ? "s.5-3-20-11" : "s";
    ASSERT_EQ(place.render(std::string("--write cube,truth,geotiff,ground") + part).code, 0);
    EXPECT_EQ(readCube(place.scratch / ("a/" + stem + ".img")).header.map_info, "");
    const json said = place.record(stem).at("georeference");
    EXPECT_FALSE(said.contains("transform"));
    const double worst = said.at("rational").at("worst_px"), rms = said["rational"]["rms_px"];
    EXPECT_LT(worst, 0.01) << "no control point is known to less";
    EXPECT_LE(rms, worst);
    EXPECT_EQ(place.python(fmt::format(R"(
from osgeo import gdal
picture, table = gdal.Open("{0}.tif"), gdal.Open("{0}.ground.tif")
x, y, z, latitude, longitude, height = table.ReadAsArray()
back = gdal.Transformer(picture, None, ["METHOD=RPC", "RPC_HEIGHT=0"])
assert z.max() > 10 and abs(z.min() - 2) < 1e-9
for j in range(x.shape[0]):
    for i in range(x.shape[1]):
        ok, at = back.TransformPoint(True, longitude[j][i], latitude[j][i], height[j][i])
        off = max(abs(at[0] - i - 0.5), abs(at[1] - j - 0.5))
        assert ok and off < 2 * {1} + 1e-4, (i, j, at)
ok, at = back.TransformPoint(True, longitude[0][0], latitude[0][0], height[0][0] + 50)
assert max(abs(at[0] - 0.5), abs(at[1] - 0.5)) > 0.5, "negative control: 50 m too high"
)",
                                       stem, worst)),
              0)
        << stem;
  }
}

// Parts that were distributed to two machines merge into the GeoTIFF and the header that one
// machine makes, to the bit.
TEST(GeoreferenceInvariant, MergedPartsLieWhereTheWholeLies) {
  const Workplace whole(sceneAboveRochester()), parts(sceneAboveRochester());
  ASSERT_EQ(whole.render("--write cube,truth,geotiff").code, 0);
  for (const char* part : {"1/2", "2/2"})
    ASSERT_EQ(parts.render(std::string("--write cube,truth,geotiff --part ") + part).code, 0);
  const Outcome merged = malusIn(parts.scratch.path, "merge a");
  ASSERT_EQ(merged.code, 0) << merged.err;
  for (const char* file : {"a/s.tif", "a/s.img", "a/s.img.hdr"}) {
    const std::string one = contents(whole.scratch / file);
    EXPECT_GT(one.size(), 500u);
    EXPECT_TRUE(one == contents(parts.scratch / file)) << file;
  }
  EXPECT_NE(contents(whole.scratch / "a/s.img.hdr").find("coordinate system string = {PROJCS"),
            std::string::npos);
}

TEST(GeoreferenceIdentity, WithoutAPlaceOnTheEarthThereAreMetres) {
  json scene = sceneAboveRochester();
  scene.erase("georeference");
  scene["platform"] = {{"position_m", {0, 0, 10}}, {"look", {0, 1, 0}}};
  const Workplace place(scene);
  ASSERT_EQ(place.render("--write ground").code, 0);
  EXPECT_FALSE(place.record().contains("georeference"));
  EXPECT_EQ(place.python(R"(
from osgeo import gdal
import numpy
x, y, z = gdal.Open("s.ground.tif").ReadAsArray()
assert numpy.isnan(z[:10]).all() and (abs(z[10:] - 2) < 1e-9).all(), "the sky is not a number"
)"),
            0);
}

TEST(GeoreferenceIdentity, PlacesThatCannotBeAreRefused) {
  expectRefusal(with("/georeference/latitude_deg", 91), "georeference.latitude_deg = 91");
  json lacks = sceneAboveRochester();
  lacks["georeference"].erase("longitude_deg");
  expectRefusal(lacks, "longitude_deg");
  const Workplace place(sceneAboveRochester());
  const Outcome dealt = place.render("--part 1/2 --write cube,truth,ground");
  EXPECT_EQ(dealt.code, 2);
  EXPECT_NE(dealt.err.find("lists ground, which equal parts do not have"), std::string::npos);
}

// The sensor of a scene: what it says, and what it refuses.
TEST(SensorsInScenesIdentity, BadSensorsAreRefusedAtTheirPlace) {
  expectRefusal(with("/sensor/distortion", {{"k1", -3}}), "sensor.distortion");
  expectRefusal(with("/sensor/distortion", {{"k1", -3}}), "folds the picture at ");
  expectRefusal(with("/sensor/distortion", {{"k4", 1}}), "k4");
  expectRefusal(with("/sensor/detector_size_px", {0, 1}), "sensor.detector_size_px[0] = 0 px");
  expectRefusal(with("/sensor/point_spread", {{"kind", "gaussian"}}), "lacks fwhm_px");
  expectRefusal(with("/sensor/point_spread", {{"kind", "gaussian"}, {"step_px", 1}}),
                "does not belong to a point spread of the kind \"gaussian\"");
  expectRefusal(with("/sensor/point_spread",
                     {{"kind", "table"}, {"step_px", 1}, {"values", {{1, 2}, {3}}}}),
                "has rows of different lengths");
  expectRefusal(
      with("/sensor/point_spread", {{"kind", "table"}, {"step_px", 1}, {"values", {{0, 0}}}}),
      "has no light");
  expectRefusal(with("/sensor/exposure_time_s", 0), "sensor.exposure_time_s = 0 s");
  json scanner = sceneAboveRochester();
  scanner["sensor"]["kind"] = "line-scanner", scanner["sensor"]["row_time_s"] = 0.1;
  scanner["platform"] = {{"path", "straight"},
                         {"start_m", {0, 0, 500}},
                         {"look", {0, 0, -1}},
                         {"velocity_m_s", {0, 100, 0}}};
  EXPECT_EQ(Workplace(scanner).render().code, 0) << "the negative control";
  json late = scanner;
  late["sensor"]["exposure_time_s"] = 0.2;
  expectRefusal(late, "is longer than the 0.1 s until the detector is needed again");
  json bent = scanner;
  bent["sensor"]["distortion"] = {{"k1", 0.01}};
  expectRefusal(bent, "a line scanner has one detector");
  json listed = with("/sensor/exposure_time_s", 0.1);
  const json pose{{"position_m", {0, 0, 500}}, {"look", {0, 0, -1}}};
  listed["platform"] = {{"poses", {pose, pose}}};
  listed["platform"]["poses"][1]["time_s"] = 1;
  expectRefusal(listed, "do not specify how the camera moves during the last exposure_time_s");
  json staring = sceneAboveRochester();
  staring["platform"] = {{"path", "staring"},     {"start_m", {0, 0, 500}},
                         {"target_m", {0, 9, 0}}, {"velocity_m_s", {1, 0, 0}},
                         {"up", {0, 1, 0}},       {"rotation_deg_s", {0, 0, 1}}};
  expectRefusal(staring, "rotation_deg_s");
}

TEST(SensorsInScenesIdentity, TheRecordSaysWhatTheSensorIs) {
  json scene = sceneAboveRochester();
  scene["sensor"]["distortion"] = {{"k1", -0.1}};
  scene["sensor"]["detector_size_px"] = {0.8, 0.5};
  scene["sensor"]["point_spread"] = {
      {"kind", "airy"}, {"aperture_mm", 0.05}, {"wavelength_nm", 900}};
  scene["sensor"]["exposure_time_s"] = 0.02;
  scene["platform"] = {{"path", "straight"},
                       {"start_m", {0, 0, 500}},
                       {"look", {0, 0, -1}},
                       {"velocity_m_s", {50, 0, 0}},
                       {"rotation_deg_s", {0, 0, 90}}};
  const Workplace place(scene);
  const Outcome dry = place.render("--dry-run");
  EXPECT_NE(
      dry.out.find("optics    lens with k1 -0.1, k2 0, k3 0, p1 0, p2 0; airy, cutoff "
                   "1.34804 cycles per px; detectors of 0.8 x 0.5 px; exposed for 0.02 s\n"
                   "earth     origin at 43.084500 deg north, -77.674900 deg east, 168 m\n"),
      std::string::npos)
      << dry.out;
  const Outcome outcome = place.render();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(
      outcome.err.find("all bands are blurred as 900 nm is; at 550 nm diffraction is 0.61 "
                       "times as wide"),
      std::string::npos)
      << outcome.err;
  const json record = place.record(), camera = record["camera"];
  EXPECT_EQ(camera["distortion"]["k1"], -0.1);
  EXPECT_EQ(camera["detector_size_px"], (json{0.8, 0.5}));
  EXPECT_EQ(camera["exposure_time_s"], 0.02);
  // D / (lambda f) = 5e-5 / (9e-7 * 15 / tan 20 deg)
  EXPECT_EQ(camera["point_spread"], "airy, cutoff 1.34804 cycles per px");
  EXPECT_NEAR(record["pose"]["position_m"][0].get<double>(), 0.5, 1e-12) << "middle of it";
  EXPECT_NEAR(record["pose"]["up"][0].get<double>(), -std::sin(0.9 * 3.14159265358979 / 180),
              1e-12);
  EXPECT_TRUE(record["conventions"].contains("distortion"));
}

// Bad pixels from a list and from a file; a converter that saturates. The record counts, and the cubes have no number there.
TEST(SensorsInScenesIdentity, BadPixelsAndCountsAreToldInTheRecord) {
  json scene = sceneAboveRochester();
  scene["sensor"]["polarimeter"] = {
      {"cameras", {{{"name", "P0"}, {"polarizer_deg", 0}}, {{"name", "open"}}}},
      {"recover", {"S0", "S1"}},
      {"noise",
       {{"electrons_per_unit", 1e6},
        {"dark_electrons", 30},
        {"converter", {{"bits", 10}, {"electrons_per_count", 10}}}}},
      {"bad_pixels", {{3, 4}, {29, 19}, {3, 4}}}};
  json filed = scene;
  filed["sensor"]["polarimeter"]["bad_pixels"] = "bad.csv";
  for (const json& one : {scene, filed}) {
    const Workplace place(one);
    put(place.scratch / "bad.csv", "x,y\n29,19\n3,4\n");
    const Outcome outcome = place.render();
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json said = place.record()["polarimeter"];
    EXPECT_EQ(said["bad_pixels"], 2);
    EXPECT_EQ(said["flagged_readings"], 4) << "two pixels of two cameras";
    EXPECT_EQ(said["noise"]["dark_electrons"], 30);
    EXPECT_EQ(said["noise"]["converter"]["bits"], 10);
    // light of 0.3 * 0.05: 7500 and 15000 electrons; 1023 counts are 10230
    EXPECT_EQ(said["saturated_readings"], 30 * 20 - 2);
    EXPECT_EQ(said["readings_below_zero"], 0);
    const Cube readings = readCube(place.scratch / "a/s.readings.img"),
               back = readCube(place.scratch / "a/s.recovered.img");
    int flagged = 0, lost = 0;
    for (const float number : readings.data) flagged += std::isnan(number);
    for (const float number : back.data) lost += std::isnan(number);
    EXPECT_EQ(flagged, 4);
    EXPECT_EQ(lost, 4);
    EXPECT_TRUE(std::isnan(readings.at(3, 4, 0)) && std::isnan(readings.at(29, 19, 1)));
    EXPECT_EQ(back.header.ignore_value, "nan");
  }
  scene["sensor"]["polarimeter"]["bad_pixels"] = {{30, 4}};
  expectRefusal(scene, "bad_pixels[0]");
  scene["sensor"]["polarimeter"]["bad_pixels"] = {{1.5, 4}};
  expectRefusal(scene, "is not a pixel of the picture; give x from 0 to 29 and y from 0 to 19");
  scene["sensor"]["polarimeter"]["bad_pixels"] = json::array();
  scene["sensor"]["polarimeter"]["noise"]["converter"]["bits"] = 40;
  expectRefusal(scene, "converter.bits = 40");
}
