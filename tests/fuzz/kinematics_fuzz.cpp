// SPDX-License-Identifier: GPL-3.0-or-later
// A file of recorded kinematics.
#include "recorder/sources/tracked_motion.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] { recorder::parseKinematics(bytes, "motion.txt"); });
}
