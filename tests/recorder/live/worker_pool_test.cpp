// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <set>
#include <thread>
#include <vector>

#include "sim/math/random.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace {

using calot::recorder::WorkerPool;

class WorkerPools : public ::testing::TestWithParam<unsigned> {};

TEST_P(WorkerPools, RunEachTaskExactlyOnce) {
  WorkerPool pool(GetParam());
  EXPECT_EQ(pool.threadCount(), GetParam());
  for (const std::size_t count : {0U, 1U, 2U, 3U, 7U, 64U, 1000U, 20000U}) {
    std::vector<std::atomic<int>> runs(count);
    pool.run(count, [&](std::size_t i) { ++runs.at(i); });
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(runs[i], 1) << i << " of " << count;
  }
}

TEST_P(WorkerPools, WhatTasksWroteIsSeenAfterwardsInEveryBatch) {
  // Plain, not atomic: the batch's end orders the tasks' writes before the caller's reads, and its start the other way
  // round. A thread sanitizer checks that; everyone checks the sums.
  WorkerPool pool(GetParam());
  std::vector<std::uint64_t> values(257);
  std::uint64_t expected = 0;
  for (std::uint64_t batch = 1; batch <= 3000; ++batch) {
    const std::size_t count = 1 + batch * 7919 % values.size();
    pool.run(count, [&](std::size_t i) { values[i] += batch * (i + 1); });
    expected += batch * (count * (count + 1) / 2);
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t v : values) sum += v;
  EXPECT_EQ(sum, expected);
}

TEST_P(WorkerPools, GiveTheSameBitsAsOneThread) {
  const auto compute = [](calot::Executor& executor) {
    std::vector<double> partial(97);
    executor.run(partial.size(), [&](std::size_t i) {
      calot::Random random(5, i);
      for (int k = 0; k < 200; ++k) partial[i] += random.normal();
    });
    double sum = 0.0;
    for (const double p : partial) sum += p;
    return sum;
  };
  calot::SerialExecutor serial;
  WorkerPool pool(GetParam());
  const double expected = compute(serial);
  for (int i = 0; i < 50; ++i) ASSERT_EQ(compute(pool), expected);
}

TEST_P(WorkerPools, WakeAfterSleep) {
  WorkerPool pool(GetParam());
  calot::Random random(11);
  for (int i = 0; i < 40; ++i) {
    std::this_thread::sleep_for(std::chrono::microseconds(random.next() % 3000));
    std::atomic<int> runs{0};
    pool.run(5, [&](std::size_t task) {
      if (task == 4 && i % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the caller sleeps too
      ++runs;
    });
    ASSERT_EQ(runs, 5);
  }
}

TEST_P(WorkerPools, SetTheFloatingPointEnvironmentOfEveryTask) {
#if defined(__x86_64__)
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);  // the host flushes denormals to zero
  WorkerPool pool(GetParam());
  std::vector<unsigned> seen(200);
  pool.run(seen.size(), [&](std::size_t i) {
    seen[i] = _mm_getcsr() & 0xFFC0U;
    std::this_thread::yield();
  });
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  EXPECT_EQ(after & 0x8040U, 0x8040U) << "the caller's environment was not restored";
  EXPECT_EQ(std::set<unsigned>(seen.begin(), seen.end()), std::set<unsigned>{0x1F80U});
#else
  GTEST_SKIP() << "reads the control register of x86";
#endif
}

INSTANTIATE_TEST_SUITE_P(Threads, WorkerPools, ::testing::Values(1U, 2U, 3U, 8U));

TEST(WorkerPoolTest, ComesAndGoesWithoutWork) {
  for (unsigned i = 0; i < 200; ++i) WorkerPool pool(i % 5);
}

TEST(WorkerPoolTest, SeveralThreadsTakePart) {
  WorkerPool pool(2);
  // Each task waits until the other runs: only two threads can end this.
  std::atomic<int> arrived{0};
  std::vector<std::thread::id> ids(2);
  pool.run(2, [&](std::size_t i) {
    ids[i] = std::this_thread::get_id();
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_NE(ids[0], ids[1]);
}

#ifndef NDEBUG
TEST(WorkerPoolDeathTest, NestedRunIsAProgrammingError) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        WorkerPool pool(2);
        pool.run(2, [&](std::size_t) { pool.run(2, [](std::size_t) {}); });
      },
      "inside a task");
}
#endif

}  // namespace
