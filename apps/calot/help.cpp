// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>

#include "apps/calot/command.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

/// The manual's first page on this machine, or nothing.
std::string manual() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  for (const fs::path& folder : assetFolders()) {
    const fs::path assets = fs::weakly_canonical(folder, ignored);  // of a build tree it is a link
    for (const fs::path& page :
         {assets / "../doc/calot-doc/html/index.html", assets.parent_path() / "docs" / "index.md"}) {
      if (fs::exists(page, ignored)) return fs::weakly_canonical(page, ignored).string();
    }
  }
  return {};
}

/// Descriptions of options and commands in lines that fit.
class FittingFormatter final : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override { return fitting(option->get_description()); }

  std::string make_subcommand(const CLI::App* command) const override {
    std::stringstream out;
    CLI::detail::format_help(out, command->get_display_name(true), fitting(command->get_description()),
                             get_column_width());
    return out.str();
  }

  /// The manual's place on this machine: for people here, not for --help-json, whose pages are read elsewhere.
  std::string make_footer(const CLI::App* command) const override {
    std::string footer = CLI::Formatter::make_footer(command);
    if (command->get_parent() != nullptr) return footer;
    if (const std::string page = manual(); !page.empty()) footer += "The manual: " + page + "\n";
    return footer;
  }

 private:
  [[nodiscard]] std::string fitting(const std::string& description) const {
    return wrappedText(description, terminalColumns() - get_column_width());
  }
};

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
  return !command.get_options([](const CLI::Option* each) { return each->get_positional(); }).empty();
}

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CLI::App* each : commands) names.push_back(each->get_name());
  return names;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> helpForm() { return std::make_shared<FittingFormatter>(); }

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
      const std::vector<std::string> known = namesOf(commands);
      const bool top = at == &app;
      what = fmt::format("there is no command '{}{}'{}{}", top ? "" : name.substr(app.get_name().size() + 1) + " ",
                         recorder::shown(word), recorder::didYouMean(word, known),
                         top ? "" : fmt::format("; there are {}", fmt::join(known, ", ")));
      break;
    }
  }
  if (what.empty()) {
    what = fault.what();
    if (const std::vector<const CLI::App*> commands = subcommandsOf(*at);
        at != &app && !commands.empty() && fault.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError) &&
        at->get_subcommands().empty() && at->get_require_subcommand_min() > 0) {
      what = fmt::format("{} is followed by one of {}", name, fmt::join(namesOf(commands), ", "));
    }
  }
  return fmt::format("{} (try: {} --help)", what, name);
}

}  // namespace calot::apps
