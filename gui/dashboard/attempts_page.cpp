// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempts_page.h"

#include <algorithm>
#include <array>
#include <QFileInfo>
#include <QFont>
#include <QItemSelectionModel>
#include <QMenu>

#include "gui/attempt/figure_text.h"
#include "gui/dashboard/dialogs.h"

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
    case Qt::EditRole:
      return lines_->cell(index.row(), index.column());
    case sortRole:
      return lines_->rank(index.row(), index.column());
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
      if (index.column() == safetyColumn) return lines_->cell(index.row(), safetyColumn);
      if (index.column() == tagsColumn) return lines_->cell(index.row(), tagsColumn);
      return {};
    default:
      return {};
  }
}

QVariant AttemptTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return AttemptLines::title(section);
}

Qt::ItemFlags AttemptTableModel::flags(const QModelIndex& index) const {
  const Qt::ItemFlags flags = QAbstractTableModel::flags(index);
  const bool editable = index.isValid() && index.column() == groupColumn && !attempt(index.row()).participant.empty();
  return editable ? flags | Qt::ItemIsEditable : flags;
}

bool AttemptTableModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::EditRole || !flags(index).testFlag(Qt::ItemIsEditable)) return false;
  const analytics::AttemptRow& row = attempt(index.row());
  const QString group = value.toString().trimmed();
  if (group.toStdString() != row.group) emit groupEdited(QString::fromStdString(row.participant), group);
  return false;  // the cohort decides
}

AttemptFilter::AttemptFilter() { setSortRole(AttemptTableModel::sortRole); }

void AttemptFilter::set(const Criteria& wanted) {
  if (wanted == wanted_) return;
  wanted_ = wanted;
  words_ = wanted.search.toLower().split(' ', Qt::SkipEmptyParts);
  invalidate();
}

bool AttemptFilter::filterAcceptsRow(int sourceRow, const QModelIndex&) const {
  const auto& model = static_cast<const AttemptTableModel&>(*sourceModel());
  const analytics::AttemptRow& attempt = model.attempt(sourceRow);
  if (!wanted_.tag.empty() && std::find(attempt.tags.begin(), attempt.tags.end(), wanted_.tag) == attempt.tags.end())
    return false;
  if (wanted_.latest && !model.isLatest(sourceRow)) return false;
  if (wanted_.verdict && attempt.verification.verdict != *wanted_.verdict) return false;
  if (wanted_.synthetic && attempt.synthetic != *wanted_.synthetic) return false;
  const QString& text = model.search(sourceRow);
  return std::all_of(words_.begin(), words_.end(), [&](const QString& word) { return text.contains(word); });
}

namespace {

using analytics::Verdict;
constexpr std::array verdicts{Verdict::verified, Verdict::diverged, Verdict::damaged, Verdict::notCheckableHere,
                              Verdict::notChecked};

}  // namespace

AttemptsPage::AttemptsPage()
    : search_(parts::named("search", new QLineEdit)),
      which_(parts::choice("which", 9)),
      verdict_(parts::choice("verdict", 9)),
      operators_(parts::choice("operators", 9)),
      tag_(parts::choice("tag", 8)),
      count_(parts::named("count", new QLabel)),
      table_(makeTable(filter_, "attempts", "Attempts")),
      banner_(new AttemptBanner),
      details_(makeTable(checkpoints_, "checkpoints", "Checkpoints of the selected attempt")) {
  begin_ = table_;
  filter_.setSourceModel(&attempts_);
  table_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  table_->setSortingEnabled(true);
  table_->sortByColumn(AttemptTableModel::startColumn, Qt::DescendingOrder);
  setWidths(*table_, {150, 90, 125, 125, 330, 85, 160, 125, 110, 110, 85, 80, 90, 70});
  table_->setEditTriggers(QAbstractItemView::EditKeyPressed);
  setWidths(*details_, {330, 110, 170, 150, 0, 0, 140, 150, 110, 70});
  for (const int column :
       {CheckpointTableModel::intervalColumn, CheckpointTableModel::normColumn, CheckpointTableModel::momentColumn})
    details_->hideColumn(column);
  // The longest words are a window's.
  details_->horizontalHeader()->setStretchLastSection(false);
  details_->horizontalHeader()->setSectionResizeMode(CheckpointTableModel::windowColumn, QHeaderView::Stretch);
  wrapWords(*details_);
  details_->setToolTip("Double-click, or press Enter, to see when a figure came about");
  QWidget* const upper = parts::boxed(parts::column({buildFilters(), table_}));
  QWidget* const lower = parts::boxed(parts::column({banner_, details_}));
  setLayout(parts::column({makeSplitter(Qt::Vertical, {{upper, 3}, {lower, 2}})}));

  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this] { showSelected(); });
  connect(&attempts_, &AttemptTableModel::groupEdited, this, &AttemptsPage::groupEdited);
  connect(table_->selectionModel(), &QItemSelectionModel::selectionChanged, this, [this] { showCount(); });
  connect(table_, &QTableView::activated, this,
          [this](const QModelIndex& at) { emit attemptActivated(at.data(AttemptTableModel::uuidRole).toString()); });
  connect(details_, &QTableView::activated, this, [this](const QModelIndex& at) {
    const analytics::CheckpointValue& value = checkpoints_.value(at.row());
    emit figureActivated(QString::fromStdString(value.name), QString::fromStdString(value.subject));
  });
}

QLayout* AttemptsPage::buildFilters() {
  search_->setAccessibleName("Search attempts");
  search_->setPlaceholderText("Search (Ctrl+F): participant, profile, group, scene, date …");
  search_->setClearButtonEnabled(true);
  which_->addItems({"Every attempt", "Latest of each"});
  which_->setAccessibleName("Which attempts");
  verdict_->addItem("All verdicts");
  for (const Verdict verdict : verdicts) verdict_->addItem(badgeText(verdict));
  operators_->addItems({"People and synthetic", "Not synthetic", "Synthetic only"});
  tag_->setToolTip("The menu Edit puts tags on attempts, and takes them off");
  connect(search_, &QLineEdit::textChanged, this, [this] { filter(); });
  connect(search_, &QLineEdit::returnPressed, this, [this] {
    if (const analytics::AttemptRow* const found = selected())
      emit attemptActivated(QString::fromStdString(found->uuid));
  });
  for (QComboBox* choice : {which_, verdict_, operators_, tag_})
    connect(choice, &QComboBox::currentIndexChanged, this, [this] { filter(); });
  return parts::row({which_,
                     {"&Search", search_, 1},
                     {"Verifi&cation", verdict_},
                     {"&Made by", operators_},
                     {"&Tag", tag_},
                     count_,
                     buildColumns()});
}

QWidget* AttemptsPage::buildColumns() {
  auto* button = parts::named("columns", new QPushButton("Co&lumns"));
  auto* menu = new QMenu(button);
  const QStringList hidden = settings::hiddenColumns();
  for (int column = AttemptTableModel::operatorColumn + 1; column < AttemptTableModel::columnTotal; ++column) {
    QAction* action = menu->addAction(AttemptLines::title(column));
    action->setCheckable(true);
    action->setChecked(!hidden.contains(action->text()));
    table_->setColumnHidden(column, !action->isChecked());
    connect(action, &QAction::toggled, this, [this, menu, column](bool shown) {
      table_->setColumnHidden(column, !shown);
      QStringList titles;
      for (const QAction* other : menu->actions()) {
        if (!other->isChecked()) titles += other->text();
      }
      settings::setHiddenColumns(titles);
    });
  }
  button->setMenu(menu);
  return button;
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
  if (selected() != nullptr && selected()->uuid == uuid.toStdString()) return;
  if (rowOf(uuid) < 0) {
    search_->clear();
    which_->setCurrentIndex(0);
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
  const qsizetype chosen = table_->selectionModel()->selectedRows().size();
  if (chosen > 1) text += QString(", %1 selected").arg(chosen);
  count_->setText(text);
}

void AttemptsPage::filter() {
  AttemptFilter::Criteria wanted;
  wanted.search = search_->text();
  if (const int at = verdict_->currentIndex(); at > 0) wanted.verdict = verdicts[static_cast<std::size_t>(at - 1)];
  wanted.latest = which_->currentIndex() == 1;
  if (operators_->currentIndex() > 0) wanted.synthetic = operators_->currentIndex() == 2;
  if (tag_->currentIndex() > 0) wanted.tag = tag_->currentText().toStdString();
  filter_.set(wanted);
  showCount();
  // If the current attempt is hidden now, the first of the remaining ones becomes current.
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
  if (!before.isEmpty() && tag_->currentIndex() == 0) filter();
}

void AttemptsPage::offer(const QList<QAction*>& actions) {
  table_->setContextMenuPolicy(Qt::ActionsContextMenu);
  table_->addActions(actions);
}

void AttemptsPage::editGroup() {
  const QModelIndex at = table_->currentIndex().siblingAtColumn(AttemptTableModel::groupColumn);
  table_->setColumnHidden(AttemptTableModel::groupColumn, false);
  if (at.flags().testFlag(Qt::ItemIsEditable)) table_->edit(at);
}

std::vector<std::vector<std::string>> AttemptsPage::shownCells() const {
  std::vector<std::vector<std::string>> lines(1);
  for (int row = -1; row < filter_.rowCount(); ++row) {
    std::vector<std::string>& cells = row < 0 ? lines.front() : lines.emplace_back();
    for (int column = 0; column < AttemptTableModel::columnTotal; ++column) {
      if (table_->isColumnHidden(column)) continue;
      cells.push_back(
          (row < 0 ? AttemptLines::title(column) : filter_.index(row, column).data().toString()).toStdString());
    }
  }
  return lines;
}

bool AttemptsPage::makeDocument(const Taker& take) {
  if (!document_ || filter_.rowCount() == 0) return false;
  std::vector<std::vector<std::string>> lines = shownCells();
  analytics::ReportTable table;
  for (const std::string& title : lines.front()) table.columns.emplace_back(title, analytics::Align::left);
  table.rows.assign(std::next(lines.begin()), lines.end());
  dropEmptyColumns(table);
  const auto& attempts = document_->attempts();
  const bool synthetic = std::any_of(attempts.begin(), attempts.end(), [](const auto& a) { return a.synthetic; });
  analytics::ReportDocument document{"Attempts", synthetic, {}};
  document.add(count_->text().toStdString() + " of " +
               QFileInfo(QString::fromStdString(document_->path())).fileName().toStdString());
  document.parts.emplace_back(std::move(table));
  take(document);
  return true;
}

std::vector<analytics::AttemptRow> AttemptsPage::selectedAll() const {
  QModelIndexList rows = table_->selectionModel()->selectedRows();
  std::sort(rows.begin(), rows.end());
  std::vector<analytics::AttemptRow> chosen;
  for (const QModelIndex& row : rows) chosen.push_back(attempts_.attempt(filter_.mapToSource(row).row()));
  return chosen;
}

std::vector<std::string> AttemptsPage::selectedUuids() const {
  std::vector<std::string> uuids;
  for (const analytics::AttemptRow& attempt : selectedAll()) uuids.push_back(attempt.uuid);
  return uuids;
}

const analytics::AttemptRow* AttemptsPage::selected() const {
  const QModelIndex at = filter_.mapToSource(table_->currentIndex());
  return document_ && at.isValid() ? &attempts_.attempt(at.row()) : nullptr;
}

void AttemptsPage::showSelected() {
  const analytics::AttemptRow* row = selected();
  std::vector<analytics::CheckpointValue> values;
  std::vector<analytics::ValueInterval> intervals;
  if (row == nullptr) {
    banner_->showText("Select an attempt to see its checkpoints.");
  } else {
    banner_->showAttempt(*row);
    tryTo([&] {
      values = document_->database().values(row->uuid);
      intervals = document_->database().intervals(row->uuid);
    });
  }
  details_->setColumnHidden(CheckpointTableModel::intervalColumn, intervals.empty());
  checkpoints_.setValues(std::move(values), std::move(intervals));
  emit selectionChanged();
}

}  // namespace calot::gui
