// Copies of a mesh in a scene: written out, shared, and from a table (nw/files/ScenePlacements.nw).
#include "malus/files/ScenePlacements.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "Scratch.hpp"
#include "malus/app/SceneDescription.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/Random.hpp"
#include "malus/files/SceneReader.hpp"
#include "malus/render/Renderer.hpp"

using namespace malus;
using nlohmann::json;

namespace {
const std::string bar = std::filesystem::absolute("scenes/chunky-bar.obj").string();

/// Bars on a meadow; every third has different names.
struct Bars {
  json list = json::array();
  std::string table = "x_m,y_m,z_m,rotate_z_deg,rotate_x_deg,scale,facet_prefix\n";
  Bars() {
    Random random(3);
    for (int i = 0; i < 25; ++i) {
      const double x = 4 * (i % 5) - 8, y = 4 * (i / 5) - 8, z = 0.5 + random.uniform();
      const double turn = 360 * random.uniform(), tilt = 20 * random.uniform(),
                   scale = 0.4 + random.uniform();
      const std::string prefix = i % 3 ? "" : fmt::format("bar-{}.", i);
      list.push_back({{"translate_m", {x, y, z}},
                      {"rotate_deg", {tilt, 0, turn}},
                      {"scale", scale},
                      {"facet_prefix", prefix}});
      table += fmt::format("{},{},{},{},{},{},{}\n", x, y, z, turn, tilt, scale, prefix);
    }
  }
};

json meadow(const json& instances, bool shared) {
  json entry = {{"obj", bar},
                {"material", "paint"},
                {"translate_m", {0.1, 0.2, 0}},
                {"instances", instances}};
  if (shared) entry["shared"] = true;
  return {{"malus", 1},
          {"bands", {{"wavelength_nm", {550}}}},
          {"geometry", {entry, {{"ground", {{"material", "soil"}}}}}},
          {"materials",
           {{"paint", {{"model", "torrance-sparrow"}, {"n", 1.5}, {"k", 0}, {"sigma", 0.2}}},
            {"soil", {{"model", "lambertian"}, {"reflectance", 0.3}}}}},
          {"sun", {{"zenith_deg", 40}, {"azimuth_deg", 130}, {"irradiance_W_m2_nm", 1}}},
          {"sky", {{"model", "uniform"}, {"radiance_W_m2_sr_nm", 0.1}}},
          {"sensor",
           {{"kind", "framing"}, {"width", 48}, {"height", 48}, {"field_of_view_deg", 50}}},
          {"platform", {{"position_m", {-14, -12, 15}}, {"look_at_m", {0, 0, 0}}}},
          {"radiometry", {{"rays", {8, 2}}}}};
}

Scene sceneOf(const json& scene, const std::filesystem::path& folder = ".") {
  return readSceneText(scene.dump(), "s.json", folder);
}

std::string complaint(const json& scene, const std::filesystem::path& folder) {
  try {
    sceneOf(scene, folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}
}  // namespace

// The same triangles, the same names, the same random numbers: a pixel differs by rounding, unless single precision finds the other
// of two triangles at an edge for one of its 20 rays; a tenth of the pixels may.
TEST(ScenePlacementsIdentity, SharedCopiesLookLikeCopiesThatAreWrittenOut) {
  const Bars bars;
  const Scene flat = sceneOf(meadow(bars.list, false)),
              shared = sceneOf(meadow(bars.list, true));
  EXPECT_EQ(flat.world.geometry.instances().size(), 0u);
  EXPECT_EQ(shared.world.geometry.instances().size(), 25u);
  EXPECT_EQ(shared.world.geometry.sharedMeshes().size(), 1u);
  EXPECT_EQ(shared.world.geometry.triangles().size(), 0u);
  const RenderedImage a = renderScene(flat), b = renderScene(shared);
  ASSERT_EQ(a.stokes.size(), b.stokes.size());
  std::size_t other_names = 0, others = 0, bars_seen = 0;
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.truth.size(); ++i) {
    const auto name = [i](const Scene& scene, const RenderedImage& picture) {
      const std::uint32_t facet = picture.truth[i].facet;
      return facet == Hit::nothing ? "" : scene.world.geometry.facetNames()[facet];
    };
    other_names += name(flat, a) != name(shared, b);
    bars_seen += name(shared, b).starts_with("bar-");
    others += std::abs(a.stokes[4 * i] - b.stokes[4 * i]) > 1e-4 * a.stokes[4 * i];
    sum_a += a.stokes[4 * i], sum_b += b.stokes[4 * i];
  }
  EXPECT_LE(other_names, 3u);
  EXPECT_GT(bars_seen, 100u);
  EXPECT_LE(others, a.truth.size() / 10);
  EXPECT_NEAR(sum_b, sum_a, 1e-3 * sum_a);
}

TEST(ScenePlacementsIdentity, ATableSaysWhatAListSays) {
  const Bars bars;
  const Scratch scratch;
  put(scratch / "bars.csv", bars.table);
  const Scene list = sceneOf(meadow(bars.list, true));
  for (const bool shared : {true, false}) {
    const Scene table = sceneOf(meadow({{"file", "bars.csv"}}, shared), scratch.path);
    const SceneGeometry &one = list.world.geometry, &other = table.world.geometry;
    ASSERT_EQ(one.countTriangles(), other.countTriangles());
    EXPECT_EQ(one.facetNames(), other.facetNames());
    const auto each = static_cast<std::uint32_t>(one.sharedMeshes()[0].triangles.size());
    for (std::uint32_t i = 0; i < 25 * each; i += 7) {
      const PlacedTriangle a = one.placed(i % each, i / each),
                           b = shared ? other.placed(i % each, i / each) : other.placed(i);
      EXPECT_EQ(a.facet, b.facet);
      EXPECT_LT((a.corners[0] - b.corners[0]).getLength(), 1e-9);
    }
    EXPECT_EQ(std::ranges::count(table.files, scratch.path / "bars.csv"), 1);
  }
  EXPECT_NE(describeScene(list).find("of them in 25 instances of 1 shared meshes"),
            std::string::npos);
}

TEST(ScenePlacementsIdentity, BadTablesNameTheirLine) {
  const Scratch scratch;
  const auto said = [&](const std::string& table) {
    put(scratch / "p.csv", table);
    return complaint(meadow({{"file", "p.csv"}}, true), scratch.path);
  };
  const auto says = [&](const std::string& table, const std::string& part) {
    const std::string all = said(table);
    EXPECT_NE(all.find(part), std::string::npos) << all;
    EXPECT_NE(all.find("geometry[0].instances.file"), std::string::npos) << all;
  };
  EXPECT_EQ(said("x_m,y_m,z_m\n1,2,3\n"), "none");
  says("x_m,y_m\n1,2\n", "z_m");
  says("x_m,y_m,z_m,skale\n1,2,3,1\n",
       "skale: is not a column of placements; did you mean "
       "scale");
  says("x_m,y_m,z_m,scale\n1,2,3,1\n1,2,3,0\n", "p.csv:3: scale = 0: is out of its range");
  says("x_m,y_m,z_m\n1,2,three\n", "p.csv:2: z_m = three: is not a number");
  says("x_m,y_m,z_m\n", "places nothing");
  EXPECT_NE(complaint(meadow({{"file", "none.csv"}}, true), scratch.path).find("none.csv"),
            std::string::npos);
  EXPECT_NE(complaint(meadow({{"fil", "p.csv"}}, true), scratch.path).find("fil"),
            std::string::npos);
}

// A camera in one of the bars: known without looking at those in whose boxes it is not.
TEST(ScenePlacementsInvariant, ACameraInASharedSolidIsRefused) {
  json scene = meadow(json::array({{{"translate_m", {0, 0, 0}}}}), true);
  scene["platform"]["position_m"] = {2.1, -1.8, 0.3};
  const std::string shared = complaint(scene, ".");
  scene["geometry"][0]["shared"] = false;
  for (const std::string& said : {shared, complaint(scene, ".")})
    EXPECT_NE(said.find("is inside a solid"), std::string::npos) << said;
  scene["platform"]["position_m"] = {2.1, -1.8, 1.3};  // above it
  scene["geometry"][0]["shared"] = true;
  EXPECT_EQ(complaint(scene, "."), "none");
}

namespace {
const std::string bus_path =
    "time_s,x_m,y_m,z_m,heading_deg\n0,0,0,0,90\n2,20,0,0,90\n3,24,4,0,0\n";

/// A bar with a path, shared or not, and pictures of three times from above.
json moving(const std::string& file, bool shared) {
  json scene = meadow(json::array({json::object()}), shared);
  scene["geometry"][0].erase("translate_m");
  scene["geometry"][0]["instances"][0]["path"] = file;
  const auto pose = [](double time_s) {
    return json{{"position_m", {22, 2, 40}},
                {"look_at_m", {22, 2, 0}},
                {"up", {0, 1, 0}},
                {"time_s", time_s}};
  };
  scene["platform"] = {{"poses", {pose(0), pose(2.5), pose(3)}}};
  scene["sensor"]["field_of_view_deg"] = 20;
  return scene;
}
}  // namespace

// By hand: 10 m in the first second; at 2.5 s half of the way from (20, 0) to (24, 4), and half of the turn from east to north.
TEST(ScenePlacementsIdentity, AThingFollowsItsPath) {
  const Scratch scratch;
  put(scratch / "bus.csv", bus_path);
  const SceneText text(R"({"path": "bus.csv"})", "t.json", scratch.path);
  const auto nose = [&](double time_s) {
    const Transform map = readMotion(text.root(), time_s);
    return std::pair{map.origin, map.apply({0, 1, 0}) - map.origin};
  };
  EXPECT_NEAR((nose(1).first - CDVector{10, 0, 0}).getLength(), 0, 1e-12);
  EXPECT_NEAR((nose(1).second - CDVector{1, 0, 0}).getLength(), 0, 1e-12);
  EXPECT_NEAR((nose(2.5).first - CDVector{22, 2, 0}).getLength(), 0, 1e-12);
  EXPECT_NEAR((nose(2.5).second - CDVector{M_SQRT1_2, M_SQRT1_2, 0}).getLength(), 0, 1e-12);
  EXPECT_NEAR((nose(3).second - CDVector{0, 1, 0}).getLength(), 0, 1e-12);
  put(scratch / "bus.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n2,-20,0,0\n");
  EXPECT_NEAR((nose(1).second - CDVector{-1, 0, 0}).getLength(), 0, 1e-12) << "along its way";
  EXPECT_THROW(nose(2.1), InputError);
}

TEST(ScenePlacementsIdentity, PicturesShowThingsWhereTheirPathsLead) {
  const Scratch scratch;
  put(scratch / "bus.csv", bus_path);
  for (const bool shared : {true, false}) {
    const Scene scene = sceneOf(moving("bus.csv", shared), scratch.path);
    std::array<int, 3> seen{};
    for (std::size_t frame = 0; frame < 3; ++frame)
      for (const Radiometry::Truth& truth : renderScene(scene, frame).truth)
        seen[frame] += truth.facet != Hit::nothing &&
                       scene.world.geometry.facetNames()[truth.facet] != "ground";
    EXPECT_EQ(seen[0], 0) << "it is 22 m away";
    EXPECT_GT(seen[1], 100);
    EXPECT_GT(seen[2], 100);
  }
}

TEST(ScenePlacementsIdentity, PathsThatEndTooEarlyAreRefused) {
  const Scratch scratch;
  const auto said = [&](const std::string& table) {
    put(scratch / "bus.csv", table);
    return complaint(moving("bus.csv", true), scratch.path);
  };
  const auto says = [&](const std::string& table, const std::string& part) {
    const std::string all = said(table);
    EXPECT_NE(all.find(part), std::string::npos) << all;
  };
  EXPECT_EQ(said(bus_path), "none");
  says(bus_path.substr(0, bus_path.find("3,24")),
       "is known from 0 s to 2 s, and a picture is taken at 3 s");
  says("time_s,x_m,y_m,z_m\n0,0,0,0\n0,1,0,0\n", "is not after the time above it");
  says("time_s,x_m,y_m,z_m\n0,0,0,0\n", "is not a path");
  says("time_s,x_m,y_m\n0,0,0\n5,0,0\n", "z_m");
  json scanner = moving("bus.csv", true);
  put(scratch / "bus.csv", bus_path);
  scanner["sensor"]["kind"] = "pushbroom", scanner["sensor"]["row_time_s"] = 0.01;
  scanner["platform"] = {{"path", "straight"},
                         {"start_m", {0, -20, 40}},
                         {"velocity_m_s", {0, 10, 0}},
                         {"look", {0, 0, -1}},
                         {"up", {0, 1, 0}}};
  EXPECT_NE(complaint(scanner, scratch.path).find("things move"), std::string::npos)
      << complaint(scanner, scratch.path);
}
