// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/continuation.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFileInfo>
#include <QLabel>
#include <QPushButton>
#include <QRadioButton>
#include <QSpinBox>

#include "gui/attempt/widget_parts.h"
#include "gui/words/event_words.h"

namespace calot::gui {

ContinuationDialog::ContinuationDialog(double time, QWidget* parent)
    : QDialog(parent),
      performer_(
          parts::named("by-performer", new QRadioButton("A &performer goes on, and both are shown side by side"))),
      person_(parts::named("by-person", new QRadioButton("A p&erson goes on, in the trainer"))),
      profile_(parts::named("continuation-profile", new QComboBox)),
      seconds_(parts::named("continuation-seconds", new QSpinBox)) {
  setWindowTitle("Go on from " + QString::fromStdString(timeText(time)));
  profile_->addItems({"skilled", "intermediate", "unskilled"});
  seconds_->setRange(1, 600);
  seconds_->setValue(BranchRequest().seconds);
  seconds_->setSuffix(" s");
  performer_->setChecked(true);
  auto* const text = new QLabel(
      "The attempt itself stays as it is. Its steps up to this moment are simulated again, and a recording of its own "
      "begins there. To undo it, delete that recording, and exclude the attempt.");
  text->setWordWrap(true);
  auto* const decision = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  setLayout(parts::column(
      {text, performer_,
       parts::row({parts::space(24), {"P&rofile", profile_}, {"&Goes on for", seconds_}, parts::spring()}), person_,
       decision}));
  connect(performer_, &QRadioButton::toggled, this, [this](bool on) {
    profile_->setEnabled(on);
    seconds_->setEnabled(on);
  });
  connect(decision, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(decision, &QDialogButtonBox::rejected, this, &QDialog::reject);
}

bool ContinuationDialog::byPerformer() const { return performer_->isChecked(); }
QString ContinuationDialog::profile() const { return profile_->currentText(); }
int ContinuationDialog::seconds() const { return seconds_->value(); }

QString branchFile(const QString& parent, const QString& who, double time) {
  const QFileInfo info(parent);
  const QString stem =
      QString("%1/%2-%3-from-%4").arg(info.absolutePath(), info.completeBaseName(), who).arg(time, 0, 'f', 1);
  QString file = stem + ".h5";
  for (int n = 2; QFileInfo::exists(file); ++n) file = QString("%1-%2.h5").arg(stem).arg(n);
  return file;
}

}  // namespace calot::gui
