// SPDX-License-Identifier: GPL-3.0-or-later
// calot-bench: options, then the benchmarks of tests/bench.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "apps/common/program.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/figures.h"

namespace {

constexpr std::string_view filterOption = "--benchmark_filter=";

/// The library would go on with nothing to do.
void checkFilter(std::string filter) {
  if (filter.starts_with('-')) filter.erase(0, 1);
  try {
    const std::regex expression(filter, std::regex::extended);
  } catch (const std::regex_error&) {
    throw calot::Error(calot::ErrorKind::invalid,
                       fmt::format("--benchmark_filter: '{}' is not a regular expression", filter));
  }
}

/// @param words of the command line that are not ours: the library's options
int run(const std::string& output, bool force, char* program, std::vector<std::string> words) {
  if (!output.empty()) calot::recorder::refuseOutput(output, force);
  std::vector<char*> theirs{program};
  for (std::string& word : words) {
    if (word.starts_with(filterOption)) checkFilter(word.substr(filterOption.size()));
    theirs.push_back(word.data());
  }
  auto count = static_cast<int>(theirs.size());
  theirs.push_back(nullptr);
  benchmark::Initialize(&count, theirs.data());
  if (count > 1) {
    throw calot::Error(calot::ErrorKind::invalid,
                       fmt::format("{}: no option of Google Benchmark's, or no value of it; try --help", theirs[1]));
  }
  calot::bench::registerAll();
  // The library has reported that no name fits the filter.
  if (benchmark::RunSpecifiedBenchmarks() == 0) return static_cast<int>(calot::apps::ExitCode::usage);
  if (!output.empty()) calot::recorder::writeText(output, calot::bench::figures().json(), force);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures run time against a peer in the same run.", "calot-bench"};
  app.footer(
      "Google Benchmark's options --benchmark_NAME=VALUE are passed on: --benchmark_list_tests=true,\n"
      "--benchmark_filter=REGEX, --benchmark_out=F.json, ...\n\n"
      "Example:\n  calot-bench --benchmark_filter='contact|haptics' --figures figures.json");
  app.allow_extras();
  std::string output;
  bool force = false;
  app.add_option("--figures", output, "Write the headline figures of this run as one flat JSON map");
  app.add_flag("--force", force, "Overwrite that file");
  return calot::apps::runProgram(app, argc, argv, [&] { return run(output, force, argv[0], app.remaining()); });
}
