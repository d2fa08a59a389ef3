// SPDX-License-Identifier: GPL-3.0-or-later
// A course: tasks of rising difficulty, each on a scene, and the criterion of proficiency in each
// (assets/curricula/*.json, schemas/course.schema.json).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/math/record.h"

namespace calot::analytics {

/// Proficiency in a task: its norm is passed several times in a row.
struct CourseCriterion {
  std::string norm;               ///< name of a norm of the cohort
  std::uint32_t normVersion = 0;  ///< 0: the newest
  std::uint32_t passes = 2;
  std::uint32_t retentionDays = 0;  ///< from proficiency to the retention test; 0: there is no test
  std::uint32_t dueDays = 0;        ///< from the begin of the course; 0: no limit

  static std::vector<Field> fields();
};

struct CourseTask {
  std::string scene;  ///< name of the scene; of imported motion, of its task
  std::string title;  ///< "Clip and cut"
  std::string goal;   ///< one sentence: what is to be reached
  std::optional<CourseCriterion> criterion;

  static std::vector<Field> fields();
};

struct Course {
  std::string name, title;
  std::vector<std::string> groups;  ///< whose participants it is assigned to; empty: everybody
  std::string begins;               ///< "2026-09-01"; empty: with a person's first attempt
  std::uint32_t daysBetween = 0;    ///< fewest days from one pass that counts to the next
  std::vector<CourseTask> tasks;    ///< the easiest first

  static std::vector<Field> fields();
};

/// @throws Error (damaged), naming file and JSON pointer, where anything is unknown, missing or out of its range.
Course readCourse(const std::filesystem::path& file);

}  // namespace calot::analytics
