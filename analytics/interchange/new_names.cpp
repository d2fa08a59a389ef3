// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/new_names.h"

#include <fmt/format.h>
#include <sodium.h>

namespace calot::analytics {

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
