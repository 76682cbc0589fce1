// Heat below a surface (nw/scene/HeatBalance.nw).
#include "malus/scene/HeatBalance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "malus/base/Error.hpp"

using namespace malus;

namespace {
constexpr double pi = std::numbers::pi, omega = 2 * pi / day_s;
const Slab soil{1, 1600, 1250}, copper{390, 8960, 385}, wood{0.12, 500, 1600};

using Flow = std::function<SurfaceHeat(double t_s)>;

/// Surface temperatures at the end of each step from `from` on.
std::vector<double> march(HeatedSlab& slab, const Flow& flow, double step_s, int from, int to) {
  std::vector<double> surface;
  for (int i = 0; i < to; ++i) {
    const double t = i * step_s;
    slab.step(step_s, {flow(t), flow(t + HeatedSlab::inner * step_s), flow(t + step_s)});
    if (i >= from) surface.push_back(slab.surface_K());
  }
  return surface;
}

/// First harmonic of the last of forty days under F cos(omega t), over F.
std::complex<double> response(const Slab& matter, std::size_t cells, int steps) {
  const double step_s = day_s / steps;
  HeatedSlab slab(matter, 0, cells);
  const auto day = march(
      slab, [](double t) { return SurfaceHeat{std::cos(omega * t)}; }, step_s, 39 * steps,
      40 * steps);
  std::complex<double> sum = 0;
  for (int i = 0; i < steps; ++i)
    sum += day[std::size_t(i)] * std::polar(2.0 / steps, -omega * (i + 1) * step_s);
  return sum;
}
std::complex<double> printed(const Slab& m) {
  return std::polar(1 / std::sqrt(m.conductivity_W_m_K * m.heat_J_m3_K() * omega), -pi / 4);
}

/// A day of sun, sky, wind and air.
SurfaceHeat weather(double t) {
  const double sun = std::max(0.0, -std::cos(omega * t));
  return {700 * sun * sun + 300, 0.95, 10 + 3 * std::sin(omega * t),
          290 - 6 * std::cos(omega * t - 0.7)};
}
}  // namespace

// Carslaw and Jaeger 1959, section 2.9: amplitude F / sqrt(k rho c omega), lag pi/4.
TEST(HeatBalancePublished, AHalfSpaceUnderAPeriodicFlux) {
  for (const Slab& matter : {soil, copper, wood}) {
    const auto got = response(matter, HeatedSlab::usual_cells, 384), want = printed(matter);
    EXPECT_NEAR(std::abs(got) / std::abs(want), 1, 1e-4) << matter.conductivity_W_m_K;
    EXPECT_NEAR(std::arg(got), -pi / 4, 1e-4) << matter.conductivity_W_m_K;
  }
  // by hand in the chapter: 200 W/m^2 move soil by 16.6 K
  EXPECT_NEAR(200 * std::abs(response(soil, HeatedSlab::usual_cells, 384)), 16.6, 0.05);
}
TEST(HeatBalanceControl, ACoarseGridShows) {
  const auto got = response(soil, HeatedSlab::usual_cells / 4, 384);
  EXPECT_GT(std::abs(got / printed(soil) - 1.0), 1e-4);
}

TEST(HeatBalanceIdentity, ASteadySlabIsALine) {
  Slab wall{0.8, 1700, 900, 0.2, 280.0};
  HeatedSlab slab(wall, 300);
  march(
      slab, [](double) { return SurfaceHeat{50}; }, 3600, 0, 24 * 40);
  for (std::size_t i = 0; i < slab.depths_m().size(); ++i)
    EXPECT_NEAR(slab.temperatures_K()[i], 280 + 50 * (0.2 - slab.depths_m()[i]) / 0.8, 1e-8);
  // the rest is the same line, with all terms of the flow
  const SurfaceHeat always{400, 0.9, 12, 295};
  const HeatedSlab rest(wall, always);
  const double through = 0.8 / 0.2 * (rest.surface_K() - 280);
  EXPECT_NEAR(always.into(rest.surface_K()), through, 1e-7);
  HeatedSlab still = rest;
  march(
      still, [&](double) { return always; }, 900, 0, 500);
  EXPECT_NEAR(still.surface_K(), rest.surface_K(), 1e-8);
}

TEST(HeatBalanceIdentity, ABlackSurfaceInAVacuum) {
  const double K = std::pow(500 / 5.670374419e-8, 0.25);  // CODATA 2018
  EXPECT_NEAR(HeatedSlab(soil, SurfaceHeat{500, 1}).surface_K(), K, 1e-7);
  HeatedSlab plate({390, 8960, 385, 0.001}, 200);
  march(
      plate,
      [](double) {
        return SurfaceHeat{500, 1};
      },
      600, 0, 1000);
  EXPECT_NEAR(plate.surface_K(), K, 1e-7);
}

TEST(HeatBalanceIdentity, AThinPlateCoolsExponentially) {
  HeatedSlab plate({390, 8960, 385, 0.002}, 340);
  const double rate = 15 / (8960 * 385 * 0.002);  // h / (rho c d); the Biot number is 8e-5
  const auto surface = march(
      plate,
      [](double) {
        return SurfaceHeat{0, 0, 15, 290};
      },
      10, 0, 360);
  for (int i : {9, 99, 359})
    EXPECT_NEAR(surface[std::size_t(i)], 290 + 50 * std::exp(-rate * 10 * (i + 1)), 50 * 1e-4);
}

TEST(HeatBalanceInvariant, HeatIsKept) {
  for (const Slab& matter :
       {Slab{1, 1600, 1250}, Slab{0.8, 1700, 900, 0.1, 290.0}, Slab{390, 8960, 385, 0.01}}) {
    HeatedSlab slab(matter, 285);
    const double step_s = 300, before = slab.heat_J_m2();
    double entered = 0, left = 0, by_hand = 0;
    for (int i = 0; i < 2 * 288; ++i) {
      const double t = i * step_s, from_K = slab.surface_K();
      const auto passed = slab.step(
          step_s, {weather(t), weather(t + HeatedSlab::inner * step_s), weather(t + step_s)});
      entered += passed.into_surface, left += passed.out_of_back;
      by_hand +=
          step_s * (weather(t).into(from_K) + weather(t + step_s).into(slab.surface_K())) / 2;
    }
    EXPECT_NEAR(slab.heat_J_m2() - before, entered - left, 1e-11 * before);
    // trapezoids over what the surface shows: of second order, so a thousandth of a day's sun
    EXPECT_NEAR(entered, by_hand, 1e-3 * 2 * day_s * 300);
  }
}

// Three solutions give the order without an exact one: (a - b) / (b - c) = 2^order.
TEST(HeatBalanceInvariant, StepsAreOfSecondOrder) {
  const auto after = [](const Slab& matter, std::size_t cells, int steps) {
    HeatedSlab slab(matter, 285, cells);
    return march(slab, weather, day_s / steps, steps - 1, steps).back();
  };
  for (const Slab& matter : {soil, Slab{390, 8960, 385, 0.01}}) {
    const double a = after(matter, 64, 48), b = after(matter, 64, 96),
                 c = after(matter, 64, 192);
    EXPECT_NEAR(std::log2((a - b) / (b - c)), 2, 0.2) << a << ' ' << b << ' ' << c;
  }
  const double a = after(soil, 16, 4000), b = after(soil, 32, 4000), c = after(soil, 64, 4000);
  EXPECT_NEAR(std::log2((a - b) / (b - c)), 2, 0.2) << a << ' ' << b << ' ' << c;
}

TEST(HeatBalanceRefusal, BeyondTheLimits) {
  const auto refused = [](Slab slab) -> std::string {
    try {
      HeatedSlab(slab, 300);
    } catch (const MathError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused(soil), "");
  EXPECT_EQ(refused({-1, 1600, 1250}), "a conductivity must be 0.001 to 10000 W/(m K), not -1");
  EXPECT_EQ(refused({1, 1e6, 1250}), "a density must be 1 to 30000 kg/m^3, not 1000000");
  EXPECT_EQ(refused({1, 1600, 1}), "a specific heat must be 10 to 20000 J/(kg K), not 1");
  EXPECT_EQ(refused({1, 1600, 1250, 0.0}), "a thickness must be 1e-05 to 100 m, not 0");
  EXPECT_EQ(refused({1, 1600, 1250, 0.1, std::nan("")}),
            "the temperature of the back must be 1 to 2000 K, not nan");
  EXPECT_EQ(refused({1, 1600, 1250, {}, 280.0}),
            "a half space has no back whose temperature could be held");
  EXPECT_THROW(HeatedSlab(soil, SurfaceHeat{100}), MathError);
}
