// SPDX-License-Identifier: GPL-3.0-or-later
// The frame of every program: its command line, its options as data, and an error at its end: exit code, line on
// stderr, advice (commands and options).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace calot::apps {

/// Exit codes of every program (docs/reference/command-line.md).
enum class ExitCode : int {
  yes = 0,
  failure = 1,    ///< something inside went wrong (disk full, no memory)
  usage = 2,      ///< wrong use of the command line
  no = 3,         ///< the answer is no: diverged, invalid, falls short
  damaged = 4,    ///< damaged or unreadable input
  undecided = 5,  ///< this build cannot decide: another simulation version
};

ExitCode codeOf(ErrorKind kind);

/// @param fault of one input; none: yes
ExitCode codeOf(const std::optional<ErrorKind>& fault);

/// Over many inputs: the first present of 1, 4, 3, 5, 0.
ExitCode worstOf(const std::vector<ExitCode>& codes);

/// One line on stderr, "calot: message". @return the code, for main()
int endWith(ExitCode code, const std::string& program, const std::string& message);

/// Body of main(): runs the body; an error that it throws is a line on stderr and an exit code.
int runProgram(const std::string& program, const std::function<int()>& body);

/// The same after the command line was parsed; a wrong one is an error, too. Adds `--help-json` behind all options and
/// commands, which prints them as JSON: manual pages and the completion of shells are made of it (scripts/manual.py),
/// so that they have what the help has. @param describe the line for a wrong command line; null: the parser's own
int runProgram(CLI::App& app, int argc, char** argv, const std::function<int()>& body,
               const std::function<std::string(const CLI::ParseError&)>& describe = {});

/// "do this, or that".
std::string advice(const std::vector<Remedy>& remedies);

/// "message; do this, or that". @param message one line; without remedies it stays as it is
std::string advised(const std::string& message, const std::vector<Remedy>& remedies);

/// An error's message with its advice.
std::string messageOf(const Error& error);

}  // namespace calot::apps
