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

#include "gui/dashboard/page_parts.h"

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
                           {"W", "The worst moment of an attempt, then the next one"},
                           {"Space", "Play or pause the replay"},
                           {", and .", "One step back, one step forward"},
                           {"Ctrl+Space", "Play or pause a rater's film"},
                           {"1 to 5, -", "Answer an item of a form, or leave it blank, and go to the next"},
                           {"Ctrl+Return", "Store a rating and go to the next film; Enter in a form does, too"}});
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
