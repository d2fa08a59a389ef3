// SPDX-License-Identifier: GPL-3.0-or-later
// calot-engine: the simulation of this version as a program (schemas/engine.md). Requests on standard input, answers on
// standard output. It first gives up everything else.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>
#include <vector>

#include "apps/calot-engine/confine.h"
#include "recorder/engine/engine_server.h"

namespace {

/// @return false at the end of the input, or where it cannot be read
bool readAll(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

bool writeAll(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

int serve(calot::recorder::Confinement confinement) {
  using namespace calot::recorder;
  EngineServer server("calot-engine " CALOT_VERSION, confinement);
  std::array<std::byte, messageHead> bytes{};
  std::vector<std::byte> payload;
  while (readAll(bytes)) {
    const MessageHead head = parseHead(bytes);
    if (head.length > maxPayload) {
      writeAll(encode(wire::Fault{wire::FaultCode::message, "a message has 2^30 bytes at most"}));
      return 4;
    }
    // Grown as it comes: a length alone costs nothing.
    payload.clear();
    while (payload.size() < head.length) {
      constexpr std::size_t piece = std::size_t{1} << 20U;
      const std::size_t at = payload.size();
      payload.resize(std::min<std::size_t>(static_cast<std::size_t>(head.length), at + piece));
      if (!readAll(std::span(payload).subspan(at))) return 4;
    }
    if (!writeAll(server.answer(head.kind, payload))) return 1;
    if (server.ended()) return 4;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const bool version = std::strcmp(argv[1], "--version") == 0;
    std::FILE* out = version || std::strcmp(argv[1], "--help") == 0 ? stdout : stderr;
    std::fprintf(out, version ? "calot-engine " CALOT_VERSION "\n"
                              : "calot-engine: decides recordings for calot, which starts it. It takes requests on its "
                                "standard input and no arguments.\n");
    return out == stdout ? 0 : 2;
  }
  if (isatty(STDIN_FILENO) != 0) {
    std::fprintf(stderr, "calot-engine: is started by calot, and takes no input from a terminal\n");
    return 2;
  }
  return serve(calot::apps::confine());
}
