// SPDX-License-Identifier: GPL-3.0-or-later
// Queues of two threads without a lock: of the newest value, and of all values.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace calot::recorder {

/// Triple buffer that passes the newest value from one writing thread to one reading thread. Neither thread ever waits,
/// locks or copies; values that the reader misses are overwritten. Slots keep their memory, so that a value no larger
/// than earlier ones allocates nothing.
template <class T>
class Newest {
 public:
  /// Writer: the slot to be filled. It holds what stood there two or more publications ago.
  T& draft() { return slots_[writing_]; }
  /// Writer: makes the draft the newest value; draft() is another slot from here on.
  void publish() {
    writing_ = between_.exchange(static_cast<std::uint8_t>(writing_ | fresh), std::memory_order_acq_rel) & index;
  }

  /// Reader: takes the newest value. @returns false if there is none newer than value().
  bool refresh() {
    if ((between_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & index;
    return true;
  }
  /// Reader: what the last refresh() took; it is the reader's own until the next one.
  T& value() { return slots_[reading_]; }

 private:
  static constexpr std::uint8_t index = 3;
  static constexpr std::uint8_t fresh = 4;
  std::array<T, 3> slots_{};
  std::uint8_t writing_ = 0;              // the writer's
  std::atomic<std::uint8_t> between_{1};  // slot, and whether it was published after the reader's last refresh
  std::uint8_t reading_ = 2;              // the reader's
};

/// Lock-free queue of one producer and one consumer over a fixed number of slots; allocates in its constructor alone.
template <class T>
class Ring {
 public:
  /// @pre capacity > 0
  explicit Ring(std::size_t capacity) : slots_(capacity) {}

  /// Producer only. @returns false, with nothing done, where all slots are taken.
  bool push(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[end % slots_.size()] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. @returns false if there is nothing.
  bool pop(T& value) {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    value = slots_[begin % slots_.size()];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> begin_{0};  // values taken so far
  alignas(64) std::atomic<std::size_t> end_{0};    // values put so far
};

/// Lock-free queue of one producer and one consumer, without a bound: a linked list whose nodes the producer uses again
/// once the consumer has passed them, so that it allocates only where it grows (D. Vyukov's unbounded SPSC queue).
template <class T>
class SpscQueue {
 public:
  SpscQueue() : head_(new Node), first_(head_.load(std::memory_order_relaxed)), tail_(first_), passed_(first_) {}
  ~SpscQueue() {
    for (Node* n = first_; n != nullptr;) {
      Node* next = n->next.load(std::memory_order_relaxed);
      delete n;
      n = next;
    }
  }
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  /// Producer only.
  void push(T value) {
    Node* n = take();
    n->value = std::move(value);
    n->next.store(nullptr, std::memory_order_relaxed);
    tail_->next.store(n, std::memory_order_release);
    tail_ = n;
  }

  /// Consumer only. @return false if there is nothing.
  bool pop(T& value) {
    Node* head = head_.load(std::memory_order_relaxed);
    Node* n = head->next.load(std::memory_order_acquire);
    if (n == nullptr) return false;
    value = std::move(n->value);
    head_.store(n, std::memory_order_release);
    return true;
  }

 private:
  struct Node {
    std::atomic<Node*> next{nullptr};
    T value{};
  };

  Node* take() {
    if (first_ == passed_) passed_ = head_.load(std::memory_order_acquire);
    if (first_ == passed_) return new Node;
    Node* n = first_;
    first_ = n->next.load(std::memory_order_relaxed);
    return n;
  }

  std::atomic<Node*> head_;  // the consumer's: the node it consumed last
  Node* first_;              // the producer's: oldest node, free up to head_
  Node* tail_;               // the producer's: newest node
  Node* passed_;             // the producer's last sight of head_
};

}  // namespace calot::recorder
