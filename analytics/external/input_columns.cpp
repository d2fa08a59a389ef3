// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/external/input_columns.h"

#include <fmt/format.h>
#include <cassert>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t headBytes = 128;  // a multiple of 64, with room for 20 digits of each dimension
constexpr std::size_t heldBack = 2048;  // numbers

}  // namespace

NpyColumn::NpyColumn(std::filesystem::path path, bool whole, std::size_t width)
    : path_(std::move(path)), whole_(whole), width_(width) {
  file_.reset(std::fopen(path_.c_str(), "wb"));
  if (!file_) fail();
  waiting_.reserve(heldBack);
  writeHead();
}

void NpyColumn::putBits(std::uint64_t bits) {
  waiting_.push_back(bits);
  ++numbers_;
  if (waiting_.size() == heldBack) flush();
}

void NpyColumn::clear() {
  assert(numbers_ == waiting_.size());
  waiting_.clear();
  numbers_ = 0;
}

void NpyColumn::flush() {
  if (std::fwrite(waiting_.data(), sizeof(std::uint64_t), waiting_.size(), file_.get()) != waiting_.size()) fail();
  waiting_.clear();
}

void NpyColumn::close() {
  assert(width_ == 0 || numbers_ % width_ == 0);
  flush();
  if (std::fseek(file_.get(), 0, SEEK_SET) != 0) fail();
  writeHead();
  if (std::fclose(file_.release()) != 0) fail();
}

void NpyColumn::writeHead() {
  const std::uint64_t rows = width_ == 0 ? numbers_ : numbers_ / width_;
  const std::string shape = width_ == 0 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, width_);
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", whole_ ? "<i8" : "<f8", shape);
  constexpr std::size_t before = 10;  // magic, version, length
  text.resize(headBytes - before - 1, ' ');
  text += '\n';
  const auto length = static_cast<std::uint16_t>(text.size());
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(length & 0xFFU);
  head += static_cast<char>(length >> 8U);
  head += text;
  if (std::fwrite(head.data(), 1, head.size(), file_.get()) != head.size()) fail();
}

void NpyColumn::fail() const {
  throw Error(ErrorKind::failure, Where{path_.string()},
              fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

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
