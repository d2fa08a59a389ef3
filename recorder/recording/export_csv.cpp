// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/export_csv.h"

#include <fmt/format.h>

#include <cstdio>
#include <iterator>
#include <memory>
#include <system_error>

#include "recorder/errors.h"
#include "recorder/recording/header.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

/// Quoted where a comma, quote or line break asks for it (RFC 4180).
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

/// One CSV file, written under its own name in the staging folder.
class Table {
 public:
  Table(const std::filesystem::path& stage, const std::string& folder) : folder_(folder) {
    std::string name = folder.substr(1) + ".csv";
    for (char& c : name) c = c == '/' ? '_' : c;
    path_ = stage / name;
    file_.reset(std::fopen(path_.c_str(), "w"));
    if (!file_) fail();
  }

  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  template <class... Args>
  void value(fmt::format_string<Args...> format, Args&&... args) {
    if (!first_) line_.push_back(',');
    first_ = false;
    fmt::format_to(std::back_inserter(line_), format, std::forward<Args>(args)...);
  }
  void put(double v) { value("{:.17g}", v); }
  void put(float v) { value("{:.9g}", v); }
  void put(bool v) { value("{}", v ? 1 : 0); }
  void put(InstrumentKind v) { value("{}", static_cast<unsigned>(v)); }
  void put(const std::string& v) { value("{}", cell(v)); }
  template <class T>
  requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) void put(T v) { value("{}", v); }

  void endRow() {
    line_.push_back('\n');
    if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) fail();
    line_.clear();
    first_ = true;
  }
  void close() {
    if (std::fclose(file_.release()) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(ExitCode::failure,
                fmt::format("{}: cannot be written: {}", path_.string(), std::generic_category().message(errno)));
  }
  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string folder_;
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  fmt::memory_buffer line_;
  bool first_ = true;
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
    for (std::size_t i = 0; i < width; ++i) {
      const std::string of = std::string(name) == "component_digest" ? header.layout.components[i]
                             : std::string(name) == "field_digest"   ? header.layout.fields[i].name
                                                                     : header.organs[i];
      title(folder, fmt::format("{}[{}]", name, of), unit);
    }
  }
  template <class T>
  void organs(const char* folder, const char* name, const char* unit, const std::vector<OrganResult>&,
              T OrganResult::*) {
    for (const std::string& organ : header.organs) title(folder, fmt::format("{}[{}]", name, organ), unit);
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
  template <class T>
  void organs(const char* folder, const char*, const char*, const std::vector<OrganResult>& organ,
              T OrganResult::*member) {
    for (const OrganResult& o : organ) to(folder).put(o.*member);
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
  const StepResult result;
  const float lateness = 0.0F;
  visitStep(digest, lateness, result, stepTitles);
  endRows(ticks);
  endRows(steps);
  Table events(stage, "/events");
  for (const char* title :
       {"step", "kind", "hand", "subject", "position_x (m)", "position_y (m)", "position_z (m)", "value"}) {
    events.put(std::string(title));
  }
  events.endRow();
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
    visitStep(step.digest, step.lateness, step.result, values);
    endRows(steps);
    for (const Event& e : step.result.events) {
      events.put(e.step);
      events.put(static_cast<unsigned>(e.kind));
      events.put(static_cast<unsigned>(e.hand));
      events.put(e.subject);
      for (int i = 0; i < 3; ++i) events.put(e.position[i]);
      events.put(e.value);
      events.endRow();
    }
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
}

}  // namespace

std::vector<std::filesystem::path> exportCsv(Recording& recording, const std::filesystem::path& folder, bool force,
                                             const std::function<void(std::uint64_t)>& progress) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error)) {
    throw Error(ExitCode::usage, fmt::format("{}: is a file; name a folder", folder.string()));
  }
  if (!force && std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error)) {
    throw Error(ExitCode::usage, fmt::format("{}: is not empty; --force replaces the files", folder.string()));
  }
  std::filesystem::path stage = folder.has_filename() ? folder : folder.parent_path();
  stage += ".part";
  std::filesystem::remove_all(stage, error);
  if (!std::filesystem::create_directories(stage, error)) {
    throw Error(ExitCode::failure, fmt::format("{}: cannot be made: {}", stage.string(), error.message()));
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
    throw Error(ExitCode::failure, fmt::format("{}: {}", folder.string(), e.code().message()));
  } catch (...) {
    std::filesystem::remove_all(stage, error);
    throw;
  }
}

}  // namespace calot::recorder
