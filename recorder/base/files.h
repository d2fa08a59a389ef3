// SPDX-License-Identifier: GPL-3.0-or-later
// Files: whole ones read and written, those that only their owner may read, and where Calot's own are.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace calot::recorder {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& o) noexcept : number_(std::exchange(o.number_, -1)) {}
  Descriptor& operator=(Descriptor&& o) noexcept {
    close();
    number_ = std::exchange(o.number_, -1);
    return *this;
  }
  ~Descriptor() { close(); }

  [[nodiscard]] int get() const { return number_; }
  [[nodiscard]] bool valid() const { return number_ >= 0; }
  void close();

 private:
  int number_;
};

/// A whole file.
/// @param name what messages call it.
/// @param most bytes that such a file may have.
/// @throws Error (damaged), naming the file, where it is missing, a folder, unreadable, or larger.
std::vector<std::byte> readFileBytes(const std::filesystem::path& path, const std::string& name, std::size_t most);

/// Bytes in lower-case hexadecimal.
std::string hexOf(std::span<const std::byte> bytes);
template <class Range>
std::string hexOf(const Range& bytes) {
  return hexOf(std::span<const std::byte>(std::as_bytes(std::span(bytes))));
}
/// @return false unless the text is as many bytes in hexadecimal
bool readHex(std::string_view text, std::span<std::byte> out);

/// SHA-256 of bytes (FIPS 180-4).
std::array<std::byte, 32> sha256(std::span<const std::byte> bytes);
/// In lower-case hexadecimal, 64 characters.
std::string sha256Hex(std::span<const std::byte> bytes);

/// Bytes as base64 (RFC 4648, with padding).
std::string base64(std::span<const std::byte> bytes);

/// @throws Error damaged: not there, no regular file, larger than `most`; invalid: others than its owner may read or
/// write it.
std::string readSecret(const std::filesystem::path& path, std::size_t most);

/// Writes a file of mode 0600 as a whole: under a temporary name, to the disk, then renamed. @throws Error invalid: it
/// is there and `replace` is not set; failure: it cannot be written.
void writeSecret(const std::filesystem::path& path, std::string_view bytes, bool replace);

/// The path that writing to a path changes: the target of a link, which need not be there.
std::filesystem::path linkTarget(const std::filesystem::path& path);

/// @throws Error (invalid) where `path` is a folder, a device, a pipe or a socket, exists and `force` is not set, or
/// its folder does not exist: asked before long work whose result goes there.
void refuseOutput(const std::filesystem::path& path, bool force);

/// The name that a new file has until it is whole, in the same folder; that of the target of a link, which stays.
/// Removed with this object unless publish() came before.
class NewFile {
 public:
  /// @param ending of that name, behind the file's own @throws Error as refuseOutput
  NewFile(const std::filesystem::path& target, bool force, const std::string& ending = ".part");
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
  /// Renames in one move, if need be while the file is being written; without force it never replaces a file.
  /// @throws Error (invalid) where the target exists; (failure)
  void publish();

 private:
  std::filesystem::path target_, temporary_;
  bool force_;
};

/// A new folder that its owner alone may enter, removed with all that is in it.
class TemporaryFolder {
 public:
  /// Below TMPDIR. @throws Error (failure).
  TemporaryFolder();
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Writes a whole file as a NewFile, so that `path` is never half-written.
/// @throws Error (invalid) as refuseOutput; (failure) where writing fails, with the temporary file removed.
void writeText(const std::filesystem::path& path, std::string_view text, bool force);

/// Files FOLDER/NAME.json under the roots by their names, or those of another ending; the first root wins.
std::map<std::string, std::filesystem::path> filesIn(const std::vector<std::filesystem::path>& roots,
                                                     const std::string& folder, const char* ending = ".json");

/// One of these by its name, or a path that ends in ".json". @param what "scene" @param file "scene file", for messages
/// @throws Error (invalid) where there is none, with the names that there are
std::filesystem::path findJsonFile(const std::string& name, const std::vector<std::filesystem::path>& roots,
                                   const char* folder, const char* what, const char* file);

/// A folder of the user's, by the XDG base directory specification: what the variable names, else one below the home.
/// Relative ones are ignored; empty where there is neither.
std::filesystem::path userFolder(const char* variable, const char* belowHome);

/// The files that come with a program: scenes, organs, performers, forms, protocols, kept engines. They are found from
/// the program's own place, so that an installed tree can be moved: `<programs>/../share/calot`. A build tree has a
/// link there to the assets of the source.
class ProgramFiles {
 public:
  /// @param programs the folder of the programs
  explicit ProgramFiles(std::filesystem::path programs);
  static ProgramFiles ofThisProgram();

  [[nodiscard]] const std::filesystem::path& programs() const { return programs_; }
  /// Folders that may contain `scenes/`, `organs/`, `performers/` and so on, in order of precedence: CALOT_ASSETS of
  /// the environment alone where it is set.
  [[nodiscard]] std::vector<std::filesystem::path> assetRoots() const;
  /// The clone that a program of a build tree was built from; empty where there is none, as for installed programs.
  [[nodiscard]] std::filesystem::path clone() const;

 private:
  std::filesystem::path programs_;
};

}  // namespace calot::recorder
