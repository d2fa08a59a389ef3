// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace calot::analytics {

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

}  // namespace calot::analytics
