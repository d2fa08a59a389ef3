// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QSlider>
#include <QString>
#include <vector>

namespace calot::gui {

/// Places of a pass mark along an axis: round numbers, close enough that two of them differ by less than a hundredth of
/// the values' range; whole ones for counts.
class MarkScale {
 public:
  MarkScale() = default;
  /// Holds all values with a margin. @pre they are finite
  MarkScale(const std::vector<double>& values, bool whole);
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] double at(int position) const;
  [[nodiscard]] int nearest(double value) const;  ///< within [0, steps()]

 private:
  double multiple_ = 1.0;  ///< 1, 2 or 5
  int exponent_ = 0;       ///< of ten
  double first_ = 0.0;     ///< in steps from zero
  int steps_ = 1;
};

/// Members' values of a figure as dots, competent ones above the others, and its pass mark as a line that is moved like
/// a slider: by the mouse, and by arrows, Page Up and Down, Home and End. Emits valueChanged() only where a person
/// moves it.
class MarkSlider : public QSlider {
  Q_OBJECT
 public:
  struct Dot {
    double value = 0.0;
    bool competent = false;
  };
  struct View {
    std::vector<Dot> dots;
    bool whole = false;            ///< counts
    bool lowerIsBetter = true;     ///< values up to the mark pass
    std::optional<double> mark;    ///< none until a first move sets it
    std::optional<double> before;  ///< the mark that the members give, where a person set another
    double start = 0.0;            ///< where a mark begins that is not there yet
  };
  MarkSlider(const QString& name, const QString& spokenName);
  void show(View view);
  [[nodiscard]] double markedValue() const { return scale_.at(value()); }
  [[nodiscard]] const View& view() const { return view_; }
  /// Position of a value on the widget, in pixels.
  [[nodiscard]] double placeOf(double value) const;

  [[nodiscard]] QSize sizeHint() const override;
  [[nodiscard]] QSize minimumSizeHint() const override { return sizeHint(); }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;

 private:
  void moveTo(double pixel);
  [[nodiscard]] double left() const;
  [[nodiscard]] double right() const;

  View view_;
  MarkScale scale_;
};

}  // namespace calot::gui
