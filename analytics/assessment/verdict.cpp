// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/verdict.h"

#include <fmt/format.h>

#include <cmath>

#include "analytics/checkpoints/error_words.h"

namespace calot::analytics {

const std::array<std::pair<Severity, std::string_view>, severityCount>& errorCheckpoints() {
  static const std::array<std::pair<Severity, std::string_view>, severityCount> all{
      {{Severity::critical, criticalErrors}, {Severity::major, "major-errors"}, {Severity::minor, "minor-errors"}}};
  return all;
}

std::string errorSentence(Severity severity, const CheckpointValue* value) {
  std::string name = nameOf(severity);
  name[0] = static_cast<char>(name[0] - 'a' + 'A');
  if (value == nullptr) return fmt::format("{} errors: not assessed.", name);
  if (!value->value) return fmt::format("{} errors: not assessed, {}.", name, value->reason);
  const CheckpointDefinition* const definition = findCheckpoint(value->name);
  if (definition != nullptr && definition->version != value->version)
    return fmt::format("{} errors: {:g} by version {} of the rules, which are of version {} now.", name, *value->value,
                       value->version, definition->version);
  const SeverityWords words{static_cast<std::uint32_t>(std::lround(*value->value)), value->note};
  return severity == Severity::critical ? safetySentence(words) : severitySentence(severity, words);
}

}  // namespace calot::analytics
