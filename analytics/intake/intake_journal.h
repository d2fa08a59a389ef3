// SPDX-License-Identifier: GPL-3.0-or-later
// Result for each file of a watched folder, kept over restarts (docs/how-to/cluster.md, "Watching a folder").
// Text files of one JSON row a line, each with a checksum, to which lines are appended: what was written before a
// program was killed is kept, and what was cut off or damaged is noticed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
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

/// State of a file, to detect changes.
struct FileState {
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< ns since 1970
  std::uint64_t inode = 0;
  bool operator==(const FileState&) const = default;
};
/// All zero where there is no such file.
FileState fileState(const std::filesystem::path& file);

struct JournalEntry {
  FileState state;
  std::uint32_t tries = 0;              ///< that failed, of this state; 0: it was decided
  std::int64_t retryAt = 0;             ///< s since 1970, where tries > 0
  bool otherVersion = false;            ///< undecided: of another simulation version than `simulationVersion`
  std::uint32_t simulationVersion = 0;  ///< of the program that decided
  bool operator==(const JournalEntry&) const = default;
};

/// One entry a file, the newest counts. Entries are appended as checked lines; a line that was cut off, and what comes
/// after damage, is dropped: those files are looked at again, and the cohort knows what it has. One program at a time
/// has the journal.
class IntakeJournal {
 public:
  /// Opens or makes it. @throws Error (failure), where another program has it or it cannot be written.
  explicit IntakeJournal(std::filesystem::path path);

  /// Null: nothing is known of the file.
  [[nodiscard]] const JournalEntry* find(const std::string& file) const;
  /// After it returned, the entry outlives the program. @throws Error (failure)
  void put(const std::string& file, const JournalEntry& entry);

 private:
  void load();
  /// Writes what counts into a new file, without files that are gone.
  void compact();

  std::filesystem::path path_;
  std::unique_ptr<LineAppender> out_;
  std::map<std::string, JournalEntry> entries_;
  std::uint64_t lines_ = 0;
};

}  // namespace calot::analytics
