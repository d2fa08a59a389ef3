// SPDX-License-Identifier: GPL-3.0-or-later
// One box of tests/bench/hanging_box.h, alone in a process: what a step takes and how much memory. Built twice: as
// calot-box from the same objects as everything else, and as calot-box-unbound from the same sources without the flags
// of the determinism contract, for this very machine: what the contract costs.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/bench/hanging_box.h"

int main(int count, char** argument) {
  using namespace calot::bench;
  const int wanted = count > 1 ? std::atoi(argument[1]) : 0;
  const int rounds = count > 2 ? std::atoi(argument[2]) : 1;
  const BoxSize* size =
      std::find_if(std::begin(boxSizes), std::end(boxSizes), [&](const BoxSize& s) { return s.tetrahedra == wanted; });
  if (size == std::end(boxSizes) || rounds < 1) {
    std::fprintf(stderr, "usage: %s TETRAHEDRA [ROUNDS]: 504, 1500, 5040, 10800, 49152 or 202800\n", argument[0]);
    return 2;
  }
  const HangingBody body = hangingBox(*size, HangingBox::soft);
  const calot::SolidModel model = modelOf(body);
  Own least;
  least.hung.seconds = 1e300;
  for (int i = 0; i < rounds; ++i) {
    const Own own = hangOurs(model, body, size->steps, 1e-3);
    if (own.hung.seconds < least.hung.seconds) least = own;
  }
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  std::printf("{\"seconds\": %.9g, \"iterations\": %.9g, \"memory_mb\": %.9g}\n", least.hung.seconds, least.iterations,
              1e-6 * 1024.0 * static_cast<double>(used.ru_maxrss));
  return 0;
}
