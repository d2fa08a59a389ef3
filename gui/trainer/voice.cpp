// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/voice.h"

#include <algorithm>
#include <QLocale>
#include <QTextToSpeech>
#include <utility>

namespace calot::gui {
namespace {
constexpr const char* remedy = "; install qt6-speech-speechd-plugin and speech-dispatcher, or qt6-speech-flite-plugin";
}

Voice::Voice(QObject* parent) : QObject(parent) {
  if (QTextToSpeech::availableEngines().isEmpty()) return;
  speech_ = new QTextToSpeech(this);
  // The words are English whatever the system speaks.
  const QList<QLocale> locales = speech_->availableLocales();
  const auto english = std::find_if(locales.begin(), locales.end(),
                                    [](const QLocale& locale) { return locale.language() == QLocale::English; });
  if (english != locales.end() && speech_->locale().language() != QLocale::English) speech_->setLocale(*english);
  connect(speech_, &QTextToSpeech::stateChanged, this, [this](QTextToSpeech::State state) {
    if (state == QTextToSpeech::Ready) sayNext();
  });
  connect(speech_, &QTextToSpeech::errorOccurred, this, [this] {
    waiting_.clear();
    present_.clear();
    emit failed(fault());
  });
}

QString Voice::fault() const {
  if (speech_ == nullptr) return QString("no speech synthesis is installed") + remedy;
  if (speech_->state() != QTextToSpeech::Error) return {};
  const QString why = speech_->errorString().simplified();
  return "speech synthesis \"" + speech_->engine() + "\" does not work" + (why.isEmpty() ? "" : ": " + why) + remedy;
}

void Voice::say(const QString& subject, const QString& words) {
  if (!fault().isEmpty()) return;
  const auto same =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const News& news) { return news.subject == subject; });
  if (same != waiting_.end()) {
    same->words = words;
    return;
  }
  if (present_ == subject) {
    // A replaced sentence is not finished, and its replacement goes first.
    waiting_.push_front({subject, words});
    speech_->stop();
    // An engine that was silent already has no change of state to tell.
    if (present_ == subject && speech_->state() == QTextToSpeech::Ready) sayNext();
    return;
  }
  waiting_.push_back({subject, words});
  if (present_.isEmpty()) sayNext();
}

void Voice::stop() {
  waiting_.clear();
  if (speech_ != nullptr) speech_->stop();
  present_.clear();
}

void Voice::sayNext() {
  present_.clear();
  if (waiting_.empty()) return;
  const News news = std::move(waiting_.front());
  waiting_.pop_front();
  present_ = news.subject;
  speech_->say(news.words);
}

}  // namespace calot::gui
