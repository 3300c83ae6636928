#include "thread_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace binpick::app {
namespace {

TEST(ThreadPool, RunsEachIndexOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool(threads);
    for (const int count : {0, 1, 2, 7, 1000}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
      pool.parallel_for(count, [&](int index, int) { ++runs[static_cast<std::size_t>(index)]; });
      for (const auto& n : runs) EXPECT_EQ(n, 1) << threads << " threads, count " << count;
    }
  }
}

TEST(ThreadPool, CountsTheCallingThread) {
  ThreadPool pool(3);
  EXPECT_EQ(pool.thread_count(), 3);
  EXPECT_EQ(ThreadPool(1).thread_count(), 1);
}

TEST(ThreadPool, OfOneThreadRunsOnTheCallerInOrder) {
  ThreadPool pool(1);
  std::vector<int> order;
  pool.parallel_for(4, [&](int index, int thread) {
    EXPECT_EQ(thread, 0);
    order.push_back(index);
  });
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3}));
}

// As many tasks as threads, each waiting for all the others: it ends only if every thread takes
// one.
TEST(ThreadPool, GivesEachThreadItsOwnNumber) {
  constexpr int kThreads = 4;
  ThreadPool pool(kThreads);
  std::atomic<int> arrived{0};
  std::vector<std::atomic<int>> tasks_of_thread(kThreads);
  std::vector<std::thread::id> id_of_thread(kThreads);
  pool.parallel_for(kThreads, [&](int, int thread) {
    ASSERT_GE(thread, 0);
    ASSERT_LT(thread, kThreads);
    ++tasks_of_thread[static_cast<std::size_t>(thread)];
    id_of_thread[static_cast<std::size_t>(thread)] = std::this_thread::get_id();
    ++arrived;
    while (arrived < kThreads) std::this_thread::yield();
  });
  for (const auto& n : tasks_of_thread) EXPECT_EQ(n, 1);
  EXPECT_EQ(id_of_thread[0], std::this_thread::get_id());
  for (int i = 0; i < kThreads; ++i) {
    for (int j = 0; j < i; ++j) {
      EXPECT_NE(id_of_thread[static_cast<std::size_t>(i)],
                id_of_thread[static_cast<std::size_t>(j)]);
    }
  }
}

TEST(ThreadPool, NeverRunsTwoTasksUnderOneNumber) {
  ThreadPool pool(4);
  std::vector<std::atomic<bool>> busy(4);
  std::atomic<int> collisions{0};
  pool.parallel_for(5000, [&](int, int thread) {
    auto& mine = busy[static_cast<std::size_t>(thread)];
    if (mine.exchange(true)) ++collisions;
    mine = false;
  });
  EXPECT_EQ(collisions, 0);
}

// Writes without atomics into places chosen by index, and reads them after parallel_for: the thread
// sanitizer build proves that the pool orders the two.
TEST(ThreadPool, IsReusedTenThousandTimes) {
  ThreadPool pool(3);
  std::vector<int> values(5, 0);
  for (int round = 0; round < 10000; ++round) {
    pool.parallel_for(5, [&](int index, int) { ++values[static_cast<std::size_t>(index)]; });
  }
  EXPECT_THAT(values, testing::Each(10000));
}

TEST(ThreadPool, HandsTheFirstExceptionToTheCaller) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    std::atomic<int> begun{0};
    try {
      pool.parallel_for(1000, [&](int index, int) {
        ++begun;
        if (index == 3) throw std::runtime_error("task 3");
      });
      FAIL() << "no exception left parallel_for";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "task 3");
    }
    if (threads == 1) {
      EXPECT_EQ(begun, 4);  // the rest is not begun
    }
  }
}

TEST(ThreadPool, WorksOnAfterAnException) {
  ThreadPool pool(2);
  EXPECT_THROW(pool.parallel_for(8, [](int, int) { throw std::runtime_error("each"); }),
               std::runtime_error);
  std::atomic<int> runs{0};
  pool.parallel_for(8, [&](int, int) { ++runs; });
  EXPECT_EQ(runs, 8);
}

TEST(ThreadPool, MayBeUsedInsideATaskOfAnotherPool) {
  ThreadPool outer(2);
  std::atomic<int> runs{0};
  outer.parallel_for(2, [&](int, int) {
    ThreadPool inner(2);
    inner.parallel_for(3, [&](int, int) { ++runs; });
  });
  EXPECT_EQ(runs, 6);
}

TEST(ThreadPoolDeathTest, AssertsWhenNested) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        ThreadPool pool(2);
        pool.parallel_for(2, [&](int, int) { pool.parallel_for(1, [](int, int) {}); });
      },
      "assertion failed");
}

TEST(ThreadPoolDeathTest, AssertsThatThereIsAThread) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(ThreadPool(0), "assertion failed");
}

TEST(ThreadPool, DefaultIsAtLeastOneThread) {
  EXPECT_GE(default_thread_count(), 1);
}

}  // namespace
}  // namespace binpick::app
