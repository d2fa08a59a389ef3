// SPDX-License-Identifier: GPL-3.0-or-later
// A stream of OpenIGTLink messages, as it arrives in pieces: the first byte says how long they are.
#include <algorithm>

#include "recorder/sources/devices/openigtlink_device.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  const std::size_t piece = 1 + std::size_t{fuzz::takeByte(bytes)};
  recorder::openigtlink::Decoder decoder;
  const auto ignore = [](const recorder::openigtlink::Item&) {};
  while (!bytes.empty() && decoder.take(bytes.first(std::min(piece, bytes.size())), ignore))
    bytes = bytes.subspan(std::min(piece, bytes.size()));
  return 0;
}
