// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/common/program.h"

#include <algorithm>
#include <cerrno>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "recorder/base/remedy_words.h"

namespace calot::apps {
namespace {

/// Remedies that are an option of a command.
constexpr RemedyWords remedyOptions[] = {
    {Remedy::replaceExisting, "--force replaces what is there"},
    {Remedy::replayAnyway, "--anyway repeats it all the same, and says so"},
    {Remedy::moveFork, "move it with --at"},
    {Remedy::nameDevice, "name another with --device"},
    {Remedy::nameTools, "name them with --tools LEFT,RIGHT"},
    {Remedy::chooseKey, "choose one with --key"},
    {Remedy::mixKeys, "compare all the same with --mix-keys"},
    {Remedy::chooseAttemptRule, "declare --attempt-rule first or mean"},
    {Remedy::takeFirst, "take --attempt-rule first"},
    {Remedy::takeMean, "take --attempt-rule mean"},
    {Remedy::chooseOccasion, "choose one occasion (--occasion-column, --occasion)"},
    {Remedy::nameParticipantColumn, "name it with --participant-column"},
    {Remedy::nameGroupColumn, "name it with --group-column"},
    {Remedy::nameOccasionColumn, "name it with --occasion-column"},
    {Remedy::nameOccasion, "name it with --occasion"},
    {Remedy::nameOutcome, "name one with --outcome"},
    {Remedy::nameGroups, "name two with --groups A,B"},
    {Remedy::nameBetterGroup, "name one with --better"},
    {Remedy::nameFamily, "name rows of the study with --family"},
    {Remedy::nameCheckpoints, "name others with --checkpoints"},
    {Remedy::sayNames, "say it with --similar-names one or two"},
    {Remedy::sayDates, "say it with --dates day-first or month-first"},
    {Remedy::sayZone, "say it with --zone, Z or +01:00"},
};

/// By name: the parser orders them by address.
std::set<std::string> namesOf(const std::set<CLI::Option*>& options) {
  std::set<std::string> names;
  for (const CLI::Option* option : options) names.insert(option->get_name());
  return names;
}

nlohmann::ordered_json describeOption(const CLI::Option& option) {
  nlohmann::ordered_json names = nlohmann::ordered_json::array();
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  const bool takesValue = option.get_items_expected_max() > 0;
  return {{"names", std::move(names)},
          {"positional", option.get_positional() ? option.get_name(true) : std::string()},
          {"value", takesValue ? option.get_type_name() : std::string()},
          {"default", option.get_default_str()},
          {"many", option.get_expected_max() > 1},
          {"required", option.get_required()},
          {"needs", namesOf(option.get_needs())},
          {"excludes", namesOf(option.get_excludes())},
          {"help", option.get_description()}};
}

/// The parser keeps a group of options as a command without a name: its options are those of the command around it.
void describeOptions(const CLI::App& app, nlohmann::ordered_json& options) {
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) options.push_back(describeOption(*option));
  }
  for (const CLI::App* group : app.get_subcommands([](const CLI::App* a) { return a->get_name().empty(); })) {
    describeOptions(*group, options);
  }
}

nlohmann::ordered_json describeCommand(const CLI::App& app) {
  nlohmann::ordered_json options = nlohmann::ordered_json::array();
  describeOptions(app, options);
  nlohmann::ordered_json commands = nlohmann::ordered_json::array();
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* a) { return !a->get_name().empty(); })) {
    if (!command->get_group().empty()) commands.push_back(describeCommand(*command));
  }
  return {{"name", app.get_name()},
          {"help", app.get_description()},
          {"notes", app.get_footer()},
          {"options", std::move(options)},
          {"commands", std::move(commands)}};
}

}  // namespace

ExitCode codeOf(ErrorKind kind) {
  static_assert(static_cast<int>(ErrorKind::undecided) + 1 == static_cast<int>(ExitCode::undecided));
  return static_cast<ExitCode>(static_cast<int>(kind) + 1);  // both lists have one order
}

ExitCode codeOf(const std::optional<ErrorKind>& fault) { return fault ? codeOf(*fault) : ExitCode::yes; }

ExitCode worstOf(const std::vector<ExitCode>& codes) {
  for (const ExitCode code : {ExitCode::failure, ExitCode::damaged, ExitCode::no, ExitCode::undecided}) {
    if (std::find(codes.begin(), codes.end(), code) != codes.end()) return code;
  }
  return ExitCode::yes;
}

int endWith(ExitCode code, const std::string& program, const std::string& message) {
  std::cerr << program << ": " << message << '\n';
  return static_cast<int>(code);
}

namespace {

constexpr const char* noMemory = "not enough memory";

/// Memory may end in a thread, or where nothing may throw.
[[noreturn]] void endUncaught() {
  try {
    if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, noMemory);
    std::_Exit(static_cast<int>(ExitCode::failure));
  } catch (...) {  // a fault of the program
  }
  std::abort();
}

}  // namespace

int runProgram(const std::string& program, const std::function<int()>& body) {
  std::set_terminate(endUncaught);
  try {
    return body();
  } catch (const Error& e) {
    return endWith(codeOf(e.kind()), program, messageOf(e));
  } catch (const std::bad_alloc&) {
    return endWith(ExitCode::failure, program, noMemory);
  } catch (const std::system_error& e) {
    const bool thread = e.code() == std::errc::resource_unavailable_try_again;
    return endWith(ExitCode::failure, program, thread ? noMemory : e.what());
  } catch (const std::exception& e) {
    return endWith(ExitCode::failure, program, e.what());
  }
}

int runProgram(CLI::App& app, int argc, char** argv, const std::function<int()>& body,
               const std::function<std::string(const CLI::ParseError&)>& describe) {
  app.add_flag_callback(
      "--help-json",
      [&app] {
        std::cout << describeCommand(app).dump(2) << '\n';
        throw CLI::Success();
      },
      "Print all commands and options as JSON and exit");
  return runProgram(app.get_name(), [&] {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
      return endWith(ExitCode::usage, app.get_name(), describe ? describe(e) : std::string(e.what()) + "; try --help");
    }
    return body();
  });
}

std::string advice(const std::vector<Remedy>& remedies) { return adviceText(remedies, remedyOptions); }

std::string advised(const std::string& message, const std::vector<Remedy>& remedies) {
  return remedies.empty() ? message : message + "; " + advice(remedies);
}

std::string messageOf(const Error& error) { return advised(error.what(), error.remedies()); }

}  // namespace calot::apps
