// SPDX-License-Identifier: GPL-3.0-or-later
// What goes between the haptic thread and the simulation: nothing is lost, mixed up, or allocated where it must not be.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <optional>
#include <thread>

#include "recorder/base/queues.h"
#include "recorder/engine/session.h"
#include "recorder/live/haptic_thread.h"
#include "sim/step/hand_haptics.h"
#include "tests/recorder/support/small_scene.h"

namespace {

thread_local std::optional<std::size_t> allocations;  // counted where it holds a number

}  // namespace

// The sanitizers bring these themselves: nothing is counted there.
#ifndef CALOT_SANITIZED
void* operator new(std::size_t size) {
  if (allocations) ++*allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t /*size*/) noexcept { std::free(p); }
#endif

namespace calot::recorder {
namespace {

TEST(Newest, TheReaderGetsWholeValuesInOrderAndTheLastOne) {
  struct Pair {
    std::uint64_t a = 0, b = 0;
  };
  constexpr std::uint64_t last = 200000;
  Newest<Pair> newest;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= last; ++i) {
      newest.draft() = {i, ~i};
      newest.publish();
    }
  });
  std::uint64_t seen = 0;
  bool whole = true, rising = true;
  while (seen < last) {
    if (!newest.refresh()) continue;
    const Pair& p = newest.value();
    whole = whole && p.b == ~p.a;
    rising = rising && p.a > seen;
    seen = p.a;
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(rising);
  EXPECT_FALSE(newest.refresh()) << "nothing newer";
}

TEST(Ring, NothingIsLostAndAFullOneRefuses) {
  Ring<int> small(2);
  int value = 0;
  EXPECT_FALSE(small.pop(value));
  EXPECT_TRUE(small.push(1));
  EXPECT_TRUE(small.push(2));
  EXPECT_FALSE(small.push(3));
  EXPECT_TRUE(small.pop(value));
  EXPECT_EQ(value, 1);
  EXPECT_TRUE(small.push(3));

  constexpr int last = 200000;
  Ring<int> ring(7);
  std::thread producer([&] {
    for (int i = 1; i <= last; ++i) {
      while (!ring.push(i)) std::this_thread::yield();
    }
  });
  int expected = 1;
  bool inOrder = true;
  while (expected <= last) {
    if (!ring.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    inOrder = inOrder && value == expected;
    ++expected;
  }
  producer.join();
  EXPECT_TRUE(inOrder);
}

/// Contact sets of a performer who presses: they come, grow, shrink and go.
TEST(ContactExchange, TheHapticSideMakesTheSessionsForcesAndAllocatesNothing) {
  const test::SmallScene scene = test::smallScene();
  const std::unique_ptr<SampleSource> source = test::performer(scene, "skilled", 5);
  SerialExecutor executor;
  Session session(*scene.model, 4, executor);
  ContactExchange exchange(*scene.model, session.haptics(), session.contactSets());
  std::array<HapticModel, handCount> model{hapticModel(*scene.model, 0), hapticModel(*scene.model, 1)};
  const std::uint32_t ticksPerStep = scene.model->scene().ticksPerStep;
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  session.onContactSets([&](const ContactSets& sets) { exchange.publish(sets); });
  std::size_t grownSteps = 0, firm = 0;
#ifndef CALOT_SANITIZED
  allocations = 0;
  ::operator delete(::operator new(8));
  EXPECT_GT(*allocations, 0U) << "allocations are not counted";
  allocations.reset();
#endif
  for (std::uint64_t step = 0; step < 400; ++step) {
    const std::uint64_t grown = exchange.grown();
    for (std::uint32_t i = 0; i < ticksPerStep; ++i) {
      ASSERT_TRUE(source->next(step * ticksPerStep + i, samples[i]));
      // Not at every step: sets are overtaken by newer ones, with the room that came with them.
      if (step % 3 == 0) {
        allocations = 0;
        exchange.refresh();
        const std::size_t counted = *allocations;
        allocations.reset();
        ASSERT_EQ(counted, 0U) << "step " << step;
      }
      std::array<std::int64_t, handCount> named{};
      std::array<HapticForce, handCount> force;
      for (std::size_t h = 0; h < handCount; ++h) {
        allocations = 0;
        takeSample(*scene.model, h, samples[i].hand[h], exchange.states()[h]);
        force[h] = hapticTick(model[h], exchange.states()[h], exchange.sets()[h]);
        const std::size_t counted = *allocations;
        allocations.reset();
        ASSERT_EQ(counted, 0U) << "step " << step << ", tick " << i;
        named[h] = exchange.sets()[h].step;
      }
      ticks[i] = session.tick(samples[i], named);
      for (std::size_t h = 0; h < handCount; ++h) {
        ASSERT_EQ(force[h].force, ticks[i].hand[h].force) << "step " << step << ", tick " << i;
        ASSERT_EQ(force[h].torque, ticks[i].hand[h].torque);
        if (force[h].force.norm() > 0.0) ++firm;
      }
    }
    session.step(samples, ticks, 0.0F);
    if (exchange.grown() > grown) ++grownSteps;
  }
  EXPECT_GT(firm, 300U) << "nothing was pressed";
  EXPECT_GT(grownSteps, 0U);
  EXPECT_LT(grownSteps, 100U);
}

}  // namespace
}  // namespace calot::recorder
