// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/recorded_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "recorder/base/csv.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/recording/block.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

/// Reads and checks every step; after the last one of each flush, calls use(first step, end).
void forEachFlush(Recording& recording, const std::function<void(std::uint64_t)>& progress, auto use) {
  std::uint64_t first = 0;
  for (const StatusRow& row : recording.status()) {
    for (std::uint64_t n = first; n < row.steps; ++n) {
      recording.step(n);
      if (progress) progress(n + 1);
    }
    if (row.steps > first) use(first, row.steps);
    first = row.steps;
  }
}

/// Whose value each element of a row is.
std::vector<std::string> partsOf(const Column& column, const AttemptHeader& header) {
  const std::string_view path = column.path;
  if (path == "/steps/component_digest") return header.layout.components;
  std::vector<std::string> names;
  if (path == "/steps/field_digest") {
    for (const DigestLayout::Field& field : header.layout.fields) names.push_back(field.name);
    return names;
  }
  if (path.ends_with("/organ_force")) return header.structures();
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if (path.starts_with(std::string(Kind::results.path) + "/")) names = namesOf<Kind>(header);
  });
  return names;
}

}  // namespace

std::vector<std::byte> packedEvents(const std::vector<Event>& events) {
  std::vector<std::byte> bytes;
  for (const Event& event : events) appendRow(event, bytes);
  return bytes;
}

RecordedColumns recordedColumns(Recording& recording) {
  const Layout& layout = recording.layout();
  RecordedColumns out;
  for (std::size_t i = 0; i < layout.tickColumns + layout.stepColumns; ++i) {
    const Column& c = layout.columns[i];
    auto& columns = i < layout.tickColumns ? out.ticks : out.steps;
    columns.push_back({c.path, numberType(c.element), c.unit, c.width, c.vector, partsOf(c, recording.header()), {}});
    const std::uint64_t rows = i < layout.tickColumns ? recording.tickCount() : recording.stepCount();
    columns.back().values.reserve(c.rowBytes() * static_cast<std::size_t>(rows));
  }
  forEachFlush(recording, {}, [&](std::uint64_t /*first*/, std::uint64_t /*end*/) {
    const auto add = [&](std::vector<std::byte>& to, std::size_t column) {
      const std::vector<std::byte>& rows = recording.flushRows(column);
      appendBytes(to, rows.data(), rows.size());
    };
    for (std::size_t i = 0; i < out.ticks.size(); ++i) add(out.ticks[i].values, i);
    for (std::size_t i = 0; i < out.steps.size(); ++i) add(out.steps[i].values, layout.tickColumns + i);
    add(out.events, layout.events);
  });
  return out;
}

std::vector<std::byte> packedRawSamples(Recording& recording, Hand hand) {
  std::vector<std::byte> bytes;
  for (const RawSample& sample : recording.rawSamples(hand, 0, recording.rawSampleCount(hand)))
    appendRow(sample, bytes);
  return bytes;
}

namespace {

/// The file of one group of the recording's columns.
struct Table {
  std::string folder;  ///< "/ticks/left": the file is ticks_left.csv
  std::vector<std::size_t> columns;
  std::unique_ptr<CsvFile> file;

  /// @throws Error failure
  Table(const std::filesystem::path& stage, std::string group) : folder(std::move(group)) {
    std::string name = folder.substr(1) + ".csv";
    std::replace(name.begin(), name.end(), '/', '_');
    file = std::make_unique<CsvFile>(stage / name);
  }
};

std::string titled(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// Ends of the titles of a vector's or an orientation's numbers.
std::vector<const char*> axesOf(std::size_t numbers) {
  if (numbers == 3) return {"_x", "_y", "_z"};
  if (numbers == 4) return {"_w", "_x", "_y", "_z"};
  return {""};
}

/// The tables of columns [first, end), in the order in which the layout first names them, with their titles.
/// @param clock title of the first column
std::vector<Table> tablesOf(const std::filesystem::path& stage, const Layout& layout, const AttemptHeader& header,
                            std::size_t first, std::size_t end, const char* clock) {
  std::vector<Table> tables;
  for (std::size_t c = first; c < end; ++c) {
    const Column& column = layout.columns[c];
    if (column.width == 0) continue;
    const std::size_t slash = column.path.rfind('/');
    const std::string folder = column.path.substr(0, slash);
    auto table = std::find_if(tables.begin(), tables.end(), [&](const Table& t) { return t.folder == folder; });
    if (table == tables.end()) {
      table = tables.emplace(table, stage, folder);
      table->file->put(std::string(clock));
    }
    table->columns.push_back(c);
    const std::string name = column.path.substr(slash + 1);
    const std::vector<std::string> parts = partsOf(column, header);
    for (const std::string& part : parts) table->file->put(titled(fmt::format("{}[{}]", name, part), column.unit));
    if (!parts.empty()) continue;
    for (const char* axis : axesOf(column.width)) table->file->put(titled(name + axis, column.unit));
  }
  for (const Table& table : tables) table.file->endRow();
  return tables;
}

/// Writes the rows of a flush. @param first number of the first one
void putRows(const Recording& recording, const std::vector<Table>& tables, std::uint64_t first, std::uint64_t end) {
  for (const Table& table : tables) {
    for (std::uint64_t row = first; row < end; ++row) {
      table.file->put(row);
      for (const std::size_t c : table.columns) {
        const Column& column = recording.layout().columns[c];
        const std::byte* at = recording.flushRows(c).data() + static_cast<std::size_t>(row - first) * column.rowBytes();
        for (std::uint64_t i = 0; i < column.width; ++i, at += elementBytes(column.element))
          withNumber(column.element, at, [&](auto number) { table.file->put(number); });
      }
      table.file->endRow();
    }
  }
}

/// Titles of a kind of packed rows, or one row of it.
template <class Row>
void putTitles(CsvFile& file) {
  const auto put = [&file]<class T>(const char* name, const char* unit, const T& /*value*/) {
    const std::size_t numbers = std::is_same_v<T, Vec3> ? 3 : std::is_same_v<T, Quat> ? 4 : 1;
    for (const char* axis : axesOf(numbers)) file.put(titled(std::string(name) + axis, unit));
  };
  const Row row{};
  visitRow(row, put);
  file.endRow();
}
void putRow(CsvFile& file, const auto& row) {
  const auto put = [&file]<class T>(const char* /*name*/, const char* /*unit*/, const T& value) {
    if constexpr (std::is_same_v<T, Vec3>) {
      for (int i = 0; i < 3; ++i) file.put(value[i]);
    } else if constexpr (std::is_same_v<T, Quat>) {
      for (const double v : {value.w(), value.x(), value.y(), value.z()}) file.put(v);
    } else {
      file.put(value);
    }
  };
  visitRow(row, put);
  file.endRow();
}

void writeAll(Recording& recording, const std::filesystem::path& stage,
              const std::function<void(std::uint64_t)>& progress, std::vector<std::filesystem::path>& files) {
  const AttemptHeader& header = recording.header();
  const Layout& layout = recording.layout();
  const std::vector<Table> ticks = tablesOf(stage, layout, header, 0, layout.tickColumns, "tick");
  const std::vector<Table> steps =
      tablesOf(stage, layout, header, layout.tickColumns, layout.tickColumns + layout.stepColumns, "step");
  const Table events(stage, "/events");
  putTitles<Event>(*events.file);
  forEachFlush(recording, progress, [&](std::uint64_t first, std::uint64_t end) {
    putRows(recording, ticks, first * layout.ticksPerStep, end * layout.ticksPerStep);
    putRows(recording, steps, first, end);
    std::span<const std::byte> packed = recording.flushRows(layout.events);
    for (Event event; !packed.empty(); packed = packed.subspan(eventBytes)) {
      static_cast<void>(parseRow(packed, event));
      putRow(*events.file, event);
    }
  });
  const Table attempt(stage, "/attempt");
  const auto attribute = [&](const std::string& name, const auto& value) {
    attempt.file->put(name);
    attempt.file->put(value);
    attempt.file->endRow();
  };
  attribute("attribute", std::string("value"));
  forEachAttribute(header, attribute);
  attribute("complete", recording.complete());
  attribute("outcome", std::string(outcomeNames[static_cast<std::size_t>(recording.outcome())]));
  const auto finish = [&files](const Table& table) {
    table.file->close();
    files.push_back(table.file->path());
  };
  finish(attempt);
  for (const Table& t : ticks) finish(t);
  for (const Table& t : steps) finish(t);
  finish(events);
  for (const Hand hand : {Hand::left, Hand::right}) {
    if (!header.deviceSamples) break;
    const Table raw(stage, std::string("/device/") + handNames[static_cast<std::size_t>(hand)]);
    putTitles<RawSample>(*raw.file);
    constexpr std::uint64_t most = 4096;
    const std::uint64_t count = recording.rawSampleCount(hand);
    for (std::uint64_t at = 0; at < count; at += most) {
      for (const RawSample& sample : recording.rawSamples(hand, at, std::min(most, count - at)))
        putRow(*raw.file, sample);
    }
    finish(raw);
  }
}

}  // namespace

std::vector<std::filesystem::path> exportCsv(Recording& recording, const std::filesystem::path& folder, bool force,
                                             const std::function<void(std::uint64_t)>& progress) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error)) {
    throw Error(ErrorKind::invalid, Where{folder.string()}, "is a file; name a folder");
  }
  if (!force && std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw Error(ErrorKind::invalid, Where{folder.string()}, "is not empty", {Remedy::replaceExisting});
  }
  std::filesystem::path stage = folder.has_filename() ? folder : folder.parent_path();
  stage += ".part";
  std::filesystem::remove_all(stage, error);
  if (!std::filesystem::create_directories(stage, error)) {
    throw Error(ErrorKind::failure, Where{stage.string()}, fmt::format("cannot be made: {}", error.message()));
  }
  try {
    std::vector<std::filesystem::path> files;
    writeAll(recording, stage, progress, files);
    std::filesystem::create_directories(folder);
    for (std::filesystem::path& file : files) {
      const std::filesystem::path target = folder / file.filename();
      refuseOutput(target, true);
      std::filesystem::rename(file, linkTarget(target));
      file = target;
    }
    std::filesystem::remove_all(stage, error);
    return files;
  } catch (const std::filesystem::filesystem_error& e) {
    std::filesystem::remove_all(stage, error);
    throw Error(ErrorKind::failure, Where{folder.string()}, e.code().message());
  } catch (...) {
    std::filesystem::remove_all(stage, error);
    throw;
  }
}

}  // namespace calot::recorder
