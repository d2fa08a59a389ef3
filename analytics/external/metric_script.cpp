// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/external/metric_script.h"

#include <fmt/format.h>
#include <cstring>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/external/metric_input.h"
#include "analytics/external/script_process.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using ScriptJson = nlohmann::json;

constexpr std::size_t maxScriptBytes = 1U << 20U;
constexpr std::size_t maxMetricName = 64, maxMetricUnit = 16, maxMetricTitle = 120, maxMissingReason = 200;
constexpr std::uint32_t maxMetricVersion = 1000000;

std::string shortened(std::string text, std::size_t most) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text.size() > most ? text.substr(0, most) + "..." : text;
}

void writeBytes(const std::filesystem::path& file, const void* bytes, std::size_t size) {
  std::ofstream out(file, std::ios::binary);
  out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  if (!out.flush()) throw Error(ErrorKind::failure, Where{file.string()}, "cannot be written");
}

std::uint64_t bytesUnder(const std::filesystem::path& folder) {
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  return bytes;
}

void passOn(const ScriptPrint& print, const std::string& file, const std::string& printed) {
  if (!print) return;
  std::string_view rest = printed;
  while (!rest.empty()) print(file, shortened(std::string(recorder::takeLine(rest)), maxPrinted));
}

/// Parses the script's output. @throws Error (damaged) where it failed.
ScriptJson run(const std::string& file, const std::vector<std::byte>& text, const ScriptLimits& limits,
               const ScriptPrint& print, const std::filesystem::path* input) {
  const TemporaryFolder folder;
  const std::filesystem::path script = folder.path() / "metric.py", runner = folder.path() / "run_metric.py";
  writeBytes(script, text.data(), text.size());
  writeBytes(runner, metricRunner().data(), metricRunner().size());
  const std::string python = pythonProgram();
  std::vector<std::string> command{python, "-s", "-B", runner.string(), script.string(), file};
  if (input != nullptr) command.push_back(input->string());
  const ScriptEnd end = runScript(command, folder.path(), limits, input != nullptr ? bytesUnder(*input) : 0);
  passOn(print, file, end.printed);
  const auto fail = [&](const std::string& fault, const ScriptJson& line = {}) {
    return Error(ErrorKind::damaged, Where{file, line.is_number() ? fmt::format("line {}", line.get<int>()) : ""},
                 fault);
  };
  if (end.how == ScriptEnd::How::late)
    throw fail(fmt::format("takes more than {} s; allow it more, or look for a loop without end", limits.seconds));
  if (end.how == ScriptEnd::How::printedTooMuch) throw fail(fmt::format("prints more than {} bytes", maxPrinted));
  if (end.how == ScriptEnd::How::signalled)
    throw fail(fmt::format("ended by signal {} ({})", end.number, strsignal(end.number)));
  const ScriptJson answer = ScriptJson::parse(end.answer, nullptr, false);
  if (!answer.is_object()) throw fail(fmt::format("ended the program without a result (exit code {})", end.number));
  if (answer.contains("setup"))
    throw Error(ErrorKind::failure, Where{python},
                answer["setup"].get<std::string>() + "; install python3-numpy, or name another in CALOT_PYTHON");
  if (answer.contains("memory"))
    throw fail(fmt::format("takes more than {} MiB of memory; allow it more, or read less at a time", limits.mebibytes),
               answer.value("line", ScriptJson()));
  if (answer.contains("fault"))
    throw fail(shortened(answer["fault"].get<std::string>(), 4 * maxMissingReason), answer.value("line", ScriptJson()));
  return answer;
}

bool isMetricName(const std::string& name) {
  const auto letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && name.size() <= maxMetricName && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '-'; });
}

bool isMetricText(const std::string& text, std::size_t most) {
  return !text.empty() && text.size() <= most &&
         std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

ExternalMetric metricOf(const ScriptJson& declared, const std::string& file, std::string sha256) {
  const auto fail = [&](const std::string& fault) { return Error(ErrorKind::damaged, Where{file}, fault); };
  ExternalMetric metric;
  CheckpointDefinition& d = metric.definition;
  d.name = declared.at("name").get<std::string>();
  if (!isMetricName(d.name))
    throw fail(fmt::format("NAME \"{}\": 1 to {} small letters, digits and hyphens are wanted, a letter first",
                           recorder::shown(d.name), maxMetricName));
  if (findCheckpoint(d.name) != nullptr)
    throw fail(fmt::format("NAME \"{}\" is a checkpoint of the program (calot checkpoints lists them)", d.name));
  const ScriptJson& version = declared.at("version");
  if (!version.is_number_unsigned() || version.get<std::uint64_t>() < 1 ||
      version.get<std::uint64_t>() > maxMetricVersion)
    throw fail(fmt::format("VERSION {}: 1 to {} is wanted", version.dump(), maxMetricVersion));
  d.version = version.get<std::uint32_t>();
  d.unit = d.displayUnit = declared.at("unit").get<std::string>();
  if (!isMetricText(d.unit, maxMetricUnit))
    throw fail(fmt::format("UNIT: 1 to {} bytes on one line are wanted, \"1\" for a share", maxMetricUnit));
  d.title = declared.at("title").get<std::string>();
  if (!isMetricText(d.title, maxMetricTitle))
    throw fail(fmt::format("TITLE: 1 to {} bytes on one line are wanted", maxMetricTitle));
  static const std::map<std::string, Direction> directions{
      {"lower", Direction::lower}, {"higher", Direction::higher}, {"none", Direction::none}};
  const auto better = declared.at("better").get<std::string>();
  const auto direction = directions.find(better);
  if (direction == directions.end())
    throw fail(fmt::format("BETTER \"{}\": lower, higher or none is wanted", recorder::shown(better)));
  d.direction = direction->second;
  d.window = "whole attempt";
  d.filter = "none";
  d.origins = {Origin::external};
  d.finality = Finality::final;
  d.definition = "script with SHA-256 " + sha256;
  metric.sha256 = std::move(sha256);
  return metric;
}

}  // namespace

MetricScript::MetricScript(const std::filesystem::path& file, const ScriptLimits& limits, ScriptPrint print)
    : file_(file.string()), limits_(limits), print_(std::move(print)) {
  text_ = recorder::readFileBytes(file, file_, maxScriptBytes);
  metric_ = ExternalMetricRef(metricOf(run(file_, text_, limits_, print_, nullptr), file_, recorder::sha256Hex(text_)));
}

CheckpointValue MetricScript::compute(const std::filesystem::path& folder, const std::string& note) const {
  const ScriptJson answer = run(file_, text_, limits_, print_, &folder);
  const CheckpointDefinition& d = metric_->definition;
  CheckpointValue value = answer.contains("value")
                              ? makeValue(d, "", Origin::external, answer.at("value").get<double>(), note)
                              : makeMissing(d, "", Origin::external, Availability::notAvailable,
                                            shortened(answer.at("missing").get<std::string>(), maxMissingReason));
  value.metric = metric_;
  return value;
}

std::vector<MetricScript> readMetricScripts(const std::vector<std::string>& files, const ScriptLimits& limits,
                                            const ScriptPrint& print) {
  std::vector<MetricScript> scripts;
  for (const std::string& file : files) {
    MetricScript script(file, limits, print);
    for (const MetricScript& other : scripts) {
      if (other.metric()->definition.name == script.metric()->definition.name)
        throw Error(ErrorKind::invalid, Where{file},
                    fmt::format("NAME {} is that of {} too", script.metric()->definition.name, other.file()));
    }
    scripts.push_back(std::move(script));
  }
  return scripts;
}

MetricOutcomes computeMetrics(const std::vector<MetricScript>& scripts, const std::filesystem::path& folder,
                              const std::string& note) {
  MetricOutcomes outcomes;
  for (const MetricScript& script : scripts) {
    try {
      outcomes.values.push_back(script.compute(folder, note));
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::damaged) throw;
      outcomes.failures.push_back(e);
    }
  }
  return outcomes;
}

}  // namespace calot::analytics
