// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/pair_side.h"

#include <algorithm>
#include <QBoxLayout>
#include <QComboBox>
#include <QSignalBlocker>
#include <utility>

#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/attempt_banner.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/timeline_bar.h"
#include "gui/view/scene_picture_widget.h"

namespace calot::gui {
namespace {

constexpr int mostListed = 2000;  // attempts in a choice: a longer list is no choice

QString attemptText(const AttemptLines& lines, int row) {
  return QString("%1 · %2 · %3 · %4")
      .arg(lines.cell(row, AttemptLines::operatorColumn), lines.cell(row, AttemptLines::sceneColumn),
           lines.cell(row, AttemptLines::startColumn), lines.cell(row, AttemptLines::verificationColumn));
}

}  // namespace

PairSide::PairSide(const QString& name, QWidget* parent)
    : QWidget(parent),
      choice_(new QComboBox),
      banner_(new AttemptBanner),
      picture_(new ScenePictureWidget),
      timeline_(new TimelineBar),
      replay_(std::make_unique<Replay>(
          [picture = picture_](std::shared_ptr<const SceneView> view) { picture->showView(std::move(view)); })),
      reader_(std::make_unique<RecordingReader>()) {
  choice_->setObjectName(name + "-attempt");
  choice_->setAccessibleName("Attempt on the " + name);
  choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  choice_->setMinimumContentsLength(20);
  auto* layout = parts::bare<QVBoxLayout>(this);
  layout->addWidget(choice_);
  banner_->makeNarrow();
  layout->addWidget(banner_);
  layout->addWidget(picture_, 1);
  layout->addWidget(timeline_);
  connect(choice_, &QComboBox::currentIndexChanged, this, [this] { openChosen(); });
  connect(replay_.get(), &Replay::opened, this, [this] {
    seconds_ = replay_->position().seconds;
    reader_->read(file_, {});
    emit ready();
  });
  connect(replay_.get(), &Replay::positionChanged, this, [this] { timeline_->setPosition(replay_->position().time); });
  connect(replay_.get(), &Replay::failed, this, [this](const QString& reason) {
    picture_->showText(reason);
    timeline_->setText("No timeline: the recording cannot be shown.");
  });
  connect(reader_.get(), &RecordingReader::trackRead, this, &PairSide::showTrack);
  connect(reader_.get(), &RecordingReader::failed, timeline_, &TimelineBar::setText);
  connect(timeline_, &TimelineBar::timeChosen, this, &PairSide::timeChosen);
}

PairSide::~PairSide() {
  // Their threads use the picture and this widget.
  reader_.reset();
  replay_.reset();
}

void PairSide::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  {
    const QSignalBlocker quiet(choice_);
    choice_->clear();
    choice_->addItem("Choose an attempt …", QString());
    const auto& attempts = document_->attempts();
    for (std::size_t i = attempts.size(); i-- > 0 && choice_->count() <= mostListed;)
      choice_->addItem(attemptText(*document_->lines(), static_cast<int>(i)), QString::fromStdString(attempts[i].uuid));
    if (!wanted_.empty()) uuid_ = std::exchange(wanted_, {});
    const int at = uuid_.empty() ? 0 : choice_->findData(QString::fromStdString(uuid_));
    choice_->setCurrentIndex(std::max(0, at));
  }
  openChosen();
}

void PairSide::choose(const std::string& uuid) {
  if (!isVisible()) {
    wanted_ = uuid;
    return;
  }
  const int at = choice_->findData(QString::fromStdString(uuid));
  if (at >= 0) choice_->setCurrentIndex(at);
}

void PairSide::chooseAnother(int n) {
  if (uuid_.empty() && choice_->count() > n) choice_->setCurrentIndex(n);
}

QWidget* PairSide::choiceBox() const { return choice_; }
bool PairSide::settled() const {
  return file_.empty() || (track_ && isOpen() && replay_->position().settled && !picture_->picture().isNull());
}

void PairSide::openChosen() {
  const std::string uuid = choice_->currentData().toString().toStdString();
  const analytics::AttemptRow* attempt = uuid.empty() ? nullptr : document_->attempt(uuid);
  if (attempt != nullptr && opened_ == uuid && isOpen()) return;
  uuid_ = opened_ = uuid;
  reader_->stop();
  replay_->close();
  track_.reset();
  file_.clear();
  emit changing();
  if (attempt == nullptr) {
    banner_->showText(" ");
    picture_->showText("No attempt is chosen.");
    timeline_->setText({});
    return;
  }
  banner_->showAttempt(*attempt);
  file_ = findRecording(*attempt, document_->path(), settings::recordingPlaces());
  if (file_.empty()) {
    picture_->showText(QString::fromStdString(attempt->fileName) +
                       " was not found. Open the attempt on its own page to say where it is.");
    timeline_->setText("No timeline without the recording.");
    return;
  }
  picture_->showText("Opening " + QString::fromStdString(file_.filename().string()) + " …");
  timeline_->setText("Checking the recording …");
  replay_->open(file_, uuid);
}

void PairSide::showTrack(const AttemptTrack& track) {
  track_ = track;
  timeline_->setTrack(track);
  emit ready();
}

PairAlignment::PairAlignment(std::array<double, 2> seconds, std::array<double, 2> offsets)
    : seconds_(seconds),
      offsets_(offsets),
      begin_(std::min(-offsets[0], -offsets[1])),
      end_(std::max(seconds[0] - offsets[0], seconds[1] - offsets[1])) {}

double PairAlignment::own(std::size_t which, double common) const {
  return std::clamp(common + offsets_[which], 0.0, seconds_[which]);
}

bool PairAlignment::runs(std::size_t which, double common) const {
  const double time = common + offsets_[which];
  return time >= 0.0 && time < seconds_[which];
}

std::optional<double> firstOf(const AttemptTrack& track, Phase phase) {
  const auto at =
      std::find_if(track.phases.begin(), track.phases.end(), [&](const TrackPhase& p) { return p.phase == phase; });
  if (at == track.phases.end()) return std::nullopt;
  return at->begin;
}

std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b) {
  std::vector<Phase> phases;
  for (const Phase phase : {Phase::identification, Phase::clipping, Phase::cutting, Phase::dissection}) {
    if (firstOf(a, phase) && firstOf(b, phase)) phases.push_back(phase);
  }
  return phases;
}

}  // namespace calot::gui
