// Air with aerosol as a sky (nw/air/AerosolSky.nw), by its name and over a scene.
#include "malus/air/AerosolSky.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "Scratch.hpp"
#include "malus/air/SkyRegistry.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/DataFiles.hpp"

using namespace malus;

namespace {
Settings settingsOf(const SkyEntry& entry, const SpectralGridPtr& grid,
                    const std::vector<std::pair<std::string, std::string>>& given) {
  Arguments arguments;
  for (const auto& [name, text] : given) arguments[name] = {text, {"test", 0, name}};
  return checkedSettings({entry.name, {"test", 0, ""}}, entry.parameters, arguments, grid);
}
std::string spheroids() {
  return (dataFolder("scenes") / "data/aerosol-spheroids.csv").string();
}
Sun sunAt(const SpectralGridPtr& grid, double zenith_deg, double azimuth_deg) {
  Sun sun{compassDirection(zenith_deg * degree, azimuth_deg * degree),
          CDSpectralVector<CDStokesVector>(grid)};
  for (std::size_t i = 0; i < grid->size(); ++i) sun.irradiance[i] = CDStokesVector(2);
  return sun;
}
double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a.getStokes(k) - b.getStokes(k)));
  return most / b.getScalar();
}
}  // namespace

// At the nodes the light is that of the solver itself, to the rounding of angles; half-way
// between them linear interpolation has an error of an eighth of the step squared times the
// curvature. The spheroids have 11 orders: (pi/180)^2 / 8 * 11^2 = 5e-3.
TEST(AerosolSkyInvariant, TheSkyOfASceneIsTheLightOfTheAir) {
  const SpectralGridPtr grid = SpectralGrid::make({450, 650});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const Settings settings = settingsOf(entry, grid,
                                       {{"aerosol", spheroids()},
                                        {"aerosol_tau", "0.2"},
                                        {"albedo", "0.3"},
                                        {"aerosol_place", "below"}});
  const Sun sun = sunAt(grid, 50, 120);
  const MadeSky made = entry.make(settings, {grid, sun});
  const std::vector<SkyAir> air = entry.air(settings, true);
  int with_u = 0, with_v = 0;
  const std::vector<double> zeniths{10, 40, 50, 72.25, 84};
  std::vector<double> cosines;
  for (const double zenith : zeniths) cosines.push_back(std::cos(zenith * degree));
  std::vector<SkyLight> exact;
  for (const SkyAir& a : air)
    exact.emplace_back(a, sun.to_sun.z, 2, cosines, std::vector<double>{a.whole()}, nullptr,
                       sceneAccuracy());
  for (const double zenith : zeniths)
    for (const double azimuth : {5.0, 30.0, 90.5, 170.0, 260.0}) {
      CDSpectralVector<CDStokesVector> light(grid);
      made.sky->radiance(compassDirection(zenith * degree, (120 + azimuth) * degree), light);
      const double mu = std::cos(zenith * degree);
      for (std::size_t band = 0; band < 2; ++band) {
        const CDStokesVector s = exact[band](mu, azimuth * degree, false, air[band].whole());
        const bool node = zenith != 72.25 && azimuth != 90.5;
        EXPECT_LT(apart(light[band], s), node ? 1e-9 : 5e-3) << zenith << ' ' << azimuth;
        with_u += std::abs(s.getStokes(2)) > 0.02 * s.getScalar();
        with_v += std::abs(s.getStokes(3)) > 1e-6 * s.getScalar();
        const CDStokesVector mirrored(s.getScalar(), s.getStokes(1), -s.getStokes(2),
                                      -s.getStokes(3));
        if (std::abs(s.getStokes(2)) > 0.02 * s.getScalar()) {
          EXPECT_GT(apart(light[band], mirrored), 0.02);  // control: the other side of the sun
        }
      }
    }
  EXPECT_GT(with_u, 10);
  EXPECT_GT(with_v, 10);
}

TEST(AerosolSkyIdentity, TheSunIsWeakenedByAirAndAerosol) {
  const SpectralGridPtr grid = SpectralGrid::make({450});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const Settings settings = settingsOf(
      entry, grid, {{"tau", "0.1"}, {"aerosol", spheroids()}, {"aerosol_tau", "0.3"}});
  const MadeSky made = entry.make(settings, {grid, sunAt(grid, 60, 0)});
  ASSERT_TRUE(made.sun);
  EXPECT_NEAR(std::as_const(made.sun->irradiance)[0].getScalar(), 2 * std::exp(-0.4 / 0.5),
              1e-12);
  EXPECT_FALSE(made.path_radiance);  // is not computed with aerosol
  // below the horizon is the black ground
  CDSpectralVector<CDStokesVector> light(grid);
  made.sky->radiance({0, 0.6, -0.8}, light);
  EXPECT_EQ(std::as_const(light)[0].getScalar(), 0);
}

// The aerosol of 1e-6 adds less than 1e-4 to a sky of 0.2; that of 0.1 adds more than a tenth.
TEST(AerosolSkyInvariant, ThinAerosolLeadsBackToTheClearSky) {
  const SpectralGridPtr grid = SpectralGrid::make({450});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const auto light = [&](const std::vector<std::pair<std::string, std::string>>& given) {
    const MadeSky made =
        entry.make(settingsOf(entry, grid, given), {grid, sunAt(grid, 50, 120)});
    CDSpectralVector<CDStokesVector> out(grid);
    made.sky->radiance(compassDirection(30 * degree, 200 * degree), out);
    return CDStokesVector(std::as_const(out)[0]);
  };
  const CDStokesVector clear = light({});
  EXPECT_LT(apart(light({{"aerosol", spheroids()}, {"aerosol_tau", "1e-6"}}), clear), 1e-4);
  EXPECT_GT(apart(light({{"aerosol", spheroids()}, {"aerosol_tau", "0.1"}}), clear), 0.05);
}

TEST(AerosolSkyIdentity, AFileMayHoldSeveralWavelengths) {
  const Scratch scratch;
  std::string text =
      "# convention: "
      "dehaan\nwavelength_nm,single_scattering_albedo,l,alpha1,alpha2,alpha3,alpha4,"
      "beta1,beta2\n";
  for (const auto& [nm, albedo, g] :
       {std::tuple("450", "0.9", "0.9"), std::tuple("650", "0.8", "0.5")})
    text += fmt::format("{0},{1},0,1,0,0,1,0,0\n{0},{1},1,{2},0,0,{2},0,0\n", nm, albedo, g);
  put(scratch / "two.csv", text);
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const auto air = [&](double nm) {
    return entry.air(
        settingsOf(entry, SpectralGrid::make({nm}),
                   {{"aerosol", (scratch / "two.csv").string()}, {"aerosol_tau", "1"}}),
        true);
  };
  EXPECT_EQ(air(450)[0].aerosol_albedo, 0.9);
  EXPECT_EQ(air(650.4)[0].aerosol_albedo, 0.8);
  EXPECT_EQ(air(650)[0].aerosol->scatterer.terms()[1].alpha1, 0.5);
  try {
    (void)air(550);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("wavelength_nm: is not that of the sky, 550 nm"),
              std::string::npos)
        << error.what();
  }
}

// The horizon is sharp: a hundredth of a degree below it there is the ground, down to the nadir.
TEST(AerosolSkyIdentity, TheGroundBeginsAtTheHorizon) {
  const SpectralGridPtr grid = SpectralGrid::make({550});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const Settings settings = settingsOf(
      entry, grid, {{"aerosol", spheroids()}, {"aerosol_tau", "0.2"}, {"albedo", "0.3"}});
  const MadeSky made = entry.make(settings, {grid, sunAt(grid, 50, 120)});
  const auto brightness = [&](double zenith_deg) {
    CDSpectralVector<CDStokesVector> light(grid);
    made.sky->radiance(compassDirection(zenith_deg * degree, 10 * degree), light);
    return light[0].getScalar();
  };
  const double ground = brightness(135);
  for (const double zenith : {90.01, 90.5, 91.0, 120.0, 179.9})
    EXPECT_DOUBLE_EQ(brightness(zenith), ground) << zenith;
  EXPECT_GT(std::abs(brightness(89.99) / ground - 1), 0.05) << "negative control";
}

TEST(AerosolSkyIdentity, ParticlesMayAbsorbAnyShare) {
  const SpectralGridPtr grid = SpectralGrid::make({550});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const auto with = [&](const std::string& albedo) {
    return settingsOf(
        entry, grid,
        {{"aerosol", spheroids()}, {"aerosol_tau", "0.2"}, {"aerosol_albedo", albedo}});
  };
  for (const char* albedo : {"0", "0.5", "1"}) EXPECT_NO_THROW(with(albedo)) << albedo;
  EXPECT_THROW(with("1.01"), InputError);
}

// The air before a camera is made of the sky's light, if it is requested, and if the aerosol
// has a height.
TEST(AerosolSkyInvariant, TheCameraLooksThroughTheSameAir) {
  const SpectralGridPtr grid = SpectralGrid::make({450, 650});
  const SkyEntry& entry = skyEntry("rayleigh", {});
  const auto made = [&](const std::vector<std::pair<std::string, std::string>>& more,
                        bool before) {
    std::vector<std::pair<std::string, std::string>> given{
        {"aerosol", spheroids()}, {"aerosol_tau", "0.2"}, {"albedo", "0.3"}};
    given.insert(given.end(), more.begin(), more.end());
    return entry.make(settingsOf(entry, grid, given),
                      {.grid = grid, .sun = sunAt(grid, 50, 120), .before = before});
  };
  const MadeSky haze = made({{"aerosol_scale_height_m", "1500"}}, true);
  ASSERT_TRUE(haze.path_radiance);
  EXPECT_TRUE(haze.path_radiance->polarizes());
  EXPECT_FALSE(made({}, false).path_radiance);
  // a view up through all of the air is the sky of the scene, here between the nodes of both tables
  const CDVector up = compassDirection(33.3 * degree, 77 * degree);
  CDSpectralVector<CDStokesVector> sky(grid), air(grid);
  haze.sky->radiance(up, sky);
  haze.path_radiance->apply(up * 200e3, {0, 0, 0}, air);
  for (std::size_t band = 0; band < 2; ++band) EXPECT_LT(apart(air[band], sky[band]), 0.01);
  haze.path_radiance->apply(up * 1500, {0, 0, 0}, air *= 0.0);
  EXPECT_GT(apart(air[0], sky[0]), 0.1) << "negative control";
  // the same without a wish for it: other panels of depth, and the remainder that the equation may leave
  made({{"aerosol_scale_height_m", "1500"}}, false).sky->radiance(up, air);
  for (std::size_t band = 0; band < 2; ++band)
    EXPECT_LT(apart(air[band], sky[band]), sceneAccuracy().remainder);
  for (const char* place : {"below", "above"}) {
    try {
      (void)made({{"aerosol_place", place}}, true);
      FAIL() << place;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("give aerosol_scale_height_m instead"),
                std::string::npos)
          << error.what();
    }
    EXPECT_THROW(made({{"aerosol_place", place}, {"aerosol_scale_height_m", "900"}}, false),
                 InputError);
  }
}
