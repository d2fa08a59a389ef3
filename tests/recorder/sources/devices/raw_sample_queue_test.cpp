// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_source.h"

#include <gtest/gtest.h>

#include <thread>

namespace calot::recorder {
namespace {

RawSample sampleOf(std::uint64_t n, Hand hand = Hand::right) {
  RawSample raw;
  raw.sample.sequence = n;
  raw.sample.hand = hand;
  raw.tick = n / 3;
  return raw;
}

TEST(RawSampleQueue, GivesWhatLiesBeforeATickAndKeepsTheRest) {
  RawSampleQueue queue;
  for (std::uint64_t n = 0; n < 10; ++n) queue.put(sampleOf(n));
  RawSample out;
  std::uint64_t got = 0;
  while (queue.take(2, out)) EXPECT_EQ(out.sample.sequence, got++);
  EXPECT_EQ(got, 6U);
  EXPECT_FALSE(queue.take(2, out));
  while (queue.take(100, out)) EXPECT_EQ(out.sample.sequence, got++);
  EXPECT_EQ(got, 10U);
}

TEST(RawSampleQueue, CountsWhatFindsNoRoom) {
  RawSampleQueue queue(4);
  for (std::uint64_t n = 0; n < 6; ++n) queue.put(sampleOf(n, Hand::left));
  queue.put(sampleOf(6));
  EXPECT_EQ(queue.dropped(), (std::array<std::uint64_t, handCount>{2, 1}));
  RawSample out;
  std::uint64_t got = 0;
  while (queue.take(100, out)) EXPECT_EQ(out.sample.sequence, got++);
  EXPECT_EQ(got, 4U);
  queue.put(sampleOf(7));
  EXPECT_TRUE(queue.take(100, out));
  EXPECT_EQ(out.sample.sequence, 7U);
}

TEST(RawSampleQueue, BetweenTwoThreadsEverySampleComesOnceOrIsCounted) {
  RawSampleQueue queue(64);
  constexpr std::uint64_t count = 200000;
  std::atomic<bool> done{false};
  std::thread producer([&] {
    for (std::uint64_t n = 0; n < count; ++n) queue.put(sampleOf(n));
    done = true;
  });
  std::uint64_t got = 0, next = 0;
  RawSample out;
  for (bool last = false; !last;) {
    last = done;
    while (queue.take(count, out)) {
      EXPECT_GE(out.sample.sequence, next);
      next = out.sample.sequence + 1;
      ++got;
    }
  }
  producer.join();
  EXPECT_EQ(got + queue.dropped()[1], count);
  EXPECT_GT(got, 0U);
}

}  // namespace
}  // namespace calot::recorder
