// SPDX-License-Identifier: GPL-3.0-or-later
// Thin layer over the HDF5 C API: handles that close themselves, one lock for the process, errors as text; types and
// property lists of the recording. Internal to this folder.
#pragma once

#include <hdf5.h>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"

namespace calot::recorder::hdf5 {

/// One HDF5 identifier, closed by the function that fits its kind.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  Id(Id&& o) noexcept : id_(std::exchange(o.id_, -1)), close_(o.close_) {}
  Id& operator=(Id&& o) noexcept {
    if (this != &o) {
      reset();
      id_ = std::exchange(o.id_, -1);
      close_ = o.close_;
    }
    return *this;
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  ~Id() { reset(); }

  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  /// Closes now. @return false if closing failed (for a file: what was not yet written could not be).
  bool reset() {
    const hid_t id = std::exchange(id_, -1);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

inline Id file(hid_t id) { return {id, H5Fclose}; }
inline Id group(hid_t id) { return {id, H5Gclose}; }
inline Id dataset(hid_t id) { return {id, H5Dclose}; }
inline Id space(hid_t id) { return {id, H5Sclose}; }
inline Id type(hid_t id) { return {id, H5Tclose}; }
inline Id attribute(hid_t id) { return {id, H5Aclose}; }
inline Id properties(hid_t id) { return {id, H5Pclose}; }

/// Lock for calls to HDF5 from this folder: disables HDF5's own error printing and ensures that a fork never interrupts
/// the library. Not recursive.
class Session {
 public:
  Session();

 private:
  std::unique_lock<std::mutex> lock_;
};

/// The process-wide lock under Session.
std::mutex& processLock();

/// The reason where another program has the lock.
inline constexpr const char* lockedByAnother = "another program has it open; end that one, or wait for it";

/// Reason why the last HDF5 call of this thread failed: "bad checksum", lockedByAnother, the system's message ("No
/// space left on device"), or the innermost description.
std::string reason();

/// Message of a damaged file: FILE: PLACE: WHAT.
Error damaged(const std::filesystem::path& file, const std::string& place, const std::string& what);

/// The stored type of an element.
Id elementType(Element element);

/// Fixed-length UTF-8 string, padded with NUL; one byte at least.
Id stringType(std::size_t bytes);

/// Access with V110 bounds. @param metadataAttempts for SWMR readers; 0: the library's default.
Id fileAccess(unsigned metadataAttempts);

/// Opens a file under the library's lock of it, or without one where the file system grants none.
/// @param access whose lock is set by this. @param[out] locked may be null. @return invalid where it cannot be opened:
/// reason() says why
Id open(const std::filesystem::path& path, unsigned flags, const Id& access, bool* locked = nullptr);

/// The data set of a column, read and written by whole rows.
class Rows {
 public:
  Rows() = default;
  /// Opens it, where the column has a width. @param column outlives this
  Rows(const Id& file, const Column& column);

  [[nodiscard]] bool valid() const { return dataset_.valid(); }
  [[nodiscard]] hid_t get() const { return dataset_.get(); }
  [[nodiscard]] const Column& column() const { return *column_; }
  /// Checks existence, type and shape of a column that has a width, and counts its rows. @return what is wrong, or
  /// empty
  std::string measure();
  /// Rows that it had then.
  [[nodiscard]] std::uint64_t count() const { return count_; }

  /// @return reason() of a failure, or empty
  [[nodiscard]] std::string read(std::uint64_t first, std::uint64_t rows, void* out) const;
  /// Writes rows behind the first ones. @return as read()
  [[nodiscard]] std::string append(std::uint64_t first, std::uint64_t rows, const void* values) const;
  /// @return false if closing failed
  bool close() { return dataset_.reset(); }

 private:
  [[nodiscard]] int rank() const { return column_->vector ? 2 : 1; }
  /// Spaces of these rows in memory and in the file.
  [[nodiscard]] std::pair<Id, Id> select(std::uint64_t first, std::uint64_t rows) const;

  const Column* column_ = nullptr;
  Id type_, dataset_;
  std::uint64_t count_ = 0;
};

/// Sets a driver of our own for a file that is opened with these properties: the library's own, but that nothing is
/// written any more after freeze().
///
/// A file whose disk is full must stay as it is: the library goes on trying to write its cache until the file is
/// closed, in an order that endangers what was flushed. It must be closed all the same, or the library is left with
/// half of it when the program ends; so what is written then succeeds and goes nowhere.
/// @return false where the library refuses
bool useOwnDriver(hid_t fileAccess);

/// From now on nothing is written to this file. Nothing happens where it was not opened by that driver.
void freeze(hid_t file);

}  // namespace calot::recorder::hdf5
