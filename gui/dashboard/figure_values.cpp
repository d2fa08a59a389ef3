// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figure_values.h"

#include <map>
#include <string>
#include <utility>

namespace calot::gui {

FigureValues::FigureValues(const std::function<void(const Take&)>& each) {
  std::map<std::pair<std::string, std::string>, std::size_t> index;
  std::vector<Figure> figures;
  std::vector<std::vector<analytics::AttemptValue>> values;
  std::vector<bool> hasValue;
  each([&](const analytics::AttemptValue& value) {
    const auto [at, isNew] = index.try_emplace({value.value.name, value.value.subject}, figures.size());
    if (isNew) {
      figures.push_back({value.value.name, value.value.subject});
      values.emplace_back();
      hasValue.push_back(false);
    }
    values[at->second].push_back(value);
    if (value.value.value) hasValue[at->second] = true;
  });
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (!hasValue[i]) continue;
    figures_.push_back(std::move(figures[i]));
    values_.push_back(std::move(values[i]));
  }
}

}  // namespace calot::gui
