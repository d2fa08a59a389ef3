// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace calot::analytics {

/// Names that must not be in what is handed out, looked for as whole cells and as whole words of a file.
class OriginalNames {
 public:
  /// @param kind for the message: "a pseudonym"
  void add(const std::string& name, const char* kind);
  [[nodiscard]] bool has(const std::string& name) const { return kindOf_.count(name) > 0; }

  /// Kind of the first of these names that the text holds, or empty. What is a figure (and no day) or a single letter,
  /// or is in `vocabulary`, says nothing about anyone and is not looked for.
  [[nodiscard]] std::string firstIn(std::string_view text, const std::set<std::string>& vocabulary) const;

 private:
  std::map<std::string, std::string, std::less<>> kindOf_;
};

}  // namespace calot::analytics
