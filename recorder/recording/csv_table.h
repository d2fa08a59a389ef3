// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "sim/scene/samples.h"

namespace calot::recorder {

/// One CSV file (RFC 4180), written value by value under its own name in a folder. Numbers read back to the same bits.
class CsvTable {
 public:
  /// @param folder of the recording, "/ticks/left": the file is ticks_left.csv. @throws Error failure.
  CsvTable(const std::filesystem::path& stage, const std::string& folder);

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  void put(double v) { value("{:.17g}", v); }
  void put(float v) { value("{:.9g}", v); }
  void put(bool v) { value("{}", v ? 1 : 0); }
  template <class T>
  requires std::is_enum_v<T>
  void put(T v) { value("{}", static_cast<unsigned>(v)); }
  void put(const std::string& v);
  template <class T>
  requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) void put(T v) { value("{}", v); }

  /// @throws Error failure.
  void endRow();
  /// @throws Error failure.
  void close();

 private:
  template <class... Args>
  void value(fmt::format_string<Args...> format, Args&&... args) {
    if (!first_) line_.push_back(',');
    first_ = false;
    fmt::format_to(std::back_inserter(line_), format, std::forward<Args>(args)...);
  }
  [[noreturn]] void fail() const;

  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string folder_;
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  fmt::memory_buffer line_;
  bool first_ = true;
};

}  // namespace calot::recorder
