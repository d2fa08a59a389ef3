// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/guided_steps.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <thread>
#include <vector>

#include "apps/calot/environment.h"
#include "apps/calot/stop_request.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/device_pump.h"

namespace calot::apps {
namespace {

struct Step {
  std::vector<const char*> phases;
  const char* text;
  double seconds;
};

/// Records the device through the steps that a person is guided through.
class GuidedRecording {
 public:
  explicit GuidedRecording(recorder::Device& device) : device_(device), pump_(device) {
    stream_.name = device.info().identity;
    stream_.file = device.info().name;
    stream_.rate = device.info().capabilities.rate;
  }

  void run(const Step& step) {
    promptStep(step.text);
    recorder::DeviceInput skipped;
    pump_.drain(skipped);
    const std::int64_t begin = recorder::monotonicNanoseconds();
    const auto length = static_cast<std::int64_t>(1e9 * step.seconds);
    const std::size_t before = stream_.samples.size();
    Progress progress("measuring, seconds");
    while (recorder::monotonicNanoseconds() < begin + length) {
      if (stopRequested()) throw Error(ErrorKind::failure, "calibrate: broken off");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      take(begin);
      progress.show(static_cast<std::uint64_t>((recorder::monotonicNanoseconds() - begin) / 1'000'000'000),
                    static_cast<std::uint64_t>(step.seconds));
    }
    take(begin);
    // The steps follow each other without the time in which nobody measured.
    for (const char* phase : step.phases) stream_.phases.push_back({phase, time_, time_ + length});
    time_ += length;
    if (stream_.samples.size() == before)
      throw Error(ErrorKind::failure, fmt::format("{}: no sample came", device_.info().detail));
  }

  [[nodiscard]] const recorder::DeviceScript& stream() const { return stream_; }

 private:
  void take(std::int64_t begin) {
    recorder::DeviceInput input;
    pump_.drain(input);
    for (recorder::DeviceSample sample : input.samples) {
      sample.hostTime += time_ - begin;
      if (sample.hostTime >= time_) stream_.samples.push_back(sample);
    }
  }

  recorder::Device& device_;
  recorder::DevicePump pump_;
  recorder::DeviceScript stream_;
  std::int64_t time_ = 0;
};

}  // namespace

void promptStep(const std::string& text) {
  fmt::print("{}\npress Enter to begin: ", text);
  std::fflush(stdout);
  std::string line;
  if (!std::getline(std::cin, line) || stopRequested()) throw Error(ErrorKind::failure, "calibrate: broken off");
}

void requireTerminal() {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
    throw Error(ErrorKind::invalid, "calibrate: the guided steps need a terminal; --from FILE takes a recorded stream");
}

recorder::DeviceScript guidedSteps(recorder::Device& device, double strokeMillimetres) {
  requireTerminal();
  stopOnSignals();
  GuidedRecording recording(device);
  recording.run({{"rest"}, "1. Put the tools down and touch nothing (5 s).", 5.0});
  if (device.info().capabilities.absolute && device.info().capabilities.sensedRotations == 3) {
    recording.run(
        {{"pivot"},
         "2. Hold each tool's tip in a dimple and tilt the tool by 30 degrees and more in all directions (20 s).",
         20.0});
  }
  const auto stroke = [&](const char* phase, int number, const char* way) {
    const std::string text =
        fmt::format("{}. Wait a second, move each tip by {:g} mm {}, and hold it there until the 6 seconds are over.",
                    number, strokeMillimetres, way);
    recording.run({{phase}, text.c_str(), 6.0});
  };
  stroke("stroke right", 3, "to the right");
  stroke("stroke down", 4, "down");
  stroke("stroke away", 5, "away from you");
  if (device.info().name == recorder::cameraKind.name) {
    recording.run({{"trocar"},
                   "6. Put the sticks through the trocars and sweep them by 20 degrees in all directions (15 s).",
                   15.0});
  }
  return recording.stream();
}

}  // namespace calot::apps
