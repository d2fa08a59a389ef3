// SPDX-License-Identifier: GPL-3.0-or-later
// To be included first, before everything else. gcc 12 turns pairs a b - c d, a b + c d (rotations) into one fused
// instruction (fmaddsub) where the machine has it, even with -ffp-contract=off: that changes bits. It does so in its
// straight-line vectoriser only, which sources with such pairs therefore do without.
#pragma once

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")
#endif
