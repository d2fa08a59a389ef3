// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/intake/intake_journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/json_reader.h"
#include "sim/math/fields.h"

namespace calot::analytics {
namespace {

constexpr std::string_view sumHead = R"({"sum":")", rowHead = R"(","row":)";
constexpr std::size_t sumDigits = 16;
constexpr std::size_t frameBytes = sumHead.size() + sumDigits + rowHead.size() + 1;  // and the closing brace

std::string sumOf(std::string_view row) {
  return fmt::format("{:016x}", digest64(std::as_bytes(std::span(row.data(), row.size()))));
}

}  // namespace

std::string checkedLine(const nlohmann::ordered_json& row) {
  const std::string text = row.dump();
  std::string line;
  line.reserve(text.size() + frameBytes + 1);
  line.append(sumHead).append(sumOf(text)).append(rowHead).append(text).append("}\n");
  if (line.size() > maxCheckedLine)
    throw Error(ErrorKind::failure,
                fmt::format("a row has {} bytes; at most {} can be read again", line.size(), maxCheckedLine));
  return line;
}

std::optional<std::string_view> rowIn(std::string_view line) {
  const bool framed = line.size() > frameBytes && line.substr(0, sumHead.size()) == sumHead &&
                      line.substr(sumHead.size() + sumDigits, rowHead.size()) == rowHead && line.back() == '}';
  if (!framed) return std::nullopt;
  const std::string_view row = line.substr(frameBytes - 1, line.size() - frameBytes);
  return line.substr(sumHead.size(), sumDigits) == sumOf(row) ? std::optional(row) : std::nullopt;
}

CheckedLineReader::CheckedLineReader(std::filesystem::path path)
    : path_(std::move(path)), in_(path_, std::ios::binary), buffer_(maxCheckedLine + 1) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path_, error) || !in_)
    throw Error(ErrorKind::damaged, Where{path_.string()}, "there is no such file, or it cannot be read");
}

std::optional<CheckedLine> CheckedLineReader::next() {
  const auto damaged = [&](const std::string& fault) {
    return Error(ErrorKind::damaged, Where{path_.string(), fmt::format("line {}", number_)}, fault);
  };
  in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  const auto read = static_cast<std::size_t>(in_.gcount());
  if (read == 0 && in_.eof()) return std::nullopt;
  CheckedLine line{++number_, offset_, offset_ + read, {}};
  if (in_.bad()) throw damaged("cannot be read");
  if (in_.eof()) throw damaged("is cut off");
  if (in_.fail()) throw damaged(fmt::format("has more than {} bytes", maxCheckedLine));
  offset_ = line.end;
  const auto row = rowIn(std::string_view(buffer_.data(), read - 1));  // without the line feed
  if (!row) throw damaged("is no row, or its checksum is wrong");
  line.row = *row;
  return line;
}

nlohmann::json CheckedLineReader::parse(const CheckedLine& line) const {
  try {
    return recorder::parseStrictJson(std::as_bytes(std::span(line.row.data(), line.row.size())), path_.string());
  } catch (const Error& e) {
    throw Error(e.kind(), Where{path_.string(), fmt::format("line {}", line.number)}, e.fault());
  }
}

LineAppender::LineAppender(std::filesystem::path path) : path_(std::move(path)) {
  // Another program may rename the file between opening and locking: then what is locked is no longer this path's.
  while (file_ < 0) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file_ < 0) fail("cannot be opened");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      const std::string why = taken ? "another program is writing it" : std::string(std::strerror(errno));
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

LineAppender::~LineAppender() { ::close(file_); }

void LineAppender::fail(const char* what) const {
  throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("{}: {}", what, std::strerror(errno)));
}

void LineAppender::truncate(std::uint64_t size) {
  if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail("cannot be cut");
}

void LineAppender::append(std::string_view line) {
  while (!line.empty()) {
    const ssize_t written = ::write(file_, line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written");
    line.remove_prefix(static_cast<std::size_t>(written));
  }
}

void LineAppender::synchronize() {
  if (::fsync(file_) != 0) fail("cannot be written");
}

namespace {

constexpr const char* journalFormat = "calot-intake";
/// Lines that count no more, above which they are dropped at the start.
constexpr std::uint64_t maxSpentLines = 1000;

nlohmann::ordered_json journalHeader() { return {{"format", journalFormat}, {"format_version", 1}}; }

/// Paths are bytes, JSON is UTF-8: a path that is none stands in hexadecimal.
std::string hexOf(const std::string& text) {
  std::string hex;
  for (const char c : text) hex += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return hex;
}

std::string fromHex(const std::string& hex) {
  std::string text;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    text += static_cast<char>(std::strtoul(hex.substr(i, 2).c_str(), nullptr, 16));
  return text;
}

bool isUtf8(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

nlohmann::ordered_json jsonOfEntry(const std::string& file, const JournalEntry& e) {
  nlohmann::ordered_json row;
  if (isUtf8(file)) {
    row["file"] = file;
  } else {
    row["file_hex"] = hexOf(file);
  }
  row["bytes"] = e.state.bytes;
  row["modified_ns"] = fmt::format("{}", e.state.modified);
  row["inode"] = fmt::format("{}", e.state.inode);
  row["tries"] = e.tries;
  row["retry_at"] = e.retryAt;
  row["other_version"] = e.otherVersion;
  row["simulation_version"] = e.simulationVersion;
  return row;
}

/// A line's checksum was right, so that it holds what jsonOfEntry() wrote, or what another version wrote.
std::pair<std::string, JournalEntry> entryFrom(const nlohmann::json& row, const std::string& journal) try {
  JournalEntry e;
  row.at("bytes").get_to(e.state.bytes);
  e.state.modified = std::strtoll(row.at("modified_ns").get<std::string>().c_str(), nullptr, 10);
  e.state.inode = std::strtoull(row.at("inode").get<std::string>().c_str(), nullptr, 10);
  row.at("tries").get_to(e.tries);
  row.at("retry_at").get_to(e.retryAt);
  row.at("other_version").get_to(e.otherVersion);
  row.at("simulation_version").get_to(e.simulationVersion);
  const bool plain = row.contains("file");
  const std::string file = row.at(plain ? "file" : "file_hex");
  return {plain ? file : fromHex(file), e};
} catch (const nlohmann::json::exception& e) {
  throw Error(ErrorKind::damaged, Where{journal}, e.what());
}

}  // namespace

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

void IntakeJournal::load() {
  std::uint64_t good = 0;
  bool foreign = false;
  try {
    CheckedLineReader in(path_);
    const std::optional<CheckedLine> first = in.next();
    if (first && in.parse(*first).value("format", nlohmann::json()) != journalFormat) foreign = true;
    if (first && !foreign) good = first->end;
    while (const std::optional<CheckedLine> line = foreign ? std::nullopt : in.next()) {
      auto [file, entry] = entryFrom(in.parse(*line), path_.string());
      entries_[std::move(file)] = entry;
      good = line->end;
      ++lines_;
    }
  } catch (const Error&) {
    // Cut off or damaged from here on. A file without any good line may be anything: it is not emptied.
    foreign = good == 0 && fileState(path_).bytes > 0;
  }
  if (foreign) throw Error(ErrorKind::damaged, Where{path_.string()}, "is no journal of Calot; name another file");
  out_->truncate(good);
  if (good == 0) out_->append(checkedLine(journalHeader()));
}

void IntakeJournal::compact() {
  std::filesystem::path fresh = path_;
  fresh += ".part";
  auto out = std::make_unique<LineAppender>(fresh);
  out->truncate(0);
  out->append(checkedLine(journalHeader()));
  std::erase_if(entries_, [](const auto& entry) {
    std::error_code error;
    return !std::filesystem::exists(entry.first, error) && !error;
  });
  for (const auto& [file, entry] : entries_) out->append(checkedLine(jsonOfEntry(file, entry)));
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
  out_->append(checkedLine(jsonOfEntry(file, entry)));
  entries_[file] = entry;
  ++lines_;
}

}  // namespace calot::analytics
