// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/csv_writer.h"

#include <cerrno>
#include <string_view>
#include <system_error>

#include "recorder/base/errors.h"

namespace calot {

std::string csvQuoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csvCell(const std::string& text) {
  const bool formula = !text.empty() && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  return csvQuoted(formula ? '\'' + text : text);
}

std::string csvLine(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) {
    line += csvCell(text);
    line += ',';
  }
  if (!line.empty()) line.back() = '\n';
  return line;
}

CsvFile::CsvFile(std::filesystem::path path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w")) {
  if (!file_) fail();
}

void CsvFile::endRow() {
  line_.push_back('\n');
  if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) fail();
  line_.clear();
  first_ = true;
}

void CsvFile::close() {
  if (std::fclose(file_.release()) != 0) fail();
}

void CsvFile::fail() const {
  throw Error(ErrorKind::failure, Where{path_.string()},
              fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

}  // namespace calot
