// The live figures against the classes that they show (nw/live/LiveFigures.nw).
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "malus/base/Angles.hpp"
#include "malus/light/CDPolarimetricMath.hpp"
#include "malus/live/LiveFigure.hpp"
#include "malus/surface/Fresnel.hpp"

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

/// The figure's answer with some controls moved.
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
  EXPECT_EQ(liveDigits(2e-6), "2e-06");
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
