// SPDX-License-Identifier: GPL-3.0-or-later
// All benchmarks, one function for each file of this folder. Names are paths: the first part is the concern, which
// --benchmark_filter picks by.
#pragma once

namespace calot::bench {

void registerContactStep();  ///< contact/step: whole steps against deformation alone
void registerHaptics();      ///< haptics/tick

inline void registerAll() {
  registerContactStep();
  registerHaptics();
}

}  // namespace calot::bench
