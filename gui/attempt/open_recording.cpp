// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/open_recording.h"

#include <fmt/format.h>

#include "recorder/base/errors.h"
#include "recorder/kept/engine_folders.h"
#include "sim/scene/version.h"

namespace calot::gui {

namespace fs = std::filesystem;

fs::path findRecording(const analytics::AttemptRow& attempt, const fs::path& database,
                       const std::vector<fs::path>& folders) {
  // The name comes from a database that anyone may have made: it names a file, never a folder.
  const fs::path name = fs::path(attempt.fileName).filename();
  if (name.empty() || name.extension() != ".h5") return {};
  std::vector<fs::path> places{database.parent_path()};
  places.insert(places.end(), folders.begin(), folders.end());
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::is_regular_file(place / name, ignored)) return place / name;
  }
  return {};
}

recorder::Recording openRecording(const fs::path& file, const std::string& attempt) {
  const recorder::ChainVerdict chain = recorder::probe(file);
  recorder::Recording recording(file);
  const std::string name = file.filename().string();
  const std::string& found = recording.header().attempt;
  if (!attempt.empty() && found != attempt)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("is the recording of attempt {}, not of {}", found, attempt));
  if (!chain.intact)
    throw Error(ErrorKind::refused, Where{name}, fmt::format("its content chain is broken ({})", chain.what));
  if (recording.stepCount() == 0) throw Error(ErrorKind::damaged, Where{name}, "holds no step to show");
  const std::uint32_t version = recording.header().simulationVersion;
  if (version != simulationVersion && recorder::commandOfEngine(version).empty())
    throw Error(ErrorKind::undecided, Where{name},
                fmt::format("was made by simulation version {}; this program has version {}, and no engine of version "
                            "{} is installed to repeat it",
                            version, simulationVersion, version));
  return recording;
}

}  // namespace calot::gui
