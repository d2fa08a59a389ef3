// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_lines.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "gui/attempt/words.h"

namespace calot::gui {
namespace {

QString tagsText(const std::vector<std::string>& tags) {
  QStringList words;
  for (const std::string& tag : tags) words += QString::fromStdString(tag);
  return words.join(", ");
}

QString cellText(const analytics::AttemptRow& attempt, int column) {
  switch (column) {
    case AttemptLines::attemptColumn:
      return QString::fromStdString(attempt.uuid).left(8);
    case AttemptLines::operatorColumn:
      return operatorText(attempt);
    case AttemptLines::groupColumn:
      return QString::fromStdString(attempt.group);
    case AttemptLines::sceneColumn:
      return QString::fromStdString(attempt.scene);
    case AttemptLines::modeColumn:
      return modeText(attempt.mode);
    case AttemptLines::outcomeColumn:
      return outcomeText(attempt.outcome) + (attempt.excluded ? ", excluded" : "");
    case AttemptLines::startColumn:
      return startText(attempt.startUtc);
    case AttemptLines::verificationColumn:
      return badgeText(attempt.verification.verdict);
    case AttemptLines::syntheticColumn:
      return attempt.synthetic ? QStringLiteral("synthetic") : QString();
    case AttemptLines::tagsColumn:
      return tagsText(attempt.tags);
    default:
      return {};
  }
}

}  // namespace

AttemptLines::AttemptLines(std::vector<analytics::AttemptRow> attempts) : attempts_(std::move(attempts)) {
  lines_.reserve(attempts_.size());
  std::set<std::string> tags;
  for (const analytics::AttemptRow& attempt : attempts_) {
    Line& line = lines_.emplace_back();
    QString text = QString::fromStdString(attempt.uuid) + '\n' + QString::fromStdString(attempt.profile) + '\n' +
                   QString::fromStdString(attempt.fileName);
    for (int column = 0; column < columnTotal; ++column) {
      line.cells[at(column)] = cellText(attempt, column);
      text += '\n' + line.cells[at(column)];
    }
    line.search = text.toLower();
    tags.insert(attempt.tags.begin(), attempt.tags.end());
  }
  for (const std::string& tag : tags) tags_ += QString::fromStdString(tag);
  std::vector<int> order(attempts_.size());
  for (int column = 0; column < columnTotal; ++column) {
    // A start is stored to the second and shown to the minute.
    const auto compare = [&](int a, int b) {
      return column == startColumn ? attempts_[at(a)].startUtc.compare(attempts_[at(b)].startUtc)
                                   : cell(a, column).compare(cell(b, column), Qt::CaseInsensitive);
    };
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return compare(a, b) < 0; });
    std::vector<int>& ranks = ranks_[at(column)];
    ranks.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool same = i > 0 && compare(order[i - 1], order[i]) == 0;
      ranks[at(order[i])] = same ? ranks[at(order[i - 1])] : static_cast<int>(i);
    }
  }
}

}  // namespace calot::gui
