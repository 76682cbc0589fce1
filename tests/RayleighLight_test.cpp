// The exact sky of a Rayleigh atmosphere (nw/air/RayleighLight.nw, nw/air/RayleighOperators.nw).
#include "malus/air/RayleighLight.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/CDVector.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
using Azimuth = RayleighLight::Azimuth;

struct Printed {
  double depth, rho, albedo, irradiance, sun, view, phi, observer, value[3], tolerance;
  bool up;
  std::string source;
};

std::vector<Printed> printedValues() {
  const Table table = Table::read("validation/printed/rayleigh.csv");
  std::vector<Printed> all;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto number = [&](const char* column) { return table.number(row, column); };
    all.push_back({number("tau"),
                   number("rho_depol"),
                   number("albedo"),
                   number("F0"),
                   number("mu0"),
                   number("mu"),
                   number("phi_deg") * degree,
                   number("tau_obs"),
                   {number("I"), number("Q"), number("U")},
                   number("tol_abs"),
                   table.cell(row, "dir") == "UP",
                   table.cell(row, "source")});
  }
  return all;
}

CDStokesVector computed(const Printed& p, double phi_sign = 1) {
  const RayleighAtmosphere air(p.depth, p.rho);
  const RayleighLight light(air, p.sun, p.albedo, p.irradiance);
  const Azimuth azimuth = Azimuth::fromRadians(phi_sign * p.phi);
  const CDStokesVector value =
      p.up ? light.up(p.view, azimuth, p.observer) : light.down(p.view, azimuth, p.observer);
  return convertSky(value, SkyConvention::malus,
                    SkyConvention::iprt);  // the file's convention
}

double worst(const CDStokesVector& ours, const Printed& p) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(ours.getStokes(k) - p.value[k]));
  return most;
}
}  // namespace

// Natraj, Li and Yung 2009: eight decimals, so half a unit of the last is 5e-9; our own numerics add
// below 1e-9. IPRT A2 (PSTAR's values): the tolerance is the spread of the codes, in the file.
TEST(RayleighLightPublished, EveryPrintedValue) {
  const std::vector<Printed> all = printedValues();
  int natraj = 0, iprt = 0, with_u = 0;
  for (const Printed& p : all) {
    const bool eight_digits = p.source == "natraj2009";
    EXPECT_LT(worst(computed(p), p), eight_digits ? 6e-9 : p.tolerance)
        << p.source << " tau " << p.depth << " mu0 " << p.sun << " mu " << p.view;
    ++(eight_digits ? natraj : iprt), with_u += p.value[2] != 0;
  }
  EXPECT_EQ(natraj, 40);
  EXPECT_EQ(iprt, 8);
  EXPECT_GT(with_u, 25);  // or the sign of U and the terms in B and D would not be seen
}

TEST(RayleighLightPublished, NegativeControlTheOtherAzimuthHasTheOtherU) {
  int seen = 0, differs = 0;
  for (const Printed& p : printedValues())
    if (p.value[2] != 0) ++seen, differs += worst(computed(p, -1), p) > 100 * p.tolerance;
  EXPECT_EQ(differs, seen);
}

// IPRT case A1, three depolarisation ratios: the models agree to 1.1e-6 of I; half a digit of ours more.
TEST(RayleighLightPublished, IprtCaseA1) {
  const Table table = Table::read("validation/printed/iprt_a1.csv");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto number = [&](const char* column) { return table.number(row, column); };
    const bool up = table.cell(row, "dir") == "UP";
    const auto light = [&](double rho, double sign) {
      const RayleighLight made(RayleighAtmosphere(0.5, rho), std::cos(number("sza") * degree),
                               0, 1);
      const Azimuth azimuth =
          Azimuth::fromRadians(sign * (number("vaa") - number("saa")) * degree);
      const double mu = std::min(1.0, std::abs(std::cos(number("vza") * degree)));
      return convertSky(up ? made.up(mu, azimuth) : made.down(mu, azimuth),
                        SkyConvention::malus, SkyConvention::iprt);
    };
    const char* const names[]{"I", "Q", "U"};
    const auto off = [&](const CDStokesVector& ours) {
      double most = 0;
      for (int k = 0; k < 3; ++k)
        most = std::max(most, std::abs(ours.getStokes(k) - number(names[k])));
      return most / number("I");
    };
    EXPECT_LT(off(light(number("rho_depol"), 1)), 1.3e-6) << row;
    EXPECT_GT(off(light(number("rho_depol") + 0.01, 1)), 1e-4) << row;  // controls
    if (number("U") != 0) {
      EXPECT_GT(off(light(number("rho_depol"), -1)), 1e-2) << row;
    }
  }
}

// Kokhanovsky et al. 2010, molecular case, down to 89 degrees: the authors claim six digits and
// print seven.
TEST(RayleighLightPublished, KokhanovskysMolecularLayer) {
  const Table table = Table::read("validation/printed/kokhanovsky2010.csv");
  const RayleighLight light(RayleighAtmosphere(0.3262), 0.5, 0, 2 * pi);  // pi / mu0
  int with_u = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double mu = std::cos(table.number(row, "vza_deg") * degree);
    const Azimuth azimuth = Azimuth::fromRadians(table.number(row, "phi_deg") * degree);
    const CDStokesVector ours =
        table.cell(row, "dir") == "UP" ? light.up(mu, azimuth) : light.down(mu, azimuth);
    const double I = table.number(row, "I"), tolerance = 1e-6 * I;
    EXPECT_NEAR(ours.getStokes(0), I, tolerance) << row;
    EXPECT_NEAR(ours.getStokes(1), table.number(row, "minus_Q"), tolerance) << row;
    EXPECT_GT(std::abs(ours.getStokes(0) * 1.00001 - I), tolerance) << row;  // control
    if (table.cell(row, "U").empty()) continue;
    EXPECT_NEAR(ours.getStokes(2), table.number(row, "U"), tolerance) << row;
    ++with_u;
  }
  EXPECT_EQ(with_u, 6);
}

// The two ways of integrating along the line must agree: they share nothing but the solution's nodes.
RC_GTEST_PROP(RayleighLightInvariant, BothWaysAlongTheLineAgree, ()) {
  const double depth = std::pow(10.0, *rc::gen::inRange(-40, 4) / 10.0),
               sun = *rc::gen::inRange(5, 101) / 100.0;
  const double view = *rc::gen::inRange(2, 101) / 100.0;
  const Azimuth azimuth = Azimuth::fromRadians(*rc::gen::inRange(0, 628) / 100.0);
  const RayleighLight light(RayleighAtmosphere(depth, 0.03), sun, 0.3, pi);
  for (int k = 0; k < 3; ++k) {
    // the solution's own accuracy at these angles, see the chapter
    RC_ASSERT(std::abs(light.down(view, azimuth).getStokes(k) -
                       light.down(view, azimuth, depth).getStokes(k)) < 3e-8);
    RC_ASSERT(std::abs(light.up(view, azimuth).getStokes(k) -
                       light.up(view, azimuth, 0).getStokes(k)) < 3e-8);
  }
}

RC_GTEST_PROP(RayleighLightInvariant, EnergyIsBalanced, ()) {
  const double depth = std::pow(10.0, *rc::gen::inRange(-40, 4) / 10.0),
               sun = *rc::gen::inRange(5, 101) / 100.0;
  const double albedo = *rc::gen::inRange(0, 11) / 10.0, rho = *rc::gen::inRange(0, 10) / 100.0;
  const RayleighLight light(RayleighAtmosphere(depth, rho), sun, albedo, pi);
  const double brought = sun * pi,
               absorbed = (1 - albedo) * (light.directFlux() + light.diffuseDown());
  RC_ASSERT(std::abs(brought - absorbed - light.diffuseUp()) < 1e-8);  // as above, times pi
  RC_ASSERT(std::abs(brought - absorbed * 1.001 - light.diffuseUp()) > 1e-8 ||
            albedo == 1);  // control
}

// White ground under ordinary suns: the demanded 1e-10.
TEST(RayleighLightInvariant, EnergyOverWhiteGround) {
  for (const double depth : {1e-4, 0.02, 0.1, 0.5, 1.0, 2.0})
    for (const double sun : {0.2, 0.5, 0.9, 1.0}) {
      const RayleighLight light(RayleighAtmosphere(depth, 0.03), sun, 1, 1);
      EXPECT_NEAR(light.diffuseUp(), sun, 1e-10) << depth << ' ' << sun;
      EXPECT_NEAR(light.groundRadiance() * pi, light.directFlux() + light.diffuseDown(), 1e-10);
    }
}

// The flux is also the integral of the radiance over the hemisphere: a midpoint rule in azimuth, which
// is exact for three harmonics, and Simpson's in the cosine squared, whose error near the horizon
// (mu ln mu) is of the order of the step squared.
TEST(RayleighLightInvariant, FluxIsTheIntegralOfRadiance) {
  const RayleighLight light(RayleighAtmosphere(0.3, 0.03), 0.6, 0.25, pi);
  const int steps = 2000;
  double flux = 0;
  for (int i = 0; i <= steps; ++i) {
    const double x = static_cast<double>(i) / steps, mu = x * x;  // mu dmu = 2 x^3 dx
    double mean = 0;
    for (int j = 0; j < 4; ++j)
      mean += light.down(mu, Azimuth::fromRadians(pi / 4 + j * pi / 2)).getScalar() / 4;
    flux += (i == 0 || i == steps ? 1.0
             : i % 2              ? 4.0
                                  : 2.0) /
            (3 * steps) * mean * 2 * x * x * x;
  }
  EXPECT_NEAR(2 * pi * flux, light.diffuseDown(), 1e-8);
}

// T -> 0: the single scattering of the chapter's first equation, as vectors: unpolarised sunlight as two
// fields, each projected onto our line of sight. The next order is smaller by T.
TEST(RayleighLightIdentity, ThinAirScattersOnce) {
  const double depth = 1e-4, view = 0.6, sun = 0.4;
  const RayleighLight light(RayleighAtmosphere(depth), sun, 0, 1);
  for (double phi = 0; phi < 360; phi += 25) {
    // clockwise azimuths: x to the north, y to the east, seen from above; travel directions
    const auto travel = [](double cosine, double azimuth) {
      const double s = std::sqrt(1 - cosine * cosine);
      return CDVector{s * std::cos(azimuth), -s * std::sin(azimuth), -cosine};
    };
    const RayFrame beam = rayFrame(travel(sun, 0), {0, 0, 1}),
                   line = rayFrame(travel(view, phi * degree), {0, 0, 1});
    double s[3]{};
    for (const CDVector& field : {beam.s, beam.p}) {
      const double a = dot(field, line.s), b = dot(field, line.p);
      s[0] += a * a + b * b, s[1] += a * a - b * b, s[2] += 2 * a * b;
    }
    const double path =
        (std::exp(-depth / sun) - std::exp(-depth / view)) / (1 / view - 1 / sun) / view;
    const CDStokesVector sky = light.down(view, Azimuth::fromRadians(phi * degree));
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(sky.getStokes(k), 3 / (16 * pi) * s[k] * path,
                  20 * depth * 3 / (16 * pi) * path)
          << phi << ' ' << k;
    EXPECT_GT(std::abs(sky.getStokes(0) - 3 / (16 * pi) * s[0] * path * 1.01),
              20 * depth * 3 / (16 * pi) * path);
  }
}

// Helmholtz: exchange sun and viewer of the light that leaves the top, turn the Stokes vector's S2
// (the axes p of the two rays are mirror images), and the intensity is the same.
RC_GTEST_PROP(RayleighLightInvariant, SunAndViewerMayBeExchanged, ()) {
  const double depth = *rc::gen::inRange(1, 20) / 10.0, a = *rc::gen::inRange(10, 101) / 100.0,
               b = *rc::gen::inRange(10, 101) / 100.0;
  const Azimuth azimuth = Azimuth::fromRadians(*rc::gen::inRange(0, 314) / 100.0);
  const RayleighAtmosphere air(depth, 0.03);
  // reflected radiance is (cosine of the sun) x irradiance x a symmetric function
  const double there = RayleighLight(air, a, 0.3, 1).up(b, azimuth).getScalar() / a;
  const double back = RayleighLight(air, b, 0.3, 1).up(a, azimuth).getScalar() / b;
  RC_ASSERT(std::abs(there - back) < 1e-7);
}

// An observer inside: the light that comes down to depth t in an atmosphere T is neither that of T nor
// that of t alone, but for black ground the two halves must add up: what goes down at t minus what goes
// up, plus the beam, is the same flux at every depth (nothing is absorbed).
TEST(RayleighLightInvariant, TheNetFluxDoesNotDependOnDepth) {
  const RayleighLight light(RayleighAtmosphere(0.5, 0.03), 0.7, 0.4, pi);
  const auto net = [&](double depth) {
    const int steps = 400;
    double flux = 0.7 * pi * std::exp(-depth / 0.7);
    for (int i = 0; i <= steps; ++i) {
      const double x = static_cast<double>(i) / steps, mu = x * x;
      double mean = 0;
      for (int j = 0; j < 4; ++j) {
        const Azimuth azimuth = Azimuth::fromRadians(pi / 4 + j * pi / 2);
        mean += (light.down(mu, azimuth, depth).getScalar() -
                 light.up(mu, azimuth, depth).getScalar()) /
                4;
      }
      flux += 2 * pi *
              (i == 0 || i == steps ? 1.0
               : i % 2              ? 4.0
                                    : 2.0) /
              (3 * steps) * mean * 2 * x * x * x;
    }
    return flux;
  };
  const double top = 0.7 * pi - light.diffuseUp();
  for (const double depth : {0.0, 0.1, 0.25, 0.5})
    EXPECT_NEAR(net(depth), top, 2e-6) << depth;  // Simpson, mu ln mu
}

// A method without any integral equation: photons with fields as vectors. Each photon carries a unit
// field E; a dipole along E radiates along n with probability proportional to |n x E|^2, with the field's
// projection. (No depolarisation.) Forced first collision; estimates along the line of sight.
TEST(RayleighLightInvariant, PhotonsFollowedOneByOneAgree) {
  const double depth = 0.5, sun = 0.5, view = 0.8, phi = 50 * degree;
  const RayleighLight light(RayleighAtmosphere(depth), sun, 0, 1);
  const CDStokesVector expected = light.down(view, Azimuth::fromRadians(phi));
  const double ss = std::sqrt(1 - sun * sun), sv = std::sqrt(1 - view * view);
  const CDVector beam{ss, 0, -sun}, line{sv * std::cos(phi), -sv * std::sin(phi), -view};
  const RayFrame start = rayFrame(beam, {0, 0, 1}), seen = rayFrame(line, {0, 0, 1});
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform;
  const int photons = 200000;
  double sum[3]{}, squares[3]{};
  for (int photon = 0; photon < photons; ++photon) {
    const double turn = 2 * pi * uniform(engine);
    CDVector k = beam, field = std::cos(turn) * start.s + std::sin(turn) * start.p;
    const double weight = 1 - std::exp(-depth / sun);
    double t = -sun * std::log(1 - uniform(engine) * weight), score[3]{};
    for (int order = 0; order < 200; ++order) {
      // towards the observer: per steradian 3/(8 pi) |projected field|^2, attenuated; per unit of
      // horizontal area the flux is sun * 1, and radiance divides by the cosine of the line
      const double w = weight * sun * 3 / (8 * pi) * std::exp(-(depth - t) / view) / view;
      const double a = dot(field, seen.s), b = dot(field, seen.p);
      score[0] += w * (a * a + b * b), score[1] += w * (a * a - b * b),
          score[2] += w * 2 * a * b;
      for (;;) {  // rejection: |n x E|^2 = 1 - (n.E)^2
        const double z = 2 * uniform(engine) - 1, r = std::sqrt(1 - z * z),
                     angle = 2 * pi * uniform(engine);
        k = {r * std::cos(angle), r * std::sin(angle), z};
        if (uniform(engine) < 1 - dot(k, field) * dot(k, field)) break;
      }
      field = normalized(field - dot(field, k) * k);
      t += k.z * std::log(1 - uniform(engine));  // down is -z: t grows by -z * path
      if (t < 0 || t > depth) break;
    }
    for (int i = 0; i < 3; ++i) sum[i] += score[i], squares[i] += score[i] * score[i];
  }
  for (int i = 0; i < 3; ++i) {
    const double mean = sum[i] / photons,
                 error = std::sqrt((squares[i] / photons - mean * mean) / photons);
    EXPECT_NEAR(mean, expected.getStokes(i), 4 * error) << i;  // three comparisons, fixed seed
    EXPECT_LT(error, 0.01 * expected.getScalar());
  }
}

// A sun that grazes the top. What comes in must go out over white ground, and what the sun makes along a line must be what
// the line's sun would make along the sun's (Helmholtz), where the grazing direction is a line of sight, which no beam
// between two nodes disturbs. 2e-6 of the flux is what the nodes keep of the logarithm at the top, 1e-5 of the radiance
// what they keep at the flattest lines; all radiances are positive.
TEST(RayleighLightInvariant, AGrazingSun) {
  for (const double depth : {0.001, 0.05, 0.5, 2.0, 16.0}) {
    const RayleighAtmosphere air(depth, 0.03);
    for (const double sun : {0.03, 0.003, 1e-4, 1e-5, 1e-7, 1e-9}) {
      const RayleighLight light(air, sun, 1, pi);
      EXPECT_NEAR(light.diffuseUp() / (pi * sun), 1, 2e-6) << depth << ' ' << sun;
      for (const double mu : {1e-6, 1e-3, 0.02, 0.5, 1.0}) {
        const RayleighLight other(air, mu, 1, pi);
        for (const double phi : {0.0, 1.0, 3.0}) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          const double there = light.up(mu, azimuth).getScalar() / sun,
                       back = other.up(sun, azimuth).getScalar() / mu;
          EXPECT_NEAR(there / back, 1, 1e-5) << depth << ' ' << sun << ' ' << mu;
          EXPECT_GT(light.up(mu, azimuth).getScalar(), 0);
          EXPECT_GE(light.down(mu, azimuth).getScalar(), 0);
          EXPECT_GE(light.down(mu, azimuth, depth / 2).getScalar(), 0);
        }
      }
    }
  }
  // control: a sun other than the given one does not keep the balance
  const RayleighAtmosphere air(0.05);
  EXPECT_GT(std::abs(RayleighLight(air, 1.001e-4, 1, pi).diffuseUp() / (pi * 1e-4) - 1), 2e-6);
}

// Suns that are treated apart and suns that are not meet: 0.05 of the optical depth is the border, and the change across
// it is that of the sun, a relative 1e-9, and twice the 1e-9 that the nodes leave of a beam.
TEST(RayleighLightIdentity, TheTwoWaysOfABeamMeet) {
  for (const double depth : {0.5, 2.0, 16.0}) {
    const RayleighAtmosphere air(depth, 0.03);
    const double border = 0.05 * depth;
    const RayleighLight low(air, border * (1 - 1e-9), 0.3, pi), high(air, border, 0.3, pi);
    for (const double mu : {0.005, 0.1, 0.9}) {
      const auto azimuth = RayleighLight::Azimuth::fromRadians(1);
      for (const double at : {0.0, 0.01 * depth, 0.5 * depth, depth})
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(low.down(mu, azimuth, at).getStokes(k),
                      high.down(mu, azimuth, at).getStokes(k), 2e-9);
          EXPECT_NEAR(low.up(mu, azimuth, at).getStokes(k),
                      high.up(mu, azimuth, at).getStokes(k), 2e-9);
        }
      EXPECT_NEAR(low.source(0.3 * depth).a, high.source(0.3 * depth).a, 2e-9);
    }
    // a flux of 2.5 would show the sun's own 1e-9: compare per light that enters
    EXPECT_NEAR(low.diffuseDown() / (1 - 1e-9), high.diffuseDown(), 2e-9);
    EXPECT_NEAR(low.diffuseUp() / (1 - 1e-9), high.diffuseUp(), 2e-9);
  }
}

// So little air overhead that its square is zero in double precision.
TEST(RayleighLightIdentity, TheSmallestDepthIsTheTop) {
  const RayleighLight light(RayleighAtmosphere(0.5), 0.6, 0.2, pi);
  const auto azimuth = RayleighLight::Azimuth::fromRadians(1);
  for (const double depth : {5e-324, 1e-300, 1e-40}) {
    EXPECT_EQ(light.up(0.5, azimuth, depth).getScalar(), light.up(0.5, azimuth, 0).getScalar());
    EXPECT_LT(light.down(0.5, azimuth, depth).getScalar(), 1e-39);
  }
}

TEST(RayleighLightInvariant, RefusesTheImpossible) {
  for (const double depth : {0.0, -1.0, 17.0, std::nan("")})
    EXPECT_THROW(RayleighAtmosphere{depth}, MathError);
  EXPECT_THROW(RayleighAtmosphere(0.1, 1), MathError);
  EXPECT_THROW(RayleighAtmosphere(0.1, -0.1), MathError);
  const RayleighAtmosphere air(0.1);
  for (const double sun : {0.0, -0.1, 1.1, std::nan("")})
    EXPECT_THROW(RayleighLight(air, sun, 0, 1), MathError);
  EXPECT_THROW(RayleighLight(air, 0.5, 1.01, 1), MathError);
  EXPECT_THROW(RayleighLight(air, 0.5, 0, -1), MathError);
  for (const double irradiance : {0.0, 0.5})
    EXPECT_NO_THROW(RayleighLight(air, 0.5, 0, irradiance));
  const RayleighLight light(air, 0.5, 0.2, 1);
  EXPECT_THROW(light.down(-0.1, {}), MathError);
  EXPECT_THROW(light.up(1.1, {}), MathError);
  EXPECT_THROW(light.down(0.5, {}, 0.2), MathError);
  EXPECT_NO_THROW(light.down(0, {}));
}

// Flat lines of sight tend to the source at the observer.
TEST(RayleighLightIdentity, TheHorizonIsALimit) {
  const RayleighLight light(RayleighAtmosphere(0.3, 0.03), 0.5, 0.2, pi);
  const double limit = light.down(0, {}).getScalar();
  EXPECT_NEAR(light.down(1e-9, {}).getScalar(), limit, 1e-6);
  EXPECT_GT(std::abs(light.down(0.02, {}).getScalar() - limit), 1e-4);  // and it does move
  // across the change of method
  EXPECT_NEAR(light.down(0.02 - 1e-12, {}).getScalar(), light.down(0.02, {}).getScalar(), 1e-8);
}
