// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/regrade_shares.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

#include "analytics/cohort/withdraw.h"
#include "analytics/cohort_files.h"
#include "analytics/shards/values_set.h"
#include "analytics/shards/values_writer.h"
#include "recorder/recording/probe.h"

namespace calot::analytics {
namespace {

double recordedSeconds(const AttemptRow& row) { return static_cast<double>(row.steps) * row.stepSeconds; }

std::vector<Dealt> dealtAttempts(const std::vector<AttemptRow>& rows) {
  std::vector<Dealt> list;
  list.reserve(rows.size());
  for (const AttemptRow& row : rows) {
    const std::string kind = fmt::format("{}/{} {}", row.scene, row.sceneMajor, row.simulationVersion);
    list.push_back({kind, row.steps, row.uuid});
  }
  return list;
}

/// Is it of this attempt, with the content that the cohort holds?
bool isRecordingOf(const AttemptRow& row, const recorder::ReplayReport& report) {
  return report.attempt == row.uuid && report.chainHead == row.chainHead;
}

/// The cohort is closed again before long work begins: it may be written meanwhile.
std::vector<AttemptRow> attemptsOf(const std::string& cohort) {
  return CohortDatabase(cohort, CohortDatabase::Access::read).listAttempts();
}

}  // namespace

std::vector<PlannedShare> regradePlan(const std::string& cohort, std::uint32_t shares) {
  const std::vector<AttemptRow> rows = attemptsOf(cohort);
  const std::vector<std::vector<std::size_t>> dealt = deal(dealtAttempts(rows), shares);
  std::vector<PlannedShare> plan;
  for (std::uint32_t i = 0; i < shares; ++i) {
    PlannedShare& share = plan.emplace_back(PlannedShare{{i + 1, shares}, dealt[i].size()});
    for (const std::size_t number : dealt[i]) share.seconds += recordedSeconds(rows[number]);
  }
  return plan;
}

ComputedShare computeRegradeShare(const std::string& cohort, const std::vector<std::filesystem::path>& places,
                                  const Shard& shard, const std::filesystem::path& values, unsigned jobs, bool replace,
                                  const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  const recorder::ProbeProcesses probes(jobs);  // before this process grows by what it reads
  const std::vector<AttemptRow> rows = attemptsOf(cohort);
  const std::vector<Dealt> planned = dealtAttempts(rows);
  const std::vector<std::size_t> share = deal(planned, shard.of)[shard.number - 1];
  ValuesWriter writer(values, headerOf(SharedWork::regrade, shard, share.size(), planned), replace);
  ComputedShare result;
  result.recordings = share.size();
  result.before = writer.complete() ? share.size() : writer.done().size();
  if (writer.complete()) return result;

  recorder::WorkerPool pool(jobs);
  const auto judge = [&](const std::vector<std::size_t>& numbers, const std::vector<std::string>& files, bool certain) {
    std::vector<std::size_t> others;
    judgeAll(files, pool, [&](std::size_t i, JudgedRecording judged) {
      const AttemptRow& row = rows[numbers[i]];
      result.resimulation += judged.report.wallSeconds;
      if (!certain && !isRecordingOf(row, judged.report)) {
        others.push_back(numbers[i]);
        return;
      }
      writer.append({numbers[i], row.uuid, files[i], std::move(judged)});
      if (progress) progress(writer.done().size(), share.size());
    });
    return others;
  };

  // Under the name that the cohort knows there is nearly always the recording that it knows: looking into all files of
  // a cohort, to compute a small share of it, would cost as much again.
  const NamedFiles names(places);
  std::vector<std::size_t> numbers, unclear;
  std::vector<std::string> files;
  for (const std::size_t i : share) {
    if (writer.done().contains(i)) continue;
    if (const auto file = names.only(rows[i].fileName)) {
      numbers.push_back(i);
      files.push_back(file->string());
    } else {
      unclear.push_back(i);
    }
  }
  for (const std::size_t i : judge(numbers, files, false)) unclear.push_back(i);

  numbers.clear();
  files.clear();
  std::optional<RecordingsFound> found;
  for (const std::size_t i : unclear) {
    // Motion without a scene has no recording: for its sake no file is opened.
    if (!found && rows[i].simulationVersion != 0) found.emplace(places, pool);
    const auto file = found ? found->of(rows[i]) : std::nullopt;
    if (file) {
      numbers.push_back(i);
      files.push_back(file->string());
    } else {
      writer.append({i, rows[i].uuid, rows[i].fileName, std::nullopt});
      ++result.missing;
    }
  }
  static_cast<void>(judge(numbers, files, true));
  writer.finish();
  return result;
}

TakenRegrade takeRegrade(const std::string& cohort, const std::vector<std::filesystem::path>& files,
                         const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  CohortDatabase database(cohort, CohortDatabase::Access::write);
  const std::vector<AttemptRow> rows = database.listAttempts();
  std::map<std::string, std::size_t> byUuid;
  for (std::size_t i = 0; i < rows.size(); ++i) byUuid[rows[i].uuid] = i;
  const ValuesSet set(files, SharedWork::regrade, [&](const ValuesRow& row) {
    if (byUuid.contains(row.attempt) || wasWithdrawn(cohort, row.attempt)) return;
    throw Error(ErrorKind::refused,
                fmt::format("attempt {} is not in {}: values of another cohort", row.attempt, cohort));
  });

  TakenRegrade taken;
  taken.refused = set.refused();
  taken.missing.numbers = set.missing();
  taken.missing.of = set.shares();
  std::vector<RegradedAttempt>& attempts = taken.regrade.attempts;
  attempts.resize(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    attempts[i].uuid = rows[i].uuid;
    attempts[i].file = rows[i].fileName;
    attempts[i].message = "in none of the shards that were taken";
  }
  std::uint64_t done = 0;
  set.forEach([&](const ValuesRow& row) {
    const auto known = byUuid.find(row.attempt);
    if (known == byUuid.end()) {
      ++taken.withdrawn;
    } else {
      const AttemptRow& attempt = rows[known->second];
      attempts[known->second] =
          row.judged ? storeRegraded(database, attempt, row.file, *row.judged) : withoutRecording(attempt);
    }
    if (progress) progress(++done, set.rows());
  });
  for (const RegradedAttempt& a : attempts) {
    if (a.how == Regraded::missing && !a.fault) ++taken.missing.attempts;
  }
  return taken;
}

}  // namespace calot::analytics
