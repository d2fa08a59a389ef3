// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/file_bytes.h"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <fstream>

#include "recorder/base/errors.h"

namespace calot::recorder {

std::vector<std::byte> readFileBytes(const std::filesystem::path& path, const std::string& name, std::size_t most) {
  std::error_code fault;
  const std::filesystem::file_status status = std::filesystem::status(path, fault);
  if (!std::filesystem::exists(status)) throw Error(ErrorKind::damaged, Where{name}, "there is no such file");
  if (std::filesystem::is_directory(status))
    throw Error(ErrorKind::damaged, Where{name}, "a folder; a file is expected");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorKind::damaged, Where{name}, "cannot be opened for reading");
  // Read piece by piece: a size that was asked for before would be wrong for a pipe or a growing file.
  std::vector<std::byte> bytes;
  std::array<char, 65536> piece{};
  while (in.read(piece.data(), piece.size()), in.gcount() > 0) {
    const auto* begin = reinterpret_cast<const std::byte*>(piece.data());
    bytes.insert(bytes.end(), begin, begin + in.gcount());
    if (bytes.size() > most) {
      throw Error(ErrorKind::damaged, Where{name}, fmt::format("larger than {} bytes, which no such file is", most));
    }
  }
  if (in.bad()) throw Error(ErrorKind::damaged, Where{name}, "reading failed");
  return bytes;
}

std::string hexOf(std::span<const std::byte> bytes) {
  std::string hex(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  hex.pop_back();  // its zero
  return hex;
}

bool readHex(std::string_view text, std::span<std::byte> out) {
  std::size_t written = 0;
  return text.size() == 2 * out.size() &&
         sodium_hex2bin(reinterpret_cast<unsigned char*>(out.data()), out.size(), text.data(), text.size(), nullptr,
                        &written, nullptr) == 0 &&
         written == out.size();
}

std::string sha256Hex(std::span<const std::byte> bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  return hexOf(hash);
}

std::string base64(std::span<const std::byte> bytes) {
  std::string text(sodium_base64_ENCODED_LEN(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // its zero
  return text;
}

}  // namespace calot::recorder
