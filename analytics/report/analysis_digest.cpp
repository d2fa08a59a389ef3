// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "analytics/report/masked_study.h"

namespace calot::analytics {
namespace {

/// Hashes cells, each behind its length: no two lists of cells give the same bytes.
class CellHash {
 public:
  CellHash() { crypto_hash_sha256_init(&state_); }

  template <class... Cells>
  void add(const Cells&... cells) {
    (cell(cells), ...);
  }

  std::string hex() {
    std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
    crypto_hash_sha256_final(&state_, digest.data());
    std::string text;
    for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
    return text;
  }

 private:
  void cell(std::string_view text) {
    number(text.size());
    crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
  }
  template <class T>
  void cell(const T& value) {
    cell(std::string_view(fmt::format("{}", value)));
  }
  void number(std::uint64_t value) {
    std::array<unsigned char, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(value >> (8 * i));
    crypto_hash_sha256_update(&state_, bytes.data(), bytes.size());
  }

  crypto_hash_sha256_state state_{};
};

}  // namespace

std::string analysisDigest(const CohortDatabase& database, const AssessmentDatabase& assessment) {
  [[maybe_unused]] static const int ready = sodium_init();
  CellHash hash;
  for (const AttemptRow& a : database.listAttempts()) {
    hash.add(a.uuid, a.participant, a.group, a.profile, a.startUtc, a.comparabilityKey, static_cast<int>(a.outcome),
             static_cast<int>(a.mode), static_cast<int>(a.verification.verdict), a.complete, a.excluded,
             a.exclusionReason);
  }
  for (const Participant& p : database.participants()) {
    hash.add(p.pseudonym, p.group, p.experience.size());
    for (const auto& [criterion, value] : p.experience) hash.add(criterion, value);
  }
  database.eachValue({}, [&](const AttemptValue& item) {
    const CheckpointValue& v = item.value;
    // Shortest digits that give the same double again.
    hash.add(item.attempt, v.name, v.subject, v.version, static_cast<int>(v.availability),
             v.value ? fmt::format("{}", *v.value) : std::string());
  });
  for (const Rating& r : assessment.ratings()) {
    hash.add(r.form, r.formVersion, r.attempt, r.rater, r.participant, r.answers.size());
    for (const auto& [item, score] : r.answers) hash.add(item, score);
  }
  return hash.hex();
}

}  // namespace calot::analytics
