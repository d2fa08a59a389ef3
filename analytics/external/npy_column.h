// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace calot::analytics {

/// One array in NumPy's file format 1.0 (NEP 1), written row by row: little-endian, in C order. Whole numbers are
/// int64, all others float64.
class NpyColumn {
 public:
  /// @param width numbers of a row; 0: the array has one dimension. @throws Error (failure), as all functions here
  NpyColumn(std::filesystem::path path, bool whole, std::size_t width);

  void put(double value);
  void put(std::int64_t value);
  /// Forgets all rows. @pre they are few: none was written yet
  void clear();
  /// Writes what is left, and the number of rows into the head. @pre rows are whole.
  void close();

 private:
  void flush();
  void writeHead();
  [[noreturn]] void fail() const;

  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  bool whole_;
  std::size_t width_;
  std::uint64_t numbers_ = 0;
  std::vector<std::uint64_t> waiting_;  ///< bits of the numbers
};

}  // namespace calot::analytics
