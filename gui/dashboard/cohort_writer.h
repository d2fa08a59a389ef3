// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <QObject>
#include <QThreadPool>
#include <string>

#include "gui/attempt/link.h"

namespace calot::analytics {
class CohortDatabase;
}

namespace calot::gui {

/// Writes what people decide into a cohort, one decision after the other, on a thread of its own: a disk may take its
/// time, and another program may be writing.
class CohortWriter : public QObject {
  Q_OBJECT
 public:
  using Change = std::function<void(analytics::CohortDatabase&)>;

  explicit CohortWriter(QObject* parent = nullptr);
  /// Waits until all is written.
  ~CohortWriter() override;
  /// Ends with written() or failed(). @param change throws calot::Error where it cannot be
  /// @param undone called on the writer's thread where nothing was written, before failed()
  void write(const std::string& database, Change change, std::function<void()> undone);

 signals:
  void written();
  void failed(const QString& reason);

 private:
  std::shared_ptr<Link<CohortWriter>> back_;
  QThreadPool thread_;  // last: it uses what is above
};

}  // namespace calot::gui
