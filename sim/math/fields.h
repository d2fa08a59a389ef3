// SPDX-License-Identifier: GPL-3.0-or-later
// One list of fields for many uses. A part of State declares its fields once:
//
//   template <class Self, class Visitor> static void fields(Self& self, Visitor& visit) {
//     visit("position", self.position);
//     visit("velocity", self.velocity);
//   }
//
// Digest, keyframe, restore and divergence check all visit that list, so that every field is both saved and hashed.
// Values have a plain layout (no padding, no pointers): arithmetic types, enums, Eigen vectors, matrices and
// quaternions, and vectors of these. Bytes are little-endian, as on all supported machines.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "sim/math/linear.h"

namespace calot {

/// XXH3-64 (xxHash 0.8 specification, seed 0) of bytes. Not cryptographic: it detects differences but proves no origin.
std::uint64_t digest64(std::span<const std::byte> bytes);

/// Streaming form of the same hash: feeding pieces one after the other equals hashing their concatenation.
class DigestStream {
 public:
  DigestStream();
  ~DigestStream();
  DigestStream(const DigestStream&) = delete;
  DigestStream& operator=(const DigestStream&) = delete;
  void reset();
  void append(const void* data, std::size_t size);
  [[nodiscard]] std::uint64_t value() const;

 private:
  struct Storage;
  Storage* storage_;
};

static_assert(std::endian::native == std::endian::little, "State bytes are little-endian by contract");

template <class T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::byte>> {};
template <class S, int R, int C, int O, int MR, int MC>
struct IsPlain<Eigen::Matrix<S, R, C, O, MR, MC>> : std::bool_constant<(R > 0 && C > 0)> {};
template <class S, int O>
struct IsPlain<Eigen::Quaternion<S, O>> : std::true_type {};
template <class T, std::size_t N>
struct IsPlain<std::array<T, N>> : IsPlain<T> {};
template <class T>
inline constexpr bool isPlain = IsPlain<T>::value;

/// The bytes of one plain value.
template <class T>
requires isPlain<T> std::span<const std::byte> bytesOf(const T& value) {
  return {reinterpret_cast<const std::byte*>(&value), sizeof(T)};
}
template <class T>
requires isPlain<T> std::span<const std::byte> bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const std::byte*>(values.data()), values.size() * sizeof(T)};
}

/// Appends fields to a byte string: plain values as they lie in memory, vectors and strings after their length (u64).
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  template <class T>
  void operator()(const char* /*name*/, const T& value) {
    write(value);
  }
  template <class T>
  requires isPlain<T>
  void write(const T& value) { append(bytesOf(value)); }
  template <class T>
  void write(const std::vector<T>& values) {
    write(static_cast<std::uint64_t>(values.size()));
    if constexpr (isPlain<T>) {
      append(bytesOf(values));
    } else {
      for (const T& v : values) write(v);
    }
  }
  template <class T, std::size_t N>
  requires(!isPlain<T>) void write(const std::array<T, N>& parts) {
    for (const T& part : parts) write(part);
  }
  void write(const std::string& text) {
    write(static_cast<std::uint64_t>(text.size()));
    append({reinterpret_cast<const std::byte*>(text.data()), text.size()});
  }
  template <class T>
  requires(!isPlain<T> && requires(const T& t, ByteWriter& w) { T::fields(t, w); }) void write(const T& part) {
    T::fields(part, *this);
  }

 private:
  void append(std::span<const std::byte> bytes) {
    // Not insert(): gcc 12 warns of an overflow in its first growth.
    const std::size_t at = out_.size();
    out_.resize(at + bytes.size());
    if (!bytes.empty()) std::memcpy(out_.data() + at, bytes.data(), bytes.size());
  }
  std::vector<std::byte>& out_;
};

/// Reads what ByteWriter wrote. Never reads outside the bytes. After the first error `ok()` is false, and later reads
/// leave their targets unchanged.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void operator()(const char* /*name*/, T& value) {
    read(value);
  }
  template <class T>
  requires isPlain<T>
  void read(T& value) {
    if (std::span<const std::byte> b = take(sizeof(T)); ok_)
      std::memcpy(static_cast<void*>(&value), b.data(), sizeof(T));
  }
  template <class T>
  void read(std::vector<T>& values) {
    std::uint64_t size = 0;
    read(size);
    const std::uint64_t least = isPlain<T> ? sizeof(T) : 1;
    if (size > (bytes_.size() - at_) / least) ok_ = false;
    if (!ok_) return;
    values.resize(static_cast<std::size_t>(size));
    if constexpr (isPlain<T>) {
      const std::span<const std::byte> b = take(values.size() * sizeof(T));
      if (ok_ && !b.empty()) std::memcpy(static_cast<void*>(values.data()), b.data(), b.size());
    } else {
      for (T& v : values) read(v);
    }
  }
  template <class T, std::size_t N>
  requires(!isPlain<T>) void read(std::array<T, N>& parts) {
    for (T& part : parts) read(part);
  }
  void read(std::string& text) {
    std::uint64_t size = 0;
    read(size);
    if (size > bytes_.size() - at_) ok_ = false;
    if (!ok_) return;
    const std::span<const std::byte> b = take(static_cast<std::size_t>(size));
    text.assign(reinterpret_cast<const char*>(b.data()), b.size());
  }
  template <class T>
  requires(!isPlain<T> && requires(T & t, ByteReader& r) { T::fields(t, r); }) void read(T& part) {
    T::fields(part, *this);
  }

  [[nodiscard]] bool ok() const { return ok_; }
  /// True if all bytes were consumed and none was missing.
  [[nodiscard]] bool complete() const { return ok_ && at_ == bytes_.size(); }

 private:
  std::span<const std::byte> take(std::size_t size) {
    if (!ok_ || size > bytes_.size() - at_) {
      ok_ = false;
      return {};
    }
    const std::span<const std::byte> b = bytes_.subspan(at_, size);
    at_ += size;
    return b;
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace calot
