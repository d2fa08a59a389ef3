// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dot_chart.h"

#include <algorithm>
#include <cmath>
#include <QGraphicsScene>
#include <QKeyEvent>
#include <QtCharts/QLegend>
#include <QtCharts/QLegendMarker>
#include <QToolTip>

#include "gui/attempt/theme.h"

namespace calot::gui {

DotChart::DotChart(const char* name, const char* spokenName, QWidget* parent)
    : QChartView(parent), watermark_(*scene()) {
  setObjectName(name);
  setAccessibleName(spokenName);
  setRenderHint(QPainter::Antialiasing);
  setFocusPolicy(Qt::StrongFocus);
  chart()->setMargins(QMargins(8, 8, 8, 8));
  chart()->legend()->setAlignment(Qt::AlignBottom);
  dress(*chart());
}

void DotChart::clearChart() {
  chart()->removeAllSeries();
  for (QAbstractAxis* axis : chart()->axes()) {
    chart()->removeAxis(axis);
    delete axis;
  }
  dots_.clear();
  across_ = up_ = nullptr;
  measure_ = nullptr;
  chosenMark_ = nullptr;
  chosen_ = -1;
  watermark_.setVisible(false);
}

void DotChart::addAxes(QAbstractAxis* across, QAbstractAxis* up) {
  across_ = across;
  up_ = up;
  chart()->addAxis(across, Qt::AlignBottom);
  chart()->addAxis(up, Qt::AlignLeft);
}

void DotChart::addSeries(QAbstractSeries* series) {
  chart()->addSeries(series);
  series->attachAxis(across_);
  series->attachAxis(up_);
  measure_ = series;
}

void DotChart::addDots(QScatterSeries* series, const std::vector<Dot>& dots) {
  for (const Dot& dot : dots) {
    series->append(dot.at);
    dots_.push_back(dot);
  }
  addSeries(series);
  connect(series, &QScatterSeries::clicked, this, [this](const QPointF& value) {
    if (const Dot* dot = dotAt(value); dot != nullptr && !dot->attempt.isEmpty()) emit attemptChosen(dot->attempt);
  });
  connect(series, &QScatterSeries::hovered, this, [this](const QPointF& value, bool on) {
    const Dot* dot = dotAt(value);
    if (on && dot != nullptr)
      QToolTip::showText(mapToGlobal(placeOf(*dot).toPoint()), dot->text, this);
    else
      QToolTip::hideText();
  });
}

void DotChart::finishChart(bool synthetic) {
  chosenMark_ = new QScatterSeries;
  chosenMark_->setMarkerSize(18.0);
  chosenMark_->setColor(Qt::transparent);
  chosenMark_->setBorderColor(theme::text());
  if (across_ != nullptr)
    addSeries(chosenMark_);
  else
    chart()->addSeries(chosenMark_);
  for (QLegendMarker* marker : chart()->legend()->markers(chosenMark_)) marker->setVisible(false);
  std::stable_sort(dots_.begin(), dots_.end(), [](const Dot& a, const Dot& b) {
    return a.at.x() != b.at.x() ? a.at.x() < b.at.x() : a.at.y() < b.at.y();
  });
  watermark_.setVisible(synthetic);
  dress(*chart());
}

QValueAxis* DotChart::valueAxis(double lower, double upper, const QString& unit) {
  auto* axis = new QValueAxis;
  const AxisSpan span = axisSpan(lower, upper);
  axis->setTitleText(unit);
  axis->setRange(span.from, span.to);
  axis->setTickType(QValueAxis::TicksDynamic);
  axis->setTickAnchor(0.0);
  axis->setTickInterval(span.interval);
  const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(span.interval) + 1e-9)), 0, 6);
  axis->setLabelFormat(QString("%.%1f").arg(decimals));
  return axis;
}

QPointF DotChart::placeOf(const Dot& dot) const {
  return mapFromScene(chart()->mapToScene(chart()->mapToPosition(dot.at, measure_)));
}

const DotChart::Dot* DotChart::dotAt(const QPointF& value) const {
  const auto at = std::find_if(dots_.begin(), dots_.end(), [&](const Dot& dot) { return dot.at == value; });
  return at == dots_.end() ? nullptr : &*at;
}

void DotChart::choose(int dot) {
  chosen_ = dot;
  chosenMark_->clear();
  if (dot < 0) return;
  const Dot& shown = dots_[static_cast<std::size_t>(dot)];
  chosenMark_->append(shown.at);
  setAccessibleDescription(shown.text);
  QToolTip::showText(mapToGlobal(placeOf(shown).toPoint()), shown.text, this);
}

void DotChart::keyPressEvent(QKeyEvent* event) {
  const int last = static_cast<int>(dots_.size()) - 1;
  const int key = event->key();
  if (last >= 0 && (key == Qt::Key_Right || key == Qt::Key_Down)) {
    choose(std::min(last, chosen_ + 1));
  } else if (last >= 0 && (key == Qt::Key_Left || key == Qt::Key_Up)) {
    choose(std::max(0, chosen_ - 1));
  } else if (chosen_ >= 0 && (key == Qt::Key_Return || key == Qt::Key_Enter)) {
    const QString uuid = dots_[static_cast<std::size_t>(chosen_)].attempt;
    if (!uuid.isEmpty()) emit attemptChosen(uuid);
  } else {
    QChartView::keyPressEvent(event);
  }
}

void DotChart::changeEvent(QEvent* event) {
  QChartView::changeEvent(event);
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) redraw();
}

void DotChart::resizeEvent(QResizeEvent* event) {
  QChartView::resizeEvent(event);
  watermark_.place(size());
}

}  // namespace calot::gui
