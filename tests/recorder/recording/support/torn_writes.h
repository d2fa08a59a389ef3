// SPDX-License-Identifier: GPL-3.0-or-later
// Writes that stop half way: what a kill does to a process between two pages of one write, made likely.
#pragma once

#include <chrono>

namespace calot::recorder::test {

/// From now on every write of this process at a place of a file rests that long at its first boundary of a page: the
/// kernel sees a fatal signal between two pages, and one that arrives meanwhile leaves the write half done.
void tearWrites(std::chrono::microseconds rest);

}  // namespace calot::recorder::test
