// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a program that lie in files of their own and are loaded when they are first needed: a program that starts
// loads only the libraries that it uses, and can be built and installed without the others.
#pragma once

#include <string>

namespace calot::recorder {

/// The symbol `calotModule` of `<programs>/../lib/calot/NAME.so`, which stays loaded. A build tree has the folder, too.
/// A module brings its own copy of the libraries that it is linked with; the program's names stay hidden from it.
/// @throws Error (failure) where the file is missing, cannot be loaded, or belongs to another build of the program
const void* lateModule(const std::string& name);

/// The functions of a module, loaded at the first call. @tparam Functions the type of its `calotModule`
template <class Functions>
const Functions& lateFunctions(const std::string& name) {
  static const Functions& functions = *static_cast<const Functions*>(lateModule(name));
  return functions;
}

}  // namespace calot::recorder
