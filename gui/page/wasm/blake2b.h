// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace calot::page {

/// BLAKE2b with a digest of 32 bytes and no key (RFC 7693): the content chain's hash. The programs take libsodium's,
/// which is no library for WebAssembly here.
class Blake2b {
 public:
  Blake2b();
  void append(std::span<const std::byte> bytes);
  /// Nothing is appended after that.
  [[nodiscard]] std::array<std::byte, 32> digest();

 private:
  static constexpr std::size_t blockBytes = 128;
  void compress(bool last);

  std::array<std::uint64_t, 8> h_;
  std::array<std::byte, blockBytes> block_{};
  std::size_t filled_ = 0;
  std::uint64_t total_ = 0;  ///< bytes in compressed blocks: far below 2^64
};

}  // namespace calot::page
