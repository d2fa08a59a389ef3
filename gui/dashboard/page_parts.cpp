// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/page_parts.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <QAbstractItemModel>
#include <QApplication>
#include <QEvent>
#include <QShortcut>
#include <QTimer>

#include "analytics/report/study_population.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/study_view.h"

namespace calot::gui {
namespace {

void beForLookingAt(QAbstractItemView& view, const char* name, const char* spokenName) {
  view.setObjectName(name);
  view.setAccessibleName(spokenName);
  view.setSelectionBehavior(QAbstractItemView::SelectRows);
  view.setEditTriggers(QAbstractItemView::NoEditTriggers);
  view.setAlternatingRowColors(true);
}

void beForLookingAt(QTableView& table, const char* name, const char* spokenName) {
  beForLookingAt(static_cast<QAbstractItemView&>(table), name, spokenName);
  table.setTabKeyNavigation(false);
  table.verticalHeader()->hide();
  table.verticalHeader()->setDefaultSectionSize(table.fontMetrics().height() + 9);
  table.horizontalHeader()->setStretchLastSection(true);
  table.horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
}

}  // namespace

QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* table = new QTableView;
  beForLookingAt(*table, name, spokenName);
  table->setModel(&model);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setWordWrap(false);
  table->horizontalHeader()->setHighlightSections(false);
  return table;
}

QTableWidget* makeTextTable(const QStringList& titles, const char* name, const char* spokenName) {
  auto* table = new QTableWidget(0, static_cast<int>(titles.size()));
  beForLookingAt(*table, name, spokenName);
  table->setHorizontalHeaderLabels(titles);
  return table;
}

void setTexts(QTableWidget& table, int row, const QStringList& texts, const std::string& key) {
  for (int column = 0; column < texts.size(); ++column) table.setItem(row, column, new QTableWidgetItem(texts[column]));
  table.item(row, 0)->setData(Qt::UserRole, QString::fromStdString(key));
}

QTreeView* makeTree(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* tree = new QTreeView;
  beForLookingAt(*tree, name, spokenName);
  tree->setModel(&model);
  tree->setUniformRowHeights(true);
  tree->header()->setStretchLastSection(true);
  tree->header()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return tree;
}

void wrapWords(QTableView& table) {
  table.setWordWrap(true);
  table.verticalHeader()->setMinimumSectionSize(table.verticalHeader()->defaultSectionSize());
  // Once for all columns that change together, when they have changed.
  auto* later = new QTimer(&table);
  later->setSingleShot(true);
  later->setInterval(0);
  QObject::connect(later, &QTimer::timeout, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.model(), &QAbstractItemModel::modelReset, &table, &QTableView::resizeRowsToContents);
  QObject::connect(table.horizontalHeader(), &QHeaderView::sectionResized, later, [later] { later->start(); });
}

QSplitter* makeSplitter(Qt::Orientation orientation, const std::vector<std::pair<QWidget*, int>>& parts) {
  auto* splitter = new QSplitter(orientation);
  for (const auto& [part, stretch] : parts) {
    splitter->addWidget(part);
    splitter->setStretchFactor(splitter->count() - 1, stretch);
  }
  splitter->setChildrenCollapsible(false);
  return splitter;
}

void refill(QComboBox& choice, const QStringList& entries, int other) {
  const QSignalBlocker quiet(choice);
  const QString before = choice.currentText();
  choice.clear();
  choice.addItems(entries);
  const int again = choice.findText(before);
  choice.setCurrentIndex(entries.isEmpty() ? -1 : again < 0 ? other : again);
}

void onKey(QWidget& widget, const QKeySequence& key, std::function<void()> action) {
  auto* shortcut = new QShortcut(key, &widget);
  shortcut->setContext(Qt::WidgetWithChildrenShortcut);
  QObject::connect(shortcut, &QShortcut::activated, &widget, std::move(action));
}

void GroupFields::offer(const std::vector<analytics::AttemptRow>& attempts) const {
  const QSignalBlocker quietBy(by), quietSynthetic(synthetic), quietPractice(practice);
  const bool people = !groupsOf(attempts, analytics::Grouping::group).empty();
  by->clear();
  by->addItem("study group", static_cast<int>(analytics::Grouping::group));
  by->addItem("performer's profile", static_cast<int>(analytics::Grouping::performer));
  by->setCurrentIndex(people ? 0 : 1);
  synthetic->setChecked(!people);
  practice->setChecked(std::none_of(attempts.begin(), attempts.end(), [](const analytics::AttemptRow& a) {
    return a.mode == recorder::Mode::assessment;
  }));
  refill(*key, textsOf(comparabilityKeysOf(attempts)));
  offerGroups(attempts);
}

void GroupFields::offerGroups(const std::vector<analytics::AttemptRow>& attempts) const {
  const analytics::Grouping grouping = options().grouping;
  const std::vector<std::string> names = groupsOf(attempts, grouping);
  std::vector<std::ptrdiff_t> sizes;
  for (const std::string& name : names)
    sizes.push_back(std::ranges::count_if(
        attempts, [&](const analytics::AttemptRow& a) { return analytics::groupOf(a, grouping) == name; }));
  // The two with the most attempts are compared until others are chosen.
  std::vector<int> chosen(names.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  std::ranges::stable_sort(chosen, std::greater(), [&](int at) { return sizes[static_cast<std::size_t>(at)]; });
  chosen.resize(2, -1);
  if (chosen[1] >= 0 && chosen[1] < chosen[0]) std::swap(chosen[0], chosen[1]);
  for (const auto& [group, at] : {std::pair{first, chosen[0]}, std::pair{second, chosen[1]}}) {
    const QSignalBlocker quiet(group);
    group->clear();
    group->addItems(textsOf(names));
    group->setCurrentIndex(at);
  }
}

analytics::StudyOptions GroupFields::options() const {
  analytics::StudyOptions options;
  options.groups = {first->currentText().toStdString(), second->currentText().toStdString()};
  options.grouping = static_cast<analytics::Grouping>(by->currentData().toInt());
  options.includeSynthetic = synthetic->isChecked();
  options.includePractice = practice->isChecked();
  options.key = key->currentText().toStdString();
  return options;
}

void CohortPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  outdate();
}

void CohortPage::focusBegin() { (begin_ != nullptr ? begin_ : this)->setFocus(Qt::OtherFocusReason); }

void CohortPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  if (document_ && std::exchange(outdated_, false)) read();
}

void CohortPage::outdate() {
  outdated_ = !isVisible();
  if (document_ && !outdated_) read();
}

bool CohortPage::tryTo(const std::function<void()>& call) {
  const QString fault = faultOf(call);
  if (!fault.isEmpty()) emit problem(fault);
  return fault.isEmpty();
}

AttemptBanner::AttemptBanner()
    : watermark_(parts::selectableLabel("watermark")),
      identity_(parts::selectableLabel("identity")),
      badge_(parts::selectableLabel("badge")) {
  watermark_->setText("SYNTHETIC — made by a performer");
  watermark_->setToolTip("It shows that the pipeline works and says nothing about people.");
  parts::embolden(watermark_);
  theme::setGround(*watermark_, QColor(0xf0, 0xe4, 0x42), Qt::black);
  watermark_->hide();
  for (QLabel* const label : {watermark_, badge_}) label->setWordWrap(false);
  setLayout(parts::bare(parts::row({watermark_, {identity_, 3}, badge_})));
}

void AttemptBanner::showAttempt(const analytics::AttemptRow& attempt) {
  QString text = QString("%1 · %2 · %3 · %4 · attempt %5")
                     .arg(operatorText(attempt), QString::fromStdString(attempt.scene), startText(attempt.startUtc),
                          outcomeText(attempt.outcome), QString::fromStdString(attempt.uuid).left(8));
  if (attempt.excluded) text += "\nExcluded from studies: " + QString::fromStdString(attempt.exclusionReason);
  identity_->setText(text);
  const Badge badge = badgeOf(attempt);
  const QString found = QString::fromStdString(attempt.verification.text);
  badge_->setText(found.isEmpty() ? badge.text : badge.text + ": " + found);
  badge_->setWordWrap(!found.isEmpty());
  badge_->setToolTip(badge.explanation + '\n' + QString::fromStdString(attempt.uuid) + '\n' +
                     QString::fromStdString(analytics::comparabilityWords(attempt.comparabilityKey)));
  verdict_ = attempt.verification.verdict;
  colourBadge();
  watermark_->setVisible(attempt.synthetic);
}

void AttemptBanner::makeNarrow() {
  watermark_->setText("SYNTHETIC");
  badge_->hide();  // the choice above says it
}

void AttemptBanner::colourBadge() {
  QPalette own = QApplication::palette();
  own.setColor(QPalette::WindowText, theme::ofVerdict(verdict_));
  badge_->setPalette(own);
}

void AttemptBanner::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) colourBadge();
}

void AttemptBanner::showText(const QString& text) {
  identity_->setText(text);
  badge_->clear();
  watermark_->hide();
}

}  // namespace calot::gui
