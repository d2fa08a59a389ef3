// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_overlay.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <QAccessible>
#include <QPainter>
#include <QPainterPath>

#include "gui/attempt/widget_parts.h"
#include "gui/render/draw_list.h"

namespace calot::gui {
namespace {

constexpr int errorTime = 5000;       // ms that an error is shown
constexpr double oneDirection = 0.9;  // cosine between arrows that would cover each other

// White letters on these keep a contrast of 4.5 (WCAG 2.1); Okabe and Ito's vermilion, orange and blue, darkened.
QColor groundOf(Severity severity) {
  if (severity == Severity::critical) return QColor(0xa8, 0x32, 0x00);
  return severity == Severity::major ? QColor(0x7a, 0x52, 0x00) : QColor(0x00, 0x4f, 0x80);
}

void drawArrow(QPainter& painter, QPointF at, QPointF towards, double size, QChar letter) {
  painter.save();
  painter.translate(at);
  painter.rotate(std::atan2(towards.y(), towards.x()) * 180.0 / std::numbers::pi);
  QPainterPath head;
  head.moveTo(size, 0.0);
  head.lineTo(-0.4 * size, 0.8 * size);
  head.lineTo(-0.4 * size, -0.8 * size);
  head.closeSubpath();
  painter.setPen(QPen(Qt::black, 2.0));
  painter.setBrush(QColor(0xf0, 0xe4, 0x42));
  painter.drawPath(head);
  painter.restore();
  painter.setPen(Qt::black);
  painter.drawText(QRectF(at.x() - size, at.y() - size, 2.0 * size, 2.0 * size), Qt::AlignCenter, letter);
}

}  // namespace

std::optional<QPointF> directionOutside(const Vec3& tip, QSizeF size, double verticalFieldOfView) {
  const double up = std::tan(0.5 * verticalFieldOfView), aside = up * size.width() / size.height();
  // In halves of the picture's height, as its round field is measured.
  const double depth = std::max(tip.z(), 1e-3);
  const QPointF seen(tip.x() / (depth * up), tip.y() / (depth * up));
  const double distance = std::hypot(seen.x(), seen.y());
  const auto width = static_cast<int>(size.width()), height = static_cast<int>(size.height());
  const double rim = 2.0 * static_cast<double>(sightOf(width, height, verticalFieldOfView, true).rim) / size.height();
  const bool within = tip.z() > 0.0 && distance < rim && std::abs(seen.x()) < aside / up && std::abs(seen.y()) < 1.0;
  if (within) return std::nullopt;
  return distance > 0.0 ? seen / distance : QPointF(0.0, 1.0);
}

PictureOverlay::PictureOverlay(QWidget* picture) : QWidget(picture) {
  auto* const title = parts::plainLabel("sheetTitle", false);
  title->setText("Learn the controls");
  parts::embolden(title);
  auto* const skips = parts::plainLabel("skips", false);
  skips->setText("Ctrl+K skips a control, Ctrl+E ends");
  sheet_ = parts::sheet(parts::column({parts::row({title, parts::spring(), skips})}));
  sheet_->hide();
  setLayout(parts::column({parts::row({parts::spring(), {sheet_, 2}, parts::spring()}), parts::spring()}));
  setAttribute(Qt::WA_TransparentForMouseEvents);
  setObjectName("over");
  errorShown_.setSingleShot(true);
  connect(&errorShown_, &QTimer::timeout, this, &PictureOverlay::clearError);
}

void PictureOverlay::showCount(const QString& text) {
  if (count_ == text) return;
  count_ = text;
  update();
}

void PictureOverlay::showSentence(const QString& text) {
  if (sentence_ == text) return;
  sentence_ = text;
  update();
}

void PictureOverlay::showError(const analytics::ErrorLine& error) {
  severity_ = error.severity;
  error_ = QString::fromStdString(analytics::nameOf(error.severity) + std::string(": ") + error.text);
  error_[0] = error_[0].toUpper();
  errorShown_.start(errorTime);
  setAccessibleName(error_);
  QAccessibleEvent alert(this, QAccessible::Alert);
  QAccessible::updateAccessibility(&alert);
  update();
}

void PictureOverlay::clearError() {
  error_.clear();
  setAccessibleName({});
  update();
}

void PictureOverlay::showInstruments(const AttemptFigures* figures, double verticalFieldOfView) {
  std::array<std::optional<QPointF>, handCount> arrows;
  for (std::size_t h = 0; h < handCount && figures != nullptr; ++h) {
    const AttemptFigures::Hand& hand = figures->hand[h];
    if (hand.instrument != InstrumentKind::none) arrows[h] = directionOutside(hand.tip, size(), verticalFieldOfView);
  }
  if (arrows == arrow_) return;
  arrow_ = arrows;
  update();
}

void PictureOverlay::paintEvent(QPaintEvent* /*event*/) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  QFont font = painter.font();
  font.setBold(true);
  if (!count_.isEmpty()) {
    painter.fillRect(rect(), QColor(0, 0, 0, 120));
    QFont large = font;
    large.setPointSizeF(6.0 * font.pointSizeF());
    painter.setFont(large);
    painter.setPen(Qt::white);
    painter.drawText(rect(), Qt::AlignCenter, count_);
  }
  painter.setFont(font);
  const double size = 1.2 * QFontMetricsF(font).height();
  const QPointF middle = QRectF(rect()).center();
  const double radius = std::min(middle.x(), middle.y()) - 1.5 * size;
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!arrow_[h]) continue;
    // If both lie in one direction the second stands behind the first.
    const bool behind = h > 0 && arrow_[0] && QPointF::dotProduct(*arrow_[0], *arrow_[h]) > oneDirection;
    const double ring = radius - (behind ? 2.2 * size : 0.0);
    drawArrow(painter, middle + *arrow_[h] * ring, *arrow_[h], size, h == 0 ? 'L' : 'R');
  }
  const QString& words = error_.isEmpty() ? sentence_ : error_;
  if (words.isEmpty()) return;
  const QRectF limits = QRectF(rect()).adjusted(0.1 * width(), 0.5 * height(), -0.1 * width(), -0.04 * height());
  constexpr int flags = Qt::AlignHCenter | Qt::AlignBottom | Qt::TextWordWrap;
  QFont larger = font;
  larger.setPointSizeF(1.4 * font.pointSizeF());
  painter.setFont(larger);
  const QRectF text = painter.boundingRect(limits, flags, words);
  painter.setPen(Qt::NoPen);
  painter.setBrush(error_.isEmpty() ? QColor(0x20, 0x28, 0x30) : groundOf(severity_));
  painter.drawRoundedRect(text.adjusted(-14.0, -8.0, 14.0, 8.0), 6.0, 6.0);
  painter.setPen(Qt::white);
  painter.drawText(text, flags, words);
}

}  // namespace calot::gui
