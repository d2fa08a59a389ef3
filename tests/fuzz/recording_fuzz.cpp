// SPDX-License-Identifier: GPL-3.0-or-later
// A recording after edits of its data sets, as a hostile editor makes them: bytes of a file as such end at HDF5's own
// checksums. Each edit is ten bytes: which data set, which row, and eight bytes for its beginning. The reader gets past
// the check of the file's shape with all of them, and has to stand what it then reads. HDF5 itself is not the target:
// it is kept apart by a child process.
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "recorder/recording/reader.h"
#include "tests/fuzz/support/fuzz_target.h"
#include "tests/fuzz/support/input_file.h"
#include "tests/recorder/recording/support/synthetic.h"

using namespace calot;

namespace {

/// Every data set of the recording that is edited.
struct Original {
  fuzz::InputFile file{"recording"};
  std::string bytes;
  std::vector<std::string> datasets;

  Original() {
    recorder::test::writeRecording(file.path(), recorder::test::makeHeader(10, 1), 30);
    std::ifstream in(file.path(), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
    const hid_t opened = H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    H5Ovisit2(
        opened, H5_INDEX_NAME, H5_ITER_INC,
        [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
          if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(out)->emplace_back(name);
          return 0;
        },
        &datasets, H5O_INFO_BASIC);
    H5Fclose(opened);
  }
};

/// Overwrites the beginning of a row with eight bytes, in the type that it is stored in.
void edit(hid_t file, const std::string& name, hsize_t row, std::span<const std::byte> bytes) {
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  std::array<hsize_t, 2> extent{1, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  if (extent[0] > 0) {
    const std::array<hsize_t, 2> start{row % extent[0], 0}, count{1, extent[1]};
    const hid_t memory = H5Screate_simple(rank, count.data(), nullptr);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    std::vector<std::byte> held(H5Tget_size(type) * extent[1]);
    H5Dread(dataset, type, memory, space, H5P_DEFAULT, held.data());
    std::copy_n(bytes.begin(), std::min(bytes.size(), held.size()), held.begin());
    H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, held.data());
    H5Sclose(memory);
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Original original;
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  original.file.write(std::as_bytes(std::span(original.bytes)));
  const hid_t file = H5Fopen(original.file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (int edits = 0; bytes.size() >= 10 && edits < 16; ++edits) {
    const std::string& name = original.datasets[fuzz::takeByte(bytes) % original.datasets.size()];
    const hsize_t row = fuzz::takeByte(bytes);
    edit(file, name, row, bytes.first(8));
    bytes = bytes.subspan(8);
  }
  H5Fclose(file);
  return fuzz::tried([&] {
    recorder::Recording recording(original.file.path());
    static_cast<void>(recording.verifyChain());
    for (std::uint64_t n = 0; n < recording.stepCount(); ++n) recording.step(n);
    for (std::size_t k = 0; k < recording.keyframeSteps().size(); ++k) static_cast<void>(recording.keyframe(k));
    for (const Hand hand : {Hand::left, Hand::right})
      static_cast<void>(recording.rawSamples(hand, 0, recording.rawSampleCount(hand)));
  });
}
