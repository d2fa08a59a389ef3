// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/intake/intake.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "sim/math/fields.h"

namespace calot::analytics {
namespace {

/// Lines that count no more, above which they are dropped at the start.
constexpr std::uint64_t maxSpentLines = 1000;

std::string checkedLine(const nlohmann::ordered_json& row) {
  const std::string text = row.dump();
  return fmt::format("{{\"sum\":\"{:016x}\",\"row\":{}}}\n", digest64(std::as_bytes(std::span(text))), text);
}

/// The row of a line without its line feed, or nothing where the line is damaged.
std::optional<nlohmann::ordered_json> rowIn(const std::string& line) {
  const auto whole = nlohmann::ordered_json::parse(line, nullptr, false);
  if (!whole.is_object() || !whole.contains("row") || checkedLine(whole["row"]) != line + "\n") return std::nullopt;
  return whole["row"];
}

std::string journalHead() { return checkedLine({{"format", "calot-intake"}, {"format_version", 1}}); }

bool isUtf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// Paths are bytes, JSON is UTF-8: a path that is not UTF-8 stands in hexadecimal.
std::string lineOf(const std::string& file, const JournalEntry& e) {
  const bool plain = isUtf8(file);
  return checkedLine({{plain ? "file" : "file_hex", plain ? file : recorder::hexOf(file)},
                      {"bytes", e.state.bytes},
                      {"modified_ns", std::to_string(e.state.modified)},
                      {"inode", std::to_string(e.state.inode)},
                      {"tries", e.tries},
                      {"retry_at", e.retryAt},
                      {"other_version", e.otherVersion},
                      {"simulation_version", e.simulationVersion}});
}

/// A line's checksum was right, so that it holds what lineOf() wrote, or what another version wrote.
/// @throws nlohmann::json::exception
std::pair<std::string, JournalEntry> entryFrom(const nlohmann::ordered_json& row) {
  JournalEntry e;
  row.at("bytes").get_to(e.state.bytes);
  e.state.modified = std::strtoll(row.at("modified_ns").get<std::string>().c_str(), nullptr, 10);
  e.state.inode = std::strtoull(row.at("inode").get<std::string>().c_str(), nullptr, 10);
  row.at("tries").get_to(e.tries);
  row.at("retry_at").get_to(e.retryAt);
  row.at("other_version").get_to(e.otherVersion);
  row.at("simulation_version").get_to(e.simulationVersion);
  if (row.contains("file")) return {row.at("file").get<std::string>(), e};
  const auto& hex = row.at("file_hex").get_ref<const std::string&>();
  std::string file(hex.size() / 2, '\0');
  recorder::readHex(hex, std::as_writable_bytes(std::span(file)));
  return {file, e};
}

}  // namespace

/// A file that lines are appended to; one program at a time has it.
class IntakeJournal::LineAppender {
 public:
  explicit LineAppender(std::filesystem::path path) : path_(std::move(path)) {
    // Another program may rename the file between opening and locking: then what is locked is no longer this path's.
    while (file_ < 0) {
      file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
      if (file_ < 0) fail("cannot be opened");
      if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        const std::string why = errno == EWOULDBLOCK ? "another program is writing it"
                                : errno == ENOLCK    ? "its file system grants no locks, without which two programs "
                                                       "could write it; keep the journal on a local disk"
                                                     : std::strerror(errno);
        ::close(file_);
        throw Error(ErrorKind::failure, Where{path_.string()}, why);
      }
      struct stat ours {
      }, named{};
      if (::fstat(file_, &ours) != 0 || ::stat(path_.c_str(), &named) != 0 || ours.st_ino != named.st_ino) {
        ::close(file_);
        file_ = -1;
      }
    }
  }
  ~LineAppender() { ::close(file_); }
  LineAppender(const LineAppender&) = delete;
  LineAppender& operator=(const LineAppender&) = delete;

  /// Cuts the file behind what is good.
  void truncate(std::uint64_t size) {
    if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail("cannot be cut");
  }
  /// After it returned, the line outlives the program.
  void append(std::string_view line) {
    while (!line.empty()) {
      const ssize_t written = ::write(file_, line.data(), line.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("cannot be written");
      line.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  /// After it returned, all lines outlive the machine.
  void synchronize() {
    if (::fsync(file_) != 0) fail("cannot be written");
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("{}: {}", what, std::strerror(errno)));
  }
  std::filesystem::path path_;
  int file_ = -1;
};

FileState fileState(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0) return {};
  constexpr std::int64_t nanoseconds = 1'000'000'000;
  return {static_cast<std::uint64_t>(s.st_size), s.st_mtim.tv_sec * nanoseconds + s.st_mtim.tv_nsec, s.st_ino};
}

IntakeJournal::IntakeJournal(std::filesystem::path path) : path_(std::move(path)) {
  out_ = std::make_unique<LineAppender>(path_);
  load();
  if (lines_ > entries_.size() + maxSpentLines) compact();
}

IntakeJournal::~IntakeJournal() = default;

void IntakeJournal::load() {
  const std::string head = journalHead();
  std::ifstream in(path_, std::ios::binary);
  std::string line(head.size(), '\0');
  in.read(line.data(), static_cast<std::streamsize>(line.size()));
  if (in.gcount() == 0) {
    out_->append(head);
    return;
  }
  // A file that does not begin so may be anything: it is not emptied.
  if (line != head)
    throw Error(ErrorKind::damaged, Where{path_.string()}, "is not a journal of Calot; name another file");
  std::uint64_t good = head.size();
  while (std::getline(in, line) && !in.eof()) {  // one without its end was cut off
    try {
      auto [file, entry] = entryFrom(rowIn(line).value());
      entries_[std::move(file)] = entry;
    } catch (const std::exception&) {
      break;  // damaged from here on
    }
    good += line.size() + 1;
    ++lines_;
  }
  out_->truncate(good);
}

void IntakeJournal::compact() {
  std::filesystem::path fresh = path_;
  fresh += ".part";
  auto out = std::make_unique<LineAppender>(fresh);
  out->truncate(0);
  out->append(journalHead());
  std::erase_if(entries_, [](const auto& entry) {
    std::error_code error;
    return !std::filesystem::exists(entry.first, error) && !error;
  });
  for (const auto& [file, entry] : entries_) out->append(lineOf(file, entry));
  out->synchronize();
  if (std::rename(fresh.c_str(), path_.c_str()) != 0) {
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be replaced: {}", std::strerror(errno)));
  }
  out_ = std::move(out);
  lines_ = entries_.size();
}

const JournalEntry* IntakeJournal::find(const std::string& file) const {
  const auto at = entries_.find(file);
  return at == entries_.end() ? nullptr : &at->second;
}

void IntakeJournal::put(const std::string& file, const JournalEntry& entry) {
  out_->append(lineOf(file, entry));
  entries_[file] = entry;
  ++lines_;
}

}  // namespace calot::analytics
