// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/secret_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

/// Closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

Error failed(const std::filesystem::path& path, const char* what) {
  return {ErrorKind::failure, Where{path.string()}, fmt::format("{}: {}", what, std::strerror(errno))};
}

}  // namespace

std::string readSecret(const std::filesystem::path& path, std::size_t most) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0)
    throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("cannot be read: {}", std::strerror(errno)));
  if (!S_ISREG(status.st_mode)) throw Error(ErrorKind::damaged, Where{path.string()}, "is not a file");
  if ((status.st_mode & 077U) != 0) {
    throw Error(ErrorKind::invalid, Where{path.string()},
                "others than its owner may use it; take that away (chmod 600) and think of who has read it");
  }
  if (static_cast<std::uintmax_t>(status.st_size) > most)
    throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("is larger than {} bytes", most));
  std::string bytes;
  std::array<char, 4096> buffer;
  for (;;) {
    const ssize_t n = ::read(file.get(), buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw failed(path, "cannot be read");
    if (n == 0) return bytes;
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
    if (bytes.size() > most)
      throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("is larger than {} bytes", most));
  }
}

void writeSecret(const std::filesystem::path& path, std::string_view bytes, bool replace) {
  std::error_code error;
  if (!replace && std::filesystem::exists(std::filesystem::symlink_status(path, error)))
    throw Error(ErrorKind::invalid, Where{path.string()}, "is there already");
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.part", ::getpid());
  try {
    const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (file.get() < 0) throw failed(path, "cannot be written");
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t n = ::write(file.get(), bytes.data() + at, bytes.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) throw failed(path, "cannot be written");
      at += static_cast<std::size_t>(n);
    }
    if (::fsync(file.get()) != 0) throw failed(path, "cannot be written");
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  // A link fails if the name is taken: of two programs that create one file, the second does not overwrite the first's.
  const bool done =
      replace ? ::rename(temporary.c_str(), path.c_str()) == 0 : ::link(temporary.c_str(), path.c_str()) == 0;
  if (!done) {
    const Error why = failed(path, "cannot be written");
    ::unlink(temporary.c_str());
    throw why;
  }
  if (!replace) ::unlink(temporary.c_str());
}

}  // namespace calot::recorder
