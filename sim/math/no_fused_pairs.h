// SPDX-License-Identifier: GPL-3.0-or-later
// Include first. gcc 12 compiles pairs a b - c d, a b + c d (rotations) to one fused instruction (fmaddsub) where
// available, even with -ffp-contract=off, which changes bits. Only its straight-line vectoriser does so; it is disabled
// in sources with such pairs.
#pragma once

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-slp-vectorize")
#endif
