// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/inspect_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/calot/terminal_text.h"

namespace calot::apps {
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

}  // namespace calot::apps
