// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/common/exit_code.h"

#include <algorithm>

namespace calot::apps {

ExitCode codeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::failure:
      return ExitCode::failure;
    case ErrorKind::invalid:
      return ExitCode::usage;
    case ErrorKind::refused:
      return ExitCode::no;
    case ErrorKind::damaged:
      return ExitCode::damaged;
    case ErrorKind::undecided:
      return ExitCode::undecided;
  }
  return ExitCode::failure;
}

ExitCode codeOf(const std::optional<ErrorKind>& fault) { return fault ? codeOf(*fault) : ExitCode::yes; }

ExitCode worstOf(const std::vector<ExitCode>& codes) {
  for (const ExitCode code : {ExitCode::failure, ExitCode::damaged, ExitCode::no, ExitCode::undecided}) {
    if (std::find(codes.begin(), codes.end(), code) != codes.end()) return code;
  }
  return ExitCode::yes;
}

}  // namespace calot::apps
