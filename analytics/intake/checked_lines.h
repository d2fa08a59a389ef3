// SPDX-License-Identifier: GPL-3.0-or-later
// Text files of one JSON row a line, each with a checksum, to which lines are appended: what was written before a
// program was killed is kept, and what was cut off or damaged is noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace calot::analytics {

/// A line in bytes, its end included; as much as the reader of JSON takes.
inline constexpr std::size_t maxCheckedLine = std::size_t{4} << 20U;

/// `{"sum":"<XXH3-64 of the row's text, 16 hex digits>","row":<row>}` and a line feed. @throws Error (failure) where
/// the line would be too long to be read again.
std::string checkedLine(const nlohmann::ordered_json& row);

/// The text of the row in a line (without its line feed), or nothing where the line is damaged.
std::optional<std::string_view> rowIn(std::string_view line);

struct CheckedLine {
  std::uint64_t number = 0;  ///< from 1
  std::uint64_t offset = 0;  ///< of its first byte
  std::uint64_t end = 0;     ///< behind its line feed
  std::string row;           ///< text of the row; its checksum was right
};

/// Reads a file line by line, with bounded memory.
class CheckedLineReader {
 public:
  /// @throws Error (damaged) where the file is not there or cannot be read.
  explicit CheckedLineReader(std::filesystem::path path);

  /// The next line; nothing at the end. @throws Error (damaged), naming the line, for one that is cut off, too long, or
  /// of another checksum.
  std::optional<CheckedLine> next();

  /// A line's row, parsed strictly. @throws Error (damaged)
  [[nodiscard]] nlohmann::json parse(const CheckedLine& line) const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::ifstream in_;
  std::vector<char> buffer_;
  std::uint64_t offset_ = 0, number_ = 0;
};

/// A file that lines are appended to; one program at a time has it.
class LineAppender {
 public:
  /// Opens or makes it. @throws Error (failure), where another program has it too.
  explicit LineAppender(std::filesystem::path path);
  ~LineAppender();
  LineAppender(const LineAppender&) = delete;
  LineAppender& operator=(const LineAppender&) = delete;

  /// Cuts the file behind what is good.
  void truncate(std::uint64_t size);
  /// After it returned, the line outlives the program. @throws Error (failure)
  void append(std::string_view line);
  /// After it returned, all lines outlive the machine. @throws Error (failure)
  void synchronize();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace calot::analytics
