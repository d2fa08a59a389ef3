// SPDX-License-Identifier: GPL-3.0-or-later
// The two phases of writing a recording's file: creation of all objects, then appending of rows by a class that cannot
// create objects. Internal to this folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recorder/recording/block.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/station_key.h"

namespace calot::recorder {

/// Creates (or truncates) a file with root attributes, scene, every data set, and the first row of /status.
/// @param signer where the recording will be signed: whose key makes the signature.
/// @return that first row. @throws Error failure. Takes the HDF5 session itself.
StatusRow createRecordingFile(const std::filesystem::path& path, const AttemptHeader& header, const Layout& layout,
                              const PublicKey* signer = nullptr);

/// Checks what createRecordingFile asks of a header. @throws Error invalid naming the field.
void checkHeader(const AttemptHeader& header);

/// Appends blocks to a file that createRecordingFile made.
class FileAppender {
 public:
  /// @param first the row that createRecordingFile returned. @param swmr keep the file readable at every moment.
  /// @throws Error failure.
  FileAppender(const std::filesystem::path& path, const Layout& layout, const StatusRow& first, bool swmr);
  ~FileAppender();
  FileAppender(const FileAppender&) = delete;
  FileAppender& operator=(const FileAppender&) = delete;

  /// Writes a block's rows and flushes them, then the row of /status that covers them. `wallNanoseconds` is the row's
  /// time. @throws Error failure; from then on nothing changes the file any more.
  void append(const Block& block, std::int64_t wallNanoseconds);

  /// Writes the signature of the last row's chain head; nothing is appended after it. @pre the file was created with a
  /// signer. @throws Error failure.
  void sign(const Signature& signature);

  /// Closes the file. @throws Error failure.
  void close();

  [[nodiscard]] const StatusRow& last() const { return last_; }
  /// Does a lock keep other programs from writing it? Not on a file system that grants none.
  [[nodiscard]] bool locked() const { return locked_; }

 private:
  void write(const hdf5::Rows& set, std::uint64_t first, std::uint64_t rows, const void* values);
  [[noreturn]] void fail(const std::string& what, const std::string& why = hdf5::reason());

  std::filesystem::path path_;
  const Layout& layout_;
  bool swmr_ = false, locked_ = false;
  StatusRow last_;
  std::uint64_t statusRows_ = 1;
  Column signatureColumn_;
  struct Open {
    hdf5::Id file;
    std::vector<hdf5::Rows> columns;
    hdf5::Rows status, rawCounts;
    hdf5::Rows signature;  ///< where it will be signed
  } open_;
  std::vector<std::byte> packed_;
};

}  // namespace calot::recorder
