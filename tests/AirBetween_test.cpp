// The air between a scene and a camera (nw/air/AirBetween.nw).
#include "malus/air/AirBetween.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "malus/air/AerosolSky.hpp"
#include "malus/air/RayleighSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Refusal.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi, irradiance = 2;

// Spheres of haze: a peak ahead, polarisation, and light that is absorbed.
Scatterer hazeOf() {
  const double s = 0.5;
  std::vector<Scatterer::Term> terms;
  for (int l = 0; l < 24; ++l) {
    const double a = (2 * l + 1) * std::pow(0.7, l);
    Scatterer::Term term{a, l < 2 ? 0 : a * s, l < 2 ? 0 : a * s, a * s, 0, 0};
    term.beta1 = l < 2 ? 0 : -0.15 * a * std::pow(0.8, l);
    term.beta2 = l < 2 ? 0 : 0.05 * a * std::pow(0.8, l);
    terms.push_back(term);
  }
  return Scatterer(terms);
}

struct Case {
  std::string name;
  std::vector<AirPart> parts;
  double albedo, sun_cosine;
};
std::vector<Case> cases() {
  const HeightSpread molecules{.scale_m = molecular_scale_height_m};
  const Scatterer air = rayleighScatterer(0.03), haze = hazeOf();
  return {
      {"haze mixed in", {{{haze, 0.3, 0.95}, molecules}, {{air, 0.1}, molecules}}, 0.3, 0.6},
      {"haze below",
       {{{haze, 0.4, 0.9}, {.scale_m = 1500}}, {{air, 0.22}, molecules}},
       0.1,
       0.35},
      {"smoke between",
       {{{haze, 0.5, 0.8}, {.from_m = 1000, .to_m = 1800}}, {{air, 0.1}, molecules}},
       0.2,
       0.8}};
}

// The light at some heights along some cosines, from a separate solution, finer in everything.
struct Exact {
  Exact(const Case& c, const std::vector<double>& heights, const std::vector<double>& cosines)
      : heights_(heights), cosines_(cosines), air_(c.parts, 60) {
    std::vector<double> depths;
    for (const double z : heights) depths.push_back(air_.depth(z));
    light_.emplace(air_.layers(), c.sun_cosine, AirGround{c.albedo}, irradiance, cosines,
                   depths,
                   LayeredLight::Accuracy{.streams = 40, .terms = 64, .remainder = 1e-9});
  }
  CDStokesVector operator()(double height, const CDVector& to_sun, const CDVector& k) const {
    const auto [cosine, sine] = azimuthFrom(to_sun, -k);
    const double phi = std::atan2(sine, cosine);
    std::size_t view = 0, observer = 0;
    while (std::abs(cosines_.at(view) - std::abs(k.z)) > 1e-9) ++view;
    while (heights_.at(observer) != height) ++observer;
    return k.z > 0 ? light_->up(view, phi, observer) : light_->down(view, phi, observer);
  }

 private:
  std::vector<double> heights_, cosines_;
  AirHeights air_;
  std::optional<LayeredLight> light_;
};

LayeredAir airOf(const Case& c, const CDVector& to_sun) {
  const AirHeights heights(c.parts);
  const std::vector<double> cosines = AirSources::cosines(),
                            depths = AirSources::depths(heights, c.sun_cosine);
  const LayeredLight light(heights.layers(), c.sun_cosine, AirGround{c.albedo}, irradiance,
                           cosines, depths);
  std::vector<std::size_t> views(cosines.size()), observers(depths.size());
  for (std::size_t i = 0; i < views.size(); ++i) views[i] = i;
  for (std::size_t i = 0; i < observers.size(); ++i) observers[i] = i;
  return {to_sun, {{heights, AirSources(heights, light, c.sun_cosine, views, observers)}}};
}

CDStokesVector through(const Atmosphere& air, const CDVector& from, const CDVector& to,
                       const CDStokesVector& in) {
  CDSpectralVector<CDStokesVector> light(SpectralGrid::make({550}));
  light[0] = in;
  air.apply(from, to, light);
  return std::as_const(light)[0];
}

double apart(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(a.getStokes(k) - b.getStokes(k)));
  return most / b.getScalar();
}

CDVector towards(double elevation_deg, double azimuth_deg) {
  return compassDirection((90 - elevation_deg) * degree, azimuth_deg * degree);
}
}  // namespace

// What arrives is the light of the solver at the camera, if what leaves is the light of the
// solver there. The stated error of the table is 1 %.
TEST(AirBetweenInvariant, WhatArrivesIsTheLightAtTheCamera) {
  double worst = 0;
  for (const Case& c : cases()) {
    const CDVector to_sun = compassDirection(std::acos(c.sun_cosine), 200 * degree);
    const LayeredAir air = airOf(c, to_sun);
    const struct {
      double thing, camera;
    } heights[]{{0, 50}, {0, 1300}, {0, 9000}, {700, 3000}, {2500, 1200}, {1500, 2}};
    const std::vector<double> elevations{1.5, 8.0, 33.0, 71.0};
    std::vector<double> cosines;
    for (const double e : elevations) cosines.push_back(std::sin(e * degree));
    const Exact exact(c, {0, 2, 50, 700, 1200, 1300, 1500, 2500, 3000, 9000}, cosines);
    int with_u = 0;
    for (const auto& [thing, camera] : heights)
      for (const double elevation : elevations)
        for (const double azimuth : {10.0, 95.0, 203.0, 301.0}) {
          const double sense = camera > thing ? 1 : -1;
          const CDVector k = towards(sense * elevation, azimuth);
          const CDVector from{0, 0, thing}, to = from + k * ((camera - thing) / k.z);
          const CDStokesVector there = exact(thing, to_sun, k),
                               wanted = exact(camera, to_sun, k),
                               got = through(air, from, to, there);
          const double error = apart(got, wanted);
          worst = std::max(worst, error);
          EXPECT_LT(error, 0.01) << c.name << ' ' << thing << ' ' << camera << ' ' << elevation
                                 << ' ' << azimuth;
          const CDStokesVector other(wanted.getScalar(), wanted.getStokes(1),
                                     -wanted.getStokes(2), -wanted.getStokes(3));
          if (std::abs(wanted.getStokes(2)) > 0.05 * wanted.getScalar() &&
              camera - thing > 1000) {
            ++with_u;
            EXPECT_GT(apart(through(air, from, to,
                                    CDStokesVector(there.getScalar(), there.getStokes(1),
                                                   there.getStokes(2), 0)),
                            other),
                      0.02)
                << "negative control: the other side of the sun";
          }
        }
    EXPECT_GT(with_u, 3) << c.name;
  }
  RecordProperty("worst", fmt::format("{}", worst));
}

// Beer's law by hand, in haze and molecules with different heights: the difference between what
// arrives of light and of none.
TEST(AirBetweenIdentity, TransmissionIsBeersLaw) {
  const Case c = cases()[1];
  const LayeredAir air = airOf(c, towards(20, 0));
  const double haze = 0.4, molecules = 0.22;
  const struct {
    CDVector from, to;
    double depth;
  } ways[]{
      {{0, 0, 0},
       {0, 0, 1500},
       haze * (1 - std::exp(-1)) + molecules * (1 - std::exp(-1500 / 8434.5))},
      {{0, 0, 3000},
       {4000, 0, 0},
       (haze * (1 - std::exp(-2)) + molecules * (1 - std::exp(-3000 / 8434.5))) * 5 / 3},
      {{0, 0, 750},
       {0, 2000, 750},
       2000 * (haze / 1500 * std::exp(-0.5) + molecules / 8434.5 * std::exp(-750 / 8434.5))},
      {{0, 0, 500}, {0, 0, 500}, 0}};
  for (const auto& [from, to, depth] : ways) {
    const double with = through(air, from, to, CDStokesVector(7, 1, 2, 0.5)).getStokes(0),
                 without = through(air, from, to, CDStokesVector(0.0)).getStokes(0);
    EXPECT_NEAR((with - without) / 7, std::exp(-depth), 1e-12);
    EXPECT_NEAR(through(air, from, to, CDStokesVector(7, 1, 2, 0.5)).getStokes(2) -
                    through(air, from, to, CDStokesVector(7, 1, 0, 0.5)).getStokes(2),
                2 * std::exp(-depth), 1e-12);
  }
  EXPECT_GT(std::abs(std::exp(-ways[0].depth) - std::exp(-ways[0].depth * 1.01)),
            1e-3);  // control
}

// No way, no light; and a way in two pieces is the way.
TEST(AirBetweenInvariant, WaysCanBeCut) {
  for (const Case& c : cases()) {
    const LayeredAir air = airOf(c, compassDirection(std::acos(c.sun_cosine), 200 * degree));
    const CDVector from{0, 0, 30}, to{3000, 5000, 4000};
    const CDStokesVector whole = through(air, from, to, CDStokesVector(0.2));
    for (const double part : {1e-6, 0.2, 0.31, 0.777}) {
      const CDVector between = from + (to - from) * part;
      const CDStokesVector cut =
          through(air, between, to, through(air, from, between, CDStokesVector(0.2)));
      EXPECT_LT(apart(cut, whole), 1e-4) << c.name << ' ' << part;
    }
    EXPECT_EQ(apart(through(air, from, from, CDStokesVector(0.2)), CDStokesVector(0.2)), 0);
    EXPECT_GT(apart(through(air, from, from + (to - from) * 0.5, CDStokesVector(0.2)), whole),
              1e-3)
        << "negative control";
  }
}

// Level paths are the limit of the others, for short ways and long ones, upwards and downwards.
TEST(AirBetweenIdentity, LevelWaysAreALimit) {
  for (const Case& c : cases()) {
    const LayeredAir air = airOf(c, compassDirection(std::acos(c.sun_cosine), 200 * degree));
    for (const double length : {10.0, 3000.0, 1e6})
      for (const double z : {3.0, 1400.0}) {
        const CDStokesVector level =
            through(air, {0, 0, z}, {length, 0, z}, CDStokesVector(0.1));
        for (const double rise : {1e-9, -1e-9, 1e-5, -1e-5})
          EXPECT_LT(apart(through(air, {0, 0, z}, {length, 0, z + rise * length},
                                  CDStokesVector(0.1)),
                          level),
                    std::abs(rise) > 1e-8 ? 0.02 : 1e-3)
              << c.name << ' ' << length << ' ' << z << ' ' << rise;
      }
  }
}

// Clear air as a special case: the table against the formulas of nw/air/RayleighSky.nw, between the nodes.
TEST(AirBetweenInvariant, ClearAirIsThatOfTheFormulas) {
  const SpectralGridPtr grid = SpectralGrid::make({550});
  const CDVector to_sun = compassDirection(50 * degree, 200 * degree);
  Sun sun{to_sun, CDSpectralVector<CDStokesVector>(grid)};
  sun.irradiance[0] = CDStokesVector(irradiance);
  const double depth = 0.25, depolarization = 0.03, albedo = 0.3;
  const auto sky = std::make_shared<RayleighSky>(
      sun, RayleighSky::Air{{grid, depth}, {grid, depolarization}, {grid, albedo}});
  const RayleighPathRadiance formulas(sky);
  const LayeredAir table = airOf(
      {"clear",
       {{{rayleighScatterer(depolarization), depth}, {.scale_m = molecular_scale_height_m}}},
       albedo,
       to_sun.z},
      to_sun);
  for (const double elevation : {2.0, 14.0, 52.0, 90.0})
    for (const double azimuth : {13.0, 130.0, 222.0})
      for (const double height : {40.0, 2000.0, 30000.0, 700e3})
        for (const bool up : {true, false}) {
          const CDVector low{0, 0, 0},
              high = towards(elevation, azimuth) * (height / std::sin(elevation * degree));
          const CDVector from = up ? low : high, to = up ? high : low;
          const CDStokesVector wanted = through(formulas, from, to, CDStokesVector(0.1)),
                               got = through(table, from, to, CDStokesVector(0.1));
          EXPECT_LT(apart(got, wanted), 0.005) << elevation << ' ' << azimuth << ' ' << height;
          if (height > 1000 && std::abs(wanted.getStokes(2)) > 0.02 * wanted.getScalar()) {
            EXPECT_GT(apart(got, CDStokesVector(wanted.getScalar(), wanted.getStokes(1),
                                                -wanted.getStokes(2), wanted.getStokes(3))),
                      0.01)
                << "negative control";
          }
        }
}

// A camera over all air sees what malus sky calls the light that goes up, over black ground nothing but path.
TEST(AirBetweenInvariant, FromSpaceItIsTheLightThatGoesUp) {
  Case c = cases()[1];
  c.albedo = 0;
  const CDVector to_sun = compassDirection(std::acos(c.sun_cosine), 100 * degree);
  const LayeredAir air = airOf(c, to_sun);
  std::vector<double> cosines{0.3, 0.8};
  const Exact exact(c, {400e3}, cosines);
  for (const double cosine : cosines)
    for (const double azimuth : {0.0, 77.0, 190.0}) {
      const CDVector k = towards(std::asin(cosine) / degree, azimuth);
      EXPECT_LT(apart(through(air, {0, 0, 0}, k * (400e3 / k.z), CDStokesVector(0.0)),
                      exact(400e3, to_sun, k)),
                0.01)
          << cosine << ' ' << azimuth;
    }
}

TEST(AirBetweenRefusal, NoBandsOrOthers) {
  EXPECT_THROW(LayeredAir({0, 0, 1}, {}), Refusal);
  const LayeredAir air = airOf(cases()[0], {0, 0, 1});
  CDSpectralVector<CDStokesVector> two(SpectralGrid::make({450, 550}));
  EXPECT_THROW(air.apply({0, 0, 0}, {0, 0, 9}, two), GridError);
}
