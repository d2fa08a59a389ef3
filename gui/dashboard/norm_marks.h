// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <QString>
#include <QWidget>
#include <string>
#include <vector>

#include "analytics/assessment/norm_decision.h"

class QCheckBox;
class QLabel;
class QVBoxLayout;

namespace calot::gui {

class MarkSlider;

/// One figure of a norm: its members' values with the mark, whether it counts, and whether its mark is a person's,
/// which is a veto. Critical errors are always one, and are shown only.
class NormMark : public QWidget {
  Q_OBJECT
 public:
  /// @param figure as analytics::figureName() has it
  NormMark(const analytics::NormCheckpoint& mark, const std::string& figure);
  /// Shows where the figure stands in a trial. @param position in its norm
  void show(const analytics::NormTrial& trial, std::size_t position);

  [[nodiscard]] const std::string& figure() const { return figure_; }
  [[nodiscard]] bool countsByItself() const { return byDefault_; }
  [[nodiscard]] bool isWanted() const;  ///< ticked to count, whether it has a mark or not
  [[nodiscard]] bool counts() const { return isWanted() && hasMark_; }
  [[nodiscard]] bool isDecided() const { return counts_.has_value() || fixed_.has_value(); }
  [[nodiscard]] std::optional<analytics::FixedCut> fixed() const;  ///< a person's mark of a figure that counts
  [[nodiscard]] MarkSlider& slider() { return *slider_; }
  void tabAfter(NormMark& before);  ///< its controls follow those of another by the keyboard

 signals:
  void changed();  ///< by a person

 private:
  void fix(std::optional<double> mark);
  void describe();

  std::string figure_;
  analytics::NormCheckpoint mark_;
  bool always_, byDefault_, hasMark_ = false;
  std::optional<bool> counts_;   ///< a person's decision
  std::optional<double> fixed_;  ///< the same, in the unit that is shown
  std::optional<double> computed_;
  MarkSlider* slider_;
  QLabel *value_, *reason_;
  QCheckBox *counting_, *veto_;
};

/// The figures of a norm in the making, those that count by themselves first.
class NormMarks : public QWidget {
  Q_OBJECT
 public:
  NormMarks();
  /// Shows a trial. Decisions about its figures stay as they are.
  void show(const analytics::NormTrial& trial);
  void showAll(bool all);  ///< figures, too, that do not count

  [[nodiscard]] bool isEmpty() const { return rows_.empty(); }
  [[nodiscard]] std::vector<std::string> wanted() const;
  [[nodiscard]] std::vector<std::string> counting() const;
  [[nodiscard]] std::vector<analytics::FixedCut> fixed() const;

 signals:
  void changed();

 private:
  std::map<std::string, NormMark*> rows_;
  QVBoxLayout* column_;
  bool all_ = false;
};

}  // namespace calot::gui
