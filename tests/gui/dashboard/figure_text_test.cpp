// SPDX-License-Identifier: GPL-3.0-or-later
// Values of checkpoints in windows: in the user's locale, counts whole.
#include "gui/attempt/figure_text.h"

#include <gtest/gtest.h>
#include <QLocale>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/figure_number.h"

namespace calot::gui {
namespace {

TEST(FigureText, writesWholeWhatTheCommandLineWritesWhole) {
  const QLocale before;
  for (const QLocale& locale : {QLocale::c(), QLocale(QLocale::German, QLocale::Germany)}) {
    QLocale::setDefault(locale);
    for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
      const analytics::CheckpointDefinition& d = entry.definition;
      for (const double shown : {0.0, 2.0, 2.5}) {
        const analytics::CheckpointValue value =
            analytics::makeValue(d, "", analytics::Origin::resimulated, shown / d.displayFactor);
        const QString number = valueText(value).section(' ', 0, 0);
        EXPECT_DOUBLE_EQ(locale.toDouble(number), shown) << d.name;
        EXPECT_EQ(number.contains(locale.decimalPoint()),
                  QString::fromStdString(analytics::figureNumber(&d, shown)).contains('.'))
            << d.name << ' ' << number.toStdString();
      }
    }
  }
  QLocale::setDefault(before);
}

}  // namespace
}  // namespace calot::gui
