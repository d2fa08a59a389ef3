// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/sha.h>  // uses the processor's own instructions, as libsodium does not
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>  // mkdtemp
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {

void Descriptor::close() {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

std::vector<std::byte> readFileBytes(const std::filesystem::path& path, const std::string& name, std::size_t most) {
  std::error_code fault;
  const std::filesystem::file_status status = std::filesystem::status(path, fault);
  if (!std::filesystem::exists(status)) throw Error(ErrorKind::damaged, Where{name}, "there is no such file");
  if (std::filesystem::is_directory(status))
    throw Error(ErrorKind::damaged, Where{name}, "a folder; a file is expected");
  const auto tooLarge = [&] {
    return Error(ErrorKind::damaged, Where{name}, fmt::format("larger than {} bytes, which no such file is", most));
  };
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, fault) > most && !fault)
    throw tooLarge();
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorKind::damaged, Where{name}, "cannot be opened for reading");
  // Read piece by piece: a size that was asked for before would be wrong for a pipe or a growing file.
  std::vector<std::byte> bytes;
  std::array<char, 65536> piece{};
  while (in.read(piece.data(), piece.size()), in.gcount() > 0) {
    const auto* begin = reinterpret_cast<const std::byte*>(piece.data());
    bytes.insert(bytes.end(), begin, begin + in.gcount());
    if (bytes.size() > most) throw tooLarge();
  }
  if (in.bad()) throw Error(ErrorKind::damaged, Where{name}, "reading failed");
  return bytes;
}

std::string hexOf(std::span<const std::byte> bytes) {
  std::string hex(2 * bytes.size() + 1, '\0');
  sodium_bin2hex(hex.data(), hex.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  hex.pop_back();  // its zero
  return hex;
}

bool readHex(std::string_view text, std::span<std::byte> out) {
  std::size_t written = 0;
  return text.size() == 2 * out.size() &&
         sodium_hex2bin(reinterpret_cast<unsigned char*>(out.data()), out.size(), text.data(), text.size(), nullptr,
                        &written, nullptr) == 0 &&
         written == out.size();
}

std::array<std::byte, 32> sha256(std::span<const std::byte> bytes) {
  std::array<std::byte, SHA256_DIGEST_LENGTH> hash{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
         reinterpret_cast<unsigned char*>(hash.data()));
  return hash;
}

std::string sha256Hex(std::span<const std::byte> bytes) { return hexOf(sha256(bytes)); }

std::string base64(std::span<const std::byte> bytes) {
  std::string text(sodium_base64_ENCODED_LEN(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // its zero
  return text;
}

namespace {

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
    // A link fails if the name is taken: of two programs that create one file, the second spares the first's.
    if (::fsync(file.get()) != 0 ||
        (replace ? ::rename(temporary.c_str(), path.c_str()) : ::link(temporary.c_str(), path.c_str())) != 0)
      throw failed(path, "cannot be written");
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  if (!replace) ::unlink(temporary.c_str());
}

namespace fs = std::filesystem;

namespace {

Error alreadyThere(const fs::path& path) {
  return {ErrorKind::invalid, Where{path.string()}, "already exists", {Remedy::replaceExisting}};
}

}  // namespace

fs::path linkTarget(const fs::path& path) {
  constexpr int mostLinks = 40;  // as the kernel
  fs::path target = path;
  std::error_code ignored;
  for (int links = 0; links < mostLinks && fs::is_symlink(target, ignored); ++links)
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target;
}

void refuseOutput(const fs::path& path, bool force) {
  std::error_code ignored;
  const fs::file_status there = fs::status(path, ignored);
  if (fs::is_directory(there)) throw Error(ErrorKind::invalid, Where{path.string()}, "is a folder; name a file");
  if (fs::exists(there) && !fs::is_regular_file(there)) {
    throw Error(ErrorKind::invalid, Where{path.string()},
                "is a device, a pipe or a socket, which is never replaced; name a file");
  }
  if (!force && fs::exists(fs::symlink_status(path, ignored))) throw alreadyThere(path);
  const fs::path target = linkTarget(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ErrorKind::invalid, Where{path.string()}, fmt::format("folder {} does not exist", folder.string()));
  }
}

NewFile::NewFile(const fs::path& target, bool force, const std::string& ending)
    : target_(linkTarget(target)), temporary_(target_.string() + ending), force_(force) {
  refuseOutput(target, force_);
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void NewFile::publish() {
  int result = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), force_ ? 0U : RENAME_NOREPLACE);
  if (result != 0 && !force_ && errno == EINVAL) {  // a file system that cannot promise it
    refuseOutput(target_, force_);
    result = ::rename(temporary_.c_str(), target_.c_str());
  }
  if (result != 0 && errno == EEXIST) throw alreadyThere(target_);
  if (result != 0)
    throw Error(ErrorKind::failure, Where{target_.string()},
                fmt::format("cannot be renamed from {}: {}", temporary_.filename().string(), std::strerror(errno)));
  temporary_.clear();
}

TemporaryFolder::TemporaryFolder() {
  std::error_code fault;
  const fs::path place = fs::temp_directory_path(fault);
  std::string name = ((fault ? fs::path(".") : place) / "calot-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(ErrorKind::failure, Where{name}, "cannot be made: " + std::generic_category().message(errno));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

void writeText(const fs::path& path, std::string_view text, bool force) {
  NewFile made(path, force);
  std::FILE* file = std::fopen(made.path().c_str(), "wb");
  if (file == nullptr) throw failed(made.path(), "cannot be created");
  int fault = 0;
  if (std::fwrite(text.data(), 1, text.size(), file) != text.size()) fault = errno;
  if (fault == 0 && (std::fflush(file) != 0 || ::fsync(::fileno(file)) != 0)) fault = errno;
  if (std::fclose(file) != 0 && fault == 0) fault = errno;
  if (fault != 0)
    throw Error(ErrorKind::failure, Where{path.string()}, fmt::format("cannot be written: {}", std::strerror(fault)));
  made.publish();
}

std::map<std::string, fs::path> filesIn(const std::vector<fs::path>& roots, const std::string& folder,
                                        const char* ending) {
  std::map<std::string, fs::path> files;
  for (const fs::path& root : roots) {
    std::error_code fault;
    for (fs::directory_iterator it(root / folder, fault), end; !fault && it != end; it.increment(fault)) {
      if (it->path().extension() == ending) files.emplace(it->path().stem().string(), it->path());
    }
  }
  return files;
}

fs::path findJsonFile(const std::string& name, const std::vector<fs::path>& roots, const char* folder, const char* what,
                      const char* file) {
  std::error_code ignored;
  if (name.size() > 5 && name.ends_with(".json")) {
    if (fs::is_regular_file(name, ignored)) return name;
    throw Error(ErrorKind::invalid, Where{name}, fmt::format("there is no such {}", file));
  }
  const std::map<std::string, fs::path> files = filesIn(roots, folder);
  if (const auto found = files.find(name); found != files.end()) return found->second;
  std::vector<std::string> known;
  known.reserve(files.size());
  for (const auto& [each, path] : files) known.push_back(each);
  throw Error(ErrorKind::invalid,
              fmt::format("there is no {} \"{}\"{}; {}", what, name, didYouMean(name, known),
                          known.empty() ? std::string("no assets folder was found (set CALOT_ASSETS)")
                                        : fmt::format("there are {}", fmt::join(known, ", "))));
}

fs::path userFolder(const char* variable, const char* belowHome) {
  if (const char* named = std::getenv(variable); named != nullptr && *named == '/') return named;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') return fs::path(home) / belowHome;
  return {};
}

ProgramFiles::ProgramFiles(std::filesystem::path programs) : programs_(std::move(programs)) {}

ProgramFiles ProgramFiles::ofThisProgram() {
  std::error_code ignored;
  return ProgramFiles(std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path());
}

std::vector<std::filesystem::path> ProgramFiles::assetRoots() const {
  if (const char* named = std::getenv("CALOT_ASSETS"); named != nullptr && *named != '\0') return {named};
  return {(programs_ / ".." / "share" / "calot").lexically_normal()};
}

std::filesystem::path ProgramFiles::clone() const {
  std::error_code fault;
  const std::filesystem::path assets = std::filesystem::canonical(programs_ / ".." / "share" / "calot", fault);
  if (fault || !std::filesystem::is_regular_file(assets / ".." / "scripts" / "engine.py", fault)) return {};
  return assets.parent_path();
}

}  // namespace calot::recorder
