// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "recorder/base/files.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

using hdf5::damaged;
using hdf5::Id;

constexpr std::size_t maxAttribute = 32768;
constexpr std::size_t maxName = 1024;
/// All names of a list together, as they are stored, and all files of a scene (bytes).
constexpr std::uint64_t maxNameBytes = std::uint64_t{1} << 20U;
constexpr std::uint64_t maxAssetBytes = std::uint64_t{512} << 20U;

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& path, const Id& file, std::uint64_t fileBytes)
      : path_(path), file_(file), fileBytes_(fileBytes) {}

  std::string text(hid_t object, const std::string& place, const char* name) const {
    const Id a = open(object, place, name);
    const Id type = hdf5::type(H5Aget_type(a.get()));
    std::string value(sizeOfText(type, maxAttribute), '\0');
    if (value.empty()) throw damaged(path_, place + "@" + name, "is not a fixed-length string");
    if (H5Aread(a.get(), type.get(), value.data()) < 0) throw damaged(path_, place + "@" + name, hdf5::reason());
    if (!trim(value)) throw damaged(path_, place + "@" + name, "has a zero inside its text");
    return value;
  }

  template <class T>
  void number(hid_t object, const std::string& place, const char* name, T& value) const {
    const Id a = open(object, place, name);
    const Id type = hdf5::type(H5Aget_type(a.get()));
    const Id expected = hdf5::elementType(storedAs<T>());
    if (H5Tequal(type.get(), expected.get()) <= 0) throw damaged(path_, place + "@" + name, "has the wrong type");
    if (H5Aread(a.get(), expected.get(), &value) < 0) throw damaged(path_, place + "@" + name, hdf5::reason());
  }

  std::vector<std::string> names(const std::string& place, std::uint64_t most) const {
    if (!there(place)) return {};
    const List list = open(place);
    const std::size_t size = sizeOfText(list.type, maxName);
    if (size == 0) throw damaged(path_, place, "does not hold fixed-length strings");
    if (list.rows < 1 || list.rows > most) throw damaged(path_, place, "has the wrong shape");
    if (list.rows * size > maxNameBytes)
      throw damaged(path_, place, fmt::format("takes {} bytes; names take at most {}", list.rows * size, maxNameBytes));
    std::string all(size * list.rows, '\0');
    read(list, place, all.data());
    std::vector<std::string> out;
    for (std::size_t i = 0; i < list.rows; ++i) {
      out.push_back(all.substr(i * size, size));
      if (!trim(out.back())) throw damaged(path_, place, "has a zero inside a name");
    }
    return out;
  }

  Asset asset(const std::string& place) {
    Asset out;
    const List list = open(place, H5T_STD_U8LE);
    // Deflate cannot shrink more than 1032 to 1.
    if (list.rows / 1040 > fileBytes_) throw damaged(path_, place, "claims more bytes than the file can hold");
    assetBytes_ += list.rows;
    if (list.rows > maxAssetBytes || assetBytes_ > maxAssetBytes)
      throw damaged(path_, place, fmt::format("the scene's files take more than {} bytes", maxAssetBytes));
    out.name = text(list.dataset.get(), place, "name");
    const std::string sha = text(list.dataset.get(), place, "sha256");
    out.bytes.resize(static_cast<std::size_t>(list.rows));
    read(list, place, out.bytes.data());
    if (sha256Hex(out.bytes) != sha) throw damaged(path_, place, "does not have the SHA-256 it is said to have");
    return out;
  }

  std::vector<std::uint32_t> numbers(const std::string& place, std::uint64_t expected) const {
    const List list = open(place, H5T_STD_U32LE);
    if (list.rows != expected) throw damaged(path_, place, "has the wrong shape");
    std::vector<std::uint32_t> out(static_cast<std::size_t>(expected));
    read(list, place, out.data());
    return out;
  }

  /// @return false where there are none, which may be
  template <std::size_t N>
  bool bytes(const std::string& place, std::array<std::uint8_t, N>& out, bool mayBeEmpty) const {
    const List list = open(place, H5T_STD_U8LE);
    if (list.rows == 0 && mayBeEmpty) return false;
    if (list.rows != N) throw damaged(path_, place, "has the wrong shape");
    read(list, place, out.data());
    return true;
  }

  [[nodiscard]] bool there(const std::string& place) const {
    return H5Lexists(file_.get(), place.c_str(), H5P_DEFAULT) > 0;
  }

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  /// A data set of one dimension.
  struct List {
    Id dataset, type;
    hsize_t rows = 0;
  };
  /// @param expected type of its elements, or any
  List open(const std::string& place, hid_t expected = H5I_INVALID_HID) const {
    List list{hdf5::dataset(H5Dopen2(file_.get(), place.c_str(), H5P_DEFAULT)), {}};
    if (!list.dataset.valid()) throw damaged(path_, place, "is missing or cannot be read");
    list.type = hdf5::type(H5Dget_type(list.dataset.get()));
    if (expected >= 0 && H5Tequal(list.type.get(), expected) <= 0) throw damaged(path_, place, "has the wrong type");
    const Id space = hdf5::space(H5Dget_space(list.dataset.get()));
    if (H5Sget_simple_extent_ndims(space.get()) != 1 ||
        H5Sget_simple_extent_dims(space.get(), &list.rows, nullptr) != 1)
      throw damaged(path_, place, "has the wrong shape");
    return list;
  }

  void read(const List& list, const std::string& place, void* out) const {
    if (list.rows > 0 && H5Dread(list.dataset.get(), list.type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0)
      throw damaged(path_, place, hdf5::reason());
  }

  /// Bytes of a fixed-length string; 0: it is not one, or longer than `most`.
  static std::size_t sizeOfText(const Id& type, std::size_t most) {
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0) return 0;
    const std::size_t size = H5Tget_size(type.get());
    return size > most ? 0 : size;
  }

  /// Removes the padding. @return false where there is a zero inside
  static bool trim(std::string& text) {
    while (!text.empty() && text.back() == '\0') text.pop_back();
    return text.find('\0') == std::string::npos;
  }

  Id open(hid_t object, const std::string& place, const char* name) const {
    Id a = hdf5::attribute(H5Aopen(object, name, H5P_DEFAULT));
    if (!a.valid()) throw damaged(path_, place + "@" + name, "is missing; the file is not a recording, or damaged");
    const Id space = hdf5::space(H5Aget_space(a.get()));
    if (H5Sget_simple_extent_type(space.get()) != H5S_SCALAR)
      throw damaged(path_, place + "@" + name, "has the wrong shape");
    return a;
  }

  const std::filesystem::path& path_;
  const Id& file_;
  std::uint64_t fileBytes_;
  std::uint64_t assetBytes_ = 0;  ///< of those that were read
};

struct ReadAttributes {
  const HeaderReader& reader;
  void operator()(const char* name, std::string& v) { v = reader.text(reader.root(), "/", name); }
  void operator()(const char* name, auto& v) { reader.number(reader.root(), "/", name, v); }
  void constant(const char* name, const std::string& expected) {
    if (reader.text(reader.root(), "/", name) != expected)
      throw damaged(reader.path(), std::string("/@") + name, "the file is not a recording");
  }
  template <class T, std::size_t N>
  void choice(const char* name, T& value, const std::array<const char*, N>& names) {
    const std::string text = reader.text(reader.root(), "/", name);
    const auto at = std::find(names.begin(), names.end(), text);
    if (at == names.end()) throw damaged(reader.path(), std::string("/@") + name, "has an unknown value");
    value = static_cast<T>(at - names.begin());
  }
};

bool isUuid(const std::string& text) {
  static const std::regex uuid("[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}");
  return text.size() == 36 && std::regex_match(text, uuid);
}

}  // namespace

AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes) {
  HeaderReader reader(path, file, fileBytes);
  AttemptHeader h;
  ReadAttributes attributes{reader};
  // The set of the other attributes depends on the version.
  attributes.constant("format", std::string(formatName));
  attributes("format_version", h.formatVersion);
  if (h.formatVersion < oldestFormatVersion || h.formatVersion > formatVersion) {
    throw damaged(path, "/@format_version",
                  fmt::format("is {}; this build reads {} to {}", h.formatVersion, oldestFormatVersion, formatVersion));
  }
  visitAttributes(h, attributes);
  if (!isUuid(h.attempt)) throw damaged(path, "/@attempt_uuid", "is not a uuid");
  if (!h.parent.empty() && !isUuid(h.parent)) throw damaged(path, "/@parent_uuid", "is not a uuid");
  if (h.ticksPerStep < 1 || h.ticksPerStep > maxTicksPerStep)
    throw damaged(path, "/@ticks_per_step", "is not in 1..1000");
  if (!(h.tickSeconds > 0.0 && h.tickSeconds <= 1.0)) throw damaged(path, "/@tick_seconds", "is not in (0, 1] s");

  h.assets.push_back(reader.asset("/scene/description"));
  const Id assets = hdf5::group(H5Gopen2(file.get(), "/scene/assets", H5P_DEFAULT));
  H5G_info_t info{};
  if (!assets.valid() || H5Gget_info(assets.get(), &info) < 0) throw damaged(path, "/scene/assets", "is missing");
  if (info.nlinks > 999) throw damaged(path, "/scene/assets", "holds too many assets");
  for (std::size_t i = 1; i <= info.nlinks; ++i)
    h.assets.push_back(reader.asset(fmt::format("/scene/assets/{:03}", i)));

  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) {
      if (Kind::results.since <= h.stepResultVersion) Kind::namesOf(h) = reader.names(namesPath<Kind>(), maxStructures);
    }
  });
  if (h.structures().size() > maxStructures)
    throw damaged(path, "/scene",
                  fmt::format("names more than {} structures (organs, vessels and bodies of fat)", maxStructures));
  h.layout.components = reader.names("/steps/component_names", 4096);
  const std::vector<std::string> fields = reader.names("/steps/field_names", 65536);
  if (!fields.empty()) {
    const std::vector<std::uint32_t> component = reader.numbers("/steps/field_component", fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (component[i] >= h.layout.components.size())
        throw damaged(path, "/steps/field_component", "names a component that is not there");
      h.layout.fields.push_back({component[i], fields[i]});
    }
  }
  h.deviceSamples = reader.there("/device");
  if (isMinimal(h)) return h;
  const Id observables = hdf5::group(H5Gopen2(file.get(), "/observables", H5P_DEFAULT));
  if (!observables.valid()) throw damaged(path, "/observables", "is missing");
  std::uint32_t version = 0;
  reader.number(observables.get(), "/observables", "version", version);
  if (version != h.stepResultVersion)
    throw damaged(path, "/observables@version", "is not the root's step_result_version");
  return h;
}

std::optional<RecordedSignature> readSignature(const std::filesystem::path& path, const hdf5::Id& file) {
  if (H5Lexists(file.get(), "/signature", H5P_DEFAULT) <= 0) return std::nullopt;
  const HeaderReader reader(path, file, 0);
  RecordedSignature signature;
  reader.bytes(publicKeyPath, signature.publicKey, false);
  Signature value{};
  if (reader.bytes(signaturePath, value, true)) signature.value = value;
  return signature;
}

}  // namespace calot::recorder
