// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices: what there is, the commands below it, and a server to try a set-up without a tracker.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calot/calibrate_device.h"
#include "apps/calot/commands.h"
#include "apps/calot/device_options.h"
#include "apps/calot/environment.h"
#include "apps/calot/marker_sheet_file.h"
#include "apps/calot/results.h"
#include "apps/calot/simulate_device.h"
#include "apps/calot/stop_request.h"
#include "apps/calot/terminal_text.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/openigtlink_device.h"

namespace calot::apps {
namespace {

int listDevicesFound(bool asJson) {
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
    printResult("devices", {{"devices", out}});
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

struct PrintOptions {
  std::string output;
  bool force = false;
};

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

  auto p = std::make_shared<PrintOptions>();
  CLI::App* print = command->add_subcommand("print", "Handles and board for cameras, to print: a PDF, true to scale.");
  print->add_option("-o,--output", p->output, "the PDF")->required();
  print->add_flag("--force", p->force, "replace the output if it is there");

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
  CLI::App* measure = addCalibrateDevice(*command, run);
  command->callback([=, &run] {
    if (simulate->parsed() || measure->parsed()) return;
    if (print->parsed())
      run = [p] {
        writeMarkerSheets(p->output, p->force);
        return 0;
      };
    else if (play->parsed())
      run = [s] { return serve(*s); };
    else
      run = [asJson] { return listDevicesFound(*asJson); };
  });
}

}  // namespace calot::apps
