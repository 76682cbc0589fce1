// Tables of the sky in other forms than a grid of Stokes vectors (nw/air/SkyTables.nw).
#include "malus/air/SkyTables.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "malus/air/RayleighSky.hpp"
#include "malus/air/TableSky.hpp"
#include "malus/base/Angles.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Table.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi;
const auto grid = SpectralGrid::make({500.0});
const double sun_zenith_deg = 50, sun_azimuth_deg = 212;

const RayleighSky& truth() {
  static const RayleighSky sky(
      {compassDirection(sun_zenith_deg * degree, sun_azimuth_deg * degree),
       CDSpectralVector<CDStokesVector>(grid, 1.0)},
      RayleighSky::clearAir(grid, 0.2));
  return sky;
}
CDStokesVector ask(const Sky& sky, const CDVector& direction) {
  CDSpectralVector<CDStokesVector> out(sky.grid());
  sky.radiance(direction, out);
  return std::as_const(out)[0];
}
std::unique_ptr<TableSky> skyOf(const std::string& text) {
  std::istringstream stream(text);
  return std::make_unique<TableSky>(Table::parse(stream, "sky.csv"), grid);
}
std::string messageOf(const std::string& text) {
  try {
    skyOf(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
// The Rayleigh sky measured in random directions, evenly over the hemisphere down to the horizon.
std::string measured(int count, SkyConvention convention, double highest_deg = 90) {
  const bool ours = convention == SkyConvention::malus;
  std::string text =
      fmt::format("# convention: {}\n# directions: scattered\n# sun_azimuth_deg: {}\n",
                  nameOf(convention), sun_azimuth_deg);
  text += ours ? "zenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2\n"
               : "zenith_deg,phi_deg,wavelength_nm,I,Q,U\n";
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < count; ++i) {
    const double zenith = std::acos(uniform(engine)) / degree, azimuth = 360 * uniform(engine);
    if (zenith > highest_deg) continue;
    const CDVector d =
        compassDirection(zenith * degree, (azimuth + (ours ? 0 : sun_azimuth_deg)) * degree);
    const CDStokesVector light = convertSky(ask(truth(), d), SkyConvention::malus, convention);
    text += fmt::format("{},{},500,{},{},{}\n", zenith, azimuth, light.getStokes(0),
                        light.getStokes(1), light.getStokes(2));
  }
  return text;
}
// root mean square of the error over the hemisphere, of S0; and of the 15 degrees around the zenith
std::pair<double, double> errorsOf(const Sky& sky) {
  double all = 0, top = 0;
  int count = 0, count_top = 0;
  for (double zenith = 2.5; zenith < 85; zenith += 5)
    for (double azimuth = 1; azimuth < 360; azimuth += 11) {
      const CDVector d = compassDirection(zenith * degree, azimuth * degree);
      const CDStokesVector off = ask(sky, d) - ask(truth(), d);
      double square = 0;
      for (int k = 0; k < 3; ++k)
        square += std::pow(off.getStokes(k) / ask(truth(), d).getScalar(), 2);
      all += square, ++count;
      if (zenith < 15) top += square, ++count_top;
    }
  return {std::sqrt(all / count), std::sqrt(top / count_top)};
}
}  // namespace

// The error of planes through neighbours is proportional to the square of their distance, so as
// 1/count; the horizon, where the sky
// brightens within degrees, less. Four times as many measurements must halve the error at least.
TEST(SkyTablesInvariant, ScatteredDirectionsBecomeASky) {
  for (const auto convention :
       {SkyConvention::malus, SkyConvention::iprt, SkyConvention::natraj}) {
    const auto few = errorsOf(*skyOf(measured(300, convention))),
               many = errorsOf(*skyOf(measured(1200, convention)));
    EXPECT_LT(few.first, 0.06) << nameOf(convention);
    EXPECT_LT(many.first, few.first / 2) << nameOf(convention);
    EXPECT_LT(many.second, 0.003);  // no worse around the zenith, where the axes turn
  }
  // control: the wrong convention
  std::string wrong = measured(1200, SkyConvention::iprt);
  wrong.replace(wrong.find("iprt"), 4, "natraj");
  EXPECT_GT(errorsOf(*skyOf(wrong)).first, 0.1);
}

TEST(SkyTablesIdentity, DegreeAndAngleAreTheComponents) {
  const auto table = [](bool components) {
    std::string text =
        components
            ? "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2\n"
            : "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,DoLP,AoLP_deg\n";
    for (double zenith = 0; zenith <= 90; zenith += 10)
      for (double azimuth = 0; azimuth < 360; azimuth += 10) {
        const CDStokesVector light =
            ask(truth(), compassDirection(std::max(zenith, 1e-6) * degree, azimuth * degree));
        text += components
                    ? fmt::format("{},{},500,{},{},{}\n", zenith, azimuth, light.getScalar(),
                                  light.getStokes(1), light.getStokes(2))
                    : fmt::format("{},{},500,{},{},{}\n", zenith, azimuth, light.getScalar(),
                                  light.getDOLP(), light.getAoLP() / degree);
      }
    return text;
  };
  const auto one = skyOf(table(true)), other = skyOf(table(false));
  for (const CDVector& d :
       {compassDirection(0.6, 1), compassDirection(1.2, 4), compassDirection(0, 0)}) {
    const CDStokesVector off = ask(*one, d) - ask(*other, d);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(off.getStokes(k), 0, 1e-12);
  }
  EXPECT_EQ(other->polarization().state(), "full");
}

// With the degree alone the angle is that of single scattering: in thin air away from the neutral points it
// departs from the truth by a degree or two.
TEST(SkyTablesInvariant, DegreeAloneTakesTheAngleOfSingleScattering) {
  std::string text = fmt::format(
      "# convention: malus\n# sun_zenith_deg: {}\n# sun_azimuth_deg: "
      "{}\nzenith_deg,azimuth_deg,wavelength_nm,S0,DoLP\n",
      sun_zenith_deg, sun_azimuth_deg);
  for (double zenith = 0; zenith <= 90; zenith += 5)
    for (double azimuth = 0; azimuth < 360; azimuth += 5) {
      const CDStokesVector light =
          ask(truth(), compassDirection(std::max(zenith, 1e-6) * degree, azimuth * degree));
      text +=
          fmt::format("{},{},500,{},{}\n", zenith, azimuth, light.getScalar(), light.getDOLP());
    }
  const auto sky = skyOf(text);
  EXPECT_EQ(sky->polarization().state(), "partly");
  EXPECT_TRUE(sky->polarization().angle_supposed);
  int compared = 0;
  for (double zenith = 10; zenith < 90; zenith += 10)
    for (double azimuth = 0; azimuth < 360; azimuth += 20) {
      const CDVector d = compassDirection(zenith * degree, azimuth * degree);
      const CDStokesVector ours = ask(*sky, d), theirs = ask(truth(), d);
      EXPECT_NEAR(ours.getDOLP(), theirs.getDOLP(), 1e-9);
      if (theirs.getDOLP() < 0.3) continue;
      const double turned = std::remainder(ours.getAoLP() - theirs.getAoLP(), pi) / degree;
      EXPECT_LT(std::abs(turned), 3) << zenith << ' ' << azimuth;
      ++compared;
    }
  EXPECT_GT(compared, 40);
  // control: another sun, other angles
  text.replace(text.find("212"), 3, "242");
  const CDVector d = compassDirection(40 * degree, 100 * degree);
  EXPECT_GT(
      std::abs(std::remainder(ask(*skyOf(text), d).getAoLP() - ask(truth(), d).getAoLP(), pi)),
      5 * degree);
}

TEST(SkyTablesInvariant, RefusesWithASentence) {
  const std::string good = measured(300, SkyConvention::malus);
  EXPECT_EQ(messageOf(good), "");
  EXPECT_NE(messageOf(measured(300, SkyConvention::malus, 60)).find("hole"), std::string::npos);
  EXPECT_EQ(messageOf(good + "45,123,500,0,0,0\n"), "") << "a dark place is none to refuse";
  for (const char* beyond : {"-1e-9", "1.1e12", "1e41"})
    EXPECT_NE(messageOf(good + "45,123,500," + beyond + ",0,0\n").find("must be 0 to 1e+12"),
              std::string::npos)
        << beyond;
  EXPECT_EQ(messageOf(good + "45,123,500,1e12,0,0\n"), "");
  std::string layout = good;
  layout.replace(layout.find("scattered"), 9, "anywhere");
  EXPECT_NE(messageOf(layout).find("scattered"), std::string::npos);
  layout = good;
  layout.erase(layout.find("# directions"), layout.find('\n', layout.find("# directions")) + 1 -
                                                layout.find("# directions"));
  EXPECT_NE(messageOf(layout), "");  // scattered, and not declared: a grid with holes
  const std::string degree_only =
      "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,DoLP\n";
  const std::string sun = "# sun_zenith_deg: 40\n# sun_azimuth_deg: 100\n";
  EXPECT_NE(messageOf(degree_only + "0,0,500,1,0.1\n90,0,500,1,0.1\n").find("sun_zenith_deg"),
            std::string::npos)
      << messageOf(degree_only + "0,0,500,1,0.1\n90,0,500,1,0.1\n");
  EXPECT_EQ(messageOf(sun + degree_only + "0,0,500,1,0.1\n90,0,500,1,0.1\n"), "");
  EXPECT_NE(messageOf(sun + degree_only + "0,0,500,1,10\n90,0,500,1,0.1\n").find("fraction"),
            std::string::npos);
  const std::string components =
      "# convention: malus\nzenith_deg,azimuth_deg,wavelength_nm,S0,S1,S2\n";
  EXPECT_NE(
      messageOf(components + "0,0,500,1,0.1,0\n90,0,500,1,,\n").find("some directions only"),
      std::string::npos);
}
