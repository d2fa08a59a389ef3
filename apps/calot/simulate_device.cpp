// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/simulate_device.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "apps/calot/stop_request.h"
#include "apps/calot/wrong_word.h"
#include "recorder/sources/devices/force/force_server.h"

namespace calot::apps {
namespace {

struct SimulateOptions {
  std::string kinematics;
  std::string hands = "right";
  double delayMilliseconds = 0.0;
  recorder::ForceServerSettings settings;
};

const std::map<std::string, std::uint8_t> handBits{{"left", 1}, {"right", 2}, {"both", 3}};

int simulate(const SimulateOptions& o) {
  recorder::ForceServerSettings settings = o.settings;
  settings.hands = handBits.at(o.hands);
  settings.delay = 0.001 * o.delayMilliseconds;
  std::optional<recorder::DeviceScript> motion;
  if (!o.kinematics.empty()) motion = recorder::readDeviceScript(o.kinematics);
  stopOnSignals();
  recorder::ForceServer server(motion ? &*motion : nullptr, settings);
  fmt::print("a simulated force device, {} hand{}, at force:127.0.0.1:{}\n", o.hands, o.hands == "both" ? "s" : "",
             server.port());
  std::fflush(stdout);
  server.run(stopRequested(), [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return 0;
}

}  // namespace

CLI::App* addSimulateDevice(CLI::App& devices, Run& run) {
  auto o = std::make_shared<SimulateOptions>();
  CLI::App* command = devices.add_subcommand(
      "simulate", "A simulated force device in a simulated hand on this machine, to try forces without a device.");
  command->add_option(
      "--kinematics", o->kinematics,
      "what the hand intends: a two-handed motion file or a device script; default: it reaches out and back");
  command->add_option("--port", o->settings.port, "0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_option("--hands", o->hands, "left, right or both")
      ->check(oneOf({"left", "right", "both"}))
      ->capture_default_str();
  command->add_option("--delay", o->delayMilliseconds, "before a force is shown, ms")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  command->add_flag("--once", o->settings.once, "end when the first client has gone");
  command->callback([o, &run] { run = [o] { return simulate(*o); }; });
  return command;
}

}  // namespace calot::apps
