// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/probe.h"

#include <fmt/format.h>

#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "recorder/recording/guard_process.h"
#include "recorder/recording/guarded.h"

namespace calot::recorder {

namespace {

/// The verdict as text: intact, flush, first and last step, words.
std::string readThrough(const std::string& file) {
  Recording recording(file);
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) recording.step(n);
  const ChainVerdict v = recording.verifyChain();
  return fmt::format("{} {} {} {} {}", v.intact ? 1 : 0, v.flush, v.firstStep, v.endStep, v.what);
}

ChainVerdict verdictIn(const std::string& answer) {
  ChainVerdict verdict;
  std::size_t at = 0;
  const auto number = [&] {
    std::uint64_t value = 0;
    for (; at < answer.size() && answer[at] != ' '; ++at)
      value = value * 10 + static_cast<std::uint64_t>(answer[at] - '0');
    ++at;
    return value;
  };
  verdict.intact = number() == 1;
  verdict.flush = number();
  verdict.firstStep = number();
  verdict.endStep = number();
  verdict.what = at < answer.size() ? answer.substr(at) : "";
  return verdict;
}

/// The processes of this program, while there are some.
struct Shared {
  std::mutex lock;
  std::shared_ptr<GuardProcesses> processes;
};

Shared& shared() {
  static Shared one;
  return one;
}

}  // namespace

ChainVerdict probe(const std::filesystem::path& path) {
  std::shared_ptr<GuardProcesses> processes;
  {
    const std::lock_guard<std::mutex> held(shared().lock);
    processes = shared().processes;
  }
  const std::string file = path.string();
  const GuardLimits limits = readingLimits(path);
  return verdictIn(processes ? processes->run(file, limits)
                             : runGuarded(
                                   file, [&] { return readThrough(file); }, limits));
}

ProbeProcesses::ProbeProcesses(unsigned count) {
  const std::lock_guard<std::mutex> held(shared().lock);
  first_ = shared().processes == nullptr;
  if (first_)
    shared().processes =
        std::make_shared<GuardProcesses>(readThrough, count == 0 ? std::thread::hardware_concurrency() : count);
}

ProbeProcesses::~ProbeProcesses() {
  if (!first_) return;
  const std::lock_guard<std::mutex> held(shared().lock);
  shared().processes.reset();
}

}  // namespace calot::recorder
