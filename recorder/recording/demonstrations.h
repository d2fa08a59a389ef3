// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files of robot demonstrations as robomimic and robosuite write them ("robosuite Datasets" of robomimic's
// documentation): /data/demo_0/obs/robot0_eef_pos (T x 3, in a unit that is not stated) and robot0_eef_quat (T x 4: x,
// y, z, w), rows at the env_kwargs.control_freq (Hz) of the JSON in /data's attribute env_args.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace calot::recorder {

bool isDemonstrations(std::string_view bytes);

/// One demonstration as a comma-separated table: a line "robomimic,hdf5,control_freq,20,demonstrations,200", names
/// ("sample", "robot0_eef_pos_x", ..., "robot0_eef_quat_w"), a row a sample. The file is read in a process of its own.
/// @param wanted its name ("demo_3"); empty: the only one; none: the first of them
/// @throws Error damaged, naming the file: no such file, nothing of that name, several and none named
std::string demonstrationTable(std::span<const std::byte> bytes, const std::string& file,
                               const std::optional<std::string>& wanted);

}  // namespace calot::recorder
