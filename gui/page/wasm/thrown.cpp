// SPDX-License-Identifier: GPL-3.0-or-later
// What the page's modules have in common: a place for the host's bytes, and what becomes of an exception in a module
// that cannot unwind. Its text is kept and the module traps; the host reads the text and makes a new module.
#include "gui/page/wasm/thrown.h"

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <string>
#include <typeinfo>

namespace {

std::string& text() {
  static std::string one;
  return one;
}

}  // namespace

namespace calot::page {

std::vector<std::byte>& placed() {
  static std::vector<std::byte> bytes;
  return bytes;
}

}  // namespace calot::page

extern "C" {

__attribute__((export_name("calot_place"))) std::byte* calot_place(std::uint32_t length) {
  calot::page::placed().resize(length);
  return calot::page::placed().data();
}

/// Message of the exception, zero-terminated; empty if there was none.
__attribute__((export_name("calot_thrown"))) const char* calot_thrown() { return text().c_str(); }

void* __cxa_allocate_exception(std::size_t bytes) noexcept { return std::malloc(bytes); }

/// Everything that these modules throw is a std::exception, and its first base.
[[noreturn]] void __cxa_throw(void* thrown, std::type_info* /*type*/, void (* /*destroy*/)(void*)) {
  text() = static_cast<std::exception*>(thrown)->what();
  __builtin_trap();
}

}  // extern "C"
