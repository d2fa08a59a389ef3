// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort of 10,000 attempts: one more comes in, a study of all, the dashboard's list of all; each against the least
// that SQLite does for the same rows.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/page_sums.h"
#include "analytics/report/study.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench::cohort_bench {

namespace {

using namespace analytics;

constexpr int attempts = 10000;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// SQLite by its own interface.
class Bare {
 public:
  /// @param layer writes a cohort's checksums; none: plain files
  explicit Bare(const std::string& path, const char* layer = nullptr) {
    if (sqlite3_open_v2(path.c_str(), &db_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, layer) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(db_));
  }
  ~Bare() { sqlite3_close(db_); }
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  void run(const std::string& sql) {
    if (sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(db_));
  }

  /// Steps through a query and looks at every column. @returns rows
  std::size_t read(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_, sql, -1, &statement, nullptr) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(db_));
    std::size_t rows = 0;
    const int columns = sqlite3_column_count(statement);
    while (sqlite3_step(statement) == SQLITE_ROW) {
      for (int c = 0; c < columns; ++c) benchmark::DoNotOptimize(sqlite3_column_bytes(statement, c));
      ++rows;
    }
    sqlite3_finalize(statement);
    return rows;
  }

 private:
  sqlite3* db_ = nullptr;
};

AttemptRecord attemptOf(const std::string& uuid, const std::string& participant) {
  AttemptRecord a;
  a.uuid = uuid;
  a.participant = participant;
  a.scene = std::string("cholecystectomy");
  a.sceneMajor = 1;
  a.operatorKind = recorder::OperatorKind::human;
  a.mode = recorder::Mode::assessment;
  a.purpose = std::string("study");
  a.outcome = recorder::Outcome::completed;
  a.startUtc = std::string("2026-01-01T00:00:00Z");
  a.device = std::string("falcon");
  a.simulationVersion = 1;
  a.comparabilityKey = std::string("cholecystectomy/1 device=falcon");
  a.fileName = uuid + ".h5";
  a.complete = true;
  a.steps = 6000;
  a.verification = {Verdict::verified, "", "calot"};
  return a;
}

/// A value of every checkpoint.
std::vector<CheckpointValue> oneOfEach() {
  std::vector<CheckpointValue> values;
  for (const CheckpointEntry& entry : checkpointRegistry())
    values.push_back(makeValue(entry.definition, "", Origin::resimulated, 1.5));
  return values;
}

/// The database, in a folder that goes away.
class Cohort {
 public:
  explicit Cohort(int people) {
    std::string pattern = (std::filesystem::temp_directory_path() / "calot-bench-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error(pattern + ": cannot be made");
    folder_ = pattern;
    path = (folder_ / "c.db").string();
    CohortDatabase(path, CohortDatabase::Access::create)
        .storeAttempt(attemptOf("00000000-0000-4000-8000-000000000000", "P000"), oneOfEach());
    // The others by one statement a table: what is measured is not how they came in.
    Bare bare(path, pageSumLayer());
    const std::string numbers =
        fmt::format("WITH RECURSIVE n (i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < {}) ", attempts);
    bare.run("BEGIN; UPDATE participant SET study_group = 'expert'");
    bare.run(numbers +
             "INSERT INTO participant (id, pseudonym, study_group, created_utc) SELECT i, printf('P%03d', i), "
             "iif(i % 2, 'expert', 'novice'), '2026-01-01T00:00:00Z' FROM n WHERE i <= " +
             std::to_string(people));
    bare.run(numbers +
             "INSERT INTO attempt SELECT i, printf('%08x-0000-4000-8000-%012x', i * 2654435761 % 4294967296, i), "
             "parent_uuid, 1 + i % " +
             std::to_string(people) +
             ", scene, scene_major, scene_minor, operator_kind, profile, "
             "profile_version, mode, purpose, outcome, printf('2026-01-%02dT00:00:%02dZ', 1 + i % 28, i % 60), seed, "
             "device, calibration, simulation_version, comparability_key, synthetic, imported_utc, station "
             "FROM n JOIN attempt ON attempt.id = 1");
    bare.run(numbers +
             "INSERT INTO recording SELECT i, file_name, chain_head, steps, step_seconds, complete FROM n "
             "JOIN recording ON attempt = 1");
    bare.run(numbers +
             "INSERT INTO verification SELECT i, verdict, detail, software, verified_utc FROM n "
             "JOIN verification ON attempt = 1");
    bare.run(numbers +
             "INSERT INTO checkpoint_value SELECT i, position, name, subject, version, availability, "
             "1.0 + (i * 7919 + position * 104729) % 1009 / 100.0, reason, note, unit, origin, filter, coverage, rate, "
             "noise FROM n "
             "JOIN checkpoint_value ON attempt = 1 ORDER BY 1, 2");
    bare.run("COMMIT; ANALYZE");
  }
  ~Cohort() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Cohort(const Cohort&) = delete;
  Cohort& operator=(const Cohort&) = delete;

  std::string path;

 private:
  std::filesystem::path folder_;
};

Cohort& cohort() {
  static Cohort one(400);
  return one;
}

/// Each attempt by somebody else: groups of thousands.
Cohort& crowd() {
  static Cohort one(attempts);
  return one;
}

void tell(benchmark::State& bench, const std::string& name, double ours, double bare) {
  bench.SetIterationTime(ours);
  bench.counters["bare_ms"] = 1e3 * bare;
  bench.counters["vs_bare"] = ours / bare;
  figures().add(name + "_ms", 1e3 * ours);
  figures().add(name + "_vs_bare", ours / bare);
}

/// One more attempt with its values, from opening the database to the commit on the disk; against a transaction of one
/// row of a table of its own in the same file, opened in the same way.
void import(benchmark::State& bench) {
  const std::string& path = cohort().path;
  const std::vector<CheckpointValue> values = oneOfEach();
  static int number = 0;
  for (auto _ : bench) {
    const AttemptRecord a = attemptOf(fmt::format("ffffffff-0000-4000-8000-{:012x}", ++number), "P000");
    const double start = now();
    CohortDatabase(path, CohortDatabase::Access::write).storeAttempt(a, values);
    const double middle = now();
    {
      Bare bare(path + ".bare");
      bare.run("PRAGMA synchronous = FULL");
      bare.run("CREATE TABLE IF NOT EXISTS one (uuid TEXT PRIMARY KEY) STRICT");
    }
    const double before = now();
    {
      Bare bare(path + ".bare");
      bare.run("PRAGMA synchronous = FULL");
      bare.run(fmt::format("INSERT INTO one VALUES ('{}')", a.uuid));
    }
    tell(bench, "cohort.import", middle - start, now() - before);
  }
}

/// A study of two groups, every checkpoint, the mean of each participant's attempts; against reading every value once.
void study(benchmark::State& bench, Cohort& (*of)(), const std::string& name) {
  StudyOptions options;
  options.attemptRule = AttemptRule::mean;
  const std::string& path = of().path;
  for (auto _ : bench) {
    const double start = threadSeconds();
    const CohortDatabase database(path, CohortDatabase::Access::read);
    const Study made = makeStudy(database, options);
    const double middle = threadSeconds();
    Bare bare(path);
    benchmark::DoNotOptimize(bare.read("SELECT * FROM checkpoint_value"));
    tell(bench, name, middle - start, threadSeconds() - middle);
    bench.counters["rows"] = static_cast<double>(made.rows.size());
  }
}

/// What the dashboard opens with: every attempt with participant, verification and exclusion.
void list(benchmark::State& bench) {
  for (auto _ : bench) {
    const double start = threadSeconds();
    const CohortDatabase database(cohort().path, CohortDatabase::Access::read);
    const std::size_t rows = database.listAttempts().size();
    const double middle = threadSeconds();
    Bare bare(cohort().path);
    benchmark::DoNotOptimize(
        bare.read("SELECT * FROM attempt a JOIN recording r ON r.attempt = a.id "
                  "LEFT JOIN verification v ON v.attempt = a.id "
                  "LEFT JOIN participant p ON p.id = a.participant "
                  "LEFT JOIN exclusion e ON e.attempt = a.id ORDER BY a.start_utc, a.uuid"));
    tell(bench, "cohort.list", middle - start, threadSeconds() - middle);
    bench.counters["attempts"] = static_cast<double>(rows);
  }
}

}  // namespace
}  // namespace calot::bench::cohort_bench

void calot::bench::registerCohort() {
  using namespace cohort_bench;

  repeated(benchmark::RegisterBenchmark("cohort/import/10k", import), 9)->Unit(benchmark::kMillisecond);
  repeated(benchmark::RegisterBenchmark("cohort/study/10k", study, cohort, "cohort.study"), 3)
      ->Unit(benchmark::kMillisecond);
  repeated(benchmark::RegisterBenchmark("cohort/study/10k-people", study, crowd, "cohort.study_people"), 3)
      ->Unit(benchmark::kMillisecond);
  repeated(benchmark::RegisterBenchmark("cohort/list/10k", list), 9)->Unit(benchmark::kMillisecond);
}
