// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <QObject>
#include <QString>

class QTextToSpeech;

namespace calot::gui {

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
