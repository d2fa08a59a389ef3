// SPDX-License-Identifier: GPL-3.0-or-later
// Input of external metrics: a folder of arrays as files of NumPy (schemas/metric-input.md).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "analytics/checkpoints/definition.h"
#include "recorder/base/files.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/judgement/judge.h"
#include "sim/math/linear.h"

namespace calot::analytics {

/// One array in NumPy's file format 1.0 (NEP 1), written row by row: little-endian, in C order. Whole numbers are
/// int64, all others float64.
class NpyColumn {
 public:
  /// @param width numbers of a row; 0: the array has one dimension. @throws Error (failure), as all functions here
  NpyColumn(std::filesystem::path path, bool whole, std::size_t width);

  void put(double value) { putBits(std::bit_cast<std::uint64_t>(value)); }        ///< @pre not whole
  void put(std::int64_t value) { putBits(std::bit_cast<std::uint64_t>(value)); }  ///< @pre whole
  /// Forgets all rows. @pre they are few: none was written yet
  void clear();
  /// Writes what is left, and the number of rows into the head. @pre rows are whole.
  void close();

 private:
  void putBits(std::uint64_t bits);
  void flush();
  void writeHead();
  [[noreturn]] void fail() const;

  struct Closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  bool whole_;
  std::size_t width_;
  std::uint64_t numbers_ = 0;
  std::vector<std::uint64_t> waiting_;  ///< bits of the numbers
};

/// The arrays of one table, in the order in which its rows put their numbers. The first row makes them.
class InputColumns {
 public:
  /// @param table "results": a folder in `folder`, which is made
  InputColumns(const std::filesystem::path& folder, std::string table);

  void beginRow() { next_ = 0; }
  void endRow() { made_ = true; }

  void number(const std::string& name, const char* unit, double value);
  void whole(const std::string& name, std::int64_t value);
  void vector(const std::string& name, const char* unit, const char* frame, const Vec3& value);
  void rotation(const std::string& name, const char* frame, const Quat& value);  ///< w x y z
  /// A number of each of several; an empty list has no column. @pre as many in each row
  template <class List, class Read>
  void list(const std::string& name, const char* unit, const List& values, Read read) {
    if (values.empty()) return;
    using T = std::remove_cvref_t<decltype(read(values.front()))>;
    constexpr bool isWhole = !std::is_floating_point_v<T>;
    NpyColumn& c = column(name, unit, "", isWhole, values.size(), true);
    for (const auto& v : values) {
      if constexpr (isWhole) {
        c.put(static_cast<std::int64_t>(read(v)));
      } else {
        c.put(static_cast<double>(read(v)));
      }
    }
  }

  /// Keeps the columns of the rows so far, and none of the rows: a table without rows has its columns all the same.
  void dropRows();
  void close();
  /// [{"table": ..., "name": ..., "unit": ..., "frame": ...}] @pre after close()
  [[nodiscard]] const nlohmann::ordered_json& description() const { return description_; }

 private:
  NpyColumn& column(const std::string& name, const char* unit, const char* frame, bool whole, std::size_t width,
                    bool list);

  std::filesystem::path folder_;
  std::string table_;
  std::vector<NpyColumn> columns_;
  nlohmann::ordered_json description_ = nlohmann::ordered_json::array();
  std::size_t next_ = 0;
  bool made_ = false;
};

/// The observer that writes them: results once a step, samples and forces once a tick, events as they are judged. It
/// says nothing of who acted: a metric can't go by participant or group.
class MetricInput final : public recorder::Observer {
 public:
  /// @param scene the attempt's own. @param origin `resimulated` or `observables`. @throws Error (failure), as all
  /// functions here, where the folder cannot be written
  MetricInput(const recorder::AttemptHeader& header, const SceneDescription& scene, Origin origin);

  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome outcome) override;

  /// The folder, complete. @pre onEnd() was called
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  recorder::TemporaryFolder folder_;
  recorder::AttemptHeader header_;
  Judge judge_;
  InputColumns results_, samples_, events_;
  Origin origin_;
};

/// The same of motion without a scene: its rows are the samples.
/// @param outcome as declared. @param handedness "right", "left", "unknown"
recorder::TemporaryFolder writeMetricInput(const recorder::TrackedMotion& motion, recorder::Outcome outcome,
                                           const std::string& handedness, const std::string& task);

}  // namespace calot::analytics
