// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/event_tree_model.h"

#include <algorithm>

#include "gui/attempt/theme.h"
#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

QList<QStandardItem*> line(const QString& what, const QString& time, const TrackEvent& event) {
  auto* first = new QStandardItem(what);
  auto* second = new QStandardItem(time);
  for (QStandardItem* item : {first, second}) {
    item->setEditable(false);
    item->setData(event.time, EventTreeModel::secondsRole);
    if (event.error) item->setToolTip("Something that should not happen");
  }
  return {first, second};
}

}  // namespace

EventTreeModel::EventTreeModel(QObject* parent) : QStandardItemModel(parent) {
  setHorizontalHeaderLabels({"Event", "Time"});
}

void EventTreeModel::setEvents(const std::vector<TrackEvent>& events) {
  clear();
  setHorizontalHeaderLabels({"Event", "Time"});
  std::vector<std::vector<const TrackEvent*>> groups;
  for (const TrackEvent& event : events) {
    const auto at = std::find_if(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.front()->kind == event.kind; });
    if (at == groups.end())
      groups.push_back({&event});
    else
      at->push_back(&event);
  }
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group.front()->error; });
  for (const auto& group : groups) {
    const TrackEvent& first = *group.front();
    const EventWords* words = wordsOf(first.kind);
    QString title = words != nullptr ? QString::fromUtf8(words->phrase) : QString::fromStdString(first.text);
    title[0] = title[0].toUpper();
    QList<QStandardItem*> head =
        line(QString::fromUtf8(first.error ? "▲ %1 (%2)" : "%1 (%2)").arg(title).arg(group.size()),
             QString::fromStdString(timeText(first.time)), first);
    QFont bold = head[0]->font();
    bold.setBold(true);
    head[0]->setFont(bold);
    for (const TrackEvent* event : group)
      head[0]->appendRow(
          line(QString::fromStdString(event->text), QString::fromStdString(timeText(event->time)), *event));
    appendRow(head);
  }
}

}  // namespace calot::gui
