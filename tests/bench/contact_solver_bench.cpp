// SPDX-License-Identifier: GPL-3.0-or-later
// The complementarity problem alone: time and error against rows and against the cap of sweeps, beside dense methods
// over the same rows.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/contact_sets.h"
#include "tests/bench/dense_contact.h"
#include "tests/bench/repeated.h"
#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

constexpr double budgetTolerance = 1e-8;     // of the scenes (m),
constexpr std::uint32_t budgetSweeps = 100;  // and their cap
constexpr int calls = 50;

/// The problem of a published set at its own pose; without friction the first row of each block.
OwnedProblem problemOf(const PublishedSet& published, bool friction) {
  const ContactSet& set = published.set;
  const ToolRow q = couplingStretch(set.reference, published.real, published.model.maxStretch);
  OwnedProblem problem;
  std::vector<std::size_t> rows;
  std::size_t at = 0;
  for (std::size_t b = 0; b < set.kind.size(); ++b) {
    problem.kind.push_back(friction ? set.kind[b] : BlockKind::unilateral);
    problem.limit.push_back(friction ? set.limit[b] : 0.0);
    for (std::size_t k = 0; k < blockRows(problem.kind.back()); ++k) rows.push_back(at + k);
    at += blockRows(set.kind[b]);
  }
  for (const std::size_t i : rows) {
    problem.free.push_back(set.free[i] + set.direction[i].dot(q));
    for (const std::size_t j : rows) problem.compliance.push_back(set.compliance[i * set.free.size() + j]);
  }
  return problem;
}

double relativeError(const std::vector<double>& lambda, const std::vector<double>& exact) {
  double error = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    error += (lambda[i] - exact[i]) * (lambda[i] - exact[i]);
    size += exact[i] * exact[i];
  }
  return std::sqrt(error / size);
}

/// Ours from a cold start. @param sweeps cap; Newton steps only with the scenes' own
ContactReport solved(const OwnedProblem& problem, std::uint32_t sweeps, bool newton, std::vector<double>& lambda,
                     double& seconds) {
  ContactSolver solver;
  std::vector<double> gap(problem.free.size());
  ContactReport report;
  const double start = threadSeconds();
  for (int i = 0; i < calls; ++i) {
    lambda.assign(problem.free.size(), 0.0);
    report = newton ? solver.solve(problem.view(), lambda, gap, budgetTolerance, sweeps)
                    : sweepContacts(problem.view(), lambda, gap, budgetTolerance, sweeps);
  }
  seconds = (threadSeconds() - start) / calls;
  return report;
}

/// Without friction: against block principal pivoting, which is exact.
void againstPivoting(benchmark::State& bench, const PublishedSet& published) {
  const OwnedProblem problem = problemOf(published, false);
  std::vector<double> lambda;
  std::vector<double> exact;
  int pivots = 0;
  for (auto _ : bench) {
    double seconds = 0.0;
    const ContactReport report = solved(problem, budgetSweeps, true, lambda, seconds);
    const double start = threadSeconds();
    for (int i = 0; i < calls; ++i) exact = principalPivoting(problem, pivots);
    const double dense = (threadSeconds() - start) / calls;
    bench.SetIterationTime(seconds);
    bench.counters["sweeps"] = report.sweeps;
    bench.counters["newton"] = report.newtonSteps;
    bench.counters["residual_um"] = 1e6 * report.residual;
    bench.counters["dense_us"] = 1e6 * dense;
    bench.counters["times_faster"] = dense / seconds;
  }
  bench.counters["rows"] = static_cast<double>(problem.free.size());
  bench.counters["pivots"] = pivots;
  bench.counters["force_error"] = relativeError(lambda, exact);
}

/// With friction: time against error over the cap of sweeps, error against the projected fixed point.
void sweepsAgainstError(benchmark::State& bench, const PublishedSet& published, std::uint32_t sweeps, bool newton) {
  const OwnedProblem problem = problemOf(published, true);
  const std::vector<double> exact = projectedFixedPoint(problem, 1e-15);
  if (exact.empty()) {
    bench.SkipWithError("the reference did not converge");
    return;
  }
  std::vector<double> lambda;
  for (auto _ : bench) {
    double seconds = 0.0;
    double whole = 0.0;
    std::vector<double> converged;
    solved(problem, budgetSweeps, true, converged, whole);
    const ContactReport report = solved(problem, sweeps, newton, lambda, seconds);
    bench.SetIterationTime(seconds);
    bench.counters["sweeps"] = report.sweeps;
    bench.counters["newton"] = report.newtonSteps;
    bench.counters["residual_um"] = 1e6 * report.residual;
    bench.counters["share_of_budget"] = seconds / whole;
  }
  bench.counters["rows"] = static_cast<double>(problem.free.size());
  bench.counters["force_error"] = relativeError(lambda, exact);
}

}  // namespace

void registerContactSolver() {
  for (const std::size_t contacts : {3U, 10U, 30U}) {
    const std::string name = "contact/solver/frictionless/" + std::to_string(contacts);
    repeated(benchmark::RegisterBenchmark(name.c_str(),
                                          [contacts](benchmark::State& bench) {
                                            const auto set = setOfLaidShaft(contacts);
                                            if (set) {
                                              againstPivoting(bench, *set);
                                            } else {
                                              bench.SkipWithError("no step has so many contacts");
                                            }
                                          }),
             5);
  }
  for (const std::uint32_t sweeps : {1U, 3U, 10U, 30U, 100U, 0U}) {
    const std::string name = "contact/solver/thirty/" + (sweeps > 0 ? "sweeps:" + std::to_string(sweeps) : "newton");
    repeated(benchmark::RegisterBenchmark(name.c_str(),
                                          [sweeps](benchmark::State& bench) {
                                            static const auto set = setOfLaidShaft(30);
                                            if (set) {
                                              sweepsAgainstError(bench, *set, sweeps > 0 ? sweeps : budgetSweeps,
                                                                 sweeps == 0);
                                            } else {
                                              bench.SkipWithError("no step has thirty contacts");
                                            }
                                          }),
             5);
  }
}

}  // namespace calot::bench
