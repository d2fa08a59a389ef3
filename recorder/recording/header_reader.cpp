// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/header_reader.h"
#include "recorder/formats/file_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "recorder/recording/chain.h"
#include "recorder/recording/header.h"
#include "recorder/recording/types.h"

namespace calot::recorder {

namespace {

using hdf5::damaged;
using hdf5::Id;

constexpr std::size_t longestAttribute = 32768;
constexpr std::size_t longestName = 1024;

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& path, const Id& file, std::uint64_t fileBytes)
      : path_(path), file_(file), fileBytes_(fileBytes) {}

  std::string text(hid_t object, const std::string& place, const char* name) const {
    const Id a = open(object, place, name);
    const Id type = hdf5::type(H5Aget_type(a.get()));
    const std::size_t size = type.valid() ? H5Tget_size(type.get()) : 0;
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 ||
        size > longestAttribute) {
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
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 ||
        size > longestName) {
      throw damaged(path_, place, "does not hold fixed-length strings");
    }
    if (rows < 1 || rows > most) throw damaged(path_, place, "has the wrong shape");
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

  Asset asset(const std::string& place) const {
    Asset out;
    std::uint64_t rows = 0;
    const Id d = vector(place, rows);
    const Id type = hdf5::type(H5Dget_type(d.get()));
    if (H5Tequal(type.get(), H5T_STD_U8LE) <= 0) throw damaged(path_, place, "has the wrong type");
    // Deflate cannot shrink more than 1032 to 1.
    if (rows / 1040 > fileBytes_) throw damaged(path_, place, "claims more bytes than the file can hold");
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
  void constant(const char* name, std::uint32_t expected) {
    std::uint32_t v = 0;
    reader.number(reader.root(), "/", name, H5T_STD_U32LE, &v);
    if (v != expected) {
      throw damaged(reader.path(), std::string("/@") + name, fmt::format("is {}; this build reads {}", v, expected));
    }
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

Superblock readSuperblock(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ExitCode::damaged, path.string() + ": no such file");
  if (std::filesystem::is_directory(status))
    throw Error(ExitCode::damaged, path.string() + ": is a folder, not a recording");
  if (!std::filesystem::is_regular_file(status))
    throw Error(ExitCode::damaged, path.string() + ": is not a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ExitCode::damaged, path.string() + ": cannot be opened; check its permissions");
  std::array<char, 36> head{};
  in.read(head.data(), head.size());
  if (in.gcount() == 0) throw Error(ExitCode::damaged, path.string() + ": is empty");
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  if (in.gcount() < static_cast<std::streamsize>(head.size()) ||
      !std::equal(signature.begin(), signature.end(), head.begin())) {
    throw Error(ExitCode::damaged, path.string() + ": is not an HDF5 file, so not a recording");
  }
  // HDF5 File Format Specification 3.0, II.A: byte 8 version, 9 size of offsets, 11 consistency flags, 28 end of file.
  Superblock s;
  s.version = static_cast<unsigned char>(head[8]);
  s.writing = s.version >= 2 && (static_cast<unsigned char>(head[11]) & 0x5U) != 0;
  if (s.version >= 2 && head[9] == 8) std::memcpy(&s.endOfFile, &head[28], sizeof s.endOfFile);
  return s;
}

hdf5::Id openForReading(const std::filesystem::path& path, Access access) {
  const Superblock superblock = readSuperblock(path);
  const Id how = hdf5::fileAccess(access == Access::settled ? 1 : 0);
  const unsigned swmr = superblock.writing ? H5F_ACC_SWMR_READ : 0U;
  Id file = hdf5::file(H5Fopen(path.c_str(), H5F_ACC_RDONLY | swmr, how.get()));
  if (file.valid()) return file;
  const std::string why = hdf5::reason();
  std::error_code ignored;
  const std::uint64_t bytes = std::filesystem::file_size(path, ignored);
  if (superblock.endOfFile > bytes && !superblock.writing) {
    throw Error(ExitCode::damaged,
                fmt::format("{}: is cut off: {} of {} bytes are there; calot recover saves what it can", path.string(),
                            bytes, superblock.endOfFile));
  }
  throw Error(ExitCode::damaged, fmt::format("{}: cannot be opened: {}", path.string(), why));
}

AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes) {
  const HeaderReader reader(path, file, fileBytes);
  AttemptHeader h;
  ReadAttributes attributes{reader};
  visitAttributes(h, attributes);
  if (!isUuid(h.attempt)) throw damaged(path, "/@attempt_uuid", "is not a uuid");
  if (!h.parent.empty() && !isUuid(h.parent)) throw damaged(path, "/@parent_uuid", "is not a uuid");
  if (h.ticksPerStep < 1 || h.ticksPerStep > largestTicksPerStep)
    throw damaged(path, "/@ticks_per_step", "is not in 1..1000");
  if (!(h.tickSeconds > 0.0 && h.tickSeconds <= 1.0)) throw damaged(path, "/@tick_seconds", "is not in (0, 1] s");

  h.assets.push_back(reader.asset("/scene/description"));
  const Id assets = hdf5::group(H5Gopen2(file.get(), "/scene/assets", H5P_DEFAULT));
  H5G_info_t info{};
  if (!assets.valid() || H5Gget_info(assets.get(), &info) < 0) throw damaged(path, "/scene/assets", "is missing");
  if (info.nlinks > 999) throw damaged(path, "/scene/assets", "holds too many assets");
  for (std::size_t i = 1; i <= info.nlinks; ++i)
    h.assets.push_back(reader.asset(fmt::format("/scene/assets/{:03}", i)));

  h.organs = reader.names("/scene/organs", largestOrganCount);
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
  const Id observables = hdf5::group(H5Gopen2(file.get(), "/observables", H5P_DEFAULT));
  if (!observables.valid()) throw damaged(path, "/observables", "is missing");
  std::uint32_t version = 0;
  reader.number(observables.get(), "/observables", "version", H5T_STD_U32LE, &version);
  if (version != h.stepResultVersion)
    throw damaged(path, "/observables@version", "is not the root's step_result_version");
  return h;
}

ColumnReader::ColumnReader(std::filesystem::path path, const hdf5::Id& file, const Layout& layout,
                           std::uint64_t fileBytes)
    : path_(std::move(path)), layout_(layout), fileBytes_(fileBytes) {
  // /status first: of a file that is being written, what is opened later holds at least what its rows vouch for.
  statusColumn_.path = "/status";
  statusColumn_.element = Element::status;
  statusColumn_.deflate = false;
  status_ = open(file, statusColumn_);
  for (const Column& column : layout.columns) source_.push_back(open(file, column));
  statusRows_ = status_.rows;
  if (statusRows_ < 1) throw damaged(path_, "/status", "is empty");
  if (statusRows_ > fileBytes) throw damaged(path_, "/status", "claims more rows than the file can hold");
}

ColumnReader::Source ColumnReader::open(const hdf5::Id& file, const Column& column) const {
  Source s;
  s.type = hdf5::elementType(column.element);
  if (column.width == 0) return s;
  const Id how = hdf5::datasetAccess(column.rowBytes() * static_cast<std::size_t>(column.chunkRows));
  s.dataset = hdf5::dataset(H5Dopen2(file.get(), column.path.c_str(), how.get()));
  if (!s.dataset.valid()) throw damaged(path_, column.path, "is missing or cannot be read");
  const Id type = hdf5::type(H5Dget_type(s.dataset.get()));
  if (H5Tequal(type.get(), s.type.get()) <= 0) throw damaged(path_, column.path, "has the wrong type");
  const Id space = hdf5::space(H5Dget_space(s.dataset.get()));
  const int rank = column.vector ? 2 : 1;
  std::array<hsize_t, 2> extent{};
  if (H5Sget_simple_extent_ndims(space.get()) != rank ||
      H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr) != rank ||
      (column.vector && extent[1] != column.width)) {
    throw damaged(path_, column.path, "has the wrong shape");
  }
  s.rows = extent[0];
  return s;
}

void ColumnReader::read(const Source& source, const Column& column, std::uint64_t first, std::uint64_t rows,
                        std::vector<std::byte>& out) const {
  out.resize(static_cast<std::size_t>(rows) * column.rowBytes());
  if (rows == 0 || column.width == 0) return;
  if (first + rows > source.rows) {
    throw damaged(path_, column.path,
                  fmt::format("holds {} rows where /status vouches for {}", source.rows, first + rows));
  }
  const std::array<hsize_t, 2> start{first, 0};
  const std::array<hsize_t, 2> count{rows, column.width};
  const Id fileSpace = hdf5::space(H5Dget_space(source.dataset.get()));
  const Id memorySpace = hdf5::space(H5Screate_simple(column.vector ? 2 : 1, count.data(), nullptr));
  if (H5Sselect_hyperslab(fileSpace.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dread(source.dataset.get(), source.type.get(), memorySpace.get(), fileSpace.get(), H5P_DEFAULT, out.data()) <
          0) {
    throw damaged(path_, column.path, fmt::format("rows {} to {}: {}", first, first + rows - 1, hdf5::reason()));
  }
}

void ColumnReader::readRows(std::size_t column, std::uint64_t first, std::uint64_t rows,
                            std::vector<std::byte>& out) const {
  read(source_[column], layout_.columns[column], first, rows, out);
}

StatusRow ColumnReader::readStatus(std::uint64_t row) const {
  std::vector<std::byte> bytes;
  read(status_, statusColumn_, row, 1, bytes);
  StatusRow out;
  if (!parseStatus(bytes, out)) throw damaged(path_, "/status", fmt::format("row {} has an unknown outcome", row));
  if (row == 0 && (out.ticks | out.steps | out.events | out.keyframes | out.keyframeWords) != 0) {
    throw damaged(path_, "/status", "row 0 does not start at nothing");
  }
  return out;
}

void ColumnReader::checkFollows(const StatusRow& before, const StatusRow& after, std::uint64_t row) const {
  const auto refuse = [&](const char* why) { throw damaged(path_, "/status", fmt::format("row {} {}", row, why)); };
  if (before.completed) refuse("comes after the end");
  if (after.ticks < before.ticks || after.steps < before.steps || after.events < before.events ||
      after.keyframes < before.keyframes || after.keyframeWords < before.keyframeWords) {
    refuse("counts less than the row before it");
  }
  const std::uint64_t steps = after.steps - before.steps;
  if (steps > layout_.stepsPerBlock) refuse("vouches for more than a flush can write");
  if (steps == 0 && !after.completed) refuse("vouches for nothing");
  if (after.ticks - before.ticks != steps * layout_.ticksPerStep) refuse("has ticks that do not fit its steps");
  if (after.keyframes - before.keyframes > steps) refuse("has more keyframes than steps");
  // Events have no bound of their own but the file's size; deflate cannot shrink keyframes more than 1032 to 1.
  if ((after.events - before.events) > fileBytes_ || (after.keyframeWords - before.keyframeWords) / 130 > fileBytes_) {
    refuse("claims more rows than the file can hold");
  }
}

void ColumnReader::readBlock(const StatusRow& before, const StatusRow& after, bool withKeyframes, Block& block) const {
  const std::array<std::uint64_t, streamCount> first{before.ticks, before.steps, before.events, before.keyframes,
                                                     before.keyframeWords};
  block.rows = {after.ticks - before.ticks, after.steps - before.steps, after.events - before.events,
                after.keyframes - before.keyframes, after.keyframeWords - before.keyframeWords};
  block.completed = after.completed;
  block.outcome = after.outcome;
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const auto stream = static_cast<std::size_t>(layout_.columns[c].stream);
    if (c == layout_.keyframeWords && !withKeyframes) {
      block.column[c].clear();
      continue;
    }
    read(source_[c], layout_.columns[c], first[stream], block.rows[stream], block.column[c]);
  }
}

}  // namespace calot::recorder
