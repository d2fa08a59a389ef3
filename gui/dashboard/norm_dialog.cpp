// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/norm_dialog.h"

#include <algorithm>
#include <QDialogButtonBox>
#include <QGuiApplication>
#include <QScreen>
#include <QSpinBox>
#include <set>

#include "gui/attempt/figure_text.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/norm_marks.h"

namespace calot::gui {
namespace {

enum MemberColumn { memberColumn, competentColumn, passesColumn, memberColumns };
constexpr int byRaters = -1;  // data of a choice of groups: its form has role formRole
constexpr int formRole = Qt::UserRole + 1;

/// A line below a field: what is wrong with it, or what follows from it.
void note(QLabel* label, const QString& fault, const QString& hint = {}) {
  QPalette colours = QGuiApplication::palette();
  colours.setColor(QPalette::WindowText, fault.isEmpty() ? theme::muted() : theme::trouble());
  label->setPalette(colours);
  parts::say(label, fault.isEmpty() ? hint : fault);
}

QString rateText(const analytics::PassRate& rate, const char* who) {
  return QString("%1 of %2 %3").arg(rate.passed).arg(rate.members).arg(who);
}

/// The word says what a tick says: styles draw empty boxes faintly on dark grounds.
const char* sideText(bool competent) { return competent ? "competent" : "other"; }

QTableWidgetItem* tick(const QString& text, bool on) {
  auto* const item = new QTableWidgetItem(text);
  item->setFlags(Qt::ItemIsSelectable | Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
  item->setCheckState(on ? Qt::Checked : Qt::Unchecked);
  return item;
}

/// A field with a line below it.
QLayout* noted(std::initializer_list<parts::Item> fields, QLabel* line) {
  QBoxLayout* const made = parts::bare(parts::column({parts::bare(parts::row(fields)), line}));
  made->setSpacing(1);
  return made;
}

}  // namespace

NormDialog::NormDialog(std::shared_ptr<const CohortDocument> document, std::vector<std::string> selected,
                       QWidget* parent)
    : QDialog(parent),
      document_(std::move(document)),
      selected_(std::move(selected)),
      name_(parts::named("norm-name", new QLineEdit)),
      by_(parts::named("norm-by", new QLineEdit(settings::person()))),
      nameNote_(parts::plainLabel("norm-name-note")),
      byNote_(parts::plainLabel("norm-by-note")),
      groupsNote_(parts::plainLabel("norm-groups-note")),
      membersNote_(parts::plainLabel("norm-members-note")),
      figuresNote_(parts::plainLabel("norm-figures-note")),
      ruleNote_(parts::plainLabel("norm-rule-note")),
      fields_{parts::choice("norm-group-by", 10),
              parts::choice("norm-competent", 8),
              parts::choice("norm-others", 8),
              parts::choice("norm-key", 14),
              parts::named("norm-synthetic", new QCheckBox("&Synthetic attempts, too")),
              parts::named("norm-practice", new QCheckBox("&Practice attempts, too"))},
      attempts_(parts::choice("norm-attempts", 10)),
      rule_(parts::choice("norm-rule", 30)),
      least_(parts::named("norm-least", new QSpinBox)),
      first_(parts::named("norm-first", new QCheckBox("Of several attempts the &first counts"))),
      all_(parts::named("norm-all-figures", new QCheckBox("All fig&ures"))),
      members_(makeTextTable({"Member", "Competent", "Would pass"}, "norm-members", "Members of the norm")),
      marks_(parts::named("norm-marks", new NormMarks)),
      outcome_(parts::plainLabel("norm-outcome")),
      result_(parts::selectableLabel("norm-result")),
      make_(parts::named("norm-make", new QPushButton("&Make the norm"))),
      undo_(parts::named("norm-undo", new QPushButton("Un&do"))),
      strip_(new WorkStrip(work_)) {
  setWindowTitle("Make a norm");
  const QSize screen = QGuiApplication::primaryScreen()->availableSize();
  resize(QSize(theme::inType(1060), theme::inType(700)).boundedTo(screen));
  for (const analytics::Norm& norm : document_->norms()) newest_[norm.name] = norm.version;
  parts::embolden(outcome_);
  QScrollArea* const result = parts::scrolled(result_);
  result->setMaximumHeight(theme::inType(110));
  result->setFocusPolicy(Qt::NoFocus);
  result->hide();
  resultArea_ = result;
  undo_->setEnabled(false);
  auto* const buttons = new QDialogButtonBox;
  buttons->addButton(undo_, QDialogButtonBox::ActionRole);
  buttons->addButton(make_, QDialogButtonBox::ActionRole);
  buttons->addButton("C&lose", QDialogButtonBox::RejectRole);
  QSplitter* const splitter = makeSplitter(Qt::Horizontal, {{buildMembers(), 2}, {buildFigures(), 3}});
  splitter->setSizes({theme::inType(400), theme::inType(640)});
  setLayout(parts::column({buildFields(), {splitter, 1}, buildRule(), outcome_, resultArea_, strip_, buttons}));
  connectFields();
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::accept);
  make_->setDefault(true);
  gather();
  name_->setFocus();
  name_->selectAll();
}

QLayout* NormDialog::buildFields() {
  name_->setPlaceholderText("letters, digits, points, hyphens");
  by_->setPlaceholderText("your pseudonym");
  for (QLineEdit* line : {name_, by_}) line->setMaxLength(64);
  attempts_->addItem("all of the cohort");
  if (selected_.size() > 1) {
    attempts_->addItem(QString("only the %1 that are selected").arg(selected_.size()));
    attempts_->setCurrentIndex(1);
  }
  fields_.offer(document_->attempts());
  offerRaters();
  first_->setChecked(true);
  fields_.synthetic->setToolTip("The norm is marked as one of performers");
  suggestName();
  return parts::column(
      {parts::row({{noted({{"&Name", name_, 1}}, nameNote_), 1}, {noted({{"Made &by", by_, 1}}, byNote_), 1}}),
       noted({{"&Groups by", fields_.by, 1}, {"Comp&etent are", fields_.first, 1}, {"&Others are", fields_.second, 1}},
             groupsNote_),
       parts::row({{"Comparable &within", fields_.key, 3}, {"A&ttempts", attempts_, 1}}),
       parts::row({first_, fields_.practice, fields_.synthetic, parts::spring()})});
}

QWidget* NormDialog::buildMembers() {
  setWidths(*members_, {150, 105});
  members_->setToolTip("Space changes a tick");
  return parts::boxed(parts::column({{members_, 1}, membersNote_}));
}

QWidget* NormDialog::buildFigures() {
  QScrollArea* const scroll = parts::scrolled(marks_);
  scroll->setFocusPolicy(Qt::NoFocus);
  return parts::boxed(parts::column({{scroll, 1}, noted({all_, parts::spring()}, figuresNote_)}));
}

QLayout* NormDialog::buildRule() {
  rule_->addItems({"all figures that count are passed", "at least this many of them are passed"});
  least_->setRange(1, 1000);
  least_->setEnabled(false);
  least_->setAccessibleName("Figures that must be passed");
  return noted({{"&Rule", rule_}, least_, parts::spring()}, ruleNote_);
}

/// The task's name, till a person types another.
void NormDialog::suggestName() {
  if (!name_->isModified()) name_->setText(fields_.key->currentText().section('/', 0, 0));
}

/// Forms by which raters judged attempts make groups, too.
void NormDialog::offerRaters() {
  std::set<std::string> forms;
  for (const analytics::Rating& rating : document_->assessment().ratings()) {
    if (rating.answers.count(analytics::competenceItem) > 0) forms.insert(rating.form);
  }
  const QSignalBlocker quiet(fields_.by);
  for (const std::string& form : forms) {
    fields_.by->addItem("raters, by form " + QString::fromStdString(form), byRaters);
    fields_.by->setItemData(fields_.by->count() - 1, QString::fromStdString(form), formRole);
  }
}

void NormDialog::connectFields() {
  for (QLineEdit* line : {name_, by_}) connect(line, &QLineEdit::textChanged, this, [this] { sayFaults(); });
  connect(fields_.by, &QComboBox::currentIndexChanged, this, [this] {
    if (fields_.by->currentData().toInt() != byRaters) fields_.offerGroups(document_->attempts());
    gather();
  });
  connect(fields_.key, &QComboBox::currentIndexChanged, this, &NormDialog::suggestName);
  for (QComboBox* box : {fields_.first, fields_.second, fields_.key, attempts_})
    connect(box, &QComboBox::currentIndexChanged, this, [this] { gather(); });
  for (QCheckBox* box : {first_, fields_.practice, fields_.synthetic})
    connect(box, &QCheckBox::toggled, this, [this] { gather(); });
  connect(rule_, &QComboBox::currentIndexChanged, this, [this](int index) {
    least_->setEnabled(index == 1);
    tryMarks();
  });
  connect(least_, &QSpinBox::valueChanged, this, [this] { tryMarks(); });
  connect(members_, &QTableWidget::itemChanged, this, [this](const QTableWidgetItem* item) {
    const QSignalBlocker quiet(members_);
    QTableWidgetItem* const competent = members_->item(item->row(), competentColumn);
    competent->setText(sideText(competent->checkState() == Qt::Checked));
    if (item->column() == memberColumn) {
      const Qt::ItemFlags flags = competent->flags();
      competent->setFlags(item->checkState() == Qt::Checked ? flags | Qt::ItemIsEnabled : flags & ~Qt::ItemIsEnabled);
    }
    tryMarks();
  });
  connect(marks_, &NormMarks::changed, this, [this] { tryMarks(); });
  connect(all_, &QCheckBox::toggled, marks_, &NormMarks::showAll);
  connect(make_, &QPushButton::clicked, this, &NormDialog::make);
  connect(undo_, &QPushButton::clicked, this, &NormDialog::undo);
  connect(&work_, &LongWork::done, this, [this](const QString& text) {
    newest_[made_->name] = made_->version;
    end(text);
    undo_->setEnabled(true);
    emit made(*made_);
  });
  connect(&work_, &LongWork::failed, this, [this](const QString& reason) {
    end("No norm was made: " + reason);
    emit refused();
  });
  connect(&work_, &LongWork::cancelled, this, [this] { end("Cancelled: no norm was made."); });
}

analytics::NormRequest NormDialog::request() const {
  analytics::NormRequest request;
  request.name = name_->text().trimmed().toStdString();
  request.by = by_->text().trimmed().toStdString();
  request.leastPassed = rule_->currentIndex() == 1 ? static_cast<std::uint32_t>(least_->value()) : 0;
  const bool raters = fields_.by->currentData().toInt() == byRaters;
  request.who = fields_.options();
  if (raters) {
    request.judgedBy = fields_.by->currentData(formRole).toString().toStdString();
    request.who.grouping = analytics::Grouping::group;
    request.who.groups.clear();
  } else {
    request.who.better = request.who.groups.front();
  }
  if (first_->isChecked()) request.who.attemptRule = analytics::AttemptRule::first;
  for (int row = 0; row < members_->rowCount(); ++row) {
    const QTableWidgetItem* const member = members_->item(row, memberColumn);
    std::optional<bool>& decided = request.decided[member->data(Qt::UserRole).toString().toStdString()];
    if (member->checkState() == Qt::Checked)
      decided = members_->item(row, competentColumn)->checkState() == Qt::Checked;
  }
  request.fixed = marks_->fixed();
  return request;
}

void NormDialog::gather() {
  const bool raters = fields_.by->currentData().toInt() == byRaters;
  for (QComboBox* group : {fields_.first, fields_.second}) group->setEnabled(!raters);
  settled_ = false;
  gathered_.reset();
  trial_.reset();
  groupsFault_.clear();
  outcome_->setText("Reading the attempts …");
  analytics::NormRequest wanted = request();
  wanted.decided.clear();
  const std::size_t which = attempts_->currentIndex() == 1 ? 1 : 0;
  const auto take = [this, which](const std::shared_ptr<const analytics::NormSource>& source, analytics::Norm norm) {
    source_[which] = source;
    gathered_ = std::move(norm);
    fillMembers();
    tryMarks();
  };
  background_.run(
      [take, wanted, path = document_->path(), source = source_[which],
       only = which == 1 ? selected_ : std::vector<std::string>()]() mutable -> Background::Completion {
        if (!source) {
          const analytics::CohortDatabase cohort(path, analytics::CohortDatabase::Access::read);
          source = std::make_shared<const analytics::NormSource>(analytics::readNormSource(cohort, only));
        }
        analytics::Norm norm = analytics::gatherNorm(source->attempts, source->values, source->ratings, wanted, path);
        return [take, source, norm = std::move(norm)] { take(source, norm); };
      },
      [this](const QString& fault) {
        groupsFault_ = fault;
        fillMembers();
        settled_ = true;
        sayFaults();
        emit tried();
      });
  sayFaults();
}

void NormDialog::fillMembers() {
  const QSignalBlocker quiet(members_);
  members_->setRowCount(0);
  if (!gathered_) return;
  std::vector<analytics::NormMember> members = gathered_->members;
  std::ranges::stable_sort(members, std::ranges::greater(), &analytics::NormMember::competent);
  members_->setRowCount(static_cast<int>(members.size()));
  for (int row = 0; row < members_->rowCount(); ++row) {
    const analytics::NormMember& member = members[static_cast<std::size_t>(row)];
    const analytics::AttemptRow* const attempt = document_->attempt(member.attempt);
    const QString number = QString::fromStdString(member.attempt).left(8);
    // Performers are several attempts of one name.
    const QString who = attempt == nullptr             ? number
                        : attempt->participant.empty() ? operatorText(*attempt) + ", " + number
                                                       : operatorText(*attempt);
    members_->setItem(row, memberColumn, tick(who, true));
    members_->item(row, memberColumn)->setData(Qt::UserRole, QString::fromStdString(member.attempt));
    if (attempt != nullptr)
      members_->item(row, memberColumn)
          ->setToolTip(QString("%1, attempt %2").arg(startText(attempt->startUtc), number));
    members_->setItem(row, competentColumn, tick(sideText(member.competent), member.competent));
    members_->setItem(row, passesColumn, new QTableWidgetItem);
  }
  if (members_->rowCount() > 0) members_->setCurrentCell(0, competentColumn);
}

void NormDialog::tryMarks() {
  if (!gathered_) return;
  settled_ = false;
  analytics::NormRequest wanted = request();
  wanted.checkpoints = marks_->wanted();
  // A list without names would be the usual one; no figure is called so.
  if (!marks_->isEmpty() && wanted.checkpoints.empty()) wanted.checkpoints = {"(none)"};
  background_.run(
      [this, wanted, gathered = *gathered_]() -> Background::Completion {
        return [this, trial = analytics::tryNorm(gathered, {}, wanted)] { take(trial); };
      },
      [this](const QString& fault) {
        groupsFault_ = fault;
        sayFaults();
      });
}

void NormDialog::take(analytics::NormTrial trial) {
  trial_ = std::move(trial);
  settled_ = true;
  marks_->show(*trial_);
  std::map<std::string, bool> passed;
  for (std::size_t i = 0; i < trial_->passed.size(); ++i) passed[trial_->norm.members[i].attempt] = trial_->passed[i];
  {
    const QSignalBlocker quiet(members_);
    for (int row = 0; row < members_->rowCount(); ++row) {
      const auto at = passed.find(members_->item(row, memberColumn)->data(Qt::UserRole).toString().toStdString());
      members_->item(row, passesColumn)->setText(at == passed.end() ? "left out" : at->second ? "yes" : "no");
    }
    members_->viewport()->update();
  }
  sayFaults();
  emit tried();
}

void NormDialog::sayFaults() {
  const QString name = name_->text().trimmed();
  const auto known = newest_.find(name.toStdString());
  const QString nameFault = name.isEmpty() ? "A norm needs a name."
                            : !analytics::isNormName(name.toStdString())
                                ? "Only letters, digits, points, hyphens and underscores."
                                : QString();
  note(
      nameNote_, nameFault,
      known == newest_.end() ? QString() : QString("It is there: this will be its version %1.").arg(known->second + 1));
  const QString byFault = by_->text().trimmed().isEmpty() ? "Somebody makes it: your pseudonym is missing." : QString();
  note(byNote_, byFault);
  note(groupsNote_, groupsFault_);
  QString membersFault, figuresFault, ruleFault;
  if (trial_) {
    const auto [competent, others] = analytics::sidesOf(trial_->norm);
    if (std::min(competent, others) < analytics::minNormMembers)
      membersFault = QString("%1 competent, %2 others: a norm needs %3 of each.")
                         .arg(competent)
                         .arg(others)
                         .arg(analytics::minNormMembers);
    const std::size_t counting = marks_->counting().size();
    if (counting == 0) figuresFault = "No figure counts: tick one, or move its line.";
    if (counting > 0 && rule_->currentIndex() == 1 && static_cast<std::size_t>(least_->value()) > counting)
      ruleFault = QString("Only %1 figures count.").arg(counting);
    if (counting == 0)
      outcome_->setText("Who would pass is known when a figure counts.");
    else
      outcome_->setText(
          "Would pass: " + rateText(trial_->rates.first, "competent, ") +
          rateText(trial_->rates.second, "others. With marks made without each of them: ") +
          rateText(trial_->withoutSelf.first, "and ") +
          QString("%1 of %2.").arg(trial_->withoutSelf.second.passed).arg(trial_->withoutSelf.second.members));
  } else if (!groupsFault_.isEmpty()) {
    outcome_->setText("Nobody is in it yet.");
  }
  note(membersNote_, membersFault);
  note(figuresNote_, figuresFault);
  note(ruleNote_, ruleFault);
  const bool good = trial_ && (nameFault + byFault + groupsFault_ + membersFault + figuresFault + ruleFault).isEmpty();
  make_->setEnabled(good && !work_.busy());
}

void NormDialog::make() {
  analytics::NormRequest wanted = request();
  wanted.checkpoints = marks_->counting();
  const std::vector<std::string> only = attempts_->currentIndex() == 1 ? selected_ : std::vector<std::string>();
  settings::setPerson(QString::fromStdString(wanted.by));
  make_->setEnabled(false);
  undo_->setEnabled(false);
  resultArea_->hide();
  strip_->begin("Making the norm");
  const auto stored = std::make_shared<analytics::Norm>();
  made_ = stored;
  work_.start([wanted, only, stored, database = document_->path()](LongWork::Control& control) {
    *stored = analytics::createNorm(database, wanted, only, [&](double share, const char* doing) {
      control.progress(share, QString("Making the norm: ") + doing);
    });
    QStringList lines = textsOf(analytics::normSummary(*stored)) + textsOf(analytics::normWarnings(*stored));
    if (stored->synthetic) lines.prepend("SYNTHETIC: made of performers' attempts, of no person's.");
    return lines.join("\n\n");
  });
}

void NormDialog::end(const QString& text) {
  parts::say(result_, text);
  resultArea_->show();
  sayFaults();
}

void NormDialog::undo() {
  undo_->setEnabled(false);
  if (made_->version > 1)
    newest_[made_->name] = made_->version - 1;
  else
    newest_.erase(made_->name);
  emit undoWanted();
  end(QString("Undone: norm %1 version %2 is taken out again.")
          .arg(QString::fromStdString(made_->name))
          .arg(made_->version));
}

}  // namespace calot::gui
