// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels process a fixed number of lanes, each an independent element, whatever the machine's vector width: wider
// hardware is faster and gives the same bits. A kernel is a plain loop over the lanes with a scalar body, which the
// compiler vectorises. CALOT_LANE_KERNEL adds clones for wider machines, selected at program start.
#pragma once

#include <cstddef>

namespace calot {

inline constexpr int laneCount = 8;

/// Number of groups of lanes that hold `count` elements.
constexpr std::size_t laneGroups(std::size_t count) { return (count + laneCount - 1) / laneCount; }

#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(CALOT_SANITIZED) && !defined(CALOT_NO_CLONES)
#define CALOT_LANE_KERNEL __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CALOT_LANE_KERNEL
#endif

}  // namespace calot
