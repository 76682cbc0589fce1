// Several ranks, one picture (nw/app/Ranks.nw): ranks are threads here, and letters lie in queues. tests/cluster.py does the
// same with Open MPI.
#include "malus/app/Ranks.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "Scratch.hpp"
#include "malus/app/CommandRender.hpp"
#include "malus/app/RenderFiles.hpp"
#include "malus/app/RenderProgress.hpp"
#include "malus/base/Error.hpp"
#include "malus/base/InputFiles.hpp"
#include "malus/files/Cube.hpp"

namespace fs = std::filesystem;
using namespace malus;

namespace {
const std::string scenes = fs::absolute("scenes").string() + "/";  // tests run in the source

/// What mpirun does to all when one has died.
struct Killed : std::exception {};

/// The post of some ranks that are threads.
struct Post {
  explicit Post(std::size_t ranks) : boxes(ranks) {}
  std::mutex mutex;
  std::vector<std::deque<Ranks::Letter>> boxes;
  std::vector<std::string> spoken;  // by rank 0, to all
  std::atomic<bool> killed = false;
  std::atomic<std::size_t> tiles = 0;  // that other ranks have reported
};

/// Faults: after so many messages the rank dies; each message takes so long; a message is
/// falsified.
struct Fate {
  std::size_t dies_after = std::size_t(-1);
  std::chrono::microseconds slow{0};
  bool lies = false;  // about its tiles
};

class ThreadRanks : public Ranks {
 public:
  ThreadRanks(Post& post, std::size_t rank, Fate fate)
      : post_(post), rank_(rank), fate_(fate) {}
  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return post_.boxes.size(); }
  std::size_t onThisMachine() const override { return size(); }
  void send(std::size_t to, std::string_view text) override {
    if (sent_++ == fate_.dies_after) post_.killed = true, stop_signal = 15, stop_wanted = true;
    demandLife();
    std::this_thread::sleep_for(fate_.slow);
    std::string sent(text);
    if (sent.starts_with("tile ")) {
      ++post_.tiles;
      if (const std::size_t light = sent.find(' ', 5) + 1; fate_.lies)
        sent[light] = sent[light] == '1' ? '2' : '1';
    }
    const std::lock_guard lock(post_.mutex);
    post_.boxes[to].push_back({rank_, std::move(sent)});
  }
  std::optional<Letter> receive() override {
    demandLife();
    const std::lock_guard lock(post_.mutex);
    if (post_.boxes[rank_].empty()) return {};
    Letter letter = post_.boxes[rank_].front();
    post_.boxes[rank_].pop_front();
    return letter;
  }
  void broadcast(std::string& text) override {
    if (rank_ == 0) {
      const std::lock_guard lock(post_.mutex);
      post_.spoken.push_back(text);
    }
    waitUntil([&] {
      if (post_.spoken.size() <= heard_) return false;
      text = post_.spoken[heard_++];
      return true;
    });
    // so that each rank gets a tile, rank 0 begins its own after all requests
    if (rank_ == 0 && text.starts_with("frame"))
      waitUntil([&] { return post_.boxes[0].size() + 1 >= size(); });
  }

 private:
  void demandLife() const {
    if (post_.killed) throw Killed();
  }
  void waitUntil(const std::function<bool()>& true_now) {
    for (;; std::this_thread::sleep_for(std::chrono::microseconds(100))) {
      demandLife();
      const std::lock_guard lock(post_.mutex);
      if (true_now()) return;
    }
  }
  Post& post_;
  std::size_t rank_, sent_ = 0, heard_ = 0;
  Fate fate_;
};

struct Ended {
  std::vector<int> codes;   ///< of the ranks; -1: killed
  std::string complaint;    ///< of rank 0
  std::size_t entered = 0;  ///< tiles of other ranks
};

/// A render by so many ranks.
Ended renderBy(std::size_t ranks, RenderFlags flags,
               const std::map<std::size_t, Fate>& fates = {}) {
  Post post(ranks);
  Ended ended{std::vector<int>(ranks, -1), "", 0};
  flags.threads = flags.threads ? flags.threads : 1;
  std::vector<std::jthread> threads;
  for (std::size_t rank = 0; rank < ranks; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks seen(post, rank, fates.contains(rank) ? fates.at(rank) : Fate{});
      try {
        ended.codes[rank] = renderAsRank(flags, seen);
      } catch (const InputError& error) {
        ended.codes[rank] = 2, ended.complaint = error.what();
      } catch (const Killed&) {
      }
    });
  threads.clear();
  ended.entered = post.tiles;
  return ended;
}

RenderFlags flagsFor(const std::string& scene, const fs::path& out) {
  RenderFlags flags;
  flags.scene = scene, flags.out = out.string();
  return flags;
}

/// A picture whose size is not a whole number of tiles, and a film of two frames.
std::string smallScene(const Scratch& scratch) {
  nlohmann::json scene =
      nlohmann::json::parse(contents(scenes + "flight-nadir.json"), nullptr, true, true);
  scene["geometry"][0]["obj"] = scenes + "chunky-bar.obj";
  scene["platform"]["frames"] = 2;
  scene["sensor"]["width"] = 100, scene["sensor"]["height"] = 70;
  put(scratch / "film.json", scene.dump());
  return (scratch / "film.json").string();
}

/// Names of the files of one directory that the other has not to the same bytes; of the records all but the seconds counts.
std::vector<std::string> differing(const fs::path& one, const fs::path& other) {
  std::vector<std::string> names;
  const auto read = [](const fs::path& path) {
    if (path.extension() != ".json") return contents(path);
    nlohmann::json record = nlohmann::json::parse(contents(path), nullptr, false);
    if (record.is_object()) record.erase("seconds"), record.erase("command");
    return record.dump();
  };
  for (const auto& entry : fs::directory_iterator(one)) {
    const std::string name = entry.path().filename().string();
    if (read(one / name) != read(other / name)) names.push_back(name);
  }
  if (filesBelow(one) != filesBelow(other)) names.push_back("another number of files");
  return names;
}
}  // namespace

TEST(RanksInvariant, AnyNumberOfRanksMakesTheSameBits) {
  const Scratch scratch;
  const std::string scene = smallScene(scratch);
  ASSERT_EQ(renderBy(1, flagsFor(scene, scratch / "1")).codes, std::vector<int>{0});
  ASSERT_GE(filesBelow(scratch / "1"), 12u);
  for (const std::size_t ranks : {2u, 3u, 8u}) {
    const fs::path out = scratch / std::to_string(ranks);
    const Ended ended = renderBy(ranks, flagsFor(scene, out));
    EXPECT_EQ(ended.codes, std::vector<int>(ranks, 0)) << ended.complaint;
    EXPECT_EQ(differing(scratch / "1", out), std::vector<std::string>{}) << ranks;
    EXPECT_GE(ended.entered, ranks - 1);  // it was not rank 0 that made it all
  }
  RenderFlags other = flagsFor(scene, scratch / "other");  // the negative control
  other.seed_text = "77";
  ASSERT_EQ(renderBy(3, other).codes, std::vector<int>(3, 0));
  EXPECT_GE(differing(scratch / "1", scratch / "other").size(), 8u);
}

// A picture of several batches has a third cube, which other ranks write into as well; a rank
// dies, and the others continue.
TEST(RanksInvariant, TheErrorsOfAPictureAreTheSameBits) {
  const Scratch scratch;
  const std::string scene = smallScene(scratch);
  nlohmann::json text = nlohmann::json::parse(contents(scene));
  text["radiometry"] = {{"rays", {9, 2}}};
  put(scene, text.dump());
  RenderFlags flags = flagsFor(scene, scratch / "alone");
  flags.frames = "1", flags.batches = "2";
  ASSERT_EQ(renderBy(1, flags).codes, std::vector<int>{0});
  EXPECT_TRUE(fs::exists(scratch / "alone/film.0001.error.img"));
  flags.out = (scratch / "three").string();
  const Ended ended = renderBy(3, flags);
  EXPECT_EQ(ended.codes, std::vector<int>(3, 0)) << ended.complaint;
  EXPECT_EQ(differing(scratch / "alone", scratch / "three"), std::vector<std::string>{});
  flags.out = (scratch / "killed").string();
  EXPECT_EQ(renderBy(3, flags, {{1, {.dies_after = 4}}}).codes, std::vector<int>(3, -1));
  flags.resume = true;
  EXPECT_EQ(renderBy(2, flags).codes, std::vector<int>(2, 0));
  EXPECT_EQ(differing(scratch / "alone", scratch / "killed"), std::vector<std::string>{});
}

// A rank that is slow, several threads a rank, another order of numbers and a part of the picture change no bit either.
TEST(RanksInvariant, SlowRanksAndManyThreadsMakeTheSameBits) {
  const Scratch scratch;
  RenderFlags flags = flagsFor(smallScene(scratch), scratch / "alone");
  flags.interleave = "bsq", flags.part = "7,5,93,61", flags.frames = "1";
  ASSERT_EQ(renderBy(1, flags).codes, std::vector<int>{0});
  flags.out = (scratch / "slow").string(), flags.threads = 3;
  const Ended ended = renderBy(3, flags, {{2, {.slow = std::chrono::milliseconds(20)}}});
  EXPECT_EQ(ended.codes, std::vector<int>(3, 0)) << ended.complaint;
  EXPECT_EQ(differing(scratch / "alone", scratch / "slow"), std::vector<std::string>{});
}

// mpirun kills all when one rank dies: the finished tiles are in the journals, and any number
// of ranks continues from there.
TEST(RanksInvariant, ARankThatDiesCostsItsTilesInWork) {
  const Scratch scratch;
  const std::string scene = smallScene(scratch);
  ASSERT_EQ(renderBy(1, flagsFor(scene, scratch / "whole")).codes, std::vector<int>{0});
  for (const std::size_t ranks : {1u, 2u, 4u}) {
    RenderFlags flags = flagsFor(scene, scratch / fmt::format("killed-{}", ranks));
    const Ended dead = renderBy(3, flags, {{1, {.dies_after = 4}}});
    EXPECT_EQ(dead.codes, std::vector<int>(3, -1));
    EXPECT_FALSE(fs::exists(fs::path(flags.out) / "film.0001.run.json"));
    flags.resume = true;
    const Ended ended = renderBy(ranks, flags);
    EXPECT_EQ(ended.codes, std::vector<int>(ranks, 0)) << ended.complaint;
    EXPECT_EQ(differing(scratch / "whole", flags.out), std::vector<std::string>{}) << ranks;
    EXPECT_LT(dead.entered, 70u);  // of two frames
  }
}

// A rank that reports a false checksum of each tile: the cube must not get its name, and
// resuming repairs it.
TEST(RanksInvariant, ATileThatDoesNotReadAsItWasToldIsFound) {
  const Scratch scratch;
  RenderFlags flags = flagsFor(smallScene(scratch), scratch / "whole");
  flags.frames = "0";
  ASSERT_EQ(renderBy(1, flags).codes, std::vector<int>{0});
  flags.out = (scratch / "out").string();
  const Ended ended = renderBy(2, flags, {{1, {.lies = true}}});
  EXPECT_EQ(ended.codes, std::vector<int>(2, 2));
  EXPECT_NE(ended.complaint.find("differs from what another process wrote"), std::string::npos)
      << ended.complaint;
  EXPECT_FALSE(fs::exists(scratch / "out/film.0000.img"));
  flags.resume = true;
  EXPECT_EQ(renderBy(2, flags).codes, std::vector<int>(2, 0));
  EXPECT_EQ(differing(scratch / "whole", scratch / "out"), std::vector<std::string>{});
}

// Whatever a rank cannot do, all end with its line.
TEST(RanksInvariant, MistakesEndAllRanks) {
  const Scratch scratch;
  RenderFlags flags = flagsFor(smallScene(scratch), scratch / "out");
  flags.part = "1/3";
  const Ended part = renderBy(2, flags);
  EXPECT_EQ(part.codes, std::vector<int>(2, 2));
  EXPECT_NE(part.complaint.find("--part = 1/3: is for independent processes"),
            std::string::npos)
      << part.complaint;
  EXPECT_EQ(filesBelow(scratch / "out"), 0u);
  flags.part = "", flags.scene = (scratch / "none.json").string();
  EXPECT_EQ(renderBy(3, flags).codes, std::vector<int>(3, 2));
}

// One failure in serving: rank 0 keeps it, serves all ranks to their end, and only then throws.
TEST(RanksIdentity, TheOfficeHearsAllBeforeItComplains) {
  stop_wanted = false;
  Post post(3);
  ThreadRanks zero(post, 0, {}), one(post, 1, {}), two(post, 2, {});
  TileOffice office(zero, {4, 7, 9});
  EXPECT_EQ(office.next(), 4u);
  office.leaveAtTheEnd();  // hands out no more
  TileDesk first(one), second(two);
  first.say({4, 1, 2, 5, 3});
  first.end("error out/x.img.part: cannot be written: No space left on device; make room");
  second.end("");
  std::vector<WrittenTile> entered;
  office.serve([&](const WrittenTile& tile) { entered.push_back(tile); });
  ASSERT_EQ(entered.size(), 1u);
  EXPECT_EQ(entered[0].number, 4u);
  EXPECT_EQ(entered[0].rays, 3u);
  try {
    office.demandGood();
    FAIL() << "a rank has failed";
  } catch (const InputError& error) {
    EXPECT_TRUE(
        std::string(error.what()).starts_with("rank 1: out/x.img.part: cannot be written"))
        << error.what();
  }
}

// A radiance that no float holds ends the frame as if rank 0 had met it, so that nothing of the frame stays.
TEST(RanksIdentity, TooBrightForAnotherRankIsTooBrightForAll) {
  stop_wanted = false;
  Post post(2);
  ThreadRanks zero(post, 0, {}), one(post, 1, {});
  TileOffice office(zero, {4});
  office.leaveAtTheEnd();
  TileDesk(one).end("bright 1e+40");
  office.serve([](const WrittenTile&) {});
  EXPECT_THROW(office.demandGood(), TooBright);
  EXPECT_THROW(floats(std::vector{1.0, 1e40}), TooBright);
  EXPECT_EQ(floats(std::vector{3e38, std::numeric_limits<double>::infinity()}).size(), 2u);
}

TEST(RanksIdentity, TilesAreHandedOutOnce) {
  stop_wanted = false;
  Post post(2);
  ThreadRanks zero(post, 0, {}), one(post, 1, {});
  TileOffice office(zero, {4, 7, 9});
  TileDesk desk(one);
  std::jthread asking([&] {
    EXPECT_EQ(desk.next(), 4u);
    EXPECT_EQ(desk.next(), 7u);
    EXPECT_EQ(desk.next(), 9u);
    EXPECT_FALSE(desk.next());
    EXPECT_FALSE(desk.next());
    desk.end("");
    office.leaveAtTheEnd();
  });
  office.serve([](const WrittenTile&) {});
}

// Copies in memory replace the files for all readers of input.
TEST(RanksIdentity, AFileInMemoryIsReadByItsName) {
  const Scratch scratch;
  const fs::path name = scratch / "there.txt";
  EXPECT_EQ(whyNoInput(name), "does not exist");
  const std::string text(3 << 20, 'x');
  placeInput(name, text);
  EXPECT_EQ(whyNoInput(name), "");
  EXPECT_EQ(readWhole(name, "remedy"), text);
  EXPECT_EQ(readWhole(name, "remedy"), text);  // each opening begins anew
  EXPECT_FALSE(fs::exists(name));
  placeInput(name, "short");
  EXPECT_EQ(readWhole(name, "remedy"), "short");
}

TEST(RanksIdentity, ThreadsOfAMachineAreShared) {
  Post post(8);
  const ThreadRanks eighth(post, 7, {});
  EXPECT_EQ(threadsOf(5, eighth), 5);
  EXPECT_GE(threadsOf(0, eighth), 1);
  EXPECT_LE(threadsOf(0, eighth), std::max(1, int(std::thread::hardware_concurrency()) / 8));
  EXPECT_EQ(threadsOf(0, Ranks()), 0);
}
