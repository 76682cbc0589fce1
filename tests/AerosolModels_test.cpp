// Aerosols by name, by file and in numbers (nw/air/AerosolModels.nw), and the skies that they make (nw/air/AerosolSky.nw).
#include "malus/air/AerosolModels.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "Scratch.hpp"
#include "malus/air/AerosolSky.hpp"
#include "malus/air/AtmosphereProfile.hpp"
#include "malus/air/RayleighAir.hpp"
#include "malus/air/SizeLaws.hpp"
#include "malus/air/SkyRegistry.hpp"
#include "malus/base/Angles.hpp"
#include "malus/files/SceneReader.hpp"

using namespace malus;
using nlohmann::json;

namespace {
constexpr double pi = std::numbers::pi;

// Spheres whose series is short.
const json haze{{"n", 1.44}, {"effective_radius_um", 0.2}, {"effective_variance", 0.07}};

// A plate under this sky, with the sun 60 degrees from the zenith in the north.
Scene sceneUnder(const json& sky, const std::vector<double>& nm = {550},
                 const std::filesystem::path& at = ".") {
  const json scene{
      {"malus", 1},
      {"bands", {{"wavelength_nm", nm}}},
      {"geometry", {{{"ground", {{"material", "plate"}}}}}},
      {"materials", {{"plate", {{"model", "lambertian"}, {"reflectance", 0.2}}}}},
      {"sun", {{"zenith_deg", 60}, {"azimuth_deg", 0}, {"irradiance_W_m2_nm", 1}}},
      {"sky", sky},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 10}}, {"look_at_m", {0, 0, 0}}}}};
  return readSceneText(scene.dump(), "s.json", at);
}
std::string complaint(const json& sky, const std::vector<double>& nm = {550}) {
  try {
    sceneUnder(sky, nm);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
json rayleigh(const json& more) {
  json sky{{"model", "rayleigh"}, {"albedo", 0.1}};
  sky.update(more);
  return sky;
}
CDStokesVector seen(const Scene& scene, double zenith_deg, double azimuth_deg,
                    std::size_t band = 0) {
  CDSpectralVector<CDStokesVector> light(scene.world.grid);
  scene.world.sky->radiance(compassDirection(zenith_deg * degree, azimuth_deg * degree), light);
  return std::as_const(light)[band];
}
// The largest difference of two skies over directions, against S0.
double apart(const Scene& a, const Scene& b) {
  double most = 0;
  for (const double zenith : {0.0, 30.0, 60.0, 80.0})
    for (const double azimuth : {3.0, 60.0, 140.0, 250.0}) {
      const CDStokesVector x = seen(a, zenith, azimuth), y = seen(b, zenith, azimuth);
      for (int k = 0; k < 4; ++k)
        most = std::max(most, std::abs(x.getStokes(k) - y.getStokes(k)) / y.getScalar());
    }
  return most;
}
}  // namespace

// Extinction per volume [1/m] of three components of the standard atmosphere at 550 nm, as the radiation code of Edwards and Slingo
// has them from WCP-112. Four digits; their laws end elsewhere than ours, which for the broadest of these three is a per cent.
TEST(AerosolModelsPublished, ComponentsTakeAsMuchLightAsInTheStandard) {
  struct Component {
    double n, k, median_um, deviation, extinction;
  };
  for (const Component& c :
       {Component{1.53, 0.006, 0.005, 2.99, 4.721e6}, Component{1.381, 0, 0.3, 2.51, 7.210e5},
        Component{1.75, 0.44, 0.0118, 2.00, 9.276e6}}) {
    const MiePowder powder = miePowder(
        c.n, c.k, logNormalRadii(c.median_um * 1000, c.deviation, 550, 20000), 550, 1e-9);
    const double s = std::log(c.deviation),
                 volume_um3 = 4 * pi / 3 * std::pow(c.median_um, 3) * std::exp(4.5 * s * s);
    EXPECT_NEAR(powder.extinction_nm2 * 1e-6 / volume_um3 * 1e6 / c.extinction, 1, 0.015)
        << c.median_um;
  }
}

// A name is its components by volume: the sums of what the components do, with the number c / V of each.
TEST(AerosolModelsIdentity, AMixtureIsTheSumOfItsComponents) {
  const Aerosol urban = namedAerosol("urban", 550, {}, {"test", 0, ""});
  double extinction = 0, scattering = 0, number = 0;
  for (const auto& [share, n, k, median, deviation] :
       {std::tuple(0.17, 1.53, 0.008, 500.0, 2.99), std::tuple(0.61, 1.53, 0.006, 5.0, 2.99),
        std::tuple(0.22, 1.75, 0.44, 11.8, 2.00)}) {
    const MiePowder powder =
        miePowder(n, k, logNormalRadii(median, deviation, 550, 20000), 550, 1e-9);
    const double s = std::log(deviation),
                 count = share / (std::pow(median, 3) * std::exp(4.5 * s * s));
    extinction += count * powder.extinction_nm2, scattering += count * powder.scattering_nm2;
    number += count;
  }
  EXPECT_NEAR(urban.albedo, scattering / extinction, 1e-12);
  EXPECT_NEAR(urban.extinction / (extinction / number), 1, 1e-12);
  EXPECT_GT(namedAerosol("maritime", 550, {}, {"test", 0, ""}).albedo, urban.albedo + 0.2);
}

// Spheres in numbers, the same as a file of modes, and the same by the function that malus mie calls.
TEST(AerosolModelsIdentity, SpheresInNumbersAreThoseOfAFile) {
  const Scratch scratch;
  put(scratch / "mode.csv",
      "number_cm3,n,k,effective_radius_um,effective_variance\n1,1.44,0.01,0.2,0.07\n");
  const json told{
      {"n", 1.44}, {"k", 0.01}, {"effective_radius_um", 0.2}, {"effective_variance", 0.07}};
  const Scene numbers = sceneUnder(rayleigh({{"aerosol", told}, {"aerosol_tau", 0.2}}));
  const Scene file = sceneUnder(rayleigh({{"aerosol", "mode.csv"}, {"aerosol_tau", 0.2}}),
                                {550}, scratch.path);
  EXPECT_EQ(apart(numbers, file), 0);
  json other = told;
  other["n"] = 1.45;
  EXPECT_GT(apart(sceneUnder(rayleigh({{"aerosol", other}, {"aerosol_tau", 0.2}})), file), 1e-4)
      << "negative control";
}

// The depth at another wavelength goes with the extinction: by hand, the ratio of two powders.
TEST(AerosolModelsIdentity, TheDepthOfAnotherWavelengthFollowsTheExtinction) {
  const Scene scene = sceneUnder(rayleigh({{"tau", 0.01},
                                           {"aerosol", "continental"},
                                           {"aerosol_tau", 0.3},
                                           {"aerosol_at_nm", 550}}),
                                 {450, 550});
  const auto left = [&](std::size_t band) {
    return -std::log(std::as_const(scene.world.sun->irradiance)[band].getScalar()) * 0.5 - 0.01;
  };
  const auto extinction = [](double nm) {
    return namedAerosol("continental", nm, {}, {"test", 0, ""}).extinction;
  };
  EXPECT_NEAR(left(1), 0.3, 1e-12);
  EXPECT_NEAR(left(0), 0.3 * extinction(450) / extinction(550), 1e-12);
  EXPECT_GT(left(0), 0.33) << "haze is thinner in the red";
}

// Molecules as a layer, and nothing else in the air, are the clear sky, which has an exact solution and a table of 1e-5.
TEST(AerosolSkyIdentity, ALayerOfMoleculesIsTheClearSky) {
  const double rho = rayleighDepolarization(550);
  const Scene clear = sceneUnder(rayleigh({{"tau", 0.3}, {"depolarization", rho}}));
  const json layer{{"particles", "molecules"}, {"tau", 0.3}};
  const Scene layered = sceneUnder(rayleigh({{"tau", 0}, {"layers", {layer}}}));
  EXPECT_LT(apart(layered, clear), 1e-4);
  const Scene plain = sceneUnder(rayleigh({{"tau", 0.3}}));
  EXPECT_GT(apart(layered, plain), 1e-3) << "negative control: without depolarisation";
  EXPECT_NEAR(layered.world.sun->irradiance[0].getScalar(), std::exp(-0.6), 1e-14);
}

// The aerosol's keys and a layer with the same are one thing; so is one layer in two halves.
TEST(AerosolSkyIdentity, AnAerosolIsALayer) {
  const Scene keys = sceneUnder(
      rayleigh({{"aerosol", haze}, {"aerosol_tau", 0.2}, {"aerosol_scale_height_m", 2000}}));
  const json layer{{"particles", haze}, {"tau", 0.2}, {"scale_height_m", 2000}};
  json half = layer;
  half["tau"] = 0.1;
  EXPECT_LT(apart(sceneUnder(rayleigh({{"layers", {layer}}})), keys), 1e-9);
  EXPECT_LT(apart(sceneUnder(rayleigh({{"layers", {half, half}}})), keys), 1e-9);
  EXPECT_GT(apart(sceneUnder(rayleigh({{"layers", {half}}})), keys), 0.1) << "negative control";
}

// Gas under all scatterers dims by Beer's law what reaches the ground along each line of sight. It reflects nothing, the ground is black.
TEST(AerosolSkyInvariant, AGasBelowAllOtherAirDimsTheSkyByBeersLaw) {
  const json molecules{
      {"particles", "molecules"}, {"tau", 0.2}, {"from_m", 1000}, {"to_m", 8000}};
  const json gas{{"tau", 0.4}, {"from_m", 0}, {"to_m", 500}};
  const Scene without =
      sceneUnder({{"model", "rayleigh"}, {"albedo", 0}, {"tau", 0}, {"layers", {molecules}}});
  const Scene with = sceneUnder(
      {{"model", "rayleigh"}, {"albedo", 0}, {"tau", 0}, {"layers", {molecules, gas}}});
  for (const double zenith : {0.0, 40.0, 70.0}) {
    const double left = std::exp(-0.4 / std::cos(zenith * degree));
    EXPECT_NEAR(
        seen(with, zenith, 50).getScalar() / seen(without, zenith, 50).getScalar() / left, 1,
        1e-6)
        << zenith;
  }
}

// An atmosphere by name has its pressure and its ozone, which the sun shows by Beer's law.
TEST(AerosolSkyIdentity, AnAtmosphereBringsPressureAndOzone) {
  const double nm = 600;
  const auto depth = [&](const json& sky) {
    return -0.5 *
           std::log(sceneUnder(rayleigh(sky), {nm}).world.sun->irradiance[0].getScalar());
  };
  const AtmosphereProfile tropical = AtmosphereProfile::named("tropical", {"test", 0, ""});
  const double ozone =
      tropical.ozoneDepth(OzoneAbsorption(SpectralGrid::make({nm})), 0, 0, tropical.top_m());
  const double air = rayleighOpticalDepth(nm, {tropical.pressure_hPa(0)});
  EXPECT_NEAR(depth({{"atmosphere", "tropical"}}), air + ozone, 1e-9);
  EXPECT_NEAR(depth({{"atmosphere", "tropical"}, {"ozone_DU", 0}}), air, 1e-12);
  EXPECT_NEAR(depth({{"atmosphere", "tropical"}, {"ozone_DU", 2 * tropical.ozone_DU()}}),
              air + 2 * ozone, 1e-9);
  EXPECT_NEAR(depth({{"atmosphere", "tropical"}, {"altitude_m", 2000}, {"ozone_DU", 0}}),
              rayleighOpticalDepth(nm, {tropical.pressure_hPa(2000), 2000}), 1e-12);
  EXPECT_GT(ozone, 0.02) << "control";
}

// A cloud between two heights: for the camera below it is grey, and the camera's air has its
// heights.
TEST(AerosolSkyInvariant, ACloudIsALayerOfDroplets) {
  const json cloud{{"particles", "water-cloud"},
                   {"radius_um", 6},
                   {"tau", 8},
                   {"from_m", 1000},
                   {"to_m", 1500}};
  const Scene scene = sceneUnder(rayleigh({{"layers", {cloud}}, {"path_radiance", true}}));
  const CDStokesVector s = seen(scene, 40, 100);
  EXPECT_LT(s.getDOLP(), 0.02);
  EXPECT_GT(seen(sceneUnder(rayleigh(json::object())), 40, 100).getDOLP(), 0.2) << "control";
  ASSERT_TRUE(scene.world.atmosphere);
  CDSpectralVector<CDStokesVector> below(scene.world.grid), through(scene.world.grid);
  below[0] = through[0] = CDStokesVector(1);
  scene.world.atmosphere->apply({0, 0, 0}, {0, 0, 900}, below);
  scene.world.atmosphere->apply({0, 0, 0}, {0, 0, 2000}, through);
  EXPECT_NE(below[0].getScalar(), through[0].getScalar());
  EXPECT_NE(scene.world.sky->description().find("water-cloud from 1000 to 1500 m"),
            std::string::npos)
      << scene.world.sky->description();
}

TEST(AerosolSkyIdentity, WhatIsWrongWithAnAirIsSaidAtItsPlace) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_NE(text.find("s.json:1:"), std::string::npos) << text;
  };
  const auto aerosol = [](const json& what) {
    return complaint(rayleigh({{"aerosol", what}, {"aerosol_tau", 0.1}}));
  };
  const auto layer = [](const json& more) {
    json one{{"particles", haze}, {"tau", 0.1}};
    one.update(more);
    for (auto it = one.begin(); it != one.end();) it = it->is_null() ? one.erase(it) : ++it;
    return complaint(rayleigh({{"layers", {one}}}));
  };
  EXPECT_EQ(aerosol("maritime"), "accepted");  // control
  EXPECT_EQ(layer({{"from_m", 0}, {"to_m", 10}}), "accepted");
  has(aerosol("maritme"), "did you mean maritime?");
  has(aerosol("water-cloud"), "lacks the effective radius of its droplets");
  has(aerosol(3), "sky.aerosol = 3");
  has(aerosol({{"n", 1.4}}), "is missing");
  has(aerosol({{"n", 1.4}, {"radius_um", 0.1}, {"effective_radius_um", 0.2}}),
      "conflicts "
      "with");
  has(aerosol({{"n", 1.4}, {"radius_um", 1e7}}), "must be 1e-06 to 1e+06");
  has(aerosol({{"n", 1.4}, {"radiuss_um", 1}}), "did you mean radius_um?");
  has(complaint(rayleigh({{"aerosol", "maritime"}, {"aerosol_tau", 0.1}, {"tau", 0.1}}),
                {3000}),
      "is not covered");
  has(complaint(
          rayleigh({{"aerosol", "maritime"}, {"aerosol_tau", 0.1}, {"aerosol_radius_um", 2}})),
      "has its own size law");
  has(layer({{"tau", nullptr}}), "lacks \"tau\"");
  has(layer({{"tau", -1}}), "sky.layers[0].tau = -1");
  has(layer({{"from_m", 100}}), "does not specify its height exactly once");
  has(layer({{"from_m", 100}, {"to_m", 50}}), "must be above from_m");
  has(layer({{"scale_height_m", 100}, {"from_m", 0}, {"to_m", 50}}),
      "does not specify its "
      "height exactly once");
  has(layer({{"particles", "molecules"}, {"albedo", 0.5}}), "needs particles");
  has(layer({{"taus", 1}}), "is not a known key here; did you mean tau?");
  has(complaint(rayleigh({{"layers", json::array()}})), "sky.layers");
  has(complaint(rayleigh({{"atmosphere", "tropicl"}})), "did you mean tropical?");
  has(complaint(rayleigh({{"atmosphere", "tropical"}, {"pressure_hPa", 900}})),
      "conflicts with the pressure of an atmosphere");
  has(complaint(rayleigh({{"ozone_DU", 1001}})), "must be 0 to 1000");
  has(complaint(rayleigh({{"ozone_DU", 300}}), {900}), "900");
  has(complaint(rayleigh({{"aerosol", "maritime"},
                          {"aerosol_tau", 0.1},
                          {"aerosol_place", "below"},
                          {"ozone_DU", 300}})),
      "gives no height, but ozone_DU needs one");
  has(complaint(rayleigh({{"aerosol_at_nm", 550}})), "needs an aerosol");
}
