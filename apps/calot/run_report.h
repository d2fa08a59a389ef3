// SPDX-License-Identifier: GPL-3.0-or-later
// What `record` and `branch` say when they are done.
#pragma once

#include <string>

#include "recorder/loop.h"

namespace calot::apps {

struct FinishedRun {
  std::string attempt;  ///< uuid
  std::string file;
  double stepSeconds = 0.0;
  recorder::RunReport report;
  std::string why;     ///< the source's word on why it failed, or empty
  bool paced = false;  ///< or live: deadlines mean something
  bool live = false;
};

/// Prints it on stdout, and on stderr what must not be missed. @returns the exit code
int tell(const FinishedRun& run, bool json);

}  // namespace calot::apps
