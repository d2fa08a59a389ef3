// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <type_traits>

#include "recorder/recording/rows.h"

namespace calot::recorder::hdf5 {

std::mutex& processLock() {
  static std::mutex lock;
  return lock;
}

Session::Session() : lock_(processLock()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

namespace {

extern "C" herr_t calotCollectReason(unsigned /*depth*/, const H5E_error2_t* error, void* out) {
  auto& text = *static_cast<std::string*>(out);
  const std::string description = error->desc != nullptr ? error->desc : "";
  if (text == "bad checksum") return 0;
  if (description.find("hecksum") != std::string::npos || description.find("inflate()") != std::string::npos) {
    text = "bad checksum";
    return 0;
  }
  constexpr const char* key = "error message = '";
  if (const auto at = description.find(key); at != std::string::npos) {
    const auto begin = at + std::char_traits<char>::length(key);
    text = description.substr(begin, description.find('\'', begin) - begin);
  } else if (text.empty()) {
    text = description;
  }
  return 0;
}

}  // namespace

std::string reason() {
  std::string text;
  // Upward: innermost call first.
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, calotCollectReason, &text);
  return text.empty() ? "unknown reason" : text;
}

Error damaged(const std::filesystem::path& file, const std::string& place, const std::string& what) {
  return {ErrorKind::damaged, Where{file.string(), place}, what};
}

namespace {

/// The compound of a row's fields, one after the other.
struct InsertFields {
  Id compound;
  std::size_t offset = 0;

  void operator()(const char* name, const char* /*unit*/, const Vec3& /*value*/) {
    insertArray(name, H5T_IEEE_F64LE, 3);
  }
  void operator()(const char* name, const char* /*unit*/, const Quat& /*value*/) {
    insertArray(name, H5T_IEEE_F64LE, 4);
  }
  template <std::size_t N>
  void operator()(const char* name, const char* /*unit*/, const std::array<std::uint8_t, N>& /*value*/) {
    insertArray(name, H5T_STD_U8LE, N);
  }
  template <class T>
  void operator()(const char* name, const char* /*unit*/, const T& /*value*/) {
    constexpr bool isSigned = std::is_signed_v<T> && !std::is_enum_v<T>;
    insert(name, std::is_floating_point_v<T> ? H5T_IEEE_F64LE
                 : isSigned                  ? H5T_STD_I64LE
                 : sizeof(T) == 8            ? H5T_STD_U64LE
                 : sizeof(T) == 2            ? H5T_STD_U16LE
                                             : H5T_STD_U8LE);
    static_assert(sizeof(T) == 8 || (!std::is_floating_point_v<T> && !isSigned && sizeof(T) <= 2));
  }

 private:
  void insert(const char* name, hid_t field) {
    H5Tinsert(compound.get(), name, offset, field);
    offset += H5Tget_size(field);
  }
  void insertArray(const char* name, hid_t element, hsize_t size) {
    insert(name, type(H5Tarray_create2(element, 1, &size)).get());
  }
};

template <class Row>
Id rowType(std::size_t bytes) {
  InsertFields fields{type(H5Tcreate(H5T_COMPOUND, bytes))};
  const Row row{};
  visitRow(row, fields);
  assert(fields.offset == bytes);
  return std::move(fields.compound);
}

}  // namespace

Id elementType(Element element) {
  switch (element) {
    case Element::u1:
      return type(H5Tcopy(H5T_STD_U8LE));
    case Element::u2:
      return type(H5Tcopy(H5T_STD_U16LE));
    case Element::u4:
      return type(H5Tcopy(H5T_STD_U32LE));
    case Element::u8:
      return type(H5Tcopy(H5T_STD_U64LE));
    case Element::i8:
      return type(H5Tcopy(H5T_STD_I64LE));
    case Element::f4:
      return type(H5Tcopy(H5T_IEEE_F32LE));
    case Element::f8:
      return type(H5Tcopy(H5T_IEEE_F64LE));
    case Element::event:
      return rowType<Event>(eventBytes);
    case Element::keyframe:
      return rowType<KeyframeRow>(keyframeBytes);
    case Element::status:
      return rowType<StatusRow>(statusBytes);
    case Element::rawSample:
      return rowType<RawSample>(rawSampleBytes);
    case Element::rawCounts:
      return rowType<RawCounts>(rawCountsBytes);
  }
  return {};
}

Id stringType(std::size_t bytes) {
  Id t = type(H5Tcopy(H5T_C_S1));
  H5Tset_size(t.get(), std::max<std::size_t>(1, bytes));
  H5Tset_strpad(t.get(), H5T_STR_NULLPAD);
  H5Tset_cset(t.get(), H5T_CSET_UTF8);
  return t;
}

Id fileAccess(unsigned metadataAttempts) {
  Id p = properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(p.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(p.get(), H5F_CLOSE_STRONG);
  if (metadataAttempts > 0) H5Pset_metadata_read_attempts(p.get(), metadataAttempts);
  return p;
}

Id datasetAccess(std::size_t chunkBytes) {
  Id p = properties(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(p.get(), 3, 2 * chunkBytes, 1.0);
  return p;
}

}  // namespace calot::recorder::hdf5
