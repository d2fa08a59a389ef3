// SPDX-License-Identifier: GPL-3.0-or-later

#include "gui/dashboard/dialogs.h"

#include <algorithm>
#include <QAction>
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTableWidget>
#include <utility>

#include "analytics/assessment/create_norm.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/theme.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/comparison.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/study_view.h"

namespace calot::gui {

KeyList keysOf(const QMenuBar& menus) {
  KeyList keys;
  for (const QAction* menu : menus.actions()) {
    if (menu->menu() == nullptr) continue;
    for (const QAction* action : menu->menu()->actions()) {
      if (action->shortcut().isEmpty()) continue;
      QString text = action->text().remove('&').remove(QString::fromUtf8(" …")).trimmed();
      keys.emplace_back(action->shortcut().toString(QKeySequence::NativeText), text);
    }
  }
  keys.insert(keys.end(), {{"Tab, Shift+Tab", "Next field, last field"},
                           {"Alt and a letter", "The field whose letter is underlined"},
                           {"Arrows", "Rows of a table; dots of a plot; events of a timeline"},
                           {"Left, Right", "In a tree: fold, unfold"},
                           {"Enter", "Open what is chosen; its worst moment, then the next one"},
                           {"Space", "Play or pause the replay"},
                           {", and .", "One step back, one step forward"},
                           {"Ctrl+Return", "Store a rating and go to the next attempt"}});
  return keys;
}

KeysDialog::KeysDialog(const KeyList& keys, QWidget* parent) : QDialog(parent) {
  setWindowTitle("Keys");
  auto* table = new QTableWidget(static_cast<int>(keys.size()), 2);
  table->setObjectName("keys");
  table->setAccessibleName("Keys and what they do");
  table->setHorizontalHeaderLabels({"Key", "What it does"});
  table->verticalHeader()->hide();
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setTabKeyNavigation(false);
  table->horizontalHeader()->setStretchLastSection(true);
  table->setColumnWidth(0, theme::inType(160));
  int row = 0;
  for (const auto& [key, what] : keys) {
    table->setItem(row, 0, new QTableWidgetItem(key));
    table->setItem(row++, 1, new QTableWidgetItem(what));
  }
  auto* close = new QDialogButtonBox(QDialogButtonBox::Close);
  connect(close, &QDialogButtonBox::rejected, this, &QDialog::reject);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(table, 1);
  layout->addWidget(close);
  resize(theme::inType(520), theme::inType(420));
}

namespace {

constexpr const char* explanation =
    "A norm is what later attempts are graded against. These figures count: time, path lengths, critical view, clip "
    "errors, perforations and burns, as far as they have a pass mark. Other figures, raters' judgements and marks that "
    "a person sets: calot norm create.";

}  // namespace

NormDialog::NormDialog(std::shared_ptr<const CohortDocument> document, std::vector<std::string> selected,
                       QWidget* parent)
    : QDialog(parent),
      document_(std::move(document)),
      selected_(std::move(selected)),
      name_(parts::named("norm-name", new QLineEdit)),
      by_(parts::named("norm-by", new QLineEdit)),
      attempts_(parts::named("norm-attempts", new QComboBox)),
      groupBy_(parts::named("norm-group-by", new QComboBox)),
      competent_(parts::named("norm-competent", new QComboBox)),
      others_(parts::named("norm-others", new QComboBox)),
      key_(parts::named("norm-key", new QComboBox)),
      rule_(parts::named("norm-rule", new QComboBox)),
      least_(parts::named("norm-least", new QSpinBox)),
      first_(parts::named("norm-first", new QCheckBox("Of a participant's several attempts the &first counts"))),
      practice_(parts::named("norm-practice", new QCheckBox("&Practice attempts, too"))),
      synthetic_(parts::named("norm-synthetic", new QCheckBox("&Synthetic attempts, too (the norm is marked)"))),
      result_(parts::named("norm-result", new QLabel)),
      make_(parts::named("norm-make", new QPushButton("&Make the norm"))),
      strip_(new WorkStrip(work_)) {
  setWindowTitle("Make a norm");
  resize(theme::inType(620), theme::inType(460));
  auto* layout = new QVBoxLayout(this);
  auto* told = new QLabel(explanation);
  told->setWordWrap(true);
  layout->addWidget(told);
  auto* form = new QFormLayout;
  buildChoices(*form);
  layout->addLayout(form);
  result_->setTextFormat(Qt::PlainText);
  result_->setWordWrap(true);
  result_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  layout->addWidget(result_, 1);
  layout->addWidget(strip_);
  auto* buttons = new QHBoxLayout;
  auto* close = new QPushButton("&Close");
  buttons->addStretch(1);
  buttons->addWidget(make_);
  buttons->addWidget(close);
  layout->addLayout(buttons);
  make_->setDefault(true);
  connect(close, &QPushButton::clicked, this, &QDialog::accept);
  connect(make_, &QPushButton::clicked, this, &NormDialog::make);
  connect(&work_, &LongWork::done, this, [this](const QString& text) {
    allow(true);
    result_->setText(text);
    emit made();
  });
  connect(&work_, &LongWork::failed, this, [this](const QString& reason) {
    allow(true);
    result_->setText("No norm was made: " + reason);
    emit refused();
  });
  connect(&work_, &LongWork::cancelled, this, [this] {
    allow(true);
    result_->setText("Cancelled: no norm was made.");
  });
}

void NormDialog::buildChoices(QFormLayout& form) {
  const std::vector<analytics::AttemptRow>& all = document_->attempts();
  name_->setMaxLength(64);
  name_->setPlaceholderText("letters, digits, points, hyphens; the same name again is its next version");
  by_->setMaxLength(64);
  by_->setText(settings::person());
  by_->setPlaceholderText("your pseudonym");
  attempts_->addItem("all of the cohort");
  if (selected_.size() > 1) {
    attempts_->addItem(QString("only the %1 that are selected").arg(selected_.size()));
    attempts_->setCurrentIndex(1);
  }
  groupBy_->addItem("study group", static_cast<int>(GroupBy::group));
  groupBy_->addItem("performer's profile", static_cast<int>(GroupBy::profile));
  const bool people = !groupsOf(all, GroupBy::group).empty();
  groupBy_->setCurrentIndex(people ? 0 : 1);
  synthetic_->setChecked(!people);
  first_->setChecked(true);
  practice_->setChecked(std::none_of(
      all.begin(), all.end(), [](const analytics::AttemptRow& a) { return a.mode == recorder::Mode::assessment; }));
  for (const std::string& key : comparabilityKeysOf(all)) key_->addItem(QString::fromStdString(key));
  key_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  key_->setMinimumContentsLength(20);
  rule_->addItem("all figures that count are passed");
  rule_->addItem("at least so many of them are passed");
  least_->setRange(1, 1000);
  least_->setEnabled(false);
  auto* rule = new QHBoxLayout;
  rule->addWidget(rule_, 1);
  rule->addWidget(least_);
  form.addRow("&Name", name_);
  form.addRow("Made &by", by_);
  form.addRow("A&ttempts", attempts_);
  form.addRow("&Groups by", groupBy_);
  form.addRow("Comp&etent are", competent_);
  form.addRow("&Others are", others_);
  form.addRow("Comparable &within", key_);
  auto* ruleName = new QLabel("&Rule");  // a row that is a layout has no widget of its own for the letter
  ruleName->setBuddy(rule_);
  form.addRow(ruleName, rule);
  for (QCheckBox* box : {first_, practice_, synthetic_}) form.addRow(QString(), box);
  connect(groupBy_, &QComboBox::currentIndexChanged, this, [this] { fillGroups(); });
  connect(rule_, &QComboBox::currentIndexChanged, least_, [this](int index) { least_->setEnabled(index == 1); });
  for (QLineEdit* line : {name_, by_}) connect(line, &QLineEdit::textChanged, this, [this] { allow(true); });
  fillGroups();
  allow(true);
}

void NormDialog::fillGroups() {
  competent_->clear();
  others_->clear();
  for (const std::string& name :
       groupsOf(document_->attempts(), static_cast<GroupBy>(groupBy_->currentData().toInt()))) {
    competent_->addItem(QString::fromStdString(name));
    others_->addItem(QString::fromStdString(name));
  }
  others_->setCurrentIndex(others_->count() > 1 ? 1 : -1);
}

void NormDialog::allow(bool ready) {
  make_->setEnabled(ready && !name_->text().trimmed().isEmpty() && !by_->text().trimmed().isEmpty());
}

void NormDialog::make() {
  analytics::NormRequest request;
  request.name = name_->text().trimmed().toStdString();
  request.by = by_->text().trimmed().toStdString();
  request.leastPassed = rule_->currentIndex() == 1 ? static_cast<std::uint32_t>(least_->value()) : 0;
  analytics::StudyOptions& who = request.who;
  who.grouping = static_cast<GroupBy>(groupBy_->currentData().toInt()) == GroupBy::profile
                     ? analytics::Grouping::performer
                     : analytics::Grouping::group;
  who.groups = {competent_->currentText().toStdString(), others_->currentText().toStdString()};
  who.better = who.groups.front();
  who.key = key_->currentText().toStdString();
  who.includePractice = practice_->isChecked();
  who.includeSynthetic = synthetic_->isChecked();
  if (first_->isChecked()) who.attemptRule = analytics::AttemptRule::first;
  const std::vector<std::string> only = attempts_->currentIndex() == 1 ? selected_ : std::vector<std::string>();
  settings::setPerson(QString::fromStdString(request.by));
  allow(false);
  result_->clear();
  strip_->begin("Making the norm");
  work_.start([request, only, database = document_->path()](LongWork::Control& control) {
    const analytics::Norm norm = analytics::createNorm(database, request, only, [&](double share, const char* doing) {
      control.progress(share, QString("Making the norm: ") + doing);
    });
    QStringList lines;
    for (const std::string& line : analytics::normSummary(norm)) lines += QString::fromStdString(line);
    for (const std::string& line : analytics::normWarnings(norm)) lines += QString::fromStdString(line);
    if (norm.synthetic) lines.prepend("SYNTHETIC: made of performers' attempts, of no person's.");
    return lines.join("\n\n");
  });
}

}  // namespace calot::gui
