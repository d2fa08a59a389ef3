// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/course_page.h"

#include <algorithm>
#include <QFileDialog>
#include <QFileInfo>

#include "analytics/report/course_tables.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/dialogs.h"
#include "recorder/base/counted.h"
#include "recorder/base/dates.h"
#include "recorder/base/files.h"

namespace calot::gui {
namespace {

using analytics::CoursePerson;
using analytics::CourseProgress;

/// "4 participants on 2026-12-01, 1 behind. 2 attempts do not count."
QString summaryOf(const CourseProgress& progress) {
  if (progress.people.empty()) return "The course is assigned to nobody: the cohort has no participants.";
  const auto behind = std::ranges::count_if(progress.people, analytics::isBehind);
  QString text = QString("%1 on %2, %3 behind.")
                     .arg(QString::fromStdString(recorder::counted(progress.people.size(), "participant")),
                          QString::fromStdString(progress.today))
                     .arg(behind);
  if (const std::size_t left = analytics::notCounted(progress); left > 0)
    text += QString(" %1 %2 not count: choose a person for the reasons.")
                .arg(QString::fromStdString(recorder::counted(left, "attempt")), left == 1 ? "does" : "do");
  if (std::ranges::none_of(progress.course.tasks, [](const auto& task) { return task.criterion.has_value(); }))
    text += " The course declares no criterion of proficiency: only tries are counted.";
  if (progress.synthetic) text = QString(analytics::watermarkText) + ". " + text;
  return text;
}

}  // namespace

std::shared_ptr<const CourseProgress> readCourseProgress(const std::string& database,
                                                         const std::filesystem::path& course, bool includeSynthetic) {
  const analytics::Course read = analytics::readCourse(course);
  analytics::refuseUnsound(database);
  const analytics::CohortDatabase cohort(database, analytics::CohortDatabase::Access::read);
  return std::make_shared<const CourseProgress>(analytics::courseProgress(
      cohort, read, course.filename().string(), recorder::presentDate().substr(0, 10), includeSynthetic));
}

CoursePage::CoursePage()
    : course_(parts::choice("course", 20)),
      another_(parts::named("course-open", new QPushButton("&Another …"))),
      synthetic_(parts::named("course-synthetic", new QCheckBox("&Synthetic attempts, too"))),
      summary_(parts::plainLabel("course-summary")),
      people_(makeTextTable({}, "course-people", "People of the course")),
      person_(parts::plainLabel("course-person")),
      attempts_(makeTextTable({"Task", "Started", "Result", "In a row", "Because"}, "course-attempts",
                              "Attempts of the chosen person")) {
  another_->setToolTip("A course from a file");
  people_->setSelectionMode(QAbstractItemView::SingleSelection);
  for (QTableWidget* table : {people_, attempts_}) table->horizontalHeader()->setHighlightSections(false);
  people_->setToolTip("Choose a person to see their attempts below");
  attempts_->setToolTip("Double-click, or press Enter, to open an attempt");
  setWidths(*attempts_, {200, 150, 170, 80});
  QWidget* const lower = parts::boxed(parts::column({person_, {attempts_, 1}}));
  setLayout(parts::column({parts::row({{"C&ourse", course_, 1}, another_, synthetic_}),
                           summary_,
                           {makeSplitter(Qt::Vertical, {{people_, 3}, {lower, 2}}), 1}}));
  begin_ = people_;
  connect(course_, &QComboBox::activated, this, [this] { choose(); });
  connect(another_, &QPushButton::clicked, this, &CoursePage::askForCourse);
  synthetic_->setChecked(settings::courseSynthetic());
  connect(synthetic_, &QCheckBox::toggled, this, [this](bool counts) {
    settings::setCourseSynthetic(counts);
    choose();
  });
  connect(people_, &QTableWidget::currentItemChanged, this, [this] { showPerson(); });
  connect(attempts_, &QTableWidget::itemActivated, this, [this](const QTableWidgetItem* item) {
    emit attemptActivated(attempts_->item(item->row(), 0)->data(Qt::UserRole).toString());
  });
}

void CoursePage::readCourses(const std::vector<std::filesystem::path>& folders) {
  for (const auto& entry : recorder::filesIn(folders, "curricula")) addCourse(entry.second);
  if (const QString last = settings::course(); QFileInfo(last).isFile()) addCourse(last.toStdString());
}

/// Adds it once, and chooses it where it is the one that was chosen last.
void CoursePage::addCourse(const std::filesystem::path& file) {
  const QString path = QString::fromStdString(file.string());
  int at = course_->findData(path);
  if (at < 0) {
    tryTo([&] {
      const analytics::Course course = analytics::readCourse(file);
      course_->addItem(QString::fromStdString(course.title + " (" + course.name + ")"), path);
      at = course_->count() - 1;
    });
  }
  if (at >= 0 && path == settings::course()) course_->setCurrentIndex(at);
}

std::filesystem::path CoursePage::chosen() const { return course_->currentData().toString().toStdString(); }

void CoursePage::choose() {
  settings::setCourse(course_->currentData().toString());
  emit courseChosen();
  outdate();
}

void CoursePage::openCourse(const QString& file) {
  if (!tryTo([&] { (void)analytics::readCourse(file.toStdString()); })) return;
  settings::setCourse(QFileInfo(file).absoluteFilePath());
  addCourse(settings::course().toStdString());
  choose();
}

void CoursePage::askForCourse() {
  const QString file = QFileDialog::getOpenFileName(this, "Open a course", {}, "Courses (*.json);;All files (*)");
  if (!file.isEmpty()) openCourse(file);
}

void CoursePage::read() {
  ready_ = false;
  if (chosen().empty()) {
    showProgress(nullptr, "No course was found; open one from a file.");
    return;
  }
  summary_->setText("Reading the course's attempts …");
  background_.run(
      [this, database = document_->path(), course = chosen(), synthetic = synthetic_->isChecked()] {
        return [this, progress = readCourseProgress(database, course, synthetic)] { showProgress(progress, {}); };
      },
      [this](const QString& fault) { showProgress(nullptr, fault); });
}

void CoursePage::showProgress(std::shared_ptr<const CourseProgress> progress, const QString& fault) {
  const QString before =
      people_->currentRow() < 0 ? QString() : people_->item(people_->currentRow(), 0)->data(Qt::UserRole).toString();
  progress_ = std::move(progress);
  ready_ = true;
  const QSignalBlocker quiet(people_);
  people_->clearContents();
  people_->setRowCount(0);
  rows_.clear();
  summary_->setText(progress_ ? summaryOf(*progress_) : fault);
  if (progress_) {
    rows_ = analytics::behindFirst(*progress_);
    const analytics::ReportTable table = analytics::courseTable(*progress_, rows_);
    QStringList titles{"Participant", "Group", "Proficient"};
    for (const analytics::CourseTask& task : progress_->course.tasks) titles += QString::fromStdString(task.title);
    titles += "Missing next";
    people_->setColumnCount(static_cast<int>(titles.size()));
    people_->setHorizontalHeaderLabels(titles);
    people_->setRowCount(static_cast<int>(rows_.size()));
    int current = 0;
    for (int row = 0; row < people_->rowCount(); ++row) {
      const CoursePerson& person = *rows_[static_cast<std::size_t>(row)];
      QStringList texts = textsOf(table.rows[static_cast<std::size_t>(row)]);
      texts.insert(2, QString::fromStdString(analytics::proficientOf(progress_->course, person)));
      texts += QString::fromStdString(analytics::nextMissing(person));
      setTexts(*people_, row, texts, person.participant);
      for (std::size_t t = 0; t < person.tasks.size(); ++t) {
        if (person.tasks[t].behind) people_->item(row, static_cast<int>(t) + 3)->setForeground(theme::trouble());
      }
      people_->item(row, static_cast<int>(texts.size()) - 1)->setToolTip(texts.back());
      if (person.participant == before.toStdString()) current = row;
    }
    const bool grouped = std::ranges::any_of(table.rows, [](const auto& row) { return !row[1].empty(); });
    people_->setColumnHidden(1, !grouped);
    for (int column = 0; column + 1 < people_->columnCount(); ++column) {
      people_->resizeColumnToContents(column);
      people_->setColumnWidth(column, people_->columnWidth(column) + theme::inType(14));
    }
    if (!rows_.empty()) people_->setCurrentCell(current, 0);
  }
  showPerson();
}

void CoursePage::showPerson() {
  const int row = people_->currentRow();
  attempts_->setRowCount(0);
  if (!progress_ || row < 0) {
    person_->clear();
    return;
  }
  const CoursePerson& person = *rows_[static_cast<std::size_t>(row)];
  person_->setText(QString::fromStdString(person.participant) + ": " +
                   textsOf(analytics::personNotes(*progress_, person)).join(' '));
  const analytics::ReportTable table = analytics::courseAttempts(*progress_, person);
  const std::vector<std::string> uuids = analytics::courseAttemptIds(person);
  attempts_->setRowCount(static_cast<int>(table.rows.size()));
  for (int at = 0; at < attempts_->rowCount(); ++at) {
    QStringList texts = textsOf(table.rows[static_cast<std::size_t>(at)]);
    texts[1] = startText(texts[1].toStdString());
    setTexts(*attempts_, at, texts, uuids[static_cast<std::size_t>(at)]);
    attempts_->item(at, attempts_->columnCount() - 1)->setToolTip(texts.back());
  }
}

bool CoursePage::makeDocument(const Taker& take) {
  if (!progress_ || progress_->people.empty()) return false;
  take(analytics::courseDocument(*progress_));
  return true;
}

}  // namespace calot::gui
