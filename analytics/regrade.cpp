// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/regrade.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>

#include "analytics/assess.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/identify.h"

namespace calot::analytics {
namespace {

/// Recordings by uuid: of several, one with the content that the cohort holds, else the longest.
class Found {
 public:
  Found(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool, Regrade& result) {
    std::vector<std::filesystem::path> files = recorder::filesUnder(places);
    std::vector<std::optional<recorder::RecordingIdentity>> identity(files.size());
    std::vector<std::optional<Error>> fault(files.size());
    const auto look = [&](std::size_t i) {
      const bool named = std::find(places.begin(), places.end(), files[i]) != places.end();
      if (!named && !recorder::looksLikeHdf5(files[i])) return;
      try {
        identity[i] = recorder::identify(files[i]);
      } catch (const Error& e) {
        fault[i] = e;
      } catch (const std::exception& e) {
        fault[i] = Error(ErrorKind::failure, Where{files[i].string()}, e.what());
      }
    };
    pool.run(files.size(), look);
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (identity[i]) byUuid_[identity[i]->attempt].push_back({files[i], *identity[i]});
      if (fault[i]) result.notRead.push_back(*fault[i]);
    }
  }

  [[nodiscard]] std::optional<std::filesystem::path> of(const AttemptRow& a) const {
    const auto at = byUuid_.find(a.uuid);
    if (at == byUuid_.end()) return std::nullopt;
    const auto better = [&](const Entry& x, const Entry& y) {
      const bool mine = x.identity.chainHead == a.chainHead, yours = y.identity.chainHead == a.chainHead;
      return mine != yours ? mine : x.identity.steps > y.identity.steps;
    };
    return std::min_element(at->second.begin(), at->second.end(), better)->file;
  }

 private:
  struct Entry {
    std::filesystem::path file;
    recorder::RecordingIdentity identity;
  };
  std::map<std::string, std::vector<Entry>> byUuid_;
};

/// Of a recording that cannot be re-simulated here: what was re-simulated before and is still of this version stays.
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

struct Work {
  const AttemptRow* row = nullptr;
  RegradedAttempt* result = nullptr;
  std::optional<Assessment> assessment;
  std::exception_ptr failure;
};

void storeOne(CohortDatabase& database, Work& work) {
  RegradedAttempt& r = *work.result;
  if (work.failure) std::rethrow_exception(work.failure);
  const recorder::ReplayReport& report = work.assessment->report;
  r.fault = report.fault();
  if (r.fault) r.message = report.message;
  r.remedies = report.remedies;
  if (!work.assessment->attempt) {
    r.how = Regraded::unreadable;
    r.message = fmt::format("{}: {}", r.file, report.message);
    return;
  }
  AssessedAttempt& assessed = *work.assessment->attempt;
  const std::vector<CheckpointValue> before = database.values(r.uuid);
  const bool undecided = report.verdict == recorder::ReplayVerdict::undecided;
  if (undecided) assessed.values = keepResimulated(before, std::move(assessed.values));
  try {
    const bool stays = undecided && work.row->verification.verdict == Verdict::verified;
    Imported imported = Imported::unchanged;
    if (stays && assessed.chainHead == work.row->chainHead) {
      database.storeValues(r.uuid, assessed.values);
    } else {
      imported = store(database, assessed);
    }
    r.changes = changesOf(before, database.values(r.uuid));
    r.how = imported == Imported::unchanged && r.changes.empty() ? Regraded::unchanged : Regraded::changed;
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::refused) throw;
    r.how = Regraded::conflict;
    r.fault = e.kind();
    r.message = e.what();
    r.remedies = e.remedies();
  }
}

}  // namespace

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
  CohortDatabase database(path, CohortDatabase::Access::write);
  Regrade result;
  recorder::WorkerPool pool(jobs);
  const Found found(places, pool, result);
  const std::vector<AttemptRow> rows = database.listAttempts();
  result.attempts.resize(rows.size());
  std::vector<Work> works;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    RegradedAttempt& r = result.attempts[i];
    r.uuid = rows[i].uuid;
    r.file = rows[i].fileName;
    if (const auto file = found.of(rows[i])) {
      r.file = file->string();
      works.push_back({&rows[i], &r, std::nullopt, nullptr});
    } else if (rows[i].simulationVersion == 0) {
      r.how = Regraded::motion;
      r.message = "motion without a recording";
      r.remedies = {Remedy::importAgain};
    } else {
      r.fault = ErrorKind::damaged;
      r.message = fmt::format("the recording {} is in none of the places", rows[i].fileName);
    }
  }
  // A batch is simulated in parallel and stored in its order before the next one begins.
  const std::size_t batch = std::size_t{4} * pool.threadCount();
  for (std::size_t begin = 0; begin < works.size(); begin += batch) {
    const std::size_t count = std::min(batch, works.size() - begin);
    // Where recordings are fewer than threads, each has several.
    const auto each = static_cast<unsigned>(std::max<std::size_t>(1, pool.threadCount() / count));
    const auto assess = [&](std::size_t i) {
      Work& work = works[begin + i];
      try {
        work.assessment = assessRecording(work.result->file, each);
      } catch (...) {
        work.failure = std::current_exception();
      }
    };
    pool.run(count, assess);
    for (std::size_t i = begin; i < begin + count; ++i) {
      storeOne(database, works[i]);
      works[i].assessment.reset();
    }
    if (progress) progress(begin + count, works.size());
  }
  return result;
}

}  // namespace calot::analytics
