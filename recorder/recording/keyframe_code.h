// SPDX-License-Identifier: GPL-3.0-or-later
// Keyframes as differences from earlier ones (schemas/recording.md, "Keyframes"). Between two keyframes most of a State
// does not change, and what does changes little: as differences of 64-bit words it deflates to a third. Internal to
// this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"

namespace calot::recorder {

/// Longest way of keyframes, each stored as differences from the next one of the way, that is followed.
inline constexpr std::size_t maxKeyframeWay = 64;
inline constexpr std::uint64_t maxKeyframeParts = 65536;

/// The keyframe that the writer stores keyframe i as differences from; none for the first. At most 3 log4(i) + 1 of
/// them have to be decoded to decode one, and most are near.
std::optional<std::uint64_t> writtenBase(std::uint64_t index);

/// Codes the keyframes of one recording, in their order. Keeps those that later ones will be compared with: one for
/// each digit of the newest one's number in base 4.
class KeyframeCoder {
 public:
  /// The words of the next keyframe. @param keyframe its parts, where it has some, are at most maxKeyframeParts and
  /// add up to its bytes
  std::vector<std::uint64_t> code(const Keyframe& keyframe);

 private:
  struct Known {
    std::vector<std::byte> bytes;
    std::vector<KeyframePart> parts;
  };
  std::uint64_t next_ = 0;
  std::map<std::uint64_t, Known> known_;
};

/// The words of one coded keyframe, taken apart. Nothing in them is trusted.
class CodedKeyframe {
 public:
  /// @param index of the keyframe
  CodedKeyframe(std::span<const std::uint64_t> words, std::uint64_t index);

  /// Describes faults that are visible without the base; empty if there are none.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const std::optional<std::uint64_t>& base() const { return base_; }

  /// Decodes. @param base bytes of the base; empty if it has none. @param size bytes that the keyframe has.
  /// @return an empty string, or what is wrong. @pre fault() is empty
  std::string decode(std::span<const std::byte> base, std::uint64_t size, std::vector<std::byte>& out) const;

 private:
  std::string fault_;
  std::optional<std::uint64_t> base_;
  std::uint64_t parts_ = 0;
  std::span<const std::uint64_t> descriptions_, values_;
};

}  // namespace calot::recorder
