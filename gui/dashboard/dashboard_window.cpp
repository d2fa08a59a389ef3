// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dashboard_window.h"

#include <algorithm>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QFileInfo>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QScreen>
#include <QStackedWidget>
#include <QStatusBar>
#include <QTabBar>
#include <QTabWidget>
#include <QTimer>
#include <QUrl>

#include "gui/attempt/replay_player.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/course_page.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/figures_page.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/ratings_page.h"
#include "gui/dashboard/study_page.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr int refreshEvery = 3000;  // ms, while an import runs

QStringList localFiles(const QMimeData& data) {
  QStringList files;
  for (const QUrl& url : data.urls()) {
    if (url.isLocalFile()) files += url.toLocalFile();
  }
  return files;
}

}  // namespace

struct DashboardWindow::Opened {
  std::shared_ptr<const CohortDocument> document;
  bool upgraded = false;  ///< it was of an older schema
};

DashboardWindow::Opened DashboardWindow::openOrUpgrade(const std::string& path) {
  try {
    return {std::make_shared<const CohortDocument>(path), false};
  } catch (const Error& error) {
    const std::vector<Remedy>& remedies = error.remedies();
    if (std::find(remedies.begin(), remedies.end(), Remedy::upgradeCohort) == remedies.end()) throw;
    const analytics::CohortDatabase upgraded(path, analytics::CohortDatabase::Access::write);
    return {std::make_shared<const CohortDocument>(path), true};
  }
}

DashboardWindow::DashboardWindow(const AssessProgram& program, const std::vector<std::filesystem::path>& assetFolders)
    : problem_(parts::selectableLabel("problem")),
      stack_(new QStackedWidget),
      greeting_(new GreetingPage),
      tabs_(new QTabWidget),
      attempts_(new AttemptsPage),
      attempt_(new AttemptPage),
      compare_(new ComparePage),
      study_(new StudyPage),
      trainee_(new TraineePage),
      pair_(new PairPage),
      rating_(new RatingPage),
      course_(new CoursePage),
      decisions_(new Decisions(this)),
      assetFolders_(assetFolders),
      program_(program),
      imports_(program) {
  setWindowTitle("Calot");
  resize(theme::windowSizeFor(screen()->availableSize()));
  setAcceptDrops(true);
  theme::setGround(*problem_, QColor(0xfb, 0xe3, 0xd6), QColor(0x5a, 0x1e, 0x00));
  problem_->hide();
  for (const auto& [page, title] : std::initializer_list<std::pair<CohortPage*, const char*>>{{attempts_, "Attempts"},
                                                                                              {attempt_, "Attempt"},
                                                                                              {compare_, "Compare"},
                                                                                              {study_, "Study"},
                                                                                              {trainee_, "Trainee"},
                                                                                              {pair_, "Side by side"},
                                                                                              {rating_, "Ratings"},
                                                                                              {course_, "Course"}}) {
    tabs_->addTab(page, title);
    connect(page, &CohortPage::problem, this, &DashboardWindow::showProblem);
    connect(page, &CohortPage::attemptActivated, this, &DashboardWindow::openAttempt);
  }
  stack_->addWidget(greeting_);
  stack_->addWidget(tabs_);
  auto* centre = new QWidget;
  centre->setLayout(parts::column({problem_, {stack_, 1}}));
  setCentralWidget(centre);
  rating_->readForms(assetFolders);
  course_->readCourses(assetFolders);
  buildImport();
  buildMenus();
  connectPages();
}

DashboardWindow::~DashboardWindow() = default;

void DashboardWindow::buildImport() {
  importDock_ = parts::named("import", new QDockWidget("Import", this));
  importDock_->setWidget(new ImportPanel(imports_));
  addDockWidget(Qt::BottomDockWidgetArea, importDock_);
  importDock_->hide();
  refresh_ = new QTimer(this);
  refresh_->setSingleShot(true);
  refresh_->setInterval(refreshEvery);
  connect(refresh_, &QTimer::timeout, this, [this] { reload(); });
  connect(&imports_, &ImportQueue::fileDone, this, [this](const ImportResult& result) {
    if (result.kind == ImportResult::Kind::stored && !refresh_->isActive()) refresh_->start();
  });
  connect(&imports_, &ImportQueue::allDone, this, [this] {
    refresh_->stop();
    reload();
  });
}

void DashboardWindow::buildMenus() {
  using Do = std::function<void()>;
  const auto add = [this](QMenu* menu, const char* text, const QKeySequence& key, Do action) {
    return menu->addAction(text, key, this, std::move(action));
  };
  QMenu* const file = menuBar()->addMenu("&File");
  add(file, "&Open …", QKeySequence::Open, [this] { askForDatabase(); });
  recent_ = file->addMenu("Open &recent");
  fillRecent();
  add(file, "&New cohort …", QKeySequence::New, [this] { askForNewDatabase(); });
  add(file, "&Import recordings …", Qt::CTRL | Qt::Key_I, [this] { askForRecordings(); });
  add(file, "Import ne&w recordings", Qt::CTRL | Qt::SHIFT | Qt::Key_I, [this] { importNew(); });
  add(file, "&Print …", QKeySequence::Print, [this] { print(); });
  QAction* const sheet = add(file, "&Grade sheet …", QKeySequence::Save, [this] {
    if (attempts_->selected() == nullptr) return;
    tabs_->setCurrentWidget(attempt_);
    attempt_->askForSheet();
  });
  add(file, "&Export the list …", {}, [this] { askForList(); });
  add(file, "&Settings …", Qt::CTRL | Qt::Key_Comma, [this] { SettingsDialog(this).exec(); });
  add(file, "&Quit", Qt::CTRL | Qt::Key_Q, [this] { close(); });
  QMenu* const edit = menuBar()->addMenu("&Edit");
  edit->addActions({decisions_->undoAction(), decisions_->redoAction()});
  exclude_ = add(edit, "&Exclude from studies …", Qt::CTRL | Qt::Key_E, [this] { askForExclusion(); });
  exclude_->setEnabled(false);
  add(edit, "Make a &norm …", Qt::CTRL | Qt::Key_M, [this] { askForNorm(); });
  attempts_->offer({sheet, exclude_,
                    add(edit, "Change the grou&p", Qt::CTRL | Qt::Key_G,
                        [this] {
                          tabs_->setCurrentWidget(attempts_);
                          attempts_->editGroup();
                        }),
                    add(edit, "Add &tag …", Qt::CTRL | Qt::Key_T, [this] { askForTag(true); }),
                    add(edit, "Remove ta&g …", Qt::CTRL | Qt::SHIFT | Qt::Key_T, [this] { askForTag(false); }),
                    add(edit, "&Verify again", Qt::CTRL | Qt::SHIFT | Qt::Key_V, [this] { verifySelected(); }),
                    add(edit, "&Side by side", Qt::CTRL | Qt::Key_B, [this] { pairSelected(); })});
  QMenu* const view = menuBar()->addMenu("&View");
  for (int page = 0; page < tabs_->count(); ++page)
    view->addAction(QString("&%1 ").arg(page + 1) + tabs_->tabText(page),
                    QKeySequence(Qt::CTRL | static_cast<Qt::Key>(Qt::Key_1 + page)), this,
                    [this, page] { tabs_->setCurrentIndex(page); });
  add(view, "&Search", QKeySequence::Find, [this] {
    tabs_->setCurrentWidget(attempts_);
    attempts_->focusSearch();
  });
  add(view, "&Reload", Qt::Key_F5, [this] { reload(); });
  view->addAction(importDock_->toggleViewAction());
  QMenu* const help = menuBar()->addMenu("&Help");
  add(help, "&Manual", {}, [this] { showManual(); });
  add(help, "&Keys …", QKeySequence::HelpContents, [this] { showKeys(keysOf(*menuBar()), this); });
  add(help, "&About Calot …", {}, [this] {
    QMessageBox::about(this, "Calot",
                       "Calot " CALOT_VERSION
                       "\nTraining of laparoscopic cholecystectomy: recorded, "
                       "replayed bit for bit, assessed.\nGPL, version 3 or later.");
  });
}

void DashboardWindow::connectPages() {
  connect(decisions_, &Decisions::written, this, &DashboardWindow::reload);
  connect(decisions_, &Decisions::failed, this, [this](const QString& reason) {
    rating_->setDocument(document_);  // shows what is stored
    showProblem(reason);
  });
  connect(course_, &CoursePage::courseChosen, trainee_, &TraineePage::readCourse);
  connect(rating_, &RatingPage::decided, this, &DashboardWindow::decide);
  connect(greeting_, &GreetingPage::openRequested, this, &DashboardWindow::askForDatabase);
  connect(greeting_, &GreetingPage::newRequested, this, &DashboardWindow::askForNewDatabase);
  connect(greeting_, &GreetingPage::importRequested, this, &DashboardWindow::askForRecordings);
  connect(attempt_, &AttemptPage::sheetWritten, this,
          [this](const QString& text) { statusBar()->showMessage(text, noticeFor); });
  connect(attempt_, &AttemptPage::continuationRequested, this, &DashboardWindow::askForContinuation);
  connect(attempt_, &AttemptPage::normRequested, this, &DashboardWindow::askForNorm);
  connect(attempts_, &AttemptsPage::groupEdited, this, &DashboardWindow::changeGroup);
  connect(attempts_, &AttemptsPage::selectionChanged, this, [this] {
    const analytics::AttemptRow* attempt = attempts_->selected();
    exclude_->setEnabled(attempt != nullptr && !attempt->withdrawn);
    if (attempt == nullptr) {
      attempt_->clear();
      return;
    }
    exclude_->setText(attempt->excluded ? "&Include in studies again …" : "&Exclude from studies …");
    attempt_->setAttempt(document_, *attempt);
    pair_->setAttempt(1, attempt->uuid);
  });
  connect(attempts_, &AttemptsPage::figureActivated, this, [this](const QString& checkpoint, const QString& subject) {
    tabs_->setCurrentWidget(attempt_);
    attempt_->figures().goToFigure(checkpoint.toStdString(), subject.toStdString());
  });
  // One begins where a page begins; who is going along the tabs stays there.
  connect(tabs_, &QTabWidget::currentChanged, this, [this] {
    if (tabs_->currentWidget() == rating_) rating_->setSelected(attempts_->selectedUuids());
    if (!tabs_->tabBar()->hasFocus()) focusPage();
  });
}

void DashboardWindow::focusPage() { static_cast<CohortPage*>(tabs_->currentWidget())->focusBegin(); }

void DashboardWindow::openAttempt(const QString& uuid) {
  attempts_->select(uuid);
  tabs_->setCurrentWidget(attempt_);
}

void DashboardWindow::setDocument(std::shared_ptr<const CohortDocument> document) {
  const bool another = !document_ || document_->path() != document->path();
  document_ = std::move(document);
  if (another) decisions_->forget();
  problem_->hide();
  const QString name = QFileInfo(QString::fromStdString(document_->path())).fileName();
  setWindowTitle(name + " – Calot");
  settings::rememberCohort(QString::fromStdString(document_->path()));
  fillRecent();
  // The list is last: its selection goes to the others.
  for (CohortPage* page :
       std::initializer_list<CohortPage*>{study_, trainee_, pair_, rating_, course_, compare_, attempts_})
    page->setDocument(document_);
  if (document_->attempts().empty()) {
    greeting_->explainEmptyDatabase(name);
    stack_->setCurrentWidget(greeting_);
  } else {
    const bool first = stack_->currentWidget() != tabs_;
    stack_->setCurrentWidget(tabs_);
    if (first) focusPage();
  }
  if (!awaited_.isEmpty() && document_->attempt(awaited_.toStdString()) != nullptr)
    openAttempt(std::exchange(awaited_, QString()));
  showBranch();
  emit documentShown();
}

bool DashboardWindow::tryTo(const std::function<void()>& call) {
  const QString fault = faultOf(call);
  if (!fault.isEmpty()) showProblem(fault);
  return fault.isEmpty();
}

void DashboardWindow::takeOpened(const Opened& opened) {
  loader_.forget();  // the former one, read again
  setDocument(opened.document);
  if (opened.upgraded)
    showProblem("This cohort was of an older Calot and has been brought up to date. A copy as it was is beside it.");
}

bool DashboardWindow::openDatabase(const QString& path) {
  opener_.forget();
  return tryTo([&] { takeOpened(openOrUpgrade(path.toStdString())); });
}

void DashboardWindow::openLater(const QString& path) {
  statusBar()->showMessage("Opening " + QFileInfo(path).fileName() + " …");
  opener_.run(
      [this, path = path.toStdString()] {
        return [this, opened = openOrUpgrade(path)] {
          statusBar()->clearMessage();
          takeOpened(opened);
        };
      },
      [this](const QString& reason) {
        statusBar()->clearMessage();
        showProblem(reason);
      });
}

bool DashboardWindow::createDatabase(const QString& path) {
  const auto create = [&] {
    const analytics::CohortDatabase made(path.toStdString(), analytics::CohortDatabase::Access::create);
  };
  return tryTo(create) && openDatabase(path);
}

void DashboardWindow::reload() {
  if (!document_) return;
  loader_.run(
      [this, path = document_->path()] {
        return [this, document = std::make_shared<const CohortDocument>(path)] { setDocument(document); };
      },
      [this](const QString& fault) { showProblem(fault); });
}

void DashboardWindow::importRecordings(const QStringList& paths) {
  const QStringList files = recordingsIn(paths);
  if (files.isEmpty()) {
    showProblem("There is no recording (*.h5) in what was chosen.");
    return;
  }
  if (!imports_.busy())
    imports_.configure(settings::calotProgram(), QString::fromStdString(document_->path()), settings::importThreads());
  // Replays are looked for in the folders of the imported recordings.
  for (const QString& file : files) settings::rememberRecordingFolder(QFileInfo(file).absolutePath());
  importDock_->show();
  imports_.add(files);
}

void DashboardWindow::prepare() { attempt_->prepare(); }

void DashboardWindow::importNew() {
  if (!document_) return;
  QStringList files = recordingsIn(QStringList(QFileInfo(QString::fromStdString(document_->path())).absolutePath()) +
                                   settings::recordingFolders());
  const auto& attempts = document_->attempts();
  files.removeIf([&](const QString& file) {
    return std::ranges::find(attempts, QFileInfo(file).fileName().toStdString(), &analytics::AttemptRow::fileName) !=
           attempts.end();
  });
  if (files.isEmpty())
    statusBar()->showMessage("No new recordings in the folders that the settings name.", noticeFor);
  else
    importRecordings(files);
}

void DashboardWindow::addBranch(const BranchRequest& request, const QString& parentUuid) {
  if (!imports_.busy())
    imports_.configure(settings::calotProgram(), QString::fromStdString(document_->path()), settings::importThreads());
  settings::rememberRecordingFolder(QFileInfo(request.file).absolutePath());
  branched_ = parentUuid.toStdString();
  branchName_ = QFileInfo(request.file).fileName().toStdString();
  importDock_->show();
  imports_.addBranch(request);
}

/// Once the branch is in the cohort.
void DashboardWindow::showBranch() {
  const auto branch = std::ranges::find_if(document_->attempts(), [this](const analytics::AttemptRow& attempt) {
    return attempt.parent == branched_ && attempt.fileName == branchName_;
  });
  if (branched_.empty() || branch == document_->attempts().end()) return;
  pair_->setAttempt(0, std::exchange(branched_, {}));
  pair_->setAttempt(1, branch->uuid);
  tabs_->setCurrentWidget(pair_);
}

void DashboardWindow::showRecording(const QString& file, const QString& uuid) {
  settings::rememberRecordingFolder(QFileInfo(file).absolutePath());
  if (document_->attempt(uuid.toStdString()) != nullptr) {
    openAttempt(uuid);
    return;
  }
  awaited_ = uuid;
  importRecordings({file});
}

void DashboardWindow::showProblem(const QString& message) {
  problem_->setText(message);
  problem_->show();
}

void DashboardWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (!localFiles(*event->mimeData()).isEmpty()) event->acceptProposedAction();
}

void DashboardWindow::dropEvent(QDropEvent* event) {
  const QStringList files = localFiles(*event->mimeData());
  if (files.isEmpty()) return;
  event->acceptProposedAction();
  if (files.size() == 1 && files[0].endsWith(".db")) {
    openLater(files[0]);
  } else if (!document_) {
    showProblem("Open a cohort database first, or make one: recordings are imported into it.");
  } else {
    importRecordings(files);
  }
}

}  // namespace calot::gui
