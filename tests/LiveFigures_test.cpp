// The live figures against the classes that they show (nw/live/LiveFigures.nw, LiveFigure.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "malus/air/NeutralPoints.hpp"
#include "malus/air/RayleighLight.hpp"
#include "malus/base/Angles.hpp"
#include "malus/light/CDPolarimetricMath.hpp"
#include "malus/live/LiveFigure.hpp"
#include "malus/render/ErrorBars.hpp"
#include "malus/surface/BRDFTorranceSparrow.hpp"
#include "malus/surface/Fresnel.hpp"
#include "malus/thesis/Section71.hpp"

using namespace malus;

namespace {
const LiveFigure& figure(std::string_view name) {
  for (const LiveFigure& one : liveFigures())
    if (one.name == name) return one;
  throw std::out_of_range(std::string(name));
}

std::vector<double> initial(const LiveFigure& of) {
  std::vector<double> values;
  for (const LiveControl& control : of.controls) values.push_back(control.initial);
  return values;
}

/// The figure's result with some controls moved.
LiveAnswer answer(std::string_view name, const std::map<std::string_view, double>& moved = {}) {
  const LiveFigure& of = figure(name);
  std::vector<double> values = initial(of);
  for (const auto& [control, value] : moved) {
    std::size_t i = 0;
    while (of.controls.at(i).name != control) ++i;
    values[i] = value;
  }
  return of.evaluate(values);
}

/// The first number with this label, at or behind a position.
std::string text(const LiveAnswer& of, std::string_view label, std::size_t from = 0) {
  for (std::size_t i = from; i < of.numbers.size(); ++i)
    if (of.numbers[i].label == label) return of.numbers[i].text;
  return "none";
}

const std::vector<double>& curve(const LiveAnswer& of, std::string_view name) {
  for (const LiveCurve& one : of.curves)
    if (one.name == name) return one.values;
  throw std::out_of_range(std::string(name));
}
}  // namespace

TEST(LiveFigures, EachControlMovesToBothEndsAndChangesSomething) {
  for (const LiveFigure& of : liveFigures())
    for (std::size_t i = 0; i < of.controls.size(); ++i) {
      const LiveControl& control = of.controls[i];
      SCOPED_TRACE(std::string(of.name) + " " + std::string(control.name));
      EXPECT_LE(control.least, control.initial);
      EXPECT_LE(control.initial, control.most);
      EXPECT_GT(control.step, 0);
      if (!control.choices.empty()) {
        EXPECT_EQ(control.most, double(control.choices.size() - 1));
      }
      std::vector<std::string> seen;
      for (const double value : {control.least, control.most}) {
        std::vector<double> values = initial(of);
        values[i] = value;
        const LiveAnswer moved = of.evaluate(values);
        std::string all;
        for (const LiveNumber& number : moved.numbers) all += number.text + " ";
        for (const LiveCurve& one : moved.curves)
          for (const double at : one.values) {
            ASSERT_FALSE(std::isnan(at)) << one.name;
            all += liveDigits(at);
          }
        seen.push_back(all);
      }
      if (control.unit != "°" || control.most - control.least < 180) {
        EXPECT_NE(seen[0], seen[1]);
      }
    }
}

TEST(LiveFigures, DigitsAreFiveAndZeroIsZero) {
  EXPECT_EQ(liveDigits(1.1803984), "1.1804");
  EXPECT_EQ(liveDigits(-1e-17), "0");
  EXPECT_EQ(liveDigits(9e-7), "0");
  EXPECT_EQ(liveDigits(3.12271e-5), "0.000031227");
  EXPECT_EQ(liveDigits(123456.7), "1.2346e+05");
}

TEST(LiveFigures, StokesVectorIsTheOneOfItsEllipse) {
  const LiveAnswer live = answer("stokes", {{"polarized", 0.5}, {"psi", 30}, {"chi", -20}});
  const CDStokesVector s = stokesFromEllipse(toRadians(-20), toRadians(30));
  EXPECT_EQ(text(live, "S0"), "1");
  for (int i = 1; i < 4; ++i)
    EXPECT_EQ(text(live, "S" + std::to_string(i)), liveDigits(s.getStokes(i) / 2));
  EXPECT_EQ(text(live, "AoLP"), "30");
  // the tip turns clockwise for left-handed light, and its longest distance is the major axis
  const auto &x = curve(live, "x"), &y = curve(live, "y");
  double longest = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    EXPECT_LT(x[i] * y[i + 1] - y[i] * x[i + 1], 0);
    longest = std::max(longest, std::hypot(x[i], y[i]));
  }
  EXPECT_NEAR(longest, (0.5 * s).getEllipse().a, 1e-9);  // that of cosineAndSine
}

TEST(LiveFigures, ChainIsTheProductOfItsElements) {
  const LiveAnswer live = answer(
      "chain",
      {{"light", 3}, {"first", 0}, {"retardance", 90}, {"fast_axis", 0}, {"second_angle", 20}});
  const CDStokesVector plate = retarder(toRadians(90), 0) * plus_45_light;
  const CDStokesVector last = linearPolarizer(toRadians(20)) * plate;
  for (int i = 0; i < 4; ++i) {
    const std::string label = "S" + std::to_string(i);
    EXPECT_EQ(text(live, label), liveDigits(plus_45_light.getStokes(i)));
    EXPECT_EQ(text(live, label, 8), liveDigits(plate.getStokes(i)));
    EXPECT_EQ(text(live, label, 12), liveDigits(last.getStokes(i)));
  }
  // Malus: behind a polariser at 0 degrees an analyser at theta passes cos^2
  const LiveAnswer law = answer("chain", {{"retardance", 0}});
  const auto &angle = curve(law, "angle"), &passed = curve(law, "passed");
  for (std::size_t i = 0; i < angle.size(); ++i)
    EXPECT_NEAR(passed[i], std::pow(std::cos(toRadians(angle[i])), 2) / 2, 1e-15);
}

TEST(LiveFigures, FresnelIsTheReflectanceOfTheBoundary) {
  const LiveAnswer live = answer("fresnel", {{"n", 0.405}, {"k", 2.95}, {"theta", 35}});
  const Reflectances at = fresnelReflectances(toRadians(35), 0.405, 2.95);
  EXPECT_EQ(text(live, "Rs"), liveDigits(at.Rs));
  EXPECT_EQ(text(live, "Rs"), "0.87597");  // by hand, chapter Fresnel
  EXPECT_EQ(text(live, "Rp"), liveDigits(at.Rp));
  EXPECT_EQ(curve(live, "Rs")[70], at.Rs);
  EXPECT_EQ(text(answer("fresnel"), "least Rp at"), liveDigits(toDegrees(brewsterAngle(2))));
}

TEST(LiveFigures, LobeIsTheModelOfTheCommand) {
  const LiveAnswer live = answer(
      "lobe",
      {{"n", 1.5}, {"k", 0}, {"sigma", 0.3}, {"theta_r", 55}, {"phi", 120}, {"diffuse", 2}});
  const BRDFTorranceSparrow model(1.5, 0, 0.3, {Shadowing::vGroove, DiffuseTerm::reciprocal});
  const CDMuellerMatrix f = model.at(BRDFGeometry::fromDegrees(30, 55, 120));
  for (int i = 0; i < 16; ++i)
    EXPECT_EQ(live.numbers[std::size_t(i)].text, liveDigits(f.getMueller(i / 4, i % 4)));
  const auto &zenith = curve(live, "zenith"), &f00 = curve(live, "f00");
  for (std::size_t i = 0; i < zenith.size(); ++i)
    if (zenith[i] == 55) {
      EXPECT_EQ(f00[i], f.getScalar());
    } else if (zenith[i] == -20) {
      EXPECT_EQ(f00[i], model.at(BRDFGeometry::fromDegrees(30, 20, 300)).getScalar());
    }
}

TEST(LiveFigures, PlateBeginsWithTheParametersOfTheThesis) {
  const std::vector<double> values = initial(figure("plate"));
  EXPECT_EQ(std::vector<double>(values.begin(), values.begin() + 5),
            (std::vector<double>{CopperPlate::n, CopperPlate::k, CopperPlate::sigma,
                                 CopperPlate::theta_i_deg, CopperPlate::theta_r_deg}));
  const std::vector<double> lobe = initial(figure("lobe"));
  EXPECT_EQ(std::vector<double>(lobe.begin(), lobe.begin() + 6),
            (std::vector<double>{CopperPlate::n, CopperPlate::k, CopperPlate::sigma,
                                 CopperPlate::theta_i_deg, CopperPlate::theta_r_deg,
                                 CopperPlate::phi_deg}));
}

TEST(LiveFigures, PlateShowsPrintedAndComputedDigits) {
  const LiveAnswer live = answer("plate", {{"light", 1}});
  const CDMuellerMatrix f = copperPlateBRDF();
  const CDStokesVector L = reflectedRadiance(f, {100, 30, 40, 0});  // second row of table 7.1
  std::size_t differ = 0;
  for (const LiveNumber& number : live.numbers) differ += number.text != number.printed;
  EXPECT_EQ(live.numbers.size(), 27U);
  EXPECT_GT(differ, 0U);  // f33 has the wrong sign in print
  EXPECT_EQ(text(live, "f33"), "-1.131");
  EXPECT_EQ(text(live, "f23"), "0.3026");
  EXPECT_NEAR(std::stod(text(live, "L1 manual")), L.getStokes(1), 0.005);
  EXPECT_NEAR(std::stod(text(live, "L3 traced")), L.getStokes(3), 0.005);
  EXPECT_NEAR(std::stod(text(live, "DoLP traced")), 100 * L.getDOLP(), 0.05);
}

TEST(LiveFigures, SkyIsRayleighsAndHasItsNeutralPoints) {
  const LiveAnswer live =
      answer("sky", {{"sun", 75}, {"tau", 0.3}, {"albedo", 0.25}, {"theta", 31}, {"phi", 200}});
  const RayleighAtmosphere air(0.3);
  const RayleighLight light(air, std::cos(toRadians(75)), 0.25, std::numbers::pi);
  const auto dome = [&](double zenith_deg, double phi_rad) {
    return light.down(std::cos(toRadians(zenith_deg)),
                      RayleighLight::Azimuth::fromRadians(phi_rad));
  };
  const CDStokesVector here = dome(31, toRadians(200));
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(text(live, "S" + std::to_string(i)), liveDigits(here.getStokes(i)));
  const std::vector<NeutralPoint> points = neutralPoints(dome, 75);
  ASSERT_EQ(points.size(), 2U);
  for (const NeutralPoint& point : points)
    EXPECT_EQ(text(live, point.name), liveDigits(point.zenith_deg));
  EXPECT_EQ(curve(live, "dome")[31 * 180 + 100], here.getDOLP());
  EXPECT_EQ(curve(answer("sky", {{"quantity", 2}}), "dome").size(), 91U * 180U);
}

TEST(LiveFigures, BiasIsTakenOffAsTheProductsDo) {
  // unpolarised light shows b sqrt(pi/2) (chapter ErrorBars); 2000 draws give it to b sqrt((2 -
  // pi/2)/2000)
  const LiveAnswer none = answer("bias", {{"p0", 0}, {"b", 2}});
  EXPECT_NEAR(std::stod(text(none, "bias")), std::sqrt(std::numbers::pi / 2),
              4 * std::sqrt((2 - std::numbers::pi / 2) / 2000));
  EXPECT_LT(std::stod(text(none, "bias left")), std::stod(text(none, "bias")));
  const LiveAnswer strong = answer("bias", {{"p0", 10}, {"b", 1}});
  EXPECT_NEAR(std::stod(text(strong, "bias left")), 0, 4 / std::sqrt(2000.0));
  double all = 0;
  for (const double share : curve(strong, "count")) all += share;
  EXPECT_NEAR(all, 1, 0.01);  // a few are beyond four standard errors
  EXPECT_NE(text(answer("bias", {{"seed", 2}}), "mean"), text(answer("bias"), "mean"));
}

TEST(LiveFigures, EverySamplingEstimatesTheReflectance) {
  const BRDFTorranceSparrow copper(CopperPlate::n, CopperPlate::k, 0.3,
                                   {Shadowing::vGroove, DiffuseTerm::none});
  for (int method = 0; method < 5; ++method) {
    const LiveAnswer live =
        answer("sampling", {{"method", method}, {"count", 1024}, {"sigma", 0.3}});
    SCOPED_TRACE(method);
    EXPECT_EQ(text(live, "exact"), liveDigits(copper.getDHR(toRadians(40))[0]));
    EXPECT_LT(std::abs(std::stod(text(live, "error"))),
              method < 2 ? 20 : 3);  // 1024 random directions: 4 % is a standard error
    EXPECT_EQ(std::to_string(curve(live, "zenith").size()), text(live, "directions"));
  }
}
