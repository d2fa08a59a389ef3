// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/state_file.h"

#include <fmt/format.h>

#include <system_error>

#include "recorder/base/files.h"
#include "recorder/recording/file_reader.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/probe.h"
#include "sim/math/fields.h"

namespace calot::recorder {

namespace {

constexpr const char* stateFormatName = "calot-state";

void writeAttribute(hid_t at, const char* name, std::uint64_t value) {
  const hdf5::Id space = hdf5::space(H5Screate(H5S_SCALAR));
  const hdf5::Id attribute =
      hdf5::attribute(H5Acreate2(at, name, H5T_STD_U64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT));
  H5Awrite(attribute.get(), H5T_NATIVE_UINT64, &value);
}

template <class T>
bool writeArray(hid_t at, const char* name, const std::vector<T>& values) {
  const hdf5::Id type = hdf5::elementType(storedAs<T>());
  const hsize_t size = values.size();
  const hdf5::Id space = hdf5::space(H5Screate_simple(1, &size, nullptr));
  const hdf5::Id properties = hdf5::properties(H5Pcreate(H5P_DATASET_CREATE));
  if (size > 0) {
    const hsize_t chunk = std::min<hsize_t>(size, 65536);
    H5Pset_chunk(properties.get(), 1, &chunk);
    H5Pset_fletcher32(properties.get());
  }
  const hdf5::Id set =
      hdf5::dataset(H5Dcreate2(at, name, type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT));
  return set.valid() &&
         (size == 0 || H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

template <class T>
void readArray(const std::filesystem::path& file, const std::string& place, hid_t set, std::vector<T>& out) {
  const hdf5::Id space = hdf5::space(H5Dget_space(set));
  hsize_t size = 0;
  if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Sget_simple_extent_dims(space.get(), &size, nullptr) < 0 ||
      size > (std::uint64_t{1} << 28U)) {
    throw hdf5::damaged(file, place, "is not a list of numbers");
  }
  out.resize(size);
  const hdf5::Id type = hdf5::elementType(storedAs<T>());
  if (size > 0 && H5Dread(set, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0) {
    throw hdf5::damaged(file, place, hdf5::reason());
  }
}

std::uint64_t readAttribute(const std::filesystem::path& file, hid_t at, const char* name) {
  const hdf5::Id attribute = hdf5::attribute(H5Aopen(at, name, H5P_DEFAULT));
  std::uint64_t value = 0;
  const hdf5::Id space = hdf5::space(attribute.valid() ? H5Aget_space(attribute.get()) : -1);
  if (!attribute.valid() || H5Sget_simple_extent_npoints(space.get()) != 1 ||
      H5Aread(attribute.get(), H5T_NATIVE_UINT64, &value) < 0) {
    throw hdf5::damaged(file, name, "this attribute is missing: is this a state that `calot state` wrote?");
  }
  return value;
}

/// The first name in a group.
std::string onlyMember(const std::filesystem::path& file, const std::string& place, const hdf5::Id& group) {
  char name[256] = {};
  if (!group.valid() ||
      H5Lget_name_by_idx(group.get(), ".", H5_INDEX_NAME, H5_ITER_INC, 0, name, sizeof name, H5P_DEFAULT) < 0)
    throw hdf5::damaged(file, place, "is missing, or holds no field");
  return name;
}

/// Reads everything; runs in the child.
StateFile readHere(const std::filesystem::path& path) {
  const hdf5::Session session;
  const hdf5::Id file = hdf5::open(path, H5F_ACC_RDONLY, hdf5::properties(H5Pcreate(H5P_FILE_ACCESS)));
  if (!file.valid()) throw hdf5::damaged(path, "/", "is not a state file that can be opened (" + hdf5::reason() + ")");
  checkShape(path, file, std::filesystem::file_size(path));
  StateFile state;
  readAttribute(path, file.get(), stateFormatName);
  state.step = readAttribute(path, file.get(), "step");
  state.simulationVersion = static_cast<std::uint32_t>(readAttribute(path, file.get(), "simulation_version"));
  const std::uint64_t count = readAttribute(path, file.get(), "fields");
  if (count > 100000) throw hdf5::damaged(path, "fields", "counts more than there can be");
  for (std::uint64_t f = 0; f < count; ++f) {
    const std::string group = fmt::format("/{:05}", f);
    const hdf5::Id open = hdf5::group(H5Gopen2(file.get(), group.c_str(), H5P_DEFAULT));
    const std::string name = onlyMember(path, group, open);
    const hdf5::Id component = hdf5::group(H5Gopen2(open.get(), name.c_str(), H5P_DEFAULT));
    const std::string field = onlyMember(path, group, component);
    const std::string place = group + "/" + name + "/" + field;
    const hdf5::Id set = hdf5::dataset(H5Dopen2(component.get(), field.c_str(), H5P_DEFAULT));
    if (!set.valid()) throw hdf5::damaged(path, place, hdf5::reason());
    const hdf5::Id type = hdf5::type(H5Dget_type(set.get()));
    StateField numbers{name + "/" + field, {}};
    if (H5Tget_class(type.get()) == H5T_FLOAT) {
      readArray(path, place, set.get(), numbers.values.emplace<0>());
    } else if (H5Tget_class(type.get()) == H5T_INTEGER) {
      readArray(path, place, set.get(), numbers.values.emplace<1>());
    } else {
      throw hdf5::damaged(path, place, "holds no numbers");
    }
    state.fields.push_back(std::move(numbers));
  }
  return state;
}

}  // namespace

void writeStateFile(const std::filesystem::path& file, std::uint64_t step, std::uint32_t simulationVersion,
                    const std::vector<StateField>& fields, bool force) {
  refuseOutput(file, force);
  std::string image;
  {
    const hdf5::Session session;
    const auto need = [&file](bool good) {
      if (!good)
        throw Error(ErrorKind::failure, Where{file.string()}, fmt::format("cannot be made ({})", hdf5::reason()));
    };
    const hdf5::Id access = hdf5::fileAccess(0);
    // In memory until it is whole: HDF5 does not survive every disk that fills up.
    H5Pset_fapl_core(access.get(), std::size_t{1} << 20U, false);
    hdf5::Id out = hdf5::file(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
    need(out.valid());
    writeAttribute(out.get(), stateFormatName, 1);
    writeAttribute(out.get(), "simulation_version", simulationVersion);
    writeAttribute(out.get(), "step", step);
    writeAttribute(out.get(), "fields", fields.size());
    const hdf5::Id links = hdf5::properties(H5Pcreate(H5P_LINK_CREATE));
    H5Pset_create_intermediate_group(links.get(), 1);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const std::string& name = fields[f].name;
      const std::size_t slash = name.find('/');
      const std::string group = fmt::format("/{:05}/{}", f, name.substr(0, slash));
      const hdf5::Id at = hdf5::group(H5Gcreate2(out.get(), group.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT));
      const std::string field = name.substr(slash + 1);
      need(at.valid() && std::visit([&](const auto& values) { return writeArray(at.get(), field.c_str(), values); },
                                    fields[f].values));
    }
    image = closedImage(out);
    need(!image.empty());
  }
  writeText(file, image, force);
}

StateFile readStateFile(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw Error(ErrorKind::damaged, Where{file.string()}, "no such file");
  // The library reads it once in a child: what makes it crash ends the child only.
  runGuarded(file.string(), [&] {
    readHere(file);
    return std::string();
  });
  return readHere(file);
}

}  // namespace calot::recorder
