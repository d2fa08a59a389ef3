// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/recording/support/torn_writes.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <thread>

namespace {

constexpr off_t page = 4096;
std::chrono::microseconds restBetweenPages{0};

ssize_t plainWrite(int file, const void* bytes, size_t count, off_t at) {
  return ::syscall(SYS_pwrite64, file, bytes, count, at);
}

}  // namespace

/// Stands in for the C library's function in this program, for the libraries that it loads, too.
extern "C" ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  const off_t boundary = (at / page + 1) * page;
  if (restBetweenPages.count() == 0 || at + static_cast<off_t>(count) <= boundary)
    return plainWrite(file, bytes, count, at);
  const auto head = static_cast<size_t>(boundary - at);
  const ssize_t first = plainWrite(file, bytes, head, at);
  if (first != static_cast<ssize_t>(head)) return first;
  std::this_thread::sleep_for(restBetweenPages);
  const ssize_t second = plainWrite(file, static_cast<const char*>(bytes) + head, count - head, boundary);
  return second < 0 ? second : first + second;
}

namespace calot::recorder::test {

void tearWrites(std::chrono::microseconds rest) { restBetweenPages = rest; }

}  // namespace calot::recorder::test
