// Thermal emission of the air (nw/air/ThermalAir.nw).
#include "malus/air/ThermalAir.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "malus/base/Error.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/surface/Emission.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const InputPlace here{"test", 0, "atmosphere"};
const SpectralGridPtr grid = SpectralGrid::make({8500.0, 10000.0});
CDSpectralVector<double> depths(double tau) { return {grid, tau}; }
const AtmosphereProfile& standard() {
  static const AtmosphereProfile air = AtmosphereProfile::named("us-standard", here);
  return air;
}
double seen(const Sky& sky, double cosine, std::size_t band = 1) {
  CDSpectralVector<CDStokesVector> light(grid);
  sky.radiance({std::sqrt(1 - cosine * cosine), 0, cosine}, light);
  return std::as_const(light)[band].getScalar();
}
/// 2 pi integral of L mu dmu.
double flux(const Sky& sky) {
  return 2 * pi *
         boost::math::quadrature::gauss<double, 60>::integrate(
             [&](double w) {
               return seen(sky, w * w) * w * w * 2 * w;  // mu = w^2
             },
             0.0, 1.0);
}
std::string refused(double K, double tau, double scale_m) {
  try {
    ThermalAir(K, depths(tau), scale_m);
  } catch (const MathError& error) {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(ThermalAirIdentity, AirOfOneTemperature) {
  const double black = planckRadiance(10000, 290);
  for (const double tau : {1e-6, 0.3, 2.0, 1000.0}) {
    const ThermalAir air(290, depths(tau), 2000);
    const ThermalSky sky(air);
    for (const double cosine : {1.0, 0.5, 0.3, 0.05}) {
      const auto [emitted, transmitted] = air.fromGround(1, cosine);
      EXPECT_NEAR(emitted, black * -std::expm1(-tau / cosine), 1e-13 * black);
      EXPECT_NEAR(transmitted, std::exp(-tau / cosine), 1e-14);
      // between two nodes of sqrt(cosine), h = 1/1024: h^2/8 times the curvature, at most 60 B here
      EXPECT_NEAR(seen(sky, cosine), emitted, 1e-5 * black) << tau << ' ' << cosine;
    }
    EXPECT_EQ(seen(sky, 0), black);     // the horizon
    EXPECT_EQ(seen(sky, -0.5), black);  // and below
    // flux down: pi B (1 - 2 E3(tau)); 1e-5 of the table
    EXPECT_NEAR(flux(sky), pi * black * (1 - 2 * boost::math::expint(3, tau)),
                2e-5 * pi * black);
  }
  EXPECT_EQ(seen(ThermalSky(ThermalAir(290, depths(1000), 2000)), 1), black);  // thick
  const ThermalAir thin(290, depths(1e-6), 2000);
  EXPECT_NEAR(thin.fromGround(1, 0.5).emitted, black * 2e-6, 1e-11 * black);
  // by hand in the chapter
  EXPECT_NEAR(ThermalAir(290, depths(0.3), 2000).fromGround(1, 0.5).emitted / black, 0.45,
              0.005);
}

// Of one temperature: as much leaves at the top as reaches the ground, and together all that is not absorbed on the way.
TEST(ThermalAirInvariant, AColumnLosesTheSameAtBothEnds) {
  const ThermalAir air(290, depths(0.4), 2000);
  for (const double cosine : {1.0, 0.4}) {
    const auto down = air.between(1, 1e5, 0, 1e5 / cosine),
               up = air.between(1, 0, 1e5, 1e5 / cosine);
    EXPECT_NEAR(down.emitted, up.emitted, 1e-12 * down.emitted);
    EXPECT_NEAR(down.emitted, air.fromGround(1, cosine).emitted, 1e-12 * down.emitted);
    EXPECT_NEAR(down.emitted, planckRadiance(10000, 290) * (1 - down.transmitted),
                1e-12 * down.emitted);
  }
}

// Kirchhoff: in a room of air at its temperature a black body cannot be distinguished.
TEST(ThermalAirInvariant, ABlackBodyOfTheAirsTemperatureIsHidden) {
  const ThermalPath path(ThermalAir(290, depths(0.4), 2000));
  const CDVector from{10, 20, 0}, ends[]{{0, 0, 5}, {3000, 0, 0}, {500, 500, 20000}};
  for (const CDVector& to : ends) {
    CDSpectralVector<CDStokesVector> light(grid), warm(grid);
    for (std::size_t band = 0; band < 2; ++band) {
      light[band] = CDStokesVector(planckRadiance(grid->nm(band), 290));
      warm[band] = CDStokesVector(planckRadiance(grid->nm(band), 300));
    }
    const auto before = light, hotter = warm;
    path.apply(from, to, light), path.apply(from, to, warm);
    for (std::size_t band = 0; band < 2; ++band) {
      const double B = before[band].getScalar();
      EXPECT_NEAR(std::as_const(light)[band].getScalar(), B, 1e-12 * B);
      // control: a warmer one is seen, and fades
      EXPECT_GT(std::as_const(warm)[band].getScalar(), B * (1 + 1e-3));
      EXPECT_LT(std::as_const(warm)[band].getScalar(), hotter[band].getScalar());
    }
  }
}

TEST(ThermalAirInvariant, PolarisedLightFades) {
  const ThermalPath path(ThermalAir(290, depths(0.4), 2000));
  CDSpectralVector<CDStokesVector> light(grid);
  for (std::size_t band = 0; band < 2; ++band) light[band] = CDStokesVector(1, 0.3, 0.1, 0);
  path.apply({0, 0, 0}, {0, 0, 1e5}, light);
  EXPECT_NEAR(std::as_const(light)[1].getStokes(1), 0.3 * std::exp(-0.4), 1e-12);
  EXPECT_NEAR(std::as_const(light)[1].getStokes(0),
              std::exp(-0.4) - planckRadiance(10000, 290) * std::expm1(-0.4), 1e-12);
}

// A sum over even steps of height, which has no equation in common with the pieces.
TEST(ThermalAirIdentity, TheSkyOfALayeredAtmosphere) {
  constexpr double tau = 0.6, scale = 2000;
  const ThermalAir air(standard(), depths(tau), scale);
  for (const double cosine : {1.0, 0.3}) {
    double sum = 0;
    const int steps = 20000;
    const double dz = 25000.0 / steps;
    for (int i = 0; i < steps; ++i) {
      const double z = (i + 0.5) * dz, below = tau / cosine * -std::expm1(-z / scale);
      sum += planckRadiance(10000, standard().temperature_K(z)) * std::exp(-below) * tau /
             cosine * std::exp(-z / scale) * dz / scale;
    }
    // B is a line in the pieces of 250 m: (250/6000)^2/8
    EXPECT_NEAR(air.fromGround(1, cosine).emitted, sum, 3e-4 * sum) << cosine;
  }
  // colder overhead than at the horizon, and colder than the ground's air
  EXPECT_LT(air.fromGround(1, 1).emitted, 0.8 * air.fromGround(1, 0.1).emitted);
  EXPECT_LT(air.fromGround(1, 0.1).emitted, planckRadiance(10000, 288.2));
}

TEST(ThermalAirInvariant, LinesJoin) {
  const ThermalAir air(standard(), depths(0.6), 2000);
  const double black = planckRadiance(10000, 288.2);
  for (const double length : {1.0, 3.0}) {
    const auto sky = air.fromGround(1, 1 / length);
    const auto line = air.between(1, 119999, 0, 119999 * length);
    EXPECT_NEAR(line.emitted, sky.emitted, 1e-9 * black);
    EXPECT_NEAR(line.transmitted, sky.transmitted, 1e-9);
    for (const bool up : {false, true}) {  // 3 km, 800 m, ground and back
      const double a = up ? 0 : 3000, b = up ? 3000 : 0;
      const auto whole = air.between(1, a, b, 3000 * length),
                 first = air.between(1, a, 800, std::abs(a - 800) * length),
                 second = air.between(1, 800, b, std::abs(b - 800) * length);
      // Another division. B is a line of the depth in a piece, and one of the height at its ends: they differ by
      // an eighth of 0.125, the piece in scale heights, times the 2.4 % of B in a piece, times its depth of 0.2.
      EXPECT_NEAR(second.emitted + second.transmitted * first.emitted, whole.emitted,
                  1e-4 * black);
      EXPECT_NEAR(second.transmitted * first.transmitted, whole.transmitted, 1e-12);
    }
  }
  // a level line: the air of its height
  const auto level = air.between(1, 1000, 1000, 5000);
  const double sigma = 0.6 * std::exp(-0.5) * 5000 / 2000;
  EXPECT_NEAR(level.transmitted, std::exp(-sigma), 1e-12);
  EXPECT_NEAR(level.emitted,
              planckRadiance(10000, standard().temperature_K(1000)) * -std::expm1(-sigma),
              1e-12 * black);
}

TEST(ThermalAirIdentity, InAScene) {
  nlohmann::json scene{
      {"malus", 1},
      {"bands", {{"wavelength_nm", {8500, 10000}}}},
      {"geometry", {{{"ground", {{"material", "soil"}}}}}},
      {"materials",
       {{"soil", {{"model", "lambertian"}, {"reflectance", 0}, {"temperature_K", 290}}}}},
      {"sky",
       {{"model", "thermal-air"},
        {"optical_depth", 0.4},
        {"temperature_K", 290},
        {"path_radiance", true}}},
      {"sensor", {{"kind", "framing"}, {"width", 4}, {"height", 4}, {"field_of_view_deg", 10}}},
      {"platform", {{"position_m", {0, 0, 9000}}, {"look_at_m", {0, 0, 0}}}}};
  const auto read = [&] { return readSceneText(scene.dump(), "s.json", "."); };
  const auto complaint = [&]() -> std::string {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const Scene made = read();
  EXPECT_NEAR(seen(*made.world.sky, 0.5), planckRadiance(10000, 290) * -std::expm1(-0.8), 1e-7);
  ASSERT_TRUE(made.world.atmosphere);
  scene["sky"]["atmosphere"] = "us-standard";
  EXPECT_NE(complaint().find("does not specify the temperature of the air exactly once; give "
                             "temperature_K "
                             "or atmosphere"),
            std::string::npos)
      << complaint();
  scene["sky"].erase("temperature_K");
  EXPECT_EQ(complaint(), "accepted");
  scene["sky"]["atmosphere"] = "us-standart";
  EXPECT_NE(complaint().find("us-standard"), std::string::npos) << complaint();
  scene["sky"]["atmosphere"] = "us-standard";
  scene["sky"]["optical_depth"] = -1;
  EXPECT_NE(complaint().find("sky.optical_depth = -1"), std::string::npos) << complaint();
}

TEST(ThermalAirRefusal, SaysWhatIsWrong) {
  EXPECT_EQ(refused(290, 0.4, 2000), "");
  EXPECT_EQ(refused(290, -0.4, 2000), "air has no optical depth of -0.4");
  EXPECT_EQ(refused(290, 0.4, 0), "air has no scale height of 0 m");
  EXPECT_EQ(refused(-1, 0.4, 2000), "a black body of -1 K at 8500 nm cannot be evaluated");
}
