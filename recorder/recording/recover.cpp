// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/recover.h"

#include <fmt/format.h>

#include <memory>
#include <system_error>

#include "recorder/base/files.h"
#include "recorder/recording/block.h"
#include "recorder/recording/file_reader.h"
#include "recorder/recording/file_writer.h"
#include "recorder/recording/probe.h"

namespace calot::recorder {

namespace {

/// A closed file whose end is missing is not opened by HDF5, though all that lies before the cut is as it was: object
/// headers stand at the front, and chunks and their index follow in the order of time. So this makes a copy of the
/// original length, with a hole in place of the lost part. Data read from the hole fail their checksum or the chain.
/// @return the copy, or the file itself if it is not truncated or was never closed.
std::filesystem::path padded(const std::filesystem::path& path, std::uint64_t fileBytes,
                             const std::filesystem::path& scratch) {
  constexpr std::uint64_t longest = std::uint64_t{1} << 40U;
  const Superblock superblock = readSuperblock(path);
  if (superblock.writing || superblock.endOfFile <= fileBytes || superblock.endOfFile > longest) return path;
  std::error_code error;
  std::filesystem::copy_file(path, scratch, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) std::filesystem::resize_file(scratch, superblock.endOfFile, error);
  if (error)
    throw Error(ErrorKind::failure, Where{scratch.string()}, fmt::format("cannot be written: {}", error.message()));
  return scratch;
}

/// Reads what is still readable of a file, from front to back.
class Salvage {
 public:
  /// @param scratch a file to work on where the input itself cannot be opened.
  Salvage(const std::filesystem::path& path, const std::filesystem::path& scratch) : path_(path) {
    const hdf5::Session session;
    const std::uint64_t fileBytes = std::filesystem::file_size(path);
    const std::filesystem::path readable = padded(path, fileBytes, scratch);
    if (readable != path)
      cut_ = fmt::format(" (cut off: {} of {} bytes are there)", fileBytes, std::filesystem::file_size(readable));
    file_ = openForReading(readable, Access::settled);
    header_ = readHeader(path, file_, fileBytes);
    try {
      signature_ = readSignature(path, file_);
    } catch (const Error&) {
      signature_.reset();  // the content is worth saving without it
    }
    try {
      open(fileBytes);
    } catch (const Error&) {
      if (!header_.deviceSamples) throw;
      header_.deviceSamples = false;  // all but the raw samples, then
      open(fileBytes);
    }
    before_ = columns_->readStatus(0);
    if (chainStart(header_) != before_.chain) {
      throw hdf5::damaged(path, "/status", "the content chain does not fit header and scene");
    }
  }
  ~Salvage() {
    const hdf5::Session session;
    columns_.reset();
    file_.reset();
  }
  Salvage(const Salvage&) = delete;
  Salvage& operator=(const Salvage&) = delete;

  [[nodiscard]] const AttemptHeader& header() const { return header_; }
  [[nodiscard]] const Layout& layout() const { return *layout_; }
  [[nodiscard]] const std::optional<RecordedSignature>& signature() const { return signature_; }

  /// Reads the next flush. @return false at the end; `lost` then says why it is the end, if it came too early.
  bool next(Block& block, StatusRow& after, std::string& lost) {
    if (row_ >= columns_->statusRows()) return false;
    const hdf5::Session session;
    try {
      after = columns_->readStatus(row_);
      columns_->checkFollows(before_, after, row_);
      columns_->readBlock(before_, after, true, block);
      if (chainNext(*layout_, before_, block, after) != after.chain) {
        lost = fmt::format("{}: the content chain is broken at flush {}{}", path_.string(), row_, cut_);
        return false;
      }
      readRaw(after, block);
    } catch (const Error& e) {
      lost = e.what() + cut_;
      return false;
    }
    before_ = after;
    ++row_;
    return true;
  }

 private:
  void open(std::uint64_t fileBytes) {
    columns_.reset();
    layout_ = std::make_unique<Layout>(header_);
    columns_ = std::make_unique<ColumnReader>(path_, file_, *layout_, fileBytes);
  }

  /// Unreadable raw samples affect nothing else: they are counted as lost.
  void readRaw(StatusRow& after, Block& block) const {
    after.rawSamples = before_.rawSamples;
    after.rawDropped = before_.rawDropped;
    try {
      columns_->readRawCounts(before_, row_, after);
      columns_->readRaw(before_, after, block);
    } catch (const Error&) {
      for (std::size_t h = 0; h < layout_->raw.size(); ++h) {
        const Column& column = layout_->columns[layout_->raw[h]];
        block.column[layout_->raw[h]].clear();
        block.rows[static_cast<std::size_t>(column.stream)] = 0;
        block.rawDropped[h] = after.rawDropped[h] - before_.rawDropped[h] + after.rawSamples[h] - before_.rawSamples[h];
      }
    }
  }

  std::filesystem::path path_;
  std::string cut_;
  hdf5::Id file_;
  AttemptHeader header_;
  std::optional<RecordedSignature> signature_;
  std::unique_ptr<Layout> layout_;
  std::unique_ptr<ColumnReader> columns_;
  StatusRow before_;
  std::uint64_t row_ = 1;
};

Recovered rewrite(const std::filesystem::path& in, const std::filesystem::path& temporary,
                  const std::filesystem::path& scratch) {
  readSuperblock(in);  // no file, or not a recording: nothing to save
  std::unique_ptr<Salvage> source;
  try {
    source = std::make_unique<Salvage>(in, scratch);
  } catch (const Error& e) {
    throw Error(e.kind(), Where{in.string(), e.where().place}, fmt::format("nothing can be saved: {}", e.fault()));
  }
  const StatusRow first = createRecordingFile(temporary, source->header(), source->layout(),
                                              source->signature() ? &source->signature()->publicKey : nullptr);
  FileAppender out(temporary, source->layout(), first, false);
  Block block(source->layout());
  StatusRow row;
  Recovered result;
  while (source->next(block, row, result.lost)) out.append(block, row.wallNanoseconds);
  // A signature is kept only if it covers exactly what was saved, not if the end is lost.
  if (source->signature() && source->signature()->fits(out.last().chain)) out.sign(*source->signature()->value);
  out.close();
  result.steps = out.last().steps;
  result.ticks = out.last().ticks;
  result.complete = out.last().completed;
  if (result.steps == 0 && !result.lost.empty()) {
    throw Error(ErrorKind::damaged, Where{in.string()}, fmt::format("nothing can be saved: {}", result.lost));
  }
  return result;
}

}  // namespace

Recovered recover(const std::filesystem::path& in, const std::filesystem::path& out, bool force) {
  std::error_code ignored;
  if (std::filesystem::equivalent(in, out, ignored)) {
    throw Error(ErrorKind::invalid, Where{out.string()}, "is the input; name another output");
  }
  NewFile made(out, force);
  const NewFile scratch(out, force, ".cut.part");  // never published
  Recovered result = guardedRecord(
      in.string(), [&] { return rewrite(in, made.path(), scratch.path()); }, readingLimits(in));
  made.publish();
  return result;
}

}  // namespace calot::recorder
