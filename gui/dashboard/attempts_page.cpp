// SPDX-License-Identifier: GPL-3.0-or-later

#include "gui/dashboard/attempts_page.h"

#include <algorithm>
#include <array>
#include <QBoxLayout>
#include <QComboBox>
#include <QFont>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableView>
#include <vector>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/settings.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {

void AttemptTableModel::setLines(std::shared_ptr<const AttemptLines> lines) {
  beginResetModel();
  lines_ = std::move(lines);
  endResetModel();
}

int AttemptTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() || !lines_ ? 0 : static_cast<int>(lines_->attempts().size());
}
int AttemptTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QVariant AttemptTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount() || index.column() >= columnTotal) return {};
  const analytics::AttemptRow& row = attempt(index.row());
  switch (role) {
    case Qt::DisplayRole:
      return lines_->cell(index.row(), index.column());
    case sortRole:
      return lines_->rank(index.row(), index.column());
    case searchRole:
      return lines_->search(index.row());
    case verdictRole:
      return static_cast<int>(row.verification.verdict);
    case syntheticRole:
      return row.synthetic;
    case uuidRole:
      return QString::fromStdString(row.uuid);
    case Qt::ForegroundRole:
      if (index.column() == verificationColumn) return badgeOf(row).colour;
      return {};
    case Qt::FontRole: {
      QFont font;
      if (index.column() == verificationColumn) font.setBold(true);
      if (index.column() == syntheticColumn) font.setItalic(true);
      return font;
    }
    case Qt::ToolTipRole:
      if (index.column() == attemptColumn) return QString::fromStdString(row.uuid);
      if (index.column() == verificationColumn) return badgeOf(row).explanation;
      if (index.column() == syntheticColumn && row.synthetic) return "Made by a performer, not by a person.";
      if (index.column() == outcomeColumn && row.excluded) return QString::fromStdString(row.exclusionReason);
      if (index.column() == tagsColumn) return lines_->cell(index.row(), tagsColumn);
      return {};
    default:
      return {};
  }
}

QVariant AttemptTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  static constexpr const char* titles[columnTotal] = {
      "Attempt", "Participant or profile", "Group",     "Scene", "Mode", "Outcome",
      "Start",   "Verification",           "Synthetic", "Tags"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return QString(titles[section]);
}

AttemptFilter::AttemptFilter(QObject* parent) : QSortFilterProxyModel(parent) {
  setSortRole(AttemptTableModel::sortRole);
}

void AttemptFilter::setSearch(const QString& text) {
  words_ = text.toLower().split(' ', Qt::SkipEmptyParts);
  refilter();
}

void AttemptFilter::setVerdict(std::optional<analytics::Verdict> verdict) {
  verdict_ = verdict;
  refilter();
}

void AttemptFilter::setOperators(Operators operators) {
  operators_ = operators;
  refilter();
}

void AttemptFilter::setTag(const QString& tag) {
  if (tag_ == tag.toStdString()) return;
  tag_ = tag.toStdString();
  refilter();
}

bool AttemptFilter::filterAcceptsRow(int sourceRow, const QModelIndex& sourceParent) const {
  const QModelIndex index = sourceModel()->index(sourceRow, 0, sourceParent);
  if (!tag_.empty()) {
    const auto* model = qobject_cast<const AttemptTableModel*>(sourceModel());
    const std::vector<std::string>& tags = model->attempt(sourceRow).tags;
    if (std::find(tags.begin(), tags.end(), tag_) == tags.end()) return false;
  }
  if (verdict_ && index.data(AttemptTableModel::verdictRole).toInt() != static_cast<int>(*verdict_)) return false;
  const bool synthetic = index.data(AttemptTableModel::syntheticRole).toBool();
  if (operators_ == Operators::people && synthetic) return false;
  if (operators_ == Operators::synthetic && !synthetic) return false;
  if (words_.isEmpty()) return true;
  const QString text = index.data(AttemptTableModel::searchRole).toString();
  return std::all_of(words_.begin(), words_.end(), [&](const QString& word) { return text.contains(word); });
}

namespace {

using analytics::Verdict;
constexpr std::array verdicts{Verdict::verified, Verdict::diverged, Verdict::damaged, Verdict::notCheckableHere,
                              Verdict::notChecked};

}  // namespace

AttemptsPage::AttemptsPage(QWidget* parent) : QWidget(parent) {
  filter_.setSourceModel(&attempts_);
  auto* upper = new QWidget;
  auto* upperLayout = parts::bare<QVBoxLayout>(upper);
  buildFilters(*upperLayout);
  table_ = makeTable(filter_, "attempts", "Attempts");
  table_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  table_->setSortingEnabled(true);
  table_->sortByColumn(AttemptTableModel::startColumn, Qt::DescendingOrder);
  const QStringList hidden = settings::hiddenColumns();
  for (int column = AttemptTableModel::operatorColumn; column < AttemptTableModel::columnTotal; ++column)
    table_->setColumnHidden(column,
                            hidden.contains(attempts_.headerData(column, Qt::Horizontal, Qt::DisplayRole).toString()));
  setWidths(*table_, {90, 180, 110, 130, 95, 130, 150, 150, 90});
  upperLayout->addWidget(table_);
  setProperty(beginProperty, QVariant::fromValue<QObject*>(table_));

  auto* lower = new QWidget;
  auto* lowerLayout = parts::bare<QVBoxLayout>(lower);
  buildDetails(*lowerLayout);

  auto* splitter = new QSplitter(Qt::Vertical);
  splitter->addWidget(upper);
  splitter->addWidget(lower);
  splitter->setStretchFactor(0, 3);
  splitter->setStretchFactor(1, 2);
  splitter->setChildrenCollapsible(false);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(splitter);

  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this] { showSelected(); });
  connect(table_->selectionModel(), &QItemSelectionModel::selectionChanged, this, [this] { showCount(); });
  connect(table_, &QTableView::activated, this, &AttemptsPage::attemptActivated);
}

void AttemptsPage::buildFilters(QBoxLayout& layout) {
  auto* row = new QHBoxLayout;
  search_ = parts::named("search", new QLineEdit);
  search_->setAccessibleName("Search attempts");
  search_->setPlaceholderText("Search (Ctrl+F): participant, profile, group, scene, date …");
  search_->setClearButtonEnabled(true);
  verdict_ = parts::named("verdict", new QComboBox);
  verdict_->addItem("All verdicts");
  for (const Verdict verdict : verdicts) verdict_->addItem(badgeText(verdict), static_cast<int>(verdict));
  operators_ = parts::named("operators", new QComboBox);
  operators_->addItem("People and synthetic");
  operators_->addItem("Not synthetic");
  operators_->addItem("Synthetic only");
  tag_ = parts::choice("tag", 8);
  tag_->setToolTip("Tags are put on attempts by the menu Edit, or by calot attempt tag");
  count_ = parts::named("count", new QLabel);
  const auto add = [&](const char* text, QWidget* field, int stretch) { parts::labelled(*row, text, field, stretch); };
  add("&Search", search_, 1);
  add("Verifi&cation", verdict_, 0);
  add("&Made by", operators_, 0);
  add("&Tag", tag_, 0);
  row->addWidget(count_);
  buildColumns(*row);
  layout.addLayout(row);

  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    filter_.setSearch(text);
    afterFilter();
  });
  connect(verdict_, &QComboBox::currentIndexChanged, this, [this](int index) {
    filter_.setVerdict(index <= 0 ? std::nullopt : std::optional(verdicts[static_cast<std::size_t>(index - 1)]));
    afterFilter();
  });
  connect(operators_, &QComboBox::currentIndexChanged, this, [this](int index) {
    filter_.setOperators(static_cast<AttemptFilter::Operators>(index));
    afterFilter();
  });
  connect(tag_, &QComboBox::currentIndexChanged, this, [this](int index) {
    filter_.setTag(index <= 0 ? QString() : tag_->itemText(index));
    afterFilter();
  });
}

void AttemptsPage::buildColumns(QBoxLayout& layout) {
  auto* button = parts::named("columns", new QPushButton("Co&lumns"));
  auto* menu = new QMenu(button);
  // The table is made after its filters.
  connect(menu, &QMenu::aboutToShow, this, [this, menu] {
    menu->clear();
    for (int column = AttemptTableModel::operatorColumn; column < AttemptTableModel::columnTotal; ++column) {
      QAction* action = menu->addAction(attempts_.headerData(column, Qt::Horizontal, Qt::DisplayRole).toString());
      action->setCheckable(true);
      action->setChecked(!table_->isColumnHidden(column));
      connect(action, &QAction::toggled, this, [this, column](bool shown) {
        table_->setColumnHidden(column, !shown);
        QStringList hidden;
        for (int c = 0; c < AttemptTableModel::columnTotal; ++c) {
          if (table_->isColumnHidden(c)) hidden += attempts_.headerData(c, Qt::Horizontal, Qt::DisplayRole).toString();
        }
        settings::setHiddenColumns(hidden);
      });
    }
  });
  button->setMenu(menu);
  layout.addWidget(button);
}

void AttemptsPage::buildDetails(QBoxLayout& layout) {
  banner_ = new AttemptBanner;
  layout.addWidget(banner_);
  details_ = makeTable(checkpoints_, "checkpoints", "Checkpoints of the selected attempt");
  setWidths(*details_, {330, 110, 170, 150, 0, 0, 140, 150, 110, 70});
  details_->hideColumn(CheckpointTableModel::intervalColumn);
  details_->hideColumn(CheckpointTableModel::normColumn);
  details_->hideColumn(CheckpointTableModel::momentColumn);
  // The longest words are a window's.
  details_->horizontalHeader()->setStretchLastSection(false);
  details_->horizontalHeader()->setSectionResizeMode(CheckpointTableModel::windowColumn, QHeaderView::Stretch);
  wrapWords(*details_);
  details_->setToolTip("Double-click, or press Enter, to see when a figure came about");
  layout.addWidget(details_);
  connect(details_, &QTableView::activated, this, [this](const QModelIndex& at) {
    const analytics::CheckpointValue& value = checkpoints_.value(at.row());
    emit figureActivated(QString::fromStdString(value.name), QString::fromStdString(value.subject));
  });
}

void AttemptsPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  const analytics::AttemptRow* before = selected();
  const QString uuid = before != nullptr ? QString::fromStdString(before->uuid) : QString();
  document_ = std::move(document);
  {
    const QSignalBlocker quiet(table_->selectionModel());
    attempts_.setLines(document_->lines());
    fillTags();
    showCount();
    // The same attempt stays selected where it is still there.
    if (filter_.rowCount() > 0) table_->selectRow(std::max(0, rowOf(uuid)));
  }
  table_->viewport()->update();
  showSelected();
}

int AttemptsPage::rowOf(const QString& uuid) const {
  if (filter_.rowCount() == 0 || uuid.isEmpty()) return -1;
  const QModelIndexList found =
      filter_.match(filter_.index(0, 0), AttemptTableModel::uuidRole, uuid, 1, Qt::MatchExactly);
  return found.isEmpty() ? -1 : found.first().row();
}

void AttemptsPage::select(const QString& uuid) {
  if (rowOf(uuid) < 0) {
    search_->clear();
    verdict_->setCurrentIndex(0);
    operators_->setCurrentIndex(0);
    tag_->setCurrentIndex(0);
  }
  if (const int row = rowOf(uuid); row >= 0) {
    table_->selectRow(row);
    table_->scrollTo(filter_.index(row, 0));
  }
}

void AttemptsPage::focusSearch() {
  search_->setFocus(Qt::ShortcutFocusReason);
  search_->selectAll();
}

void AttemptsPage::showCount() {
  QString text = QString("%1 of %2 attempts").arg(filter_.rowCount()).arg(attempts_.rowCount());
  if (table_ != nullptr) {
    const qsizetype chosen = table_->selectionModel()->selectedRows().size();
    if (chosen > 1) text += QString(", %1 selected").arg(chosen);
  }
  count_->setText(text);
}

/// What was current may be hidden now: then it is the first of what is left.
void AttemptsPage::afterFilter() {
  showCount();
  if (table_->currentIndex().isValid()) return;
  if (filter_.rowCount() > 0)
    table_->selectRow(0);
  else
    showSelected();
}

void AttemptsPage::fillTags() {
  const QSignalBlocker quiet(tag_);
  const QString before = tag_->currentIndex() > 0 ? tag_->currentText() : QString();
  tag_->clear();
  tag_->addItem("any, or none");
  tag_->addItems(document_->lines()->tags());
  tag_->setCurrentIndex(before.isEmpty() ? 0 : std::max(0, tag_->findText(before)));
  tag_->setEnabled(tag_->count() > 1);
  if (tag_->currentIndex() == 0) filter_.setTag({});
}

void AttemptsPage::selectNext() {
  const int row = table_->currentIndex().row() + 1;
  if (row < filter_.rowCount()) table_->selectRow(row);
}

std::vector<analytics::AttemptRow> AttemptsPage::selectedAll() const {
  QModelIndexList rows = table_->selectionModel()->selectedRows();
  std::sort(rows.begin(), rows.end());
  std::vector<analytics::AttemptRow> chosen;
  for (const QModelIndex& row : rows) chosen.push_back(attempts_.attempt(filter_.mapToSource(row).row()));
  return chosen;
}

const analytics::AttemptRow* AttemptsPage::selected() const {
  const QModelIndex at = filter_.mapToSource(table_->currentIndex());
  return document_ && at.isValid() ? &attempts_.attempt(at.row()) : nullptr;
}

void AttemptsPage::showSelected() {
  const analytics::AttemptRow* attempt = selected();
  if (attempt == nullptr) {
    banner_->showText("Select an attempt to see its checkpoints.");
    checkpoints_.setValues({});
    emit selectionChanged();
    return;
  }
  banner_->showAttempt(*attempt);
  try {
    checkpoints_.setValues(document_->values(attempt->uuid), document_->intervals(attempt->uuid));
    details_->setColumnHidden(CheckpointTableModel::intervalColumn, !checkpoints_.hasIntervals());
  } catch (const Error& error) {
    checkpoints_.setValues({});
    emit problem(QString::fromStdString(problemText(error)));
  }
  emit selectionChanged();
}

}  // namespace calot::gui
