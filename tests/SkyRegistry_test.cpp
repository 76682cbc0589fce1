// Skies by name (nw/air/SkyRegistry.nw): what a scene can say, malus sky can compute, and the other way round.
#include "malus/air/SkyRegistry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Program.hpp"
#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Table.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/files/SceneSchema.hpp"

using namespace malus;
using nlohmann::json;

namespace {
// A camera over a plate, under this sky, with the sun in the north.
json sceneUnder(const json& sky) {
  return {
      {"malus", 1},
      {"bands", {{"wavelength_nm", {450}}}},
      {"geometry", {{{"ground", {{"material", "plate"}}}}}},
      {"materials", {{"plate", {{"model", "lambertian"}, {"reflectance", 0.2}}}}},
      {"sun", {{"zenith_deg", 60}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 10}}, {"look_at_m", {0, 0, 0}}}}};
}
struct Example {
  std::string flags;
  json sky;
};
Example exampleOf(const SkyEntry& entry) {
  Example made{"--model " + entry.name, {{"model", entry.name}}};
  std::istringstream words(entry.example);
  for (std::string word; words >> word;) {
    const std::string name = word.substr(0, word.find('=')),
                      value = word.substr(name.size() + 1);
    made.flags += ' ' + flagOf(name) + ' ' + value;
    made.sky[name] = json::accept(value) ? json::parse(value) : json(value);
  }
  return made;
}
}  // namespace

// The scene's clear sky is tabulated: 1e-5 (RayleighSky_test).
TEST(SkyRegistryIdentity, EachSkyIsTheSameInASceneAndOnTheCommandLine) {
  const Scratch scratch;
  ASSERT_EQ(malusIn(scratch.path,
                    "sky --wavelength-nm 450 --mu0 0.5 --dome-step-deg 10 --out sky.csv")
                .code,
            0);
  ASSERT_GE(skyEntries().size(), 3u);
  for (const SkyEntry& entry : skyEntries()) {
    const Example example = exampleOf(entry);
    const Scene scene = readSceneText(sceneUnder(example.sky).dump(), "s.json", scratch.path);
    CDSpectralVector<CDStokesVector> light(scene.world.grid);
    scene.world.sky->radiance(compassDirection(60 * degree, 40 * degree), light);
    const CDStokesVector ours = std::as_const(light)[0];
    const Outcome outcome =
        malusIn(scratch.path,
                "sky " + example.flags +
                    " --wavelength-nm 450 --mu0 0.5 --mu 0.5 --phi-deg 40 --irradiance 1");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream text(outcome.out);
    const Table answer = Table::parse(text, "answer");
    const char* const names[]{"I", "Q", "U", "V"};
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(ours.getStokes(k), answer.number(0, names[k]), 1e-5 * ours.getScalar())
          << entry.name << k;
    EXPECT_GT(ours.getScalar(), 0) << entry.name;  // control
  }
}

TEST(SkyRegistryInvariant, EachParameterIsAKeyAndAFlagAndIsDescribed) {
  const std::string help = malusIn(".", "sky --help").out,
                    list = malusIn(".", "sky --list").out;
  const json& keys = sceneSchema()["properties"]["sky"]["properties"];
  for (const SkyEntry& entry : skyEntries()) {
    EXPECT_NE(list.find(entry.name), std::string::npos);
    const std::string described = malusIn(".", "sky --describe " + entry.name).out;
    for (const Parameter& parameter : entry.parameters) {
      EXPECT_TRUE(keys.contains(parameter.name)) << parameter.name;
      EXPECT_EQ(help.find(flagOf(parameter.name) + ' ') == std::string::npos, parameter.list)
          << parameter.name;
      EXPECT_NE(described.find(parameter.meaning), std::string::npos) << parameter.name;
    }
  }
  EXPECT_FALSE(keys.contains("wind_m_s"));  // control
}

TEST(SkyRegistryIdentity, WhatIsWrongIsSaidAtItsPlace) {
  const auto complaint = [](const json& sky) {
    try {
      readSceneText(sceneUnder(sky).dump(), "s.json", ".");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.substr(0, 9), "s.json:1:") << text;
  };
  EXPECT_EQ(complaint({{"model", "rayleigh"}, {"albedo", 0.2}}), "accepted");  // control
  has(complaint({{"model", "raleigh"}}), "did you mean rayleigh?");
  has(complaint({{"model", "rayleigh"}, {"albedoo", 0.2}}),
      "sky.albedoo: is not a known key here; did you mean albedo?");
  has(complaint({{"model", "rayleigh"}, {"albedo", 2}}), "sky.albedo = 2: must be 0 to 1");
  has(complaint({{"model", "rayleigh"}, {"tau", 0.2}, {"pressure_hPa", 900}}),
      "sky.pressure_hPa: changes nothing beside an optical depth");
  has(complaint({{"model", "rayleigh"}, {"aerosol_tau", 0.2}}),
      "sky.aerosol_tau: needs an aerosol");
  has(complaint({{"model", "table"}}), "lacks \"file\"");
  has(complaint({{"model", "uniform"}, {"path_radiance", true}, {"temperature_K", 300}}),
      "sky.path_radiance = true: is not available for this sky");
  for (const char* flag : {"--fluxes", "--mu 0.5 --direction up", "--mu 0.5 --tau-obs 0.1",
                           "--mu 0.5 --path --direction up"}) {
    const Outcome outcome = malusIn(
        ".",
        std::string("sky --model uniform --temperature-K 300 --wavelength-nm 9000 ") + flag);
    EXPECT_EQ(outcome.code, 2) << flag;
    EXPECT_NE(outcome.err.find("is not made of air"), std::string::npos) << outcome.err;
  }
  const Outcome stranger = malusIn(".", "sky --tau 0.1 --mu0 0.5 --mu 0.5 --temperature-K 300");
  EXPECT_EQ(stranger.code, 2);
  EXPECT_NE(stranger.err.find("--temperature-K = 300: is not a parameter of rayleigh"),
            std::string::npos)
      << stranger.err;
}
