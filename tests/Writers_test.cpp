// A program among others, from outside (nw/app/Process.nw, nw/app/CommandRender.nw, CommandLine.nw,
// nw/files/OutputLock.nw): two writers, closed
// and full streams, lost and damaged files, limits, a setting sun, a moved program.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <new>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "Program.hpp"
#include "malus/app/CommandLine.hpp"
#include "malus/base/Error.hpp"
#include "malus/files/Cube.hpp"
#include "malus/files/OutputLock.hpp"

using nlohmann::json;
namespace fs = std::filesystem;

namespace {
const std::string scenes = fs::path(MALUS_SOURCE_DATA).parent_path().string() + "/scenes/";
const std::string program = "'" MALUS_PROGRAM "' ";

/// A small chunky bar; its mesh is a copy that a test may change.
struct Place {
  Scratch scratch;
  explicit Place(int side = 40, int rays = 9) {
    std::ifstream file(scenes + "chunky-bar-copper.json");
    json scene = json::parse(file, nullptr, true, true);
    fs::copy_file(scenes + "chunky-bar.obj", scratch / "bar.obj");
    scene["geometry"][0]["obj"] = "bar.obj";
    scene["sensor"] = {{"kind", "framing"},
                       {"width", side},
                       {"height", side - 7},
                       {"field_of_view_deg", 36.87}};
    scene["radiometry"] = {{"sampling", "grid-rotated"}, {"rays", {rays, 2}}, {"seed", 5}};
    put(scratch / "s.json", scene.dump(1));
  }
  Outcome render(const std::string& arguments) const {
    return malusIn(scratch.path, "render s.json " + arguments);
  }
  std::string file(const std::string& name) const { return contents(scratch / name); }
  bool has(const std::string& name) const { return fs::exists(scratch / name); }
};

long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

/// A render in one thread that has begun to fill its journal, and ends with the object.
struct Running {
  pid_t child;
  bool over = false;
  int status = 0;
  explicit Running(const Place& place) : child(::fork()) {
    if (child == 0) {
      if (::chdir(place.scratch.path.c_str()) != 0) ::_exit(3);
      (void)!::freopen("err", "w", stderr);
      (void)!::freopen("/dev/null", "w", stdout);
      ::execl(MALUS_PROGRAM, MALUS_PROGRAM, "render", "s.json", "--threads", "1", "--out", "b",
              nullptr);
      ::_exit(3);
    }
    while (!over && lines(place.file("b/s.truth.img.tiles")) < 4) {
      over = ::waitpid(child, &status, WNOHANG) != 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  int end(int signal) {
    if (!over) ::kill(child, signal), ::waitpid(child, &status, 0), over = true;
    return status;
  }
  ~Running() { end(SIGKILL); }
};

void flip(const fs::path& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(at);
  const char byte = static_cast<char>(file.get() ^ 1);
  file.seekp(at);
  file.put(byte);
}
}  // namespace

// ---------------------------------------------------------------- one writer

TEST(WritersInvariant, ASecondRenderIntoOnePlaceIsRefused) {
  const Place place(160, 60);
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  Running first(place);
  ASSERT_FALSE(first.over) << "the render ended too soon";
  ::kill(first.child, SIGSTOP);  // it holds its lock for as long as we look
  for (const char* flags :
       {"--out b", "--out b --resume", "--out b --seed 9", "--out b --dry-run"}) {
    const Outcome second = place.render(flags);
    EXPECT_EQ(second.code, 2) << flags;
    EXPECT_EQ(lines(second.err), 1) << second.err;
    EXPECT_NE(second.err.find("is in use by another malus"), std::string::npos) << second.err;
  }
  EXPECT_EQ(place.render("--out b --part 0,0,8,8").code, 0);  // another part disturbs no other
  ::kill(first.child, SIGTERM), ::kill(first.child, SIGCONT);
  const int status = first.end(0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_FALSE(place.has("b/.s.lock"));
  ASSERT_EQ(place.render("--out b --resume").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
}

TEST(WritersInvariant, AKilledProgramLeavesNoLock) {
  const Place place(160, 60);
  Running first(place);
  ASSERT_FALSE(first.over);
  first.end(SIGKILL);
  EXPECT_EQ(place.render("--out b").code, 0);
  EXPECT_FALSE(place.has("b/.s.lock"));
}

TEST(WritersIdentity, ALockHoldsItsRangeAndNoOther) {
  const Scratch scratch;
  const fs::path file = scratch / "x.lock";
  {
    const malus::OutputLock some(file, 3, 5);
    EXPECT_THROW((void)malus::OutputLock(file, 5, 9), malus::InputError);
    EXPECT_THROW(malus::OutputLock::demandFree(file, 0, 3), malus::InputError);
    EXPECT_NO_THROW(malus::OutputLock::demandFree(file, 6, 9));
    const malus::OutputLock others(file, 6, 9);
  }
  EXPECT_FALSE(fs::exists(file));
}

// ---------------------------------------------------------------- streams

TEST(WritersInvariant, ClosedStreamsDoNotBecomeCubes) {
  const Place place;
  ASSERT_EQ(place.render("--out a").code, 0);
  const auto closed = [&](const std::string& streams) {
    return runIn(place.scratch.path,
                 "sh -c \"" + program + "render s.json --out b --threads 1 " + streams + "\"");
  };
  EXPECT_EQ(closed("2>&-").code, 0);
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
  EXPECT_EQ(closed(">&- 2>&- <&-").code, 2);  // the name of the cube did not arrive
  EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
}

TEST(WritersInvariant, FullErrorStreamDoesNotStopARender) {
  const Place place;
  const Outcome full =
      runIn(place.scratch.path, "sh -c \"" + program + "render s.json --out b 2>/dev/full\"");
  EXPECT_EQ(full.code, 0);
  EXPECT_TRUE(place.has("b/s.run.json"));
}

TEST(WritersInvariant, OutputThatDoesNotArriveIsReportedByEveryCommand) {
  const Place place;
  ASSERT_EQ(place.render("--out a").code, 0);
  const std::string tester =
      "'" + (fs::path(MALUS_PROGRAM).parent_path() / "mathtester").string() + "'";
  std::vector<std::string> commands{tester, tester + " --json", tester + " --help"};
  for (const char* arguments :
       {"--help", "--version", "brdf --help", "brdf --list",
        "brdf --model lambertian --param reflectance=0.5 --theta-i-deg 30 --theta-r-deg 40 "
        "--phi-deg 180",
        "sun --latitude-deg 43 --longitude-deg -77.6 --time 2001-06-10T13:08:00-04:00",
        "sky --tau 0.1 --albedo 0 --mu0 0.6 --mu 0.5 --phi-deg 20", "schema", "info a/s.img",
        "info s.json", "reproduce --list", "render s.json --dry-run --out a",
        "render s.json --out c", "products a/s.img"})
    commands.push_back(program + arguments);
  for (const std::string& command : commands)
    for (const char* stream : {">/dev/full", ">&-"}) {
      const Outcome outcome =
          runIn(place.scratch.path, "sh -c \"" + command + " " + stream + "\"");
      EXPECT_EQ(outcome.code, 2) << command << stream;
      EXPECT_NE(outcome.err.find("standard output: cannot be written"), std::string::npos)
          << command << stream << ": " << outcome.err;
    }
  EXPECT_EQ(runIn(place.scratch.path, "sh -c \"" + program + "--version >/dev/null\"").code, 0);
}

// ---------------------------------------------------------------- what a resumed run relies on

TEST(WritersInvariant, ALostRecordNeverMixesTwoMeshes) {
  const Place place(160, 60);
  ASSERT_EQ(place.render("--threads 1 --out a").code, 0);
  for (const char* left : {"", "{\"files\"", "[]"}) {
    Running first(place);
    first.end(SIGKILL);
    ASSERT_TRUE(place.has("b/s.img.part"));
    const std::string mesh = place.file("bar.obj");
    put(place.scratch / "b/s.run.json.part", left);
    if (*left == 0) fs::remove(place.scratch / "b/s.run.json.part");
    put(place.scratch / "bar.obj", "# mended\n" + mesh);
    const Outcome other = place.render("--out b --resume");
    EXPECT_EQ(other.code, 2) << other.err;
    EXPECT_NE(other.err.find("belongs to a cube other than"), std::string::npos) << other.err;
    put(place.scratch / "bar.obj", mesh);
    ASSERT_EQ(place.render("--out b --resume").code, 0);
    EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
    fs::remove_all(place.scratch / "b");
  }
}

TEST(WritersInvariant, AWholeRecordNamesWhatHasChanged) {
  const Place place(160, 60);
  Running(place).end(SIGKILL);
  const json record = json::parse(place.file("b/s.run.json.part"));
  EXPECT_EQ(record["program"], malus::programVersion());
  EXPECT_EQ(record["files"]["bar.obj"], malus::crc32Of(place.scratch / "bar.obj"));
  json other = record;
  other["program"] = "malus 0.0.1";
  put(place.scratch / "b/s.run.json.part", other.dump());
  const Outcome program_differs = place.render("--out b --resume");
  EXPECT_EQ(program_differs.code, 2);
  EXPECT_NE(program_differs.err.find("is not the program"), std::string::npos)
      << program_differs.err;
  other = record;
  EXPECT_EQ(other["sources"], malus::programSources());
  other["sources"] = "0123456789ab";
  put(place.scratch / "b/s.run.json.part", other.dump());
  const Outcome build_differs = place.render("--out b --resume");
  EXPECT_EQ(build_differs.code, 2);
  EXPECT_NE(build_differs.err.find("is not the build that this frame was made with"),
            std::string::npos)
      << build_differs.err;
  put(place.scratch / "b/s.run.json.part", record.dump());
  put(place.scratch / "bar.obj", "# mended\n" + place.file("bar.obj"));
  const Outcome mesh_differs = place.render("--out b --resume");
  EXPECT_EQ(mesh_differs.code, 2);
  EXPECT_NE(mesh_differs.err.find("bar.obj: is not the file"), std::string::npos)
      << mesh_differs.err;
}

TEST(WritersInvariant, AKillDuringTheAllocationIsResumed) {
  const Place place;
  ASSERT_EQ(place.render("--out a").code, 0);
  for (const char* journal : {"", "malus cu"}) {
    fs::remove_all(place.scratch / "b");
    put(place.scratch / "b/s.img.part", std::string(100, 'x'));
    put(place.scratch / "b/s.img.tiles", journal);
    const Outcome resumed = place.render("--out b --resume");
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
  }
}

TEST(WritersInvariant, AFinishedFrameIsVerifiedBeforeItIsTrusted) {
  const Place place;
  ASSERT_EQ(place.render("--out a").code, 0);
  const auto resumedAfter = [&](const std::function<void(const fs::path&)>& damage) {
    fs::remove_all(place.scratch / "b");
    fs::copy(place.scratch / "a", place.scratch / "b");
    damage(place.scratch / "b");
    const Outcome outcome = place.render("--out b --resume");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(place.file("a/s.img"), place.file("b/s.img"));
    EXPECT_EQ(place.file("a/s.truth.img"), place.file("b/s.truth.img"));
    return outcome.err;
  };
  const std::string there = "exists already", again = "the frame is rendered again";
  EXPECT_NE(resumedAfter([](const fs::path&) {}).find(there), std::string::npos);
  EXPECT_NE(resumedAfter([](const fs::path& b) { fs::remove(b / "s.S0.png"); }).find(there),
            std::string::npos);
  for (const char* cube : {"s.img", "s.truth.img"}) {
    EXPECT_NE(resumedAfter([&](const fs::path& b) { flip(b / cube, 1000); }).find(again),
              std::string::npos);
    EXPECT_NE(
        resumedAfter([&](const fs::path& b) { fs::resize_file(b / cube, 500); }).find(again),
        std::string::npos);
    EXPECT_NE(resumedAfter([&](const fs::path& b) { fs::remove(b / cube); }).find(again),
              std::string::npos);
  }
}

TEST(WritersInvariant, LeftoversOfAKilledProgramAreRemoved) {
  const Place place;
  constexpr const char* dead = "999999999";  // beyond the largest number of a process
  for (const std::string& name :
       {std::string(".") + dead + ".s.S0.png", std::string("s.run.json.") + dead + ".new",
        std::string(".") + dead + ".t.S0.png", ".1.s.S1.png" + std::string()})
    put(place.scratch / ("b/" + name), "half");
  ASSERT_EQ(place.render("--out b --resume").code, 0);
  EXPECT_FALSE(place.has(std::string("b/.") + dead + ".s.S0.png"));
  EXPECT_FALSE(place.has(std::string("b/s.run.json.") + dead + ".new"));
  EXPECT_TRUE(place.has(std::string("b/.") + dead + ".t.S0.png"));  // another scene's
  EXPECT_TRUE(place.has("b/.1.s.S1.png"));                          // process 1 runs
}

TEST(WritersInvariant, ATruncatedTableOfOurOwnIsNoticed) {
  const Scratch scratch;
  ASSERT_EQ(malusIn(scratch.path,
                    "fit --basis 2 --model lambertian --param reflectance=0.5 --wavelength-nm "
                    "550 --out basis.csv")
                .code,
            0);
  const std::string ask =
      "brdf --model basis --param file=basis.csv --wavelength-nm 550 "
      "--theta-i-deg 30 --theta-r-deg 40 --phi-deg 180";
  ASSERT_EQ(malusIn(scratch.path, ask).code, 0);
  const std::string whole = contents(scratch / "basis.csv");
  for (std::size_t cut = whole.size() - 2; cut > whole.size() / 2; cut -= whole.size() / 7) {
    put(scratch / "basis.csv", whole.substr(0, cut));
    const Outcome outcome = malusIn(scratch.path, ask);
    EXPECT_EQ(outcome.code, 2) << cut;
    EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
  }
}

// ---------------------------------------------------------------- the needs that the dry run
// reports

TEST(WritersInvariant, PlacesThatCannotBeWrittenAreRefusedByDryRunAndRun) {
  const Place place;
  put(place.scratch / "file", "x");
  fs::create_symlink("loop", place.scratch / "loop");
  std::vector<std::pair<std::string, std::string>> places{
      {"file/b", "Not a directory"},
      {"file", "Not a directory"},
      {"loop/b", "Too many levels of symbolic links"},
      {std::string(300, 'n'), "File name too long"}};
  fs::create_directory(place.scratch / "closed");
  fs::permissions(place.scratch / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  if (::access((place.scratch / "closed").c_str(), W_OK) != 0)  // root may write everywhere
    places.emplace_back("closed/b", "Permission denied");
  for (const auto& [out, word] : places)
    for (const char* dry : {"", " --dry-run"}) {
      const Outcome outcome = place.render("--out " + out + dry);
      EXPECT_EQ(outcome.code, 2) << out;
      EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
      EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find("; "), std::string::npos) << "no remedy: " << outcome.err;
    }
  fs::remove(place.scratch / "loop");
  EXPECT_EQ(filesBelow(place.scratch.path), 3u);
}

TEST(WritersInvariant, ALimitOnFilesIsAnErrorAndNoSignal) {
  const Place place;
  for (const char* dry : {"", "--dry-run "}) {
    const Outcome outcome =
        runIn(place.scratch.path, "ulimit -f 8; " + program + "render s.json --out b " + dry);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("ulimit -f"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(place.has("b"));
  const Outcome table = runIn(
      place.scratch.path,
      "ulimit -f 1; " + program +
          "brdf --model lambertian --param reflectance=0.5 --table t.csv --wavelength-nm 550");
  EXPECT_EQ(table.code, 2) << table.err;
  EXPECT_EQ(lines(table.err), 1) << table.err;
  EXPECT_EQ(filesBelow(place.scratch.path), 2u);
}

TEST(WritersInvariant, NamesThatNoRecordCanHoldAreRefusedAtTheDoor) {
  const Place place;
  const std::string latin = "B\xe4ume";
  fs::copy_file(place.scratch / "s.json", place.scratch / (latin + ".json"));
  for (const std::string& arguments :
       {latin + ".json --out b", latin + ".json --out b --dry-run", "s.json --out " + latin}) {
    const Outcome outcome = malusIn(place.scratch.path, "render " + arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(lines(outcome.err), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("UTF-8"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(filesBelow(place.scratch.path), 3u);
  EXPECT_EQ(place.render("--out B\xc3\xa4ume --part 0,0,4,4").code, 0);
}

TEST(WritersIdentity, UTF8IsRecognised) {
  for (const char* good : {"", "plain", "\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\x8c\x88"})
    EXPECT_TRUE(malus::endOfUTF8(good) == std::string_view::npos) << good;
  for (const char* bad :
       {"\xe4", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "a\x80"})
    EXPECT_FALSE(malus::endOfUTF8(bad) == std::string_view::npos);
}

TEST(WritersInvariant, TheDryRunCountsFilesAndBytes) {
  const Place place;
  for (const bool filters : {false, true}) {
    if (filters) {
      json scene = json::parse(place.file("s.json"));
      scene["sensor"]["polarimeter"] = json::parse(
          R"({"cameras": [{"polarizer_deg": 0}, {"polarizer_deg": 45}, {"polarizer_deg": 90}],
              "recover": ["S0", "S1", "S2"]})");
      put(place.scratch / "s.json", scene.dump());
    }
    const std::string out = filters ? "c" : "b";
    const Outcome dry = place.render("--dry-run --out " + out);
    ASSERT_EQ(dry.code, 0) << dry.err;
    std::smatch m;
    ASSERT_TRUE(std::regex_search(
        dry.out, m,
        std::regex(R"(1 frames of (\d+) files and at most ([\d.]+) MB, .* are free)")))
        << dry.out;
    EXPECT_NE(dry.out.find("memory    about "), std::string::npos) << dry.out;
    EXPECT_NE(dry.out.find("time      about "), std::string::npos) << dry.out;
    const std::size_t files = std::stoul(m[1]);
    const double bytes = std::stod(m[2]) * 1e6;
    ASSERT_EQ(place.render("--out " + out).code, 0);
    EXPECT_EQ(filesBelow(place.scratch / out), files);
    double there = 0;
    for (const auto& entry : fs::directory_iterator(place.scratch / out))
      there += double(entry.file_size());
    EXPECT_LE(there, bytes);
    EXPECT_GT(
        there,
        bytes / 20);  // a bound that is of use: the room for pictures is for unpacked ones
  }
}

TEST(WritersInvariant, ASceneThatRunsThroughSunsetRenders) {
  const Place place;
  json scene = json::parse(place.file("s.json"));
  scene["sun"] = {
      {"latitude_deg", 43.1}, {"longitude_deg", -77.6}, {"time", "2001-06-10T12:00:00-04:00"}};
  scene["sky"] = {{"model", "rayleigh"}, {"path_radiance", true}};
  scene["platform"]["frames"] = 14, scene["platform"]["interval_s"] = 3600;
  put(place.scratch / "s.json", scene.dump());
  const Outcome dry = place.render("--dry-run --out b");
  ASSERT_EQ(dry.code, 0) << dry.err;
  EXPECT_NE(dry.out.find("below the horizon in 5 of 14 frames, first in frame 9"),
            std::string::npos)
      << dry.out;
  const Outcome run = place.render("--out b --frames 8:10");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("twilight"), run.err.rfind("twilight")) << run.err;  // once
  const auto mean = [&](const char* name) {
    const malus::Cube cube = malus::readCube(place.scratch / "b" / name);
    double sum = 0;
    for (std::size_t i = 0; i < cube.data.size(); i += 4) sum += cube.data[i];
    return sum;
  };
  EXPECT_GT(mean("s.0008.img"), 0);
  EXPECT_EQ(mean("s.0009.img"), 0);
  EXPECT_EQ(mean("s.0010.img"), 0);
  // minute by minute the light fades: the last lit one has a sun of at most 0.2 degrees, and its light grows like the sine
  scene["sun"]["time"] = "2001-06-10T19:50:00-04:00";
  scene["platform"]["frames"] = 90, scene["platform"]["interval_s"] = 60;
  put(place.scratch / "s.json", scene.dump());
  const std::string said = place.render("--dry-run --out b").out;
  const int dark = std::stoi(said.substr(said.find("first in frame ") + 15));
  ASSERT_GT(dark, 50);
  ASSERT_EQ(place.render(fmt::format("--out b --frames {}:{}", dark - 1, dark)).code, 0);
  ASSERT_EQ(place.render(fmt::format("--out b --frames {}", dark - 50)).code, 0);
  const auto frame = [&](int n) { return mean(fmt::format("s.{:04}.img", n).c_str()); };
  EXPECT_GT(frame(dark - 1), 0);
  EXPECT_LT(frame(dark - 1), frame(dark - 50) / 10);
  EXPECT_EQ(frame(dark), 0);
  scene["sun"]["time"] = "2001-06-10T23:00:00-04:00";
  scene["platform"]["frames"] = 1;
  put(place.scratch / "s.json", scene.dump());
  EXPECT_EQ(place.render("--out c").code, 0);  // a night from the beginning
}

TEST(WritersInvariant, AMovedProgramFindsItsDataOrSaysWhatIsMissing) {
  const Place place;
  const fs::path bin = place.scratch / "moved/bin";
  const fs::path build = fs::path(MALUS_PROGRAM).parent_path(), lib = bin.parent_path() / "lib";
  fs::create_directories(bin), fs::create_directories(lib);
  for (const char* program : {"malus", "malus-reproduce"})
    fs::copy_file(build / program, bin / program);
  for (const auto& library : fs::directory_iterator(build / "lib"))
    if (library.path().filename() != "libmalus_netcdf.so")
      fs::copy_file(library.path(), lib / library.path().filename());
  const std::string moved = "moved/bin/malus ";
  const Outcome lame =
      runIn(place.scratch.path, moved + "render s.json --write netcdf --dry-run");
  EXPECT_EQ(lame.code, 2);
  EXPECT_NE(lame.err.find("libmalus_netcdf.so"), std::string::npos) << lame.err;
  fs::copy_file(build / "lib" / "libmalus_netcdf.so", lib / "libmalus_netcdf.so");
  EXPECT_EQ(runIn(place.scratch.path, moved + "render s.json --out b").code, 0);
  put(place.scratch / "moved/share/malus/validation/inventory.csv", "spoilt");
  const Outcome list = runIn(place.scratch.path, moved + "reproduce T3.1 --out r");
  EXPECT_NE(list.code, 0);
  EXPECT_NE(list.err.find("inventory.csv"), std::string::npos) << list.err;
}

// ---------------------------------------------------------------- whose mistake it is

TEST(WritersIdentity, InternalErrorsSaySoAndHaveTheirOwnCode) {
  const auto codeOf = [](const std::function<int()>& action) {
    const char* arguments[] = {"malus", "try"};
    testing::internal::CaptureStderr();
    const int code = malus::runCommandLine(
        2, arguments, {{"try", "throws", "", [action](CLI::App&) { return action; }}});
    return std::pair(code, testing::internal::GetCapturedStderr());
  };
  const auto broken = codeOf([]() -> int { throw malus::InvariantError("1 against 2"); });
  EXPECT_EQ(broken.first, 70);
  EXPECT_EQ(broken.second,
            "malus try: internal error (malus::InvariantError): 1 against 2; this is a defect "
            "of malus, not of your input: please report it with the command and its files\n");
  EXPECT_EQ(codeOf([]() -> int { throw std::out_of_range("x"); }).first, 70);
  EXPECT_EQ(codeOf([]() -> int { throw std::bad_alloc(); }).first, 2);
  const auto file =
      codeOf([]() -> int { return fs::create_directory("/proc/self/none/x"), 0; });
  EXPECT_EQ(file.first, 2);
  EXPECT_EQ(lines(file.second), 1);
  EXPECT_EQ(codeOf([] { return 0; }).first, 0);
}
