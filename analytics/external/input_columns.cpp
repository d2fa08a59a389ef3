// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/external/input_columns.h"

#include <cassert>
#include <utility>

namespace calot::analytics {

InputColumns::InputColumns(const std::filesystem::path& folder, std::string table)
    : folder_(folder / table), table_(std::move(table)) {
  std::filesystem::create_directory(folder_);
}

NpyColumn& InputColumns::column(const std::string& name, const char* unit, const char* frame, bool whole,
                                std::size_t width, bool list) {
  if (!made_) {
    columns_.emplace_back(folder_ / (name + ".npy"), whole, list ? width : 0);
    description_.push_back({{"table", table_}, {"name", name}, {"unit", unit}, {"frame", frame}});
  }
  assert(next_ < columns_.size());
  return columns_[next_++];
}

void InputColumns::number(const std::string& name, const char* unit, double value) {
  column(name, unit, "", false, 0, false).put(value);
}

void InputColumns::whole(const std::string& name, std::int64_t value) {
  column(name, "", "", true, 0, false).put(value);
}

void InputColumns::vector(const std::string& name, const char* unit, const char* frame, const Vec3& value) {
  NpyColumn& c = column(name, unit, frame, false, 3, true);
  for (int i = 0; i < 3; ++i) c.put(value[i]);
}

void InputColumns::rotation(const std::string& name, const char* frame, const Quat& value) {
  NpyColumn& c = column(name, "", frame, false, 4, true);
  for (const double part : {value.w(), value.x(), value.y(), value.z()}) c.put(part);
}

void InputColumns::dropRows() {
  for (NpyColumn& c : columns_) c.clear();
}

void InputColumns::close() {
  for (NpyColumn& c : columns_) c.close();
}

}  // namespace calot::analytics
