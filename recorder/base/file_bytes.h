// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calot::recorder {

/// A whole file.
/// @param name what messages call it.
/// @param most bytes that such a file may have.
/// @throws Error (damaged), naming the file, where it is missing, a folder, unreadable, or larger.
std::vector<std::byte> readFileBytes(const std::filesystem::path& path, const std::string& name, std::size_t most);

/// Bytes in lower-case hexadecimal.
std::string hexOf(std::span<const std::byte> bytes);
template <class Range>
std::string hexOf(const Range& bytes) {
  return hexOf(std::span<const std::byte>(std::as_bytes(std::span(bytes))));
}
/// @return false unless the text is as many bytes in hexadecimal
bool readHex(std::string_view text, std::span<std::byte> out);

/// SHA-256 of bytes (FIPS 180-4) in lower-case hexadecimal, 64 characters.
std::string sha256Hex(std::span<const std::byte> bytes);

/// Bytes as base64 (RFC 4648, with padding).
std::string base64(std::span<const std::byte> bytes);

}  // namespace calot::recorder
