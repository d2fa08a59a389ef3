// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <QObject>
#include <QStyle>
#include <QWidget>

#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_player.h"

class QComboBox;
class QLabel;
class QSlider;
class QToolButton;

namespace calot::gui {

/// A ReplayPlayer for the interface's thread: what it says arrives there as signals, the newest only.
class Replay : public QObject {
  Q_OBJECT
 public:
  using Sink = std::function<void(std::shared_ptr<const SceneView>)>;

  /// @param sink takes the pictures to be; called on the player's thread
  explicit Replay(Sink sink);
  ~Replay() override;

  /// Ends what was open, without waiting for it, and opens another recording. opened() or failed() follows.
  /// The first picture may come before.
  void open(const std::filesystem::path& file, const std::string& attempt);
  void close();
  [[nodiscard]] bool isOpen() const { return open_; }
  /// @pre isOpen()
  [[nodiscard]] const PlayerPosition& position() const { return position_; }

  // Without a recording these do nothing; a speed holds for those to come.
  void seek(double time) { ask({.time = time}); }
  void stepBy(int steps) { ask({.steps = steps}); }
  void togglePlaying() { ask({.playing = !(open_ && position_.playing)}); }
  void play() { ask({.playing = true}); }
  void playFrom(double time) { ask({.time = time, .playing = true}); }
  void pause() { ask({.playing = false}); }
  void setSpeed(double speed) { ask({.speed = speed_ = speed}); }

 signals:
  void opened();
  void positionChanged();
  void failed(const QString& reason);

 private:
  using Back = std::shared_ptr<Link<Replay>>;
  void ask(const ReplayWish& wish) {
    if (player_) player_->ask(wish);
  }
  void hear(const Back& back, std::shared_ptr<const SceneView> view, const PlayerPosition& position);
  void take(const Back& back);

  Sink sink_;
  bool open_ = false;
  double speed_ = 1.0;
  PlayerPosition position_;
  std::mutex mutex_;
  std::optional<PlayerPosition> newest_;  ///< reported and not yet taken
  Back back_;                             ///< of the present player
  std::unique_ptr<ReplayPlayer> player_;
};

/// A button of a replay, for Tab and the mouse.
QToolButton* transportButton(const char* name, const char* what, QStyle::StandardPixmap picture);
/// Position of a replay, from 0 to scrubSteps.
QSlider* scrubBar(const char* name, const char* spokenName);
inline constexpr int scrubSteps = 10000;
/// Speed of a replay, times real time, as the entries' data.
QComboBox* speedChoice(const char* name, const char* spokenName);

/// Buttons of a replay: play and pause, single steps, scrub, speed, and where it stands.
class TransportBar : public QWidget {
  Q_OBJECT
 public:
  /// @param replay outlives the bar
  explicit TransportBar(Replay& replay);

 private:
  void show(const PlayerPosition& position);
  void setReady(bool ready);

  Replay& replay_;
  QToolButton* play_;
  QToolButton* back_;
  QToolButton* forward_;
  QSlider* scrub_;
  QComboBox* speed_;
  QLabel* time_;
};

}  // namespace calot::gui
