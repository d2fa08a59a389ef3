// SPDX-License-Identifier: GPL-3.0-or-later
// Search for scenes in folders: the part of scene_file.h that reads folders rather than files.
#include <fmt/format.h>

#include <map>

#include "recorder/base/errors.h"
#include "recorder/base/nearest_word.h"
#include "recorder/formats/scene_file.h"

namespace calot::recorder {
namespace fs = std::filesystem;

std::vector<fs::path> listScenes(const std::vector<fs::path>& roots) {
  std::map<std::string, fs::path> byName;
  for (const fs::path& root : roots) {
    std::error_code fault;
    for (fs::directory_iterator it(root / "scenes", fault), end; !fault && it != end; it.increment(fault)) {
      if (it->path().extension() == ".json") byName.emplace(it->path().stem().string(), it->path());
    }
  }
  std::vector<fs::path> files;
  files.reserve(byName.size());
  for (const auto& entry : byName) files.push_back(entry.second);
  return files;
}

fs::path findScene(const std::string& name, const std::vector<fs::path>& roots) {
  std::error_code ignored;
  if (name.size() > 5 && name.substr(name.size() - 5) == ".json") {
    if (fs::is_regular_file(name, ignored)) return name;
    throw Error(ErrorKind::invalid, Where{name}, "there is no such scene file");
  }
  std::string known;
  std::vector<std::string> names;
  for (const fs::path& file : listScenes(roots)) {
    if (file.stem() == name) return file;
    names.push_back(file.stem().string());
    known += (known.empty() ? "" : ", ") + names.back();
  }
  throw Error(
      ErrorKind::invalid,
      fmt::format("there is no scene \"{}\"{}; {}", name, didYouMean(name, names),
                  known.empty() ? std::string("no assets folder was found (set CALOT_ASSETS)") : "there are " + known));
}

}  // namespace calot::recorder
