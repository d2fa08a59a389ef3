// SPDX-License-Identifier: GPL-3.0-or-later
// Names that a cohort database knows: sites, arms, stations with their keys, cohorts with their participants.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace calot::analytics {

using PublicKey = std::array<std::byte, 32>;

struct Named {
  std::string name, note;
};
struct Station {
  std::string name, site, note;
  std::optional<PublicKey> publicKey;  ///< Ed25519: what its recordings are signed with
};
struct NamedCohort {
  std::string name, note;
  std::vector<std::string> participants;  ///< pseudonyms
};

struct Registers {
  std::vector<Named> sites, arms;
  std::vector<Station> stations;
  std::vector<NamedCohort> cohorts;
};

/// All of them, by name. @throws Error as CohortDatabase does.
Registers readRegisters(const std::string& path);

/// Each adds the name where it is new, changes what is given, and writes an audit row where something changed.
/// @throws Error (invalid) for an empty or malformed name; (refused) for a participant that is not there. A station's
/// key that is there already is not replaced by another: (refused).
/// @param kind "site" or "arm"
void setNamed(const std::string& path, const char* kind, const std::string& name,
              const std::optional<std::string>& note);
void setStation(const std::string& path, const std::string& name, const std::optional<std::string>& site,
                const std::optional<PublicKey>& key, const std::optional<std::string>& note);
void setCohort(const std::string& path, const std::string& name, const std::optional<std::string>& note,
               const std::vector<std::string>& add, const std::vector<std::string>& remove);

/// Describes a rater: criteria ("experience", "training", "independence") and their values; others stay.
void setRater(const std::string& path, const std::string& name,
              const std::vector<std::pair<std::string, std::string>>& criteria);

/// Status of the key that signed a station's recording, according to the database.
enum class KeyStanding : std::uint8_t {
  unsignedAndUnknown,   ///< no signature; the station has no key here, either
  unsignedButExpected,  ///< no signature, though the station has a key
  known,                ///< signed by the station's key
  unregistered,         ///< signed; the station has no key here
  another,              ///< signed by a key that is not the station's
};
KeyStanding standingOf(const Registers& registers, const std::string& station, const std::optional<PublicKey>& key);

}  // namespace calot::analytics
