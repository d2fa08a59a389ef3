// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/station_key.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::recorder {
namespace {

using Seed = std::array<std::uint8_t, crypto_sign_SEEDBYTES>;

void ready() {
  if (sodium_init() < 0) throw Error(ErrorKind::failure, "libsodium cannot be initialised");
}

void checkStation(const std::string& station) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  if (station.empty() || station.size() > 64 || std::any_of(station.begin(), station.end(), control))
    throw Error(ErrorKind::invalid, "station: a name has 1 to 64 characters and no control characters");
}

void expand(const Seed& seed, StationKey& key) {
  crypto_sign_seed_keypair(key.publicKey.data(), key.secret.data(), seed.data());
}

}  // namespace

StationKey::~StationKey() { sodium_memzero(secret.data(), secret.size()); }

StationKey makeStationKey(const std::string& station) {
  ready();
  checkStation(station);
  Seed seed{};
  randombytes_buf(seed.data(), seed.size());
  StationKey key;
  key.station = station;
  expand(seed, key);
  sodium_memzero(seed.data(), seed.size());
  return key;
}

void writeStationKey(const std::filesystem::path& file, const StationKey& key) {
  Seed seed{};
  std::copy_n(key.secret.begin(), seed.size(), seed.begin());
  std::string text;
  try {
    text = nlohmann::ordered_json{{"format", "calot-station-key"},
                                  {"version", 1},
                                  {"station", key.station},
                                  {"public_key", hexOf(key.publicKey)},
                                  {"seed", hexOf(seed)}}
               .dump(2) +
           "\n";
  } catch (const nlohmann::json::exception&) {
    throw Error(ErrorKind::invalid, "station: its name is not UTF-8 text");
  }
  writeSecret(file, text, false);
  sodium_memzero(text.data(), text.size());
  sodium_memzero(seed.data(), seed.size());
}

StationKey readStationKey(const std::filesystem::path& file) {
  ready();
  std::string text = readSecret(file, 65536);
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  sodium_memzero(text.data(), text.size());
  StationKey key;
  PublicKey said{};
  Seed seed{};
  const auto word = [&](const char* name) { return json.contains(name) ? json[name] : nlohmann::json(); };
  const auto readBytes = [&](const char* name, auto& out) {
    return word(name).is_string() &&
           readHex(word(name).get_ref<const std::string&>(), std::as_writable_bytes(std::span(out)));
  };
  const bool good = json.is_object() && word("format") == "calot-station-key" && word("version") == 1 &&
                    word("station").is_string() && readBytes("public_key", said) && readBytes("seed", seed);
  if (!good) throw Error(ErrorKind::damaged, Where{file.string()}, "no station key, or of a newer Calot");
  key.station = json["station"].get<std::string>();
  checkStation(key.station);
  expand(seed, key);
  sodium_memzero(seed.data(), seed.size());
  if (key.publicKey != said)
    throw Error(ErrorKind::damaged, Where{file.string()}, "its public key is not that of its seed");
  return key;
}

Signature signHead(const StationKey& key, const std::array<std::uint8_t, 32>& head) {
  Signature signature{};
  crypto_sign_detached(signature.data(), nullptr, head.data(), head.size(), key.secret.data());
  return signature;
}

std::array<std::uint8_t, 32> headOfText(std::string_view text) {
  std::array<std::uint8_t, 32> head{};
  readHex(sha256Hex(std::as_bytes(std::span(text))), std::as_writable_bytes(std::span(head)));
  return head;
}

bool fits(const Signature& signature, const PublicKey& key, const std::array<std::uint8_t, 32>& head) {
  ready();
  return crypto_sign_verify_detached(signature.data(), head.data(), head.size(), key.data()) == 0;
}

}  // namespace calot::recorder
