// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dialogs.h"

#include <QAction>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QMenu>
#include <QMenuBar>
#include <QSpinBox>

#include "analytics/assessment/norm.h"
#include "gui/dashboard/settings.h"

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

void showKeys(const KeyList& keys, QWidget* parent) {
  QDialog dialog(parent);
  dialog.setWindowTitle("Keys");
  QTableWidget* table = makeTextTable({"Key", "What it does"}, "keys", "Keys and what they do");
  setWidths(*table, {160});
  table->setRowCount(static_cast<int>(keys.size()));
  for (int row = 0; row < table->rowCount(); ++row) {
    const auto& [key, what] = keys[static_cast<std::size_t>(row)];
    setTexts(*table, row, {key, what});
  }
  auto* close = new QDialogButtonBox(QDialogButtonBox::Close);
  QObject::connect(close, &QDialogButtonBox::rejected, &dialog, &QDialog::reject);
  auto* layout = new QVBoxLayout(&dialog);
  layout->addWidget(table, 1);
  layout->addWidget(close);
  dialog.resize(theme::inType(520), theme::inType(420));
  dialog.exec();
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
      by_(parts::named("norm-by", new QLineEdit(settings::person()))),
      fields_{parts::named("norm-group-by", new QComboBox),
              parts::named("norm-competent", new QComboBox),
              parts::named("norm-others", new QComboBox),
              parts::choice("norm-key", 20),
              parts::named("norm-synthetic", new QCheckBox("&Synthetic attempts, too (the norm is marked)")),
              parts::named("norm-practice", new QCheckBox("&Practice attempts, too"))},
      attempts_(parts::named("norm-attempts", new QComboBox)),
      rule_(parts::named("norm-rule", new QComboBox)),
      least_(parts::named("norm-least", new QSpinBox)),
      first_(parts::named("norm-first", new QCheckBox("Of a participant's several attempts the &first counts"))),
      result_(parts::plainLabel("norm-result")),
      make_(parts::named("norm-make", new QPushButton("&Make the norm"))),
      strip_(new WorkStrip(work_)) {
  setWindowTitle("Make a norm");
  resize(theme::inType(620), theme::inType(460));
  auto* layout = new QVBoxLayout(this);
  auto* purpose = new QLabel(explanation);
  purpose->setWordWrap(true);
  layout->addWidget(purpose);
  layout->addLayout(buildForm());
  result_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  layout->addWidget(result_, 1);
  layout->addWidget(strip_);
  auto* buttons = new QDialogButtonBox;
  buttons->addButton(make_, QDialogButtonBox::ActionRole);
  buttons->addButton("&Close", QDialogButtonBox::RejectRole);
  layout->addWidget(buttons);
  make_->setDefault(true);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::accept);
  connect(make_, &QPushButton::clicked, this, &NormDialog::make);
  const auto end = [this](const QString& text) {
    allow(true);
    result_->setText(text);
  };
  connect(&work_, &LongWork::done, this, [this, end](const QString& text) {
    end(text);
    emit made();
  });
  connect(&work_, &LongWork::failed, this, [this, end](const QString& reason) {
    end("No norm was made: " + reason);
    emit refused();
  });
  connect(&work_, &LongWork::cancelled, this, [end] { end("Cancelled: no norm was made."); });
}

QFormLayout* NormDialog::buildForm() {
  name_->setPlaceholderText("letters, digits, points, hyphens; the same name again is its next version");
  by_->setPlaceholderText("your pseudonym");
  for (QLineEdit* line : {name_, by_}) {
    line->setMaxLength(64);
    connect(line, &QLineEdit::textChanged, this, [this] { allow(true); });
  }
  attempts_->addItem("all of the cohort");
  if (selected_.size() > 1) {
    attempts_->addItem(QString("only the %1 that are selected").arg(selected_.size()));
    attempts_->setCurrentIndex(1);
  }
  fields_.offer(document_->attempts());
  connect(fields_.by, &QComboBox::currentIndexChanged, this, [this] { fields_.offerGroups(document_->attempts()); });
  rule_->addItems({"all figures that count are passed", "at least this many of them are passed"});
  least_->setRange(1, 1000);
  least_->setEnabled(false);
  connect(rule_, &QComboBox::currentIndexChanged, least_, [this](int index) { least_->setEnabled(index == 1); });
  first_->setChecked(true);
  auto* rule = new QHBoxLayout;
  rule->addWidget(rule_, 1);
  rule->addWidget(least_);
  auto* ruleName = new QLabel("&Rule");  // a row that is a layout has no widget of its own for the letter
  ruleName->setBuddy(rule_);
  auto* form = new QFormLayout;
  form->addRow("&Name", name_);
  form->addRow("Made &by", by_);
  form->addRow("A&ttempts", attempts_);
  form->addRow("&Groups by", fields_.by);
  form->addRow("Comp&etent are", fields_.first);
  form->addRow("&Others are", fields_.second);
  form->addRow("Comparable &within", fields_.key);
  form->addRow(ruleName, rule);
  for (QCheckBox* box : {first_, fields_.practice, fields_.synthetic}) form->addRow(QString(), box);
  allow(true);
  return form;
}

void NormDialog::allow(bool ready) {
  make_->setEnabled(ready && !name_->text().trimmed().isEmpty() && !by_->text().trimmed().isEmpty());
}

void NormDialog::make() {
  analytics::NormRequest request;
  request.name = name_->text().trimmed().toStdString();
  request.by = by_->text().trimmed().toStdString();
  request.leastPassed = rule_->currentIndex() == 1 ? static_cast<std::uint32_t>(least_->value()) : 0;
  request.who = fields_.options();
  request.who.better = request.who.groups.front();
  if (first_->isChecked()) request.who.attemptRule = analytics::AttemptRule::first;
  const std::vector<std::string> only = attempts_->currentIndex() == 1 ? selected_ : std::vector<std::string>();
  settings::setPerson(QString::fromStdString(request.by));
  allow(false);
  result_->clear();
  strip_->begin("Making the norm");
  work_.start([request, only, database = document_->path()](LongWork::Control& control) {
    const analytics::Norm norm = analytics::createNorm(database, request, only, [&](double share, const char* doing) {
      control.progress(share, QString("Making the norm: ") + doing);
    });
    QStringList lines = textsOf(analytics::normSummary(norm)) + textsOf(analytics::normWarnings(norm));
    if (norm.synthetic) lines.prepend("SYNTHETIC: made of performers' attempts, of no person's.");
    return lines.join("\n\n");
  });
}

}  // namespace calot::gui
