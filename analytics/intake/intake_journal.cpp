// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/intake_journal.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::analytics {
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
