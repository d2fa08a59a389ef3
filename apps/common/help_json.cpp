// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/common/help_json.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

namespace calot::apps {

namespace {

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

void addHelpJson(CLI::App& app) {
  app.add_flag_callback(
      "--help-json",
      [&app] {
        std::cout << describeCommand(app).dump(2) << '\n';
        throw CLI::Success();
      },
      "Print all commands and options as JSON and exit");
}

}  // namespace calot::apps
