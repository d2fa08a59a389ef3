// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <QDialog>
#include <string>
#include <vector>

#include "analytics/assessment/norm_decision.h"
#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"

class QSpinBox;

namespace calot::gui {

class NormMarks;

/// Makes a norm: who is in it and who of them is competent, as a list with ticks; each figure's values and its pass
/// mark, which can be moved; and who would pass, with marks made without each member. What is missing is said beside
/// the field that it is missing in. The norm is made as `calot norm create` makes it.
class NormDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param selected uuids of the attempts that are selected on the page
  NormDialog(std::shared_ptr<const CohortDocument> document, std::vector<std::string> selected,
             QWidget* parent = nullptr);
  /// True where what is shown follows from what is chosen: nothing is being read or computed.
  [[nodiscard]] bool settled() const { return settled_; }

 signals:
  void tried();                            ///< the members, or their marks, were worked out, or why they can't be
  void made(const analytics::Norm& norm);  ///< it is stored
  void refused();                          ///< and why stands in the dialog
  void undoWanted();                       ///< of the norm that was just made

 private:
  QLayout* buildFields();
  QWidget* buildMembers();
  QWidget* buildFigures();
  QLayout* buildRule();
  void connectFields();
  void suggestName();
  void offerRaters();
  [[nodiscard]] analytics::NormRequest request() const;
  void gather();  ///< members again: another choice of groups or attempts
  void fillMembers();
  void tryMarks();  ///< of the same members: another tick or mark
  void take(analytics::NormTrial trial);
  void sayFaults();
  void make();
  void end(const QString& text);
  void undo();

  std::shared_ptr<const CohortDocument> document_;
  std::vector<std::string> selected_;
  std::map<std::string, std::uint32_t> newest_;             ///< versions of the cohort's norms
  std::shared_ptr<const analytics::NormSource> source_[2];  ///< of all attempts, of those that are selected
  std::optional<analytics::Norm> gathered_;                 ///< none: there are no members
  std::optional<analytics::NormTrial> trial_;
  std::shared_ptr<const analytics::Norm> made_;  ///< the last, once it is stored
  QString groupsFault_;
  bool settled_ = false;
  LongWork work_;

  QLineEdit *name_, *by_;
  QLabel *nameNote_, *byNote_, *groupsNote_, *membersNote_, *figuresNote_, *ruleNote_;
  GroupFields fields_;  ///< first: the competent
  QComboBox *attempts_, *rule_;
  QSpinBox* least_;
  QCheckBox *first_, *all_;
  QTableWidget* members_;
  NormMarks* marks_;
  QLabel *outcome_, *result_;
  QWidget* resultArea_;
  QPushButton *make_, *undo_;
  WorkStrip* strip_;
  Background background_;  // last: it uses what is above
};

}  // namespace calot::gui
