// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/watermark.h"

#include <gtest/gtest.h>

#include <QGraphicsItem>
#include <QGraphicsScene>
#include <QSize>

#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

TEST(Watermark, IsWholeInAChartOfAnySize) {
  test::startApplication();
  QGraphicsScene scene;
  Watermark watermark(scene);
  EXPECT_FALSE(watermark.isVisible());
  watermark.setVisible(true);
  ASSERT_EQ(scene.items().size(), 1);
  const QGraphicsItem& item = *scene.items().first();
  for (const QSize size : {QSize(1200, 700), QSize(480, 300), QSize(200, 600), QSize(60, 40)}) {
    watermark.place(size);
    const QRectF box = item.sceneBoundingRect();
    EXPECT_TRUE(QRectF(QPointF(), size).contains(box)) << size.width() << " x " << size.height();
    EXPECT_NEAR(box.center().x(), 0.5 * size.width(), 1.0);
    EXPECT_NEAR(box.center().y(), 0.5 * size.height(), 1.0);
  }
  watermark.place({1200, 700});
  const double large = item.sceneBoundingRect().width();
  watermark.place({4800, 2800});
  EXPECT_NEAR(item.sceneBoundingRect().width(), large, 1e-6) << "no larger than it is made";
}

}  // namespace
}  // namespace calot::gui
