// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices: what there is, what it measures like, and a server to try a set-up without a tracker.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/calot/commands.h"
#include "apps/calot/device_options.h"
#include "apps/calot/environment.h"
#include "apps/calot/simulate_device.h"
#include "apps/calot/stop_request.h"
#include "apps/calot/terminal_text.h"
#include "recorder/errors.h"
#include "recorder/formats/text_output.h"
#include "recorder/sources/devices/calibration_fit.h"
#include "recorder/sources/devices/device_pump.h"
#include "recorder/sources/devices/openigtlink_server.h"

namespace calot::apps {
namespace {

int list(bool asJson) {
  const std::vector<recorder::ListedDevice> devices = recorder::listDevices();
  if (asJson) {
    nlohmann::json out = nlohmann::json::array();
    for (const recorder::ListedDevice& d : devices) {
      out.push_back({{"name", d.name},
                     {"present", d.present},
                     {"detail", d.detail},
                     {"hands", d.hands},
                     {"senses", d.senses},
                     {"rate", d.rate}});
    }
    fmt::print("{}\n", nlohmann::json{{"devices", out}}.dump(2));
    return 0;
  }
  constexpr std::size_t detailAt = 25;
  for (const recorder::ListedDevice& d : devices) {
    const std::string text = fmt::format("{}; {}; hands: {}; senses: {}; rate (1/s): {}",
                                         d.present ? "present" : "not present", d.detail, d.hands, d.senses, d.rate);
    fmt::print("{:<24} {}\n", d.name, wrappedText(text, terminalColumns(), detailAt, detailAt));
  }
  return 0;
}

struct CalibrateOptions {
  DeviceOptions device;
  std::string from, stream, output;
  double strokeMillimetres = 100.0;
  std::uint32_t validDays = 30;
  bool force = false, json = false;
};

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
    fmt::print("{}\npress Enter to begin: ", step.text);
    std::fflush(stdout);
    std::string line;
    if (!std::getline(std::cin, line) || stopRequested()) throw Error(ErrorKind::failure, "calibrate: broken off");
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

recorder::DeviceScript guided(recorder::Device& device, double strokeMillimetres) {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
    throw Error(ErrorKind::invalid, "calibrate: the guided steps need a terminal; --from FILE takes a recorded stream");
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
  return recording.stream();
}

void printCalibration(const recorder::Calibration& c, const std::vector<std::string>& faults) {
  fmt::print("{} ({})\n", c.identity, c.date);
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!c.hand[h]) continue;
    const recorder::HandCalibration& m = *c.hand[h];
    fmt::print("{}:\n", handNames[h]);
    if (m.tipOffset) {
      fmt::print("  tip offset       {:.2f} {:.2f} {:.2f} mm\n", 1e3 * m.tipOffset->x(), 1e3 * m.tipOffset->y(),
                 1e3 * m.tipOffset->z());
      fmt::print("  pivot residual   {:.3f} mm\n", 1e3 * *m.pivotResidual);
    } else {
      fmt::print("  tip offset       not measured\n");
    }
    if (m.scale) {
      fmt::print("  scale            {:.4f}, strokes apart by {:.1f} %\n", *m.scale, 100.0 * *m.scaleSpread);
      fmt::print("  axes             within {:.1f} degrees\n", 57.29577951308232 * *m.axesResidual);
    } else {
      fmt::print("  scale, axes      not measured\n");
    }
    fmt::print("  noise at rest    {:.3f} {:.3f} {:.3f} mm\n", 1e3 * m.noise.x(), 1e3 * m.noise.y(), 1e3 * m.noise.z());
    fmt::print("  rate             {:.1f} a second, intervals {:.2f} ms sd, {:.2f} ms at 99 %\n", m.rate,
               1e3 * m.jitter, 1e3 * m.longInterval);
    fmt::print("  invalid          {:.1f} %\n", 100.0 * m.invalidShare);
  }
  fmt::print("latency: {}\nforce: {}\n", c.latency, c.force);
  for (const std::string& fault : faults) fmt::print("falls short: {}\n", fault);
  fmt::print("{}\n", faults.empty() ? fmt::format("passed; valid for {} days", c.validDays) : "failed");
}

int calibrate(const CalibrateOptions& o) {
  recorder::refuseOutput(o.output, o.force);
  if (!o.stream.empty()) recorder::refuseOutput(o.stream, o.force);
  const recorder::OpenedDevice opened = recorder::openDevice(o.device.name, toolsOf(o.device));
  if (o.from.empty() && opened.tickClock) {
    throw Error(ErrorKind::invalid,
                fmt::format("calibrate {}: a device without real time is measured with --from FILE", o.device.name));
  }
  const recorder::DeviceScript stream =
      o.from.empty() ? guided(*opened.device, o.strokeMillimetres) : recorder::readDeviceScript(o.from);
  recorder::Calibration calibration =
      recorder::measureCalibration(stream, 1e-3 * o.strokeMillimetres, opened.device->info());
  calibration.validDays = o.validDays;
  const std::vector<std::string> faults = recorder::shortcomings(calibration);
  if (!o.stream.empty()) recorder::writeText(o.stream, recorder::deviceScriptText(stream), o.force);
  recorder::writeText(o.output, recorder::calibrationText(calibration, false), o.force);
  if (o.json)
    fmt::print("{}", recorder::calibrationText(calibration, false));
  else
    printCalibration(calibration, faults);
  if (faults.empty()) return 0;
  throw Error(ErrorKind::refused, fmt::format("{}: the calibration failed: {}", o.output, faults.front()));
}

struct ServeOptions {
  DeviceOptions device;
  std::string kinematics;
  recorder::OpenIgtLinkServerSettings settings;
};

int serve(const ServeOptions& o) {
  const recorder::DeviceScript motion = recorder::readDeviceScript(o.kinematics);
  recorder::OpenIgtLinkServerSettings settings = o.settings;
  settings.tool = toolsOf(o.device);
  stopOnSignals();
  recorder::OpenIgtLinkServer server(motion, settings);
  fmt::print("listening on 127.0.0.1:{}\n", server.port());
  std::fflush(stdout);
  server.run(stopRequested(), [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return 0;
}

}  // namespace

void addDevices(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("devices", "Lists input devices; measures one; plays one.");
  const auto asJson = std::make_shared<bool>(false);
  command->add_flag("--json", *asJson, "print JSON");
  command->require_subcommand(0, 1);

  auto c = std::make_shared<CalibrateOptions>();
  CLI::App* measure = command->add_subcommand("calibrate", "Measures a device in guided steps and stores the result.");
  measure->add_option("device", c->device.name, "as for record --device")->required();
  addTools(*measure, c->device);
  measure->add_option("--from", c->from, "measure this stream instead, recorded by --keep-stream");
  measure->add_option("--keep-stream", c->stream, "write what was measured from, for --from");
  measure->add_option("--stroke", c->strokeMillimetres, "length of each stroke, mm")
      ->check(CLI::Range(10.0, 1000.0))
      ->capture_default_str();
  measure->add_option("--valid-days", c->validDays, "from today on")->check(CLI::Range(1, 3650))->capture_default_str();
  measure->add_option("-o,--output", c->output, "the calibration, a JSON file")->required();
  measure->add_flag("--force", c->force, "replace the outputs if they are there");
  measure->add_flag("--json", c->json, "print the result as JSON");

  auto s = std::make_shared<ServeOptions>();
  CLI::App* play = command->add_subcommand(
      "serve", "An OpenIGTLink server on this machine that plays a motion, to try a set-up without a tracker.");
  play->add_option("--kinematics", s->kinematics, "two-handed motion file, 76 columns at 30 Hz, or a device script")
      ->required();
  play->add_option("--port", s->settings.port, "0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  addTools(*play, s->device);
  play->add_option("--speed", s->settings.speed, "of the motion's time")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  play->add_flag("--once", s->settings.once, "end when the first client has gone");

  CLI::App* simulate = addSimulateDevice(*command, run);
  command->callback([=, &run] {
    if (simulate->parsed()) return;
    if (measure->parsed())
      run = [c] { return calibrate(*c); };
    else if (play->parsed())
      run = [s] { return serve(*s); };
    else
      run = [asJson] { return list(*asJson); };
  });
}

}  // namespace calot::apps
