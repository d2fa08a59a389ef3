// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/contact_exchange.h"

#include <algorithm>

#include "sim/step/hand_haptics.h"

namespace calot::recorder {

namespace {

/// Visits the vectors among a part's fields, also of parts within it.
template <class Use>
struct Vectors {
  Use use;
  std::size_t count = 0;
  template <class T>
  void operator()(const char* /*name*/, T& value) {
    visit(value);
  }
  template <class T>
  void visit(std::vector<T>& values) {
    if (count++ < maxVectors) use(values);
  }
  template <class T>
  void visit(const std::vector<T>& values) {
    if (count++ < maxVectors) use(values);
  }
  template <class T>
  void visit(T& value) {
    if constexpr (requires { std::remove_const_t<T>::fields(value, *this); })
      std::remove_const_t<T>::fields(value, *this);
  }
};

template <class Part, class Use>
void forEachVector(Part& part, Use use) {
  Vectors<Use> visit{std::move(use)};
  std::remove_const_t<Part>::fields(part, visit);
}

/// Gives every vector of `to` at least the capacity of its counterpart.
void reserveLike(HapticState& to, const HapticState& like) {
  VectorSizes wanted{};
  std::size_t i = 0;
  forEachVector(like, [&](const auto& v) { wanted[i++] = v.capacity(); });
  i = 0;
  forEachVector(to, [&](auto& v) { v.reserve(wanted[i++]); });
}

}  // namespace

ContactExchange::ContactExchange(const Model& model, const HapticStates& states, const ContactSets& sets)
    : states_(states), room_(states) {
  for (std::size_t h = 0; h < handCount; ++h) model_[h] = hapticModel(model, h);
  publish(sets);
  refresh();
  grown_ = 0;
}

bool ContactExchange::outgrown(const ContactSets& sets) {
  bool grown = false;
  for (std::size_t h = 0; h < handCount; ++h) {
    std::size_t i = 0;
    forEachVector(sets[h], [&](const auto& v) {
      if (v.size() > most_[h][i]) {
        most_[h][i] = v.size();
        grown = true;
      }
      ++i;
    });
  }
  return grown;
}

void ContactExchange::makeRoom(const ContactSets& sets) {
  for (std::size_t h = 0; h < handCount; ++h) {
    HapticState tried = room_[h];
    reserveLike(tried, room_[h]);
    hapticTick(model_[h], tried, sets[h]);
    room_[h] = std::move(tried);
  }
  ++generation_;
}

void ContactExchange::publish(const ContactSets& sets) {
  Slot& slot = newest_.draft();
  slot.sets = sets;
  if (outgrown(sets)) {
    ++grown_;
    makeRoom(sets);
  }
  // Every publication carries the new capacity until the haptic thread has adopted it, since it may miss some.
  if (seen_.load(std::memory_order_acquire) < generation_ && slot.generation < generation_) {
    for (std::size_t h = 0; h < handCount; ++h) {
      slot.room[h] = room_[h];
      reserveLike(slot.room[h], room_[h]);
    }
    slot.generation = generation_;
  }
  newest_.publish();
}

void ContactExchange::refresh() {
  if (!newest_.refresh()) return;
  Slot& slot = newest_.value();
  if (slot.generation <= adopted_) return;
  for (std::size_t h = 0; h < handCount; ++h) {
    slot.room[h] = states_[h];  // it has the capacity
    std::swap(states_[h], slot.room[h]);
  }
  adopted_ = slot.generation;
  seen_.store(adopted_, std::memory_order_release);
}

}  // namespace calot::recorder
