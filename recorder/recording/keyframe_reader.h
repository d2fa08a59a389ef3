// SPDX-License-Identifier: GPL-3.0-or-later
// Reading the keyframes of a recording, of either format version. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/recording/column_reader.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/rows.h"

namespace calot::recorder {

class KeyframeReader {
 public:
  /// Reads and checks the index. The caller holds the HDF5 session. Layout and columns outlive the reader.
  /// @throws Error damaged
  KeyframeReader(std::filesystem::path path, const Layout& layout, const ColumnReader& columns, const StatusRow& last);

  /// Steps after which there is a keyframe, rising.
  [[nodiscard]] const std::vector<std::uint64_t>& steps() const { return steps_; }

  /// Takes the HDF5 session itself. Keeps what the next ones will be compared with, so that reading in order is cheap.
  /// @throws Error damaged
  Keyframe read(std::size_t index);

 private:
  struct Known {
    std::vector<std::byte> bytes;
    std::optional<std::uint64_t> base;
  };
  [[nodiscard]] std::vector<std::byte> plain(std::size_t index) const;
  [[nodiscard]] std::vector<std::byte> words(std::size_t index) const;
  const std::vector<std::byte>& decoded(std::size_t index);
  /// Keeps what the way to a keyframe needs.
  void forgetAllBut(std::size_t index);
  [[nodiscard]] Error refused(std::size_t index, const std::string& why) const;

  std::filesystem::path path_;
  const Layout& layout_;
  const ColumnReader& columns_;
  std::uint64_t totalWords_;
  std::vector<KeyframeRow> rows_;
  std::vector<std::uint64_t> steps_;
  std::map<std::size_t, Known> known_;
};

}  // namespace calot::recorder
