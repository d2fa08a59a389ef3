// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/superblock.h"

#include <array>
#include <bit>
#include <cstring>

namespace calot::recorder {

std::uint32_t lookup3(std::span<const unsigned char> bytes) {
  std::uint32_t a = 0xdeadbeefU + static_cast<std::uint32_t>(bytes.size()), b = a, c = a;
  if (bytes.empty()) return c;
  const auto addTwelve = [&](const unsigned char* p) {
    std::array<std::uint32_t, 3> word;
    std::memcpy(word.data(), p, 12);
    a += word[0];
    b += word[1];
    c += word[2];
  };
  while (bytes.size() > 12) {
    addTwelve(bytes.data());
    a -= c, a ^= std::rotl(c, 4), c += b;
    b -= a, b ^= std::rotl(a, 6), a += c;
    c -= b, c ^= std::rotl(b, 8), b += a;
    a -= c, a ^= std::rotl(c, 16), c += b;
    b -= a, b ^= std::rotl(a, 19), a += c;
    c -= b, c ^= std::rotl(b, 4), b += a;
    bytes = bytes.subspan(12);
  }
  std::array<unsigned char, 12> last{};
  std::memcpy(last.data(), bytes.data(), bytes.size());
  addTwelve(last.data());
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
  return c;
}

bool markClosed(std::span<unsigned char> image) {
  constexpr std::size_t version = 8, sizeOfOffsets = 9, flags = 11, checksum = 44;
  if (image.size() < checksum + 4 || image[version] < 2 || image[version] > 3 || image[sizeOfOffsets] != 8)
    return false;
  image[flags] = 0;
  const std::uint32_t sum = lookup3(image.first(checksum));
  std::memcpy(&image[checksum], &sum, sizeof sum);
  return true;
}

}  // namespace calot::recorder
