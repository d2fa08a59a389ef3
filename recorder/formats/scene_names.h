// SPDX-License-Identifier: GPL-3.0-or-later
// Names and words in a scene file. Internal to this folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "recorder/base/json_reader.h"
#include "recorder/base/nearest_word.h"

namespace calot::recorder {

inline constexpr std::size_t maxSceneName = 64;

/// A name that goes into field names, columns and file names: small letters, digits and hyphens.
/// @throws Error damaged, naming the place.
std::string readName(const JsonObject& object, const std::string& key);

/// A path inside the assets root, with '/' and without '.' or '..', the same on every system. @throws Error damaged.
std::string readAssetName(const JsonObject& object, const std::string& key);

/// One of the words that are known. @throws Error damaged, listing them.
template <class Value>
Value readWord(const JsonObject& object, const std::string& key, const std::map<std::string, Value>& words) {
  const std::string word = object.at(key).text(maxSceneName);
  if (const auto found = words.find(word); found != words.end()) return found->second;
  std::string known;
  std::vector<std::string> names;
  for (const auto& entry : words) {
    known += (known.empty() ? "" : ", ") + entry.first;
    names.push_back(entry.first);
  }
  object.at(key).fail("unknown word" + didYouMean(word, names) + "; known are " + known);
}

}  // namespace calot::recorder
