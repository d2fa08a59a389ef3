// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "analytics/assessment/course_progress.h"
#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"

namespace calot::gui {

/// How far the people of a cohort are in a course, as `calot course` has it, today. Checks the database before; for a
/// thread that is not the interface's. @throws Error as analytics::courseProgress(), (damaged) for course or database
std::shared_ptr<const analytics::CourseProgress> readCourseProgress(const std::string& database,
                                                                    const std::filesystem::path& course,
                                                                    bool includeSynthetic);

/// A course: a row for each person, who is behind first, and what is missing next; below, what the chosen person lacks
/// and their attempts, each of which can be opened. The course is one that comes with the program, or a file.
class CoursePage : public CohortPage {
  Q_OBJECT
 public:
  CoursePage();
  /// Offers the courses in `curricula/` of these folders, best first, and the one that was chosen last.
  void readCourses(const std::vector<std::filesystem::path>& folders);
  /// Takes a course from a file, too, and shows it.
  void openCourse(const QString& file);
  [[nodiscard]] bool ready() const { return ready_; }  ///< what is shown is of the chosen course
  bool makeDocument(const Taker& take) override;

 signals:
  void courseChosen();

 private:
  void read() override;
  void addCourse(const std::filesystem::path& file);
  void choose();
  void askForCourse();
  void showProgress(std::shared_ptr<const analytics::CourseProgress> progress, const QString& fault);
  void showPerson();
  [[nodiscard]] std::filesystem::path chosen() const;

  std::shared_ptr<const analytics::CourseProgress> progress_;  ///< or null
  std::vector<const analytics::CoursePerson*> rows_;           ///< of people_
  bool ready_ = false;
  QComboBox* course_;
  QPushButton* another_;
  QCheckBox* synthetic_;
  QLabel* summary_;
  QTableWidget* people_;
  QLabel* person_;
  QTableWidget* attempts_;
  Background background_;
};

}  // namespace calot::gui
