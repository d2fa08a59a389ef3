// SPDX-License-Identifier: GPL-3.0-or-later
// calot participant key: who is behind a pseudonym.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>

#include "analytics/cohort/key_file.h"
#include "apps/calot/passphrase.h"
#include "apps/calot/withdraw_command.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

struct KeyOptions {
  std::string file, passphraseFile, pseudonym, name;
};

CLI::App* addOne(CLI::App& parent, const char* word, const char* help, const std::shared_ptr<KeyOptions>& o) {
  CLI::App* command = parent.add_subcommand(word, help);
  command->add_option("--file", o->file, "Key file")->required();
  command->add_option("--passphrase-file", o->passphraseFile, "File whose first line is the passphrase");
  return command;
}

/// Not a command's argument, where shells keep it: read from stdin unless it was given.
std::string nameOf(const KeyOptions& o) {
  if (!o.name.empty()) return o.name;
  std::string line;
  std::getline(std::cin, line);
  if (line.empty()) throw Error(ErrorKind::invalid, "key add: the name is wanted on stdin, or as --name");
  return line;
}

Error noFile(const std::string& file) { return {ErrorKind::damaged, Where{file}, "no such key file"}; }

}  // namespace

void addKey(CLI::App& participant, Run& run) {
  CLI::App* key = participant.add_subcommand("key", "Who is behind a pseudonym, in an encrypted file of its own");
  key->require_subcommand(1);

  const auto added = std::make_shared<KeyOptions>();
  CLI::App* add = addOne(*key, "add", "Add a pseudonym and the name behind it; makes the file if there is none", added);
  add->add_option("participant", added->pseudonym, "Pseudonym")->required();
  add->add_option("--name", added->name, "Name; without it, a line of stdin");
  add->callback([added, &run] {
    run = [added] {
      const std::string passphrase = readPassphrase(added->passphraseFile);
      analytics::KeyFile file(added->file, passphrase);
      file.add(added->pseudonym, nameOf(*added));
      std::cout << fmt::format("{}: {} added\n", added->file, added->pseudonym);
      return static_cast<int>(ExitCode::yes);
    };
  });

  const auto shown = std::make_shared<KeyOptions>();
  CLI::App* show = addOne(*key, "show", "Print the name behind a pseudonym, or all", shown);
  show->add_option("participant", shown->pseudonym, "Pseudonym");
  show->callback([shown, &run] {
    run = [shown] {
      if (!std::filesystem::exists(shown->file)) throw noFile(shown->file);
      const analytics::KeyFile file(shown->file, readPassphrase(shown->passphraseFile));
      if (!shown->pseudonym.empty() && file.names().count(shown->pseudonym) == 0)
        throw Error(ErrorKind::refused, fmt::format("{}: no entry \"{}\"", shown->file, shown->pseudonym));
      for (const auto& [pseudonym, name] : file.names()) {
        if (shown->pseudonym.empty() || shown->pseudonym == pseudonym) std::cout << pseudonym << '\t' << name << '\n';
      }
      return static_cast<int>(ExitCode::yes);
    };
  });

  const auto removed = std::make_shared<KeyOptions>();
  CLI::App* remove = addOne(*key, "remove", "Remove a pseudonym's entry", removed);
  remove->add_option("participant", removed->pseudonym, "Pseudonym")->required();
  remove->callback([removed, &run] {
    run = [removed] {
      if (!std::filesystem::exists(removed->file)) throw noFile(removed->file);
      analytics::KeyFile file(removed->file, readPassphrase(removed->passphraseFile));
      if (!file.remove(removed->pseudonym))
        throw Error(ErrorKind::refused, fmt::format("{}: no entry \"{}\"", removed->file, removed->pseudonym));
      std::cout << fmt::format("{}: {} removed\n", removed->file, removed->pseudonym);
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
