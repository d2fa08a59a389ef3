// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices: what there is, the commands below it, and a server to try a set-up without a tracker.
#include <map>

#include "apps/calot/command.h"
#include "apps/calot/source_options.h"
#include "gui/report/pdf_report.h"
#include "recorder/base/files.h"
#include "recorder/loop.h"
#include "recorder/sources/devices/force/force_server.h"
#include "recorder/sources/devices/openigtlink_device.h"

namespace calot::apps {
namespace {

struct PrintOptions {
  std::string output;
  bool force = false;
};

/// The sheets of handles and board as PDF.
void printSheets(const PrintOptions& o) {
  recorder::refuseOutput(o.output, o.force);
  recorder::writeText(o.output, gui::sheetsPdf(recorder::markerSheets(), recorder::softwareName(), recorder::tagCells),
                      o.force);
}

void printLine(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

struct SimulateOptions {
  std::string kinematics;
  std::string hands = "right";
  double delayMilliseconds = 0.0;
  recorder::ForceServerSettings settings;
};

const std::map<std::string, std::uint8_t> handBits{{"left", 1}, {"right", 2}, {"both", 3}};

void simulate(const SimulateOptions& o) {
  recorder::ForceServerSettings settings = o.settings;
  settings.hands = handBits.at(o.hands);
  settings.delay = 0.001 * o.delayMilliseconds;
  std::optional<recorder::DeviceScript> motion;
  if (!o.kinematics.empty()) motion = recorder::readDeviceScript(o.kinematics);
  stopOnSignals();
  recorder::ForceServer server(motion ? &*motion : nullptr, settings);
  printLine(fmt::format("a simulated force device, {} hand{}, at force:127.0.0.1:{}", o.hands,
                        o.hands == "both" ? "s" : "", server.port()));
  server.run(stopRequested(), printLine);
}

void listDevices(const JsonOption& o) {
  constexpr std::size_t detailAt = 25;
  nlohmann::json out = nlohmann::json::array();
  for (const recorder::ListedDevice& d : recorder::listDevices()) {
    out.push_back({{"name", d.name},
                   {"present", d.present},
                   {"detail", d.detail},
                   {"hands", d.hands},
                   {"senses", d.senses},
                   {"rate", d.rate}});
    if (o.json) continue;
    const std::string text = fmt::format("{}; {}; hands: {}; senses: {}; rate (1/s): {}",
                                         d.present ? "present" : "not present", d.detail, d.hands, d.senses, d.rate);
    fmt::print("{:<24} {}\n", d.name, wrappedText(text, terminalColumns(), detailAt, detailAt));
  }
  if (o.json) printResult("devices", {{"devices", out}});
}

struct ServeOptions {
  DeviceOptions device;
  std::string kinematics;
  recorder::OpenIgtLinkServerSettings settings;
};

void serve(const ServeOptions& o) {
  const recorder::DeviceScript motion = recorder::readDeviceScript(o.kinematics);
  recorder::OpenIgtLinkServerSettings settings = o.settings;
  settings.tool = toolsOf(o.device);
  stopOnSignals();
  recorder::serveOpenIgtLink(motion, settings, stopRequested(), printLine);
}

}  // namespace

void addDevices(CLI::App& app, Run& run) {
  const auto [devices, l] =
      addCommand(app, run, {"devices", "Lists input devices; measures one; plays one.", "calot devices"}, listDevices);
  devices->add_flag("--json", l->json, "print JSON");
  devices->require_subcommand(0, 1);

  const auto [print, p] = addCommand(
      *devices, run,
      {"print", "Handles and board for cameras, to print: a PDF, true to scale.", "calot devices print -o handles.pdf"},
      printSheets);
  print->add_option("-o,--output", p->output, "the PDF")->required();
  print->add_flag("--force", p->force, "replace the output if it is there");

  const auto [play, s] = addCommand(
      *devices, run,
      {"serve", "An OpenIGTLink server on this machine that plays a motion, to try a set-up without a tracker.",
       "calot devices serve --kinematics motion.txt --port 18944"},
      serve);
  play->add_option("--kinematics", s->kinematics, "two-handed motion file, 76 columns at 30 Hz, or a device script")
      ->required();
  addNumber(*play, "--port", s->settings.port, "0: any that is free", 0, 65535);
  addTools(*play, s->device);
  addNumber(*play, "--speed", s->settings.speed, "of the motion's time", 0.01, 100.0);
  play->add_flag("--once", s->settings.once, "end when the first client has gone");

  const auto [simulated, o] = addCommand(
      *devices, run,
      {"simulate", "A simulated force device in a simulated hand on this machine, to try forces without a device.",
       "calot devices simulate --hands both --delay 2"},
      simulate);
  simulated->add_option(
      "--kinematics", o->kinematics,
      "what the hand intends: a two-handed motion file or a device script; default: it reaches out and back");
  addNumber(*simulated, "--port", o->settings.port, "0: any that is free", 0, 65535);
  addChoice(*simulated, "--hands", o->hands, "left, right or both", {"left", "right", "both"});
  addNumber(*simulated, "--delay", o->delayMilliseconds, "before a force is shown, ms", 0.0, 50.0);
  simulated->add_flag("--once", o->settings.once, "end when the first client has gone");

  addCalibrateDevice(*devices, run);
}

}  // namespace calot::apps
