// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

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

}  // namespace calot::recorder
