// SPDX-License-Identifier: GPL-3.0-or-later
// Modules are loaded when a command first needs them, so that the command line starts fast and is built and installed
// without their libraries. NAME_module.cpp is a module's side of its table, NAME_late.cpp the command line's.
#pragma once

#include <string>

namespace calot::apps {

/// A table of functions. A module holds static copies of the libraries that its functions use: only values and abstract
/// classes cross, and a table fits the program that was built with it alone.
struct Module {
  const char* build;  ///< CALOT_MODULE_BUILD
};

/// @return the table of <programs>/../lib/calot/NAME.so
/// @throws Error (failure) that names the file, where it is missing, damaged or of another build
const Module& loadModule(const std::string& name);

template <class Table>
const Table& module() {
  static const Table& table = static_cast<const Table&>(loadModule(Table::name));
  return table;
}

}  // namespace calot::apps
