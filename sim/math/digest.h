// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace calot {

/// XXH3-64 (xxHash 0.8 specification, seed 0) of bytes. Not cryptographic: it detects differences but proves no origin.
std::uint64_t digest64(std::span<const std::byte> bytes);

/// Streaming form of the same hash: feeding pieces one after the other equals hashing their concatenation.
class DigestStream {
 public:
  DigestStream();
  ~DigestStream();
  DigestStream(const DigestStream&) = delete;
  DigestStream& operator=(const DigestStream&) = delete;
  void reset();
  void append(const void* data, std::size_t size);
  [[nodiscard]] std::uint64_t value() const;

 private:
  struct Storage;
  Storage* storage_;
};

}  // namespace calot
