// SPDX-License-Identifier: GPL-3.0-or-later
// Names and dates that a bundle gives instead of those in the database.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace calot::analytics {

/// Seconds of 30 to 365 days, earlier or later, from the system's source of randomness.
std::int64_t drawShift();

/// Names that must not occur in an export, searched for as whole cells and whole words of a file.
class OriginalNames {
 public:
  /// @param kind for the message: "a pseudonym"
  void add(const std::string& name, const char* kind);
  [[nodiscard]] bool has(const std::string& name) const { return kindOf_.count(name) > 0; }

  /// Kind of the first of these names that the text holds, or empty. Numbers (other than dates), single letters and
  /// words in `vocabulary` identify nobody and are not searched for.
  [[nodiscard]] std::string firstIn(std::string_view text, const std::set<std::string>& vocabulary) const;

 private:
  std::map<std::string, std::string, std::less<>> kindOf_;
};

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
