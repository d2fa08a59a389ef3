// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/export_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <system_error>

#include "recorder/base/csv_writer.h"
#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/rows.h"

namespace calot::recorder {

namespace {

/// The file of one group of the recording.
class Table final : public CsvFile {
 public:
  /// @param folder "/ticks/left": the file is ticks_left.csv. @throws Error failure.
  Table(const std::filesystem::path& stage, const std::string& folder)
      : CsvFile(pathOf(stage, folder)), folder_(folder) {}

  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  static std::filesystem::path pathOf(const std::filesystem::path& stage, const std::string& folder) {
    std::string name = folder.substr(1) + ".csv";
    std::replace(name.begin(), name.end(), '/', '_');
    return stage / name;
  }

  std::string folder_;
};

using Tables = std::vector<std::unique_ptr<Table>>;

Table* find(Tables& tables, const std::string& folder) {
  for (const auto& t : tables) {
    if (t->folder() == folder) return t.get();
  }
  return nullptr;
}

std::string titled(const std::string& name, const char* unit) {
  return *unit == '\0' ? name : fmt::format("{} ({})", name, unit);
}

/// Writes the titles of every visited value; makes the tables.
struct TitleVisitor {
  const Layout& layout;
  const AttemptHeader& header;
  const std::filesystem::path& stage;
  const char* clock;  ///< title of the first column
  Tables& tables;

  template <class T>
  void operator()(const char* folder, const char* name, const char* unit, const T&) {
    title(folder, name, unit);
  }
  void operator()(const char* folder, const char* name, const char* unit, const Vec3&) {
    for (const char* axis : {"_x", "_y", "_z"}) title(folder, std::string(name) + axis, unit);
  }
  void operator()(const char* folder, const char* name, const char* unit, const Quat&) {
    for (const char* part : {"_w", "_x", "_y", "_z"}) title(folder, std::string(name) + part, unit);
  }
  template <class T>
  void outside(const char* folder, const char* name, const char* unit, const T&) {
    title(folder, name, unit);
  }
  template <class T>
  void list(const char* folder, const char* name, const char* unit, const std::vector<T>&, std::size_t width) {
    const std::vector<std::string> structures = header.structures();
    for (std::size_t i = 0; i < width; ++i) {
      const std::string of = std::string(name) == "component_digest" ? header.layout.components[i]
                             : std::string(name) == "field_digest"   ? header.layout.fields[i].name
                                                                     : structures[i];
      title(folder, fmt::format("{}[{}]", name, of), unit);
    }
  }
  template <class Part, class T>
  void each(const char* folder, const char* name, const char* unit, const std::vector<Part>& /*parts*/, T Part::*) {
    Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
      if constexpr (std::is_same_v<typename Kind::Result, Part>) {
        for (const std::string& part : namesOf<Kind>(header)) title(folder, fmt::format("{}[{}]", name, part), unit);
      }
    });
  }

 private:
  void title(const std::string& folder, const std::string& name, const char* unit) {
    Table* table = find(tables, folder);
    if (table == nullptr) {
      tables.push_back(std::make_unique<Table>(stage, folder));
      table = tables.back().get();
      table->put(std::string(clock));
    }
    table->put(titled(name, unit));
  }
};

/// Writes every visited value into its table's row. Tables stand in the order in which the list first names them.
struct ValueVisitor {
  const Layout& layout;
  Tables& tables;
  std::uint64_t row = 0;
  const char* folderNow = nullptr;
  Table* table = nullptr;

  template <class T>
  void operator()(const char* folder, const char*, const char*, const T& v) {
    to(folder).put(v);
  }
  void operator()(const char* folder, const char*, const char*, const Vec3& v) {
    for (int i = 0; i < 3; ++i) to(folder).put(v[i]);
  }
  void operator()(const char* folder, const char*, const char*, const Quat& q) {
    for (const double v : {q.w(), q.x(), q.y(), q.z()}) to(folder).put(v);
  }
  template <class T>
  void outside(const char* folder, const char*, const char*, const T& v) {
    to(folder).put(v);
  }
  template <class T>
  void list(const char* folder, const char*, const char*, const std::vector<T>& values, std::size_t) {
    for (const T& v : values) to(folder).put(v);
  }
  template <class Part, class T>
  void each(const char* folder, const char*, const char*, const std::vector<Part>& parts, T Part::*member) {
    for (const Part& part : parts) to(folder).put(part.*member);
  }

 private:
  Table& to(const char* folder) {
    if (folder != folderNow) {
      folderNow = folder;
      table = find(tables, folder);
    }
    return *table;
  }
};

void beginRows(Tables& tables, std::uint64_t row) {
  for (const auto& t : tables) t->put(row);
}
void endRows(Tables& tables) {
  for (const auto& t : tables) t->endRow();
}

struct AttributeRows {
  Table& table;
  template <class T>
  void operator()(const char* name, const T& value) {
    table.put(std::string(name));
    table.put(value);
    table.endRow();
  }
  template <class T>
  void constant(const char* name, const T& value) {
    (*this)(name, value);
  }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    (*this)(name, std::string(names[static_cast<std::size_t>(value)]));
  }
};

/// Titles of a kind of packed rows, or one row of it.
template <class Row>
void putTitles(Table& table) {
  const auto put = [&table]<class T>(const char* name, const char* unit, const T& /*value*/) {
    const std::vector<const char*> parts = std::is_same_v<T, Vec3>   ? std::vector{"_x", "_y", "_z"}
                                           : std::is_same_v<T, Quat> ? std::vector{"_w", "_x", "_y", "_z"}
                                                                     : std::vector{""};
    for (const char* part : parts) table.put(titled(std::string(name) + part, unit));
  };
  const Row row{};
  visitRow(row, put);
  table.endRow();
}
template <class Row>
void putRow(Table& table, const Row& row) {
  const auto put = [&table]<class T>(const char* /*name*/, const char* /*unit*/, const T& value) {
    if constexpr (std::is_same_v<T, Vec3>) {
      for (int i = 0; i < 3; ++i) table.put(value[i]);
    } else if constexpr (std::is_same_v<T, Quat>) {
      for (const double v : {value.w(), value.x(), value.y(), value.z()}) table.put(v);
    } else {
      table.put(value);
    }
  };
  visitRow(row, put);
  table.endRow();
}

/// Raw samples of a hand's device.
void writeRawSamples(Recording& recording, Hand hand, Table& table) {
  putTitles<RawSample>(table);
  constexpr std::uint64_t most = 4096;
  const std::uint64_t count = recording.rawSampleCount(hand);
  for (std::uint64_t at = 0; at < count; at += most) {
    for (const RawSample& raw : recording.rawSamples(hand, at, std::min(most, count - at))) putRow(table, raw);
  }
}

void writeAll(Recording& recording, const std::filesystem::path& stage,
              const std::function<void(std::uint64_t)>& progress, std::vector<std::filesystem::path>& files) {
  const AttemptHeader& header = recording.header();
  const Layout layout(header);
  Tables ticks, steps;
  TitleVisitor tickTitles{layout, header, stage, "tick", ticks};
  TitleVisitor stepTitles{layout, header, stage, "step", steps};
  const TickSamples samples;
  const TickOutcome outcome;
  visitTick(samples, outcome, tickTitles);
  const StateDigest digest;
  const BriefDigest brief;
  const StepResult result;
  const std::uint64_t forces = 0;
  const float lateness = 0.0F;
  const RecordedProcedure procedure;
  visitStep(digest, brief, forces, lateness, result, procedure, stepTitles);
  endRows(ticks);
  endRows(steps);
  Table events(stage, "/events");
  putTitles<Event>(events);
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    for (std::size_t t = 0; t < step.samples.size(); ++t) {
      beginRows(ticks, n * layout.ticksPerStep + t);
      ValueVisitor values{layout, ticks};
      visitTick(step.samples[t], step.ticks[t], values);
      endRows(ticks);
    }
    beginRows(steps, n);
    ValueVisitor values{layout, steps};
    visitStep(step.digest, step.brief, step.forces, step.lateness, step.result, step.procedure, values);
    endRows(steps);
    for (const Event& event : step.result.events) putRow(events, event);
    if (progress) progress(n + 1);
  }
  Table attempt(stage, "/attempt");
  attempt.put(std::string("attribute"));
  attempt.put(std::string("value"));
  attempt.endRow();
  AttributeRows rows{attempt};
  visitAttributes(header, rows);
  rows("complete", recording.complete());
  rows("outcome", std::string(outcomeNames[static_cast<std::size_t>(recording.outcome())]));
  const auto finish = [&files](Table& table) {
    table.close();
    files.push_back(table.path());
  };
  finish(attempt);
  for (const auto& t : ticks) finish(*t);
  for (const auto& t : steps) finish(*t);
  finish(events);
  if (!header.deviceSamples) return;
  for (const Hand hand : {Hand::left, Hand::right}) {
    Table raw(stage, std::string("/device/") + handNames[static_cast<std::size_t>(hand)]);
    writeRawSamples(recording, hand, raw);
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
      std::filesystem::rename(file, target);
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
