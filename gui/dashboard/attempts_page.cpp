// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempts_page.h"

#include <array>
#include <QBoxLayout>
#include <QComboBox>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLabel>
#include <QLineEdit>
#include <QSplitter>
#include <QTableView>

#include "gui/dashboard/words.h"
#include "recorder/errors.h"

namespace calot::gui {
namespace {

using analytics::Verdict;
constexpr std::array verdicts{Verdict::verified, Verdict::diverged, Verdict::damaged, Verdict::notCheckableHere,
                              Verdict::notChecked};

QTableView* makeTable(QAbstractItemModel& model, const char* name, const char* spokenName) {
  auto* table = new QTableView;
  table->setObjectName(name);
  table->setAccessibleName(spokenName);
  table->setModel(&model);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setAlternatingRowColors(true);
  table->setTabKeyNavigation(false);  // Tab leaves the table, arrows move in it
  table->setWordWrap(false);
  table->verticalHeader()->hide();
  table->horizontalHeader()->setStretchLastSection(true);
  table->horizontalHeader()->setHighlightSections(false);
  table->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return table;
}

void setWidths(QTableView& table, std::initializer_list<int> widths) {
  int column = 0;
  for (const int width : widths) table.setColumnWidth(column++, width);
}

}  // namespace

AttemptsPage::AttemptsPage(QWidget* parent) : QWidget(parent) {
  filter_.setSourceModel(&attempts_);
  auto* upper = new QWidget;
  auto* upperLayout = new QVBoxLayout(upper);
  upperLayout->setContentsMargins(0, 0, 0, 0);
  buildFilters(*upperLayout);
  table_ = makeTable(filter_, "attempts", "Attempts");
  table_->setSortingEnabled(true);
  table_->sortByColumn(AttemptTableModel::startColumn, Qt::DescendingOrder);
  setWidths(*table_, {90, 180, 110, 130, 95, 130, 150, 150, 90});
  upperLayout->addWidget(table_);

  auto* lower = new QWidget;
  auto* lowerLayout = new QVBoxLayout(lower);
  lowerLayout->setContentsMargins(0, 0, 0, 0);
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
}

void AttemptsPage::buildFilters(QBoxLayout& layout) {
  auto* row = new QHBoxLayout;
  search_ = new QLineEdit;
  search_->setObjectName("search");
  search_->setAccessibleName("Search attempts");
  search_->setPlaceholderText("Search (Ctrl+F): participant, profile, group, scene, date …");
  search_->setClearButtonEnabled(true);
  verdict_ = new QComboBox;
  verdict_->setObjectName("verdict");
  verdict_->addItem("All verdicts");
  for (const Verdict verdict : verdicts) verdict_->addItem(badgeText(verdict), static_cast<int>(verdict));
  operators_ = new QComboBox;
  operators_->setObjectName("operators");
  operators_->addItem("People and synthetic");
  operators_->addItem("Not synthetic");
  operators_->addItem("Synthetic only");
  count_ = new QLabel;
  count_->setObjectName("count");
  const auto add = [&](const char* text, QWidget* field, int stretch) {
    auto* label = new QLabel(text);
    label->setBuddy(field);
    row->addWidget(label);
    row->addWidget(field, stretch);
  };
  add("&Search", search_, 1);
  add("&Verification", verdict_, 0);
  add("&Made by", operators_, 0);
  row->addWidget(count_);
  layout.addLayout(row);

  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    filter_.setSearch(text);
    showCount();
  });
  connect(verdict_, &QComboBox::currentIndexChanged, this, [this](int index) {
    filter_.setVerdict(index <= 0 ? std::nullopt : std::optional(verdicts[static_cast<std::size_t>(index - 1)]));
    showCount();
  });
  connect(operators_, &QComboBox::currentIndexChanged, this, [this](int index) {
    filter_.setOperators(static_cast<AttemptFilter::Operators>(index));
    showCount();
  });
}

void AttemptsPage::buildDetails(QBoxLayout& layout) {
  const auto label = [&](const char* name) {
    auto* made = new QLabel;
    made->setObjectName(name);
    made->setWordWrap(true);
    made->setTextFormat(Qt::PlainText);
    made->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
    layout.addWidget(made);
    return made;
  };
  watermark_ = label("watermark");
  watermark_->setText(
      "SYNTHETIC — made by a performer. It shows that the pipeline works and says nothing about people.");
  watermark_->setStyleSheet("QLabel { background: #f0e442; color: #000000; font-weight: bold; padding: 4px; }");
  watermark_->hide();
  identity_ = label("identity");
  badge_ = label("badge");
  details_ = makeTable(checkpoints_, "checkpoints", "Checkpoints of the selected attempt");
  setWidths(*details_, {300, 110, 190, 150, 150, 130, 70});
  layout.addWidget(details_);
}

void AttemptsPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  attempts_.setAttempts(document_->attempts());
  showCount();
  if (filter_.rowCount() > 0) table_->selectRow(0);
  showSelected();
}

void AttemptsPage::focusSearch() {
  search_->setFocus(Qt::ShortcutFocusReason);
  search_->selectAll();
}

void AttemptsPage::showCount() {
  count_->setText(QString("%1 of %2 attempts").arg(filter_.rowCount()).arg(attempts_.rowCount()));
}

void AttemptsPage::showSelected() {
  const QModelIndex selected = filter_.mapToSource(table_->currentIndex());
  if (!document_ || !selected.isValid()) {
    identity_->setText("Select an attempt to see its checkpoints.");
    badge_->clear();
    watermark_->hide();
    checkpoints_.setValues({});
    return;
  }
  const analytics::AttemptRow& attempt = attempts_.attempt(selected.row());
  QString text = QString("Attempt %1 · %2 · %3")
                     .arg(QString::fromStdString(attempt.uuid), operatorText(attempt),
                          QString::fromStdString(attempt.comparabilityKey));
  if (attempt.excluded) text += "\nExcluded from studies: " + QString::fromStdString(attempt.exclusionReason);
  identity_->setText(text);
  const Badge badge = badgeOf(attempt);
  badge_->setText(badge.text + ". " + QString(badge.explanation).replace('\n', ' '));
  badge_->setStyleSheet("QLabel { color: " + badge.colour.name() + "; }");
  watermark_->setVisible(attempt.synthetic);
  try {
    checkpoints_.setValues(document_->values(attempt.uuid));
  } catch (const Error& error) {
    checkpoints_.setValues({});
    emit problem(QString::fromUtf8(error.what()));
  }
}

}  // namespace calot::gui
