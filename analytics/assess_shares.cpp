// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assess_shares.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "analytics/shards/values_set.h"
#include "analytics/shards/values_writer.h"
#include "recorder/base/errors.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/recording_facts.h"

namespace calot::analytics {
namespace {

std::vector<Dealt> dealtFiles(const std::vector<std::filesystem::path>& files) {
  std::vector<Dealt> list;
  list.reserve(files.size());
  for (const std::filesystem::path& file : files) {
    std::error_code gone;  // judging it says so
    const std::uintmax_t bytes = std::filesystem::file_size(file, gone);
    list.push_back({"", gone ? 0 : bytes, file.string()});
  }
  return list;
}

}  // namespace

std::vector<std::filesystem::path> recordingsUnder(const std::vector<std::filesystem::path>& places) {
  std::vector<std::filesystem::path> files = recorder::filesUnder(places);
  std::erase_if(files, [&](const std::filesystem::path& file) {
    const bool named = std::find(places.begin(), places.end(), file) != places.end();
    return !named && !recorder::looksLikeHdf5(file);
  });
  if (files.empty())
    throw Error(ErrorKind::damaged, Where{places.empty() ? "" : places.front().string()},
                "there are no recordings in it");
  return files;
}

std::vector<PlannedShare> assessPlan(const std::vector<std::filesystem::path>& places, std::uint32_t shares) {
  const std::vector<std::vector<std::size_t>> dealt = deal(dealtFiles(recordingsUnder(places)), shares);
  std::vector<PlannedShare> plan;
  for (std::uint32_t i = 0; i < shares; ++i) plan.push_back({{i + 1, shares}, dealt[i].size()});
  return plan;
}

ComputedShare computeAssessShare(const std::vector<std::filesystem::path>& places, const Shard& shard,
                                 const std::filesystem::path& values, unsigned jobs, bool replace,
                                 const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  const recorder::ProbeProcesses probes(jobs);  // before this process grows by what it reads
  const std::vector<std::filesystem::path> all = recordingsUnder(places);
  const std::vector<Dealt> planned = dealtFiles(all);
  const std::vector<std::size_t> share = deal(planned, shard.of)[shard.number - 1];
  ValuesWriter writer(values, headerOf(SharedWork::assess, shard, share.size(), planned), replace);
  ComputedShare result;
  result.recordings = share.size();
  result.before = writer.complete() ? share.size() : writer.done().size();
  if (writer.complete()) return result;
  std::vector<std::size_t> positions;
  std::vector<std::string> files;
  for (const std::size_t i : share) {
    if (writer.done().contains(i)) continue;
    positions.push_back(i);
    files.push_back(all[i].string());
  }
  recorder::WorkerPool pool(jobs);
  judgeAll(files, pool, [&](std::size_t i, JudgedRecording judged) {
    result.resimulation += judged.report.wallSeconds;
    const std::string attempt = judged.record ? judged.record->uuid : judged.report.attempt;
    writer.append({positions[i], attempt, files[i], std::move(judged)});
    if (progress) progress(writer.done().size(), share.size());
  });
  writer.finish();
  return result;
}

TakenAssess takeAssess(const std::vector<std::filesystem::path>& files,
                       const std::function<void(const ValuesRow& row)>& take) {
  const ValuesSet set(files, SharedWork::assess, [](const ValuesRow& row) {
    if (!row.judged) throw Error(ErrorKind::damaged, "a recording without its report");
  });
  set.forEach(take);
  return {set.refused(), set.missing(), set.shares()};
}

}  // namespace calot::analytics
