// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <QObject>
#include <QString>
#include <QWidget>
#include <vector>

#include "gui/trainer/operation_view.h"
#include "gui/trainer/trainer_texts.h"

class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QStackedWidget;
class QTextToSpeech;

namespace calot::gui {

/// Fills a list with errors. @param stepSeconds of the scene
void listErrors(QListWidget& list, const std::vector<analytics::ErrorLine>& errors, double stepSeconds);
/// Fork of a branch before the chosen one (s); none: none is chosen.
[[nodiscard]] std::optional<double> chosenBranch(const QListWidget& list);

/// Beside the picture: what the attempt is at, what to do next, the keys; paused and afterwards the mistakes to go back
/// to. It shows what it is given and requests what is pressed.
class RunPanel : public QWidget {
  Q_OBJECT
 public:
  /// @param mouse both hands are driven by mouse and keyboard @param scope keys move the endoscope
  RunPanel(bool mouse, bool scope);

  void show(const TrainingStatus& status, const PanelText& text, double stepSeconds);
  void setMode(recorder::Mode mode);
  /// Sets whether figures are shown that only who looks after the computer needs.
  void setTechnical(bool shown);
  /// Moves the hint there; null: back into the panel.
  void showHintIn(QLayout* place);

 signals:
  void pauseRequested();
  void finishRequested();
  void restartRequested();
  void scenesRequested();
  void backRequested(double time);
  void announced(const QString& subject, const QString& words);  ///< is worth being read aloud

 private:
  void showErrors(const TrainingStatus& status, double stepSeconds);
  void goBack();
  void announce(QLabel* label, const QString& text);  ///< shows it, and announces it when its words change

  recorder::Mode mode_ = recorder::Mode::practice;
  bool mouse_, scope_;
  QLabel *stage_, *modeLabel_, *time_, *late_, *technical_, *phase_, *score_, *hint_, *pointer_, *result_;
  std::array<QLabel*, handCount> hand_;
  QLabel* assistant_;
  QProgressBar* progress_;
  QStackedWidget* lower_;
  QWidget* keys_ = nullptr;
  QLabel* mistakesTitle_;
  QListWidget* list_;
  QPushButton* back_;
  QWidget* mistakes_;
  QPushButton *pause_, *finish_, *restart_, *scenes_;
  std::shared_ptr<const std::vector<analytics::ErrorLine>> listed_;
};

/// Reads words aloud by the system's speech synthesis, through whichever of Qt's engines is installed. News waits for
/// what is being said; of one subject only the latest is worth saying, and cuts off what it replaces.
class Voice : public QObject {
  Q_OBJECT
 public:
  explicit Voice(QObject* parent = nullptr);

  /// In one line why nothing can be read aloud, and what to do; empty: it can.
  [[nodiscard]] QString fault() const;

  /// @param subject what the words are of
  void say(const QString& subject, const QString& words);
  void stop();

 signals:
  /// Synthesis ended in the middle: nothing more will be heard.
  void failed(const QString& why);

 private:
  struct News {
    QString subject, words;
  };
  void sayNext();

  QTextToSpeech* speech_ = nullptr;  ///< null where no engine is installed
  QString present_;                  ///< subject of what is being said; empty: silence
  std::deque<News> waiting_;
};

}  // namespace calot::gui
