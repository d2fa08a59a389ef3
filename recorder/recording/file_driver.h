// SPDX-License-Identifier: GPL-3.0-or-later
// How the writer's file reaches the disk. Internal to this folder.
#pragma once

#include <hdf5.h>

namespace calot::recorder::hdf5 {

/// Sets a driver of our own for a file that is opened with these properties: POSIX reads and writes as the library's
/// own has them, but for this: after freeze() nothing is written any more.
///
/// A file whose disk is full must stay as it is: the library goes on trying to write its cache until the file is
/// closed, in an order that endangers what was flushed. It must be closed all the same, or the library is left with
/// half of it when the program ends; so what is written then succeeds and goes nowhere.
/// @return false where the library refuses
bool useOwnDriver(hid_t fileAccess);

/// From now on nothing is written to this file. Nothing happens where it was not opened by that driver.
void freeze(hid_t file);

}  // namespace calot::recorder::hdf5
