// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/module.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::apps {
namespace {

/// A file that was cut off has lost the table of sections at its end; loading it would be a bus error.
bool isWhole(const std::filesystem::path& file) {
  Elf64_Ehdr head{};
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(&head), sizeof head);
  std::error_code ignored;
  return head.e_shoff != 0 && head.e_shoff + std::uint64_t{head.e_shnum} * head.e_shentsize <= file_size(file, ignored);
}

}  // namespace

const Module& loadModule(const std::string& name) {
  const std::filesystem::path folder = recorder::ProgramFiles::ofThisProgram().programs() / ".." / "lib" / "calot";
  const std::filesystem::path file = (folder / (name + ".so")).lexically_normal();
  const auto fail = [&](const std::string& why) {
    throw Error(ErrorKind::failure, Where{file.string()},
                why + "; install the package calot-modules, or in a clone run scripts/demo.sh --windows");
  };
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) fail("there is no such module");
  if (!isWhole(file)) fail("is not a whole module");
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) fail(fmt::format("cannot load the module ({})", dlerror()));
  void* const symbol = dlsym(library, "calotModule");
  if (symbol == nullptr) fail("is not a module");
  const Module& module = *reinterpret_cast<const Module* (*)()>(symbol)();
  if (std::string_view(module.build) != CALOT_MODULE_BUILD)
    fail(fmt::format("is of build {}, this program is of build {}", module.build, CALOT_MODULE_BUILD));
  return module;
}

}  // namespace calot::apps
