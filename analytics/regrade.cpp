// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/regrade.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <numeric>
#include <utility>

#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort_files.h"
#include "recorder/recording/probe.h"

namespace calot::analytics {
namespace {

/// A recording that cannot be re-simulated here keeps the values that were re-simulated with this version before.
std::vector<CheckpointValue> keepResimulated(const std::vector<CheckpointValue>& before,
                                             std::vector<CheckpointValue> now) {
  for (CheckpointValue& v : now) {
    const auto known = std::find_if(before.begin(), before.end(), [&](const CheckpointValue& b) {
      return b.name == v.name && b.subject == v.subject && b.version == v.version && b.origin == Origin::resimulated &&
             b.value;
    });
    if (known != before.end()) v = *known;
  }
  return now;
}

/// Without those of external metrics, whose scripts are not here.
std::vector<CheckpointValue> ownValues(const CohortDatabase& database, const std::string& attempt) {
  std::vector<CheckpointValue> values = database.values(attempt);
  std::erase_if(values, [](const CheckpointValue& v) { return v.origin == Origin::external; });
  return values;
}

RegradedAttempt withoutRecording(const AttemptRow& row) {
  RegradedAttempt r;
  r.uuid = row.uuid;
  r.file = row.fileName;
  if (row.simulationVersion == 0) {
    r.how = Regraded::motion;
    r.message = "motion without a recording";
    r.remedies = {Remedy::importAgain};
  } else {
    r.fault = ErrorKind::damaged;
    r.message = fmt::format("the recording {} is in none of the places", row.fileName);
  }
  return r;
}

RegradedAttempt storeRegraded(CohortDatabase& database, const AttemptRow& row, const std::string& file,
                              JudgedRecording judged) {
  RegradedAttempt r;
  r.uuid = row.uuid;
  r.file = file;
  const recorder::ReplayReport& report = judged.report;
  r.fault = report.fault();
  if (r.fault) r.message = wordsFor(report);
  r.remedies = report.remedies;
  if (!judged.record) {
    r.how = Regraded::unreadable;
    r.message = fmt::format("{}: {}", r.file, wordsFor(report));
    return r;
  }
  const std::vector<CheckpointValue> before = ownValues(database, r.uuid);
  const bool undecided = report.verdict == recorder::ReplayVerdict::undecided;
  if (undecided) judged.values = keepResimulated(before, std::move(judged.values));
  try {
    const bool stays = undecided && row.verification.verdict == Verdict::verified;
    Imported imported = Imported::unchanged;
    if (stays && judged.record->chainHead == row.chainHead) {
      database.storeValues(r.uuid, judged.values);
    } else {
      imported = database.storeAttempt(*judged.record, judged.values);
    }
    r.changes = changesOf(before, ownValues(database, r.uuid));
    r.how = imported == Imported::unchanged && r.changes.empty() ? Regraded::unchanged : Regraded::changed;
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::refused) throw;
    r.how = Regraded::conflict;
    r.fault = e.kind();
    r.message = e.what();
    r.remedies = e.remedies();
  }
  return r;
}

}  // namespace

void judgeAll(const std::vector<std::string>& files, recorder::WorkerPool& pool, const AssessSettings& settings,
              const std::function<void(std::size_t index, JudgedRecording judged)>& consume) {
  struct Work {
    JudgedRecording judged;
    std::exception_ptr failure;
  };
  // A batch is simulated in parallel and consumed in its order before the next one begins.
  const std::size_t batch = pool.threadCount() == 1 ? 1 : std::size_t{4} * pool.threadCount();
  constexpr std::uint64_t parts = 1000;  // of a recording
  std::vector<std::atomic<std::uint64_t>> done(files.size());
  for (std::size_t begin = 0; begin < files.size(); begin += batch) {
    std::vector<Work> works(std::min(batch, files.size() - begin));
    // With fewer recordings than threads, each has several.
    AssessSettings own = settings;
    if (pool.threadCount() > 1)
      own.threads = static_cast<unsigned>(std::max<std::size_t>(1, pool.threadCount() / works.size()));
    const auto judge = [&](std::size_t i) {
      AssessSettings mine = own;
      if (settings.progress) {
        mine.progress = [&, i](std::uint64_t step, std::uint64_t of) {
          done[begin + i] = of > 0 ? parts * step / of : 0;
          settings.progress(std::accumulate(done.begin(), done.end(), std::uint64_t{0}), parts * files.size());
        };
      }
      try {
        works[i].judged = assessRecording(files[begin + i], mine);
      } catch (...) {
        works[i].failure = std::current_exception();
      }
    };
    pool.run(works.size(), judge);
    for (std::size_t i = 0; i < works.size(); ++i) {
      if (works[i].failure) std::rethrow_exception(works[i].failure);
      consume(begin + i, std::move(works[i].judged));
    }
  }
}

std::vector<ValueChange> changesOf(const std::vector<CheckpointValue>& before,
                                   const std::vector<CheckpointValue>& now) {
  const auto same = [](const CheckpointValue& v) {
    return [&v](const CheckpointValue& other) { return other.name == v.name && other.subject == v.subject; };
  };
  std::vector<ValueChange> changes;
  for (const CheckpointValue& v : now) {
    const auto was = std::find_if(before.begin(), before.end(), same(v));
    if (was == before.end()) {
      changes.push_back({std::nullopt, v});
    } else if (*was != v) {
      changes.push_back({*was, v});
    }
  }
  for (const CheckpointValue& v : before) {
    if (std::none_of(now.begin(), now.end(), same(v))) changes.push_back({v, std::nullopt});
  }
  return changes;
}

Regrade regrade(const std::string& path, const std::vector<std::filesystem::path>& places, unsigned jobs,
                const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  const recorder::ProbeProcesses probes(jobs);  // before this process grows by what it reads
  CohortDatabase database(path, CohortDatabase::Access::write);
  Regrade result;
  recorder::WorkerPool pool(jobs);
  const RecordingsFound found(places, pool);
  result.notRead = found.notRead();
  const std::vector<AttemptRow> rows = database.listAttempts();
  result.attempts.resize(rows.size());
  std::vector<std::size_t> numbers;
  std::vector<std::string> files;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto file = found.of(rows[i])) {
      numbers.push_back(i);
      files.push_back(file->string());
    } else {
      result.attempts[i] = withoutRecording(rows[i]);
    }
  }
  judgeAll(files, pool, {}, [&](std::size_t i, JudgedRecording judged) {
    const std::size_t number = numbers[i];
    result.attempts[number] = storeRegraded(database, rows[number], files[i], std::move(judged));
    if (progress) progress(i + 1, files.size());
  });
  return result;
}

Regrade takeNewer(const std::string& into, const std::vector<std::string>& from) {
  CohortDatabase database(into, CohortDatabase::Access::write);
  struct Source {
    const CohortDatabase* database = nullptr;
    AttemptRow row;
  };
  std::vector<CohortDatabase> others;
  others.reserve(from.size());
  std::map<std::string, Source> newest;
  for (const std::string& path : from) {
    const CohortDatabase& other = others.emplace_back(path, CohortDatabase::Access::read);
    for (const AttemptRow& row : other.listAttempts()) {
      Source& source = newest[row.uuid];
      if (source.database == nullptr || source.row.verifiedUtc <= row.verifiedUtc) source = {&other, row};
    }
  }
  Regrade result;
  for (const AttemptRow& row : database.listAttempts()) {
    const auto found = newest.find(row.uuid);
    if (found == newest.end()) {
      RegradedAttempt& missing = result.attempts.emplace_back(withoutRecording(row));
      if (missing.how == Regraded::missing) missing.message = "assessed in none of the databases";
      continue;
    }
    const AttemptRow& other = found->second.row;
    if (other.verifiedUtc < row.verifiedUtc) {
      RegradedAttempt& kept = result.attempts.emplace_back();
      kept.uuid = row.uuid;
      kept.file = row.fileName;
      kept.how = Regraded::unchanged;
      continue;
    }
    JudgedRecording judged;
    judged.report.path = other.fileName;
    judged.report.attempt = other.uuid;
    judged.report.verdict = verdictOf(other.verification.verdict);
    judged.report.error = other.verification.text;
    judged.record = other;
    judged.values = ownValues(*found->second.database, row.uuid);
    result.attempts.push_back(storeRegraded(database, row, other.fileName, std::move(judged)));
  }
  return result;
}

}  // namespace calot::analytics
