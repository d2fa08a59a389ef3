// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/file_driver.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>

namespace calot::recorder::hdf5 {

namespace {

constexpr const char* driverName = "calot-recording";

/// What the library holds of a file. Its own part comes first.
struct OpenFile {
  H5FD_t library{};
  int descriptor = -1;
  haddr_t allocated = 0, size = 0;  ///< end of what is given out, end of what was written
  dev_t device = 0;
  ino_t inode = 0;
  bool frozen = false;
};

OpenFile& of(H5FD_t* file) { return *reinterpret_cast<OpenFile*>(file); }
const OpenFile& of(const H5FD_t* file) { return *reinterpret_cast<const OpenFile*>(file); }

/// Puts the system's message on the library's stack of errors, in its own driver's words.
herr_t failed(const char* what, hid_t kind = H5E_WRITEERROR) {
  const int error = errno;
  // The name of the driver in the place of this file's, which would put the folder of the build into the program.
  H5Epush2(H5E_DEFAULT, driverName, __func__, __LINE__, H5E_ERR_CLS, H5E_IO, kind,
           "%s: errno = %d, error message = '%s'", what, error, std::strerror(error));
  return -1;
}

extern "C" {

H5FD_t* calotFileOpen(const char* name, unsigned flags, hid_t /*fileAccess*/, haddr_t /*most*/) {
  int how = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_TRUNC) != 0) how |= O_TRUNC;
  if ((flags & H5F_ACC_CREAT) != 0) how |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) how |= O_EXCL;
  auto file = std::make_unique<OpenFile>();
  file->descriptor = ::open(name, how | O_CLOEXEC, 0666);
  if (file->descriptor < 0) {
    failed("cannot open", H5E_CANTOPENFILE);
    return nullptr;
  }
  struct stat status {};
  if (::fstat(file->descriptor, &status) != 0) {
    failed("cannot look at it", H5E_CANTOPENFILE);
    ::close(file->descriptor);
    return nullptr;
  }
  file->size = static_cast<haddr_t>(status.st_size);
  file->device = status.st_dev;
  file->inode = status.st_ino;
  return &file.release()->library;
}

herr_t calotFileClose(H5FD_t* file) {
  const std::unique_ptr<OpenFile> owned(&of(file));
  return ::close(owned->descriptor) == 0 || owned->frozen ? 0 : failed("cannot close");
}

int calotFileCompare(const H5FD_t* a, const H5FD_t* b) {
  const OpenFile &l = of(a), &r = of(b);
  if (l.device != r.device) return l.device < r.device ? -1 : 1;
  if (l.inode != r.inode) return l.inode < r.inode ? -1 : 1;
  return 0;
}

herr_t calotFileQuery(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_POSIX_COMPAT_HANDLE | H5FD_FEAT_SUPPORTS_SWMR_IO |
           H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t calotFileAllocated(const H5FD_t* file, H5FD_mem_t /*type*/) { return of(file).allocated; }

herr_t calotFileAllocate(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t end) {
  of(file).allocated = end;
  return 0;
}

haddr_t calotFileSize(const H5FD_t* file, H5FD_mem_t /*type*/) { return of(file).size; }

herr_t calotFileHandle(H5FD_t* file, hid_t /*fileAccess*/, void** handle) {
  *handle = &of(file);
  return 0;
}

/// Beyond the end there are zeros.
herr_t calotFileRead(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t at, size_t bytes, void* out) {
  auto* to = static_cast<char*>(out);
  while (bytes > 0) {
    const ssize_t n = ::pread(of(file).descriptor, to, bytes, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failed("cannot read", H5E_READERROR);
    if (n == 0) {
      std::memset(to, 0, bytes);
      break;
    }
    to += n;
    at += static_cast<haddr_t>(n);
    bytes -= static_cast<size_t>(n);
  }
  return 0;
}

herr_t calotFileWrite(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t at, size_t bytes,
                      const void* values) {
  OpenFile& f = of(file);
  const auto* from = static_cast<const char*>(values);
  while (bytes > 0 && !f.frozen) {
    const ssize_t n = ::pwrite(f.descriptor, from, bytes, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failed("cannot write");
    from += n;
    at += static_cast<haddr_t>(n);
    bytes -= static_cast<size_t>(n);
  }
  f.size = std::max(f.size, at + bytes);
  return 0;
}

herr_t calotFileTruncate(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  OpenFile& f = of(file);
  if (f.allocated == f.size) return 0;
  if (!f.frozen && ::ftruncate(f.descriptor, static_cast<off_t>(f.allocated)) != 0) return failed("cannot extend");
  f.size = f.allocated;
  return 0;
}

herr_t calotFileLock(H5FD_t* file, hbool_t writing) {
  if (::flock(of(file).descriptor, (writing ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0 || errno == ENOSYS) return 0;
  return failed("cannot lock", H5E_CANTLOCKFILE);
}

herr_t calotFileUnlock(H5FD_t* file) {
  if (::flock(of(file).descriptor, LOCK_UN) == 0 || errno == ENOSYS) return 0;
  return failed("cannot unlock", H5E_CANTUNLOCKFILE);
}

herr_t calotFileTerminate();
}

const H5FD_class_t& driver() {
  static const H5FD_class_t d = [] {
    H5FD_class_t c{};
    c.name = driverName;
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
    // As the library's own POSIX driver: raw data apart from structure (H5FD_FLMAP_DICHOTOMY).
    constexpr H5FD_mem_t dichotomy[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(dichotomy), std::end(dichotomy), std::begin(c.fl_map));
    return c;
  }();
  return d;
}

hid_t registered = H5I_INVALID_HID;  // under the Session's lock

/// The library ends, or begins anew: the number means nothing then.
extern "C" herr_t calotFileTerminate() {
  registered = H5I_INVALID_HID;
  return 0;
}

}  // namespace

bool useOwnDriver(hid_t fileAccess) {
  if (registered < 0) registered = H5FDregister(&driver());
  return registered >= 0 && H5Pset_driver(fileAccess, registered, nullptr) >= 0;
}

void freeze(hid_t file) {
  const hid_t access = H5Fget_access_plist(file);
  const bool ours = access >= 0 && registered >= 0 && H5Pget_driver(access) == registered;
  if (access >= 0) H5Pclose(access);
  void* handle = nullptr;
  if (!ours || H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0 || handle == nullptr) return;
  static_cast<OpenFile*>(handle)->frozen = true;
  // A flush that failed leaves the library's list of what is to be written in disorder, over which the next one, that
  // of closing, would fail as well. One in between fails, too, but empties the list.
  H5Fflush(file, H5F_SCOPE_LOCAL);
}

}  // namespace calot::recorder::hdf5
