// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/scene_picture_widget.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace calot::gui {
namespace {

std::shared_ptr<const SceneView> viewOfStep(std::uint64_t step) {
  SceneView view;
  view.step = step;
  return std::make_shared<const SceneView>(view);
}

/// A loop whose drawing waits to be allowed, one permit a picture, and which remembers what it drew.
class HeldLoop {
 public:
  explicit HeldLoop(std::uint64_t faulty = ~0ULL)
      : loop_(
            [this, faulty] {
              return [this, faulty](const SceneView& v, int w, int h, bool) { return draw(v, w, h, faulty); };
            },
            {[this](ScenePicture p) {
               const std::lock_guard lock(mutex_);
               shown_.push_back(p.view->step);
               sizes_.push_back(p.image.width);
               changed_.notify_all();
             },
             [this](const std::string& fault) {
               const std::lock_guard lock(mutex_);
               faults_.push_back(fault);
               changed_.notify_all();
             }}) {}
  ~HeldLoop() { allow(1000); }

  PictureLoop& loop() { return loop_; }
  void allow(int pictures) {
    const std::lock_guard lock(mutex_);
    permits_ += pictures;
    changed_.notify_all();
  }
  void awaitBegun(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return begun_.size() >= count; });
  }
  void awaitAnswers(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return shown_.size() + faults_.size() >= count; });
  }
  std::vector<std::uint64_t> shown() { return locked(shown_); }
  std::vector<int> sizes() { return locked(sizes_); }
  std::vector<std::string> faults() { return locked(faults_); }

 private:
  template <class T>
  T locked(const T& value) {
    const std::lock_guard lock(mutex_);
    return value;
  }
  Image draw(const SceneView& view, int width, int height, std::uint64_t faulty) {
    std::unique_lock lock(mutex_);
    begun_.push_back(view.step);
    changed_.notify_all();
    changed_.wait(lock, [&] { return permits_ > 0; });
    --permits_;
    if (view.step == faulty) throw std::runtime_error("no such view");
    Image image;
    image.width = width;
    image.height = height;
    return image;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int permits_ = 0;
  std::vector<std::uint64_t> begun_, shown_;
  std::vector<int> sizes_;
  std::vector<std::string> faults_;
  PictureLoop loop_;
};

TEST(PictureLoop, ViewsThatComeWhileOneIsDrawnReplaceEachOther) {
  HeldLoop held;
  held.loop().resize(64, 48);
  held.loop().show(viewOfStep(0));
  held.awaitBegun(1);
  for (std::uint64_t step = 1; step <= 500; ++step) held.loop().show(viewOfStep(step));
  held.allow(2);
  held.awaitAnswers(2);
  EXPECT_EQ(held.shown(), (std::vector<std::uint64_t>{0, 500})) << "the first, then the newest, and nothing between";
}

TEST(PictureLoop, NothingIsDrawnBeforeThereIsASizeAndANewSizeDrawsTheNewestAgain) {
  HeldLoop held;
  held.allow(10);
  held.loop().show(viewOfStep(7));
  held.loop().resize(64, 48);
  held.awaitAnswers(1);
  held.loop().resize(64, 48);  // the same: nothing to do
  held.loop().resize(80, 60);
  held.awaitAnswers(2);
  EXPECT_EQ(held.shown(), (std::vector<std::uint64_t>{7, 7}));
  EXPECT_EQ(held.sizes(), (std::vector<int>{64, 80}));
}

TEST(PictureLoop, AViewThatCannotBeDrawnIsToldAndTheNextOneIsDrawn) {
  HeldLoop held(3);
  held.allow(10);
  held.loop().resize(64, 48);
  held.loop().show(viewOfStep(3));
  held.awaitAnswers(1);
  EXPECT_EQ(held.faults(), std::vector<std::string>{"no such view"});
  held.loop().show(viewOfStep(4));
  held.awaitAnswers(2);
  EXPECT_EQ(held.shown(), std::vector<std::uint64_t>{4});
}

TEST(PictureLoop, DrawsSmallerWhereTheRateIsNotKeptAndWholeWhatStands) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<int> widths;
  // A picture takes longer than the rate leaves it, whatever the machine.
  PictureLoop loop(
      [] {
        return [](const SceneView&, int width, int height, bool) {
          std::this_thread::sleep_for(std::chrono::milliseconds(30));
          Image image;
          image.width = width;
          image.height = height;
          return image;
        };
      },
      {[&](ScenePicture picture) {
         const std::lock_guard lock(mutex);
         widths.push_back(picture.image.width);
         changed.notify_all();
       },
       [](const std::string& fault) { ADD_FAILURE() << fault; }},
      1, 50.0);
  loop.resize(640, 480);
  const auto newest = [&] { return widths.empty() ? 0 : widths.back(); };
  std::uint64_t step = 0;
  std::unique_lock lock(mutex);
  while (newest() != 320) {  // half, which is as small as it gets
    const std::size_t before = widths.size();
    lock.unlock();
    loop.show(viewOfStep(step++));
    lock.lock();
    changed.wait(lock, [&] { return widths.size() > before; });
    ASSERT_LT(widths.size(), 500U);
  }
  EXPECT_EQ(widths.front(), 640);
  changed.wait(lock, [&] { return newest() == 640; });  // no view comes any more
}

TEST(PictureLoop, WhatStandsStillIsDrawnOnceMoreAndRefined) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<bool> refined;
  PictureLoop loop(
      [&] {
        return [&](const SceneView&, int, int, bool still) {
          const std::lock_guard lock(mutex);
          refined.push_back(still);
          return Image{1, 1, {}};
        };
      },
      {[&](const ScenePicture&) { changed.notify_all(); }, [](const std::string& fault) { ADD_FAILURE() << fault; }}, 1,
      0.0, true);
  loop.resize(640, 480);
  loop.show(viewOfStep(1));
  {
    std::unique_lock lock(mutex);
    ASSERT_TRUE(changed.wait_for(lock, std::chrono::minutes(1), [&] { return refined.size() >= 2; }));
    EXPECT_EQ(refined, (std::vector<bool>{false, true}));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(refined.size(), 2U) << "once is enough";
}

TEST(PictureLoop, WhatWasClearedIsNotDrawn) {
  HeldLoop held;
  held.loop().resize(64, 48);
  held.loop().show(viewOfStep(0));
  held.awaitBegun(1);
  held.loop().show(viewOfStep(1));
  held.loop().clear();
  held.loop().resize(65, 48);
  held.allow(10);
  held.awaitAnswers(1);
  held.loop().show(viewOfStep(2));
  held.awaitAnswers(2);
  EXPECT_EQ(held.shown(), (std::vector<std::uint64_t>{0, 2}));
}

TEST(PictureLoop, TwoDrawersDrawTwoViewsAtATimeAndOneThatIsOvertakenIsDropped) {
  std::mutex mutex;
  std::condition_variable changed;
  std::set<std::uint64_t> open;  // steps that may be finished
  std::vector<std::uint64_t> begun, ended, shown;
  const auto await = [&](const std::vector<std::uint64_t>& list, std::size_t count) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return list.size() >= count; });
  };
  const auto finish = [&](std::uint64_t step) {
    const std::lock_guard lock(mutex);
    open.insert(step);
    changed.notify_all();
  };
  PictureLoop loop(
      [&] {
        return [&](const SceneView& view, int, int, bool) {
          std::unique_lock lock(mutex);
          begun.push_back(view.step);
          changed.notify_all();
          changed.wait(lock, [&] { return open.contains(view.step); });
          ended.push_back(view.step);
          changed.notify_all();
          return Image{};
        };
      },
      {[&](const ScenePicture& picture) {
         const std::lock_guard lock(mutex);
         shown.push_back(picture.view->step);
         changed.notify_all();
       },
       [](const std::string&) {}},
      2);
  loop.resize(64, 48);
  finish(0);
  loop.show(viewOfStep(0));
  await(ended, 2);  // both get warm by it, and it is shown once
  loop.show(viewOfStep(1));
  await(begun, 3);
  loop.show(viewOfStep(2));
  await(begun, 4);
  finish(2);
  await(shown, 2);
  finish(1);
  await(ended, 4);
  finish(3);
  loop.show(viewOfStep(3));
  await(shown, 3);
  EXPECT_EQ(shown, (std::vector<std::uint64_t>{0, 2, 3}));
}

TEST(PictureLoop, EndsWhileOneIsDrawnAndOthersWait) {
  std::promise<void> begun;
  std::promise<void> go;
  std::shared_future<void> allowed = go.get_future().share();
  int drawn = 0;
  auto loop = std::make_unique<PictureLoop>(
      [&] {
        return [&, allowed](const SceneView&, int, int, bool) {
          if (drawn++ == 0) begun.set_value();
          allowed.wait();
          return Image{};
        };
      },
      PictureLoop::Receiver{[](const ScenePicture&) {}, [](const std::string&) {}});
  loop->resize(64, 48);
  loop->show(viewOfStep(0));
  begun.get_future().wait();
  loop->show(viewOfStep(1));
  std::thread later([&] { go.set_value(); });
  loop.reset();
  later.join();
  EXPECT_LE(drawn, 2);
}

}  // namespace
}  // namespace calot::gui
