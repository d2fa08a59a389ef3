// SPDX-License-Identifier: GPL-3.0-or-later
// An engine of Qt's speech synthesis that speaks to a test: it says nothing aloud and is done when the test says so.
#pragma once

#include <QTextToSpeechEngine>
#include <QTextToSpeechPlugin>

namespace calot::gui::trainertest {

class SpokenEngine : public QTextToSpeechEngine {
  Q_OBJECT
 public:
  explicit SpokenEngine(QObject* parent) : QTextToSpeechEngine(parent) { last = this; }
  ~SpokenEngine() override {
    if (last == this) last = nullptr;
  }

  static inline SpokenEngine* last = nullptr;
  QStringList begun;  ///< everything that it was asked to say

  void finish() { become(QTextToSpeech::Ready); }
  void fail(const QString& why) {
    why_ = why;
    become(QTextToSpeech::Error);
    emit errorOccurred(QTextToSpeech::ErrorReason::Playback, why);
  }

  [[nodiscard]] QList<QLocale> availableLocales() const override {
    return {QLocale(QLocale::German), QLocale(QLocale::English)};
  }
  [[nodiscard]] QList<QVoice> availableVoices() const override { return {}; }
  void say(const QString& text) override {
    begun += text;
    become(QTextToSpeech::Speaking);
  }
  void stop(QTextToSpeech::BoundaryHint) override { become(QTextToSpeech::Ready); }
  void pause(QTextToSpeech::BoundaryHint) override { become(QTextToSpeech::Paused); }
  void resume() override { become(QTextToSpeech::Speaking); }
  [[nodiscard]] double rate() const override { return 0.0; }
  bool setRate(double) override { return false; }
  [[nodiscard]] double pitch() const override { return 0.0; }
  bool setPitch(double) override { return false; }
  [[nodiscard]] QLocale locale() const override { return locale_; }
  bool setLocale(const QLocale& locale) override {
    locale_ = locale;
    return true;
  }
  [[nodiscard]] double volume() const override { return 1.0; }
  bool setVolume(double) override { return false; }
  [[nodiscard]] QVoice voice() const override { return {}; }
  bool setVoice(const QVoice&) override { return false; }
  [[nodiscard]] QTextToSpeech::State state() const override { return state_; }
  [[nodiscard]] QTextToSpeech::ErrorReason errorReason() const override {
    return why_.isEmpty() ? QTextToSpeech::ErrorReason::NoError : QTextToSpeech::ErrorReason::Playback;
  }
  [[nodiscard]] QString errorString() const override { return why_; }

 private:
  void become(QTextToSpeech::State state) {
    if (state == state_) return;
    state_ = state;
    emit stateChanged(state);
  }
  QTextToSpeech::State state_ = QTextToSpeech::Ready;
  QLocale locale_{QLocale::German};
  QString why_;
};

class SpokenPlugin : public QObject, public QTextToSpeechPlugin {
  Q_OBJECT
  Q_INTERFACES(QTextToSpeechPlugin)
  Q_PLUGIN_METADATA(IID "org.qt-project.qt.speech.tts.plugin/6.0" FILE "spoken.json")
 public:
  QTextToSpeechEngine* createTextToSpeechEngine(const QVariantMap&, QObject* parent, QString*) const override {
    return new SpokenEngine(parent);
  }
};

}  // namespace calot::gui::trainertest
