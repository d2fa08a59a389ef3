// SPDX-License-Identifier: GPL-3.0-or-later
// Ed25519 (RFC 8032): a station signs the last head of a recording's content chain. docs/explanation/threat-model.md
// explains what that proves.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace calot::recorder {

using PublicKey = std::array<std::uint8_t, 32>;
using Signature = std::array<std::uint8_t, 64>;

/// Key with which a station signs. Its file is JSON: format "calot-station-key", version 1, station, seed and
/// public_key in hexadecimal; only its owner may read it.
struct StationKey {
  std::string station;  ///< the name that its recordings carry
  PublicKey publicKey{};
  std::array<std::uint8_t, 64> secret{};  ///< seed and public key, as libsodium has it

  StationKey() = default;
  StationKey(const StationKey&) = default;
  StationKey& operator=(const StationKey&) = default;
  ~StationKey();  ///< wipes the secret
};

/// A new key from the system's random numbers. @throws Error invalid: an empty or overlong name.
StationKey makeStationKey(const std::string& station);

/// @throws Error invalid: it is there already; failure: it cannot be written.
void writeStationKey(const std::filesystem::path& file, const StationKey& key);

/// @throws Error damaged: not there, or no station key; invalid: others than its owner may read it.
StationKey readStationKey(const std::filesystem::path& file);

/// The signature of 32 bytes: a chain head. The same bytes give the same signature.
Signature signHead(const StationKey& key, const std::array<std::uint8_t, 32>& head);
/// SHA-256 of a text, to be signed instead of it.
std::array<std::uint8_t, 32> headOfText(std::string_view text);
bool fits(const Signature& signature, const PublicKey& key, const std::array<std::uint8_t, 32>& head);

}  // namespace calot::recorder
