// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dashboard_window.h"

#include <QBoxLayout>
#include <QCoreApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QMenuBar>
#include <QStackedWidget>
#include <QTabWidget>

#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/compare_page.h"
#include "gui/dashboard/greeting_page.h"
#include "recorder/errors.h"

namespace calot::gui {

DashboardWindow::DashboardWindow(QWidget* parent)
    : QMainWindow(parent),
      problem_(new QLabel),
      stack_(new QStackedWidget),
      greeting_(new GreetingPage),
      tabs_(new QTabWidget),
      attempts_(new AttemptsPage),
      compare_(new ComparePage) {
  setWindowTitle("Calot");
  resize(1280, 800);
  problem_->setObjectName("problem");
  problem_->setTextFormat(Qt::PlainText);
  problem_->setWordWrap(true);
  problem_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  problem_->setStyleSheet(
      "QLabel { background: #fbe3d6; color: #5a1e00; border-left: 6px solid #d55e00; padding: 8px; }");
  problem_->hide();
  tabs_->addTab(attempts_, "&Attempts");
  tabs_->addTab(compare_, "Com&pare");
  stack_->addWidget(greeting_);
  stack_->addWidget(tabs_);
  auto* centre = new QWidget;
  auto* layout = new QVBoxLayout(centre);
  layout->addWidget(problem_);
  layout->addWidget(stack_, 1);
  setCentralWidget(centre);
  buildMenus();
  connect(greeting_, &GreetingPage::openRequested, this, &DashboardWindow::askForDatabase);
  connect(attempts_, &AttemptsPage::problem, this, &DashboardWindow::showProblem);
  connect(compare_, &ComparePage::problem, this, &DashboardWindow::showProblem);
}

DashboardWindow::~DashboardWindow() = default;

void DashboardWindow::buildMenus() {
  const auto add = [this](QMenu* menu, const char* text, const QKeySequence& keys, auto action) {
    QAction* const made = menu->addAction(text);
    made->setShortcut(keys);
    connect(made, &QAction::triggered, this, action);
  };
  QMenu* const file = menuBar()->addMenu("&File");
  add(file, "&Open …", QKeySequence::Open, [this] { askForDatabase(); });
  add(file, "&Quit", QKeySequence(Qt::CTRL | Qt::Key_Q), [this] { close(); });
  QMenu* const view = menuBar()->addMenu("&View");
  add(view, "&Attempts", QKeySequence(Qt::CTRL | Qt::Key_1), [this] { tabs_->setCurrentWidget(attempts_); });
  add(view, "&Compare", QKeySequence(Qt::CTRL | Qt::Key_2), [this] { tabs_->setCurrentWidget(compare_); });
  add(view, "&Find", QKeySequence::Find, [this] {
    tabs_->setCurrentWidget(attempts_);
    attempts_->focusSearch();
  });
  add(view, "&Reload", QKeySequence(Qt::Key_F5), [this] { reload(); });
}

void DashboardWindow::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  problem_->hide();
  const QString name = QFileInfo(QString::fromStdString(document_->path())).fileName();
  setWindowTitle(name + " – Calot");
  attempts_->setDocument(document_);
  compare_->setDocument(document_);
  if (document_->attempts().empty()) {
    greeting_->explainEmptyDatabase(name);
    stack_->setCurrentWidget(greeting_);
  } else {
    stack_->setCurrentWidget(tabs_);
  }
}

bool DashboardWindow::openDatabase(const QString& path) {
  try {
    setDocument(std::make_shared<const CohortDocument>(path.toStdString()));
    return true;
  } catch (const Error& error) {
    showProblem(QString::fromUtf8(error.what()));
    return false;
  }
}

void DashboardWindow::reload() {
  if (document_) openDatabase(QString::fromStdString(document_->path()));
}

void DashboardWindow::askForDatabase() {
  const QString path =
      QFileDialog::getOpenFileName(this, "Open a cohort database", {}, "Cohort databases (*.db);;All files (*)");
  if (!path.isEmpty()) openDatabase(path);
}

void DashboardWindow::showProblem(const QString& message) {
  problem_->setText(message);
  problem_->show();
}

void DashboardWindow::savePictures(const QString& folder) {
  const auto save = [&](const QString& name) {
    QCoreApplication::processEvents();
    const QString file = folder + '/' + name;
    if (!grab().save(file, "PNG"))
      throw Error(ExitCode::failure, file.toStdString() + ": cannot write the picture; does the folder exist?");
  };
  if (stack_->currentWidget() == greeting_) {
    save("greeting.png");
    return;
  }
  tabs_->setCurrentWidget(attempts_);
  save("attempts.png");
  tabs_->setCurrentWidget(compare_);
  save("compare.png");
}

}  // namespace calot::gui
