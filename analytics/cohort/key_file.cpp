// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/key_file.h"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <nlohmann/json.hpp>

#include "analytics/cohort/tables.h"
#include "recorder/base/errors.h"
#include "recorder/base/secret_file.h"

namespace calot::analytics {
namespace {

using nlohmann::json;

constexpr std::string_view magic = "calot-key-file-1";
constexpr std::size_t headBytes = magic.size() + 16 + crypto_pwhash_SALTBYTES + crypto_secretbox_NONCEBYTES;
constexpr std::size_t maxBytes = std::size_t{16} << 20U;
// Upper limits of a file's parameters; larger ones could only serve to hang the reader.
constexpr std::uint64_t mostPasses = 16, maxMemory = std::uint64_t{1} << 30U;

const unsigned char* bytesOf(const std::string& text, std::size_t at = 0) {
  return reinterpret_cast<const unsigned char*>(text.data()) + at;
}

void putNumber(std::string& to, std::uint64_t value) {
  for (unsigned i = 0; i < 8; ++i) to += static_cast<char>(value >> (8 * i) & 0xFFU);
}

std::uint64_t numberAt(const std::string& from, std::size_t at) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= std::uint64_t{bytesOf(from)[at + i]} << (8 * i);
  return value;
}

/// Encryption key; wiped on destruction.
class SealingKey {
 public:
  SealingKey(const std::filesystem::path& path, const std::string& passphrase, const unsigned char* salt,
             std::uint64_t passes, std::uint64_t memory) {
    if (crypto_pwhash(key_.data(), key_.size(), passphrase.data(), passphrase.size(), salt, passes,
                      static_cast<std::size_t>(memory), crypto_pwhash_ALG_ARGON2ID13) != 0) {
      throw Error(ErrorKind::failure, Where{path.string()},
                  fmt::format("not enough memory for the passphrase ({} MiB are wanted)", memory >> 20U));
    }
  }
  ~SealingKey() { sodium_memzero(key_.data(), key_.size()); }
  SealingKey(const SealingKey&) = delete;
  SealingKey& operator=(const SealingKey&) = delete;
  [[nodiscard]] const unsigned char* get() const { return key_.data(); }

 private:
  std::array<unsigned char, crypto_secretbox_KEYBYTES> key_{};
};

}  // namespace

KeyFile::KeyFile(std::filesystem::path path, std::string passphrase)
    : path_(std::move(path)), passphrase_(std::move(passphrase)) {
  if (sodium_init() < 0) throw Error(ErrorKind::failure, "libsodium cannot be initialised");
  if (passphrase_.empty()) throw Error(ErrorKind::invalid, Where{path_.string()}, "its passphrase is empty");
  std::error_code error;
  if (std::filesystem::exists(path_, error)) open();
}

KeyFile::~KeyFile() {
  sodium_memzero(passphrase_.data(), passphrase_.size());
  for (auto& item : names_) sodium_memzero(item.second.data(), item.second.size());
}

void KeyFile::open() {
  const std::string file = recorder::readSecret(path_, maxBytes);
  const auto damaged = [&] { return Error(ErrorKind::damaged, Where{path_.string()}, "not a key file, or damaged"); };
  if (file.size() < headBytes + crypto_secretbox_MACBYTES || file.compare(0, magic.size(), magic) != 0) throw damaged();
  const std::uint64_t passes = numberAt(file, magic.size()), memory = numberAt(file, magic.size() + 8);
  if (passes < crypto_pwhash_OPSLIMIT_MIN || passes > mostPasses || memory < crypto_pwhash_MEMLIMIT_MIN ||
      memory > maxMemory || memory % 1024 != 0) {  // Argon2 counts KiB: the rest would not be vouched for
    throw damaged();
  }
  const std::size_t saltAt = magic.size() + 16, nonceAt = saltAt + crypto_pwhash_SALTBYTES;
  const SealingKey key(path_, passphrase_, bytesOf(file, saltAt), passes, memory);
  std::string text(file.size() - headBytes - crypto_secretbox_MACBYTES, '\0');
  if (crypto_secretbox_open_easy(reinterpret_cast<unsigned char*>(text.data()), bytesOf(file, headBytes),
                                 file.size() - headBytes, bytesOf(file, nonceAt), key.get()) != 0) {
    throw Error(ErrorKind::refused, Where{path_.string()},
                "the passphrase is not this file's, or the file was changed");
  }
  const json names = json::parse(text, nullptr, false);
  sodium_memzero(text.data(), text.size());
  if (!names.is_object()) throw damaged();
  for (const auto& [pseudonym, name] : names.items()) {
    if (!name.is_string()) throw damaged();
    names_[pseudonym] = name.get<std::string>();
  }
}

void KeyFile::add(const std::string& pseudonym, const std::string& name) {
  tables::checkPseudonym(pseudonym);
  if (name.empty()) throw Error(ErrorKind::invalid, fmt::format("{}: a name is wanted", pseudonym));
  const auto [at, fresh] = names_.emplace(pseudonym, name);
  if (!fresh && at->second == name) return;
  if (!fresh) {
    throw Error(ErrorKind::refused, Where{path_.string()},
                fmt::format("\"{}\" stands for someone else already; remove that entry first", pseudonym));
  }
  save();
}

bool KeyFile::remove(const std::string& pseudonym) {
  if (names_.erase(pseudonym) == 0) return false;
  save();
  return true;
}

void KeyFile::save() const {
  std::array<unsigned char, crypto_pwhash_SALTBYTES> salt{};
  std::array<unsigned char, crypto_secretbox_NONCEBYTES> nonce{};
  randombytes_buf(salt.data(), salt.size());
  randombytes_buf(nonce.data(), nonce.size());
  const SealingKey key(path_, passphrase_, salt.data(), crypto_pwhash_OPSLIMIT_MODERATE,
                       crypto_pwhash_MEMLIMIT_MODERATE);
  std::string text;
  try {
    text = json(names_).dump();
  } catch (const json::exception&) {
    throw Error(ErrorKind::invalid, Where{path_.string()}, "a name is no UTF-8 text");
  }
  std::string sealed(text.size() + crypto_secretbox_MACBYTES, '\0');
  crypto_secretbox_easy(reinterpret_cast<unsigned char*>(sealed.data()), bytesOf(text), text.size(), nonce.data(),
                        key.get());
  sodium_memzero(text.data(), text.size());
  std::string file(magic);
  putNumber(file, crypto_pwhash_OPSLIMIT_MODERATE);
  putNumber(file, crypto_pwhash_MEMLIMIT_MODERATE);
  file.append(reinterpret_cast<const char*>(salt.data()), salt.size());
  file.append(reinterpret_cast<const char*>(nonce.data()), nonce.size());
  recorder::writeSecret(path_, file + sealed, true);
}

}  // namespace calot::analytics
