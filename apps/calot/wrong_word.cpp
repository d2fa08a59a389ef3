// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/wrong_word.h"

#include <fmt/format.h>

#include <algorithm>

#include "recorder/base/nearest_word.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

std::vector<const CLI::App*> subcommandsOf(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); });
}

/// Long options of a command with their dashes; the parser keeps groups of options as commands without names.
void addLongOptions(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* group : command.get_subcommands([](const CLI::App* each) { return each->get_name().empty(); }))
    addLongOptions(*group, names);
}

bool takesWords(const CLI::App& command) {
  const std::vector<const CLI::Option*> options = command.get_options();
  return std::any_of(options.begin(), options.end(), [](const CLI::Option* each) { return each->get_positional(); });
}

std::string namesText(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

}  // namespace

CLI::Validator oneOf(std::vector<std::string> words) {
  const std::string description = fmt::format("{{{}}}", fmt::join(words, ","));
  return {[words = std::move(words)](std::string& word) {
            if (std::find(words.begin(), words.end(), word) != words.end()) return std::string();
            return fmt::format("\"{}\" is none of {}{}", recorder::shown(word), namesText(words),
                               recorder::didYouMean(word, words));
          },
          description};
}

std::string wrongWord(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& fault) {
  const CLI::App* at = &app;
  std::string name = app.get_name();
  std::string what;
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word.starts_with("--")) {
      const std::string option = word.substr(0, word.find('='));
      std::vector<std::string> known;
      addLongOptions(*at, known);
      if (std::find(known.begin(), known.end(), option) != known.end()) continue;
      what = fmt::format("{} has no option '{}'{}", name, recorder::shown(option), recorder::didYouMean(option, known));
      break;
    }
    const std::vector<const CLI::App*> commands = subcommandsOf(*at);
    if (word.starts_with('-') || commands.empty()) continue;
    const auto chosen =
        std::find_if(commands.begin(), commands.end(), [&](const CLI::App* c) { return c->get_name() == word; });
    if (chosen != commands.end()) {
      at = *chosen;
      name += " " + word;
    } else if (!takesWords(*at)) {
      std::vector<std::string> known;
      for (const CLI::App* each : commands) known.push_back(each->get_name());
      const bool top = at == &app;
      what = fmt::format("there is no command '{}{}'{}{}", top ? "" : name.substr(app.get_name().size() + 1) + " ",
                         recorder::shown(word), recorder::didYouMean(word, known),
                         top ? "" : "; there are " + namesText(known));
      break;
    }
  }
  if (what.empty()) {
    what = fault.what();
    if (const std::vector<const CLI::App*> commands = subcommandsOf(*at);
        at != &app && !commands.empty() && fault.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError) &&
        at->get_subcommands().empty() && at->get_require_subcommand_min() > 0) {
      std::vector<std::string> known;
      for (const CLI::App* each : commands) known.push_back(each->get_name());
      what = fmt::format("{} is followed by one of {}", name, namesText(known));
    }
  }
  return fmt::format("{} (try: {} --help)", what, name);
}

}  // namespace calot::apps
