// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

#include "recorder/recording/block.h"

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
  if (text == std::strerror(EWOULDBLOCK)) return lockedByAnother;
  return text.empty() ? "unknown reason" : text;
}

namespace {

/// Also where this program has it open without a lock already.
bool grantsNoLock(const std::string& why) {
  return why == "file locking flag values don't match" || why == std::strerror(ENOLCK) ||
         why == std::strerror(EOPNOTSUPP) || why == std::strerror(ENOSYS);
}

}  // namespace

Error damaged(const std::filesystem::path& file, const std::string& place, const std::string& what) {
  return {ErrorKind::damaged, Where{file.string(), place}, what};
}

namespace {

hid_t numberOf(Element element) {
  switch (element) {
    case Element::u1:
      return H5T_STD_U8LE;
    case Element::u2:
      return H5T_STD_U16LE;
    case Element::u4:
      return H5T_STD_U32LE;
    case Element::u8:
      return H5T_STD_U64LE;
    case Element::i8:
      return H5T_STD_I64LE;
    case Element::f4:
      return H5T_IEEE_F32LE;
    default:
      return H5T_IEEE_F64LE;
  }
}

/// The compound of a row's fields, one after the other.
struct InsertFields {
  Id compound;
  std::size_t offset = 0;

  template <class T>
  void operator()(const char* name, const char* /*unit*/, const T& /*value*/) {
    if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, Quat>) {
      insertArray(name, Element::f8, sizeof(T) / sizeof(double));
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      insert(name, numberOf(storedAs<T>()));
    } else {
      insertArray(name, Element::u1, sizeof(T));
    }
  }

 private:
  void insert(const char* name, hid_t field) {
    H5Tinsert(compound.get(), name, offset, field);
    offset += H5Tget_size(field);
  }
  void insertArray(const char* name, Element element, hsize_t size) {
    insert(name, type(H5Tarray_create2(numberOf(element), 1, &size)).get());
  }
};

template <class Row>
Id rowType(Element element) {
  InsertFields fields{type(H5Tcreate(H5T_COMPOUND, elementBytes(element)))};
  const Row row{};
  visitRow(row, fields);
  assert(fields.offset == elementBytes(element));
  return std::move(fields.compound);
}

}  // namespace

Id elementType(Element element) {
  switch (element) {
    case Element::event:
      return rowType<Event>(element);
    case Element::keyframe:
      return rowType<KeyframeRow>(element);
    case Element::status:
      return rowType<StatusRow>(element);
    case Element::rawSample:
      return rowType<RawSample>(element);
    case Element::rawCounts:
      return rowType<RawCounts>(element);
    default:
      return type(H5Tcopy(numberOf(element)));
  }
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

Id open(const std::filesystem::path& path, unsigned flags, const Id& access, bool* locked) {
  Id opened;
  // Not under the library's lock: it takes ENOSYS alone for a file system without locks, and NFS says ENOLCK.
  for (const bool lock : {true, false}) {
    H5Pset_file_locking(access.get(), lock, true);
    if (locked != nullptr) *locked = lock;
    opened = file(H5Fopen(path.c_str(), flags, access.get()));
    if (opened.valid() || !grantsNoLock(reason())) break;
  }
  return opened;
}

Rows::Rows(const Id& file, const Column& column) : column_(&column), type_(elementType(column.element)) {
  if (column.width == 0) return;
  // A chunk cache that holds two chunks: whole chunks are written once.
  const Id access = properties(H5Pcreate(H5P_DATASET_ACCESS));
  const std::size_t chunkBytes = column.rowBytes() * static_cast<std::size_t>(column.chunkRows);
  H5Pset_chunk_cache(access.get(), 3, 2 * chunkBytes, 1.0);
  dataset_ = dataset(H5Dopen2(file.get(), column.path.c_str(), access.get()));
}

std::string Rows::measure() {
  if (column_->width == 0) return "";
  if (!valid()) return "is missing or cannot be read";
  const Id stored = type(H5Dget_type(dataset_.get()));
  if (H5Tequal(stored.get(), type_.get()) <= 0) return "has the wrong type";
  const Id extent = space(H5Dget_space(dataset_.get()));
  std::array<hsize_t, 2> size{};
  if (H5Sget_simple_extent_ndims(extent.get()) != rank() ||
      H5Sget_simple_extent_dims(extent.get(), size.data(), nullptr) != rank() ||
      (column_->vector && size[1] != column_->width))
    return "has the wrong shape";
  count_ = size[0];
  return "";
}

std::pair<Id, Id> Rows::select(std::uint64_t first, std::uint64_t rows) const {
  const std::array<hsize_t, 2> start{first, 0};
  const std::array<hsize_t, 2> count{rows, column_->width};
  std::pair<Id, Id> spaces{space(H5Screate_simple(rank(), count.data(), nullptr)), space(H5Dget_space(dataset_.get()))};
  // A failure is one of reading or writing, too.
  H5Sselect_hyperslab(spaces.second.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  return spaces;
}

std::string Rows::read(std::uint64_t first, std::uint64_t rows, void* out) const {
  const auto [memory, file] = select(first, rows);
  const bool done = H5Dread(dataset_.get(), type_.get(), memory.get(), file.get(), H5P_DEFAULT, out) >= 0;
  return done ? "" : reason();
}

std::string Rows::append(std::uint64_t first, std::uint64_t rows, const void* values) const {
  const std::array<hsize_t, 2> extent{first + rows, column_->width};
  if (H5Dset_extent(dataset_.get(), extent.data()) < 0) return reason();
  const auto [memory, file] = select(first, rows);
  const bool done = H5Dwrite(dataset_.get(), type_.get(), memory.get(), file.get(), H5P_DEFAULT, values) >= 0;
  return done ? "" : reason();
}

namespace {

/// State that the library holds of a file. Its own part comes first.
struct OpenFile {
  H5FD_t library{};
  H5FD_t* plain = nullptr;  ///< the same file by the library's own driver
  bool frozen = false;
};

OpenFile& of(H5FD_t* file) { return *reinterpret_cast<OpenFile*>(file); }
H5FD_t* plainOf(const H5FD_t* file) { return reinterpret_cast<const OpenFile*>(file)->plain; }

hid_t registered = H5I_INVALID_HID;  // under the Session's lock

extern "C" {

H5FD_t* calotFileOpen(const char* name, unsigned flags, hid_t /*fileAccess*/, haddr_t most) {
  const Id access = properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fapl_sec2(access.get());
  H5FD_t* const plain = H5FDopen(name, flags, access.get(), most);
  return plain == nullptr ? nullptr : &(new OpenFile{{}, plain})->library;
}

herr_t calotFileClose(H5FD_t* file) {
  const std::unique_ptr<OpenFile> owned(&of(file));
  // Closing begins a new list of errors: where a file could not be opened, it would hide why.
  const hid_t errors = H5Eget_current_stack();
  const bool closed = H5FDclose(owned->plain) >= 0;
  closed ? H5Eset_current_stack(errors) : H5Eclose_stack(errors);
  return closed || owned->frozen ? 0 : -1;
}

int calotFileCompare(const H5FD_t* a, const H5FD_t* b) { return H5FDcmp(plainOf(a), plainOf(b)); }
haddr_t calotFileAllocated(const H5FD_t* file, H5FD_mem_t kind) { return H5FDget_eoa(plainOf(file), kind); }
herr_t calotFileAllocate(H5FD_t* file, H5FD_mem_t kind, haddr_t end) { return H5FDset_eoa(plainOf(file), kind, end); }
haddr_t calotFileSize(const H5FD_t* file, H5FD_mem_t kind) { return H5FDget_eof(plainOf(file), kind); }

/// Those of the library's own driver, also before a file is open.
herr_t calotFileQuery(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_POSIX_COMPAT_HANDLE | H5FD_FEAT_SUPPORTS_SWMR_IO |
           H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

herr_t calotFileHandle(H5FD_t* file, hid_t /*fileAccess*/, void** handle) {
  *handle = &of(file);
  return 0;
}

herr_t calotFileRead(H5FD_t* file, H5FD_mem_t kind, hid_t transfer, haddr_t at, size_t bytes, void* out) {
  return H5FDread(plainOf(file), kind, transfer, at, bytes, out);
}

herr_t calotFileWrite(H5FD_t* file, H5FD_mem_t kind, hid_t transfer, haddr_t at, size_t bytes, const void* values) {
  return of(file).frozen ? 0 : H5FDwrite(plainOf(file), kind, transfer, at, bytes, values);
}

herr_t calotFileTruncate(H5FD_t* file, hid_t transfer, hbool_t closing) {
  return of(file).frozen ? 0 : H5FDtruncate(plainOf(file), transfer, closing);
}

herr_t calotFileLock(H5FD_t* file, hbool_t writing) { return H5FDlock(plainOf(file), writing); }
herr_t calotFileUnlock(H5FD_t* file) { return H5FDunlock(plainOf(file)); }

/// The library ends, or begins again: the number means nothing then.
herr_t calotFileTerminate() {
  registered = H5I_INVALID_HID;
  return 0;
}
}

H5FD_class_t driver() {
  H5FD_class_t c{};
  c.name = "calot-recording";
  c.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  c.fc_degree = H5F_CLOSE_WEAK;
  c.terminate = calotFileTerminate;
  c.open = calotFileOpen;
  c.close = calotFileClose;
  c.cmp = calotFileCompare;
  c.query = calotFileQuery;
  c.get_eoa = calotFileAllocated;
  c.set_eoa = calotFileAllocate;
  c.get_eof = calotFileSize;
  c.get_handle = calotFileHandle;
  c.read = calotFileRead;
  c.write = calotFileWrite;
  c.truncate = calotFileTruncate;
  c.lock = calotFileLock;
  c.unlock = calotFileUnlock;
  // As the library's own driver: raw data apart from structure (H5FD_FLMAP_DICHOTOMY).
  constexpr H5FD_mem_t dichotomy[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(dichotomy), std::end(dichotomy), std::begin(c.fl_map));
  return c;
}

}  // namespace

bool useOwnDriver(hid_t fileAccess) {
  static const H5FD_class_t own = driver();
  if (registered < 0) registered = H5FDregister(&own);
  return registered >= 0 && H5Pset_driver(fileAccess, registered, nullptr) >= 0;
}

void freeze(hid_t file) {
  void* handle = nullptr;
  const Id access = properties(H5Fget_access_plist(file));
  const bool ours = access.valid() && registered >= 0 && H5Pget_driver(access.get()) == registered;
  if (!ours || H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0 || handle == nullptr) return;
  static_cast<OpenFile*>(handle)->frozen = true;
  // A flush that failed leaves the library's list of what is to be written in disorder, over which the next one, that
  // of closing, would fail as well. One in between fails, too, but empties the list.
  H5Fflush(file, H5F_SCOPE_LOCAL);
}

}  // namespace calot::recorder::hdf5
