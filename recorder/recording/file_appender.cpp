// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "recorder/recording/chain.h"
#include "recorder/recording/file_driver.h"
#include "recorder/recording/file_writer.h"
#include "recorder/recording/types.h"

namespace calot::recorder {

FileAppender::FileAppender(const std::filesystem::path& path, const Layout& layout, const StatusRow& first, bool swmr)
    : path_(path), layout_(layout), swmr_(swmr), last_(first) {
  const hdf5::Session session;
  const hdf5::Id access = hdf5::fileAccess(0);
  if (!hdf5::useOwnDriver(access.get())) fail("cannot be opened for writing");
  file_ = hdf5::file(H5Fopen(path.c_str(), H5F_ACC_RDWR | (swmr ? H5F_ACC_SWMR_WRITE : 0U), access.get()));
  if (!file_.valid()) fail("cannot be opened for writing");
  for (const Column& column : layout.columns) {
    type_.push_back(hdf5::elementType(column.element));
    if (column.width == 0) {
      dataset_.emplace_back();
      continue;
    }
    const hdf5::Id how = hdf5::datasetAccess(column.rowBytes() * static_cast<std::size_t>(column.chunkRows));
    dataset_.push_back(hdf5::dataset(H5Dopen2(file_.get(), column.path.c_str(), how.get())));
    if (!dataset_.back().valid()) fail("cannot open " + column.path);
  }
  statusType_ = hdf5::elementType(Element::status);
  const hdf5::Id how = hdf5::datasetAccess(statusBytes);
  status_ = hdf5::dataset(H5Dopen2(file_.get(), "/status", how.get()));
  if (!status_.valid()) fail("cannot open /status");
  if (H5Lexists(file_.get(), "/signature", H5P_DEFAULT) > 0) {
    byteType_ = hdf5::elementType(Element::u1);
    const hdf5::Id little = hdf5::datasetAccess(std::tuple_size_v<Signature>);
    signature_ = hdf5::dataset(H5Dopen2(file_.get(), signaturePath, little.get()));
    if (!signature_.valid()) fail(std::string("cannot open ") + signaturePath);
  }
  if (!layout.deviceSamples) return;
  rawCountsType_ = hdf5::elementType(Element::rawCounts);
  const hdf5::Id small = hdf5::datasetAccess(rawCountsBytes * rawChunkRows);
  rawCounts_ = hdf5::dataset(H5Dopen2(file_.get(), rawCountsPath, small.get()));
  if (!rawCounts_.valid()) fail(std::string("cannot open ") + rawCountsPath);
}

FileAppender::~FileAppender() {
  const hdf5::Session session;
  dataset_.clear();
  status_.reset();
  rawCounts_.reset();
  signature_.reset();
  byteType_.reset();
  type_.clear();
  statusType_.reset();
  rawCountsType_.reset();
  file_.reset();
}

void FileAppender::fail(const std::string& what) {
  const std::string why = hdf5::reason();
  hdf5::freeze(file_.get());
  throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("{}: {}", what, why));
}

void FileAppender::writeRows(const hdf5::Id& dataset, const hdf5::Id& type, std::uint64_t first, std::uint64_t rows,
                             std::uint64_t width, bool vector, const void* data, const std::string& path) {
  const int rank = vector ? 2 : 1;
  const std::array<hsize_t, 2> extent{first + rows, width};
  const std::array<hsize_t, 2> start{first, 0};
  const std::array<hsize_t, 2> count{rows, width};
  if (H5Dset_extent(dataset.get(), extent.data()) < 0) fail("cannot extend " + path);
  const hdf5::Id fileSpace = hdf5::space(H5Dget_space(dataset.get()));
  const hdf5::Id memorySpace = hdf5::space(H5Screate_simple(rank, count.data(), nullptr));
  if (H5Sselect_hyperslab(fileSpace.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dwrite(dataset.get(), type.get(), memorySpace.get(), fileSpace.get(), H5P_DEFAULT, data) < 0) {
    fail("cannot write " + path);
  }
}

void FileAppender::append(const Block& block, std::int64_t wallNanoseconds) {
  StatusRow row;
  row.ticks = last_.ticks + block.rows[static_cast<std::size_t>(Stream::ticks)];
  row.steps = last_.steps + block.rows[static_cast<std::size_t>(Stream::steps)];
  row.events = last_.events + block.rows[static_cast<std::size_t>(Stream::events)];
  row.keyframes = last_.keyframes + block.rows[static_cast<std::size_t>(Stream::keyframes)];
  row.keyframeWords = last_.keyframeWords + block.rows[static_cast<std::size_t>(Stream::keyframeWords)];
  for (std::size_t h = 0; h < row.rawSamples.size(); ++h) {
    const Stream stream = layout_.columns[layout_.raw[h]].stream;
    row.rawSamples[h] = last_.rawSamples[h] + block.rows[static_cast<std::size_t>(stream)];
    row.rawDropped[h] = last_.rawDropped[h] + block.rawDropped[h];
  }
  row.completed = block.completed;
  row.outcome = block.outcome;
  row.wallNanoseconds = wallNanoseconds;
  row.chain = chainNext(layout_, last_, block, row);
  const std::array<std::uint64_t, streamCount> before = countsOf(last_);
  const hdf5::Session session;
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const Column& column = layout_.columns[c];
    const auto stream = static_cast<std::size_t>(column.stream);
    if (column.width == 0 || block.rows[stream] == 0) continue;
    writeRows(dataset_[c], type_[c], before[stream], block.rows[stream], column.width, column.vector,
              block.column[c].data(), column.path);
  }
  if (rawCounts_.valid()) {
    packed_.clear();
    appendRawCounts(row, packed_);
    writeRows(rawCounts_, rawCountsType_, statusRows_, 1, 1, false, packed_.data(), rawCountsPath);
  }
  // The rows must be in the file before the row of /status that covers them.
  if (swmr_ && H5Fflush(file_.get(), H5F_SCOPE_LOCAL) < 0) fail("cannot flush");
  packed_.clear();
  appendStatus(row, packed_);
  writeRows(status_, statusType_, statusRows_, 1, 1, false, packed_.data(), "/status");
  if (swmr_ && H5Dflush(status_.get()) < 0) fail("cannot flush /status");
  ++statusRows_;
  last_ = row;
}

void FileAppender::sign(const Signature& signature) {
  const hdf5::Session session;
  writeRows(signature_, byteType_, 0, signature.size(), 1, false, signature.data(), signaturePath);
}

void FileAppender::close() {
  const hdf5::Session session;
  for (hdf5::Id& d : dataset_) {
    if (!d.reset()) fail("cannot close");
  }
  if (!status_.reset()) fail("cannot close /status");
  if (!rawCounts_.reset()) fail(std::string("cannot close ") + rawCountsPath);
  if (!signature_.reset()) fail(std::string("cannot close ") + signaturePath);
  if (H5Fflush(file_.get(), H5F_SCOPE_LOCAL) < 0) fail("cannot flush");
  if (!file_.reset())
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be closed: {}", hdf5::reason()));
}

}  // namespace calot::recorder
