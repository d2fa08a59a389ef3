// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/stored_bytes.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "recorder/recording/hdf5.h"
#include "recorder/recording/open_file.h"

namespace calot::recorder {

namespace {

using Groups = std::map<std::string, std::uint64_t>;

/// Called for every object, each once whatever links to it.
herr_t addDataset(hid_t file, const char* name, const H5O_info_t* info, void* groups) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const hdf5::Id dataset = hdf5::dataset(H5Dopen2(file, name, H5P_DEFAULT));
  if (!dataset.valid()) return -1;
  const std::string_view path = name;
  (*static_cast<Groups*>(groups))[std::string(path.substr(0, path.find('/')))] += H5Dget_storage_size(dataset.get());
  return 0;
}

}  // namespace

std::vector<StoredBytes> storedBytes(const std::filesystem::path& path) {
  Groups groups;
  {
    const hdf5::Session session;
    const hdf5::Id file = openForReading(path, Access::settled);
    if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, addDataset, &groups, H5O_INFO_BASIC) < 0)
      throw hdf5::damaged(path, "/", hdf5::reason());
  }
  std::uint64_t sum = 0;
  for (const auto& [group, bytes] : groups) sum += bytes;
  std::error_code ignored;
  const std::uint64_t whole = std::filesystem::file_size(path, ignored);
  groups["structure"] += whole > sum ? whole - sum : 0;
  std::vector<StoredBytes> out;
  for (const auto& [group, bytes] : groups) out.push_back({group, bytes});
  std::stable_sort(out.begin(), out.end(),
                   [](const StoredBytes& a, const StoredBytes& b) { return a.bytes > b.bytes; });
  return out;
}

}  // namespace calot::recorder
