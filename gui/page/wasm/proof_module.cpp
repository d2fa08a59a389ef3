// SPDX-License-Identifier: GPL-3.0-or-later
// What a proof needs beside the engine, as a WebAssembly module: digests, the content chain, and keyframes from
// their differences.
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "gui/page/wasm/blake2b.h"
#include "gui/page/wasm/thrown.h"
#include "recorder/recording/keyframe_code.h"
#include "sim/math/fields.h"

namespace {

std::vector<std::byte>& decoded() {
  static std::vector<std::byte> bytes;
  return bytes;
}

std::string& fault() {
  static std::string text;
  return text;
}

calot::page::Blake2b& chain() {
  static calot::page::Blake2b hash;
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
