// The sky as the radiometry evaluates it, tables of it, and a haze (nw/air/Sky.nw,
// nw/air/TableSky.nw).
#include "malus/air/Sky.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "malus/air/Sun.hpp"
#include "malus/air/TableSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const CDVector up{0, 0, 1};

using Spectrum = CDSpectralVector<CDStokesVector>;
CDStokesVector only(const Spectrum& spectrum) { return spectrum[0]; }
CDStokesVector ask(const Sky& sky, const CDVector& direction) {
  Spectrum out(sky.grid());
  sky.radiance(direction, out);
  return only(out);
}
double distance(const CDStokesVector& a, const CDStokesVector& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, std::abs(a.getStokes(i) - b.getStokes(i)));
  return most;
}

// Single Rayleigh scattering drawn as vectors: unpolarised sunlight shakes an electron in every
// direction across the beam, and we see the two of them across our line of sight. No formula of the
// chapter is used: Stokes components are sums over two fields a, b across the sunbeam.
CDStokesVector rayleigh(const CDVector& to_sky, const CDVector& to_sun) {
  const RayFrame seen = rayFrame(-to_sky, up), beam = rayFrame(-to_sun, {0.1, 0.2, 0.3});
  double s0 = 0, s1 = 0, s2 = 0;
  for (const CDVector& field : {beam.s, beam.p}) {
    const double s = dot(field, seen.s), p = dot(field, seen.p);
    s0 += s * s + p * p, s1 += s * s - p * p, s2 += 2 * s * p;
  }
  return {s0, s1, s2, 0};
}

const double sun_azimuth_deg = 212;
const CDVector to_sun = compassDirection(40 * degree, sun_azimuth_deg* degree);

// The analytic sky written to a table; the literature's components are made from its definitions:
// l = e_theta and r = e_phi of the direction of travel, phi clockwise from the sunbeam's.
std::string written(SkyConvention convention, double u_sign = 1, double step = 5) {
  const bool ours = convention == SkyConvention::malus;
  std::string text = fmt::format("# convention: {}\n", nameOf(convention));
  if (!ours) text += fmt::format("# sun_azimuth_deg: {}\n", sun_azimuth_deg);
  text += ours ? "zenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2,S3\n"
               : "zenith_deg,phi_deg,wavelength_nm,I,Q,U,V\n";
  for (double zenith = 0; zenith <= 90; zenith += step)
    for (double azimuth = 0; azimuth < 360; azimuth += step) {
      const double compass = azimuth + (ours ? 0 : sun_azimuth_deg);
      // in the zenith each row has the axes of its azimuth: the limit of small zenith angles
      const CDVector d = compassDirection(std::max(zenith, 1e-7) * degree, compass * degree);
      double q, u;
      const double i = rayleigh(d, to_sun).getScalar();
      if (ours) {
        q = rayleigh(d, to_sun).getStokes(1), u = rayleigh(d, to_sun).getStokes(2);
      } else {
        const CDVector k = -d;
        const CDVector r = normalized(cross(k, up));  // clockwise azimuth of travel
        const CDVector l =
            cross(r, k) * (cross(r, k).z < 0 ? 1 : -1);  // larger zenith angle of travel: down
        q = u = 0;
        const RayFrame beam = rayFrame(-to_sun, up);
        for (const CDVector& field : {beam.s, beam.p}) {
          const double fl = dot(field, l), fr = dot(field, r);
          q += (fr * fr - fl * fl) * (convention == SkyConvention::iprt ? -1 : 1);
          u += 2 * fl * fr;
        }
      }
      for (const double nm : {400.0, 600.0})
        text += fmt::format("{},{},{},{},{},{},0\n", zenith, azimuth, nm, i * nm, q * nm,
                            u_sign * u * nm);
    }
  return text;
}

std::unique_ptr<TableSky> skyOf(const std::string& text, double nm = 500) {
  std::istringstream stream(text);
  return std::make_unique<TableSky>(Table::parse(stream, "sky.csv"), SpectralGrid::make({nm}));
}
std::string messageOf(const std::string& text, double nm = 500) {
  try {
    skyOf(text, nm);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(SkyIdentity, UniformSkyIsTheSameEverywhere) {
  const auto grid = SpectralGrid::make({400.0, 500.0});
  const UniformSky sky(Spectrum(grid, 0.05));
  Spectrum out(grid);
  for (const CDVector& d : {CDVector{0, 0, 1}, CDVector{1, 0, 0}, CDVector{0, 0, -1}}) {
    sky.radiance(d, out);
    EXPECT_EQ(out, Spectrum(grid, 0.05));
  }
  EXPECT_NE(out, Spectrum(grid, 0.051));  // negative control
  EXPECT_FALSE(sky.polarized());
  ASSERT_NE(sky.uniform(), nullptr);
  EXPECT_EQ(*sky.uniform(), Spectrum(grid, 0.05));
  EXPECT_EQ(blackSky(grid)->uniform()->grid(), *grid);
}

TEST(SkyIdentity, UniformSkyRefusesWhatItCannotBe) {
  const auto grid = SpectralGrid::make({400.0});
  EXPECT_THROW(UniformSky(Spectrum(grid, -1.0)), MathError);
  EXPECT_THROW(UniformSky(Spectrum(grid, std::nan(""))), MathError);
  EXPECT_THROW(UniformSky(Spectrum(grid, CDStokesVector(1, 0.5, 0, 0))), MathError);
}

// The three conventions of one sky are one sky. At the nodes the tables are exact: rounding of the
// decimal numbers is in the 16th digit.
TEST(SkyInvariant, ThreeConventionsAreOneSky) {
  const auto ours = skyOf(written(SkyConvention::malus));
  const auto natraj = skyOf(written(SkyConvention::natraj));
  const auto iprt = skyOf(written(SkyConvention::iprt));
  for (double zenith = 5; zenith <= 90; zenith += 5)
    for (double azimuth = 0; azimuth < 360; azimuth += 5) {
      const CDVector ours_d = compassDirection(zenith * degree, azimuth * degree);
      const CDVector theirs_d =
          compassDirection(zenith * degree, (sun_azimuth_deg + azimuth) * degree);
      EXPECT_LT(distance(ask(*ours, ours_d), rayleigh(ours_d, to_sun) * 500.0), 1e-9);
      EXPECT_LT(distance(ask(*natraj, theirs_d), rayleigh(theirs_d, to_sun) * 500.0), 1e-9);
      EXPECT_LT(distance(ask(*iprt, theirs_d), rayleigh(theirs_d, to_sun) * 500.0), 1e-9);
    }
}

TEST(SkyInvariant, NegativeControlTheOtherSignOfUIsAnotherSky) {
  const auto wrong = skyOf(written(SkyConvention::iprt, -1));
  const CDVector d = compassDirection(50 * degree, (sun_azimuth_deg + 60) * degree);
  EXPECT_GT(distance(ask(*wrong, d), rayleigh(d, to_sun) * 500.0), 50);
}

TEST(SkyInvariant, LightScatteredOnceIsPolarisedAcrossThePlaneOfScattering) {
  const auto sky = skyOf(written(SkyConvention::natraj));
  const CDVector d = compassDirection(60 * degree, (sun_azimuth_deg + 75) * degree);
  const CDStokesVector light = ask(*sky, d);
  const RayFrame frame = rayFrame(-d, up);
  const CDVector field =
      std::cos(light.getAoLP()) * frame.s + std::sin(light.getAoLP()) * frame.p;
  EXPECT_NEAR(dot(field, to_sun), 0, 1e-6);  // AoLP from decimal numbers; d is a node
}

// Between nodes linear interpolation has an error of h^2/8 times the second derivative;
// components are sums of
// harmonics of the angles up to the second: |f''| <= 4 |f|, two angles.
TEST(SkyInvariant, InterpolationErrsAsTheStepSquared) {
  for (const double step : {10.0, 5.0}) {
    const auto sky = skyOf(written(SkyConvention::malus, 1, step));
    double worst = 0;
    for (double zenith = step / 2; zenith < 90; zenith += step)
      for (double azimuth = step / 2; azimuth < 360; azimuth += step) {
        const CDVector d = compassDirection(zenith * degree, azimuth * degree);
        worst = std::max(worst, distance(ask(*sky, d), rayleigh(d, to_sun) * 500.0));
      }
    const double bound = 2 * 4 * 1000.0 * std::pow(step * degree, 2) / 8;
    EXPECT_LT(worst, bound);
    EXPECT_GT(worst, bound / 20);
  }
}

TEST(SkyIdentity, TheZenithHasTheAxesOfTheFrame) {
  const auto sky = skyOf(written(SkyConvention::malus));
  EXPECT_LT(distance(ask(*sky, up), rayleigh(up, to_sun) * 500.0),
            1e-3);  // rows 1e-7 deg off the zenith
}

TEST(SkyIdentity, BlackBelowTheHorizonAndAroundTheSeam) {
  const auto sky = skyOf(written(SkyConvention::malus));
  EXPECT_EQ(ask(*sky, normalized({1, 0, -0.01})).getScalar(), 0);
  const CDVector left = compassDirection(1, 359.999999 * degree),
                 right = compassDirection(1, 1e-6 * degree);
  EXPECT_LT(distance(ask(*sky, left), ask(*sky, right)), 1e-3);
}

// 1e-7 of S0: single precision rounds each component by 6e-8 of itself.
TEST(SkyIdentity, ManyDirectionsAreAnsweredAsOneByOne) {
  const SpectralGridPtr grid = SpectralGrid::make({500.0, 600.0});
  const UniformSky uniform(Spectrum(grid, CDStokesVector(0.3)));
  const auto polarized = skyOf(written(SkyConvention::malus));
  const std::vector<float> x{0.6f, 0, 0.48f, -0.8f}, y{0, 0.8f, 0.64f, 0},
      z{0.8f, 0.6f, 0.6f, -0.6f};
  for (const Sky* sky :
       {static_cast<const Sky*>(&uniform), static_cast<const Sky*>(polarized.get())}) {
    const std::size_t bands = sky->grid()->size();
    std::vector<float> many(x.size() * 4 * bands, -1);
    sky->radiances({x.size(), x.data(), y.data(), z.data()}, many);
    EXPECT_THROW(sky->radiances({x.size() - 1, x.data(), y.data(), z.data()}, many), MathError);
    Spectrum one(sky->grid());
    for (std::size_t i = 0; i < x.size(); ++i) {
      sky->radiance({x[i], y[i], z[i]}, one);
      for (std::size_t band = 0; band < bands; ++band)
        for (int c = 0; c < 4; ++c)
          EXPECT_NEAR(many[(i * 4 + static_cast<std::size_t>(c)) * bands + band],
                      CDStokesVector(one.at(band)).getStokes(c),
                      1e-7 * CDStokesVector(one.at(band)).getScalar())
              << sky->description() << " direction " << i;
    }
  }
}

TEST(SkyIdentity, ATableWithoutPolarisationIsAnUnpolarisedSky) {
  std::string text = "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0\n";
  for (const char* zenith : {"0", "90"})
    text += fmt::format("{},0,500,{}\n", zenith, zenith[0] == '0' ? 1 : 3);
  const auto sky = skyOf(text);
  EXPECT_FALSE(sky->polarized());
  EXPECT_NEAR(ask(*sky, compassDirection(45 * degree, 1)).getScalar(), 2, 1e-12);
  EXPECT_FALSE(ask(*sky, up).isPolarized());
}

// Polarisation is not known at 400 nm: it is lost between there and 600 nm, and at 600 nm, a wavelength of the table, it is not.
TEST(SkyIdentity, PolarisationIsKnownFromTheFirstKnownWavelengthOn) {
  std::string text = "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2,S3\n";
  for (const char* zenith : {"0", "90"}) {
    text += fmt::format("{},0,400,2,,,\n", zenith);
    for (const char* nm : {"600", "800"})
      text += fmt::format("{},0,{},2,0.5,0.25,0.125\n", zenith, nm);
  }
  const CDVector d = compassDirection(45 * degree, 0);
  const CDStokesVector known(2, 0.5, 0.25, 0.125);
  for (const double nm : {600.0, 700.0, 800.0}) {
    EXPECT_LT(distance(ask(*skyOf(text, nm), d), known), 1e-12) << nm;
    EXPECT_EQ(skyOf(text, nm)->polarization().bands, std::vector<bool>{true}) << nm;
  }
  for (const double nm : {400.0, 500.0}) {
    EXPECT_LT(distance(ask(*skyOf(text, nm), d), CDStokesVector(2)), 1e-12) << nm;
    EXPECT_EQ(skyOf(text, nm)->polarization().bands, std::vector<bool>{false}) << nm;
  }
}

TEST(SkyInvariant, RefusesWithASentence) {
  const std::string good = written(SkyConvention::malus, 1, 30);
  EXPECT_EQ(messageOf(good), "");
  const auto without = [](std::string text, const std::string& what) {
    const std::size_t at = text.find(what);
    return text.erase(at, text.find('\n', at) + 1 - at);
  };
  const std::string missing = messageOf(without(good, "# convention"));
  for (const char* choice : {"convention", "malus", "natraj", "iprt"})
    EXPECT_NE(missing.find(choice), std::string::npos) << missing;
  EXPECT_NE(
      messageOf("# convention: modtran\n" + without(good, "# convention")).find("modtran"),
      std::string::npos);
  EXPECT_NE(messageOf(without(good, "60,90,600"))
                .find("no row for zenith 60 deg, azimuth 90 deg, 600 nm"),
            std::string::npos);
  EXPECT_NE(messageOf(good + "60,90,600,1,0,0,0\n").find("repeats"), std::string::npos);
  EXPECT_NE(messageOf(good, 700).find("does not cover the band at 700 nm"), std::string::npos);
  EXPECT_NE(messageOf(good + "180.5,0,600,1,0,0,0\n").find("must be 0 to 180"),
            std::string::npos);
  EXPECT_NE(messageOf(good + "60,95,600,-1,0,0,0\n").find("no row"), std::string::npos);
  EXPECT_NE(
      messageOf("# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0\n").find("empty"),
      std::string::npos);
  EXPECT_NE(messageOf("# convention: "
                      "malus\nzenith_deg,azimuth_deg,wavelength_nm,S0\n0,0,500,1\n80,0,500,1\n")
                .find("0 to 80 deg"),
            std::string::npos);
  for (const char* beyond : {"-1", "1e39", "1.1e12"})
    EXPECT_NE(
        messageOf(std::string("# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0\n"
                              "0,0,500,") +
                  beyond + "\n90,0,500,1\n")
            .find("must be 0 to 1e+12"),
        std::string::npos)
        << beyond;
  EXPECT_NE(messageOf("# convention: "
                      "malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2\n0,0,500,1,1,1\n90,"
                      "0,500,1,0,0\n")
                .find("exceeds one"),
            std::string::npos);
  EXPECT_NE(
      messageOf(
          "# convention: iprt\nzenith_deg,phi_deg,wavelength_nm,I\n0,0,500,1\n90,0,500,1\n")
          .find("sun_azimuth_deg"),
      std::string::npos);
}

// The default sampler: the mean of z over its density must be what the density says. With n draws of
// a stratified grid the mean of z over the hemisphere is 1/2 up to half a stratum.
TEST(SkyInvariant, DrawsUniformlyFromTheUpperHemisphere) {
  const UniformSky sky(Spectrum(SpectralGrid::make({400.0}), 1.0));
  double z = 0, x2 = 0;
  const int n = 100;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Sky::Sample drawn = sky.sample((i + 0.5) / n, (j + 0.5) / n);
      EXPECT_NEAR(drawn.to_sky.getLength(), 1, 1e-15);
      EXPECT_EQ(drawn.density, sky.density(drawn.to_sky));
      z += drawn.to_sky.z, x2 += drawn.to_sky.x * drawn.to_sky.x;
    }
  EXPECT_NEAR(z / (n * n), 0.5, 1e-12);
  EXPECT_NEAR(x2 / (n * n), 1.0 / 3, 1e-4);  // midpoint rule: (1/n)^2
  EXPECT_EQ(sky.density({0, 0, -1}), 0);
}

// Drawing where it is bright: the density integrates to one, sample() and density() agree, and the
// estimate of the flux has less variance than uniform drawing. Midpoints of an n x n grid of u.
TEST(SkyInvariant, ABrightPartIsDrawnMoreOften) {
  const auto brightness = [](const CDVector& d) {
    return std::pow(std::max(0.0, d.x), 8) + 0.01;
  };
  const HemisphereDistribution drawn(brightness);
  double inverse = 0, flux = 0, squares = 0, uniform = 0, uniform_squares = 0;
  const int n = 200;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u1 = (i + 0.5) / n, u2 = (j + 0.5) / n;
      const Sky::Sample sample = drawn.sample(u1, u2);
      ASSERT_NEAR(sample.to_sky.getLength(), 1, 1e-14);
      ASSERT_NEAR(sample.density / drawn.density(sample.to_sky), 1, 1e-12);
      const double value = brightness(sample.to_sky) / sample.density;
      inverse += 1 / sample.density / (n * n), flux += value / (n * n),
          squares += value * value / (n * n);
      const double r = std::sqrt(1 - u1 * u1);
      const double even =
          2 * pi * brightness({r * std::cos(2 * pi * u2), r * std::sin(2 * pi * u2), u1});
      uniform += even / (n * n), uniform_squares += even * even / (n * n);
    }
  // midpoint sums over cells whose edges are not edges of the grid: 1/n times the largest value
  EXPECT_NEAR(inverse, 2 * pi, 0.03);
  EXPECT_NEAR(flux, pi / 9 + 0.02 * pi, 0.01);  // half of 4 pi/(2*9) and the constant
  EXPECT_NEAR(uniform, flux, 0.01);
  EXPECT_LT(squares - flux * flux, 0.05 * (uniform_squares - uniform * uniform));
}

// The chapter's 32 zones by 64 sectors: in the middle of a cell the density is a twentieth of the even one and, of the rest, the
// brightness there over the mean brightness, here 3/2. Corners of a cell are half a zone and half a sector away, so that their
// mean differs by second derivatives times squares of these steps, 2e-3 in all below a zenith angle of 30 degrees.
TEST(SkyIdentity, ACellIsDrawnAsOftenAsItIsBright) {
  const auto brightness = [](const CDVector& d) {
    return 1 + d.z + 0.5 * d.x + 0.3 * d.y * d.z;
  };
  const HemisphereDistribution drawn(brightness);
  const auto middle = [](int zone, int sector) {
    return CDVector::fromAngles(std::acos((zone + 0.5) / 32), 2 * pi * (sector + 0.5) / 64);
  };
  double worst = 0, control = 0;
  for (int zone = 0; zone < 28; ++zone)
    for (int sector = 0; sector < 64; ++sector) {
      const double density = drawn.density(middle(zone, sector)) * 2 * pi;
      const auto expected = [&](int of) {
        return 0.05 + 0.95 * brightness(middle(zone, of)) / 1.5;
      };
      worst = std::max(worst, std::abs(density - expected(sector)));
      control = std::max(control, std::abs(density - expected(sector + 1)));
    }
  EXPECT_LT(worst, 2e-3);
  EXPECT_GT(control, 1e-2) << "negative control: the next sector's brightness";
  // up to the zenith the drawn direction's density is that of its cell
  for (int i = 0; i < 1000; ++i) {
    const Sky::Sample sample = drawn.sample((i + 0.5) / 1000, std::fmod(i * 0.618, 1.0));
    EXPECT_NEAR(sample.density / drawn.density(sample.to_sky), 1, 1e-12) << i;
  }
}

TEST(SkyInvariant, ABlackSkyIsDrawnEvenly) {
  const HemisphereDistribution black([](const CDVector&) { return 0.0; });
  EXPECT_NEAR(black.density(up), 1 / (2 * pi), 1e-15);
  EXPECT_EQ(black.density({0, 0, -1}), 0);
  EXPECT_THROW(HemisphereDistribution([](const CDVector&) { return -1.0; }), MathError);
}

// Two halves of a path are the whole path; no path changes nothing; a very long one hides the
// scene.
RC_GTEST_PROP(AtmosphereInvariant, HazeComposes, ()) {
  const auto grid = SpectralGrid::make({500.0});
  const double beta = *rc::gen::inRange(0, 1000) * 1e-5,
               split = *rc::gen::inRange(0, 100) * 0.01;
  const UniformHaze haze(CDSpectralVector<double>(grid, beta),
                         CDSpectralVector<double>(grid, 0.2));
  const CDVector a{0, 0, 0}, b{300, 400, 1200}, middle = a + split * (b - a);
  Spectrum whole(grid, CDStokesVector(1, 0.3, -0.2, 0.1)), halves = whole, none = whole;
  haze.apply(a, b, whole);
  haze.apply(a, middle, halves);
  haze.apply(middle, b, halves);
  haze.apply(b, b, none);
  RC_ASSERT(distance(only(whole), only(halves)) < 1e-14);
  RC_ASSERT(distance(only(none), CDStokesVector(1, 0.3, -0.2, 0.1)) < 1e-15);
  const double lost = 1 - std::exp(-beta * 1300);
  RC_ASSERT(std::abs(only(whole).getStokes(1) - 0.3 * (1 - lost)) < 1e-14);
  RC_ASSERT(std::abs(only(whole).getScalar() - (1 - lost) - 0.2 * lost) < 1e-14);
}

TEST(AtmosphereInvariant, HazeRefusesNonsense) {
  const auto grid = SpectralGrid::make({500.0});
  using Numbers = CDSpectralVector<double>;
  EXPECT_THROW(UniformHaze(Numbers(grid, -1.0), Numbers(grid, 0.0)), MathError);
  EXPECT_THROW(UniformHaze(Numbers(grid, 1.0), Numbers(grid, std::nan(""))), MathError);
  EXPECT_THROW(UniformHaze(Numbers(grid, 1.0), Numbers(SpectralGrid::make({501.0}), 1.0)),
               GridError);
}
