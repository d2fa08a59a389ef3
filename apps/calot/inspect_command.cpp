// SPDX-License-Identifier: GPL-3.0-or-later
// calot inspect and calot recover: a recording as it is, and one that was cut off.

#include <algorithm>
#include <map>

#include "analytics/checkpoints/replay_words.h"
#include "apps/calot/command.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/recording/recover.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"

namespace calot::apps {
namespace {

/// How a run at real time kept its deadlines, by the lateness of its ticks and steps' events; and how many of its steps
/// missed a tolerance.
void describeSteps(recorder::Recording& recording, Json& out, Progress& progress) {
  std::uint64_t missed = 0;
  float worst = 0.0F;
  double stretched = 0.0;
  recorder::StepMisses misses;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    progress.show(n, recording.stepCount());
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
Json describeDevice(recorder::Recording& recording) {
  Json out;
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

Json describe(recorder::Recording& recording, const recorder::ChainVerdict& chain, Progress& progress) {
  const recorder::AttemptHeader& header = recording.header();
  Json out;
  out["file"] = recording.path().string();
  out["state"] = recording.complete() ? "complete" : "incomplete";
  out["outcome"] = recorder::outcomeNames[static_cast<std::size_t>(recording.outcome())];
  out["seconds"] = recording.seconds();
  out["steps"] = recording.stepCount();
  out["ticks"] = recording.tickCount();
  out["events"] = recording.eventCount();
  out["keyframes"] = recording.keyframeSteps().size();
  describeSteps(recording, out, progress);
  if (header.deviceSamples) out["device_samples"] = describeDevice(recording);
  out["flushes"] = recording.status().size() - 1;
  out["chain"] = chain.intact() ? "intact" : "broken";
  if (!chain.intact()) out["chain_broken_at_flush"] = chain.flush;
  const std::string head = recorder::hexOf(recording.status().back().chain);
  out["chain_head"] = head;
  const std::optional<recorder::RecordedSignature>& signature = recording.signature();
  out["signature"] = !signature                                         ? "none"
                     : !signature->value                                ? "unfinished: its writer was killed"
                     : signature->fits(recording.status().back().chain) ? "valid"
                                                                        : "invalid";
  if (signature) out["public_key"] = recorder::hexOf(signature->publicKey);
  out["this_simulation_version"] = simulationVersion;
  Json bytes;
  std::uint64_t whole = 0;
  for (const recorder::StoredBytes& part : recorder::storedBytes(recording.path())) {
    bytes[part.group] = part.bytes;
    whole += part.bytes;
  }
  out["bytes"] = whole;
  out["bytes_by_group"] = bytes;
  Json attributes;
  recorder::forEachAttribute(header, [&](const char* name, const auto& value) { attributes[name] = value; });
  out["attempt"] = attributes;
  out["organs"] = header.organs;
  out["vessels"] = header.vessels;
  out["fat"] = header.fat;
  Json assets = Json::array();
  for (const recorder::Asset& asset : header.assets)
    assets.push_back({{"name", asset.name}, {"bytes", asset.bytes.size()}});
  out["scene_files"] = assets;
  return out;
}

/// Headings in their order, each with the members that stand under it. What no heading names stands under the attempt.
struct Group {
  const char* heading;
  std::vector<std::string_view> members;
};

const std::vector<Group> groups{
    {"Recording", {"file", "state", "outcome", "seconds", "steps", "ticks", "events", "keyframes", "flushes"}},
    {"Integrity", {"chain", "chain_broken_at_flush", "chain_head", "signature", "public_key"}},
    {"Real time", {"missed_deadlines", "largest_lateness_s", "clock_stretched_s"}},
    {"Tolerances", {"steps_missed_tolerance", "steps_missed_by_solver", "steps_missed_by_contact", "steps_held_back"}},
    {"Device", {}},
    {"Attempt", {}},
    {"Versions",
     {"format", "format_version", "software", "build", "simulation_version", "this_simulation_version",
      "step_result_version"}},
    {"Scene", {"scene_name", "scene_major", "scene_minor", "organs", "vessels", "fat"}},
    {"Size", {"bytes"}},
};

std::string headingOf(const std::string& member) {
  for (const Group& group : groups) {
    if (std::find(group.members.begin(), group.members.end(), member) != group.members.end()) return group.heading;
  }
  return "Attempt";
}

std::string shownValue(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.10g}", value.get<double>());
  if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string list;
  for (const Json& each : value) list += (list.empty() ? "" : ", ") + shownValue(each);
  return list;
}

std::string shareOf(const Json& bytes, const Json& whole) {
  const auto all = whole.get<double>();
  return fmt::format("{} ({:.1f} %)", shownValue(bytes), all > 0.0 ? 100.0 * bytes.get<double>() / all : 0.0);
}

std::string deviceOf(const Json& s) {
  return fmt::format(
      "{} ({} valid, {} used by ticks, {} dropped, {} missing), {:.1f} a second, {:.0f} ms apart at most",
      shownValue(s["samples"]), shownValue(s["valid"]), shownValue(s["used"]), shownValue(s["dropped"]),
      shownValue(s["missing"]), s["rate_hz"].get<double>(), 1e3 * s["longest_interval_s"].get<double>());
}

/// The members of the JSON form, under headings.
std::string inspectText(const Json& recording) {
  std::map<std::string, std::string> under;
  const auto add = [&](const std::string& heading, const std::string& name, const std::string& value) {
    constexpr std::size_t valueAt = 27;
    if (!value.empty())
      under[heading] += fmt::format("  {:<24} {}\n", name, wrappedText(value, terminalColumns(), valueAt, valueAt));
  };
  for (const auto& [member, value] : recording.items()) {
    if (member == "attempt") {
      for (const auto& [name, attribute] : value.items()) add(headingOf(name), name, shownValue(attribute));
    } else if (member == "scene_files") {
      for (const auto& asset : value)
        add("Scene", "scene file", fmt::format("{} ({} bytes)", shownValue(asset["name"]), shownValue(asset["bytes"])));
    } else if (member == "bytes_by_group") {
      for (const auto& [group, bytes] : value.items())
        add("Size", "bytes, " + group, shareOf(bytes, recording["bytes"]));
    } else if (member == "device_samples") {
      for (const auto& [hand, samples] : value.items()) add("Device", "device, " + hand, deviceOf(samples));
    } else {
      add(headingOf(member), member, shownValue(value));
    }
  }
  std::string text;
  for (const Group& group : groups) {
    if (const std::string& lines = under[group.heading]; !lines.empty())
      text += fmt::format("{}{}\n{}", text.empty() ? "" : "\n", group.heading, lines);
  }
  return text;
}

struct InspectOptions {
  std::string file, key;
  bool json = false;
};

void inspect(const InspectOptions& o) {
  Progress progress("Reading the recording", o.json, "steps");
  const recorder::ChainVerdict chain = recorder::probe(o.file);
  recorder::Recording recording(o.file);
  const Json d = describe(recording, chain, progress);
  printResult(o.json, "inspect", d, inspectText(d));
  const std::string wanted = o.key.empty() ? "" : recorder::hexOf(keyOf(o.key, "--public-key"));
  if (!chain.intact()) throw Error(ErrorKind::refused, fmt::format("{}: {}", o.file, analytics::wordsFor(chain)));
  const auto& signature = recording.signature();
  if (!wanted.empty() && (!signature || !signature->value || recorder::hexOf(signature->publicKey) != wanted))
    throw Error(ErrorKind::refused, fmt::format("{}: not signed by that key", o.file));
}

struct RecoverOptions {
  std::string in, out;
  bool force = false;
};

void recoverRecording(const RecoverOptions& o) {
  Progress progress("Recovering");
  const recorder::Recovered saved = recorder::recover(o.in, o.out, o.force);
  Progress::erase();
  fmt::print("{}: {}, {} saved, {}\n", o.out, recorder::counted(saved.steps, "step"),
             recorder::counted(saved.ticks, "tick"), saved.complete ? "complete" : "incomplete");
  if (!saved.lost.empty()) fmt::print("the rest is lost: {}\n", saved.lost);
}

}  // namespace

void addInspect(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(
      app, run,
      {"inspect", "Say what a recording holds, and whether its content chain is intact", "calot inspect attempt.h5"},
      inspect);
  command->add_option("recording", o->file, "Recording (.h5)")->required();
  command->add_option("--public-key", o->key, "The key that must have signed it; else the exit code is 3");
  command->add_flag("--json", o->json, "Print JSON");
}

void addRecover(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(app, run,
                                       {"recover", "Rewrite a recording that was cut off or whose writer was killed",
                                        "calot recover killed.h5 -o recovered.h5"},
                                       recoverRecording);
  command->add_option("recording", o->in, "Recording (.h5)")->required();
  command->add_option("-o,--output", o->out, "File to write")->required();
  command->add_flag("--force", o->force, "Replace the output if it is there");
}

}  // namespace calot::apps
