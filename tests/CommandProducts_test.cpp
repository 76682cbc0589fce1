// malus products and malus info, from outside (nw/app/CommandProducts.nw).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Program.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/OutputLock.hpp"

using namespace malus;

namespace {
void cubeIn(const std::filesystem::path& directory) {
  const auto bands = SpectralGrid::make({450, 550, 650});
  CubeWriter writer(directory / "x.img", stokesHeader(4, 3, *bands, "W m^-2 sr^-1 nm^-1"));
  std::vector<float> numbers;
  for (int i = 0; i < 4 * 3 * 3; ++i)
    for (const float v : {5.f, 3.f, -0.f, 4.f}) numbers.push_back(v);
  writer.write({0, 0, 4, 3}, numbers);
  writer.finish();
}
}  // namespace

TEST(CommandProductsIdentity, DerivesFourNumbersAndDrawsThem) {
  const Scratch scratch;
  cubeIn(scratch.path);
  const Outcome outcome = malusIn(scratch.path, "products x.img");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube made = readCube(scratch / "x.products.img");
  EXPECT_EQ(made.header.channels[4], "DoP 550");
  EXPECT_FLOAT_EQ(made.at(1, 1, 0), 1.0f);
  EXPECT_FLOAT_EQ(made.at(1, 1, 1), 0.6f);
  EXPECT_FLOAT_EQ(made.at(1, 1, 2), 0.8f);
  EXPECT_FLOAT_EQ(made.at(1, 1, 3), 0.0f);
  EXPECT_TRUE(std::filesystem::exists(scratch / "x.550.DoLP.png"));
  EXPECT_TRUE(std::filesystem::exists(scratch / "x.550.rgb.png"));
  EXPECT_EQ(malusIn(scratch.path, "products x.img --all --out all").code, 0);
  EXPECT_TRUE(std::filesystem::exists(scratch / "all/x.450.S3.png"));
}

// Two runs that would write one file: the second is refused while the first holds the lock, and leaves nothing.
TEST(CommandProductsInvariant, TwoRunsDoNotMixTheirProducts) {
  const Scratch scratch;
  cubeIn(scratch.path);
  {
    const OutputLock held(scratch / ".x.products.lock", 0, 0);
    const Outcome second = malusIn(scratch.path, "products x.img");
    EXPECT_EQ(second.code, 2);
    EXPECT_NE(second.err.find("is in use by another malus"), std::string::npos) << second.err;
    EXPECT_FALSE(std::filesystem::exists(scratch / "x.products.img"));
    EXPECT_EQ(malusIn(scratch.path, "products x.img --out elsewhere").code, 0);
  }
  EXPECT_EQ(malusIn(scratch.path, "products x.img").code, 0);
  EXPECT_FALSE(std::filesystem::exists(scratch / ".x.products.lock"));
}

TEST(CommandProductsIdentity, BlackPixelsHaveNoProducts) {
  const Scratch scratch;
  CubeWriter writer(scratch / "y.img", stokesHeader(3, 1, *SpectralGrid::make({450}), "1"));
  writer.write({0, 0, 3, 1}, std::vector<float>{0, 0, 0, 0, 2, 0, 0, 0, 2, 0, 1, 0});
  writer.finish();
  ASSERT_EQ(malusIn(scratch.path, "products y.img").code, 0);
  const Cube made = readCube(scratch / "y.products.img");
  for (std::size_t c = 0; c < 4; ++c) EXPECT_TRUE(std::isnan(made.at(0, 0, c))) << c;
  EXPECT_EQ(made.at(1, 0, 1), 0);  // lit and unpolarised: a degree of zero, and no line
  EXPECT_TRUE(std::isnan(made.at(1, 0, 3)));
  EXPECT_EQ(made.at(2, 0, 1), 0.5f);
  EXPECT_EQ(made.at(2, 0, 3), 45);
  EXPECT_EQ(made.header.ignore_value, "nan");
}

TEST(CommandProductsIdentity, WhatDependsOnAnAbsentComponentIsAbsent) {
  const Scratch scratch;
  const auto bands = SpectralGrid::bands({CDSpectralLocation(650.0), CDSpectralLocation(450.0)},
                                         {"red", "blue"});
  CubeHeader header = bandHeader(1, 1, *bands, {"S0", "S1", "S2"}, "1");
  header.interleave = Interleave::bil;
  CubeWriter writer(scratch / "y.img", header);
  writer.write({0, 0, 1, 1}, std::vector<float>{5, 3, 0, 5, 0, 4});
  writer.finish();
  ASSERT_EQ(malusIn(scratch.path, "products y.img").code, 0);
  const Cube made = readCube(scratch / "y.products.img");
  EXPECT_EQ(made.header.channels,
            (std::vector<std::string>{"DoLP red", "AoLP red", "DoLP blue", "AoLP blue"}));
  EXPECT_EQ(made.header.wavelength_nm, (std::vector<double>{650, 650, 450, 450}));
  EXPECT_EQ(made.header.interleave, Interleave::bil);
  EXPECT_EQ(made.data, (std::vector<float>{0.6f, 0, 0.8f, 45}));
  EXPECT_TRUE(std::filesystem::exists(scratch / "y.blue.AoLP.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "y.blue.S3.png"));
  ASSERT_EQ(malusIn(scratch.path, "products y.img --interleave bsq").code, 0);
  const Cube again = readCube(scratch / "y.products.img");
  EXPECT_EQ(again.header.interleave, Interleave::bsq);
  EXPECT_EQ(again.data, made.data);
}

// Three cubes, of which the second is twice as bright: as a film all are drawn on its scale.
TEST(CommandProductsIdentity, AFilmHasOneScale) {
  const Scratch scratch;
  const auto bands = SpectralGrid::make({450});
  for (const auto& [name, factor] : {std::pair{"a", 1.f}, {"b", 2.f}, {"c", 1.f}}) {
    CubeWriter writer(scratch / (name + std::string(".img")), stokesHeader(2, 1, *bands, "1"));
    writer.write({0, 0, 2, 1},
                 std::vector<float>{factor, 0, 0, 0, factor / 2, factor / 4, 0, 0});
    writer.finish();
  }
  const auto draw = [&](const std::string& out, const std::string& flags) {
    const Outcome outcome = malusIn(scratch.path, "products " + flags + " --out " + out);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return contents(scratch / (out + "/a.450.S0.png"));
  };
  const std::string own = draw("own", "a.img b.img c.img"),
                    film = draw("film", "a.img b.img c.img --scale film"),
                    alone = draw("alone", "a.img --scale film");
  EXPECT_EQ(own, alone);
  EXPECT_NE(own, film);
  EXPECT_EQ(film, draw("given", "a.img --scale S0=2"));
  EXPECT_EQ(contents(scratch / "own/b.450.S0.png"), contents(scratch / "film/b.450.S0.png"));
  EXPECT_EQ(contents(scratch / "own/a.products.img"),
            contents(scratch / "film/a.products.img"));
  const std::size_t before = filesBelow(scratch.path);
  for (const char* bad :
       {"a.img none.img --scale film", "a.img --scale flim", "a.img own/b.products.img"})
    EXPECT_EQ(malusIn(scratch.path, std::string("products --out new ") + bad).code, 2) << bad;
  EXPECT_EQ(filesBelow(scratch.path), before);
}

// Matt ground of 0.2 and 0.6, looked at from the nadir, under two skies, as truth and as measured. The mean over the
// picture may differ by five of its own standard errors, beside the 3e-6 of a sky's table and
// sum; these errors are below a hundredth, so that a wrong pi or cosine is noticed. The last is
// the control: the same ground as radiance is far from it.
TEST(CommandProductsIdentity, MattGroundHasItsReflectance) {
  const Scratch scratch;
  const auto judge = [&](const std::string& sky, const std::string& file) {
    put(scratch / "s.json",
        R"({"malus": 1, "bands": {"wavelength_nm": [450, 650]},
            "geometry": [{"ground": {"z_m": 0, "material": "m", "facet": "f"}}],
            "materials": {"m": {"model": "lambertian", "reflectance": {"wavelength_nm": [450, 650], "values": [0.2, 0.6]}}},
            "sun": {"zenith_deg": 50, "azimuth_deg": 70, "irradiance_W_m2_nm": 1.3}, "sky": )" +
            sky +
            R"(, "sensor": {"kind": "framing", "width": 8, "height": 8, "field_of_view_deg": 5,
              "polarimeter": {"cameras": [{"polarizer_deg": 0}, {"polarizer_deg": 60}, {"polarizer_deg": 120}],
                              "recover": ["S0", "S1", "S2"]}},
            "platform": {"position_m": [0, 0, 9], "look_at_m": [0, 0, 0], "up": [0, 1, 0]},
            "radiometry": {"sampling": "importance", "rays": [400]}})");
    EXPECT_EQ(malusIn(scratch.path, "render s.json --out o --write cube").code, 0);
    const Outcome outcome = malusIn(scratch.path, "products --reflectance o/" + file + ".img");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const Cube made = readCube(scratch / ("o/" + file + ".reflectance.img"));
    EXPECT_EQ(made.header.unit, "1");
    const std::size_t each = made.header.channels.size() / 2;
    for (const auto& [band, reflectance] : {std::pair{0, 0.2}, {1, 0.6}}) {
      double sum = 0, squares = 0;
      for (std::size_t i = band * each; i < made.data.size(); i += 2 * each)
        sum += made.data[i], squares += made.data[i] * made.data[i];
      const double mean = sum / 64,
                   error = std::sqrt(std::max(squares / 64 - mean * mean, 0.0)) / 8;
      EXPECT_LT(error, 0.01 * reflectance) << sky << file;
      EXPECT_NEAR(mean, reflectance, 5 * error + 3e-6 * reflectance) << sky << file;
    }
  };
  const std::string uniform = R"({"model": "uniform", "radiance_W_m2_sr_nm": 0.07})";
  for (const char* file : {"s", "s.recovered"}) {
    judge(uniform, file);
    judge(R"({"model": "rayleigh", "albedo": 0.1})", file);
  }
  EXPECT_GT(std::abs(readCube(scratch / "o/s.img").at(0, 0, 0) - 0.2), 0.05);

  std::filesystem::remove(scratch / "o/s.reflectance.img");
  std::filesystem::remove(scratch / "o/s.run.json");
  const Outcome bare = malusIn(scratch.path, "products --reflectance o/s.img --out new");
  EXPECT_EQ(bare.code, 2);
  EXPECT_NE(bare.err.find("s.run.json"), std::string::npos) << bare.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "new"));
}

TEST(CommandProductsIdentity, BandsWithoutAHarmlessNameGetTheirNumber) {
  const Scratch scratch;
  cubeIn(scratch.path);
  std::string text = contents(scratch / "x.img.hdr");
  text.replace(text.find("S0 450"), 6, "S0");
  text.replace(text.find("S0 550"), 6, "S0 ../up");
  put(scratch / "x.img.hdr", text);
  const Outcome outcome = malusIn(scratch.path, "products x.img --all --out made");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(scratch / "made/x.band1.DoLP.png"));
  EXPECT_TRUE(std::filesystem::exists(scratch / "made/x.band2.DoLP.png"));
  EXPECT_TRUE(std::filesystem::exists(scratch / "made/x.650.DoLP.png"));
}

TEST(CommandProductsIdentity, InfoCountsWhatIsNoNumber) {
  const Scratch scratch;
  const auto bands = SpectralGrid::make({450});
  CubeWriter writer(scratch / "y.img", stokesHeader(2, 1, *bands, "W m^-2 sr^-1 nm^-1"));
  const float none = std::numeric_limits<float>::quiet_NaN();
  writer.write({0, 0, 2, 1}, std::vector<float>{5, none, none, 4, 7, 3, none, 4});
  writer.finish();
  const std::string out = malusIn(scratch.path, "info y.img").out;
  const auto line = [&](const std::string& channel) {
    const std::size_t at = out.find(channel);
    return at == std::string::npos ? "" : out.substr(at, out.find('\n', at) - at);
  };
  const auto words = [](const std::string& text) {
    std::istringstream stream(text);
    return std::vector<std::string>(std::istream_iterator<std::string>(stream), {});
  };
  using Words = std::vector<std::string>;
  EXPECT_EQ(words(line("S0 450")), (Words{"S0", "450", "5", "6", "7", "0"})) << out;
  EXPECT_EQ(words(line("S1 450")), (Words{"S1", "450", "3", "3", "3", "1"})) << out;
  EXPECT_EQ(words(line("S2 450")), (Words{"S2", "450", "-", "-", "-", "2"})) << out;
}

TEST(CommandProductsIdentity, InfoSaysWhatIsThere) {
  const Scratch scratch;
  cubeIn(scratch.path);
  const Outcome outcome = malusIn(scratch.path, "info x.img");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("4 x 3 pixels, 12 channels"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("S3 650"), std::string::npos);
}

// The table shows five digits of the JSON's numbers; where the two differ, one is wrong.
TEST(CommandProductsIdentity, InfoSaysTheSameAsJSON) {
  const Scratch scratch;
  const auto bands = SpectralGrid::make({450});
  CubeHeader header = stokesHeader(2, 1, *bands, "W m^-2 sr^-1 nm^-1");
  header.acquisition_time = "2001-06-10T17:06:00Z";
  CubeWriter writer(scratch / "y.img", header);
  const float none = std::numeric_limits<float>::quiet_NaN();
  writer.write({0, 0, 2, 1}, std::vector<float>{5, none, none, 4, 7.1234567f, 3, none, 4});
  writer.finish();
  const std::string text = malusIn(scratch.path, "info y.img").out;
  const Outcome outcome = malusIn(scratch.path, "info y.img --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto info = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(info["kind"], "cube");
  EXPECT_NE(
      text.find(fmt::format(
          "{}: {} x {} pixels, {} channels, {}\n{}\nacquired {}\n",
          info["file"].get<std::string>(), info["width"].get<int>(), info["height"].get<int>(),
          info["channels"].size(), info["unit"].get<std::string>(),
          info["description"].get<std::string>(), info["time"].get<std::string>())),
      text.npos)
      << text;
  std::string last;
  for (const auto& channel : info["channels"]) {
    const auto word = [&](const char* key) {
      return channel[key].is_null() ? "-" : fmt::format("{:.5g}", channel[key].get<double>());
    };
    last = fmt::format("{:<16} {:>12} {:>12} {:>12} {:>8}\n",
                       channel["name"].get<std::string>(), word("smallest"), word("mean"),
                       word("largest"), channel["invalid"].get<int>());
    EXPECT_NE(text.find(last), text.npos) << last << text;
    EXPECT_EQ(channel["wavelength_nm"], 450);
  }
  EXPECT_EQ(info["channels"][0]["largest"], double(7.1234567f));
  EXPECT_EQ(info["channels"][2]["mean"], nullptr);
  EXPECT_EQ(text.find(last.replace(last.find('4'), 1, "5")), text.npos);  // negative control
}

TEST(CommandProductsIdentity, InfoOfASceneSaysTheSameAsJSON) {
  const std::string scenes = std::string(MALUS_SOURCE_DATA) + "/../scenes/";
  for (const std::string name : {"flat-plate.json", "four-cameras.json", "flight-nadir.json"}) {
    const std::string text = malusIn(".", "info " + scenes + name).out;
    const auto info = nlohmann::json::parse(malusIn(".", "info --json " + scenes + name).out);
    const auto number = [&](const char* key) { return info[key].get<std::size_t>(); };
    const auto says = [&](const std::string& line) {
      EXPECT_NE(text.find(line), text.npos) << name << ": " << line << "\n" << text;
    };
    EXPECT_EQ(info["kind"], "scene");
    says(fmt::format("{} x {} pixels, {} frames, {} samples", number("width"), number("height"),
                     number("frames"), number("samples_per_pixel")));
    says(fmt::format("{} triangles{}, {} facets, {} materials\n", number("triangles"),
                     info["ground"] == true ? " and a ground" : "", info["facets"].size(),
                     info["materials"].size()));
    if (!info["polarimeter"].is_null())
      says(fmt::format("; condition number {:.3g}\n",
                       info["polarimeter"]["condition_number"].get<double>()));
    EXPECT_EQ(info["polarimeter"].is_null(), text.find("filters   ") == text.npos) << name;
    says("sky       " + info["sky"].get<std::string>() + "\n");
    says(fmt::format("rays      {}, seed {}; ", info["sampling"].get<std::string>(),
                     number("seed")));
    if (info["sun"].is_null())
      says("sun       none\n");
    else
      says(fmt::format("sun       zenith {:.2f} deg, azimuth {:.2f} deg, ",
                       info["sun"]["zenith_deg"].get<double>(),
                       info["sun"]["azimuth_deg"].get<double>()));
  }
}

TEST(CommandProductsIdentity, BadCubesAreOneLineAndLeaveNothing) {
  const Scratch scratch;
  cubeIn(scratch.path);
  const auto before = filesBelow(scratch.path);
  const auto complaint = [&](const std::string& arguments) {
    const Outcome outcome = malusIn(scratch.path, arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(complaint("products none.img").find("none.img"), std::string::npos);
  EXPECT_NE(complaint("products x.img --band 4").find("from 1 to 3"), std::string::npos);
  EXPECT_NE(complaint("products x.img --band -1").find("--band = -1: is not a band"),
            std::string::npos);
  EXPECT_NE(complaint("products x.img --band 0").find("from 1 to 3"), std::string::npos);
  EXPECT_NE(complaint("products x.img --band 1 --all").find("conflicts with --all"),
            std::string::npos);
  EXPECT_NE(complaint("products x.img --interleave big").find("bip (by pixel)"),
            std::string::npos);
  std::filesystem::resize_file(scratch / "x.img", 100);
  EXPECT_NE(complaint("info x.img").find("100 bytes"), std::string::npos);
  cubeIn(scratch.path);
  std::string text = contents(scratch / "x.img.hdr");
  text.replace(text.find("S1 450"), 6, "Q  450");
  put(scratch / "x.img.hdr", text);
  EXPECT_NE(complaint("products x.img").find("channel 2 should be an S1"), std::string::npos);
  EXPECT_EQ(filesBelow(scratch.path), before);
}
