// SPDX-License-Identifier: GPL-3.0-or-later
// What every fuzz target is: a function of bytes that may throw an Error and do nothing else wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "recorder/base/errors.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace calot::fuzz {

/// Takes the next byte; 0 at the end.
inline std::uint8_t takeByte(std::span<const std::byte>& bytes) {
  if (bytes.empty()) return 0;
  const auto byte = std::to_integer<std::uint8_t>(bytes.front());
  bytes = bytes.subspan(1);
  return byte;
}

inline std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A refusal is an answer.
template <class Task>
int tried(Task task) {
  try {
    task();
  } catch (const Error&) {
    return 0;
  }
  return 0;
}

}  // namespace calot::fuzz
