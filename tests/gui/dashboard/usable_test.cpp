// SPDX-License-Identifier: GPL-3.0-or-later
// Every page is usable on a small screen, in both colours, with large letters and from the keyboard alone.
#include <gtest/gtest.h>
#include <cmath>

#include <filesystem>
#include <QAbstractButton>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QGroupBox>
#include <QHeaderView>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QTabBar>
#include <QTableView>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QTreeView>
#include <set>

#include "apps/calot-dashboard/assess_program.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/norm_dialog.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;

/// Twelve attempts without recordings on every page.
class Usable : public ::testing::Test {
 protected:
  void SetUp() override {
    test::startApplication();
    settings::setRecordingFolders({});
    analytics::CohortDatabase database(path(), Access::create);
    for (int i = 0; i < 12; ++i)
      database.storeAttempt(test::attemptNumber(i), {test::pathLength("left", 0.1 + 0.01 * i + 0.2 * (i % 2))});
  }
  void TearDown() override { theme::apply(theme::Choice::system, theme::usualType); }
  [[nodiscard]] std::string path() const { return folder_.filePath("c.db").toStdString(); }
  [[nodiscard]] std::unique_ptr<DashboardWindow> opened(const QSize& size = {1366, 768}) const {
    auto window = std::make_unique<DashboardWindow>(
        apps::assessProgram(), std::vector<std::filesystem::path>{std::filesystem::path(CALOT_SOURCE_DIR) / "assets"});
    window->resize(size);
    window->show();
    EXPECT_TRUE(window->openDatabase(QString::fromStdString(path())));
    return window;
  }
  template <class Check>
  static void onEachPage(DashboardWindow& window, Check check) {
    auto* tabs = window.findChild<QTabWidget*>();
    for (int page = 0; page < tabs->count(); ++page) {
      tabs->setCurrentIndex(page);
      QTest::qWait(30);
      check(tabs->tabText(page).toStdString(), *tabs->currentWidget());
    }
  }
  /// Seen, or would be without scrolling.
  static QList<QWidget*> shown(QWidget& page) {
    QList<QWidget*> widgets;
    for (QWidget* widget : page.findChildren<QWidget*>()) {
      if (widget->isVisible()) widgets += widget;
    }
    return widgets;
  }
  QTemporaryDir folder_;
};

/// Text and the colour behind it of everything that shows letters.
std::vector<std::pair<QColor, QColor>> textColours(const QWidget& widget) {
  const QPalette p = widget.palette();
  using Role = QPalette::ColorRole;
  const auto of = [&](Role text, Role ground) {
    return std::pair{p.color(QPalette::Active, text), p.color(QPalette::Active, ground)};
  };
  if (qobject_cast<const QLabel*>(&widget) != nullptr) return {of(QPalette::WindowText, QPalette::Window)};
  if (qobject_cast<const QLineEdit*>(&widget) != nullptr)
    return {of(QPalette::Text, QPalette::Base), of(QPalette::PlaceholderText, QPalette::Base)};
  if (qobject_cast<const QAbstractItemView*>(&widget) != nullptr)
    return {of(QPalette::Text, QPalette::Base), of(QPalette::Text, QPalette::AlternateBase),
            of(QPalette::HighlightedText, QPalette::Highlight)};
  if (qobject_cast<const QAbstractButton*>(&widget) != nullptr || qobject_cast<const QComboBox*>(&widget) != nullptr)
    return {of(QPalette::ButtonText, QPalette::Button)};
  if (qobject_cast<const QGroupBox*>(&widget) != nullptr || qobject_cast<const QTabBar*>(&widget) != nullptr ||
      qobject_cast<const QMenuBar*>(&widget) != nullptr)
    return {of(QPalette::WindowText, QPalette::Window)};
  return {};
}

TEST_F(Usable, ContrastOfEveryTextIsThatOfLevelAA) {
  EXPECT_NEAR(theme::contrast(Qt::black, Qt::white), 21.0, 1e-9);
  EXPECT_NEAR(theme::contrast(QColor(0x77, 0x77, 0x77), Qt::white), 4.48, 0.005) << "as the W3C's tables have it";
  for (const theme::Choice choice : {theme::Choice::system, theme::Choice::light, theme::Choice::dark}) {
    theme::apply(choice, theme::usualType);
    if (choice != theme::Choice::system) {
      EXPECT_EQ(theme::dark(), choice == theme::Choice::dark);
    }
    const std::string name = theme::wordOf(choice).toStdString();
    for (const QColor& colour : {theme::text(), theme::muted(), theme::first(), theme::second(), theme::trouble()})
      EXPECT_GE(theme::contrast(colour, theme::surface()), theme::leastContrast)
          << name << ' ' << colour.name().toStdString();
    for (const auto verdict : {analytics::Verdict::verified, analytics::Verdict::diverged, analytics::Verdict::damaged,
                               analytics::Verdict::notChecked}) {
      for (const auto ground : {QPalette::Base, QPalette::AlternateBase, QPalette::Window})
        EXPECT_GE(theme::contrast(theme::ofVerdict(verdict), QApplication::palette().color(ground)),
                  theme::leastContrast)
            << name;
    }
    const auto window = opened();
    int texts = 0;
    onEachPage(*window, [&](const std::string& page, QWidget& content) {
      for (const QWidget* widget : shown(content)) {
        for (const auto& [text, ground] : textColours(*widget)) {
          ++texts;
          EXPECT_GE(theme::contrast(text, ground), theme::leastContrast)
              << name << ", " << page << ": " << widget->metaObject()->className() << ' '
              << widget->objectName().toStdString() << ' ' << text.name().toStdString() << " on "
              << ground.name().toStdString();
        }
      }
    });
    EXPECT_GT(texts, 100);
  }
}

TEST_F(Usable, EveryPageFitsASmallScreenWithLargeLetters) {
  for (const int type : {100, 150}) {
    for (const theme::Choice choice : {theme::Choice::light, theme::Choice::dark}) {
      theme::apply(choice, type);
      const QSize size(1366, 768);
      const auto window = opened(size);
      onEachPage(*window, [&](const std::string& page, QWidget& content) {
        const std::string at = page + ", " + std::to_string(type) + " %";
        EXPECT_LE(window->minimumSizeHint().width(), size.width()) << at;
        EXPECT_LE(window->minimumSizeHint().height(), size.height()) << at;
        EXPECT_EQ(window->size(), size) << at;
        for (QWidget* widget : shown(content)) {
          const bool control = qobject_cast<QAbstractButton*>(widget) != nullptr ||
                               qobject_cast<QComboBox*>(widget) != nullptr ||
                               qobject_cast<QLineEdit*>(widget) != nullptr;
          bool scrolled = false;
          for (const QWidget* w = widget; w != nullptr; w = w->parentWidget())
            scrolled = scrolled || qobject_cast<const QAbstractScrollArea*>(w) != nullptr;
          if (!control || scrolled) continue;
          const QRect place(widget->mapTo(window.get(), QPoint(0, 0)), widget->size());
          EXPECT_TRUE(QRect(QPoint(0, 0), size).contains(place)) << at << ' ' << widget->objectName().toStdString();
          EXPECT_GE(widget->width(), widget->minimumSizeHint().width())
              << at << ' ' << widget->objectName().toStdString();
          EXPECT_GE(widget->height(), widget->minimumSizeHint().height())
              << at << ' ' << widget->objectName().toStdString();
        }
        // What a page is about has room.
        for (const QWidget* view : content.findChildren<QAbstractItemView*>()) {
          if (!view->isVisible() ||
              (qobject_cast<const QTableView*>(view) == nullptr && qobject_cast<const QTreeView*>(view) == nullptr))
            continue;
          EXPECT_GE(view->height(), 3 * view->fontMetrics().height()) << at << ' ' << view->objectName().toStdString();
        }
      });
    }
  }
}

TEST_F(Usable, PicturesShowLightAndDark) {
  for (const theme::Choice choice : {theme::Choice::light, theme::Choice::dark}) {
    theme::apply(choice, theme::usualType);
    const auto window = opened();
    const QImage picture = window->grab().toImage();
    double light = 0.0;
    int count = 0;
    for (int y = 0; y < picture.height(); y += 7) {
      for (int x = 0; x < picture.width(); x += 7, ++count) light += picture.pixelColor(x, y).lightnessF();
    }
    EXPECT_EQ(light / count < 0.5, choice == theme::Choice::dark);
    EXPECT_EQ(picture.size(), QSize(1366, 768));
  }
}

TEST_F(Usable, AWindowTakesItsSizeFromTheScreen) {
  EXPECT_EQ(theme::windowSizeFor({1366, 740}), QSize(1366, 740)) << "all of a small one";
  EXPECT_EQ(theme::windowSizeFor({1920, 1040}), QSize(1680, 936)) << "most of a usual one";
  EXPECT_EQ(theme::windowSizeFor({3840, 2160}), QSize(1680, 1050));
}

QChar mnemonicOf(const QString& text) {
  for (qsizetype i = 0; i + 1 < text.size(); ++i) {
    if (text[i] != '&') continue;
    if (text[i + 1] != '&') return text[i + 1].toUpper();
    ++i;
  }
  return {};
}

TEST_F(Usable, NoTwoLettersClash) {
  const auto window = opened();
  for (const QAction* menu : window->menuBar()->actions()) {
    std::set<QChar> inMenu;
    for (const QAction* action : menu->menu()->actions()) {
      const QChar letter = mnemonicOf(action->text());
      if (!letter.isNull()) {
        EXPECT_TRUE(inMenu.insert(letter).second) << menu->text().toStdString() << ": " << action->text().toStdString();
      }
    }
  }
  const auto clashes = [&](const std::string& where, QWidget& content, std::set<QChar> letters) {
    const auto take = [&](const QString& text) {
      const QChar letter = mnemonicOf(text);
      if (!letter.isNull()) {
        EXPECT_TRUE(letters.insert(letter).second) << where << ": " << text.toStdString();
      }
    };
    for (const QWidget* widget : shown(content)) {
      if (const auto* label = qobject_cast<const QLabel*>(widget)) {
        if (label->buddy() != nullptr) {
          take(label->text());
        } else if (label->textFormat() != Qt::PlainText) {
          EXPECT_TRUE(mnemonicOf(label->text()).isNull())
              << where << ": an & is shown in " << label->text().toStdString();
        }
      }
      if (const auto* button = qobject_cast<const QAbstractButton*>(widget)) take(button->text());
      if (const auto* box = qobject_cast<const QGroupBox*>(widget)) take(box->title());
      if (const auto* tabs = qobject_cast<const QTabBar*>(widget)) {
        for (int i = 0; i < tabs->count(); ++i) take(tabs->tabText(i));
      }
    }
  };
  std::set<QChar> always;
  for (const QAction* menu : window->menuBar()->actions())
    EXPECT_TRUE(always.insert(mnemonicOf(menu->text())).second) << menu->text().toStdString();
  always.insert('G');  // "Stop importing" may stand beneath any page
  EXPECT_EQ(mnemonicOf(window->findChild<QAbstractButton*>("import-stop")->text()), 'G');
  onEachPage(*window, [&](const std::string& page, QWidget& content) { clashes(page, content, always); });
  SettingsDialog dialog;
  dialog.show();
  clashes("settings", dialog, {});
  NormDialog norm(std::make_shared<const CohortDocument>(path()), {});
  norm.show();
  clashes("norm", norm, {});
}

TEST_F(Usable, TheKeyboardReachesEverything) {
  const auto window = opened();
  window->activateWindow();
  ASSERT_TRUE(QTest::qWaitFor([&] { return window->isActiveWindow(); }, 5000));
  onEachPage(*window, [&](const std::string& page, QWidget& content) {
    QWidget* const begin = QApplication::focusWidget();
    ASSERT_NE(begin, nullptr) << page;
    EXPECT_TRUE(&content == begin || content.isAncestorOf(begin)) << page << " begins elsewhere";
    std::set<QWidget*> reached;
    for (int i = 0; i < 300; ++i) {
      QWidget* const now = QApplication::focusWidget();
      if (!reached.insert(now).second) break;
      QTest::keyClick(now, Qt::Key_Tab);
    }
    for (QWidget* widget : shown(content)) {
      const bool control = qobject_cast<QComboBox*>(widget) != nullptr || qobject_cast<QLineEdit*>(widget) != nullptr ||
                           qobject_cast<QAbstractButton*>(widget) != nullptr ||
                           qobject_cast<QSlider*>(widget) != nullptr || qobject_cast<QTableView*>(widget) != nullptr ||
                           qobject_cast<QTreeView*>(widget) != nullptr || widget->objectName().endsWith("-chart") ||
                           widget->objectName() == "timeline";
      const bool inner = qobject_cast<QHeaderView*>(widget) != nullptr ||
                         qobject_cast<QComboBox*>(widget->parentWidget()) != nullptr ||
                         qobject_cast<QLineEdit*>(widget->parentWidget()) != nullptr ||
                         qobject_cast<QTableView*>(widget->parentWidget()) != nullptr ||
                         qobject_cast<QTabBar*>(widget->parentWidget()) != nullptr ||
                         widget->objectName() == "roc-chart";
      // Of buttons that exclude each other one is reached, the others by arrows.
      const auto* button = qobject_cast<QAbstractButton*>(widget);
      if (!control || inner || !widget->isEnabled() || (button != nullptr && button->autoExclusive())) continue;
      EXPECT_TRUE(reached.count(widget) > 0)
          << page << ": " << widget->metaObject()->className() << ' ' << widget->objectName().toStdString();
    }
  });
}

TEST_F(Usable, TheWindowOfANormFitsASmallScreenAndIsReachedByKeys) {
  for (const theme::Choice choice : {theme::Choice::light, theme::Choice::dark}) {
    theme::apply(choice, 150);
    NormDialog norm(std::make_shared<const CohortDocument>(path()), {});
    const QSize size(1366, 768);
    EXPECT_LE(norm.minimumSizeHint().width(), size.width());
    EXPECT_LE(norm.minimumSizeHint().height(), size.height());
    norm.show();
    norm.resize(size);
    norm.activateWindow();
    ASSERT_TRUE(QTest::qWaitFor([&] { return norm.settled() && norm.isActiveWindow(); }, 20000));
    std::set<QWidget*> reached;
    for (int i = 0; i < 200 && reached.insert(QApplication::focusWidget()).second; ++i)
      QTest::keyClick(QApplication::focusWidget(), Qt::Key_Tab);
    int controls = 0;
    for (QWidget* widget : shown(norm)) {
      for (const auto& [text, ground] : textColours(*widget))
        EXPECT_GE(theme::contrast(text, ground), theme::leastContrast) << widget->objectName().toStdString();
      const bool control = qobject_cast<QAbstractButton*>(widget) != nullptr ||
                           qobject_cast<QLineEdit*>(widget) != nullptr || qobject_cast<QSlider*>(widget) != nullptr ||
                           (qobject_cast<QComboBox*>(widget) != nullptr);
      const bool inner =
          widget->objectName() == "qt_spinbox_lineedit" || qobject_cast<QTableView*>(widget->parentWidget()) != nullptr;
      if (!control || inner || !widget->isEnabled()) continue;
      ++controls;
      EXPECT_TRUE(reached.count(widget) > 0) << widget->objectName().toStdString();
      EXPECT_FALSE(qobject_cast<QSlider*>(widget) != nullptr && widget->accessibleName().isEmpty());
    }
    EXPECT_GT(controls, 15);
    EXPECT_TRUE(reached.count(norm.findChild<QTableView*>("norm-members")) > 0);
  }
}

TEST_F(Usable, TheHelpMenuNamesEveryKeyOfTheMenus) {
  const auto window = opened();
  const KeyList keys = keysOf(*window->menuBar());
  for (const QAction* menu : window->menuBar()->actions()) {
    for (const QAction* action : menu->menu()->actions()) {
      if (action->shortcut().isEmpty()) continue;
      const QString key = action->shortcut().toString(QKeySequence::NativeText);
      EXPECT_EQ(std::count_if(keys.begin(), keys.end(), [&](const auto& k) { return k.first == key; }), 1)
          << key.toStdString();
    }
  }
  EXPECT_EQ(window->menuBar()->actions().back()->text(), "&Help");
  EXPECT_TRUE(std::any_of(keys.begin(), keys.end(), [](const auto& k) { return k.first == "F1"; }));
}

}  // namespace
}  // namespace calot::gui
