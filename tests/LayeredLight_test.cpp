// Light in layers by successive orders: against two other methods, printed values, balances and brute force
// (nw/air/LayeredLight.nw).
#include "malus/air/LayeredLight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ScatteredOnce.hpp"
#include "malus/air/Mie.hpp"
#include "malus/air/RayleighLight.hpp"
#include "malus/air/SizeLaws.hpp"
#include "malus/air/Sky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Refusal.hpp"
#include "malus/base/Table.hpp"
#include "malus/surface/BRDFNadalBreon.hpp"
#include "malus/surface/BRDFRoughWater.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"

using namespace malus;
using malus::testing::apart;
using malus::testing::scattered;

namespace {
constexpr double pi = std::numbers::pi;
Scatterer spheroids() {
  return Scatterer::read(Table::read("scenes/data/aerosol-spheroids.csv"));
}
Scatterer droplets() {
  return Scatterer::read(Table::read("validation/printed/iprt-droplets.csv"));
}
AirGround copper() {
  return {0, std::make_shared<BRDFTorranceSparrow>(
                 0.405, 2.95, 0.3,
                 TorranceSparrowOptions{Shadowing::vGroove, DiffuseTerm::reciprocal})};
}
CDSpectralVector<double> oneBand(double value) { return {SpectralGrid::make({550.0}), value}; }
AirGround lawn() { return {0, std::make_shared<BRDFNadalBreon>(oneBand(0.04), 0.03, 8.0)}; }
AirGround sea() {
  return {0, std::make_shared<BRDFRoughWater>(oneBand(0.02), WaterState{8, 15, 35, true})};
}
const std::vector<double> flat_and_steep{0.02, 0.05, 0.2, 0.7, 1.0};
constexpr std::array names{"0", "0.125", "0.25", "0.5", "0.75", "0.875", "1"};
}  // namespace

// 1e-8 of an irradiance of pi, over the grid of depths, suns and grounds that adding and doubling is held to.
TEST(LayeredLightInvariant, AgreesWithTheCoherencyTensor) {
  const auto largest = [](double depth, double sun, double albedo,
                          const LayeredLightAccuracy& accuracy) {
    const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, albedo, pi);
    const std::vector<double> inside{0, 0.02 * depth, 0.5 * depth, depth};
    const LayeredLight light({{{rayleighScatterer(0.03), depth}}}, sun, {albedo}, pi,
                             flat_and_steep, inside, accuracy);
    double most = std::abs(light.diffuseDown(3) - exact.diffuseDown());
    for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
      for (const double phi : {0.0, 1.0, 2.5})
        for (std::size_t k = 0; k < inside.size(); ++k) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          const double mu = flat_and_steep[v];
          most =
              std::max({most, apart(light.down(v, phi, k), exact.down(mu, azimuth, inside[k])),
                        apart(light.up(v, phi, k), exact.up(mu, azimuth, inside[k]))});
        }
    return most;
  };
  for (const double depth : {0.001, 0.01, 0.2, 1.0, 10.0})
    for (const double sun : {0.02, 0.2, 1.0})
      for (const double albedo : {0.0, 1.0})
        EXPECT_LT(largest(depth, sun, albedo, {}), 1e-8)
            << "tau " << depth << " mu0 " << sun << " albedo " << albedo;
  EXPECT_GT(largest(0.2, 0.2, 0, {.streams = 8}), 1e-8);  // control
  EXPECT_GT(largest(0.2, 0.2, 0, {.remainder = 1e-3}), 1e-8);
}

// Haze under air, with absorption, over matt ground: adding and doubling shares streams and
// rotations, and nothing else. At cosines from 0.2 on both have an accuracy of 1e-8.
TEST(LayeredLightInvariant, AgreesWithAddingAndDoubling) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.1}},
                                     {{spheroids(), 0.5, 0.9}, {rayleighScatterer(0.03), 0.2}},
                                     {{rayleighScatterer(0.03), 0.05, 0}}};
  const std::vector<double> views{0.2, 0.5, 0.95}, depths{0, 0.3, 0.85};
  const LayeredLight light(layers, 0.6, {0.3}, pi, views, depths);
  const AddingDoubling doubled(layers, 0.6, 0.3, pi, views, {}, depths);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double phi : {0.0, 1.0, 4.0})
      for (std::size_t k = 0; k < depths.size(); ++k) {
        EXPECT_LT(apart(light.down(v, phi, k), doubled.down(v, phi, k)), 1e-8) << v << phi << k;
        EXPECT_LT(apart(light.up(v, phi, k), doubled.up(v, phi, k)), 1e-8) << v << phi << k;
      }
  EXPECT_GT(light.up(1, 1, 0).getStokes(3) * light.up(1, 1, 0).getStokes(3), 1e-14);
  const std::vector<AirLayer> swapped{layers[1], layers[0], layers[2]};  // control
  const LayeredLight other(swapped, 0.6, {0.3}, pi, views, {0});
  EXPECT_GT(apart(other.up(0, 1, 0), light.up(0, 1, 0)), 1e-4);
}

// Siewert's layer of spheroids, all four components at seven depths: half a unit of the sixth digit of the largest values.
TEST(LayeredLightPrinted, SiewertsSpheroids) {
  const Table printed = Table::read("validation/printed/siewert2000.csv");
  const std::vector<double> mu{0.1, 0.2, 0.3, 0.4, 0.5,
                               0.6, 0.7, 0.8, 0.9, std::cos(1e-4 * degree)};
  const std::vector<double> depths{0, 0.125, 0.25, 0.5, 0.75, 0.875, 1};
  const LayeredLight light({{{spheroids(), 1.0, 0.973527}}}, 0.6, {}, pi, mu, depths);
  double worst = 0;
  for (std::size_t row = 0; row < printed.rows(); ++row) {
    const double signed_mu = printed.number(row, "mu"),
                 phi = -printed.number(row, "phi_deg") * degree;
    const auto view = static_cast<std::size_t>(std::lround(std::abs(signed_mu) * 10)) - 1;
    const auto component =
        static_cast<int>(std::string("IQUV").find(printed.cell(row, "component")));
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const CDStokesVector ours =
          convertSky(signed_mu < 0 ? light.up(view, phi, k) : light.down(view, phi, k),
                     SkyConvention::malus, SkyConvention::iprt);
      worst = std::max(worst, std::abs(ours.getStokes(component) -
                                       printed.number(row, "tau_" + std::string(names[k]))));
    }
  }
  EXPECT_LT(worst, 5.5e-6);
  EXPECT_GT(worst, 1e-9);  // digits were compared
}

// The aerosol and the cloud of Kokhanovsky and others, all components, to 1 % of I: their scattering matrices are sums over
// sizes that differ from Mie's by some tenths of a percent, and by several at right angles of the cloud.
TEST(LayeredLightPublished, KokhanovskysAerosolAndCloud) {
  const Table printed = Table::read("validation/printed/kokhanovsky2010-particles.csv");
  const auto spheres = [](double n, double median_nm, double s) {
    constexpr double nm = 412, largest_nm = 29500;  // as far as Mie's series is summed
    return miePowder(n, 0, logNormalRadii(median_nm, std::exp(s), nm, largest_nm), nm, 1e-9)
        .scatterer;
  };
  const auto worst = [&](const char* name, const AirLayer& layer) {
    std::vector<double> views;
    for (std::size_t row = 0; row < printed.rows(); ++row)
      views.push_back(std::cos(printed.number(row, "vza_deg") * degree));
    const LayeredLight light({layer}, 0.5, {}, 2 * pi, views, {0}, {.thinnest = 1e-4});
    double most = 0, circular = 0;
    for (std::size_t row = 0; row < printed.rows(); ++row) {
      if (printed.cell(row, "case") != name) continue;
      const auto number = [&](const char* column) { return printed.number(row, column); };
      const CDStokesVector ours = light.up(row, number("phi_deg") * degree, 0),
                           theirs(number("I"), number("Q"), number("U"), number("V"));
      most = std::max(most, apart(ours, theirs) / number("I"));
      if (std::abs(number("V")) > 1e-5)
        circular = std::max(circular, std::abs(ours.getStokes(3) / number("V") - 1));
    }
    EXPECT_GT(circular, 0);
    EXPECT_LT(circular, 0.1) << name;
    return most;
  };
  const Scatterer aerosol = spheres(1.385, 300, 0.92);
  EXPECT_LT(worst("aerosol", {{aerosol, 0.3262}}), 0.01);
  EXPECT_LT(worst("cloud", {{spheres(1.339, 5000, 0.4), 5}}), 0.01);
  EXPECT_GT(worst("aerosol", {{spheres(1.4, 300, 0.92), 0.3262}}), 0.01);  // control
}

// All sunlight returns from a white ground, at every height, through a cloud that absorbs
// nothing and air: 1e-7.
TEST(LayeredLightInvariant, EnergyIsConserved) {
  const std::vector<AirLayer> layers{
      {{rayleighScatterer(0.03), 0.2}}, {{droplets(), 8}}, {{spheroids(), 0.4}}};
  const std::vector<double> depths{0, 0.1, 0.2, 3, 8.2, 8.6};
  for (const double sun : {0.2, 0.9}) {
    const LayeredLight light(layers, sun, {1}, pi, {0.5}, depths);
    for (std::size_t k = 0; k < depths.size(); ++k)
      EXPECT_NEAR(
          (light.directFlux(k) + light.diffuseDown(k) - light.diffuseUp(k)) / (pi * sun), 0,
          1e-7)
          << sun << ' ' << depths[k];
    EXPECT_NEAR(light.diffuseUp(0), pi * sun, 1e-7);
    const LayeredLight darker(layers, sun, {0.999}, pi, {0.5}, {0}, {});  // control
    EXPECT_GT(pi * sun - darker.diffuseUp(0), 1e-5);
  }
}

// Sun and viewer may be exchanged: L / mu0 is a symmetric function, in S0, over a surface that is reciprocal too.
TEST(LayeredLightInvariant, SunAndViewerMayBeExchanged) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.2}},
                                     {{spheroids(), 0.4, 0.95}}};
  for (const auto& [a, b] : {std::pair{0.9, 0.3}, {0.5, 0.15}})
    for (const double phi : {0.3, 1.5, 3.0}) {
      const LayeredLight one(layers, a, copper(), 1, {b}, {0}),
          other(layers, b, copper(), 1, {a}, {0});
      const double forth = one.up(0, phi, 0).getScalar() / a,
                   back = other.up(0, phi, 0).getScalar() / b;
      EXPECT_NEAR(forth / back, 1, 2e-6) << a << b << phi;
      EXPECT_GT(std::abs(forth / other.up(0, phi + 1, 0).getScalar() * b - 1), 1e-4);
    }
}

namespace {
/// Travel along the cosine `mu`, upwards positive, at an azimuth counter-clockwise from the sunbeam's.
CDVector travel(double mu, double azimuth) {
  const double s = std::sqrt(1 - mu * mu);
  return {s * std::cos(azimuth), s * std::sin(azimuth), mu};
}
CDStokesVector reflected(const AirGround& ground, const CDStokesVector& light, double in,
                         double out, double azimuth) {
  return CDMuellerMatrix(groundMatrix(ground, in, out, azimuth)) * light;
}
/// What a trace of air, per unit of its depth, adds to the light over a ground, by sums over the hemisphere: to what goes up,
/// less what it takes from the glint, and to what comes down.
class TraceOfAir {
 public:
  TraceOfAir(Scatterer scatterer, AirGround below, double sun_cosine, double azimuth_sense)
      : air(std::move(scatterer)),
        ground(std::move(below)),
        sun(sun_cosine),
        sense(azimuth_sense) {
    const int rings = 20, sectors = 60;
    const GaussRule rule(rings);
    for (std::size_t i = 0; i < rule.at.size(); ++i)
      for (int j = 0; j < sectors; ++j) {
        const double mu = rule.at[i], phi = 2 * pi * (j + 0.5) / sectors;
        ways.push_back({mu, phi, rule.weight[i] * 2 * pi / sectors, glint(mu, phi), {}});
      }
    for (Way& way : ways) way.sky = fallingTimesCosine(way.mu, way.phi);
  }
  CDStokesVector down(double mu, double phi) const {
    return fallingTimesCosine(mu, phi) * (1 / mu);
  }
  CDStokesVector up(double mu, double phi) const {
    const CDVector view = travel(mu, phi);
    CDStokesVector sum =
        scattered(air, {1, 0, 0, 0}, travel(-sun, 0), view) * (1 / (4 * pi * mu));
    sum -= glint(mu, phi) * (1 / sun + 1 / mu);
    for (const Way& way : ways) {
      sum += scattered(air, way.rising, travel(way.mu, way.phi), view) *
             (way.solid / (4 * pi * mu));
      sum += reflected(ground, way.sky, way.mu, mu, sense * (phi - way.phi)) * way.solid;
    }
    return sum;
  }

 private:
  struct Way {
    double mu, phi, solid;
    CDStokesVector rising, sky;  // the glint; what falls, times its cosine
  };
  CDStokesVector glint(double mu, double phi) const {
    return reflected(ground, {1, 0, 0, 0}, sun, mu, sense * phi) * sun;
  }
  CDStokesVector fallingTimesCosine(double mu, double phi) const {
    const CDVector falls = travel(-mu, phi);
    CDStokesVector sum = scattered(air, {1, 0, 0, 0}, travel(-sun, 0), falls);
    for (const Way& way : ways)
      sum += scattered(air, way.rising, travel(way.mu, way.phi), falls) * way.solid;
    return sum * (1 / (4 * pi));
  }
  Scatterer air;
  AirGround ground;
  double sun, sense;
  std::vector<Way> ways;
};
}  // namespace

// Vegetation, a rough sea and copper under a trace of air: light has met the air once, and the ground before it and after
// it or not at all; it is found without harmonics, by vectors and sums over the hemisphere. 2e-3 of the light: the sums' rule.
TEST(LayeredLightInvariant, AnyGroundAndATraceOfAir) {
  const Scatterer air = rayleighScatterer(0.03);
  const double tau = 1e-6, sun = 0.6, mu = 0.5;
  for (const AirGround& ground : {lawn(), sea(), copper()}) {
    const LayeredLight light({{{air, tau}}}, sun, ground, 1, {mu}, {0, tau});
    const TraceOfAir brute(air, ground, sun, 1), wrong(air, ground, sun, -1);
    double most = 0, mirrored = 0;
    for (const double azimuth : {0.4, 1.5, 2.6}) {
      const CDStokesVector glint = reflected(ground, {1, 0, 0, 0}, sun, mu, azimuth) * sun,
                           up = (light.up(0, -azimuth, 0) - glint) * (1 / tau),
                           down = light.down(0, -azimuth, 1) * (1 / tau);
      const double size = down.getScalar();
      most = std::max({most, apart(up, brute.up(mu, azimuth)) / size,
                       apart(down, brute.down(mu, azimuth)) / size});
      mirrored = std::max(mirrored, apart(down, wrong.down(mu, azimuth)) / size);
    }
    EXPECT_LT(most, 2e-3) << ground.surface->name();
    EXPECT_GT(mirrored, 5e-3)
        << ground.surface->name();  // control: the ground's S2 turned about
  }
}

// Over each of them sun and viewer may be exchanged under a haze, in which light is scattered
// and reflected in all orders.
TEST(LayeredLightInvariant, ExchangedOverAnyGround) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.1}, {spheroids(), 0.3}}};
  for (const AirGround& ground : {lawn(), sea(), copper()}) {
    const LayeredLight one(layers, 0.8, ground, 1, {0.35}, {0}),
        other(layers, 0.35, ground, 1, {0.8}, {0});
    for (const double phi : {0.3, 1.5, 3.0}) {
      const double forth = one.up(0, phi, 0).getScalar() / 0.8;
      EXPECT_NEAR(forth / (other.up(0, phi, 0).getScalar() / 0.35), 1, 2e-6)
          << ground.surface->name() << ' ' << phi;
      EXPECT_GT(std::abs(forth / (other.up(0, phi + 1, 0).getScalar() / 0.35) - 1), 1e-4);
    }
  }
}

namespace {
/// Light by four suns, from whose differences the matrices come.
class FourSuns {
 public:
  FourSuns(const std::vector<AirLayer>& layers, double depth, double sun,
           const AirGround& ground, const std::vector<double>& views) {
    for (int l = 0; l < 4; ++l)
      lights_.emplace_back(layers, sun, ground, CDStokesVector(1, l == 1, l == 2, l == 3),
                           views, std::vector<double>{0, depth});
  }
  /// Of what leaves the top, or reaches the ground.
  CDMuellerMatrix operator()(std::size_t view, double phi, bool up) const {
    std::array<double, 16> m{};
    for (std::size_t l = 0; l < 4; ++l) {
      const CDStokesVector seen =
          up ? lights_[l].up(view, phi, 0) : lights_[l].down(view, phi, 1);
      for (std::size_t k = 0; k < 4; ++k)
        m[4 * k + l] = seen.getStokes(static_cast<int>(k)) - (l > 0 ? m[4 * k] : 0);
    }
    return CDMuellerMatrix(m);
  }

 private:
  std::vector<LayeredLight> lights_;
};
std::array<double, 16> elementsOf(const CDMuellerMatrix& m) {
  std::array<double, 16> all{};
  for (int k = 0; k < 16; ++k) all[static_cast<std::size_t>(k)] = m.getMueller(k / 4, k % 4);
  return all;
}
double leastEigenvalue(const CDMuellerMatrix& m) { return coherencyEigenvalues(m)[3]; }
}  // namespace

// All sixteen elements of the reflection of haze over grey ground are those of adding and
// doubling, whose matrices do not depend on a sun; sun and view are streams without weight
// there. Light from S2 and S3 fills the azimuth's other halves.
TEST(LayeredLightInvariant, PolarisedSunsMakeTheMatrixOfDoubling) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.1}},
                                     {{spheroids(), 0.5, 0.9}}};
  const double sun = 0.6, mu = 0.35, phi = 0.7, no_weight = 1e-9;
  const CDMuellerMatrix ours = FourSuns(layers, 0.6, sun, {0.3}, {mu})(0, phi, true);
  Streams streams = squaredStreams(32);
  for (const double cosine : {sun, mu})
    streams.cosines.push_back(cosine), streams.weights.push_back(no_weight);
  const std::size_t rows = 4 * streams.cosines.size(), from = rows - 8, to = rows - 4;
  std::array<double, 16> doubled{};
  for (int m = 0; m < static_cast<int>(spheroids().terms().size()); ++m) {
    const std::vector<double> r = layeredReflection(layers, 0.3, streams, m);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t l = 0; l < 4; ++l) {
        const double turn = -m * phi, sign = l < 2 ? 1 : -1,
                     wave = (k < 2) == (l < 2) ? std::cos(turn) : sign * std::sin(turn);
        doubled[4 * k + l] +=
            (m == 0 ? 1 : 2) / (2 * pi) * wave * r[(from + l) * rows + to + k] / no_weight;
      }
  }
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l)
      EXPECT_NEAR(ours.getMueller(k, l), doubled[static_cast<std::size_t>(4 * k + l)], 1e-7)
          << k << l;
  EXPECT_GT(std::abs(ours.getMueller(0, 2)), 1e-4);  // the other halves are not empty
  EXPECT_GT(std::abs(ours.getMueller(2, 0)), 1e-4);
}

// What air over a ground makes of any light is possible light: no eigenvalue of Cloude's matrix is negative, but for 1e-7 of
// the radiance, which is what the solution keeps. Controls: left and right circular light exchanged; S1 amplified.
TEST(LayeredLightInvariant, TheirMatricesAreRealisable) {
  const std::vector<std::vector<AirLayer>> airs{
      {{{rayleighScatterer(0), 0.2}}},
      {{{rayleighScatterer(0.03), 0.1}}, {{spheroids(), 0.5, 0.9}}},
      {{{rayleighScatterer(0.03), 5}}}};
  const std::vector<double> whole{0.2, 0.6, 5};
  double least = 0, exchanged = 0, amplified = 0;
  const auto look = [&](const CDMuellerMatrix& m) {
    least = std::min(least, leastEigenvalue(m) / m.getScalar());
    std::array<double, 16> turned = elementsOf(m), strong = turned;
    for (std::size_t k = 0; k < 4; ++k) turned[4 * k + 3] *= -1, strong[4 * k + 1] *= 1.1;
    exchanged = std::min(exchanged, leastEigenvalue(CDMuellerMatrix(turned)) / m.getScalar());
    amplified = std::min(amplified, leastEigenvalue(CDMuellerMatrix(strong)) / m.getScalar());
  };
  for (std::size_t a = 0; a < airs.size(); ++a)
    for (const AirGround& ground : {AirGround{}, AirGround{0.5}, lawn(), copper()})
      for (const double sun : {0.15, 0.7}) {
        const FourSuns matrix(airs[a], whole[a], sun, ground, {0.1, 0.6, 1.0});
        for (std::size_t view = 0; view < 3; ++view)
          for (const double phi : {0.0, 1.0, 2.2, 3.1})
            look(matrix(view, phi, true)), look(matrix(view, phi, false));
      }
  EXPECT_GT(least, -1e-7);
  EXPECT_LT(exchanged, -0.1);
  EXPECT_LT(amplified, -0.01);
}

// Time reversed, light goes back its way. Its s turns round and its p does not, and Jones's matrix becomes its transpose: of
// Mueller's matrix the transpose, its row and its column of S2 with the other sign. The way back to the sun lies on the other
// side of the azimuth, where a mirror image has the signs of S2 and S3 reversed: what is left of both is S3. Light that comes
// through goes back through the layers from below; upside down that is another mirror image, and what is left is S2.
TEST(LayeredLightInvariant, AllSixteenElementsMayBeExchanged) {
  const std::vector<AirLayer> layers{{{rayleighScatterer(0.03), 0.2}},
                                     {{spheroids(), 0.4, 0.95}}},
      turned{layers[1], layers[0]};
  const double a = 0.85, b = 0.3, whole = 0.6;
  const auto off = [](const CDMuellerMatrix& there, double there_sun,
                      const CDMuellerMatrix& back, double back_sun, int reversed) {
    double most = 0;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) {
        const double sign = (k == reversed) == (l == reversed) ? 1 : -1;
        most = std::max(most, std::abs(there.getMueller(k, l) / there_sun -
                                       sign * back.getMueller(l, k) / back_sun));
      }
    return most * there_sun / there.getScalar();
  };
  const FourSuns over(layers, whole, a, copper(), {b}),
      over_back(layers, whole, b, copper(), {a});
  const FourSuns through(layers, whole, a, {}, {b}), through_back(turned, whole, b, {}, {a}),
      unturned(layers, whole, b, {}, {a});
  for (const double phi : {0.3, 1.5, 2.8}) {
    EXPECT_LT(off(over(0, phi, true), a, over_back(0, phi, true), b, 3), 3e-6) << phi;
    EXPECT_GT(off(over(0, phi, true), a, over_back(0, phi, true), b, 2), 1e-3);  // control
    EXPECT_LT(off(through(0, phi, false), a, through_back(0, phi, false), b, 2), 3e-6) << phi;
    EXPECT_GT(off(through(0, phi, false), a, through_back(0, phi, false), b, 3),
              1e-3);  // controls
    EXPECT_GT(off(through(0, phi, false), a, unturned(0, phi, false), b, 2), 1e-3);
  }
}

// Kokhanovsky et al. 2010, molecular case: the authors claim six digits and print seven, and
// the solution keeps 1e-8 of an
// irradiance of pi.
TEST(LayeredLightPublished, KokhanovskysMolecularLayer) {
  const Table table = Table::read("validation/printed/kokhanovsky2010.csv");
  std::vector<double> views;
  for (std::size_t row = 0; row < table.rows(); ++row)
    views.push_back(std::cos(table.number(row, "vza_deg") * degree));
  const LayeredLight light({{{rayleighScatterer(0), 0.3262}}}, 0.5, {}, 2 * pi, views,
                           {0, 0.3262});
  double worst = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double I = table.number(row, "I"), phi = table.number(row, "phi_deg") * degree;
    const CDStokesVector ours =
        table.cell(row, "dir") == "UP" ? light.up(row, phi, 0) : light.down(row, phi, 1);
    worst = std::max(worst, std::abs(ours.getStokes(0) - I) / I);
    worst = std::max(worst, std::abs(ours.getStokes(1) - table.number(row, "minus_Q")) / I);
    if (!table.cell(row, "U").empty())
      worst = std::max(worst, std::abs(ours.getStokes(2) - table.number(row, "U")) / I);
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(worst, 1e-9);  // digits were compared
}

// A sun at the horizon lights the top alone: the balance over white ground against what comes in, and the exact solution to
// what that keeps of reciprocity there (ch. AddingDoubling, whose test this is).
TEST(LayeredLightInvariant, AGrazingSunKeepsTheBalance) {
  for (const double sun : {1e-3, 1e-5, 1e-9})
    for (const double depth : {0.05, 0.5}) {
      const LayeredLight light({{{rayleighScatterer(0.03), depth}}}, sun, {1}, pi,
                               flat_and_steep, {0, depth});
      const RayleighLight exact(RayleighAtmosphere(depth, 0.03), sun, 1, pi);
      EXPECT_NEAR(light.diffuseUp(0) / (pi * sun), 1, 1e-8) << sun << ' ' << depth;
      EXPECT_GT(std::abs(light.diffuseUp(0) / (pi * sun * 1.001) - 1), 1e-8);  // control
      for (std::size_t v = 0; v < flat_and_steep.size(); ++v)
        for (const double phi : {0.0, 1.0, 3.0}) {
          const auto azimuth = RayleighLight::Azimuth::fromRadians(phi);
          EXPECT_LT(apart(light.up(v, phi, 0), exact.up(flat_and_steep[v], azimuth)),
                    1e-5 * pi * sun)
              << sun << ' ' << v;
        }
    }
}

// A layer in two is the same layer; absorption darkens; a mirror image has the other S2 and S3.
TEST(LayeredLightInvariant, CutsAndMirrors) {
  const Scatterer haze = spheroids();
  const std::vector<double> views{0.3, 0.8};
  const LayeredLight whole({{{haze, 0.6}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6}),
      cut({{{haze, 0.25}}, {{haze, 0.35}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6}),
      dark({{{haze, 0.6, 0.9}}}, 0.5, copper(), 1, views, {0, 0.25, 0.6});
  for (std::size_t v = 0; v < 2; ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(apart(whole.up(v, 1, k), cut.up(v, 1, k)), 1e-9);
      EXPECT_LT(apart(whole.down(v, 1, k), cut.down(v, 1, k)), 1e-9);
      EXPECT_GT(whole.up(v, 1, k).getScalar(), dark.up(v, 1, k).getScalar());
      const CDStokesVector left = whole.up(v, 1, k), right = whole.up(v, -1, k);
      EXPECT_LT(apart(left, {right.getStokes(0), right.getStokes(1), -right.getStokes(2),
                             -right.getStokes(3)}),
                1e-14);
      EXPECT_GT(std::abs(left.getStokes(2)), 1e-5);
    }
}

// Thin air scatters once: a1 tau / 4 mu of the irradiance, and the ground its glint. Deep air keeps the balance.
TEST(LayeredLightInvariant, ThinAndDeep) {
  const Scatterer air = rayleighScatterer(0);
  const double tau = 1e-8, mu = 0.4, sun = 0.7, phi = 1.1;
  const LayeredLight thin({{{air, tau}}}, sun, {}, 1, {mu}, {0, tau});
  const double cosine = -sun * mu + std::sqrt((1 - sun * sun) * (1 - mu * mu)) * std::cos(phi);
  EXPECT_NEAR(thin.up(0, phi, 0).getScalar() / (air.matrix(cosine).a1 * tau / (4 * pi * mu)), 1,
              1e-6);
  const LayeredLight glint({{{air, tau}}}, sun, copper(), 1, {mu}, {0});
  const auto f = groundMatrix(copper(), sun, mu, -phi);
  EXPECT_LT(apart(glint.up(0, phi, 0), sun * CDStokesVector(f[0], f[4], f[8], f[12])), 1e-7);
  const LayeredLight deep({{{air, 300}}}, sun, {1}, 1, {mu}, {0, 150, 300});
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(deep.directFlux(k) + deep.diffuseDown(k) - deep.diffuseUp(k), 0, 1e-7);
}

namespace {
/// Chandrasekhar's function of isotropic scattering, by the closed integral of Stibbs and Weir 1959.
double hFunction(double albedo, double mu) {
  const int steps = 20000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {  // in cube roots, since the logarithm has a pole at zero
    const double y = (i + 0.5) / steps, x = y * y * y * pi / 2, c = std::cos(x),
                 s = std::sin(x);
    const double gap = x < 0.01 ? x * x / 3 + x * x * x * x / 45 : 1 - x * c / s;
    sum += y * y * std::log(1 - albedo + albedo * gap) / (c * c + mu * mu * s * s);
  }
  return std::exp(-mu / pi * sum * 3 * pi / 2 / steps);
}
Scatterer isotropic() { return Scatterer({Scatterer::Term{1, 0, 0, 0, 0, 0}}); }
}  // namespace

// Theory of semi-infinite air: what isotropic particles reflect is albedo H H / 4 (mu + mu0), the flux 1 - H sqrt(1 - albedo);
// without absorption a deep layer lets through mu0 H / sqrt(3) (tau + 2 q), with Hopf's q = 0.710446. To 1e-6.
TEST(LayeredLightPublished, DeepAirIsThatOfTheTheory) {
  const std::vector<double> views{0.1, 0.5, 1};
  for (const double albedo : {1.0, 0.999, 0.9, 0.5})
    for (const double sun : {0.3, 1.0}) {
      const double h = hFunction(albedo, sun), depth = 1e4;
      const LayeredLight light({{{isotropic(), depth, albedo}}}, sun, {}, pi, views,
                               {0, depth / 2, depth});
      const double lost =
          albedo < 1 ? h * std::sqrt(1 - albedo) : h / std::sqrt(3) / (depth + 2 * 0.71044609);
      EXPECT_NEAR(light.diffuseUp(0) / (pi * sun), 1 - lost, 1e-6) << albedo << ' ' << sun;
      EXPECT_NEAR(light.diffuseDown(2) / (pi * sun * lost), albedo < 1 ? 0 : 1, 1e-6) << sun;
      const double missing = lost / (1 - lost) * (albedo < 1 ? 0 : 1);
      for (std::size_t v = 0; v < views.size(); ++v)
        EXPECT_NEAR(light.up(v, 1, 0).getScalar() /
                        (albedo * h * hFunction(albedo, views[v]) * sun / 4 / (views[v] + sun)),
                    1, 1e-6 + 3 * missing)
            << albedo << ' ' << sun << ' ' << views[v];
      EXPECT_LT(light.rounds(), 60);
    }
  EXPECT_GT(std::abs(hFunction(1, 1) / hFunction(0.999, 1) - 1), 1e-3);  // control
}

// From 1e-8 to 1e4: nothing is lost over a white ground, at any height, nor over a black one; light through deep air falls as
// 1 / (tau + const); absorption leaves no light deep down.
TEST(LayeredLightInvariant, EnergyFromThinToDeep) {
  const LayeredLightAccuracy few{.streams = 32,
                                 .terms = 8};  // the balance does not need the aureole
  for (const Scatterer& kind : {rayleighScatterer(0.03), droplets()}) {
    std::vector<double> resistance;
    for (const double depth : {1e-8, 1e-3, 1.0, 100.0, 2500.0, 5000.0, 1e4}) {
      const std::vector<double> depths{0, depth / 3, depth};
      const LayeredLight white({{{kind, depth}}}, 0.6, {1}, 1, {0.5}, depths, few),
          black({{{kind, depth}}}, 0.6, {}, 1, {0.5}, depths, few);
      EXPECT_LT(white.rounds(), 60) << depth;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(white.directFlux(k) + white.diffuseDown(k) - white.diffuseUp(k), 0, 1e-7)
            << depth << ' ' << k;
      EXPECT_NEAR(black.diffuseUp(0) + black.directFlux(2) + black.diffuseDown(2), 0.6, 1e-7)
          << depth;
      resistance.push_back(0.6 / (black.directFlux(2) + black.diffuseDown(2)));
    }
    const double half = resistance[5] - resistance[4], all = resistance[6] - resistance[5];
    EXPECT_NEAR(all / half, 2, 1e-6);
    const LayeredLight dark({{{kind, 1e4, 0.9999}}}, 0.6, {1}, 1, {0.5}, {0, 1e4}, few);
    EXPECT_LT(dark.diffuseDown(1), 1e-20);
    EXPECT_GT(dark.diffuseUp(0), 0.4);
  }
}

// The cloud of IPRT A5: 64 terms are as good as 128, beside the sun and elsewhere, to a thousandth; 24 terms are not.
TEST(LayeredLightInvariant, WhatIsCutOffIsPutBack) {
  const std::vector<AirLayer> cloud{{{droplets(), 5, 0.999979}}};
  const double sun = std::cos(50 * degree);
  const std::vector<double> views{sun, 0.9};
  const LayeredLight usual(cloud, sun, {}, 1, views, {5}, {.thinnest = 1e-3}),
      more(cloud, sun, {}, 1, views, {5}, {.streams = 128, .terms = 128, .thinnest = 1e-3}),
      few(cloud, sun, {}, 1, views, {5}, {.terms = 24, .thinnest = 1e-3});
  double worst = 0;
  for (std::size_t v = 0; v < 2; ++v)
    for (const double phi_deg : {0.0, 1.0, 3.0, 6.0, 15.0, 40.0, 90.0, 180.0}) {
      const double exact = more.down(v, phi_deg * degree, 0).getScalar();
      EXPECT_NEAR(usual.down(v, phi_deg * degree, 0).getScalar() / exact, 1, 1e-3)
          << v << ' ' << phi_deg;
      worst =
          std::max(worst, std::abs(few.down(v, phi_deg * degree, 0).getScalar() / exact - 1));
    }
  EXPECT_GT(worst, 1e-3);  // control
}

TEST(LayeredLightRefusal, WhatCannotBe) {
  const AirLayer air{{rayleighScatterer(0), 0.1}};
  const auto make = [&](std::vector<AirLayer> layers, double sun, double albedo, double view,
                        double depth) {
    return LayeredLight(std::move(layers), sun, {albedo}, 1, {view}, {depth});
  };
  EXPECT_NO_THROW(make({air}, 0.5, 0, 0.5, 0.1));
  EXPECT_THROW(make({}, 0.5, 0, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0, 0, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 1.1, 0.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 0, 1.5, 0), Refusal);
  EXPECT_THROW(make({air}, 0.5, 0, 0.5, 0.2), Refusal);
  EXPECT_THROW(make({{{rayleighScatterer(0), 10001}}}, 0.5, 0, 0.5, 0), Refusal);
  EXPECT_THROW(LayeredLight({air}, 0.5, {}, 1, {0.5}, {0}, {.streams = 3}), Refusal);
  EXPECT_NO_THROW(LayeredLight({air}, 0.5, {}, {1, 0.6, 0, -0.8}, {0.5}, {0}));
  EXPECT_THROW(LayeredLight({air}, 0.5, {}, {1, 0.6, 0, -0.9}, {0.5}, {0}), Refusal);
}
