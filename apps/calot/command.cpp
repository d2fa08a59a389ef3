// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/command.h"

#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

/// The parser fills positional arguments in order and cannot know that a later option makes one of them unnecessary.
bool hasCohortOption = false;

}  // namespace

void lookForCohort(const std::vector<std::string>& words) {
  hasCohortOption = std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word == "--cohort" || word.starts_with("--cohort=");
  });
}

CLI::App* addBareCommand(CLI::App& parent, const CommandText& text) {
  const std::string examples =
      text.another.empty() ? ":\n  " + text.example : "s:\n  " + text.example + "\n  " + text.another;
  return parent.add_subcommand(text.name, text.help)->footer("Example" + examples);
}

CLI::App& addGroup(CLI::App& parent, const CommandText& text) {
  return *addBareCommand(parent, text)->require_subcommand(1);
}

CLI::Option* addCohortOption(CLI::App& command, std::string& database, const std::string& help) {
  return command.add_option(hasCohortOption ? "--cohort" : "cohort,--cohort", database, help);
}

namespace {

void writeOut(const std::string& text) {
  Progress::erase();
  // In order with what was printed through the other of the two streams.
  std::cout << std::flush;
  fmt::print("{}", text);
  if (std::fflush(stdout) != 0) throw Error(ErrorKind::failure, "standard output cannot be written");
}

/// @param indent blanks a level; -1: all on one line
void printJson(std::string_view what, const Json& body, int indent) {
  constexpr int version = 1;  // a command whose members change gets its own here
  Json result{{"schema", fmt::format("calot-{}", what)}, {"version", version}};
  result.update(body);
  writeOut(result.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace

void printText(const std::string& text) {
  const std::size_t columns = columnsOfTerminal(STDOUT_FILENO);
  if (columns == 0) return writeOut(text);
  std::string fitted;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size()) + 2;
    fitted += (analytics::columnsOf(line) <= columns ? line : wrappedText(line, columns, indent)) + '\n';
  }
  if (!text.ends_with('\n') && !fitted.empty()) fitted.pop_back();
  writeOut(fitted);
}

void printResult(std::string_view what, const Json& body) { printJson(what, body, 2); }

void printResultLine(std::string_view what, const Json& body) { printJson(what, body, -1); }

void printResult(bool json, std::string_view what, const Json& body, const std::string& text) {
  json ? printResult(what, body) : printText(text);
}

void printResult(bool json, std::string_view what, const Json& body, const std::function<void(std::ostream&)>& write) {
  std::ostringstream text;
  text.copyfmt(std::cout);  // with the terminal's columns
  if (!json) write(text);
  printResult(json, what, body, text.str());
}

Json jsonOf(const analytics::Fields& fields) {
  Json object;
  for (const auto& [name, value] : fields) {
    Json& member = object[name];
    std::visit(
        [&](const auto& v) {
          if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(v)>, std::monostate>) member = v;
        },
        value);
  }
  return object;
}

CLI::Validator oneOf(std::vector<std::string> words) {
  const std::string description = fmt::format("{{{}}}", fmt::join(words, ","));
  return {[words = std::move(words)](std::string& word) {
            if (std::find(words.begin(), words.end(), word) != words.end()) return std::string();
            return fmt::format("\"{}\" is not one of {}{}", recorder::shown(word), fmt::join(words, ", "),
                               recorder::didYouMean(word, words));
          },
          description};
}

CLI::Option* addChoice(CLI::App& command, const std::string& name, std::string& value, const std::string& help,
                       std::vector<std::string> words) {
  return command.add_option(name, value, help)->check(oneOf(std::move(words)))->capture_default_str();
}

CLI::Option* addSimilarNames(CLI::App& command, recorder::SimilarNames& similar) {
  using recorder::SimilarNames;
  return command
      .add_option_function<std::string>(
          "--similar-names",
          [&similar](const std::string& word) { similar = word == "one" ? SimilarNames::one : SimilarNames::two; },
          "What names of the table are that differ in capitals or leading zeros alone (P1 and p1, 001 and 1): one, or "
          "two (default: they are refused)")
      ->check(oneOf({"one", "two"}));
}

std::optional<std::string> givenOf(const CLI::App& command, const std::string& option, const std::string& value) {
  return command.count(option) > 0 ? std::optional(value) : std::nullopt;
}

std::size_t terminalColumns() {
  constexpr std::size_t withoutTerminal = 80;
  const std::size_t columns = columnsOfTerminal(STDOUT_FILENO);
  return columns == 0 ? withoutTerminal : std::clamp<std::size_t>(columns, 40, 160);
}

void fitTerminal() { analytics::setTerminalColumns(std::cout, columnsOfTerminal(STDOUT_FILENO)); }

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
