// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/recording_reader.h"

#include <algorithm>
#include <exception>
#include <QMetaObject>

#include "gui/view/thread_rank.h"
#include "gui/words/problem_words.h"

namespace calot::gui {
namespace {

struct BrokenOff {};

/// Calls on the object's thread, unless it is not interested any more by then.
template <class Call>
void tell(const std::shared_ptr<Link<RecordingReader>>& back, Call call) {
  back->pass([&](RecordingReader& reader) {
    QMetaObject::invokeMethod(
        &reader,
        [&reader, back, call = std::move(call)] {
          if (back->stands()) call(reader);
        },
        Qt::QueuedConnection);
  });
}

}  // namespace

RecordingReader::RecordingReader(QObject* parent) : QObject(parent) {}

RecordingReader::~RecordingReader() { stop(); }

void RecordingReader::read(const std::filesystem::path& file, const Figures& figures) {
  stop();
  back_ = std::make_shared<Link<RecordingReader>>(*this);
  taskPool().start([back = back_, file, figures] { run(back, file, figures); });
}

void RecordingReader::stop() {
  if (back_) back_->cut();
  back_.reset();
}

void RecordingReader::run(const Back& back, const std::filesystem::path& file, const Figures& figures) {
  stepBack(behindInterface);
  int told = -1;
  const auto progressFrom = [&](int from) {
    return [&, from](std::uint64_t done, std::uint64_t of) {
      bool wanted = false;
      back->pass([&](RecordingReader&) { wanted = true; });
      if (!wanted) throw BrokenOff();
      const int percent = from + static_cast<int>(50 * done / std::max<std::uint64_t>(1, of));
      if (percent == told) return;
      told = percent;
      tell(back, [percent](RecordingReader& reader) { emit reader.progress(percent); });
    };
  };
  try {
    recorder::Recording recording(file);
    AttemptTrack track = readTrack(recording, progressFrom(0));
    const bool results = track.none.empty();
    tell(back, [track = std::move(track)](RecordingReader& reader) { emit reader.trackRead(track); });
    std::vector<analytics::FigureMoments> moments;
    if (results && !figures.empty()) moments = analytics::findMoments(recording, figures, progressFrom(50));
    tell(back, [moments = std::move(moments)](RecordingReader& reader) { emit reader.momentsFound(moments); });
  } catch (const BrokenOff&) {
    return;
  } catch (const std::exception& error) {
    tell(back,
         [text = QString::fromStdString(problemText(error))](RecordingReader& reader) { emit reader.failed(text); });
  }
}

}  // namespace calot::gui
