// SPDX-License-Identifier: GPL-3.0-or-later
// Linked into test programs with threads of other libraries (windows, pictures): one that crashes says where, since on
// another machine it may never do so again.
#include <array>
#include <csignal>

#include <execinfo.h>
#include <unistd.h>

namespace {

extern "C" void writeTrace(int signal) {
  std::array<void*, 64> frames{};
  ::backtrace_symbols_fd(frames.data(), ::backtrace(frames.data(), static_cast<int>(frames.size())), STDERR_FILENO);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

const bool installed = [] {
  std::array<void*, 1> first{};
  ::backtrace(first.data(), 1);  // loads what it needs now, not within a handler
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, writeTrace);
  return true;
}();

}  // namespace
