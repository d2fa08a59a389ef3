// SPDX-License-Identifier: GPL-3.0-or-later
#include <sodium.h>

#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {

std::array<std::byte, 32> withdrawalDigest(const std::string& uuid) {
  [[maybe_unused]] static const int ready = sodium_init();
  const std::string text = "calot-withdrawn-1 " + uuid;
  std::array<std::byte, 32> digest{};
  crypto_generichash(reinterpret_cast<unsigned char*>(digest.data()), digest.size(),
                     reinterpret_cast<const unsigned char*>(text.data()), text.size(), nullptr, 0);
  return digest;
}

bool isWithdrawn(SQLite::Database& db, const std::string& uuid) {
  const std::array<std::byte, 32> digest = withdrawalDigest(uuid);
  SQLite::Statement find(db, "SELECT 1 FROM tombstone_attempt WHERE digest = ?");
  find.bind(1, digest.data(), static_cast<int>(digest.size()));
  return find.executeStep();
}

}  // namespace calot::analytics::tables
