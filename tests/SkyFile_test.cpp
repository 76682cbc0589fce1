// malus sky with the sky of a scene or of a file (nw/files/SkyFile.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Program.hpp"
#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Table.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const json layered{{"model", "rayleigh"},
                   {"albedo", 0.1},
                   {"layers", {{{"particles", "waso.csv"}, {"tau", 0.2}}}}};
json sceneUnder(const json& sky) {
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {550}}}},
      {"geometry", {{{"ground", {{"material", "plate"}}}}}},
      {"materials", {{"plate", {{"model", "lambertian"}, {"reflectance", 0.3}}}}},
      {"sun", {{"zenith_deg", 60}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 10}}, {"look_at_m", {0, 0, 0}}}}};
}
const std::string asked = " --wavelength-nm 550 --mu0 0.5 --mu 0.5 --phi-deg 40 --irradiance 1";
CDStokesVector answered(const Scratch& scratch, const std::string& flags) {
  const Outcome outcome = malusIn(scratch.path, "sky " + flags + asked);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream text(outcome.out);
  const Table answer = Table::parse(text, "answer");
  return {answer.number(0, "I"), answer.number(0, "Q"), answer.number(0, "U"),
          answer.number(0, "V")};
}
double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a.getStokes(k) - b.getStokes(k)));
  return most / b.getScalar();
}
}  // namespace

// An aerosol is a layer (AerosolModels_test), so one sky can be said by flags, alone in a file, and in a scene.
TEST(SkyFileIdentity, FlagsAFileAndASceneSayTheSame) {
  const Scratch scratch;
  put(scratch / "waso.csv",
      "number_cm3,n,k,effective_radius_um,effective_variance\n1,1.44,0,0.2,0.07\n");
  put(scratch / "sky.json", layered.dump());
  put(scratch / "scene.json", sceneUnder(layered).dump());
  const CDStokesVector flags =
      answered(scratch, "--aerosol waso.csv --aerosol-tau 0.2 --albedo 0.1");
  EXPECT_LT(apart(answered(scratch, "--sky sky.json"), flags), 1e-9);
  EXPECT_LT(apart(answered(scratch, "--sky scene.json"), flags), 1e-9);
  const Scene scene = readScene(scratch / "scene.json");
  CDSpectralVector<CDStokesVector> light(scene.world.grid);
  scene.world.sky->radiance(compassDirection(60 * degree, 40 * degree), light);
  EXPECT_LT(apart(light[0], flags), 1e-6);
  json other = layered;
  other["layers"][0]["tau"] = 0.3;
  put(scratch / "other.json", other.dump());
  EXPECT_GT(apart(answered(scratch, "--sky other.json"), flags), 0.01) << "negative control";
}

TEST(SkyFileIdentity, TheGroundIsTheScenes) {
  const Scratch scratch;
  json sky{{"model", "rayleigh"}};
  put(scratch / "scene.json", sceneUnder(sky).dump());
  put(scratch / "sky.json", sky.dump());
  EXPECT_LT(apart(answered(scratch, "--sky scene.json"), answered(scratch, "--albedo 0.3")),
            1e-9);
  EXPECT_LT(apart(answered(scratch, "--sky sky.json"), answered(scratch, "--albedo 0")), 1e-12);
  sky["ground"] = "plate";
  put(scratch / "named.json", sceneUnder(sky).dump());
  EXPECT_LT(apart(answered(scratch, "--sky named.json"), answered(scratch, "--albedo 0.3")),
            1e-5);
}

TEST(SkyFileIdentity, WhatIsWrongIsSaid) {
  const Scratch scratch;
  put(scratch / "waso.csv",
      "number_cm3,n,k,effective_radius_um,effective_variance\n1,1.44,0,0.2,0.07\n");
  put(scratch / "sky.json", layered.dump());
  put(scratch / "none.json", "{\"moddel\": 1}");
  put(scratch / "wrong.json", "{\"model\": \"rayleigh\",\n \"albedoo\": 0.1}");
  json dark = sceneUnder(layered);
  dark.erase("sky");
  put(scratch / "dark.json", dark.dump());
  const auto refused = [&](const std::string& flags, const std::string& part) {
    const Outcome outcome = malusIn(scratch.path, "sky " + flags + asked);
    EXPECT_EQ(outcome.code, 2) << flags;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  refused("--sky sky.json --albedo 0.1", "--albedo = 0.1: conflicts with --sky");
  refused("--sky sky.json --model uniform", "--model = uniform: conflicts with --sky");
  refused("--sky none.json", "is neither a scene nor a sky");
  refused("--sky dark.json", "has no sky");
  refused("--sky absent.json", "absent.json");
  refused("--sky wrong.json", "wrong.json:2:");
}
