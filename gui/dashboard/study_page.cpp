// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/study_page.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>

#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QCoreApplication>
#include <QFileDialog>
#include <QFont>
#include <QImage>
#include <QLabel>
#include <QList>
#include <QPainter>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSplitter>
#include <QStandardItemModel>
#include <QTextBrowser>
#include <QTextDocument>
#include <QTextOption>
#include <QTimer>
#include <QUrl>

#include "analytics/report/study_output.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/plot_view.h"
#include "gui/report/drawing_painter.h"

namespace calot::gui {
namespace {

QString effectText(const analytics::StudyRow& row) {
  QStringList parts;
  if (row.area)
    parts += QString("A = %1 [%2, %3]")
                 .arg(numberText(row.area->value.a), numberText(row.area->a.lower), numberText(row.area->a.upper));
  if (row.hedges) parts += QString("Hedges' g = %1").arg(numberText(row.hedges->g));
  if (row.test) parts += QString("p = %1").arg(numberText(row.test->p));
  if (row.holm) parts += QString::fromUtf8("Holm‑adjusted p = %1").arg(numberText(*row.holm));
  if (parts.isEmpty()) return "No effect size: " + QString::fromStdString(row.area.reason()) + '.';
  // A line ends between figures, not within one (nor at the hyphen above).
  for (QString& part : parts) part.replace(' ', QChar(QChar::Nbsp));
  return parts.join(QString::fromUtf8(" · "));
}

/// What a text shows under forestAddress; null where the study has none. Any thread.
QImage forestPicture(const analytics::Study& study, const QFont& font, double ratio) {
  const std::optional<analytics::Drawing> forest = analytics::forestOf(study);
  if (!forest) return {};
  QImage image(static_cast<int>(std::ceil(forest->width * ratio)), static_cast<int>(std::ceil(forest->height * ratio)),
               QImage::Format_ARGB32_Premultiplied);
  image.setDevicePixelRatio(ratio);
  image.fill(Qt::white);
  QPainter painter(&image);
  painter.setRenderHint(QPainter::Antialiasing);
  paintDrawing(painter, *forest, QRectF(0.0, 0.0, forest->width, forest->height), {font});
  return image;
}

/// Layout of the study's text on the page that requested it.
struct TextLook {
  QFont font;
  QTextOption option;
  qreal width = 0.0;  ///< of its lines
  qreal ratio = 1.0;  ///< of a picture's pixels
};

/// Whoever lets go of a document of the window's thread leaves its end to that thread.
struct DeleteLater {
  void operator()(QObject* object) const { object->deleteLater(); }
};
using WindowsText = std::unique_ptr<QTextDocument, DeleteLater>;

/// The study's text with its picture, laid out: on the window's own thread the tables of thousands of attempts would
/// take longer than a person may be kept waiting. It then is the window's.
WindowsText textOf(const analytics::Study& study, const TextLook& look) {
  auto text = std::make_unique<QTextDocument>();
  text->setDefaultFont(look.font);
  text->setDefaultTextOption(look.option);
  const QImage forest = forestPicture(study, look.font, look.ratio);
  if (!forest.isNull()) text->addResource(QTextDocument::ImageResource, QUrl(forestAddress), forest);
  text->setHtml(QString::fromStdString(studyText(study)));
  text->setTextWidth(look.width);
  (void)text->size();  // lays out
  text->moveToThread(QCoreApplication::instance()->thread());
  return WindowsText(text.release());
}

constexpr int shownAfter = 300;  // ms before progress is shown

}  // namespace

/// All that takes time, made on the thread of the work.
struct StudyPage::Computed {
  std::shared_ptr<const analytics::Study> study;
  std::string refusal;
  WindowsText text;
};

StudyPage::StudyPage(QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  buildChoices(*layout);
  state_ = parts::plainLabel("study-state");
  layout->addWidget(state_);
  strip_ = new WorkStrip(work_);
  layout->addWidget(strip_);

  text_ = parts::named("study-text", new QTextBrowser);
  text_->setAccessibleName("Tables of the study");
  text_->setOpenLinks(false);
  text_->setWordWrapMode(QTextOption::WordWrap);
  row_ = parts::named("study-row", new QComboBox);
  auto* rowLabel = new QLabel("&Checkpoint");
  rowLabel->setBuddy(row_);
  auto* rowLayout = new QHBoxLayout;
  rowLayout->addWidget(rowLabel);
  rowLayout->addWidget(row_, 1);
  effect_ = parts::named("study-effect", new QLabel);
  effect_->setWordWrap(true);
  boxes_ = new PlotView("study-boxes", "Values by group");
  roc_ = new PlotView("roc-chart", "Receiver operating characteristic");
  auto* charts = new QWidget;
  auto* chartLayout = parts::bare<QVBoxLayout>(charts);
  chartLayout->addLayout(rowLayout);
  chartLayout->addWidget(effect_);
  chartLayout->addWidget(boxes_, 1);
  chartLayout->addWidget(roc_, 1);
  auto* splitter = new QSplitter(Qt::Horizontal);
  splitter->addWidget(text_);
  splitter->addWidget(charts);
  splitter->setSizes({830, 410});
  splitter->setStretchFactor(0, 3);
  splitter->setStretchFactor(1, 2);
  splitter->setChildrenCollapsible(false);
  layout->addWidget(splitter, 1);
  connectParts();
  setProperty(beginProperty, QVariant::fromValue<QObject*>(groupBy_));
}

void StudyPage::buildChoices(QBoxLayout& layout) {
  const auto add = [](QHBoxLayout& row, const char* name, const char* text, int stretch) {
    auto* box = parts::choice(name, 6);
    parts::labelled(row, text, box, stretch);
    return box;
  };
  auto* upper = new QHBoxLayout;
  groupBy_ = add(*upper, "study-group-by", "&By", 0);
  groupBy_->setMinimumContentsLength(8);
  groupBy_->addItem("study group", static_cast<int>(GroupBy::group));
  groupBy_->addItem("performer's profile", static_cast<int>(GroupBy::profile));
  first_ = add(*upper, "study-first", "C&ompare", 0);
  second_ = add(*upper, "study-second", "w&ith", 0);
  rule_ = add(*upper, "study-rule", "Of several &attempts", 0);
  rule_->addItem("the first", static_cast<int>(analytics::AttemptRule::first));
  rule_->addItem("the mean", static_cast<int>(analytics::AttemptRule::mean));
  upper->addStretch(1);
  csv_ = new QPushButton("Export C&SV …");
  html_ = new QPushButton("Export HTM&L …");
  csv_->setObjectName("study-csv");
  html_->setObjectName("study-html");
  upper->addWidget(csv_);
  upper->addWidget(html_);
  layout.addLayout(upper);
  auto* lower = new QHBoxLayout;
  protocol_ = add(*lower, "study-protocol", "Pro&tocol", 0);
  protocol_->setMinimumContentsLength(8);
  protocol_->setToolTip("A protocol that is registered in this cohort makes the choices (calot protocol register)");
  key_ = add(*lower, "study-key", "Comparable &within", 1);
  synthetic_ = parts::named("study-synthetic", new QCheckBox("S&ynthetic attempts"));
  practice_ = parts::named("study-practice", new QCheckBox("&Practice attempts"));
  lower->addWidget(synthetic_);
  lower->addWidget(practice_);
  layout.addLayout(lower);
}

void StudyPage::connectParts() {
  connect(groupBy_, &QComboBox::currentIndexChanged, this, [this] {
    fillGroups();
    make();
  });
  for (QComboBox* box : {first_, second_, rule_, key_})
    connect(box, &QComboBox::currentIndexChanged, this, [this] { make(); });
  connect(protocol_, &QComboBox::currentIndexChanged, this, [this] {
    allowChoices();
    make();
  });
  connect(first_, &QComboBox::currentIndexChanged, this, [this] { allowChoices(); });
  for (QCheckBox* box : {synthetic_, practice_}) connect(box, &QCheckBox::toggled, this, [this] { make(); });
  connect(row_, &QComboBox::currentIndexChanged, this, [this] { showRow(); });
  connect(&work_, &LongWork::done, this, [this](const QString& text) {
    if (computed_) {
      take(*std::exchange(computed_, nullptr));
    } else {
      state_->setText(text);
      emit written();
    }
  });
  connect(&work_, &LongWork::failed, this, [this](const QString& reason) {
    if (std::exchange(computed_, nullptr))
      state_->setText("There is no study with these choices: " + reason);
    else
      emit written();
    emit problem(reason);
  });
  connect(&work_, &LongWork::cancelled, this, [this] {
    computed_.reset();
    state_->setText("Cancelled: no study was computed. Another choice, or Reload (F5), begins again.");
  });
  connect(csv_, &QPushButton::clicked, this, [this] { saveAs(false); });
  connect(html_, &QPushButton::clicked, this, [this] { saveAs(true); });
}

void StudyPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  const bool another = !document_ || document_->path() != document->path();
  document_ = std::move(document);
  made_ = checked_ = false;
  if (another) fillChoices();
  fillProtocols();
  // While recordings are imported a cohort is read again and again: what is being computed is shown before the next.
  if (isVisible() && (another || !computed_)) make();
}

void StudyPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (!made_) make();
}

void StudyPage::fillChoices() {
  const auto& attempts = document_->attempts();
  const QSignalBlocker quietGroup(groupBy_), quietKey(key_), quietSynthetic(synthetic_), quietPractice(practice_);
  // Nobody has a study group: then profiles tell more, and all is synthetic.
  const bool people = !groupsOf(attempts, GroupBy::group).empty();
  groupBy_->setCurrentIndex(people ? 0 : 1);
  synthetic_->setChecked(!people);
  bool assessment = false;
  for (const analytics::AttemptRow& attempt : attempts)
    assessment = assessment || attempt.mode == recorder::Mode::assessment;
  practice_->setChecked(!assessment);
  key_->clear();
  for (const std::string& key : comparabilityKeysOf(attempts)) key_->addItem(QString::fromStdString(key));
  fillGroups();
}

void StudyPage::fillGroups() {
  if (!document_) return;
  const QSignalBlocker quietFirst(first_), quietSecond(second_);
  first_->clear();
  second_->clear();
  for (const std::string& name :
       groupsOf(document_->attempts(), static_cast<GroupBy>(groupBy_->currentData().toInt()))) {
    first_->addItem(QString::fromStdString(name));
    second_->addItem(QString::fromStdString(name));
  }
  second_->setCurrentIndex(second_->count() > 1 ? 1 : -1);
}

void StudyPage::fillProtocols() {
  const QSignalBlocker quiet(protocol_);
  const QVariant before = protocol_->currentData();
  protocol_->clear();
  protocol_->addItem("none", QString());
  for (const analytics::RegisteredProtocol& p : document_->protocols())
    protocol_->addItem(QString("%1, version %2").arg(QString::fromStdString(p.name)).arg(p.version),
                       QString::fromStdString(p.sha256));
  protocol_->setCurrentIndex(std::max(0, protocol_->findData(before)));
  protocol_->setEnabled(protocol_->count() > 1);
  allowChoices();
}

/// Only what can make a study: a protocol leaves the key alone, and a group is not compared with itself.
void StudyPage::allowChoices() {
  const bool free = protocol_->currentData().toString().isEmpty();
  for (QWidget* choice : std::initializer_list<QWidget*>{groupBy_, first_, second_, rule_, synthetic_, practice_})
    choice->setEnabled(free);
  auto* groups = qobject_cast<QStandardItemModel*>(second_->model());
  for (int i = 0; groups != nullptr && i < groups->rowCount(); ++i)
    groups->item(i)->setEnabled(i != first_->currentIndex());
  if (second_->count() > 1 && second_->currentIndex() == first_->currentIndex())
    second_->setCurrentIndex(first_->currentIndex() == 0 ? 1 : 0);
}

void StudyPage::make() {
  if (!document_ || !isVisible()) return;
  made_ = true;
  study_ = nullptr;
  csv_->setEnabled(false);
  html_->setEnabled(false);
  state_->setText("Computing …");
  StudyRequest request;
  request.groupBy = static_cast<GroupBy>(groupBy_->currentData().toInt());
  request.includeSynthetic = synthetic_->isChecked();
  request.includePractice = practice_->isChecked();
  request.key = key_->currentText().toStdString();
  request.attemptRule = static_cast<analytics::AttemptRule>(rule_->currentData().toInt());
  request.first = first_->currentText().toStdString();
  request.second = second_->currentText().toStdString();
  request.protocol = protocol_->currentData().toString().toStdString();
  request.check = !checked_;
  computed_ = std::make_shared<Computed>();
  strip_->begin("Computing the study", shownAfter);
  const TextLook look{text_->font(), text_->document()->defaultTextOption(),
                      static_cast<qreal>(text_->viewport()->width()), devicePixelRatioF()};
  work_.start([computed = computed_, request, database = document_->path(), look](LongWork::Control& control) {
    StudyAnswer answer = studyOf(database, request, [&](double share, const char* doing) {
      control.progress(share, QString("Computing the study: ") + doing);
    });
    computed->refusal = std::move(answer.refusal);
    if (!answer.study) return QString();
    control.progress(1.0, "Computing the study: laying out");
    computed->study = std::make_shared<const analytics::Study>(*std::move(answer.study));
    computed->text = textOf(*computed->study, look);
    return QString();
  });
}

void StudyPage::take(Computed& computed) {
  study_ = computed.study;
  checked_ = made_ && study_ != nullptr;  // of the document as it is now
  csv_->setEnabled(ready());
  html_->setEnabled(ready());
  {
    const QSignalBlocker quiet(row_);
    const QString before = row_->currentText();
    row_->clear();
    if (study_) {
      for (const analytics::StudyRow& row : study_->rows)
        row_->addItem(row.source.empty() ? figureTitle(row.checkpoint, row.subject)
                                         : QString::fromStdString(row.title) + " (external)");
      const auto leading = std::find_if(study_->rows.begin(), study_->rows.end(),
                                        [](const analytics::StudyRow& row) { return row.leading; });
      const auto first = leading == study_->rows.end() ? 0 : static_cast<int>(leading - study_->rows.begin());
      const int again = row_->findText(before);
      row_->setCurrentIndex(again < 0 ? first : again);
    }
  }
  if (study_) {
    state_->setText(QString("%1 of %2 attempts are analysed.").arg(study_->analysed).arg(study_->recruited));
    // The browser deletes only a document that it made itself.
    const QList<QTextDocument*> before = text_->findChildren<QTextDocument*>(Qt::FindDirectChildrenOnly);
    QTextDocument* const text = computed.text.release();
    text->setParent(text_);
    text_->setDocument(text);
    qDeleteAll(before);
  } else {
    state_->setText("There is no study with these choices: " + QString::fromStdString(computed.refusal));
    text_->clear();
  }
  // In another turn: text and charts together take longer than a person may be kept waiting.
  QTimer::singleShot(0, this, [this] {
    showRow();
    emit studyShown();
    if (!made_) make();
  });
}

void StudyPage::showRow() {
  const int at = row_->currentIndex();
  if (!study_ || at < 0) {
    effect_->clear();
    boxes_->clear("Box plot");
    roc_->clear("ROC");
    return;
  }
  const analytics::StudyRow& row = study_->rows[static_cast<std::size_t>(at)];
  effect_->setText(effectText(row));
  boxes_->show(
      row_->currentText(),
      [study = study_, &row](const analytics::PlotFrame& frame) { return analytics::boxPlotOf(*study, row, frame); },
      study_->synthetic);
  if (row.values[0].empty() || row.values[1].empty()) {
    roc_->clear("No ROC: a group has no values");
    return;
  }
  const RocCurve curve = rocOf(row);
  const QString title = QString("ROC: %1 values speak for %2; area %3")
                            .arg(curve.lowerIsPositive ? "small" : "large", QString::fromStdString(study_->groups[0]),
                                 numberText(curve.area));
  roc_->show(title, [curve, name = title.toStdString()](const analytics::PlotFrame& frame) {
    return drawRoc(curve, name, frame);
  });
}

void StudyPage::exportCsv(const QString& folder) { write(folder, false); }
void StudyPage::exportHtml(const QString& file) { write(file, true); }

void StudyPage::write(const QString& target, bool html) {
  if (!study_ || busy()) return;
  state_->setText("Writing " + target + " …");  // short, and not to be broken off: half a file helps nobody
  work_.start([study = study_, database = document_->path(), target, html](LongWork::Control&) {
    const std::string warning = html ? exportStudyHtml(*study, database, target.toStdString(), true)
                                     : exportStudyCsv(*study, database, target.toStdString(), true);
    return warning.empty() ? "Written: " + target : QString::fromStdString(warning);
  });
}

void StudyPage::saveAs(bool html) {
  if (!study_) return;
  const QString target =
      html ? QFileDialog::getSaveFileName(this, "Write the study as a page", "study.html", "Pages (*.html)")
           : QFileDialog::getExistingDirectory(this, "Write study.csv, values.csv and flow.csv into");
  if (target.isEmpty()) return;
  if (html)
    exportHtml(target);
  else
    exportCsv(target);
}

}  // namespace calot::gui
