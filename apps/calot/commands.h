// SPDX-License-Identifier: GPL-3.0-or-later
// Commands of `calot`: each adds its subcommand with its options to the application and, when chosen, sets `run` to
// what main() shall call; `run` returns the exit code or throws calot::Error. A new command is a file that defines its
// function, with an example in the footer or in help.cpp, and a line of this list.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace calot::apps {

using Run = std::function<int()>;

// In the order of `calot --help`.
#define CALOT_COMMAND_LIST(X) \
  X(Record)                   \
  X(Replay)                   \
  X(Engine)                   \
  X(Branch)                   \
  X(Inspect)                  \
  X(Recover)                  \
  X(Export)                   \
  X(State)                    \
  X(Diff)                     \
  X(Import)                   \
  X(Assess)                   \
  X(Verify)                   \
  X(Study)                    \
  X(Protocol)                 \
  X(Power)                    \
  X(Rate)                     \
  X(Norm)                     \
  X(Grade)                    \
  X(Participant)              \
  X(Attempt)                  \
  X(Regrade)                  \
  X(Cohort)                   \
  X(Station)                  \
  X(Render)                   \
  X(Mesh)                     \
  X(Scenes)                   \
  X(Scene)                    \
  X(Checkpoints)              \
  X(Devices)                  \
  X(Golden)                   \
  X(Cache)

#define CALOT_DECLARE_COMMAND(name) void add##name(CLI::App& app, Run& run);
CALOT_COMMAND_LIST(CALOT_DECLARE_COMMAND)
#undef CALOT_DECLARE_COMMAND

}  // namespace calot::apps
