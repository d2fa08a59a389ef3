// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "analytics/interchange/original_names.h"

namespace calot::analytics {

/// New names by the old ones. Random names are drawn once each; numbers are given in the order of first use.
class NewNames {
 public:
  /// @param originals none of which is given; must outlive this
  explicit NewNames(const OriginalNames& originals) : originals_(originals) {}

  /// "P" and nine letters from the system's source of randomness; of an empty name an empty one.
  std::string random(const char* kind, const std::string& old);
  /// "key 1", "key 2", ...
  std::string numbered(const char* kind, const std::string& old);

 private:
  template <class Draw>
  std::string named(const char* kind, const std::string& old, Draw draw) {
    if (old.empty()) return {};
    const auto known = given_.find({kind, old});
    if (known != given_.end()) return known->second;
    std::string name = draw();
    while (originals_.has(name) || !taken_.insert(name).second) name = draw();
    return given_[{kind, old}] = name;
  }

  const OriginalNames& originals_;
  std::map<std::pair<std::string, std::string>, std::string> given_;
  std::map<std::string, int> last_;
  std::set<std::string> taken_;
};

}  // namespace calot::analytics
