// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_writer.h"

#include <exception>
#include <QMetaObject>
#include <utility>

#include "analytics/cohort/cohort_database.h"
#include "gui/words/problem_words.h"

namespace calot::gui {

CohortWriter::CohortWriter(QObject* parent) : QObject(parent), back_(std::make_shared<Link<CohortWriter>>(*this)) {
  thread_.setMaxThreadCount(1);
}

CohortWriter::~CohortWriter() {
  back_->cut();
  thread_.waitForDone();
}

void CohortWriter::write(const std::string& database, Change change, std::function<void()> undone) {
  thread_.start([back = back_, database, change = std::move(change), undone = std::move(undone)] {
    QString fault;
    try {
      analytics::CohortDatabase cohort(database, analytics::CohortDatabase::Access::write);
      change(cohort);
    } catch (const std::exception& error) {
      fault = QString::fromStdString(problemText(error));
      undone();
    }
    back->pass([&](CohortWriter& writer) {
      QMetaObject::invokeMethod(
          &writer,
          [&writer, fault] {
            if (fault.isEmpty())
              emit writer.written();
            else
              emit writer.failed(fault);
          },
          Qt::QueuedConnection);
    });
  });
}

}  // namespace calot::gui
