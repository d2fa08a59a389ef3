// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dialogs.h"

#include <algorithm>
#include <QAction>
#include <QComboBox>
#include <QCoreApplication>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QFormLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QSettings>
#include <QSpinBox>
#include <QStandardPaths>
#include <utility>

#include "analytics/assessment/norm.h"

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
                           {"Ctrl+Space", "Play or pause a rater's film"},
                           {"Ctrl+Return", "Store a rating and go to the next film"}});
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
  dialog.setLayout(parts::column({{table, 1}, close}));
  dialog.resize(theme::inType(520), theme::inType(420));
  dialog.exec();
}

namespace {

constexpr const char* explanation =
    "A norm is what later attempts are graded against. These figures count: time, path lengths, critical view, clip "
    "errors, perforations and burns, as far as they have a pass mark. Other figures, raters' judgements and marks that "
    "a person sets: calot norm create.";

constexpr int maxFolders = 20;
constexpr int maxRecent = 9;
constexpr const char* recentKey = "cohorts/recent";
constexpr const char* foldersKey = "recordings/folders";
constexpr const char* programKey = "import/program";
constexpr const char* threadsKey = "import/threads";
constexpr const char* personKey = "person";
constexpr const char* courseKey = "course/file";
constexpr const char* courseSyntheticKey = "course/synthetic";
constexpr const char* coloursKey = "look/colours";
constexpr const char* typeKey = "look/type";
constexpr const char* columnsKey = "attempts/hidden-columns";

/// A row of several widgets, which has no buddy by itself.
void addRow(QFormLayout& form, const char* text, QWidget* buddy, QLayout* row) {
  auto* const label = new QLabel(text);
  label->setBuddy(buddy);
  form.addRow(label, row);
}

QSettings store() { return {QSettings::IniFormat, QSettings::UserScope, "calot", "dashboard"}; }

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
      result_(parts::selectableLabel("norm-result")),
      make_(parts::named("norm-make", new QPushButton("&Make the norm"))),
      strip_(new WorkStrip(work_)) {
  setWindowTitle("Make a norm");
  resize(theme::inType(620), theme::inType(460));
  auto* purpose = new QLabel(explanation);
  purpose->setWordWrap(true);
  auto* buttons = new QDialogButtonBox;
  buttons->addButton(make_, QDialogButtonBox::ActionRole);
  buttons->addButton("&Close", QDialogButtonBox::RejectRole);
  setLayout(parts::column({purpose, buildForm(), {result_, 1}, strip_, buttons}));
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
  auto* form = new QFormLayout;
  form->addRow("&Name", name_);
  form->addRow("Made &by", by_);
  form->addRow("A&ttempts", attempts_);
  form->addRow("&Groups by", fields_.by);
  form->addRow("Comp&etent are", fields_.first);
  form->addRow("&Others are", fields_.second);
  form->addRow("Comparable &within", fields_.key);
  addRow(*form, "&Rule", rule_, parts::row({{rule_, 1}, least_}));
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

SettingsDialog::SettingsDialog(QWidget* parent)
    : QDialog(parent),
      folders_(parts::named("settings-folders", new QListWidget)),
      program_(parts::named("settings-program", new QLineEdit)),
      threads_(parts::named("settings-threads", new QSpinBox)),
      person_(parts::named("settings-person", new QLineEdit)),
      colours_(parts::named("settings-colours", new QComboBox)),
      type_(parts::named("settings-type", new QSpinBox)) {
  setWindowTitle("Settings");
  resize(theme::inType(560), theme::inType(400));
  folders_->addItems(settings::recordingFolders());
  auto* addFolder = new QPushButton("&Add …");
  auto* removeFolder = new QPushButton("&Remove");
  program_->setText(settings::chosenCalotProgram());
  const QString found = settings::calotProgram();
  program_->setPlaceholderText(found.isEmpty() ? "not found: name it here" : "the calot that was found");
  program_->setToolTip(found);
  threads_->setRange(1, 64);
  threads_->setValue(settings::importThreads());
  person_->setMaxLength(64);
  person_->setText(settings::person());
  person_->setPlaceholderText("pseudonym of who excludes and tags");
  for (const auto& [text, choice] : {std::pair{"as the system has them", theme::Choice::system},
                                     {"dark letters on light", theme::Choice::light},
                                     {"light letters on dark", theme::Choice::dark}})
    colours_->addItem(text, theme::wordOf(choice));
  colours_->setCurrentIndex(colours_->findData(theme::wordOf(settings::colours())));
  type_->setRange(theme::usualType, theme::largestType);
  type_->setSingleStep(25);
  type_->setSuffix(" %");
  type_->setValue(settings::type());
  type_->setToolTip("From the next start on");
  auto* decision = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  auto* form = new QFormLayout(this);
  addRow(*form, "&Folders with recordings", folders_,
         parts::row({{folders_, 1}, parts::column({addFolder, removeFolder, parts::spring()})}));
  form->addRow("&Program that imports", program_);
  form->addRow("&Threads of an import", threads_);
  form->addRow("&You", person_);
  form->addRow("Co&lours", colours_);
  form->addRow("&Size of letters", type_);
  auto* const lasting = parts::plainLabel("settings-lasting");
  lasting->setText("Settings cannot be undone by Ctrl+Z: open them again to change them back.");
  form->addRow(lasting);
  form->addRow(decision);
  connect(addFolder, &QPushButton::clicked, this, [this] {
    const QString folder = QFileDialog::getExistingDirectory(this, "A folder with recordings");
    if (!folder.isEmpty()) folders_->addItem(folder);
  });
  connect(removeFolder, &QPushButton::clicked, this, [this] { delete folders_->currentItem(); });
  connect(decision, &QDialogButtonBox::accepted, this, &SettingsDialog::accept);
  connect(decision, &QDialogButtonBox::rejected, this, &SettingsDialog::reject);
}

void SettingsDialog::accept() {
  QStringList folders;
  for (int row = 0; row < folders_->count(); ++row) folders += folders_->item(row)->text();
  settings::setRecordingFolders(folders);
  settings::setCalotProgram(program_->text().trimmed());
  settings::setImportThreads(threads_->value());
  settings::setPerson(person_->text().trimmed());
  const theme::Choice before = settings::colours();
  settings::setColours(theme::choiceOf(colours_->currentData().toString()));
  const int letters = settings::type();
  settings::setType(type_->value());
  // Widths of columns are chosen when the window is made: letters change with the next one.
  if (settings::colours() != before) theme::apply(settings::colours(), letters);
  QDialog::accept();
}

}  // namespace calot::gui

namespace calot::gui::settings {

QStringList recordingFolders() { return store().value(foldersKey).toStringList(); }

std::vector<std::filesystem::path> recordingPlaces() {
  std::vector<std::filesystem::path> places;
  for (const QString& folder : recordingFolders()) places.emplace_back(folder.toStdString());
  return places;
}

void setRecordingFolders(const QStringList& folders) { store().setValue(foldersKey, folders.mid(0, maxFolders)); }

void rememberRecordingFolder(const QString& folder) {
  QStringList folders = recordingFolders();
  folders.removeAll(folder);
  folders.prepend(folder);
  setRecordingFolders(folders);
}

QStringList recentCohorts() { return store().value(recentKey).toStringList(); }
void rememberCohort(const QString& file) {
  QStringList files = recentCohorts();
  files.removeAll(file);
  files.prepend(file);
  store().setValue(recentKey, files.mid(0, maxRecent));
}

QString chosenCalotProgram() { return store().value(programKey).toString(); }

QString calotProgram() {
  if (const QString chosen = chosenCalotProgram(); !chosen.isEmpty()) return chosen;
  const QString beside = QStandardPaths::findExecutable("calot", {QCoreApplication::applicationDirPath()});
  return beside.isEmpty() ? QStandardPaths::findExecutable("calot") : beside;
}

void setCalotProgram(const QString& file) { store().setValue(programKey, file); }

int importThreads() { return std::clamp(store().value(threadsKey, 1).toInt(), 1, 64); }
void setImportThreads(int threads) { store().setValue(threadsKey, std::clamp(threads, 1, 64)); }

theme::Choice colours() { return theme::choiceOf(store().value(coloursKey).toString()); }
void setColours(theme::Choice choice) { store().setValue(coloursKey, theme::wordOf(choice)); }
int type() {
  return std::clamp(store().value(typeKey, theme::usualType).toInt(), theme::usualType, theme::largestType);
}
void setType(int percent) { store().setValue(typeKey, std::clamp(percent, theme::usualType, theme::largestType)); }

QStringList hiddenColumns() { return store().value(columnsKey).toStringList(); }
void setHiddenColumns(const QStringList& titles) { store().setValue(columnsKey, titles); }

QString course() { return store().value(courseKey).toString(); }
void setCourse(const QString& file) { store().setValue(courseKey, file); }
bool courseSynthetic() { return store().value(courseSyntheticKey, false).toBool(); }
void setCourseSynthetic(bool counts) { store().setValue(courseSyntheticKey, counts); }

QString person() { return store().value(personKey).toString(); }
void setPerson(const QString& name) { store().setValue(personKey, name); }

}  // namespace calot::gui::settings
