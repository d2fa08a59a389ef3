// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/share_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "analytics/shards/shard.h"
#include "apps/calot/environment.h"
#include "apps/calot/results.h"
#include "apps/common/advice.h"

namespace calot::apps {
namespace {

using nlohmann::ordered_json;

/// As many numbers as a line of a message holds.
constexpr std::size_t maxListed = 20;

std::string numbersText(const std::vector<std::uint32_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < std::min(numbers.size(), maxListed); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", numbers[i]);
  if (numbers.size() > maxListed) text += fmt::format(" and {} more", numbers.size() - maxListed);
  return text;
}

}  // namespace

void addSharing(CLI::App& command, ShareOptions& o) {
  CLI::Option* shard = command.add_option("--shard", o.shard, "compute this share alone: 3/8 is the third of eight");
  CLI::Option* values = command.add_option("--values-to", o.valuesTo,
                                           "with --shard: file for its values; one that is cut short is taken up");
  CLI::Option* take = command.add_option("--take", o.take, "store values that were computed in shards");
  CLI::Option* plan = command.add_option("--plan", o.plan, "show what so many shards would hold, and compute nothing")
                          ->check(CLI::Range(1U, analytics::maxShards));
  shard->needs(values);
  values->needs(shard);
  take->excludes(shard)->excludes(plan);
  plan->excludes(shard);
  command.add_flag("--force", o.force, "with --values-to: replace a file that is there")->needs(values);
}

void printPlan(const std::vector<analytics::PlannedShare>& plan, bool json) {
  std::uint64_t recordings = 0;
  double seconds = 0.0;
  for (const analytics::PlannedShare& share : plan) {
    recordings += share.recordings;
    seconds += share.seconds;
  }
  if (json) {
    ordered_json out = {{"shards", plan.size()}, {"recordings", recordings}, {"seconds", seconds}};
    out["shares"] = ordered_json::array();
    for (const analytics::PlannedShare& s : plan)
      out["shares"].push_back({{"shard", s.shard.number}, {"recordings", s.recordings}, {"seconds", s.seconds}});
    printResult("plan", out);
    return;
  }
  const auto fewer = [](const auto& a, const auto& b) { return a.recordings < b.recordings; };
  const auto shorter = [](const auto& a, const auto& b) { return a.seconds < b.seconds; };
  const auto [least, most] = std::minmax_element(plan.begin(), plan.end(), fewer);
  fmt::print("{} shards, {} recordings, {} to {} in each\n", plan.size(), recordings, least->recordings,
             most->recordings);
  if (seconds > 0.0) {
    const auto [shortest, longest] = std::minmax_element(plan.begin(), plan.end(), shorter);
    fmt::print("{:.1f} s of recorded time, {:.1f} to {:.1f} s in each\n", seconds, shortest->seconds, longest->seconds);
  }
}

void printShare(const ShareOptions& o, const analytics::ComputedShare& share, bool json) {
  Progress::erase();
  const analytics::Shard shard = analytics::shardNamed(o.shard);
  if (json) {
    const ordered_json out = {{"values", o.valuesTo},
                              {"shard", shard.number},
                              {"of", shard.of},
                              {"recordings", share.recordings},
                              {"before", share.before},
                              {"missing", share.missing},
                              {"resimulation_seconds", share.resimulation}};
    printResult("shard", out);
    return;
  }
  std::string text =
      fmt::format("{}: shard {} of {}, {} recordings", o.valuesTo, shard.number, shard.of, share.recordings);
  if (share.before > 0) text += fmt::format(" ({} of an earlier run)", share.before);
  if (share.missing > 0) text += fmt::format(", {} missing", share.missing);
  fmt::print("{}\n", text);
}

ExitCode reportShards(const std::string& cohort, const std::vector<Error>& refused,
                      const analytics::MissingShares& missing) {
  std::vector<ExitCode> codes;
  for (const Error& e : refused) {
    codes.push_back(codeOf(e.kind()));
    fmt::print(stderr, "calot: {}\n", messageOf(e));
  }
  if (!missing.numbers.empty()) {
    codes.push_back(ExitCode::damaged);
    fmt::print(stderr, "calot: {}: {} of {} shards missing: {}; compute them, and take their files too\n", cohort,
               missing.numbers.size(), missing.of, numbersText(missing.numbers));
  } else if (missing.attempts > 0 && missing.of > 0) {
    codes.push_back(ExitCode::damaged);
    fmt::print(stderr,
               "calot: {}: {} attempts are in none of the shards: they came in after these were planned; "
               "regrade again\n",
               cohort, missing.attempts);
  }
  return worstOf(codes);
}

std::vector<std::filesystem::path> pathsOf(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

}  // namespace calot::apps
