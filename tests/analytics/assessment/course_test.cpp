// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/course.h"

#include <gtest/gtest.h>

#include <fstream>

#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

/// A course file of these tasks, with further members before them.
class CourseFile {
 public:
  explicit CourseFile(const std::string& tasks, const std::string& more = "") : path_(folder_.file("c.json")) {
    std::ofstream(path_) << R"({"format": "calot-course", "formatVersion": 1, "name": "c", "title": "C", )" << more
                         << R"("tasks": )" << tasks << "}";
  }
  [[nodiscard]] Course read() const { return readCourse(path_); }
  [[nodiscard]] std::optional<Error> fault() const {
    return caught([&] { static_cast<void>(read()); });
  }
  [[nodiscard]] std::string at(const std::string& pointer) const { return path_ + ": " + pointer; }

 private:
  support::Folder folder_;
  std::string path_;
};

std::string taskOf(const std::string& scene, const std::string& criterion = "") {
  return R"({"scene": ")" + scene + R"(", "title": "A", "goal": "Do.")" +
         (criterion.empty() ? "" : R"(, "criterion": )" + criterion) + "}";
}

TEST(CourseFiles, TheOneThatComesWithTheProgramHasNoCriteria) {
  const Course course = readCourse(CALOT_SOURCE_DIR "/assets/curricula/basic.json");
  EXPECT_EQ(course.tasks.size(), 5U);
  for (const CourseTask& task : course.tasks) EXPECT_FALSE(task.criterion) << "norms are the site's";
  EXPECT_TRUE(course.groups.empty());
}

TEST(CourseFiles, CriteriaHaveDefaults) {
  const Course course =
      CourseFile(
          "[" + taskOf("a", R"({"norm": "clinic"})") + ", " +
              taskOf("b", R"({"norm": "n", "normVersion": 3, "passes": 1, "retentionDays": 30, "dueDays": 60})") + "]",
          R"("groups": ["novice"], "begins": "2026-02-28", "daysBetween": 1, )")
          .read();
  EXPECT_EQ(course.groups, std::vector<std::string>{"novice"});
  EXPECT_EQ(course.begins, "2026-02-28");
  EXPECT_EQ(course.daysBetween, 1U);
  const CourseCriterion &plain = *course.tasks[0].criterion, &full = *course.tasks[1].criterion;
  EXPECT_EQ(plain.norm, "clinic");
  EXPECT_EQ((std::array{plain.normVersion, plain.passes, plain.retentionDays, plain.dueDays}),
            (std::array{0U, 2U, 0U, 0U}));
  EXPECT_EQ((std::array{full.normVersion, full.passes, full.retentionDays, full.dueDays}),
            (std::array{3U, 1U, 30U, 60U}));
}

TEST(CourseFiles, FaultsAreNamedWithTheirPlace) {
  struct Case {
    std::string tasks, more, place;
    std::vector<std::string> values;
  };
  const std::string one = "[" + taskOf("a") + "]";
  const std::vector<Case> cases{
      {"[]", "", "/tasks", {"0"}},
      {R"([{"scene": "a", "title": "A"}])", "", "/tasks/0", {"\"goal\""}},
      // Two tasks of one scene: which is next?
      {"[" + taskOf("a") + ", " + taskOf("a") + "]", "", "/tasks/1/scene", {}},
      {"[" + taskOf("a", "{}") + "]", "", "/tasks/0/criterion", {"\"norm\""}},
      {"[" + taskOf("a", R"({"norm": "a b"})") + "]", "", "/tasks/0/criterion/norm", {}},
      {"[" + taskOf("a", R"({"norm": "n", "passes": 0})") + "]", "", "/tasks/0/criterion/passes", {"1", "20"}},
      {"[" + taskOf("a", R"({"norm": "n", "passes": 1.5})") + "]", "", "/tasks/0/criterion/passes", {}},
      {"[" + taskOf("a", R"({"norm": "n", "dueDays": -1})") + "]", "", "/tasks/0/criterion/dueDays", {}},
      {"[" + taskOf("a", R"({"norm": "n", "days": 1})") + "]", "", "/tasks/0/criterion/days", {"dueDays"}},
      {one, R"("groups": [], )", "/groups", {"0"}},
      {one, R"("groups": ["g", "h", "g"], )", "/groups/2", {}},
      {one, R"("begins": "1.9.2026", )", "/begins", {"2026-01-31"}},
      {one, R"("begins": "2026-02-30", )", "/begins", {}},
      {one, R"("daysBetween": 4000, )", "/daysBetween", {"3650"}},
  };
  EXPECT_FALSE(CourseFile(one).fault());
  for (const Case& c : cases) {
    const CourseFile file(c.tasks, c.more);
    expectFault(ErrorKind::damaged, file.at(c.place), c.values, file.fault());
  }
}

}  // namespace
}  // namespace calot::analytics
