// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_names.h"

#include <algorithm>

namespace calot::recorder {

std::string readName(const JsonObject& object, const std::string& key) {
  std::string name;
  object.read(key, name, maxSceneName);
  const bool plain = std::all_of(name.begin(), name.end(),
                                 [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
  if (!plain || name.front() == '-')
    object.at(key).fail("small letters, digits and hyphens are allowed, the first no hyphen");
  return name;
}

std::string readAssetName(const JsonObject& object, const std::string& key) {
  std::string name;
  object.read(key, name, 200);
  bool inside = name.front() != '/' && name.find('\\') == std::string::npos && name.find(':') == std::string::npos;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    inside = inside && !part.empty() && part != "." && part != "..";
    begin = end + 1;
  }
  if (!inside) object.at(key).fail("a path relative to the assets folder is wanted, with / and without . or ..");
  return name;
}

}  // namespace calot::recorder
