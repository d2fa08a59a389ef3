// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace calot::analytics {

/// Identities behind pseudonyms: a file separate from the cohort database, for the one person authorised to read it.
/// Its content is encrypted and authenticated (XSalsa20-Poly1305) with a key from a passphrase (Argon2id, 256 MiB).
/// Layout: 16 bytes "calot-key-file-1", 8 bytes each of Argon2's passes and memory (little-endian), 16 of salt, 24 of
/// nonce, then the sealed JSON object pseudonym -> name.
///
/// The file must be readable by its owner alone. It is replaced as a whole, with a new salt and nonce each time; copies
/// in backups are out of reach.
class KeyFile {
 public:
  /// Opens a file; one that is not there is empty. @throws Error (refused) the passphrase is not the file's; (damaged)
  /// no such file, or damaged; (invalid) others than its owner may read it, or the passphrase is empty; (failure) no
  /// memory.
  KeyFile(std::filesystem::path path, std::string passphrase);
  ~KeyFile();
  KeyFile(const KeyFile&) = delete;
  KeyFile& operator=(const KeyFile&) = delete;

  [[nodiscard]] const std::map<std::string, std::string>& names() const { return names_; }

  /// @throws Error (refused) where the pseudonym has another name already; (failure) where the file cannot be written.
  void add(const std::string& pseudonym, const std::string& name);
  /// @returns false where it was not there. @throws Error (failure) where the file cannot be written.
  bool remove(const std::string& pseudonym);

 private:
  void open();
  void save() const;

  std::filesystem::path path_;
  std::string passphrase_;
  std::map<std::string, std::string> names_;
};

}  // namespace calot::analytics
