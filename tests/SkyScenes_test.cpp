// Skies in scenes, from the JSON text to the picture: a mirror reads the sky back, a turned world looks the same, the
// record says what was known of the polarisation (nw/files/SceneReader.nw, nw/air/RayleighSky.nw, nw/air/Sky.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "Program.hpp"
#include "malus/air/RayleighSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Table.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using nlohmann::json;

namespace {
// A level mirror (a metal that reflects 1 - 4e-8, with facets tilted by half a hundredth), seen by one pixel from
// `view_deg` off the vertical, at the compass azimuth `azimuth_deg`.
json mirrorScene(double view_deg, double azimuth_deg, const json& sky) {
  const CDVector to_camera = compassDirection(view_deg * degree, azimuth_deg * degree);
  const CDVector at = to_camera * 100.0;
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {450, 650}}}},
      {"geometry", {{{"ground", {{"z_m", 0}, {"material", "mirror"}}}}}},
      {"materials",
       {{"mirror", {{"model", "torrance-sparrow"}, {"n", 1}, {"k", 10000}, {"sigma", 0.005}}}}},
      {"sun", {{"zenith_deg", 50}, {"azimuth_deg", 120}, {"irradiance_W_m2_nm", 1}}},
      {"sky", sky},
      {"sensor",
       {{"kind", "framing"}, {"width", 1}, {"height", 1}, {"field_of_view_deg", 0.01}}},
      {"platform",
       {{"path", "fixed"},
        {"position_m", {at.x, at.y, at.z}},
        {"look_at_m", {0, 0, 0}},
        {"up", {0, 0, 1}}}},
      {"radiometry", {{"sampling", "importance"}, {"rays", {4096}}, {"seed", 3}}}};
}
const json rayleigh{{"model", "rayleigh"}, {"albedo", 0.2}};

CDStokesVector pixel(const json& scene, std::size_t band,
                     const std::filesystem::path& at = ".") {
  const RenderedImage frame = renderScene(readSceneText(scene.dump(), "mirror.json", at));
  const double* s = frame.at(0, 0, band);
  return {s[0], s[1], s[2], s[3]};
}
double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a.getStokes(k) - b.getStokes(k)));
  return most / b.getScalar();
}
// What a perfect mirror makes of it: the field across the plane of incidence turns round, the one in it does not.
CDStokesVector mirrored(const CDStokesVector& s) {
  return {s.getStokes(0), s.getStokes(1), -s.getStokes(2), -s.getStokes(3)};
}
// The exact sky where the mirror looks, without table, scene or renderer.
CDStokesVector exact(double view_deg, double azimuth_deg, double nm,
                     double sun_azimuth_deg = 120) {
  const RayleighLight light(
      RayleighAtmosphere(rayleighOpticalDepth(nm), rayleighDepolarization(nm)),
      std::cos(50 * degree), 0.2, 1);
  // the mirrored direction has the opposite azimuth
  return light.down(
      std::cos(view_deg * degree),
      RayleighLight::Azimuth::fromRadians((azimuth_deg + 180 - sun_azimuth_deg) * degree));
}
}  // namespace

// 4096 directions, some drawn for the sky and not for the lobe, whose weights scatter by a few parts in a thousand;
// the lobe is a hundredth wide, over a sky that changes by its own size in a radian.
TEST(SkyScenesInvariant, AMirrorReadsTheSkyBack) {
  int with_u = 0;
  for (const double azimuth : {0.0, 35.0, 80.0, 150.0, 200.0, 260.0, 340.0})
    for (const double view : {30.0, 55.0}) {
      const json scene = mirrorScene(view, azimuth, rayleigh);
      const double nm[]{450, 650};
      for (const std::size_t band : {0u, 1u}) {
        const CDStokesVector ours = pixel(scene, band),
                             theirs = mirrored(exact(view, azimuth, nm[band]));
        EXPECT_LT(apart(ours, theirs), 3e-3) << azimuth << ' ' << view << ' ' << nm[band];
        const bool u = std::abs(theirs.getStokes(2)) > 0.05 * theirs.getScalar();
        with_u += u;
        if (u) {
          EXPECT_GT(apart(ours, mirrored(theirs)), 0.05);  // control: the other sign of U
        }
        EXPECT_GT(apart(ours, mirrored(exact(view, azimuth + 5, nm[band]))),
                  3e-3);  // control: 5 degrees beside
      }
    }
  EXPECT_GT(with_u, 15);
}

TEST(SkyScenesInvariant, SunCameraAndWorldTurnTogether) {
  const CDStokesVector still = pixel(mirrorScene(40, 20, rayleigh), 0);
  for (const double turn : {70.0, 163.0}) {
    json scene = mirrorScene(40, 20 + turn, rayleigh);
    EXPECT_GT(apart(pixel(scene, 0), still), 0.02);  // control: the camera alone
    scene["sun"]["azimuth_deg"] = 120 + turn;
    EXPECT_LT(apart(pixel(scene, 0), still), 3e-3) << turn;
  }
}

// A dome with aerosol goes through a file into a scene. The table has steps of 2 degrees: h^2/8 of four times S0.
TEST(SkyScenesInvariant, ADomeWithAerosolIsASkyOfAScene) {
  const Scratch scratch;
  const std::string air =
      "sky --wavelength-nm 500 --mu0 0.6 --albedo 0.2 --irradiance 1 --aerosol '" +
      (std::filesystem::path(MALUS_SOURCE_DATA).parent_path() /
       "scenes/data/aerosol-spheroids.csv")
          .string() +
      "' --aerosol-tau 0.1 --aerosol-place below ";
  ASSERT_EQ(malusIn(scratch.path, air + "--dome-step-deg 2 --out sky.csv").code, 0);
  json scene =
      mirrorScene(40, 60, {{"model", "table"}, {"file", "sky.csv"}, {"polarization", "full"}});
  scene["bands"]["wavelength_nm"] = {500};
  scene.erase("sun");
  const CDStokesVector seen = pixel(scene, 0, scratch.path);
  std::istringstream answer(
      malusIn(scratch.path, air + "--mu 0.766044443118978 --phi-deg 240").out);
  const Table one = Table::parse(answer, "answer");
  const CDStokesVector light(one.number(0, "I"), one.number(0, "Q"), one.number(0, "U"),
                             one.number(0, "V"));
  EXPECT_GT(std::abs(light.getStokes(3)), 0);
  EXPECT_LT(apart(seen, mirrored(light)), 3e-3);
  EXPECT_GT(apart(seen, light), 0.02);
}

// The scene of figures 7.37 and 7.38 as it is shipped, small: polarised light at both wavelengths, S3 included.
TEST(SkyScenesInvariant, TheShippedSceneUnderThePolarisedSky) {
  const Scratch scratch;
  const std::string scene =
      (std::filesystem::path(MALUS_SOURCE_DATA).parent_path() / "scenes/chunky-bar-sky.json")
          .string();
  const RenderedImage frame = renderScene(readScene(
      scene,
      R"({"sensor": {"width": 16, "height": 16, "focal_length_mm": 15, "pixel_pitch_um": 625}, "radiometry": {"rays": [46, 1]}})"));
  double linear[2]{}, circular[2]{};
  for (std::size_t y = 0; y < frame.height; ++y)
    for (std::size_t x = 0; x < frame.width; ++x)
      for (const std::size_t band : {0u, 1u}) {
        const double* s = frame.at(x, y, band);
        linear[band] = std::max(linear[band], std::hypot(s[1], s[2]) / s[0]);
        circular[band] = std::max(circular[band], std::abs(s[3]) / s[0]);
      }
  for (const std::size_t band : {0u, 1u}) {
    EXPECT_GT(linear[band], 0.01);
    EXPECT_LT(linear[band], 1);
    EXPECT_GT(circular[band], 1e-5);
    EXPECT_LT(circular[band], linear[band]);
  }
  EXPECT_GT(linear[0],
            linear[1]);  // blue skies are brighter, and copper is a poorer metal there
}

// Section 2.1: what is known is used, and the record says what was.
TEST(SkyScenesInvariant, TheRecordSaysHowTheSkyIsPolarised) {
  const Scratch scratch;
  std::string table = "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2,S3\n";
  for (const char* zenith : {"0", "90"})
    for (const char* azimuth : {"0", "180"}) {
      table += fmt::format("{},{},450,0.1,0.02,0.03,0\n", zenith, azimuth);
      table += fmt::format("{},{},650,0.1,,,\n", zenith, azimuth);
    }
  put(scratch / "partly.csv", table);
  const auto record = [&](json sky) {
    json scene = mirrorScene(40, 60, sky);
    put(scratch / "s.json", scene.dump());
    const Outcome outcome = malusIn(scratch.path, "render s.json --out o");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    json info = json::parse(contents(scratch / "o/s.run.json"));
    std::filesystem::remove_all(scratch / "o");
    return info["sky_polarization"];
  };
  EXPECT_EQ(record(rayleigh)["used"], "full");
  EXPECT_EQ(record({{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0.1}})["used"], "none");
  const json partly = record({{"model", "table"}, {"file", "partly.csv"}});
  EXPECT_EQ(partly["used"], "partly");
  EXPECT_EQ(partly["wavelengths_nm"], json::array({450.0}));
  json without = rayleigh;
  without["polarization"] = "none";
  EXPECT_EQ(record(without)["used"], "none");
  // the same light without its polarisation: only S0, and all of it
  const CDStokesVector plain = pixel(mirrorScene(40, 20, without), 0),
                       full = pixel(mirrorScene(40, 20, rayleigh), 0);
  EXPECT_NEAR(plain.getScalar() / full.getScalar(), 1, 1e-3);
  EXPECT_LT(plain.getDOLP(), 1e-3);
  EXPECT_GT(full.getDOLP(), 0.05);
  // a scene that states more polarisation than its sky has
  json scene = mirrorScene(
      40, 60, {{"model", "table"}, {"file", "partly.csv"}, {"polarization", "full"}});
  put(scratch / "s.json", scene.dump());
  const Outcome refused = malusIn(scratch.path, "render s.json --out o");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("partly"), std::string::npos) << refused.err;
}
