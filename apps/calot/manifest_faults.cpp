// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/manifest_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "apps/common/advice.h"
#include "apps/common/exit_code.h"

namespace calot::apps {

int refuseRows(const std::vector<Error>& faults) {
  constexpr std::size_t most = 20;
  std::vector<ExitCode> codes;
  codes.reserve(faults.size());
  for (const Error& fault : faults) codes.push_back(codeOf(fault.kind()));
  for (std::size_t i = 0; i < std::min(faults.size(), most); ++i)
    fmt::print(stderr, "calot: {}\n", messageOf(faults[i]));
  if (faults.size() > most)
    fmt::print(stderr, "calot: and {} more wrong rows; nothing was stored\n", faults.size() - most);
  return static_cast<int>(worstOf(codes));
}

}  // namespace calot::apps
