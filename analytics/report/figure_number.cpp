// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/figure_number.h"

#include <fmt/format.h>
#include <cmath>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {

bool isWrittenWhole(const CheckpointDefinition* definition, double shown) {
  return definition != nullptr && definition->domain == Domain::whole &&
         std::abs(shown - std::round(shown)) < arithmeticDust;
}

std::string figureNumber(const CheckpointDefinition* definition, double shown, int digits) {
  return isWrittenWhole(definition, shown) ? fmt::format("{:.0f}", std::round(shown) + 0.0)
                                           : significant(shown, digits);
}

const CheckpointDefinition* definitionOfFigure(const std::string& name) {
  return findCheckpoint(name.substr(0, name.find(' ')));
}

}  // namespace calot::analytics
