// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "analytics/external/npy_column.h"
#include "sim/math/linear.h"

namespace calot::analytics {

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
  /// A number of each of several; no column where there are none. @pre as many in each row
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

}  // namespace calot::analytics
