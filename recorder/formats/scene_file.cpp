// SPDX-License-Identifier: GPL-3.0-or-later
// Search for scenes in folders: the part of scene_file.h that reads folders rather than files.

#include "recorder/formats/scene_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/nearest_word.h"

namespace calot::recorder {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t maxMesh = std::size_t{256} << 20U;

}  // namespace

LoadedScene loadScene(const fs::path& sceneFile) {
  const fs::path folder = sceneFile.has_parent_path() ? sceneFile.parent_path() : fs::path(".");
  const bool inScenes = folder.filename() == "scenes";
  const fs::path root = inScenes ? folder / ".." : folder;
  const std::string base = sceneFile.filename().string();
  std::vector<Asset> assets;
  assets.reserve(maxStructures + 1);  // references to the elements stay good
  assets.push_back({inScenes ? "scenes/" + base : base, {}});
  assets[0].bytes = readFileBytes(sceneFile, assets[0].name, maxMesh);

  const FetchAsset fetch = [&](const std::string& name, const JsonPlace& place) -> const Asset& {
    const auto known = std::find_if(assets.begin() + 1, assets.end(), [&](const Asset& a) { return a.name == name; });
    if (known != assets.end()) return *known;
    std::error_code ignored;
    const fs::path path = root / name;
    if (!fs::is_regular_file(path, ignored)) place.fail("there is no file \"" + name + "\" in the assets folder");
    // A link may lead out of the folder, whatever its name says.
    const fs::path home = fs::weakly_canonical(root, ignored);
    const fs::path real = fs::weakly_canonical(path, ignored);
    if (std::mismatch(home.begin(), home.end(), real.begin(), real.end()).first != home.end()) {
      place.fail("\"" + name + "\" leads out of the assets folder");
    }
    assets.push_back({name, readFileBytes(path, name, maxMesh)});
    return assets.back();
  };
  LoadedScene loaded = parseScene(assets[0], fetch);
  loaded.assets = std::move(assets);
  return loaded;
}

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
