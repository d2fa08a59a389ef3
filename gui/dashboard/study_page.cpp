// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/study_page.h"

#include <algorithm>
#include <cmath>
#include <QCoreApplication>
#include <QFileDialog>
#include <QFont>
#include <QImage>
#include <QList>
#include <QPainter>
#include <QStandardItemModel>
#include <QTextBrowser>
#include <QTextDocument>
#include <QTextOption>
#include <QTimer>
#include <QUrl>

#include "analytics/report/study_output.h"
#include "gui/attempt/figure_text.h"
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
  if (row.test && row.attainableP) parts += QString("p = %1").arg(numberText(row.test->p));
  if (row.holm) parts += QString::fromUtf8("Holm‑adjusted p = %1").arg(numberText(*row.holm));
  if (parts.isEmpty()) return "No effect size: " + QString::fromStdString(row.area.reason()) + '.';
  // A line ends between figures, not within one (nor at the hyphen above).
  for (QString& part : parts) part.replace(' ', QChar(QChar::Nbsp));
  return parts.join(QString::fromUtf8(" · "));
}

/// Values of a row, as Compare shows them.
Comparison comparisonOf(const analytics::Study& study, const analytics::StudyRow& row,
                        const std::vector<analytics::AttemptRow>& attempts) {
  std::set<std::string> performers;  // as a row names them
  for (const analytics::AttemptRow& a : attempts) {
    if (a.synthetic) performers.insert(a.participant.empty() ? "attempt " + a.uuid : a.participant);
  }
  Comparison made;
  made.unit = row.unit == "1" ? "" : row.unit;
  made.synthetic = study.synthetic;
  for (std::size_t g = 0; g < row.values.size(); ++g) {
    ComparisonGroup& group = made.group.emplace_back();
    group.name = study.groups[g];
    for (std::size_t i = 0; i < row.values[g].size(); ++i) {
      const std::string& who = row.participants[g][i];
      group.point.push_back({who, row.values[g][i], performers.count(who) > 0});
    }
  }
  return made;
}

/// The study's first forest plot, shown under forestAddress; null where the study has none. Any thread.
QImage forestPicture(const analytics::Study& study, const QFont& font, double ratio) {
  const std::vector<analytics::Drawing> forests = analytics::forestsOf(study);
  if (forests.empty()) return {};
  const analytics::Drawing& forest = forests.front();
  QImage image(static_cast<int>(std::ceil(forest.width * ratio)), static_cast<int>(std::ceil(forest.height * ratio)),
               QImage::Format_ARGB32_Premultiplied);
  image.setDevicePixelRatio(ratio);
  image.fill(Qt::white);
  QPainter painter(&image);
  painter.setRenderHint(QPainter::Antialiasing);
  paintDrawing(painter, forest, QRectF(0.0, 0.0, forest.width, forest.height), {font});
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
  WindowsText text;
};

StudyPage::StudyPage()
    : fields_{parts::choice("study-group-by", 8),
              parts::choice("study-first", 6),
              parts::choice("study-second", 6),
              parts::choice("study-key", 6),
              parts::named("study-synthetic", new QCheckBox("S&ynthetic attempts")),
              parts::named("study-practice", new QCheckBox("&Practice attempts"))},
      rule_(parts::choice("study-rule", 6)),
      protocol_(parts::choice("study-protocol", 8)),
      state_(parts::plainLabel("study-state")),
      strip_(new WorkStrip(work_)),
      text_(parts::named("study-text", new QTextBrowser)),
      row_(parts::named("study-row", new QComboBox)),
      effect_(parts::named("study-effect", new QLabel)),
      boxes_(new PlotView("study-boxes", "Values by group")),
      roc_(new PlotView("roc-chart", "Receiver operating characteristic")),
      csv_(parts::named("study-csv", new QPushButton("Export C&SV …"))),
      html_(parts::named("study-html", new QPushButton("Export HTM&L …"))) {
  text_->setAccessibleName("Tables of the study");
  text_->setOpenLinks(false);
  text_->setWordWrapMode(QTextOption::WordWrap);
  effect_->setWordWrap(true);
  QWidget* const charts =
      parts::boxed(parts::column({parts::row({{"&Checkpoint", row_, 1}}), effect_, {boxes_, 1}, {roc_, 1}}));
  QSplitter* splitter = makeSplitter(Qt::Horizontal, {{text_, 3}, {charts, 2}});
  splitter->setSizes({830, 410});
  setLayout(parts::column({buildChoices(), state_, strip_, {splitter, 1}}));
  connectParts();
  begin_ = fields_.by;
}

QLayout* StudyPage::buildChoices() {
  rule_->addItem("the first", static_cast<int>(analytics::AttemptRule::first));
  rule_->addItem("the mean", static_cast<int>(analytics::AttemptRule::mean));
  protocol_->setToolTip("A protocol that is registered in this cohort makes the choices");
  QBoxLayout* const upper = parts::row({{"&By", fields_.by}, {"C&ompare", fields_.first}, {"w&ith", fields_.second}});
  parts::fill(upper, {{"Of several &attempts", rule_}, parts::spring(), csv_, html_});
  QBoxLayout* const lower = parts::row({{"Pro&tocol", protocol_}, {"Comparable &within", fields_.key, 1}});
  return parts::column({upper, parts::fill(lower, {fields_.synthetic, fields_.practice})});
}

void StudyPage::connectParts() {
  connect(fields_.by, &QComboBox::currentIndexChanged, this, [this] {
    if (document_) fields_.offerGroups(document_->attempts());
    make();
  });
  for (QComboBox* box : {fields_.first, fields_.second, rule_, fields_.key})
    connect(box, &QComboBox::currentIndexChanged, this, [this] { make(); });
  connect(protocol_, &QComboBox::currentIndexChanged, this, [this] {
    allowChoices();
    make();
  });
  connect(fields_.first, &QComboBox::currentIndexChanged, this, [this] { allowChoices(); });
  for (QCheckBox* box : {fields_.synthetic, fields_.practice})
    connect(box, &QCheckBox::toggled, this, [this] { make(); });
  connect(row_, &QComboBox::currentIndexChanged, this, [this] { showRow(); });
  connect(&work_, &LongWork::done, this, [this](const QString& text) {
    if (computed_) return take(std::exchange(computed_, nullptr));
    state_->setText(text);
    emit written();
  });
  connect(&work_, &LongWork::failed, this, [this](const QString& reason) {
    if (std::exchange(computed_, nullptr)) {
      state_->setText("There is no study with these choices: " + reason);
      text_->clear();
      return take(nullptr);
    }
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

void StudyPage::read() {
  const bool another = std::exchange(path_, document_->path()) != document_->path();
  made_ = checked_ = false;
  if (another) fields_.offer(document_->attempts());
  fillProtocols();
  // While recordings are imported a cohort is read again and again: what is being computed is shown before the next.
  if (another || !computed_) make();
}

void StudyPage::fillProtocols() {
  const QSignalBlocker quiet(protocol_);
  const QVariant before = protocol_->currentData();
  protocol_->clear();
  protocol_->addItem("none", QString());
  for (const analytics::RegisteredProtocol& p : document_->assessment().protocols()) {
    if (!p.withdrawnUtc.empty()) continue;
    protocol_->addItem(QString("%1, version %2").arg(QString::fromStdString(p.name)).arg(p.version),
                       QString::fromStdString(p.sha256));
  }
  protocol_->setCurrentIndex(std::max(0, protocol_->findData(before)));
  protocol_->setEnabled(protocol_->count() > 1);
  allowChoices();
}

/// Only what can make a study: a protocol leaves the key alone, and a group is not compared with itself.
void StudyPage::allowChoices() {
  const bool free = protocol_->currentData().toString().isEmpty();
  QComboBox *const first = fields_.first, *const second = fields_.second;
  for (QWidget* choice :
       std::initializer_list<QWidget*>{fields_.by, first, second, rule_, fields_.synthetic, fields_.practice})
    choice->setEnabled(free);
  auto* groups = qobject_cast<QStandardItemModel*>(second->model());
  for (int i = 0; groups != nullptr && i < groups->rowCount(); ++i)
    groups->item(i)->setEnabled(i != first->currentIndex());
  if (second->count() > 1 && second->currentIndex() == first->currentIndex())
    second->setCurrentIndex(first->currentIndex() == 0 ? 1 : 0);
}

void StudyPage::make() {
  if (!document_ || !isVisible()) return;
  made_ = true;
  study_ = nullptr;
  csv_->setEnabled(false);
  html_->setEnabled(false);
  state_->setText("Computing …");
  StudyRequest request{fields_.options(), protocol_->currentData().toString().toStdString(), !checked_};
  request.options.attemptRule = static_cast<analytics::AttemptRule>(rule_->currentData().toInt());
  computed_ = std::make_shared<Computed>();
  strip_->begin("Computing the study", shownAfter);
  const TextLook look{text_->font(), text_->document()->defaultTextOption(),
                      static_cast<qreal>(text_->viewport()->width()), devicePixelRatioF()};
  work_.start([computed = computed_, request, database = document_->path(), look](LongWork::Control& control) {
    computed->study =
        std::make_shared<const analytics::Study>(studyOf(database, request, [&](double share, const char* doing) {
          control.progress(share, QString("Computing the study: ") + doing);
        }));
    control.progress(1.0, "Computing the study: laying out");
    computed->text = textOf(*computed->study, look);
    return QString();
  });
}

void StudyPage::take(const std::shared_ptr<Computed>& computed) {
  study_ = computed ? computed->study : nullptr;
  checked_ = made_ && study_ != nullptr;  // of the document as it is now
  csv_->setEnabled(ready());
  html_->setEnabled(ready());
  QStringList titles;
  int first = 0;
  if (study_) {
    for (const analytics::StudyRow& row : study_->rows)
      titles += row.source.empty() ? figureTitle(row.checkpoint, row.subject)
                                   : QString::fromStdString(row.title) + " (external)";
    const auto leading = std::ranges::find(study_->rows, true, &analytics::StudyRow::leading);
    if (leading != study_->rows.end()) first = static_cast<int>(leading - study_->rows.begin());
  }
  refill(*row_, titles, first);
  if (study_) {
    state_->setText(QString("%1 of %2 attempts are analysed.").arg(study_->analysed).arg(study_->recruited));
    // The browser deletes only a document that it made itself.
    const QList<QTextDocument*> before = text_->findChildren<QTextDocument*>(Qt::FindDirectChildrenOnly);
    QTextDocument* const text = computed->text.release();
    text->setParent(text_);
    text_->setDocument(text);
    qDeleteAll(before);
  }
  // In another turn: text and charts together take longer than a person may be kept waiting.
  QTimer::singleShot(0, this, [this] {
    showRow();
    emit studyShown();
    if (!made_) outdate();
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
      [values = comparisonOf(*study_, row, document_->attempts()), name = row_->currentText().toStdString()](
          const analytics::PlotFrame& frame) { return drawComparison(values, name, frame); },
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

void StudyPage::write(const QString& target, bool html) {
  if (!study_ || busy()) return;
  state_->setText("Writing " + target + " …");  // short, and not to be broken off: half a file helps nobody
  work_.start([study = study_, database = document_->path(), target, html](LongWork::Control&) {
    const std::string warning = exportStudy(*study, database, target.toStdString(), html);
    return warning.empty() ? "Written: " + target : QString::fromStdString(warning);
  });
}

bool StudyPage::makeDocument(const Taker& take) {
  if (!study_) return false;
  take(analytics::studyDocument(*study_));
  return true;
}

void StudyPage::saveAs(bool html) {
  if (!study_) return;
  const QString target =
      html ? QFileDialog::getSaveFileName(this, "Write the study as a page (the cohort notes it for good)",
                                          "study.html", "Pages (*.html)")
           : QFileDialog::getExistingDirectory(
                 this, "Write study.csv, values.csv and flow.csv into (the cohort notes it for good)");
  if (!target.isEmpty()) write(target, html);
}

}  // namespace calot::gui
