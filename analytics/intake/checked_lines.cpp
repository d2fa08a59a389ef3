// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/checked_lines.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>

#include "recorder/base/errors.h"
#include "recorder/base/json_reader.h"
#include "sim/math/fields.h"

namespace calot::analytics {
namespace {

constexpr std::string_view sumHead = R"({"sum":")", rowHead = R"(","row":)";
constexpr std::size_t sumDigits = 16;
constexpr std::size_t frameBytes = sumHead.size() + sumDigits + rowHead.size() + 1;  // and the closing brace

std::string sumOf(std::string_view row) {
  return fmt::format("{:016x}", digest64(std::as_bytes(std::span(row.data(), row.size()))));
}

}  // namespace

std::string checkedLine(const nlohmann::ordered_json& row) {
  const std::string text = row.dump();
  std::string line;
  line.reserve(text.size() + frameBytes + 1);
  line.append(sumHead).append(sumOf(text)).append(rowHead).append(text).append("}\n");
  if (line.size() > maxCheckedLine)
    throw Error(ErrorKind::failure,
                fmt::format("a row has {} bytes; at most {} can be read again", line.size(), maxCheckedLine));
  return line;
}

std::optional<std::string_view> rowIn(std::string_view line) {
  const bool framed = line.size() > frameBytes && line.substr(0, sumHead.size()) == sumHead &&
                      line.substr(sumHead.size() + sumDigits, rowHead.size()) == rowHead && line.back() == '}';
  if (!framed) return std::nullopt;
  const std::string_view row = line.substr(frameBytes - 1, line.size() - frameBytes);
  return line.substr(sumHead.size(), sumDigits) == sumOf(row) ? std::optional(row) : std::nullopt;
}

CheckedLineReader::CheckedLineReader(std::filesystem::path path)
    : path_(std::move(path)), in_(path_, std::ios::binary), buffer_(maxCheckedLine + 1) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path_, error) || !in_)
    throw Error(ErrorKind::damaged, Where{path_.string()}, "there is no such file, or it cannot be read");
}

std::optional<CheckedLine> CheckedLineReader::next() {
  const auto damaged = [&](const std::string& fault) {
    return Error(ErrorKind::damaged, Where{path_.string(), fmt::format("line {}", number_)}, fault);
  };
  in_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  const auto read = static_cast<std::size_t>(in_.gcount());
  if (read == 0 && in_.eof()) return std::nullopt;
  CheckedLine line{++number_, offset_, offset_ + read, {}};
  if (in_.bad()) throw damaged("cannot be read");
  if (in_.eof()) throw damaged("is cut off");
  if (in_.fail()) throw damaged(fmt::format("has more than {} bytes", maxCheckedLine));
  offset_ = line.end;
  const auto row = rowIn(std::string_view(buffer_.data(), read - 1));  // without the line feed
  if (!row) throw damaged("is no row, or its checksum is wrong");
  line.row = *row;
  return line;
}

nlohmann::json CheckedLineReader::parse(const CheckedLine& line) const {
  try {
    return recorder::parseStrictJson(std::as_bytes(std::span(line.row.data(), line.row.size())), path_.string());
  } catch (const Error& e) {
    throw Error(e.kind(), Where{path_.string(), fmt::format("line {}", line.number)}, e.fault());
  }
}

LineAppender::LineAppender(std::filesystem::path path) : path_(std::move(path)) {
  // Another program may rename the file between opening and locking: then what is locked is no longer this path's.
  while (file_ < 0) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (file_ < 0) fail("cannot be opened");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      const std::string why = taken ? "another program is writing it" : std::string(std::strerror(errno));
      ::close(file_);
      throw Error(ErrorKind::failure, Where{path_.string()}, why);
    }
    struct stat ours {
    }, named{};
    if (::fstat(file_, &ours) != 0 || ::stat(path_.c_str(), &named) != 0 || ours.st_ino != named.st_ino) {
      ::close(file_);
      file_ = -1;
    }
  }
}

LineAppender::~LineAppender() { ::close(file_); }

void LineAppender::fail(const char* what) const {
  throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("{}: {}", what, std::strerror(errno)));
}

void LineAppender::truncate(std::uint64_t size) {
  if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail("cannot be cut");
}

void LineAppender::append(std::string_view line) {
  while (!line.empty()) {
    const ssize_t written = ::write(file_, line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written");
    line.remove_prefix(static_cast<std::size_t>(written));
  }
}

void LineAppender::synchronize() {
  if (::fsync(file_) != 0) fail("cannot be written");
}

}  // namespace calot::analytics
