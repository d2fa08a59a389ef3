// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/values_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "analytics/shards/checked_lines.h"
#include "recorder/base/json_reader.h"

namespace calot::analytics {
namespace {

/// A fault of a row, with the line that it is in.
Error inLine(const Error& e, const std::filesystem::path& path, std::uint64_t line) {
  const std::string place = e.where().place.empty() || e.where().place == "/" ? "" : e.where().place + ": ";
  return {e.kind(), Where{path.string(), fmt::format("line {}", line)}, place + e.fault(), e.remedies()};
}

/// The number in the last row, or nothing where it is no last row.
std::optional<std::uint64_t> endOf(const nlohmann::json& row) {
  if (!row.is_object() || row.size() != 1) return std::nullopt;
  const nlohmann::json end = row.value("end", nlohmann::json());
  return end.is_number_unsigned() ? std::optional(end.get<std::uint64_t>()) : std::nullopt;
}

/// Lines of many files in any order: few systems let a program have thousands of files open.
class LinesByLocation {
 public:
  /// The line without its end; cut short where the file is.
  std::string line(const std::filesystem::path& path, std::uint64_t offset, std::uint32_t bytes) {
    std::ifstream& in = open(path);
    std::string text(bytes, '\0');
    in.clear();
    in.seekg(static_cast<std::streamoff>(offset));
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    if (!text.empty()) text.pop_back();
    return text;
  }

 private:
  std::ifstream& open(const std::filesystem::path& path) {
    const auto known = files_.find(path);
    if (known != files_.end()) return known->second;
    if (files_.size() >= maxOpen) files_.clear();
    return files_.emplace(path, std::ifstream(path, std::ios::binary)).first->second;
  }
  static constexpr std::size_t maxOpen = 256;
  std::map<std::filesystem::path, std::ifstream> files_;
};

}  // namespace

ValuesSet::ValuesSet(const std::vector<std::filesystem::path>& files, SharedWork work,
                     const std::function<void(const ValuesRow& row)>& refuse) {
  for (const std::filesystem::path& path : files) {
    const std::size_t before = rows_.size();
    try {
      accept(path, work, refuse);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::failure) throw;
      rows_.resize(before);
      refused_.push_back(e);
    }
  }
  std::sort(rows_.begin(), rows_.end(), [](const Location& a, const Location& b) { return a.position < b.position; });
}

void ValuesSet::checkPlan(const ValuesHeader& header, SharedWork work, const std::filesystem::path& path) const {
  const auto refused = [&](const std::string& why) { return Error(ErrorKind::refused, Where{path.string()}, why); };
  if (header.work != work)
    throw refused(fmt::format("holds values of calot {}, to be taken with that command", nameOf(header.work)));
  if (!plan_) return;
  if (header.plan != plan_->plan || header.planned != plan_->planned || header.shard.of != plan_->shard.of) {
    throw refused(
        fmt::format("is of another plan (one of {} shards of {} recordings) than {} ({} of {}); take it by "
                    "itself",
                    header.shard.of, header.planned, files_.front().path.string(), plan_->shard.of, plan_->planned));
  }
  for (const Accepted& other : files_) {
    if (other.header.shard == header.shard)
      throw refused(fmt::format("is shard {} of {}, as is {}; name one of them", header.shard.number, header.shard.of,
                                other.path.string()));
  }
}

void ValuesSet::accept(const std::filesystem::path& path, SharedWork work,
                       const std::function<void(const ValuesRow& row)>& refuse) {
  CheckedLineReader in(path);
  const std::optional<CheckedLine> first = in.next();
  if (!first) throw Error(ErrorKind::damaged, Where{path.string()}, "is empty");
  const ValuesHeader header = valuesHeader(in.parse(*first), path.string());
  checkDefinitions(header, path.string());
  checkPlan(header, work, path);
  std::set<std::uint64_t> positions;
  bool ended = false;
  while (const std::optional<CheckedLine> line = in.next()) {
    const auto damaged = [&](const std::string& fault) {
      return Error(ErrorKind::damaged, Where{path.string(), fmt::format("line {}", line->number)}, fault);
    };
    if (ended) throw damaged("a row behind the last one");
    const nlohmann::json json = in.parse(*line);
    if (const std::optional<std::uint64_t> end = endOf(json)) {
      if (*end != header.recordings || positions.size() != header.recordings)
        throw damaged(fmt::format("{} of {} recordings are there", positions.size(), header.recordings));
      ended = true;
      continue;
    }
    try {
      const ValuesRow row = valuesRow(json, header, path.string());
      if (row.position >= header.planned) throw Error(ErrorKind::damaged, "its position is behind the plan's end");
      if (!positions.insert(row.position).second) throw Error(ErrorKind::damaged, "its position is given twice");
      refuse(row);
      rows_.push_back(
          {row.position, files_.size(), line->offset, static_cast<std::uint32_t>(line->end - line->offset)});
    } catch (const Error& e) {
      throw inLine(e, path, line->number);
    }
  }
  if (!ended) {
    throw Error(ErrorKind::damaged, Where{path.string()},
                fmt::format("is cut off: {} of {} recordings are there; compute this shard again", positions.size(),
                            header.recordings));
  }
  if (!plan_) plan_ = header;
  files_.push_back({path, header});
}

std::vector<std::uint32_t> ValuesSet::missing() const {
  std::set<std::uint32_t> there;
  for (const Accepted& file : files_) there.insert(file.header.shard.number);
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t n = 1; n <= shares(); ++n) {
    if (!there.contains(n)) numbers.push_back(n);
  }
  return numbers;
}

void ValuesSet::forEach(const std::function<void(const ValuesRow& row)>& take) const {
  LinesByLocation lines;
  for (const Location& at : rows_) {
    const Accepted& file = files_[at.file];
    const std::string line = lines.line(file.path, at.offset, at.bytes), name = file.path.string();
    const auto changed = [&] { return Error(ErrorKind::damaged, Where{name}, "has changed while it was read"); };
    const std::optional<std::string_view> text = rowIn(line);
    if (!text) throw changed();
    const nlohmann::json json = recorder::parseStrictJson(std::as_bytes(std::span(text->data(), text->size())), name);
    const ValuesRow row = valuesRow(json, file.header, name);
    if (row.position != at.position) throw changed();
    take(row);
  }
}

}  // namespace calot::analytics
