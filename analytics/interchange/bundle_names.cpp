// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/interchange/bundle_names.h"

#include <fmt/format.h>
#include <sodium.h>
#include <algorithm>

#include "analytics/cohort/withdraw.h"

namespace calot::analytics {

std::int64_t drawShift() {
  [[maybe_unused]] static const int ready = sodium_init();
  constexpr std::uint32_t day = 86400, least = 30 * day, most = 365 * day;
  const std::uint32_t length = least + randombytes_uniform(most - least + 1);
  const bool earlier = randombytes_uniform(2) == 0;
  return earlier ? -static_cast<std::int64_t>(length) : static_cast<std::int64_t>(length);
}

namespace {

/// A figure, but for a day ("2026-01-31"), or a single letter.
bool saysNothing(std::string_view name) {
  const bool figure = std::all_of(name.begin(), name.end(),
                                  [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+'; });
  const bool day = name.size() == 10 && std::count(name.begin(), name.end(), '-') == 2;
  return name.size() < 2 || (figure && !day);
}

bool inCell(char c) { return c != ',' && c != '"' && c != '\n'; }

}  // namespace

void OriginalNames::add(const std::string& name, const char* kind) {
  if (!saysNothing(name)) kindOf_.emplace(name, kind);
}

std::string OriginalNames::firstIn(std::string_view text, const std::set<std::string>& vocabulary) const {
  for (bool (*belongs)(char) : {inCell, isInWord}) {
    for (std::size_t i = 0; i < text.size();) {
      std::size_t end = i;
      while (end < text.size() && belongs(text[end])) ++end;
      const auto at = kindOf_.find(text.substr(i, end - i));
      if (at != kindOf_.end() && vocabulary.count(at->first) == 0) return at->second;
      i = end + 1;
    }
  }
  return {};
}

std::string NewNames::random(const char* kind, const std::string& old) {
  [[maybe_unused]] static const int ready = sodium_init();
  return named(kind, old, [&] {
    static constexpr char letters[] = "abcdefghjkmnpqrstuvwxyz23456789";
    std::string name = kind;
    for (int i = 0; i < 9; ++i) name += letters[randombytes_uniform(sizeof letters - 1)];
    return name;
  });
}

std::string NewNames::numbered(const char* kind, const std::string& old) {
  return named(kind, old, [&] { return fmt::format("{}{}", kind, ++last_[kind]); });
}

}  // namespace calot::analytics
