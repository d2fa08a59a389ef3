// SPDX-License-Identifier: GPL-3.0-or-later
// The engine as a WebAssembly module: a host puts requests into its memory and finds answers there (schemas/engine.md,
// "As a WebAssembly module"). Its exceptions do not unwind: the first one is the engine's last word.
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/engine/engine_server.h"

namespace {

using calot::recorder::EngineServer;

EngineServer& server() {
  static EngineServer one("calot-engine " CALOT_VERSION, calot::recorder::Confinement::byHost);
  return one;
}

std::vector<std::byte>& request() {
  static std::vector<std::byte> bytes;
  return bytes;
}

std::vector<std::byte>& lastWords() {
  static std::vector<std::byte> bytes;
  return bytes;
}

}  // namespace

extern "C" {

__attribute__((export_name("calot_request"))) std::byte* calot_request(std::uint32_t length) {
  request().resize(length);
  return request().data();
}

__attribute__((export_name("calot_answer"))) const std::byte* calot_answer() {
  using namespace calot::recorder;
  const std::vector<std::byte>& bytes = request();
  if (server().ended() || bytes.size() < messageHead) return nullptr;
  const MessageHead head = parseHead(bytes);
  if (head.length != bytes.size() - messageHead) return nullptr;
  return server().answer(head.kind, std::span(bytes).subspan(messageHead)).data();
}

__attribute__((export_name("calot_fault"))) const std::byte* calot_fault() {
  return lastWords().empty() ? nullptr : lastWords().data();
}

// Replaces the C++ runtime's throw in a module that cannot unwind: everything that the engine throws is
// a std::exception, and its first base.
void* __cxa_allocate_exception(std::size_t bytes) noexcept { return std::malloc(bytes); }

[[noreturn]] void __cxa_throw(void* thrown, std::type_info* type, void (* /*destroy*/)(void*)) {
  using namespace calot::recorder;
  wire::Fault fault{wire::FaultCode::other, static_cast<std::exception*>(thrown)->what()};
  if (*type == typeid(std::out_of_range)) fault.code = wire::FaultCode::contactSet;
  if (*type == typeid(calot::Error)) fault.code = wire::FaultCode::scene;
  lastWords() = encode(fault);
  __builtin_trap();
}

}  // extern "C"
