// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/help.h"

#include <algorithm>

#include "apps/calot/command.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

struct Example {
  std::string_view command;
  std::string_view line;
};

/// By the words of a command; a command has one or more. A test runs over all commands and asks for one.
constexpr Example examples[] = {
    {"record", "calot record --scene touch-liver --performer skilled --seed 7 -o attempt.h5"},
    {"record", "calot record --scene cholecystectomy --device gamepad --participant P1 -o attempt.h5"},
    {"replay", "calot replay attempt.h5"},
    {"replay", "calot replay recordings/*.h5 --jobs 0 --junit result.xml"},
    {"engine", "calot engine list"},
    {"engine list", "calot engine list --json"},
    {"engine check", "calot engine check 12"},
    {"engine build", "calot engine build 12 -o calot-engine-12"},
    {"engine transcript", "calot engine transcript attempt.h5 --engine calot-engine-12 -o transcript.txt"},
    {"branch", "calot branch attempt.h5 --at 1:02.5 --performer skilled -o branch.h5"},
    {"inspect", "calot inspect attempt.h5"},
    {"recover", "calot recover killed.h5 -o recovered.h5"},
    {"export", "calot export attempt.h5 --csv tables"},
    {"export", "calot export attempt.h5 --motion motion"},
    {"state", "calot state attempt.h5 --step 100 -o step100.h5"},
    {"diff", "calot diff step100.h5 other.h5"},
    {"import", "calot import knots.txt --task knot-tying --participant P1 --mode assessment --cohort c.db"},
    {"import", "calot import --manifest table.csv --mode assessment --cohort c.db"},
    {"assess", "calot assess attempt.h5 --cohort c.db"},
    {"assess", "calot assess recordings --cohort c.db --metric my.py"},
    {"verify", "calot verify --watch incoming --cohort c.db"},
    {"study", "calot study c.db --attempt-rule mean"},
    {"study", "calot study --table f.csv --participant-column person --group-column level --outcome seconds:lower"},
    {"protocol", "calot protocol list"},
    {"protocol check", "calot protocol check my-protocol.json"},
    {"protocol register", "calot protocol register my-protocol.json c.db --by \"A. Instructor\""},
    {"protocol lock", "calot protocol lock my-protocol.json c.db --by \"A. Analyst\""},
    {"protocol list", "calot protocol list c.db"},
    {"power", "calot power --effect 1.2 --n 8:20:4"},
    {"power", "calot power pilot.db --n 10:40:10"},
    {"rate", "calot rate --forms"},
    {"rate", "calot rate c.db --form osats --attempt 3f2a --rater R1 --answers osats.json"},
    {"rate pack", "calot rate pack c.db --form goals --films films --raters R1,R2 -o pack"},
    {"norm", "calot norm list c.db"},
    {"norm create", "calot norm create c.db clinic --by \"A. Instructor\" --rule at-least:6 --attempt-rule first"},
    {"norm list", "calot norm list c.db"},
    {"norm show", "calot norm show c.db clinic"},
    {"norm evidence",
     "calot norm evidence c.db clinic --file report.pdf --statement \"validated 2026\" --by \"A. Instructor\""},
    {"norm angoff", "calot norm angoff judges.csv"},
    {"grade", "calot grade c.db --attempt 3f2a --html sheet.html"},
    {"participant", "calot participant add P1 --cohort c.db --group novice"},
    {"participant withdraw", "calot participant withdraw P1 --cohort c.db --scope all --recordings recordings"},
    {"participant add", "calot participant add P1 --cohort c.db --group novice --consent study:2026-01-31"},
    {"participant set", "calot participant set P1 --cohort c.db --experience laparoscopies=240"},
    {"attempt list", "calot attempt list --cohort c.db"},
    {"participant list", "calot participant list --cohort c.db --group novice"},
    {"attempt", "calot attempt exclude 3f2a --cohort c.db --reason \"camera failed\" --by \"A. Instructor\""},
    {"attempt exclude", "calot attempt exclude 3f2a --cohort c.db --reason \"camera failed\" --by \"A. Instructor\""},
    {"attempt include", "calot attempt include 3f2a --cohort c.db --reason \"film found\" --by \"A. Instructor\""},
    {"attempt tag", "calot attempt tag 3f2a add teaching --cohort c.db --by \"A. Instructor\""},
    {"regrade", "calot regrade c.db recordings"},
    {"cohort", "calot cohort list c.db"},
    {"cohort merge", "calot cohort merge all.db site2.db"},
    {"cohort check", "calot cohort check c.db"},
    {"cohort upgrade", "calot cohort upgrade c.db"},
    {"cohort scrub", "calot cohort scrub c.db"},
    {"cohort list", "calot cohort list c.db"},
    {"cohort site", "calot cohort site north --cohort c.db"},
    {"cohort arm", "calot cohort arm simulator-first --cohort c.db"},
    {"cohort station", "calot cohort station trainer-1 --cohort c.db --site north"},
    {"cohort name", "calot cohort name second-years --cohort c.db --add P1 --add P2"},
    {"cohort export", "calot cohort export c.db -o tables"},
    {"cohort bundle", "calot cohort bundle c.db -o bundle"},
    {"station", "calot station init trainer-1 -o station.json"},
    {"station init", "calot station init trainer-1 -o station.json"},
    {"station show", "calot station show station.json"},
    {"render", "calot render attempt.h5 --at 12.5 -o moment.png"},
    {"render", "calot render attempt.h5 --from 10 --to 20 --overlay time,phase -o film.mp4"},
    {"mesh", "calot mesh liver.stl --unit mm --tetrahedra 1500 -o liver.vtk"},
    {"mesh", "calot mesh liver.stl --unit mm --repair --surface-output organs/liver.obj --surface-triangles 6000"},
    {"scenes", "calot scenes"},
    {"scene", "calot scene check my/scenes/press.json"},
    {"scene check", "calot scene check my/scenes/press.json"},
    {"scene template", "calot scene template liver.stl --unit mm -o my/scenes/press.json"},
    {"checkpoints", "calot checkpoints --json"},
    {"devices", "calot devices"},
    {"devices calibrate", "calot devices calibrate gamepad -o gamepad.json"},
    {"devices calibrate", "calot devices calibrate camera:0 -o camera.json --pictures ."},
    {"devices print", "calot devices print -o handles.pdf"},
    {"devices serve", "calot devices serve --kinematics motion.txt --port 18944"},
    {"devices simulate", "calot devices simulate --hands both --delay 2"},
    {"golden", "calot golden check"},
    {"golden check", "calot golden check --junit golden.xml"},
    {"golden check", "calot golden check --folder my-golden"},
    {"golden update", "calot golden update --reason \"contact solver: other tolerance\""},
    {"golden values", "calot golden values --reason \"new checkpoint\""},
    {"cache", "calot cache --clean"},
};

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
  explicit FittingFormatter(std::size_t columns) : columns_(columns) {}

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
    return wrappedText(description, columns_ - get_column_width());
  }

  std::size_t columns_;
};

std::string examplesOf(const std::string& command) {
  std::string text;
  for (const Example& each : examples) {
    if (each.command == command) text += fmt::format("\n  {}", each.line);
  }
  return text.empty() ? text : (text.find('\n', 1) == std::string::npos ? "Example:" : "Examples:") + text;
}

void formatCommand(CLI::App& command, const std::string& words, const std::shared_ptr<CLI::FormatterBase>& formatter) {
  command.formatter(formatter);
  std::string footer = command.get_footer();
  if (const std::string those = examplesOf(words); !those.empty()) footer += (footer.empty() ? "" : "\n\n") + those;
  command.footer(footer);
  for (CLI::App* each : command.get_subcommands({})) {
    if (each->get_name().empty()) {
      each->formatter(formatter);  // a group of options
    } else {
      formatCommand(*each, words.empty() ? each->get_name() : words + " " + each->get_name(), formatter);
    }
  }
}

}  // namespace

void formatHelp(CLI::App& app) {
  formatCommand(app, "", std::make_shared<FittingFormatter>(terminalColumns()));
  app.footer("calot COMMAND --help has the options of each command, and an example.");
}

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

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* each : commands) names.push_back(each->get_name());
  return names;
}

}  // namespace

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
