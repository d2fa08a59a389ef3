// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/csv_table.h"

#include <cerrno>
#include <system_error>

#include "recorder/base/errors.h"

namespace calot::recorder {

namespace {

/// Quoted if it contains a comma, quote or line break.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& stage, const std::string& folder) : folder_(folder) {
  std::string name = folder.substr(1) + ".csv";
  for (char& c : name) c = c == '/' ? '_' : c;
  path_ = stage / name;
  file_.reset(std::fopen(path_.c_str(), "w"));
  if (!file_) fail();
}

void CsvTable::put(const std::string& v) { value("{}", cell(v)); }

void CsvTable::endRow() {
  line_.push_back('\n');
  if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) fail();
  line_.clear();
  first_ = true;
}

void CsvTable::close() {
  if (std::fclose(file_.release()) != 0) fail();
}

void CsvTable::fail() const {
  throw Error(ErrorKind::failure, Where{path_.string()},
              fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

}  // namespace calot::recorder
