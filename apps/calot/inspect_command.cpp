// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/inspect_command.h"

#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/recording/recover.h"
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

/// Measurements of the device, by hand.
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

namespace {

using nlohmann::ordered_json;
using Lines = std::vector<std::pair<std::string, std::string>>;

/// Headings in their order, each with the members that stand under it. What no heading names stands under the attempt.
struct Group {
  const char* heading;
  std::vector<std::string_view> members;
};

const std::vector<Group>& groups() {
  static const std::vector<Group> all{
      {"Recording", {"file", "state", "outcome", "seconds", "steps", "ticks", "events", "keyframes", "flushes"}},
      {"Integrity", {"chain", "chain_broken_at_flush", "chain_head", "signature", "public_key"}},
      {"Real time", {"missed_deadlines", "largest_lateness_s", "clock_stretched_s"}},
      {"Tolerances",
       {"steps_missed_tolerance", "steps_missed_by_solver", "steps_missed_by_contact", "steps_held_back"}},
      {"Device", {}},
      {"Attempt", {}},
      {"Versions",
       {"format", "format_version", "software", "build", "simulation_version", "this_simulation_version",
        "step_result_version"}},
      {"Scene", {"scene_name", "scene_major", "scene_minor", "organs", "vessels", "fat"}},
      {"Size", {"bytes"}},
  };
  return all;
}

std::string headingOf(const std::string& member) {
  for (const Group& group : groups()) {
    if (std::find(group.members.begin(), group.members.end(), member) != group.members.end()) return group.heading;
  }
  return "Attempt";
}

std::string shown(const ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  std::string list;
  for (const ordered_json& each : value) list += (list.empty() ? "" : ", ") + shown(each);
  return list;
}

std::string shareOf(const ordered_json& bytes, const ordered_json& whole) {
  const auto all = whole.get<double>();
  return fmt::format("{} ({:.1f} %)", shown(bytes), all > 0.0 ? 100.0 * bytes.get<double>() / all : 0.0);
}

std::string deviceOf(const ordered_json& s) {
  return fmt::format(
      "{} ({} valid, {} used by ticks, {} dropped, {} missing), {:.1f} a second, {:.0f} ms apart at most",
      shown(s["samples"]), shown(s["valid"]), shown(s["used"]), shown(s["dropped"]), shown(s["missing"]),
      s["rate_hz"].get<double>(), 1e3 * s["longest_interval_s"].get<double>());
}

/// The lines under one heading.
Lines linesOf(const ordered_json& d, const std::string& heading) {
  Lines lines;
  const auto take = [&](const std::string& member, const ordered_json& value) {
    if (headingOf(member) == heading && !shown(value).empty()) lines.emplace_back(member, shown(value));
  };
  for (const auto& [member, value] : d.items()) {
    if (member == "attempt") {
      for (const auto& [name, attribute] : value.items()) take(name, attribute);
    } else if (member == "scene_files") {
      if (heading != "Scene") continue;
      for (const auto& asset : value)
        lines.emplace_back("scene file", fmt::format("{} ({} bytes)", shown(asset["name"]), shown(asset["bytes"])));
    } else if (member == "bytes_by_group") {
      if (heading != "Size") continue;
      for (const auto& [group, bytes] : value.items())
        lines.emplace_back("bytes, " + group, shareOf(bytes, d["bytes"]));
    } else if (member == "device_samples") {
      if (heading != "Device") continue;
      for (const auto& [hand, samples] : value.items()) lines.emplace_back("device, " + hand, deviceOf(samples));
    } else {
      take(member, value);
    }
  }
  return lines;
}

}  // namespace

std::string inspectText(const ordered_json& recording, std::size_t columns) {
  constexpr std::size_t valueAt = 27;
  std::string text;
  for (const Group& group : groups()) {
    const Lines lines = linesOf(recording, group.heading);
    if (lines.empty()) continue;
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", group.heading);
    for (const auto& [name, value] : lines)
      text += fmt::format("  {:<24} {}\n", name, wrappedText(value, columns, valueAt, valueAt));
  }
  return text;
}

void addRecover(CLI::App& app, Run& run) {
  struct Options {
    std::string in, out;
    bool force = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("recover", "Rewrite a recording that was cut off or whose writer was killed");
  command->add_option("recording", options->in, "Recording (.h5)")->required();
  command->add_option("-o,--output", options->out, "File to write")->required();
  command->add_flag("--force", options->force, "Replace the output if it is there");
  command->callback([options, &run] {
    run = [options] {
      const recorder::Recovered saved = recorder::recover(options->in, options->out, options->force);
      fmt::print("{}: {} steps, {} ticks saved, {}\n", options->out, saved.steps, saved.ticks,
                 saved.complete ? "complete" : "incomplete");
      if (!saved.lost.empty()) fmt::print("the rest is lost: {}\n", saved.lost);
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
