// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/inspect_text.h"
#include "apps/calot/results.h"
#include "apps/calot/terminal_text.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/step_watch.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

using nlohmann::ordered_json;

struct Attributes {
  ordered_json& json;
  template <class T>
  void operator()(const char* name, const T& value) {
    json[name] = value;
  }
  template <class T>
  void constant(const char* name, const T& value) {
    json[name] = value;
  }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    json[name] = names[static_cast<std::size_t>(value)];
  }
};

/// How a run at real time kept its deadlines, by the lateness of its ticks and steps' events; and how many of its steps
/// missed a tolerance.
void describeSteps(recorder::Recording& recording, ordered_json& out) {
  std::uint64_t missed = 0;
  float worst = 0.0F;
  double stretched = 0.0;
  recorder::StepMisses misses;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    misses.add(step.result.misses);
    for (const recorder::TickOutcome& tick : step.ticks) {
      if (tick.lateness > recorder::tickDeadline) ++missed;
      worst = std::max(worst, tick.lateness);
    }
    for (const Event& event : step.result.events) {
      if (event.kind == EventKind::clockStretched) stretched += event.value;
    }
  }
  out["missed_deadlines"] = missed;
  out["largest_lateness_s"] = worst;
  out["clock_stretched_s"] = stretched;
  out["steps_missed_tolerance"] = misses.any;
  out["steps_missed_by_solver"] = misses.solver;
  out["steps_missed_by_contact"] = misses.contact;
  out["steps_held_back"] = misses.heldBack;
}

/// What the device measured, by hand.
ordered_json describeDevice(recorder::Recording& recording) {
  ordered_json out;
  for (const Hand hand : {Hand::left, Hand::right}) {
    const recorder::RawStatistics s = recorder::rawStatistics(recording, hand);
    out[handNames[static_cast<std::size_t>(hand)]] = {{"samples", s.samples},
                                                      {"valid", s.valid},
                                                      {"used", s.used},
                                                      {"dropped", s.dropped},
                                                      {"missing", s.missing},
                                                      {"rate_hz", s.rate},
                                                      {"longest_interval_s", s.maxInterval}};
  }
  return out;
}

ordered_json describe(recorder::Recording& recording, const recorder::ChainVerdict& chain) {
  const recorder::AttemptHeader& header = recording.header();
  ordered_json out;
  out["file"] = recording.path().string();
  out["state"] = recording.complete() ? "complete" : "incomplete";
  out["outcome"] = recorder::outcomeNames[static_cast<std::size_t>(recording.outcome())];
  out["seconds"] = recording.seconds();
  out["steps"] = recording.stepCount();
  out["ticks"] = recording.tickCount();
  out["events"] = recording.eventCount();
  out["keyframes"] = recording.keyframeSteps().size();
  describeSteps(recording, out);
  if (header.deviceSamples) out["device_samples"] = describeDevice(recording);
  out["flushes"] = recording.status().size() - 1;
  out["chain"] = chain.intact ? "intact" : "broken";
  if (!chain.intact) out["chain_broken_at_flush"] = chain.flush;
  const std::string head = toHex(recording.status().back().chain);
  out["chain_head"] = head;
  const std::optional<recorder::RecordedSignature>& signature = recording.signature();
  out["signature"] = !signature                                         ? "none"
                     : !signature->value                                ? "unfinished: its writer was killed"
                     : signature->fits(recording.status().back().chain) ? "valid"
                                                                        : "invalid";
  if (signature) out["public_key"] = toHex(signature->publicKey);
  out["this_simulation_version"] = simulationVersion;
  ordered_json bytes;
  std::uint64_t whole = 0;
  for (const recorder::StoredBytes& part : recorder::storedBytes(recording.path())) {
    bytes[part.group] = part.bytes;
    whole += part.bytes;
  }
  out["bytes"] = whole;
  out["bytes_by_group"] = bytes;
  ordered_json attributes;
  Attributes visit{attributes};
  recorder::visitAttributes(header, visit);
  out["attempt"] = attributes;
  out["organs"] = header.organs;
  out["vessels"] = header.vessels;
  out["fat"] = header.fat;
  ordered_json assets = ordered_json::array();
  for (const recorder::Asset& asset : header.assets)
    assets.push_back({{"name", asset.name}, {"bytes", asset.bytes.size()}});
  out["scene_files"] = assets;
  return out;
}

}  // namespace

void addInspect(CLI::App& app, Run& run) {
  struct Options {
    std::string file, key;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("inspect", "Say what a recording holds, and whether its content chain is intact");
  command->add_option("recording", options->file, "Recording (.h5)")->required();
  command->add_option("--public-key", options->key, "The key that must have signed it; else the exit code is 3");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &run] {
    run = [options] {
      const recorder::ChainVerdict chain = recorder::probe(options->file);
      recorder::Recording recording(options->file);
      const ordered_json d = describe(recording, chain);
      if (options->json) {
        printResult("inspect", d);
      } else {
        fmt::print("{}", inspectText(d, terminalColumns()));
      }
      if (!options->key.empty()) {
        const auto wanted = fromHex<32>(options->key, "--public-key");
        const auto& signature = recording.signature();
        const bool by = signature && signature->value && toHex(signature->publicKey) == toHex(wanted);
        if (!by && chain.intact)
          throw Error(ErrorKind::refused, fmt::format("{}: not signed by that key", options->file));
      }
      if (!chain.intact) throw Error(ErrorKind::refused, fmt::format("{}: {}", options->file, chain.what));
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
