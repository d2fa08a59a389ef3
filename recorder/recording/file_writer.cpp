// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/file_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "recorder/base/files.h"
#include "recorder/recording/block.h"
#include "recorder/recording/file_reader.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

using hdf5::Id;

/// The kernel writes a page of its cache whole or not at all, whenever the process is killed.
constexpr hsize_t atomicBytes = 4096;

Column signatureColumn() {
  return {signaturePath, Element::u1, {}, false, 1, std::tuple_size_v<Signature>, 0, false, ""};
}

/// Creates objects in a file in memory, which is written plainly once complete: HDF5 does not always survive a disk
/// that fills up during creation. Every failure is an exception.
class Builder {
 public:
  Builder(const std::filesystem::path& path, unsigned deflate) : path_(path), deflate_(deflate) {
    const Id create = hdf5::properties(H5Pcreate(H5P_FILE_CREATE));
    // Attributes and links stay in the object headers, at the front of the file.
    H5Pset_attr_phase_change(create.get(), 64, 32);
    H5Pset_link_phase_change(create.get(), 64, 32);
    // No piece of structure lies across two pages: a writer that is killed leaves each as it was or as it became.
    H5Pset_file_space_strategy(create.get(), H5F_FSPACE_STRATEGY_PAGE, false, 1);
    H5Pset_file_space_page_size(create.get(), atomicBytes);
    const Id access = hdf5::fileAccess(0);
    H5Pset_fapl_core(access.get(), std::size_t{1} << 20U, false);
    file_ = hdf5::file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, create.get(), access.get()));
    need(file_.valid(), "the file");
  }

  [[nodiscard]] hid_t root() const { return file_.get(); }

  void group(const std::string& name) const {
    const Id create = hdf5::properties(H5Pcreate(H5P_GROUP_CREATE));
    H5Pset_link_phase_change(create.get(), 64, 32);
    H5Pset_obj_track_times(create.get(), false);
    const Id g = hdf5::group(H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, create.get(), H5P_DEFAULT));
    need(g.valid(), name);
  }

  void text(hid_t object, const char* name, const std::string& value) const {
    const Id type = hdf5::stringType(value.size());
    std::string padded = value;
    if (padded.empty()) padded.push_back('\0');
    attribute(object, name, type.get(), padded.data());
  }

  void attribute(hid_t object, const char* name, hid_t type, const void* value) const {
    const Id scalar = hdf5::space(H5Screate(H5S_SCALAR));
    const Id a = hdf5::attribute(H5Acreate2(object, name, type, scalar.get(), H5P_DEFAULT, H5P_DEFAULT));
    need(a.valid() && H5Awrite(a.get(), type, value) >= 0, name);
  }

  /// A data set of fixed size (`growing` false) or that starts empty and grows.
  [[nodiscard]] Id dataset(const std::string& path, hid_t type, std::vector<hsize_t> shape, hsize_t chunkRows,
                           unsigned deflate, bool growing) const {
    std::vector<hsize_t> most = shape;
    if (growing) most[0] = H5S_UNLIMITED;
    std::vector<hsize_t> chunk = shape;
    chunk[0] = std::max<hsize_t>(1, chunkRows);
    const Id space = hdf5::space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), most.data()));
    const Id create = hdf5::properties(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_chunk(create.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_obj_track_times(create.get(), false);
    if (deflate > 0) {
      H5Pset_shuffle(create.get());
      H5Pset_deflate(create.get(), deflate);
    }
    H5Pset_fletcher32(create.get());
    Id d =
        hdf5::dataset(H5Dcreate2(file_.get(), path.c_str(), type, space.get(), H5P_DEFAULT, create.get(), H5P_DEFAULT));
    need(d.valid(), path);
    return d;
  }

  /// A data set of the column's rows, still empty.
  void column(const Column& column) const {
    std::vector<hsize_t> shape{0};
    if (column.vector) shape.push_back(column.width);
    const Id type = hdf5::elementType(column.element);
    static_cast<void>(dataset(column.path, type.get(), shape, column.chunkRows, column.deflate, true));
  }

  /// A data set with its values.
  Id write(const std::string& path, hid_t type, hsize_t size, hsize_t chunkRows, const void* values,
           unsigned deflate = 0, bool growing = false) const {
    Id d = dataset(path, type, {size}, chunkRows, deflate, growing);
    need(size == 0 || H5Dwrite(d.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0, path);
    return d;
  }

  void bytes(const std::string& path, const Asset& asset) const {
    const hsize_t size = asset.bytes.size();
    const Id d = write(path, H5T_STD_U8LE, size, std::min<hsize_t>(size, 65536), asset.bytes.data(), deflate_);
    text(d.get(), "name", asset.name);
    text(d.get(), "sha256", sha256Hex(asset.bytes));
  }

  void names(const std::string& path, const std::vector<std::string>& names) const {
    if (names.empty()) return;
    std::size_t longest = 1;
    for (const std::string& n : names) longest = std::max(longest, n.size());
    std::string padded(longest * names.size(), '\0');
    for (std::size_t i = 0; i < names.size(); ++i) std::memcpy(&padded[i * longest], names[i].data(), names[i].size());
    write(path, hdf5::stringType(longest).get(), names.size(), names.size(), padded.data());
  }

  /// A data set of the column that grows, with its first row.
  void firstRow(const Column& column, const auto& row) const {
    std::vector<std::byte> packed;
    appendRow(row, packed);
    write(column.path, hdf5::elementType(column.element).get(), 1, column.chunkRows, packed.data(), 0, true);
  }

  void need(bool ok, const std::string& what) const {
    if (ok) return;
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot create {}: {}", what, hdf5::reason()));
  }

  /// Writes the file to its path.
  void close() {
    const std::string image = closedImage(file_);
    need(!image.empty(), "the file");
    std::ofstream out(path_, std::ios::binary | std::ios::trunc);
    out << image;
    out.close();
    if (!out)
      throw Error(ErrorKind::failure, Where{path_.string()},
                  fmt::format("cannot be written: {}", std::strerror(errno)));
  }

 private:
  std::filesystem::path path_;
  unsigned deflate_;
  Id file_;
};

void observables(Builder& builder, const AttemptHeader& header, const Layout& layout) {
  for (const char* name :
       {"/observables", "/observables/left", "/observables/right", "/observables/contact", "/keyframes"}) {
    builder.group(name);
  }
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId id) {
    if (layout.count[id] > 0) builder.group(Kind::results.path);
  });
  if (layout.procedure) builder.group("/observables/procedure");
  const Id g = hdf5::group(H5Gopen2(builder.root(), "/observables", H5P_DEFAULT));
  builder.attribute(g.get(), "version", H5T_STD_U32LE, &header.stepResultVersion);
}

/// The signer is known from the start; the signature comes with the last flush.
void signature(Builder& builder, const PublicKey& signer) {
  builder.group("/signature");
  builder.write(publicKeyPath, H5T_STD_U8LE, signer.size(), signer.size(), signer.data());
  builder.column(signatureColumn());
}

StatusRow build(Builder& builder, const AttemptHeader& header, const Layout& layout, const PublicKey* signer) {
  forEachAttribute(header, [&]<class T>(const char* name, const T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      builder.text(builder.root(), name, value);
    } else {
      builder.attribute(builder.root(), name, hdf5::elementType(storedAs<T>()).get(), &value);
    }
  });
  for (const char* name : {"/scene", "/scene/assets", "/ticks", "/ticks/left", "/ticks/right", "/camera", "/steps"}) {
    builder.group(name);
  }
  if (!layout.minimal) observables(builder, header, layout);
  if (layout.deviceSamples) {
    for (const char* name : {"/device", "/device/left", "/device/right"}) builder.group(name);
  }
  for (const Column& column : layout.columns) {
    if (column.width > 0) builder.column(column);
  }
  if (signer != nullptr) signature(builder, *signer);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) builder.names(namesPath<Kind>(), Kind::namesOf(header));
  });
  builder.names("/steps/component_names", header.layout.components);
  std::vector<std::string> fieldNames;
  std::vector<std::uint32_t> fieldComponents;
  for (const DigestLayout::Field& f : header.layout.fields) {
    fieldNames.push_back(f.name);
    fieldComponents.push_back(f.component);
  }
  builder.names("/steps/field_names", fieldNames);
  if (!fieldComponents.empty())
    builder.write("/steps/field_component", H5T_STD_U32LE, fieldComponents.size(), fieldComponents.size(),
                  fieldComponents.data());

  StatusRow first;
  first.chain = chainStart(header);
  builder.firstRow(layout.status, first);
  if (layout.deviceSamples) builder.firstRow(layout.rawCounts, RawCounts{});

  builder.bytes("/scene/description", header.assets.front());
  for (std::size_t i = 1; i < header.assets.size(); ++i) {
    builder.bytes(fmt::format("/scene/assets/{:03}", i), header.assets[i]);
  }
  return first;
}

}  // namespace

void checkHeader(const AttemptHeader& header) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::invalid, "recording: " + what); };
  if (header.formatVersion < oldestFormatVersion || header.formatVersion > formatVersion)
    refuse(fmt::format("format version {} cannot be written", header.formatVersion));
  if (header.attempt.size() != 36) refuse("the attempt's uuid is not 36 characters long");
  if (header.ticksPerStep < 1 || header.ticksPerStep > maxTicksPerStep) refuse("ticks a step must lie in 1..1000");
  if (!(header.tickSeconds > 0.0 && header.tickSeconds <= 1.0)) refuse("the tick's length must lie in (0, 1] s");
  if (header.structures().size() > maxStructures)
    refuse(fmt::format("more than {} structures (organs, vessels and bodies of fat)", maxStructures));
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) {
      if (Kind::results.since > header.stepResultVersion && !Kind::namesOf(header).empty())
        refuse(fmt::format("{} in a version of StepResult that does not have them", namesPath<Kind>()));
    }
  });
  if (header.layout.components.size() > 4096 || header.layout.fields.size() > 65536) refuse("too many digests");
  for (const DigestLayout::Field& f : header.layout.fields) {
    if (f.component >= header.layout.components.size())
      refuse("field " + f.name + " names a component that is not there");
  }
  if (header.assets.empty()) refuse("no scene");
  if (header.assets.size() > 1000) refuse("more than 999 assets beside the scene");
}

StatusRow createRecordingFile(const std::filesystem::path& path, const AttemptHeader& header, const Layout& layout,
                              const PublicKey* signer) {
  checkHeader(header);
  const hdf5::Session session;
  Builder builder(path, layout.deflateLevel);
  const StatusRow first = build(builder, header, layout, signer);
  builder.close();
  return first;
}

FileAppender::FileAppender(const std::filesystem::path& path, const Layout& layout, const StatusRow& first, bool swmr)
    : path_(path), layout_(layout), swmr_(swmr), last_(first), signatureColumn_(signatureColumn()) {
  const hdf5::Session session;
  const hdf5::Id access = hdf5::fileAccess(0);
  if (!hdf5::useOwnDriver(access.get())) fail("cannot be opened for writing");
  open_.file = hdf5::open(path, H5F_ACC_RDWR | (swmr ? H5F_ACC_SWMR_WRITE : 0U), access, &locked_);
  if (!open_.file.valid()) fail("cannot be opened for writing");
  const auto open = [this](const Column& column) {
    hdf5::Rows set(open_.file, column);
    if (column.width > 0 && !set.valid()) fail("cannot open " + column.path);
    return set;
  };
  for (const Column& column : layout.columns) open_.columns.push_back(open(column));
  open_.status = open(layout.status);
  if (H5Lexists(open_.file.get(), "/signature", H5P_DEFAULT) > 0) open_.signature = open(signatureColumn_);
  open_.rawCounts = open(layout.rawCounts);
}

FileAppender::~FileAppender() {
  const hdf5::Session session;
  const Open closing = std::move(open_);  // the file last
}

void FileAppender::fail(const std::string& what, const std::string& why) {
  hdf5::freeze(open_.file.get());
  throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("{}: {}", what, why));
}

void FileAppender::write(const hdf5::Rows& set, std::uint64_t first, std::uint64_t rows, const void* values) {
  if (const std::string why = set.append(first, rows, values); !why.empty())
    fail("cannot write " + set.column().path, why);
}

void FileAppender::append(const Block& block, std::int64_t wallNanoseconds) {
  StatusRow row;
  row.ticks = last_.ticks + block.rows[static_cast<std::size_t>(Stream::ticks)];
  row.steps = last_.steps + block.rows[static_cast<std::size_t>(Stream::steps)];
  row.events = last_.events + block.rows[static_cast<std::size_t>(Stream::events)];
  row.keyframes = last_.keyframes + block.rows[static_cast<std::size_t>(Stream::keyframes)];
  row.keyframeWords = last_.keyframeWords + block.rows[static_cast<std::size_t>(Stream::keyframeWords)];
  for (std::size_t h = 0; h < row.rawSamples.size(); ++h) {
    const Stream stream = layout_.columns[layout_.raw[h]].stream;
    row.rawSamples[h] = last_.rawSamples[h] + block.rows[static_cast<std::size_t>(stream)];
    row.rawDropped[h] = last_.rawDropped[h] + block.rawDropped[h];
  }
  row.completed = block.completed;
  row.outcome = block.outcome;
  row.wallNanoseconds = wallNanoseconds;
  row.chain = chainNext(layout_, last_, block, row);
  const std::array<std::uint64_t, streamCount> before = countsOf(last_);
  const hdf5::Session session;
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const Column& column = layout_.columns[c];
    const auto stream = static_cast<std::size_t>(column.stream);
    if (column.width == 0 || block.rows[stream] == 0) continue;
    assert(block.column[c].size() == block.rows[stream] * column.rowBytes());
    write(open_.columns[c], before[stream], block.rows[stream], block.column[c].data());
  }
  if (open_.rawCounts.valid()) {
    packed_.clear();
    appendRow(RawCounts{row.rawSamples, row.rawDropped}, packed_);
    write(open_.rawCounts, statusRows_, 1, packed_.data());
  }
  // The rows must be in the file before the row of /status that covers them.
  if (swmr_ && H5Fflush(open_.file.get(), H5F_SCOPE_LOCAL) < 0) fail("cannot flush");
  packed_.clear();
  appendRow(row, packed_);
  write(open_.status, statusRows_, 1, packed_.data());
  if (swmr_ && H5Dflush(open_.status.get()) < 0) fail("cannot flush /status");
  ++statusRows_;
  last_ = row;
}

void FileAppender::sign(const Signature& signature) {
  const hdf5::Session session;
  write(open_.signature, 0, signature.size(), signature.data());
}

void FileAppender::close() {
  const hdf5::Session session;
  const auto closeSet = [this](hdf5::Rows& set) {
    if (!set.close()) fail("cannot close " + set.column().path);
  };
  std::for_each(open_.columns.begin(), open_.columns.end(), closeSet);
  closeSet(open_.status);
  closeSet(open_.rawCounts);
  closeSet(open_.signature);
  if (H5Fflush(open_.file.get(), H5F_SCOPE_LOCAL) < 0) fail("cannot flush");
  if (!open_.file.reset())
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be closed: {}", hdf5::reason()));
}

}  // namespace calot::recorder
