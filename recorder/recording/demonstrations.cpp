// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/demonstrations.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/probe.h"

namespace calot::recorder {
namespace {

constexpr hsize_t mostSamples = 1000000;
constexpr std::size_t mostNames = 100000;

[[noreturn]] void fail(const std::string& file, const std::string& fault) {
  throw Error(ErrorKind::damaged, Where{file}, fault);
}

/// Names of links in a group, without those that a table cannot have.
std::vector<std::string> namesIn(const hdf5::Id& group) {
  H5G_info_t info{};
  std::vector<std::string> names;
  if (H5Gget_info(group.get(), &info) < 0) return names;
  for (hsize_t i = 0; i < std::min<hsize_t>(info.nlinks, mostNames); ++i) {
    std::array<char, 128> name{};
    const ssize_t size =
        H5Lget_name_by_idx(group.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    if (size > 0 && static_cast<std::size_t>(size) < name.size() &&
        std::string_view(name.data()).find_first_of(",\"\n\r") == std::string_view::npos)
      names.emplace_back(name.data());
  }
  return names;
}

/// Reads a data set that has `width` columns; empty where there is none.
std::vector<double> rowsOf(const hdf5::Id& group, const std::string& name, hsize_t width) {
  const hdf5::Id set = hdf5::dataset(H5Dopen2(group.get(), name.c_str(), H5P_DEFAULT));
  if (!set.valid()) return {};
  const hdf5::Id space = hdf5::space(H5Dget_space(set.get()));
  std::array<hsize_t, 2> size{};
  if (H5Sget_simple_extent_ndims(space.get()) != 2) return {};
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  if (size[0] > mostSamples || size[1] != width) return {};
  std::vector<double> values(size[0] * width);
  const herr_t read = H5Dread(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  return read < 0 ? std::vector<double>() : values;
}

/// env_kwargs.control_freq of the attribute env_args; empty: it is not there.
std::string controlFrequency(const hdf5::Id& data) {
  const hdf5::Id attribute = hdf5::attribute(H5Aopen(data.get(), "env_args", H5P_DEFAULT));
  if (!attribute.valid()) return {};
  const hdf5::Id type = hdf5::type(H5Aget_type(attribute.get()));
  std::string text;
  if (H5Tis_variable_str(type.get()) > 0) {
    char* value = nullptr;
    if (H5Aread(attribute.get(), type.get(), &value) >= 0 && value != nullptr) text = value;
    H5free_memory(value);
  } else if (H5Tget_class(type.get()) == H5T_STRING) {
    text.resize(H5Tget_size(type.get()));
    if (H5Aread(attribute.get(), type.get(), text.data()) < 0) return {};
    text.resize(std::min(text.find('\0'), text.size()));
  }
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  const nlohmann::json::json_pointer place("/env_kwargs/control_freq");
  return json.is_object() && json.contains(place) && json[place].is_number() ? json[place].dump() : std::string();
}

std::string tableOf(std::span<const std::byte> bytes, const std::string& file,
                    const std::optional<std::string>& wanted) {
  const hdf5::Session session;
  const hdf5::Id access = hdf5::properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fapl_core(access.get(), std::size_t{1} << 20U, false);
  // The image is copied: HDF5 takes no constant one.
  std::vector<std::byte> image(bytes.begin(), bytes.end());
  H5Pset_file_image(access.get(), image.data(), image.size());
  const hdf5::Id opened = hdf5::file(H5Fopen("image", H5F_ACC_RDONLY, access.get()));
  if (!opened.valid()) fail(file, "is a damaged HDF5 file: " + hdf5::reason());
  const hdf5::Id data = hdf5::group(H5Gopen2(opened.get(), "data", H5P_DEFAULT));
  std::vector<std::string> names = data.valid() ? namesIn(data) : std::vector<std::string>();
  std::erase_if(names, [](const std::string& name) { return !name.starts_with("demo_"); });
  if (names.empty())
    fail(file,
         "is an HDF5 file without demonstrations of robomimic (/data/demo_0/obs/robot0_eef_pos); write time, x, y, z "
         "as CSV, a row a sample");
  // demo_2 before demo_10.
  std::sort(names.begin(), names.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() < b.size() : a < b; });
  const auto all = fmt::format("{} demonstrations, {} to {}", names.size(), names.front(), names.back());
  if (wanted && wanted->empty() && names.size() > 1)
    fail(file, fmt::format("has {}: \"demonstration\" in the map names one", all));
  const std::string name = wanted && !wanted->empty() ? *wanted : names.front();
  if (std::find(names.begin(), names.end(), name) == names.end())
    fail(file, fmt::format("has no demonstration \"{}\"; it has {}", shown(name), all));
  const hdf5::Id observed = hdf5::group(H5Gopen2(data.get(), (name + "/obs").c_str(), H5P_DEFAULT));
  std::string columns = "sample";
  std::vector<std::pair<std::size_t, std::vector<double>>> sets;
  for (const std::string& position : observed.valid() ? namesIn(observed) : std::vector<std::string>()) {
    constexpr std::string_view ending = "eef_pos";
    if (!position.ends_with(ending)) continue;
    const std::string turn = position.substr(0, position.size() - 3) + "quat";
    for (const auto& [set, axes] : {std::pair(position, "xyz"), std::pair(turn, "xyzw")}) {
      const std::size_t width = std::string_view(axes).size();
      std::vector<double> values = rowsOf(observed, set, width);
      if (values.empty() || (!sets.empty() && values.size() / width != sets[0].second.size() / sets[0].first)) continue;
      for (const char axis : std::string_view(axes)) columns += fmt::format(",{}_{}", set, axis);
      sets.emplace_back(width, std::move(values));
    }
  }
  if (sets.empty())
    fail(file, fmt::format("/data/{} has no observations obs/robot0_eef_pos; robomimic's dataset_states_to_obs.py adds "
                           "them",
                           name));
  std::string text = fmt::format("robomimic,hdf5,control_freq,{},demonstrations,{}\n{}\n", controlFrequency(data),
                                 names.size(), columns);
  for (std::size_t row = 0; row < sets[0].second.size() / sets[0].first; ++row) {
    text += fmt::format("{}", row);
    for (const auto& [width, values] : sets) {
      for (std::size_t i = 0; i < width; ++i) text += fmt::format(",{}", values[row * width + i]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

bool isDemonstrations(std::string_view bytes) { return bytes.starts_with("\x89HDF\r"); }

std::string demonstrationTable(std::span<const std::byte> bytes, const std::string& file,
                               const std::optional<std::string>& wanted) {
  return runGuarded(file, [&] { return tableOf(bytes, file, wanted); });
}

}  // namespace calot::recorder
