// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/timeline.h"

#include <cmath>
#include <map>
#include <QEvent>
#include <QHelpEvent>
#include <QKeyEvent>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>

#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

int phaseTop() { return 4; }
int phaseHeight() { return theme::inType(20); }
// Lanes below the phases: errors by severity, the gravest first, then what else happened.
constexpr int laneCount = static_cast<int>(severityCount) + 1;
int laneHeight() { return theme::inType(14); }
int laneTop(int lane) { return phaseTop() + phaseHeight() + 4 + lane * laneHeight(); }
int laneOf(const TrackEvent& event) {
  return event.severity ? static_cast<int>(Severity::critical) - static_cast<int>(*event.severity) : laneCount - 1;
}
constexpr double reach = 5.0;  // pixels from an event that still count as on it

/// Okabe and Ito's colours, distinguished by people with any of the common colour-vision deficiencies; the name stands
/// in the stretch.
QColor colourOf(Phase phase) {
  static const std::map<Phase, QColor> colours{{Phase::identification, {0x56, 0xb4, 0xe9}},
                                               {Phase::clipping, {0xe6, 0x9f, 0x00}},
                                               {Phase::cutting, {0xf0, 0xe4, 0x42}},
                                               {Phase::dissection, {0x7f, 0xd0, 0xb8}}};
  const auto at = colours.find(phase);
  return at != colours.end() ? at->second : QColor(0xd8, 0xd8, 0xd8);
}

QColor colourOf(const TrackEvent& event) {
  if (!event.severity) return event.error ? theme::second() : theme::first();
  return *event.severity == Severity::critical ? theme::trouble()
         : *event.severity == Severity::major  ? theme::second()
                                               : theme::muted();
}

void paintEvents(QPainter& painter, const TimeScale& scale, const std::vector<TrackEvent>& events) {
  const double height = laneHeight();
  for (const TrackEvent& event : events) {
    const double x = scale.x(event.time), top = laneTop(laneOf(event));
    if (event.severity) {
      painter.setPen(QPen(theme::surface(), 0.8));
      painter.setBrush(colourOf(event));
      painter.drawPolygon(QPolygonF{{QPointF(x, top + 1.0), QPointF(x - 0.45 * height, top + height - 1.0),
                                     QPointF(x + 0.45 * height, top + height - 1.0)}});
    } else {
      painter.setPen(QPen(colourOf(event), 2.0));
      painter.drawLine(QPointF(x, top + 2.0), QPointF(x, top + height - 2.0));
    }
  }
}

/// "1:20": minutes and seconds.
QString clockText(double seconds) {
  const int whole = static_cast<int>(std::lround(seconds));
  return QString("%1:%2").arg(whole / 60).arg(whole % 60, 2, 10, QChar('0'));
}

double topMargin() { return theme::inType(18); }
double bottomMargin() { return theme::inType(16); }
constexpr double headroom = 1.15;  // of the highest number, so that a line along it is seen

double timeInterval(double seconds) {
  if (seconds > 1200.0) return 300.0;
  if (seconds > 240.0) return 60.0;
  if (seconds > 60.0) return 20.0;
  return seconds > 20.0 ? 5.0 : 1.0;
}

}  // namespace

QSize TimelineBar::sizeHint() const { return {600, laneTop(laneCount) + 4}; }

TimelineBar::TimelineBar() {
  setObjectName("timeline");
  setAccessibleName("Timeline of phases and events");
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setToolTip("Left and Right go from event to event");
}

void TimelineBar::setTrack(AttemptTrack track) {
  track_ = std::move(track);
  marked_.clear();
  update();
}

void TimelineBar::setText(const QString& text) {
  AttemptTrack nothing;
  nothing.none = text.toStdString();
  setTrack(std::move(nothing));
}

void TimelineBar::setPosition(double time) {
  position_ = time;
  update();
}

void TimelineBar::setMarked(std::vector<std::pair<double, double>> windows) {
  marked_ = std::move(windows);
  update();
}

void TimelineBar::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const TimeScale s = scale();
  for (const TrackPhase& phase : track_.phases) {
    const QRectF box(s.x(phase.begin), phaseTop(), s.x(phase.end) - s.x(phase.begin), phaseHeight());
    painter.fillRect(box, colourOf(phase.phase));
    const QString name = QString::fromStdString(wordFor(phase.phase));
    painter.setPen(QColor(0x22, 0x22, 0x22));
    if (painter.fontMetrics().horizontalAdvance(name) + 6 < box.width()) painter.drawText(box, Qt::AlignCenter, name);
    painter.setPen(QPen(theme::surface(), 1.0));
    painter.drawLine(box.topRight(), box.bottomRight());
  }
  if (!track_.none.empty()) {
    painter.setPen(theme::muted());
    painter.drawText(rect().adjusted(12, 0, -12, 0), Qt::AlignCenter | Qt::TextWordWrap,
                     QString::fromStdString(track_.none));
    return;
  }
  if (track_.seconds <= 0.0) return;
  painter.setPen(theme::muted());
  painter.drawText(QRectF(4, phaseTop(), TimeScale::leftMargin() - 10, phaseHeight()),
                   Qt::AlignVCenter | Qt::AlignRight, "Phases");
  for (int lane = 0; lane < laneCount; ++lane) {
    static constexpr const char* titles[laneCount] = {"Critical", "Major", "Minor", "Events"};
    painter.setPen(theme::muted());
    painter.drawText(QRectF(4, laneTop(lane), TimeScale::leftMargin() - 10, laneHeight()),
                     Qt::AlignVCenter | Qt::AlignRight, titles[lane]);
    painter.setPen(QPen(theme::grid(), 1.0));
    painter.drawLine(QPointF(s.x(0.0), laneTop(lane) + laneHeight()),
                     QPointF(s.x(track_.seconds), laneTop(lane) + laneHeight()));
  }
  for (const auto& [begin, end] : marked_) {
    painter.fillRect(QRectF(s.x(begin), laneTop(0), std::max(3.0, s.x(end) - s.x(begin)), laneCount * laneHeight()),
                     QColor(0xcc, 0x79, 0xa7, 120));
  }
  paintEvents(painter, s, track_.events);
  painter.setPen(QPen(theme::text(), 1.5));
  painter.drawLine(QPointF(s.x(position_), 0), QPointF(s.x(position_), height()));
  if (hasFocus()) {
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(QPalette::Highlight), 2.0));
    painter.drawRect(rect().adjusted(1, 1, -1, -1));
  }
}

void TimelineBar::keyPressEvent(QKeyEvent* event) {
  const bool forward = event->key() == Qt::Key_Right;
  if (track_.seconds <= 0.0 || (!forward && event->key() != Qt::Key_Left)) {
    QWidget::keyPressEvent(event);
    return;
  }
  constexpr double apart = 0.05;  // s: pictures stand at ends of steps
  const TrackEvent* next = nullptr;
  for (const TrackEvent& e : track_.events) {
    if (forward ? e.time <= position_ + apart : e.time >= position_ - apart) continue;
    if (next == nullptr || (forward ? e.time < next->time : e.time > next->time)) next = &e;
  }
  if (next == nullptr) return;
  setAccessibleDescription(QString::fromStdString(timeText(next->time) + "  " + next->text));
  emit timeChosen(next->time);
}

const TrackEvent* TimelineBar::eventAt(const QPoint& at) const {
  const int lane = (at.y() - laneTop(0)) / laneHeight();
  if (at.y() < laneTop(0) || lane >= laneCount) return nullptr;
  const TimeScale s = scale();
  const TrackEvent* best = nullptr;
  double nearest = reach;
  for (const TrackEvent& event : track_.events) {
    const double away = std::abs(s.x(event.time) - at.x());
    if (laneOf(event) != lane || away > nearest) continue;
    best = &event;
    nearest = away;
  }
  return best;
}

void TimelineBar::mousePressEvent(QMouseEvent* event) {
  if (track_.seconds <= 0.0 || event->button() != Qt::LeftButton) return;
  const TrackEvent* const hit = eventAt(event->pos());
  emit timeChosen(hit != nullptr ? hit->time : scale().time(event->position().x()));
}

void TimelineBar::mouseMoveEvent(QMouseEvent* event) {
  if (track_.seconds <= 0.0) return;
  setCursor(eventAt(event->pos()) != nullptr ? Qt::PointingHandCursor : Qt::ArrowCursor);
  if (event->buttons().testFlag(Qt::LeftButton)) emit timeChosen(scale().time(event->position().x()));
}

bool TimelineBar::event(QEvent* event) {
  if (event->type() == QEvent::ToolTip) {
    const auto* help = static_cast<QHelpEvent*>(event);
    if (const TrackEvent* hit = eventAt(help->pos()))
      QToolTip::showText(help->globalPos(), QString::fromStdString(timeText(hit->time) + "  " + hit->text), this);
    else
      QToolTip::hideText();
    return true;
  }
  return QWidget::event(event);
}

double axisTop(double largest) {
  if (largest <= 0.0) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(largest)));
  for (const double factor : {1.0, 2.0, 4.0, 5.0, 8.0}) {
    if (largest <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

TraceChart::TraceChart(const QString& name, QString title) : title_(std::move(title)) {
  setObjectName(name);
  setAccessibleName(title_);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  QFont small = font();
  small.setPointSizeF(0.85 * small.pointSizeF());
  setFont(small);
}

void TraceChart::setTraces(double seconds, double bin, std::array<std::vector<double>, handCount> values) {
  seconds_ = seconds;
  bin_ = bin;
  values_ = std::move(values);
  double largest = 0.0;
  for (const std::vector<double>& trace : values_) {
    for (const double value : trace) largest = std::max(largest, value);
  }
  top_ = axisTop(largest);
  painted_ = {};
  update();
}

void TraceChart::setPosition(double time) {
  if (time == position_) return;
  position_ = time;
  update();
}

QRectF TraceChart::plot() const {
  // Its bottom is the middle of a row of pixels: a hand at rest is one clear line.
  return {TimeScale::leftMargin(), topMargin(), scale().span(),
          std::max(10.0, height() - topMargin() - bottomMargin() - 0.5)};
}

void TraceChart::paintAxes(QPainter& painter) const {
  const QRectF box = plot();
  painter.setPen(theme::text());
  painter.drawText(QRectF(0, 0, width(), topMargin()), Qt::AlignCenter, title_);
  const QPen grid(theme::grid(), 1.0);
  const int decimals = top_ < 1.0 ? 2 : top_ < 10.0 ? 1 : 0;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double y = box.bottom() - share / headroom * box.height();
    painter.setPen(grid);
    painter.drawLine(QPointF(box.left(), y), QPointF(box.right(), y));
    painter.setPen(theme::text());
    painter.drawText(QRectF(0, y - 10.0, box.left() - 6.0, 20.0), Qt::AlignRight | Qt::AlignVCenter,
                     QLocale().toString(share * top_, 'f', decimals));
  }
  if (seconds_ <= 0.0) return;
  const double interval = timeInterval(seconds_);
  for (int n = 0; n * interval <= seconds_; ++n) {
    const double x = scale().x(n * interval);
    painter.setPen(grid);
    painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()));
    painter.setPen(theme::text());
    painter.drawText(QRectF(x - 40.0, box.bottom(), 80.0, bottomMargin()), Qt::AlignCenter, clockText(n * interval));
  }
}

void TraceChart::paintTrace(QPainter& painter, std::size_t hand) const {
  const QRectF box = plot();
  QPolygonF line;
  line.reserve(static_cast<qsizetype>(values_[hand].size()));
  for (std::size_t i = 0; i < values_[hand].size(); ++i) {
    const double time = std::min(seconds_, (static_cast<double>(i) + 0.5) * bin_);
    line.append({scale().x(time), box.bottom() - values_[hand][i] / (headroom * top_) * box.height()});
  }
  // Qt strokes lines of a pixel twenty times as fast as wider ones.
  QPen pen(hand == 0 ? theme::first() : theme::second(), 1.0);
  pen.setCosmetic(true);
  if (hand == 1) pen.setStyle(Qt::DashLine);
  painter.setPen(pen);
  painter.drawPolyline(line);
}

void TraceChart::paintEvent(QPaintEvent*) {
  if (painted_.isNull()) {
    const double ratio = devicePixelRatioF();
    painted_ = QPixmap((QSizeF(size()) * ratio).toSize());
    painted_.setDevicePixelRatio(ratio);
    painted_.fill(theme::surface());
    QPainter painter(&painted_);
    painter.setFont(font());
    paintAxes(painter);
    painter.setRenderHint(QPainter::Antialiasing);
    for (std::size_t hand = 0; hand < handCount; ++hand) paintTrace(painter, hand);
  }
  QPainter painter(this);
  painter.drawPixmap(0, 0, painted_);
  if (seconds_ <= 0.0) return;
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(theme::text(), 1.5));
  const double x = std::floor(scale().x(position_)) + 0.5;  // one black column, not two grey ones
  painter.drawLine(QPointF(x, plot().top()), QPointF(x, plot().bottom()));
}

void TraceChart::resizeEvent(QResizeEvent*) { painted_ = {}; }

void TraceChart::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) painted_ = {};
}

void TraceChart::mousePressEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->button() == Qt::LeftButton) emit timeChosen(scale().time(event->position().x()));
}

void TraceChart::mouseMoveEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->buttons().testFlag(Qt::LeftButton)) emit timeChosen(scale().time(event->position().x()));
}

}  // namespace calot::gui
