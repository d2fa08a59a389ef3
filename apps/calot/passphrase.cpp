// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/passphrase.h"

#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "recorder/base/errors.h"
#include "recorder/base/secret_file.h"

namespace calot::apps {

std::string readPassphrase(const std::string& file) {
  std::string line;
  if (!file.empty()) {
    line = recorder::readSecret(file, 4096);
    line.resize(std::min(line.find_first_of("\r\n"), line.size()));
  } else if (const char* set = std::getenv("CALOT_KEY_PASSPHRASE"); set != nullptr) {
    line = set;
  } else if (::isatty(STDIN_FILENO) != 0) {
    fmt::print(stderr, "passphrase of the key file: ");
    termios before{};
    ::tcgetattr(STDIN_FILENO, &before);
    termios quiet = before;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &quiet);
    std::getline(std::cin, line);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
    fmt::print(stderr, "\n");
  }
  if (line.empty()) {
    throw Error(ErrorKind::invalid,
                "the key file's passphrase is wanted: --passphrase-file F, CALOT_KEY_PASSPHRASE, or a terminal");
  }
  return line;
}

}  // namespace calot::apps
