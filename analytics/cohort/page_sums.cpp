// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/page_sums.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sodium.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace page_sums {
namespace {

constexpr int sumBytes = 8;
constexpr int headerBytes = 100;  // of the file, at its start
using Sum = std::array<unsigned char, sumBytes>;

thread_local std::optional<Error> newestFault;

sqlite3_vfs* below() {
  static sqlite3_vfs* const plain = sqlite3_vfs_find(nullptr);
  return plain;
}

/// A database's file. SQLite gives it memory, with that of the file below behind it.
struct SummedFile {
  sqlite3_file head;
  const char* path;
  int pageSize;
  bool sums;     ///< as the file's header says
  bool writing;  ///< the first page says that a commit is under way
  bool noLocks;  ///< the file system grants none
  bool held;     ///< by the folder that stands for them

  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
static_assert(sizeof(SummedFile) % alignof(sqlite3_int64) == 0);

SummedFile& of(sqlite3_file* file) { return *reinterpret_cast<SummedFile*>(file); }

template <auto method, class... Arguments>
int passed(sqlite3_file* file, Arguments... arguments) {
  sqlite3_file* real = of(file).real();
  return (real->pMethods->*method)(real, arguments...);
}

/// BLAKE2b-128 of the page but for its last 8 bytes, then its number: the first 8 bytes of that.
Sum sumOf(const unsigned char* page, int size, sqlite3_int64 at) {
  const auto number = static_cast<std::uint32_t>(at / size + 1);
  std::array<unsigned char, 4> last{};
  for (std::size_t i = 0; i < last.size(); ++i) last[i] = static_cast<unsigned char>(number >> (8 * i));
  crypto_generichash_state state;
  std::array<unsigned char, crypto_generichash_BYTES_MIN> digest{};
  crypto_generichash_init(&state, nullptr, 0, digest.size());
  crypto_generichash_update(&state, page, static_cast<unsigned long long>(size - sumBytes));
  crypto_generichash_update(&state, last.data(), last.size());
  crypto_generichash_final(&state, digest.data(), digest.size());
  Sum sum;
  std::copy_n(digest.begin(), sum.size(), sum.begin());
  return sum;
}

/// The first page ends with it while a commit is under way.
Sum inverted(Sum sum) {
  for (unsigned char& byte : sum) byte = static_cast<unsigned char>(~byte);
  return sum;
}

void noteHeader(SummedFile& file, const unsigned char* header) {
  file.pageSize = header[16] << 8 | header[17];
  if (file.pageSize == 1) file.pageSize = 65536;
  file.sums = header[20] == sumBytes;
  if (!file.sums) file.writing = false;  // what gave it sums is taken back
}

int readPage(sqlite3_file* f, void* to, int size, sqlite3_int64 at) {
  SummedFile& file = of(f);
  const int code = passed<&sqlite3_io_methods::xRead>(f, to, size, at);
  if (code != SQLITE_OK) return code;
  const auto* page = static_cast<const unsigned char*>(to);
  if (at == 0 && size >= headerBytes) noteHeader(file, page);
  if (!file.sums || size != file.pageSize || at % size != 0) return code;
  const Sum sum = sumOf(page, size, at);
  const auto is = [&](const Sum& other) { return std::memcmp(page + size - sumBytes, other.data(), sumBytes) == 0; };
  if (is(sum) || (at == 0 && file.writing && is(inverted(sum)))) return code;
  newestFault =
      at == 0 && is(inverted(sum))
          ? Error(ErrorKind::damaged, Where{file.path},
                  "is a copy that was taken while a program wrote to it; copy it again when no program has it open")
          : Error(
                ErrorKind::damaged, Where{file.path},
                fmt::format("page {} is not as Calot wrote it (its checksum differs): the file is damaged, or another "
                            "program has changed it; restore a copy, or assess the recordings into a new one",
                            at / size + 1));
  return SQLITE_IOERR_DATA;
}

/// Writes the first page's sum, or that a commit is under way.
int markFirstPage(sqlite3_file* f, bool writing) {
  SummedFile& file = of(f);
  std::vector<unsigned char> page(static_cast<std::size_t>(file.pageSize));
  const int code = passed<&sqlite3_io_methods::xRead>(f, static_cast<void*>(page.data()), file.pageSize, 0);
  if (code == SQLITE_IOERR_SHORT_READ) return SQLITE_OK;  // an empty file
  if (code != SQLITE_OK) return code;
  const Sum sum = sumOf(page.data(), file.pageSize, 0);
  file.writing = writing;
  return passed<&sqlite3_io_methods::xWrite>(f, static_cast<const void*>((writing ? inverted(sum) : sum).data()),
                                             sumBytes, file.pageSize - sumBytes);
}

/// The sum goes into SQLite's own copy of the page, too: a rollback journal has pages with their sums, so that any
/// program may take a commit back.
int writePage(sqlite3_file* f, const void* from, int size, sqlite3_int64 at) {
  SummedFile& file = of(f);
  auto* page = static_cast<unsigned char*>(const_cast<void*>(from));
  if (at == 0 && size >= headerBytes) noteHeader(file, page);
  if (file.sums && size == file.pageSize && at % size == 0) {
    if (!file.writing) {
      if (const int code = markFirstPage(f, true); code != SQLITE_OK) return code;
    }
    const Sum sum = sumOf(page, size, at);
    std::copy(sum.begin(), sum.end(), page + size - sumBytes);
  }
  const int code = passed<&sqlite3_io_methods::xWrite>(f, from, size, at);
  return code == SQLITE_OK && at == 0 && file.writing ? markFirstPage(f, true) : code;
}

/// SQLite syncs the file when all pages of a commit, or of one that it takes back, are written.
int sync(sqlite3_file* f, int flags) {
  if (of(f).writing) {
    if (const int code = markFirstPage(f, false); code != SQLITE_OK) return code;
  }
  return passed<&sqlite3_io_methods::xSync>(f, flags);
}

/// The folder that is the lock; its one file is named by who holds it, "HOST.PROCESS".
struct LockFolder {
  explicit LockFolder(const SummedFile& file) : folder(std::string(file.path) + ".lock"), host(256, '\0') {
    ::gethostname(host.data(), host.size() - 1);
    host.resize(std::strlen(host.c_str()));
    mine = fmt::format("{}/{}.{}", folder, host, ::getpid());
  }

  /// The name of its holder, empty where nobody knows.
  [[nodiscard]] std::string holder() const {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      return entry.path().filename().string();
    return {};
  }
  /// Its holder ran on this machine and is gone.
  [[nodiscard]] bool isStale(const std::string& holder) const {
    const std::size_t dot = holder.rfind('.');
    if (dot == std::string::npos || holder.substr(0, dot) != host) return false;
    const int process = std::atoi(holder.c_str() + dot + 1);
    return process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
  }

  int take() const {
    if (::mkdir(folder.c_str(), 0777) == 0) {
      const int made = ::open(mine.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0666);
      if (made < 0) return SQLITE_CANTOPEN;
      ::close(made);
      return SQLITE_OK;
    }
    if (errno == EROFS) return SQLITE_OK;  // nobody can write here
    if (errno != EEXIST) return SQLITE_PERM;
    const std::string who = holder();
    // Several may find it stale: one removes the file.
    if (isStale(who) && ::unlink((folder + "/" + who).c_str()) == 0) ::rmdir(folder.c_str());
    newestFault = Error(ErrorKind::failure, Where{folder},
                        fmt::format("the cohort database is in use by {}; try again when it has finished, or remove "
                                    "this folder if it runs no more",
                                    who.empty() ? "another program" : "process " + recorder::shown(who)));
    return SQLITE_BUSY;
  }
  void release() const {
    ::unlink(mine.c_str());
    ::rmdir(folder.c_str());
  }

  std::string folder, host, mine;
};

int lock(sqlite3_file* f, int level) {
  SummedFile& file = of(f);
  if (!file.noLocks) {
    errno = 0;
    const int code = passed<&sqlite3_io_methods::xLock>(f, level);
    file.noLocks = code == SQLITE_BUSY && errno == ENOLCK;
    if (!file.noLocks) return code;
  }
  if (file.held) return SQLITE_OK;
  const int code = LockFolder(file).take();
  file.held = code == SQLITE_OK;
  if (file.held) newestFault.reset();
  return code;
}

int unlock(sqlite3_file* f, int level) {
  SummedFile& file = of(f);
  if (file.writing) markFirstPage(f, false);
  if (!file.noLocks) return passed<&sqlite3_io_methods::xUnlock>(f, level);
  if (level == SQLITE_LOCK_NONE && std::exchange(file.held, false)) LockFolder(file).release();
  return SQLITE_OK;
}

int isReserved(sqlite3_file* f, int* answer) {
  if (!of(f).noLocks) return passed<&sqlite3_io_methods::xCheckReservedLock>(f, answer);
  *answer = 0;  // the folder has one holder
  return SQLITE_OK;
}

int close(sqlite3_file* f) {
  unlock(f, SQLITE_LOCK_NONE);
  return passed<&sqlite3_io_methods::xClose>(f);
}

/// SQLite shall neither read parts of pages nor leave pages to the file system.
int characteristics(sqlite3_file* f) {
  constexpr int subpageRead = 0x8000;  // of later versions of SQLite
  return passed<&sqlite3_io_methods::xDeviceCharacteristics>(f) & ~(SQLITE_IOCAP_BATCH_ATOMIC | subpageRead);
}

int sharedMap(sqlite3_file* f, int region, int size, int extend, void volatile** to) {
  SummedFile& file = of(f);
  if (!file.noLocks) return passed<&sqlite3_io_methods::xShmMap>(f, region, size, extend, to);
  newestFault = Error(ErrorKind::failure, Where{file.path},
                      "is of an older schema, and this file system grants no locks; copy it to a disk of this machine, "
                      "run calot cohort upgrade there, and copy it back");
  return SQLITE_IOERR_LOCK;
}

int openFile(sqlite3_vfs* /*layer*/, const char* path, sqlite3_file* f, int flags, int* opened) {
  if ((flags & SQLITE_OPEN_MAIN_DB) == 0) return below()->xOpen(below(), path, f, flags, opened);
  // No mapping into memory (version 3): pages must come through xRead.
  static const sqlite3_io_methods methods{
      .iVersion = 2,
      .xClose = close,
      .xRead = readPage,
      .xWrite = writePage,
      .xTruncate = passed<&sqlite3_io_methods::xTruncate>,
      .xSync = sync,
      .xFileSize = passed<&sqlite3_io_methods::xFileSize>,
      .xLock = lock,
      .xUnlock = unlock,
      .xCheckReservedLock = isReserved,
      .xFileControl = passed<&sqlite3_io_methods::xFileControl>,
      .xSectorSize = passed<&sqlite3_io_methods::xSectorSize>,
      .xDeviceCharacteristics = characteristics,
      .xShmMap = sharedMap,
      .xShmLock = passed<&sqlite3_io_methods::xShmLock>,
      .xShmBarrier = [](sqlite3_file* file) { of(file).real()->pMethods->xShmBarrier(of(file).real()); },
      .xShmUnmap = passed<&sqlite3_io_methods::xShmUnmap>,
      .xFetch = nullptr,
      .xUnfetch = nullptr};
  SummedFile& file = of(f);
  file = SummedFile{};
  file.path = path;
  const int code = below()->xOpen(below(), path, file.real(), flags, opened);
  if (code == SQLITE_OK) file.head.pMethods = &methods;
  return code;
}

}  // namespace
}  // namespace page_sums

const char* pageSumLayer() {
  using namespace page_sums;
  static sqlite3_vfs layer = [] {
    sqlite3_vfs made = *below();
    made.pNext = nullptr;
    made.zName = "calot-page-sums";
    made.szOsFile += static_cast<int>(sizeof(SummedFile));
    made.xOpen = openFile;
    return made;
  }();
  static const int registered = sqlite3_vfs_register(&layer, 0);
  return registered == SQLITE_OK ? layer.zName : nullptr;
}

bool hasPageSums(sqlite3* database) {
  using namespace page_sums;
  int reserved = -1;  // asks
  sqlite3_file_control(database, "main", SQLITE_FCNTL_RESERVE_BYTES, &reserved);
  return reserved == sumBytes;
}

void askForPageSums(sqlite3* database) {
  using namespace page_sums;
  int reserved = sumBytes;
  sqlite3_file_control(database, "main", SQLITE_FCNTL_RESERVE_BYTES, &reserved);
}

std::optional<Error> layersFault() { return std::exchange(page_sums::newestFault, std::nullopt); }

}  // namespace calot::analytics
