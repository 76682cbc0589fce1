// The tabulated Rayleigh sky and the air before the camera (nw/air/RayleighSky.nw).
#include "malus/air/RayleighSky.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "malus/base/Angles.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const CDVector up{0, 0, 1};
using Spectrum = CDSpectralVector<CDStokesVector>;
using Azimuth = RayleighLight::Azimuth;
const auto grid = SpectralGrid::make({400.0, 550.0, 700.0});

Sun sunFrom(double zenith_deg, double azimuth_deg) {
  return {compassDirection(zenith_deg * degree, azimuth_deg * degree), Spectrum(grid, 1.0)};
}
Spectrum ask(const Sky& sky, const CDVector& direction) {
  Spectrum out(sky.grid());
  sky.radiance(direction, out);
  return out;
}
double distance(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a.getStokes(i) - b.getStokes(i)));
  return most;
}
}  // namespace

// The interpolation error that the chapter states, at random directions down to the horizon.
TEST(RayleighSkyInvariant, TheTableIsTheExactLight) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform;
  double worst = 0;
  for (int suns = 0; suns < 8; ++suns) {
    const double sun_azimuth = 360 * uniform(engine);
    const RayleighSky sky(sunFrom(85 * uniform(engine), sun_azimuth),
                          RayleighSky::clearAir(grid, uniform(engine)));
    for (int i = 0; i < 200; ++i) {
      const double z = uniform(engine) * uniform(engine), turn = 2 * pi * uniform(engine);
      const CDVector d = compassDirection(std::acos(z), turn);
      const Spectrum table = ask(sky, d);
      for (std::size_t b = 0; b < 3; ++b) {
        const CDStokesVector exact =
            sky.light(b).down(d.z, Azimuth::fromRadians(turn - sun_azimuth * degree));
        worst = std::max(worst, distance(table[b], exact) / exact.getScalar());
      }
    }
  }
  EXPECT_LT(worst, 2e-6);
  EXPECT_GT(worst, 2e-10);  // a table is not the light itself: the comparison sees differences
}

// Single precision: ten roundings of 6e-8, and directions that are known to 1e-7, where the sky is steepest
// in 1/mu near the horizon: 1e-5 of the radiance.
TEST(RayleighSkyInvariant, ManyDirectionsAtOnceAreTheSameLight) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform;
  for (const double zenith_deg : {0.0, 30.0, 80.0}) {
    const RayleighSky sky(sunFrom(zenith_deg, 77), RayleighSky::clearAir(grid, 0.3));
    std::vector<float> x, y, z;
    for (int i = 0; i < 150; ++i) {  // more than two blocks of 64, and an odd rest
      CDVector d = CDVector::fromAngles(std::acos(1.1 * uniform(engine) - 0.1),
                                        2 * pi * uniform(engine));
      if (i == 0) d = up;
      if (i == 1) d = {1, 0, 0};
      if (i == 2) d = normalized({1e-4, 2e-4, 1});
      x.push_back(static_cast<float>(d.x)), y.push_back(static_cast<float>(d.y));
      z.push_back(static_cast<float>(d.z));
    }
    std::vector<float> out(x.size() * 4 * 3);
    sky.radiances({x.size(), x.data(), y.data(), z.data()}, out);
    EXPECT_THROW(sky.radiances({x.size() + 1, x.data(), y.data(), z.data()}, out), MathError);
    double worst = 0, mirrored = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Spectrum one = ask(sky, normalized({x[i], y[i], z[i]}));
      for (std::size_t b = 0; b < 3; ++b) {
        const CDStokesVector many(out[(4 * i) * 3 + b], out[(4 * i + 1) * 3 + b],
                                  out[(4 * i + 2) * 3 + b], out[(4 * i + 3) * 3 + b]);
        const CDStokesVector other(many.getStokes(0), many.getStokes(1), -many.getStokes(2), 0);
        worst = std::max(worst, distance(many, one[b]) / one[b].getScalar());
        mirrored = std::max(mirrored, distance(other, one[b]) / one[b].getScalar());
      }
    }
    EXPECT_LT(worst, 1e-5) << zenith_deg;
    if (zenith_deg > 0) {
      EXPECT_GT(mirrored, 0.1);  // control
    }
  }
}

// A sky without its own radiances().
class OneByOne final : public Sky {
 public:
  explicit OneByOne(const Sky& sky) : Sky(sky.grid()), sky_(sky) {}
  void radiance(const CDVector& to_sky, Spectrum& out) const override {
    sky_.radiance(to_sky, out);
  }
  bool polarized() const override { return true; }
  std::string description() const override { return "one by one"; }

 private:
  const Sky& sky_;
};

// The sky's own loop over eights of bands and the plain one against rotate(), eq 3.48 of the thesis; the
// tolerance is that of the test above.
TEST(RayleighSkyInvariant, ManyDirectionsAreTurnedAsOneIs) {
  for (const std::size_t bands : {1, 2, 7, 8, 9, 100}) {
    std::vector<double> nm;
    for (std::size_t b = 0; b < bands; ++b) nm.push_back(400 + 3.0 * static_cast<double>(b));
    const auto many = SpectralGrid::make(nm);
    const Sun sun{compassDirection(40 * degree, 1), Spectrum(many, 1.0)};
    const RayleighSky sky(sun, RayleighSky::clearAir(many, 0.3));
    const OneByOne plain(sky);
    std::vector<float> x, y, z, c, s;
    for (int i = 0; i < 70;
         ++i) {  // a portion of 64 and a rest; one direction below the horizon
      const CDVector d = CDVector::fromAngles(std::acos((i + 0.5) / 70 - 0.01), 2.4 * i);
      x.push_back(static_cast<float>(d.x)), y.push_back(static_cast<float>(d.y));
      z.push_back(static_cast<float>(d.z));
      c.push_back(static_cast<float>(std::cos(0.7 * i))),
          s.push_back(static_cast<float>(std::sin(0.7 * i)));
    }
    for (const Sky* asked : {static_cast<const Sky*>(&sky), static_cast<const Sky*>(&plain)}) {
      std::vector<float> out(x.size() * 4 * bands);
      const SkyDirections to_sky{x.size(), x.data(), y.data(), z.data(), c.data(), s.data()};
      asked->radiances(to_sky, out);
      SkyDirections for_s0 = to_sky;
      for_s0.only_s0 = true;
      std::vector<float> s0(out.size(), -1);
      asked->radiances(for_s0, s0);
      for (std::size_t i = 0; i < out.size(); ++i)
        if (i / bands % 4 == 0) {
          EXPECT_FLOAT_EQ(s0[i], out[i]) << i;
        }
      EXPECT_EQ(std::ranges::count(s0, -1) > 0, asked == &sky) << "control: less is written";
      double worst = 0, opposite = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        Spectrum one = ask(sky, normalized({x[i], y[i], z[i]})), other = one;
        one.rotate(c[i], s[i]), other.rotate(c[i], -s[i]);
        for (std::size_t b = 0; b < bands; ++b) {
          const float* at = &out[4 * i * bands + b];
          const CDStokesVector got(at[0], at[bands], at[2 * bands], at[3 * bands]);
          worst = std::max(worst, distance(got, one[b]) / one[b].getScalar());
          opposite = std::max(opposite, distance(got, other[b]) / one[b].getScalar());
        }
      }
      EXPECT_LT(worst, 1e-5) << bands << " bands, " << asked->description();
      EXPECT_GT(opposite, 0.1);  // control
    }
  }
}

RC_GTEST_PROP(RayleighSkyInvariant, SunAndSkyTurnTogether, ()) {
  const double turn = *rc::gen::inRange(0, 3600) / 10.0,
               zenith = *rc::gen::inRange(1, 900) / 10.0,
               phi = *rc::gen::inRange(0, 3600) / 10.0;
  const RayleighSky::Air air = RayleighSky::clearAir(grid, 0.2);
  static const RayleighSky still(sunFrom(50, 120), air);
  const RayleighSky turned(sunFrom(50, 120 + turn), air);
  const Spectrum a = ask(still, compassDirection(zenith * degree, phi * degree));
  const Spectrum b = ask(turned, compassDirection(zenith * degree, (phi + turn) * degree));
  for (std::size_t i = 0; i < 3; ++i) RC_ASSERT(distance(a[i], b[i]) < 1e-13);
}

// Light from the side is polarised across the plane of scattering, whatever the axes: the electric
// field is nearly perpendicular to the sun. In the thin air of 700 nm within two degrees.
TEST(RayleighSkyIdentity, TheFieldIsPerpendicularToTheSun) {
  const Sun sun = sunFrom(60, 200);
  const RayleighSky sky(sun, RayleighSky::clearAir(grid, 0));
  for (const double azimuth : {80.0, 110.0, 290.0, 320.0}) {
    const CDVector d = compassDirection(50 * degree, azimuth * degree);
    const CDStokesVector light = ask(sky, d)[2];
    const RayFrame frame = rayFrame(-d, up);
    const CDVector field =
        std::cos(light.getAoLP()) * frame.s + std::sin(light.getAoLP()) * frame.p;
    EXPECT_LT(std::abs(dot(field, sun.to_sun)), std::sin(2 * degree)) << azimuth;
    const CDVector mirrored =
        std::cos(light.getAoLP()) * frame.s - std::sin(light.getAoLP()) * frame.p;
    EXPECT_GT(std::abs(dot(mirrored, sun.to_sun)), 0.2) << azimuth;  // the other sign of S2
  }
}

TEST(RayleighSkyIdentity, TheZenithJoinsItsNeighbourhood) {
  const RayleighSky sky(sunFrom(60, 200), RayleighSky::clearAir(grid, 0.3));
  const CDVector near = normalized({-1e-7, 0, 1});  // from the west: travels towards +x
  EXPECT_LT(distance(ask(sky, up)[0], ask(sky, near)[0]), 1e-6);
  const RayleighSky overhead(sunFrom(0, 0), RayleighSky::clearAir(grid, 0.3));
  EXPECT_LT(ask(overhead, up)[0].getDOLP(), 1e-12);
}

// Coulson 1988, ch. 5: Babinet's and Brewster's points lie some ten to twenty degrees above and below
// the sun, Arago's above the antisolar point; multiple scattering, bluer light, moves them away.
TEST(RayleighSkyPublished, NeutralPoints) {
  const auto one = SpectralGrid::make({450.0});
  // the zero of S1 in the principal plane between two zenith angles; negative: beyond the zenith
  const auto neutral = [&](double sun_zenith_deg, double a, double b) {
    const Sun sun{compassDirection(sun_zenith_deg * degree, 180 * degree), Spectrum(one, 1.0)};
    const RayleighSky sky(sun, RayleighSky::clearAir(one, 0));
    const auto s1 = [&](double zenith_deg) {
      const CDVector d =
          compassDirection(std::abs(zenith_deg) * degree, (zenith_deg < 0 ? 0 : 180) * degree);
      return ask(sky, d)[0].getStokes(1);
    };
    EXPECT_LT(s1(a) * s1(b), 0) << a << ' ' << b;
    for (int i = 0; i < 40; ++i) (s1(a) * s1((a + b) / 2) > 0 ? a : b) = (a + b) / 2;
    return a;
  };
  const double babinet = 70 - neutral(70, 30, 69.9), brewster = neutral(45, 45.1, 89.9) - 45;
  const double low_arago =
      95 + neutral(85, -50, -89.9);  // the antisolar point: 5 deg below the horizon
  for (const double degrees : {babinet, brewster, low_arago}) {
    EXPECT_GT(degrees, 10);
    EXPECT_LT(degrees, 25);
  }
}

TEST(RayleighSkyInvariant, TheSunIsDimmedByTheSameAir) {
  const RayleighSky sky(sunFrom(60, 200), RayleighSky::clearAir(grid, 0));
  const Sun sun = sky.sunAtGround();
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_NEAR(sun.irradiance[b].getScalar() * 0.5, sky.light(b).directFlux(),
                1e-15);  // cos 60 deg
  EXPECT_LT(sun.irradiance[0].getScalar(), sun.irradiance[2].getScalar());
}

TEST(RayleighSkyInvariant, DrawsInProportionToBrightness) {
  const RayleighSky sky(sunFrom(75, 200), RayleighSky::clearAir(grid, 0));
  double least = 1e9, most = 0, flux = 0;
  const int n = 100;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Sky::Sample drawn = sky.sample((i + 0.5) / n, (j + 0.5) / n);
      const double value = bandMean(sky, drawn.to_sky) / drawn.density;
      least = std::min(least, value), most = std::max(most, value);
      flux += value * drawn.to_sky.z / (n * n);
    }
  EXPECT_LT(most / least, 3);  // uniform drawing: the sky itself varies by more than ten
  double exact = 0;
  for (std::size_t b = 0; b < 3; ++b) exact += sky.light(b).diffuseDown() / 3;
  EXPECT_NEAR(flux / exact, 1, 2e-3);  // midpoints of 10^4 cells
}

TEST(RayleighSkyIdentity, BelowTheHorizonLiesTheGround) {
  const RayleighSky sky(sunFrom(30, 0), RayleighSky::clearAir(grid, 0.4));
  const Spectrum below = ask(sky, normalized({0.3, 0.1, -0.2}));
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_EQ(distance(below[b], CDStokesVector(sky.light(b).groundRadiance(), 0, 0, 0)), 0);
}

// From above the atmosphere down to the ground the haze gives the light that goes up at the top: the
// same integral, with Gauss's rule over an exponential of height. A scale height of 1 m makes 60 m
// outer space. Thin paths are summed exactly; here the whole atmosphere is one path, in pieces.
TEST(RayleighSkyPathRadianceInvariant, TheWholeAtmosphereIsAPath) {
  const auto sky =
      std::make_shared<RayleighSky>(sunFrom(40, 90), RayleighSky::clearAir(grid, 0.3));
  const RayleighPathRadiance haze(sky, 0, 1);
  const CDVector d = compassDirection(35 * degree, 20 * degree);  // to the camera
  Spectrum light(grid);
  for (std::size_t b = 0; b < 3; ++b) light[b] = CDStokesVector(sky->light(b).groundRadiance());
  CDVector here{0, 0, 0};
  for (int piece = 0; piece < 400; ++piece) {
    const CDVector next = here + (0.1 / d.z) * d;
    haze.apply(here, next, light);
    here = next;
  }
  for (std::size_t b = 0; b < 3; ++b) {
    // travel azimuth: the light goes to the camera's side, compass 20; the sunbeam travels to 270
    const CDStokesVector exact =
        sky->light(b).up(d.z, Azimuth::fromRadians((20 - 270) * degree));
    // the source has a term (T - t) ln(T - t) at the ground, which Gauss's rule meets in one piece
    EXPECT_LT(distance(light[b], exact), 1e-7) << b;
    EXPECT_GT(
        distance(light[b], sky->light(b).up(d.z, Azimuth::fromRadians((270 - 20) * degree))),
        1e-4);
  }
}

// A hundred metres of air in one piece or in ten; up, down and level; nothing on a path of no length.
TEST(RayleighSkyPathRadianceInvariant, PathsCompose) {
  const auto sky =
      std::make_shared<RayleighSky>(sunFrom(40, 90), RayleighSky::clearAir(grid, 0.3));
  const RayleighPathRadiance haze(sky);
  for (const CDVector& b : {CDVector{10, 20, 1000}, CDVector{10, 20, -900}, CDVector{900, 0, 0},
                            CDVector{900, 0, 1e-6}}) {
    const CDVector a{0, 0, 1000}, end = a + b, middle = a + 0.3 * b;
    Spectrum whole(grid, CDStokesVector(0.1, 0.02, 0, 0)), parts = whole, none = whole;
    haze.apply(a, end, whole);
    haze.apply(a, middle, parts);
    haze.apply(middle, end, parts);
    haze.apply(a, a, none);
    EXPECT_LT(distance(whole[0], parts[0]), 1e-8);  // as above
    EXPECT_EQ(distance(none[0], CDStokesVector(0.1, 0.02, 0, 0)), 0);
    EXPECT_GT(distance(whole[0], none[0]), 1e-6);
  }
}

TEST(RayleighSkyInvariant, RefusesTheImpossible) {
  EXPECT_THROW(RayleighSky(sunFrom(90.1, 0), RayleighSky::clearAir(grid, 0)), MathError);
  EXPECT_THROW(RayleighSky(sunFrom(30, 0), RayleighSky::clearAir(grid, 1.1)), MathError);
  EXPECT_THROW(
      RayleighSky(sunFrom(30, 0), RayleighSky::clearAir(SpectralGrid::make({500.0}), 0)),
      GridError);
  EXPECT_THROW(RayleighPathRadiance(nullptr), MathError);
  const auto sky =
      std::make_shared<RayleighSky>(sunFrom(30, 0), RayleighSky::clearAir(grid, 0.4));
  for (const double height : {-1.0, 0.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(RayleighPathRadiance(sky, 0, height), MathError) << height;
  EXPECT_THROW(RayleighPathRadiance(sky, std::nan("")), MathError);
  EXPECT_NO_THROW(RayleighPathRadiance(sky, 0, 8000));
}
