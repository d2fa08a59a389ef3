// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/event_tree.h"

#include <algorithm>
#include <QFont>

#include "gui/words/attempt_summary.h"
#include "gui/words/event_words.h"

namespace calot::gui {

void listEvents(QStandardItemModel& tree, const std::vector<TrackEvent>& events,
                const std::vector<analytics::ErrorLine>& errors) {
  tree.setHorizontalHeaderLabels({"Event", "Time"});
  tree.removeRows(0, tree.rowCount());
  const auto rowOf = [](const QString& text, double time, bool marked) {
    auto* first = new QStandardItem(text);
    auto* second = new QStandardItem(QString::fromStdString(timeText(time)));
    for (QStandardItem* item : {first, second}) {
      item->setEditable(false);
      item->setData(time, eventSecondsRole);
      if (marked) item->setToolTip("Something that should not happen");
    }
    return QList<QStandardItem*>{first, second};
  };
  const auto addGroup = [&](const QString& text, double time, bool marked, const std::vector<const TrackEvent*>& of) {
    const QList<QStandardItem*> head = rowOf(marked ? QString::fromUtf8("▲ ") + text : text, time, marked);
    QFont bold = head[0]->font();
    bold.setBold(true);
    head[0]->setFont(bold);
    for (const TrackEvent* event : of)
      head[0]->appendRow(rowOf(QString::fromStdString(event->text), event->time, marked));
    tree.appendRow(head);
  };
  for (const analytics::ErrorLine& error : errors) {
    std::vector<const TrackEvent*> occasions;
    for (const TrackEvent& event : events) {
      if (error.count > 1 && event.severity && event.title == error.text) occasions.push_back(&event);
    }
    QString severity = analytics::nameOf(error.severity);
    severity[0] = severity[0].toUpper();
    addGroup(severity + ": " + QString::fromStdString(error.counted()), error.time, true, occasions);
  }
  std::vector<std::vector<const TrackEvent*>> groups;
  for (const TrackEvent& event : events) {
    if (event.severity) continue;
    const auto at = std::find_if(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.front()->title == event.title; });
    if (at == groups.end())
      groups.push_back({&event});
    else
      at->push_back(&event);
  }
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group.front()->error; });
  for (const auto& group : groups) {
    const TrackEvent& first = *group.front();
    QString title = QString::fromStdString(first.title);
    title[0] = title[0].toUpper();
    addGroup(QString("%1 (%2)").arg(title).arg(group.size()), first.time, first.error, group);
  }
}

}  // namespace calot::gui
