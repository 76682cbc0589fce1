// Work in several threads (nw/base/Parallel.nw).
#include "malus/base/Parallel.hpp"

#include <gtest/gtest.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace malus;

namespace {
// how often each number came; no lock: every number has its own place
std::vector<int> timesEach(std::size_t count, int threads) {
  std::vector<int> times(count, 0);
  parallelFor(
      count, [&](std::size_t i) { ++times[i]; }, threads);
  return times;
}

// n threads that wait for each other: whether all of them came
class Meeting {
 public:
  explicit Meeting(int n) : missing_(n) {}
  bool wait() {
    std::unique_lock lock(mutex_);
    if (--missing_ == 0) all_.notify_all();
    // the minute is not a measurement: without it a failure would be a hang
    return all_.wait_for(lock, std::chrono::minutes(1), [&] { return missing_ <= 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable all_;
  int missing_;
};

#if defined(__x86_64__)
// Every body computes with the caller's switches for tiny numbers, however oneTBB's threads were used before.
TEST(ParallelInvariant, BodiesHaveTheCallersSwitchesForTinyNumbers) {
  constexpr unsigned tiny_is_zero =
      0x8040;  // flush to zero, denormals are zero (Intel's manual, MXCSR)
  const unsigned before = _mm_getcsr();
  for (const unsigned wanted : {0u, tiny_is_zero, 0u})
    for (const int threads : {0, 3}) {
      _mm_setcsr((before & ~tiny_is_zero) | wanted);
      std::vector<unsigned> seen(64, ~0u);
      malus::parallelFor(
          seen.size(),
          [&](std::size_t i) {
            std::this_thread::sleep_for(
                std::chrono::milliseconds(1));  // so that others come, too
            seen[i] = _mm_getcsr() & tiny_is_zero;
          },
          threads);
      _mm_setcsr(before);
      for (const unsigned bits : seen) EXPECT_EQ(bits, wanted) << threads;
    }
}
#endif
}  // namespace

TEST(ParallelIdentity, EveryNumberComesOnce) {
  for (const int threads : {0, 1, 2, 7})
    for (const std::size_t count : {0, 1, 2, 3, 1000})
      EXPECT_EQ(timesEach(count, threads), std::vector<int>(count, 1))
          << count << " numbers, " << threads << " threads";
}

TEST(ParallelIdentity, OneThreadIsTheCaller) {
  std::set<std::thread::id> who;  // without a lock, as only one thread may come
  parallelFor(
      100, [&](std::size_t) { who.insert(std::this_thread::get_id()); }, 1);
  EXPECT_EQ(who, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ParallelInvariant, NoMoreThreadsThanAskedFor) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<int> running = 0, most = 0;
    const auto body = [&](std::size_t) {
      const int now = ++running;
      for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::yield();
      --running;
    };
    parallelFor(200, body, threads);
    EXPECT_LE(most, threads);
    EXPECT_GE(most, 1);
  }
}

TEST(ParallelInvariant, ThreeThreadsMeetIfThreeAreAskedFor) {
  // on any machine, also one of two processors
  Meeting meeting(3);
  std::atomic<int> met = 0;
  parallelFor(
      3, [&](std::size_t) { met += meeting.wait(); }, 3);
  EXPECT_EQ(met, 3);
}

TEST(ParallelInvariant, AnExceptionArrivesAfterAllWorkHasEnded) {
  for (const int threads : {0, 1, 3}) {
    std::atomic<int> running = 0, begun = 0;
    std::string text;
    try {
      parallelFor(
          500,
          [&](std::size_t i) {
            ++running, ++begun;
            if (i == 17) {
              --running;
              throw std::out_of_range("number seventeen");
            }
            std::this_thread::yield();
            --running;
          },
          threads);
    } catch (const std::out_of_range& e) {
      text = e.what();
    }
    EXPECT_EQ(text, "number seventeen");
    EXPECT_EQ(running, 0);
    EXPECT_GE(begun, 1);
  }
}

TEST(ParallelInvariant, AnExceptionEndsTheWork) {
  // one thread begins a body after another, and none after the one that threw, unless it was the very last
  std::vector<int> times(100, 0);
  const auto body = [&](std::size_t i) {
    if (i == 10) throw std::runtime_error("ten");
    ++times[i];
  };
  EXPECT_THROW(parallelFor(times.size(), body, 1), std::runtime_error);
  EXPECT_LT(std::accumulate(times.begin(), times.end(), 0), 100 - 1);
}

TEST(ParallelIdentity, InnerWorkWithinOuterWork) {
  std::vector<std::vector<std::size_t>> squares(40, std::vector<std::size_t>(30));
  parallelFor(squares.size(), [&](std::size_t i) {
    parallelFor(squares[i].size(), [&](std::size_t k) { squares[i][k] = (i + k) * (i + k); });
  });
  for (std::size_t i = 0; i < squares.size(); ++i)
    for (std::size_t k = 0; k < squares[i].size(); ++k)
      EXPECT_EQ(squares[i][k], (i + k) * (i + k)) << i << " " << k;
}

// A watched work of many threads ends with what look() has thrown, though all its bodies are inner works without an end.
TEST(ParallelInvariant, AWatchedWorkEndsWhereverItIs) {
  for (const int threads : {1, 3}) {
    const auto caller = std::this_thread::get_id();
    int looks = 0;
    const auto look = [&] {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      if (++looks == 3) throw std::runtime_error("enough");
    };
    const auto endless = [&](std::size_t) {
      for (;;) std::this_thread::yield(), mayStop();
    };
    const auto work = [&] {
      parallelFor(
          3, [&](std::size_t) { parallelFor(2, endless); }, threads);
    };
    try {
      watched(look, work);
      ADD_FAILURE() << "the work ended by itself";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "enough");
    }
    EXPECT_EQ(looks, 3);
  }
}

// Who looks may work in parallel and be watched himself; the watch that was left is the former one again.
TEST(ParallelInvariant, WhoLooksMayWork) {
  int looks = 0, inner_looks = 0;
  const auto look = [&] {
    const int before = looks;
    watched([&] { ++inner_looks; },
            [] {
              parallelFor(4, [](std::size_t) {
                std::this_thread::sleep_for(std::chrono::milliseconds(150));
                mayStop();
              });
            });
    EXPECT_EQ(looks, before);
    if (++looks == 2) throw std::runtime_error("enough");
  };
  const auto body = [](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };
  EXPECT_THROW(watched(look, [&] { parallelFor(100000, body); }), std::runtime_error);
  EXPECT_EQ(looks, 2);
  EXPECT_GE(inner_looks, 1);
  looks = 0;
  parallelFor(20, body);  // there is no watcher any more
  EXPECT_EQ(looks, 0);
}

TEST(ParallelInvariant, AWatchedWorkThatKeepsItsExceptionsEndsWithThatOfWhoLooks) {
  const auto look = [] { throw std::runtime_error("enough"); };
  for (const bool throws : {false, true}) {
    const auto work = [&] {
      try {
        for (;;) mayStop();
      } catch (...) {
        if (throws) throw std::out_of_range("its own");
      }
    };
    EXPECT_THROW(watched(look, work), std::runtime_error) << throws;
  }
}

TEST(ParallelInvariant, AWatchedWorkMayEndByItself) {
  int sum = 0;
  watched([] { throw std::runtime_error("too early"); }, [&] { mayStop(), ++sum; });
  EXPECT_EQ(sum, 1);
  EXPECT_THROW(watched([] {}, [] { throw std::out_of_range("its own"); }), std::out_of_range);
}

#ifdef __SANITIZE_THREAD__
// Negative control of the marks and of tests/tsan.supp: a race between two bodies must be reported.
// The meeting is there to have two threads; it orders what is before and not what is after.
TEST(ParallelDeathTest, NegativeControlARaceOfTwoBodiesIsReported) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";  // oneTBB has threads by now
  const auto race = [] {
    int sum = 0;
    Meeting meeting(2);
    parallelFor(
        2,
        [&](std::size_t i) {
          meeting.wait();
          sum += static_cast<int>(i);
        },
        2);
    std::exit(sum < 0);
  };
  EXPECT_EXIT(race(), testing::ExitedWithCode(66), "data race.*");
}
#endif
