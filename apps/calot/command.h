// SPDX-License-Identifier: GPL-3.0-or-later
// Every command of `calot` is made with this: its options, its cohort, its result as JSON, its text on the terminal.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/report/terminal_text.h"
#include "apps/calot/environment.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"
#include "recorder/base/names.h"

namespace calot::apps {

using analytics::wrappedText;
using Json = nlohmann::ordered_json;

/// The chosen command's work, called by main(): returns the exit code or throws calot::Error.
using Run = std::function<int()>;

/// Each function adds a command with its options to the application. A new command is a file that defines its function,
/// and a line of this list.
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
  X(Course)                   \
  X(Dossier)                  \
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

/// `calot devices calibrate`, in a file of its own.
void addCalibrateDevice(CLI::App& devices, Run& run);

/// A command in the help.
struct CommandText {
  std::string name, help;
  std::string example, another = {};  ///< lines to type
};

/// Adds a command that is followed by one of those below it.
CLI::App& addGroup(CLI::App& parent, const CommandText& text);

/// Adds a command without options.
CLI::App* addBareCommand(CLI::App& parent, const CommandText& text);

/// Adds a command whose work has these options. The options live as long as the command.
/// @param run is set to the work when the command is chosen, unless a command below it was
/// @param work returns an exit code, or nothing: ExitCode::yes
template <class Result, class Options>
auto addCommand(CLI::App& parent, Run& run, const CommandText& text, Result (*work)(Options&),
                std::shared_ptr<std::remove_const_t<Options>> options = {}) {
  if (!options) options = std::make_shared<std::remove_const_t<Options>>();
  CLI::App* const command = addBareCommand(parent, text);
  command->callback([options, work, &run] {
    if (run) return;
    run = [options, work] {
      if constexpr (!std::is_void_v<Result>) return static_cast<int>(work(*options));
      work(*options);
      return static_cast<int>(ExitCode::yes);
    };
  });
  return std::pair{command, std::move(options)};
}

/// Options of a command that has but --json.
struct JsonOption {
  bool json = false;
};

/// Adds `--cohort`, as every command has that works with one database. It may be given without the option's name, too,
/// as the first word: calot study c.db. Where the command line has the option, all words are other arguments: calot
/// norm show clinic --cohort c.db.
CLI::Option* addCohortOption(CLI::App& command, std::string& database, const std::string& help = "Cohort database");

/// Looks whether a command line has `--cohort`. Before commands are added.
/// @param words the command line without the program's name
void lookForCohort(const std::vector<std::string>& words);

/// Adds --similar-names, of the table that a command reads.
CLI::Option* addSimilarNames(CLI::App& command, recorder::SimilarNames& similar);

/// For CLI::Option::check: one of these words. The fault names the nearest.
CLI::Validator oneOf(std::vector<std::string> words);

/// Adds an option that is one of these words; its value is the default.
CLI::Option* addChoice(CLI::App& command, const std::string& name, std::string& value, const std::string& help,
                       std::vector<std::string> words);

/// Adds an option for several values, "A,B".
template <class Value>
CLI::Option* addList(CLI::App& command, const std::string& name, std::vector<Value>& values, const std::string& help) {
  return command.add_option(name, values, help)->delimiter(',')->allow_extra_args(false);
}

/// Adds an option that is a number from `least` to `most`; its value is the default.
template <class Number>
CLI::Option* addNumber(CLI::App& command, const std::string& name, Number& value, const std::string& help,
                       std::type_identity_t<Number> least, std::type_identity_t<Number> most) {
  return command.add_option(name, value, help)->check(CLI::Range(least, most))->capture_default_str();
}

/// Adds `--threads` or `--jobs`: 0 to 64.
inline CLI::Option* addThreads(CLI::App& command, unsigned& count, const std::string& help,
                               const std::string& name = "--threads") {
  return addNumber(command, name, count, help, 0U, 64U);
}

/// The value of an option that the command line has, which may be empty: --group "" takes a group away.
std::optional<std::string> givenOf(const CLI::App& command, const std::string& option, const std::string& value);

/// A row of a cohort as an object.
[[nodiscard]] Json jsonOf(const analytics::Fields& fields);

/// Prints a result on stdout, over several lines, behind the head of every result: {"schema": "calot-<what>",
/// "version": N}. The version is raised when a member changes its meaning or goes; new members alone do not raise it.
/// Erases a line of progress first. @param body an object without these two members
void printResult(std::string_view what, const Json& body);

/// The same on one line, flushed: of results that come one after the other.
void printResultLine(std::string_view what, const Json& body);

/// Prints a text in order with what was printed through std::cout. Erases a line of progress first. On a terminal a
/// line that is too long goes on below, indented.
void printText(const std::string& text);

/// Prints a result as JSON, or else as a text.
void printResult(bool json, std::string_view what, const Json& body, const std::string& text);
void printResult(bool json, std::string_view what, const Json& body, const std::function<void(std::ostream&)>& write);

/// The form of the program's help and of all its commands': lines that fit the terminal. Before commands are added.
std::shared_ptr<CLI::FormatterBase> helpForm();

/// One line about the first word of a command line that is no command or option where it stands, with the nearest one;
/// else the parser's own message. Ends with the help to look at.
/// @param app after parse() threw `fault`. @param words the command line without the program's name
std::string wrongWord(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& fault);

/// Columns of the terminal on stdout, from 40 to 160; 80 without a terminal.
std::size_t terminalColumns();

/// From here on what is printed to std::cout, and by printResult(), fits the terminal on stdout, if there is one.
void fitTerminal();

}  // namespace calot::apps
