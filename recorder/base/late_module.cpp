// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/late_module.h"

#include <dlfcn.h>
#include <filesystem>

#include "recorder/base/errors.h"
#include "recorder/base/program_files.h"

namespace calot::recorder {

const void* lateModule(const std::string& name) {
  const std::filesystem::path programs = ProgramFiles::ofThisProgram().programs();
  const std::string file = (programs / ".." / "lib" / "calot" / (name + ".so")).lexically_normal().string();
  if (!std::filesystem::exists(file))
    throw Error(ErrorKind::failure, Where{file}, "this part of the program is not installed; install it, or build all");
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw Error(ErrorKind::failure, Where{file}, ::dlerror());
  const auto* const version = static_cast<const char* const*>(::dlsym(library, "calotModuleVersion"));
  const void* const functions = ::dlsym(library, "calotModule");
  if (version == nullptr || functions == nullptr || std::string(*version) != CALOT_VERSION)
    throw Error(ErrorKind::failure, Where{file},
                "this part belongs to another version of the program; install both again");
  return functions;
}

}  // namespace calot::recorder
