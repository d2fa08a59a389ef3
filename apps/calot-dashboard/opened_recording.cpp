// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot-dashboard/opened_recording.h"

#include <array>
#include <fstream>
#include <QStandardPaths>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {

namespace fs = std::filesystem;

std::optional<OpenedRecording> openedRecording(const fs::path& file) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> head{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(head.data(), head.size()) || head != signature) return std::nullopt;
  static_cast<void>(recorder::probe(file));
  std::error_code ignored;
  return OpenedRecording{fs::absolute(file, ignored), recorder::Recording(file).header().attempt};
}

fs::path openedCohort() {
  const fs::path folder =
      fs::path(QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation).toStdString()) / "calot";
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) throw Error(ErrorKind::failure, Where{folder.string()}, "the folder cannot be made: " + fault.message());
  return folder / "opened.db";
}

}  // namespace calot::apps
