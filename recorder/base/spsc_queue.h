// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <utility>

namespace calot::recorder {

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
