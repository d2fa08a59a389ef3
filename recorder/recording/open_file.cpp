// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/open_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "recorder/base/errors.h"
#include "recorder/recording/shape.h"
#include "recorder/recording/types.h"

namespace calot::recorder {

using hdf5::Id;

Superblock readSuperblock(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ErrorKind::damaged, Where{path.string()}, "no such file");
  if (std::filesystem::is_directory(status))
    throw Error(ErrorKind::damaged, Where{path.string()}, "is a folder, not a recording");
  if (!std::filesystem::is_regular_file(status))
    throw Error(ErrorKind::damaged, Where{path.string()}, "is not a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorKind::damaged, Where{path.string()}, "cannot be opened; check its permissions");
  std::array<char, 36> head{};
  in.read(head.data(), head.size());
  if (in.gcount() == 0) throw Error(ErrorKind::damaged, Where{path.string()}, "is empty");
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  if (in.gcount() < static_cast<std::streamsize>(head.size()) ||
      !std::equal(signature.begin(), signature.end(), head.begin())) {
    throw Error(ErrorKind::damaged, Where{path.string()}, "is not an HDF5 file, so not a recording");
  }
  // HDF5 File Format Specification 3.0, II.A: byte 8 version, 9 size of offsets, 11 consistency flags, 28 end of file.
  Superblock s;
  s.version = static_cast<unsigned char>(head[8]);
  s.writing = s.version >= 2 && (static_cast<unsigned char>(head[11]) & 0x5U) != 0;
  if (s.version >= 2 && head[9] == 8) std::memcpy(&s.endOfFile, &head[28], sizeof s.endOfFile);
  return s;
}

namespace {

std::uint64_t sizeOfFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

}  // namespace

hdf5::Id openForReading(const std::filesystem::path& path, Access access) {
  const Superblock superblock = readSuperblock(path);
  const Id how = hdf5::fileAccess(access == Access::settled ? 1 : 0);
  const unsigned swmr = superblock.writing ? H5F_ACC_SWMR_READ : 0U;
  // Who has the file open already in this process decides how it is closed: another library of files has the default.
  for (const H5F_close_degree_t degree : {H5F_CLOSE_DEFAULT, H5F_CLOSE_STRONG}) {
    H5Pset_fclose_degree(how.get(), degree);
    const auto open = [&] { return hdf5::file(H5Fopen(path.c_str(), H5F_ACC_RDONLY | swmr, how.get())); };
    Id file = open();
    if (!file.valid()) continue;
    checkShape(path, file, sizeOfFile(path));
    if (!superblock.writing) return file;
    // What was looked at is remembered with the extents that it had then, and the file grows: it is forgotten.
    file.reset();
    file = open();
    if (file.valid()) return file;
  }
  const std::string why = hdf5::reason();
  const std::uint64_t bytes = sizeOfFile(path);
  if (superblock.endOfFile > bytes && !superblock.writing) {
    throw Error(ErrorKind::damaged, Where{path.string()},
                fmt::format("is cut off: {} of {} bytes are there", bytes, superblock.endOfFile), {Remedy::recover});
  }
  throw Error(ErrorKind::damaged, Where{path.string()}, fmt::format("cannot be opened: {}", why));
}

}  // namespace calot::recorder
