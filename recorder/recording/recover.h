// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace calot::recorder {

struct Recovered {
  std::uint64_t steps = 0;  ///< saved
  std::uint64_t ticks = 0;  ///< saved
  bool complete = false;    ///< all of a finished attempt was there
  std::string lost;         ///< why the rest could not be saved; empty if no covered row is lost

  static void fields(auto& self, auto& visit) {
    visit("steps", self.steps);
    visit("ticks", self.ticks);
    visit("complete", self.complete);
    visit("lost", self.lost);
  }
};

/// Rewrites a recording that was left by a killed writer, or was cut off, as a clean closed file of the same attempt:
/// same uuid, same header and scene, every flush up to the first that cannot be read or breaks the chain, so that both
/// chains agree as far as the new file goes. Reads in a child process.
/// @throws Error damaged: nothing can be saved, and why. invalid: `out` exists and force is not set, or is `in` itself.
/// failure: `out` cannot be written. Never leaves a half-written `out`.
Recovered recover(const std::filesystem::path& in, const std::filesystem::path& out, bool force);

}  // namespace calot::recorder
