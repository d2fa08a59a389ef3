// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/intake_journal.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "analytics/shards/row_text.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr const char* journalFormat = "calot-intake";
/// Lines that count no more, above which they are dropped at the start.
constexpr std::uint64_t maxSpentLines = 1000;

nlohmann::ordered_json journalHeader() { return {{"format", journalFormat}, {"format_version", 1}}; }

nlohmann::ordered_json jsonOfEntry(const std::string& file, const JournalEntry& e) {
  nlohmann::ordered_json row;
  putText(row, "file", file);
  row["bytes"] = e.state.bytes;
  row["modified_ns"] = fmt::format("{}", e.state.modified);
  row["inode"] = fmt::format("{}", e.state.inode);
  row["tries"] = e.tries;
  row["retry_at"] = e.retryAt;
  row["other_version"] = e.otherVersion;
  row["simulation_version"] = e.simulationVersion;
  return row;
}

std::pair<std::string, JournalEntry> entryFrom(const nlohmann::json& json, const std::string& journal) {
  static const recorder::ObjectRule rule = [] {
    recorder::ObjectRule made{"entry", textKeys("file")};
    for (const char* count : {"bytes", "tries", "retry_at", "simulation_version"}) made.keys.push_back(countKey(count));
    for (const char* key : {"modified_ns", "inode", "other_version"}) made.keys.push_back({key});
    return made;
  }();
  const recorder::JsonObject o = recorder::JsonPlace(json, journal).object(rule);
  std::string modified, inode;
  JournalEntry e;
  e.state.bytes = takeCount(o, "bytes");
  o.read("modified_ns", modified, maxRowText);
  o.read("inode", inode, maxRowText);
  e.state.modified = std::strtoll(modified.c_str(), nullptr, 10);
  e.state.inode = std::strtoull(inode.c_str(), nullptr, 10);
  e.tries = static_cast<std::uint32_t>(takeCount(o, "tries"));
  e.retryAt = static_cast<std::int64_t>(takeCount(o, "retry_at"));
  o.read("other_version", e.otherVersion);
  e.simulationVersion = static_cast<std::uint32_t>(takeCount(o, "simulation_version"));
  return {takeText(o, "file"), e};
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
