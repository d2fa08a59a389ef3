// SPDX-License-Identifier: GPL-3.0-or-later
// What a proof needs beside the engine, as a WebAssembly module: digests, the content chain, and keyframes from
// their differences.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "gui/page/wasm/thrown.h"
#include "recorder/recording/keyframe_code.h"
#include "sim/math/fields.h"

namespace {

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

constexpr std::array<std::uint64_t, 8> start{0x6a09e667f3bcc908, 0xbb67ae8584caa73b, 0x3c6ef372fe94f82b,
                                             0xa54ff53a5f1d36f1, 0x510e527fade682d1, 0x9b05688c2b3e6c1f,
                                             0x1f83d9abfb41bd6b, 0x5be0cd19137e2179};
constexpr std::uint64_t parameters = 0x01010000 ^ 32U;  // depth 1, fanout 1, no key, 32 bytes

constexpr std::array<std::array<std::uint8_t, 16>, 10> sigma{{
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
    {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4},
    {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
    {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13},
    {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
    {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11},
    {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
    {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5},
    {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0},
}};

Blake2b::Blake2b() : h_(start) { h_[0] ^= parameters; }

void Blake2b::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (filled_ == blockBytes) {  // not before more comes: the last block is compressed otherwise
      total_ += blockBytes;
      compress(false);
      filled_ = 0;
    }
    const std::size_t n = std::min(bytes.size(), blockBytes - filled_);
    std::memcpy(block_.data() + filled_, bytes.data(), n);
    filled_ += n;
    bytes = bytes.subspan(n);
  }
}

std::array<std::byte, 32> Blake2b::digest() {
  total_ += filled_;
  std::fill(block_.begin() + static_cast<std::ptrdiff_t>(filled_), block_.end(), std::byte{0});
  compress(true);
  std::array<std::byte, 32> out{};
  std::memcpy(out.data(), h_.data(), out.size());
  return out;
}

void Blake2b::compress(bool last) {
  std::array<std::uint64_t, 16> m{};
  std::memcpy(m.data(), block_.data(), blockBytes);
  std::array<std::uint64_t, 16> v{};
  for (std::size_t i = 0; i < 8; ++i) {
    v[i] = h_[i];
    v[i + 8] = start[i];
  }
  v[12] ^= total_;
  if (last) v[14] = ~v[14];
  for (std::size_t round = 0; round < 12; ++round) {
    const auto& s = sigma[round % sigma.size()];
    for (std::size_t g = 0; g < 8; ++g) {  // the columns of the state's four rows, then its diagonals
      const auto at = [g](std::size_t row) { return 4 * row + (g + row * (g / 4)) % 4; };
      const std::size_t a = at(0), b = at(1), c = at(2), d = at(3);
      v[a] += v[b] + m[s[2 * g]];
      v[d] = std::rotr(v[d] ^ v[a], 32);
      v[c] += v[d];
      v[b] = std::rotr(v[b] ^ v[c], 24);
      v[a] += v[b] + m[s[2 * g + 1]];
      v[d] = std::rotr(v[d] ^ v[a], 16);
      v[c] += v[d];
      v[b] = std::rotr(v[b] ^ v[c], 63);
    }
  }
  for (std::size_t i = 0; i < 8; ++i) h_[i] ^= v[i] ^ v[i + 8];
}

std::vector<std::byte>& decoded() {
  static std::vector<std::byte> bytes;
  return bytes;
}

std::string& fault() {
  static std::string text;
  return text;
}

Blake2b& chain() {
  static Blake2b hash;
  return hash;
}

}  // namespace

extern "C" {

// A head of the content chain: begin, append what is placed as often as wanted, then take its 32 bytes.
__attribute__((export_name("calot_chain_begin"))) void calot_chain_begin() { chain() = {}; }
__attribute__((export_name("calot_chain_append"))) void calot_chain_append(std::uint32_t length) {
  chain().append(std::span(calot::page::placed()).first(length));
}
__attribute__((export_name("calot_chain_head"))) const std::byte* calot_chain_head() {
  static std::array<std::byte, 32> head;
  head = chain().digest();
  return head.data();
}

/// XXH3-64 of the first `length` placed bytes.
__attribute__((export_name("calot_digest"))) std::uint64_t calot_digest(std::uint32_t length) {
  return calot::digest64(std::span(calot::page::placed()).first(length));
}

/// Decodes a keyframe: placed are its words, then the bytes of its base. @return 1, or 0: calot_fault() says why
__attribute__((export_name("calot_keyframe"))) int calot_keyframe(std::uint32_t index, std::uint32_t words,
                                                                  std::uint32_t baseBytes, std::uint32_t size) {
  const std::span<const std::byte> placed = calot::page::placed();
  std::vector<std::uint64_t> code(words);
  std::memcpy(code.data(), placed.data(), code.size() * sizeof(std::uint64_t));
  const std::span<const std::byte> base = placed.subspan(code.size() * sizeof(std::uint64_t), baseBytes);
  const calot::recorder::CodedKeyframe keyframe(code, index);
  fault() = keyframe.fault();
  if (fault().empty()) fault() = keyframe.decode(base, size, decoded());
  return fault().empty() ? 1 : 0;
}

__attribute__((export_name("calot_decoded"))) const std::byte* calot_decoded() { return decoded().data(); }
__attribute__((export_name("calot_fault"))) const char* calot_fault() { return fault().c_str(); }

}  // extern "C"
