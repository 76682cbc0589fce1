// Solutions of several bands that share what does not depend on the wavelength (nw/air/SharedByBands.nw).
#include "malus/air/SharedByBands.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "malus/air/LayeredLight.hpp"
#include "malus/surface/BRDFNadalBreon.hpp"

using namespace malus;

namespace {
AirGround lawn(double body) {
  return {0, std::make_shared<BRDFNadalBreon>(
                 CDSpectralVector<double>(SpectralGrid::make({550.0}), body), 0.03, 8.0)};
}
/// One solution, in numbers.
std::vector<double> solved(double depth, double sun, const AirGround& ground,
                           const std::vector<double>& views, int terms,
                           const std::shared_ptr<SharedByBands>& shared) {
  const LayeredLight light(
      {{{rayleighScatterer(0.03), depth}, {henyeyGreensteinScatterer(0.6), depth}}}, sun,
      ground, 1, views, {0, depth},
      {.streams = 16, .terms = terms, .thinnest = 1e-3, .shared = shared});
  std::vector<double> numbers{light.diffuseUp(0), light.diffuseDown(1)};
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int c = 0; c < 4; ++c) {
      numbers.push_back(light.up(v, 0.7, 0).getStokes(c));
      numbers.push_back(light.down(v, 0.7, 1).getStokes(c));
    }
  return numbers;
}
}  // namespace

TEST(SharedByBandsIdentity, SharedOrNotTheBitsAreTheSame) {
  const auto shared = std::make_shared<SharedByBands>();
  const AirGround green = lawn(0.1), red = lawn(0.04);
  const std::vector<double> few{0.5}, more{0.3, 0.5};
  const auto same = [&](double depth, double sun, const AirGround& ground,
                        const std::vector<double>& views, int terms) {
    EXPECT_EQ(solved(depth, sun, ground, views, terms, shared),
              solved(depth, sun, ground, views, terms, nullptr))
        << depth << ' ' << sun << ' ' << views.size() << ' ' << terms;
  };
  same(0.1, 0.6, green, few, 8), same(0.2, 0.6, green, few, 8);  // another band
  same(0.1, 0.6, red, few, 8), same(0.1, 0.6, {0.2}, few, 8), same(0.1, 0.6, {0.3}, few, 8);
  same(0.1, 0.5, green, few, 8), same(0.1, 0.5, green, more, 8),
      same(0.1, 0.5, green, more, 10);
  same(0.1, 0.6, green, few, 8);  // and back
  EXPECT_NE(solved(0.1, 0.6, green, few, 8, nullptr), solved(0.1, 0.6, red, few, 8, nullptr));
}

// What fits is kept, and what does not is made again.
TEST(SharedByBandsIdentity, WhatFitsIsTheSameObject) {
  SharedByBands shared;
  const std::vector<double> views{0.5};
  const auto first =
                 SharedByBands::keep<LayerDirections>(&shared, 0.6, views, std::size_t{8}, 16),
             again =
                 SharedByBands::keep<LayerDirections>(&shared, 0.6, views, std::size_t{8}, 16),
             other =
                 SharedByBands::keep<LayerDirections>(&shared, 0.6, views, std::size_t{8}, 18);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
  const AirGround ground = lawn(0.1);
  EXPECT_EQ(SharedByBands::keep<LayerGround>(&shared, *first, ground),
            SharedByBands::keep<LayerGround>(&shared, *again, ground));
  EXPECT_NE(SharedByBands::keep<LayerGround>(nullptr, *first, ground),
            SharedByBands::keep<LayerGround>(nullptr, *first, ground));
}

TEST(SharedByBandsInvariant, ThreadsMayBeginTogether) {
  const auto shared = std::make_shared<SharedByBands>();
  const AirGround ground = lawn(0.1);
  const std::vector<double> expected = solved(0.1, 0.6, ground, {0.5}, 8, nullptr);
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> found(4);
  for (auto& one : found)
    threads.emplace_back([&] { one = solved(0.1, 0.6, ground, {0.5}, 8, shared); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& one : found) EXPECT_EQ(one, expected);
}
