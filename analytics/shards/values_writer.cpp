// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/values_writer.h"

#include <fmt/format.h>

#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

namespace calot::analytics {
namespace fs = std::filesystem;

ValuesWriter::ValuesWriter(fs::path path, ValuesHeader header, bool replace)
    : path_(std::move(path)), header_(std::move(header)) {
  std::error_code ignored;
  if (!replace && fs::is_regular_file(path_, ignored)) {
    complete_ = isComplete();
    if (complete_) return;
  }
  recorder::refuseOutput(path_, replace);
  fs::path part = path_;
  part += ".part";
  out_ = std::make_unique<LineAppender>(part);
  // The program that had it may have finished it meanwhile.
  if (!replace && fs::is_regular_file(path_, ignored)) {
    fs::remove(part, ignored);
    recorder::refuseOutput(path_, false);
  }
  const std::uint64_t good = takeUp(part);
  out_->truncate(good);
  if (good == 0) out_->append(checkedLine(jsonOf(header_)));
}

bool ValuesWriter::isComplete() const {
  try {
    CheckedLineReader in(path_);
    const std::optional<CheckedLine> first = in.next();
    return first && valuesHeader(in.parse(*first), path_.string()) == header_;
  } catch (const Error&) {  // whatever it is, it is not this share's
    return false;
  }
}

std::uint64_t ValuesWriter::takeUp(const fs::path& part) {
  std::uint64_t good = 0;
  try {
    CheckedLineReader in(part);
    const std::optional<CheckedLine> first = in.next();
    if (!first || valuesHeader(in.parse(*first), part.string()) != header_) return 0;
    good = first->end;
    while (const std::optional<CheckedLine> line = in.next()) {
      const ValuesRow row = valuesRow(in.parse(*line), header_, part.string());
      done_.insert(row.position);
      good = line->end;
    }
  } catch (const Error&) {  // a line that was cut off: from there on it is written again
  }
  return good;
}

void ValuesWriter::append(const ValuesRow& row) {
  assert(out_);
  out_->append(checkedLine(jsonOf(row, header_)));
  done_.insert(row.position);
}

void ValuesWriter::finish() {
  assert(out_ && done_.size() == header_.recordings);
  out_->append(checkedLine({{"end", header_.recordings}}));
  out_->synchronize();
  fs::path part = path_;
  part += ".part";
  if (std::rename(part.c_str(), path_.c_str()) != 0) {
    throw Error(ErrorKind::failure, Where{path_.string()},
                fmt::format("cannot take its name: {}", std::strerror(errno)));
  }
  out_.reset();
}

}  // namespace calot::analytics
