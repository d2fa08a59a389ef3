// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/error_words.h"

#include <algorithm>
#include <cmath>

namespace calot::analytics {
namespace {

std::string nameOf(ErrorSubject kind, std::uint16_t subject, const SubjectNames& names) {
  if (kind == ErrorSubject::none) return {};
  const bool structure = kind == ErrorSubject::structure;
  const std::vector<std::string>& of = structure ? names.structures : names.connective;
  if (subject < of.size()) return spoken(of[subject]);
  return structure ? "tissue" : "connective tissue";
}

}  // namespace

SubjectNames subjectNames(const SceneDescription& scene) {
  SubjectNames names;
  for (const OrganDescription& organ : scene.organs) names.structures.push_back(organ.name);
  for (const VesselDescription& vessel : scene.vessels) names.structures.push_back(vessel.name);
  for (const FatDescription& fat : scene.fat) names.structures.push_back(fat.name);
  for (const ConnectiveDescription& tissue : scene.connective) names.connective.push_back(tissue.name);
  return names;
}

std::string spoken(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '_' || c == '-'; }, ' ');
  return name;
}

std::string timeText(double seconds) {
  const auto tenths = static_cast<long long>(std::floor(std::max(0.0, seconds) * 10.0 + 1e-6));
  const long long rest = tenths / 10 % 60;
  return std::to_string(tenths / 600) + (rest < 10 ? ":0" : ":") + std::to_string(rest) + '.' +
         std::to_string(tenths % 10);
}

const char* nameOf(Severity severity) {
  constexpr const char* names[]{"minor", "major", "critical"};
  return names[static_cast<std::size_t>(severity) - 1];
}

std::string textOf(const AttemptError& error, const SubjectNames& names) {
  std::string text = nameOf(calot::textOf(error.rules.front()).subject, error.subject, names);
  for (const ErrorRule rule : error.rules) {
    if (!text.empty()) text += rule == error.rules.front() ? " " : ", ";
    text += calot::textOf(rule).words;
  }
  return text;
}

std::string ErrorLine::counted() const { return count > 1 ? text + ", " + std::to_string(count) + " times" : text; }

std::vector<ErrorLine> linesOf(const std::vector<AttemptError>& errors, const SubjectNames& names, double stepSeconds) {
  std::vector<ErrorLine> lines;
  for (const AttemptError& error : errors) {
    const double time = static_cast<double>(error.worst + 1) * stepSeconds;
    lines.push_back({error.severity(), error.count, time, textOf(error, names)});
  }
  return lines;
}

SeverityWords wordsOf(const std::vector<ErrorLine>& lines, Severity severity, const std::vector<std::string>& missing) {
  SeverityWords words;
  for (const ErrorLine& line : lines) {
    if (line.severity != severity) continue;
    words.count += line.count;
    words.lines += (words.lines.empty() ? "" : "; ") + line.counted() + (line.count > 1 ? ", worst at " : ", ") +
                   timeText(line.time);
  }
  for (const std::string& one : missing)
    words.lines += (&one != &missing.front() ? ", "
                    : words.lines.empty()    ? "not assessed: "
                                             : "; not assessed: ") +
                   one;
  return words;
}

std::string safetySentence(const SeverityWords& words) {
  if (words.count > 0) return "Not safe: " + words.lines + ".";
  return "No critical error" + (words.lines.empty() ? "" : "; " + words.lines) + ".";
}

std::string severitySentence(Severity severity, const SeverityWords& words) {
  const std::string name = std::string(nameOf(severity)) + (words.count == 1 ? " error" : " errors");
  if (words.count == 0) return "No " + name.substr(0, name.size() - 1) + ".";
  return std::to_string(words.count) + " " + name + ": " + words.lines + ".";
}

std::vector<std::string> verdictOf(const std::vector<AttemptError>& errors, const SubjectNames& names,
                                   double stepSeconds, const std::vector<std::string>& missing) {
  const std::vector<ErrorLine> lines = linesOf(errors, names, stepSeconds);
  std::vector<std::string> verdict{safetySentence(wordsOf(lines, Severity::critical, missing))};
  for (const Severity severity : {Severity::major, Severity::minor})
    verdict.push_back(severitySentence(severity, wordsOf(lines, severity)));
  return verdict;
}

}  // namespace calot::analytics
