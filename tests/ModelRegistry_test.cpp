// The stated properties of the models (nw/surface/ModelRegistry.nw), each computed.
#include "malus/surface/ModelRegistry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "ModelChecks.hpp"
#include "malus/base/Random.hpp"
#include "malus/base/Refusal.hpp"

using namespace malus;
using namespace malus::testing;

namespace {
std::unique_ptr<CDBRDFModel> example(const ModelEntry& entry) {
  return exampleModel(entry, SpectralGrid::make({550}));
}

/// The largest degree of polarisation of what unpolarised light becomes over these geometries.
double largestDOP(const CDBRDFModel& model, const std::vector<BRDFGeometry>& geometries) {
  double most = 0;
  for (const BRDFGeometry& g : geometries) {
    const CDMuellerMatrix f = model.getBRDF(g).at(0);
    if (f.getScalar() > 0)
      most = std::max(most,
                      std::hypot(f.getMueller(1, 0), f.getMueller(2, 0), f.getMueller(3, 0)) /
                          f.getScalar());
  }
  return most;
}

std::vector<BRDFGeometry> everywhere() {
  std::vector<BRDFGeometry> all;
  for (const Angles& angles : someAngles(60)) all.push_back(angles.there());
  return all;
}
/// Straight back to oblique sources: facets are met face to face.
std::vector<BRDFGeometry> straightBack() {
  std::vector<BRDFGeometry> all;
  for (const double deg : {20.0, 40.0, 60.0, 75.0})
    all.push_back(BRDFGeometry::fromDegrees(deg, deg, 0));
  return all;
}
// A polarisation of less than a thousandth counts as none; that of rounding would be 1e-12, and
// the least of the polarising models has some per cent. Reciprocity of the models that have it
// holds to rounding, and what lacks it lacks it by per cents.
constexpr double polarized = 1e-3, irreciprocal = 1e-6, above_one = 1e-6;
}  // namespace

// At the example and, where there is one, at the counterexample of a property that the model
// does not have.
TEST(ModelRegistryInvariant, EveryPromiseIsKeptAtTheExample) {
  for (const ModelEntry& entry : modelEntries()) {
    const auto model = example(entry);
    const ModelTraits& traits = entry.traits;
    EXPECT_EQ(largestDOP(*model, everywhere()) > polarized, traits.polarized)
        << entry.name << ' ' << largestDOP(*model, everywhere());
    EXPECT_EQ(largestDOP(*model, straightBack()) > polarized, traits.diffuse_polarized)
        << entry.name << ' ' << largestDOP(*model, straightBack());
    EXPECT_EQ(reciprocityError(*model) < irreciprocal, traits.reciprocal)
        << entry.name << ' ' << reciprocityError(*model);
    expectRealizable(*model, 1e-9);
    if (traits.witness.empty()) {
      EXPECT_EQ(largestDHR(*model) <= 1 + above_one,
                traits.conserves || !traits.conserves_with.empty())
          << entry.name << ' ' << largestDHR(*model);
    } else {
      const auto witness = exampleModel(entry, SpectralGrid::make({550}), traits.witness);
      EXPECT_GT(largestDHR(*witness), 1.01) << entry.name;
    }
  }
}

namespace {
using Words = std::map<std::string, std::string>;
/// Every combination of the words that a model's parameters may be.
std::vector<Words> choicesOf(const ModelEntry& entry) {
  std::vector<Words> all{{}};
  for (const Parameter& parameter : entry.parameters) {
    std::vector<Words> more;
    for (const Words& words : all)
      for (const std::string& word : parameter.words)
        more.push_back(words), more.back()[parameter.name] = word;
    if (!parameter.words.empty()) all = more;
  }
  return all;
}
/// Whether these words are one of the alternatives of "a=b c=d or a=e".
bool among(const Words& words, const std::string& alternatives) {
  std::istringstream stream(alternatives + " or");
  bool fits = true, any = false;
  for (std::string word; stream >> word;) {
    if (word == "or") {
      if (fits && any) return true;
      fits = true, any = false;
      continue;
    }
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) return false;  // no settings, but a sentence
    any = true;
    const auto found = words.find(word.substr(0, equals));
    fits = fits && found != words.end() && found->second == word.substr(equals + 1);
  }
  return false;
}
/// A number from all of a parameter's range: an end of it, or drawn evenly, or over all orders of magnitude.
double drawn(const Parameter& parameter, Random& random) {
  const auto& [least_of_all, high, open] = parameter.limits;
  const double low = open ? high * 1e-9 : least_of_all;
  const double which = random.uniform(), u = random.uniform();
  if (which < 1.0 / 6) return low;
  if (which < 1.0 / 3) return high;
  if (which < 0.6) return low + (high - low) * u;
  const double least = std::max(low, high * 1e-9);
  return std::min(high, least * std::pow(high / least, u));
}
struct Found {  // the worst of all draws
  double dop = 0, dop_back = 0, exchange = 0, dhr = 0;
  int made = 0;
};
Found swept(const ModelEntry& entry, const Words& words, int draws) {
  Random random(1967);
  Found worst;
  for (int i = 0; i < draws; ++i) {
    Arguments arguments;
    for (const Parameter& parameter : entry.parameters)
      arguments[parameter.name] = {parameter.words.empty()
                                       ? fmt::format("{}", drawn(parameter, random))
                                       : words.at(parameter.name),
                                   {"draw", 0, parameter.name}};
    std::unique_ptr<CDBRDFModel> model;
    try {
      model = entry.make(checkedSettings(entry, arguments, SpectralGrid::make({550})));
    } catch (const InputError&) {
      continue;  // right each for itself and wrong together
    }
    ++worst.made;
    worst.dop = std::max(worst.dop, largestDOP(*model, everywhere()));
    worst.dop_back = std::max(worst.dop_back, largestDOP(*model, straightBack()));
    worst.exchange = std::max(worst.exchange, reciprocityError(*model));
    worst.dhr = std::max(worst.dhr, largestDHR(*model));
  }
  return worst;
}
// What straight lines between the nodes of a table may add to the light that returns. The glossy coating's transmission has
// 128 cells over the root of the cosine: where it is concave upwards (an index of 10 near 60 degrees) the chord lies
// h^2 T''/8 = 1.0e-5 above it, and in the mean over all directions at most as much again. The body of a paint has nine
// nodes a direction, and its own tests allow it 1e-4.
double interpolation(const ModelEntry& entry) {
  return entry.name == "layered-paint" ? 1e-4 : 2e-5;
}
}  // namespace

// All settings that a user may choose, corners included. What has no parameters but a file is
// as good as that.
TEST(ModelRegistryInvariant, EveryPromiseIsKeptWithAllParameters) {
  for (const ModelEntry& entry : modelEntries()) {
    if (std::any_of(entry.parameters.begin(), entry.parameters.end(),
                    [](const Parameter& p) { return p.file; }))
      continue;
    const ModelTraits& t = entry.traits;
    // Mie's series for each draw of a paint; the others are cheap
    const int draws = entry.name == "layered-paint" ? 4 : choicesOf(entry).size() > 3 ? 12 : 24;
    double largest = 0, exchange = 0;
    for (const Words& words : choicesOf(entry)) {
      const Found found = swept(entry, words, draws);
      std::string told = entry.name;
      for (const auto& [name, word] : words) told += " " + name + "=" + word;
      EXPECT_GT(found.made, 0) << told;
      if (!t.polarized) {
        EXPECT_LT(found.dop, polarized) << told;
      }
      if (!t.diffuse_polarized) {
        EXPECT_LT(found.dop_back, polarized) << told;
      }
      if (t.reciprocal || among(words, t.reciprocal_with)) {
        EXPECT_LT(found.exchange, irreciprocal) << told;
      } else {
        exchange = std::max(exchange, found.exchange);
      }
      if (t.conserves || among(words, t.conserves_with)) {
        EXPECT_LT(found.dhr, 1 + interpolation(entry)) << told;
      } else {
        largest = std::max(largest, found.dhr);
      }
    }
    // control: the same draws find models without the property
    if (!t.reciprocal) {
      EXPECT_GT(exchange, 0.01) << entry.name;
    }
    if (!t.conserves) {
      EXPECT_GT(largest, 1.1) << entry.name;
    }
  }
}

// The alternatives are read as they are meant, and each names words that the model has.
TEST(ModelRegistryIdentity, SettingsOfAPromiseAreSettingsOfTheModel) {
  EXPECT_TRUE(among({{"a", "1"}, {"b", "2"}}, "a=3 or a=1 b=2"));
  EXPECT_FALSE(among({{"a", "1"}, {"b", "3"}}, "a=3 or a=1 b=2"));
  EXPECT_FALSE(among({{"a", "1"}}, "") || among({}, "a file that conserves energy"));
  for (const ModelEntry& entry : modelEntries())
    for (const std::string& with :
         {entry.traits.reciprocal_with, entry.traits.conserves_with}) {
      if (with.find('=') == std::string::npos) continue;
      const std::vector<Words> all = choicesOf(entry);
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Words& words) {
        return among(words, with);
      })) << entry.name;
    }
}

// Some models have each property and others do not, so each comparison above can fail.
TEST(ModelRegistryInvariant, NegativeControlEachPromiseIsMadeAndNotMade) {
  std::array<std::set<bool>, 4> seen;
  for (const ModelEntry& entry : modelEntries()) {
    const ModelTraits& t = entry.traits;
    const std::array<bool, 4> promises{t.polarized, t.diffuse_polarized, t.reciprocal,
                                       t.conserves};
    for (std::size_t i = 0; i < 4; ++i) seen[i].insert(promises[i]);
  }
  for (const auto& answers : seen) EXPECT_EQ(answers.size(), 2u);
}

TEST(ModelRegistryIdentity, EveryModelSaysWhatItIsFor) {
  std::set<std::string> names;
  for (const ModelEntry& entry : modelEntries()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.traits.materials.empty()) << entry.name;
    EXPECT_FALSE(entry.traits.example.empty()) << entry.name;
    EXPECT_FALSE(entry.summary.empty() || entry.citation.empty()) << entry.name;
    for (const Parameter& parameter : entry.parameters) {
      EXPECT_FALSE(parameter.meaning.empty()) << entry.name << ' ' << parameter.name;
      if (parameter.otherwise.empty()) {
        EXPECT_NE((' ' + entry.traits.example).find(' ' + parameter.name + '='),
                  std::string::npos)
            << entry.name << ": the example lacks " << parameter.name;
      }
    }
  }
}

// The model of the thesis becomes reciprocal with another diffuse term, as the chapter says.
TEST(ModelRegistryIdentity, AnotherDiffuseTermIsReciprocal) {
  ModelEntry entry = modelEntry("torrance-sparrow", {});
  EXPECT_FALSE(entry.traits.reciprocal);
  entry.traits.example += " diffuse=reciprocal";
  EXPECT_LT(reciprocityError(*example(entry)), irreciprocal);
}

TEST(ModelRegistryIdentity, ASmoothFaceHasTheLeastSlope) {
  EXPECT_EQ(slopeOf(0.2), 0.2);
  EXPECT_EQ(slopeOf(1e-6), 1e-6);
  EXPECT_EQ(slopeOf(0), 1e-6);
}

// What a constructor refuses, and a file that ends too early, is the user's. Anything else is
// ours, and must not be reported as theirs.
TEST(ModelRegistryIdentity, OnlyARefusalIsTheUsersMistake) {
  ModelSettings settings;
  settings.place = {"scene.json", 7, "/materials/paint", 0};
  const auto making = [&](const auto& error) {
    return [&] {
      orRefuse(settings, "paint", "give less",
               [&]() -> std::unique_ptr<CDBRDFModel> { throw error; });
    };
  };
  try {
    making(Refusal("too bright"))();
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "scene.json:7: /materials/paint: paint: too bright; give less");
  }
  EXPECT_THROW(making(InterpolationError("ends at 600 nm"))(), InputError);
  EXPECT_THROW(making(MathError("a division by zero"))(), MathError);
  EXPECT_THROW(making(GridError("two grids"))(), GridError);
}
