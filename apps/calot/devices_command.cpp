// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices: what there is, the commands below it, and a server to try a set-up without a tracker.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/calot/calibrate_device.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "apps/calot/help.h"
#include "apps/calot/source_options.h"
#include "recorder/attempt.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"
#include "recorder/sources/devices/force/force_server.h"
#include "recorder/sources/devices/openigtlink_device.h"
#ifdef CALOT_PDF
#include "gui/report/pdf_report.h"
#endif

namespace calot::apps {
namespace {

/// `calot devices print`: the sheets of handles and board as PDF.
/// @throws Error: invalid, in a build without Qt, and as writeText does
void writeMarkerSheets(const std::string& file, bool force);

void writeMarkerSheets([[maybe_unused]] const std::string& file, [[maybe_unused]] bool force) {
#ifdef CALOT_PDF
  recorder::refuseOutput(file, force);
  recorder::writeText(file, gui::sheetsPdf(recorder::markerSheets(), recorder::softwareName(), recorder::tagCells),
                      force);
#else
  throw Error(ErrorKind::invalid, "this build writes no PDF");
#endif
}

/// Adds the command below `devices`. @returns it @param run is set to it where it was asked for
CLI::App* addSimulateDevice(CLI::App& devices, Run& run);

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
