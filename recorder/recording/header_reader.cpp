// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/header_reader.h"

#include <fmt/format.h>

#include "recorder/base/file_bytes.h"
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
    const std::size_t size = type.valid() ? H5Tget_size(type.get()) : 0;
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 ||
        size > maxAttribute) {
      throw damaged(path_, place + "@" + name, "is not a fixed-length string");
    }
    std::string value(size, '\0');
    if (H5Aread(a.get(), type.get(), value.data()) < 0) throw damaged(path_, place + "@" + name, hdf5::reason());
    while (!value.empty() && value.back() == '\0') value.pop_back();
    if (value.find('\0') != std::string::npos) throw damaged(path_, place + "@" + name, "has a zero inside its text");
    return value;
  }

  void number(hid_t object, const std::string& place, const char* name, hid_t expected, void* value) const {
    const Id a = open(object, place, name);
    const Id type = hdf5::type(H5Aget_type(a.get()));
    if (H5Tequal(type.get(), expected) <= 0) throw damaged(path_, place + "@" + name, "has the wrong type");
    if (H5Aread(a.get(), expected, value) < 0) throw damaged(path_, place + "@" + name, hdf5::reason());
  }

  /// A data set of one dimension; its extent.
  Id vector(const std::string& place, std::uint64_t& rows) const {
    Id d = hdf5::dataset(H5Dopen2(file_.get(), place.c_str(), H5P_DEFAULT));
    if (!d.valid()) throw damaged(path_, place, "is missing or cannot be read");
    const Id space = hdf5::space(H5Dget_space(d.get()));
    hsize_t extent = 0;
    if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Sget_simple_extent_dims(space.get(), &extent, nullptr) != 1) {
      throw damaged(path_, place, "has the wrong shape");
    }
    rows = extent;
    return d;
  }

  std::vector<std::string> names(const std::string& place, std::uint64_t most) const {
    if (!there(place)) return {};
    std::uint64_t rows = 0;
    const Id d = vector(place, rows);
    const Id type = hdf5::type(H5Dget_type(d.get()));
    const std::size_t size = type.valid() ? H5Tget_size(type.get()) : 0;
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 || size > maxName) {
      throw damaged(path_, place, "does not hold fixed-length strings");
    }
    if (rows < 1 || rows > most) throw damaged(path_, place, "has the wrong shape");
    if (rows * size > maxNameBytes)
      throw damaged(path_, place, fmt::format("takes {} bytes; names take at most {}", rows * size, maxNameBytes));
    std::string all(size * rows, '\0');
    if (H5Dread(d.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      throw damaged(path_, place, hdf5::reason());
    std::vector<std::string> out;
    for (std::size_t i = 0; i < rows; ++i) {
      std::string one = all.substr(i * size, size);
      while (!one.empty() && one.back() == '\0') one.pop_back();
      if (one.find('\0') != std::string::npos) throw damaged(path_, place, "has a zero inside a name");
      out.push_back(std::move(one));
    }
    return out;
  }

  Asset asset(const std::string& place) {
    Asset out;
    std::uint64_t rows = 0;
    const Id d = vector(place, rows);
    const Id type = hdf5::type(H5Dget_type(d.get()));
    if (H5Tequal(type.get(), H5T_STD_U8LE) <= 0) throw damaged(path_, place, "has the wrong type");
    // Deflate cannot shrink more than 1032 to 1.
    if (rows / 1040 > fileBytes_) throw damaged(path_, place, "claims more bytes than the file can hold");
    assetBytes_ += rows;
    if (rows > maxAssetBytes || assetBytes_ > maxAssetBytes)
      throw damaged(path_, place, fmt::format("the scene's files take more than {} bytes", maxAssetBytes));
    out.name = text(d.get(), place, "name");
    const std::string sha = text(d.get(), place, "sha256");
    out.bytes.resize(static_cast<std::size_t>(rows));
    if (rows > 0 && H5Dread(d.get(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.bytes.data()) < 0) {
      throw damaged(path_, place, hdf5::reason());
    }
    if (sha256Hex(out.bytes) != sha) throw damaged(path_, place, "does not have the SHA-256 it is said to have");
    return out;
  }

  [[nodiscard]] bool there(const std::string& place) const {
    return H5Lexists(file_.get(), place.c_str(), H5P_DEFAULT) > 0;
  }

  std::vector<std::uint32_t> numbers(const std::string& place, std::uint64_t expected) const {
    std::uint64_t rows = 0;
    const Id d = vector(place, rows);
    const Id type = hdf5::type(H5Dget_type(d.get()));
    if (H5Tequal(type.get(), H5T_STD_U32LE) <= 0) throw damaged(path_, place, "has the wrong type");
    if (rows != expected) throw damaged(path_, place, "has the wrong shape");
    std::vector<std::uint32_t> out(static_cast<std::size_t>(rows));
    if (H5Dread(d.get(), H5T_STD_U32LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0)
      throw damaged(path_, place, hdf5::reason());
    return out;
  }

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
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
  void operator()(const char* name, std::uint32_t& v) { reader.number(reader.root(), "/", name, H5T_STD_U32LE, &v); }
  void operator()(const char* name, std::uint64_t& v) { reader.number(reader.root(), "/", name, H5T_STD_U64LE, &v); }
  void operator()(const char* name, std::int64_t& v) { reader.number(reader.root(), "/", name, H5T_STD_I64LE, &v); }
  void operator()(const char* name, double& v) { reader.number(reader.root(), "/", name, H5T_IEEE_F64LE, &v); }
  void constant(const char* name, const std::string& expected) {
    if (reader.text(reader.root(), "/", name) != expected)
      throw damaged(reader.path(), std::string("/@") + name, "the file is not a recording");
  }
  template <class T, std::size_t N>
  void choice(const char* name, T& value, const std::array<const char*, N>& names) {
    const std::string text = reader.text(reader.root(), "/", name);
    for (std::size_t i = 0; i < N; ++i) {
      if (text == names[i]) {
        value = static_cast<T>(i);
        return;
      }
    }
    throw damaged(reader.path(), std::string("/@") + name, "has an unknown value");
  }
};

bool isUuid(const std::string& text) {
  if (text.size() != 36) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool hyphen = i == 8 || i == 13 || i == 18 || i == 23;
    const char c = text[i];
    if (hyphen ? c != '-' : !((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'))) return false;
  }
  return true;
}

}  // namespace

AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes) {
  HeaderReader reader(path, file, fileBytes);
  AttemptHeader h;
  ReadAttributes attributes{reader};
  // What the other attributes are depends on the version.
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
  reader.number(observables.get(), "/observables", "version", H5T_STD_U32LE, &version);
  if (version != h.stepResultVersion)
    throw damaged(path, "/observables@version", "is not the root's step_result_version");
  return h;
}

std::optional<RecordedSignature> readSignature(const std::filesystem::path& path, const hdf5::Id& file) {
  const auto bytes = [&](const char* place, auto& out, bool mayBeEmpty) {
    const Id d = hdf5::dataset(H5Dopen2(file.get(), place, H5P_DEFAULT));
    if (!d.valid()) throw damaged(path, place, "is missing");
    const Id type = hdf5::type(H5Dget_type(d.get()));
    const Id space = hdf5::space(H5Dget_space(d.get()));
    if (H5Tequal(type.get(), H5T_STD_U8LE) <= 0) throw damaged(path, place, "has the wrong type");
    hsize_t rows = 0;
    if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Sget_simple_extent_dims(space.get(), &rows, nullptr) != 1)
      throw damaged(path, place, "has the wrong shape");
    if (rows == 0 && mayBeEmpty) return false;
    if (rows != out.size()) throw damaged(path, place, "has the wrong shape");
    if (H5Dread(d.get(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0)
      throw damaged(path, place, hdf5::reason());
    return true;
  };
  if (H5Lexists(file.get(), "/signature", H5P_DEFAULT) <= 0) return std::nullopt;
  RecordedSignature signature;
  bytes(publicKeyPath, signature.publicKey, false);
  Signature value{};
  if (bytes(signaturePath, value, true)) signature.value = value;
  return signature;
}

}  // namespace calot::recorder
