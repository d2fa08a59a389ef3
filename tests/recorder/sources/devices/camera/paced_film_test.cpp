// SPDX-License-Identifier: GPL-3.0-or-later
// Films in real time.
#include "recorder/sources/devices/camera/camera_device.h"

#include <gtest/gtest.h>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

/// Ten frames, 40 ms apart; the sixth is missing.
class TenFrames final : public FrameSource {
 public:
  TenFrames() : FrameSource("ten frames", 640, 360, 25.0) {}
  FrameStatus next(std::chrono::nanoseconds /*wait*/, Frame& out) override {
    if (next_ == 10) return FrameStatus::ended;
    out.missed = next_ == 5 ? 1 : 0;
    if (next_ == 5) ++next_;
    out.time = next_++ * 40'000'000;
    return FrameStatus::frame;
  }

 private:
  std::int64_t next_ = 0;
};

TEST(PacedFilm, GivesEachFrameWhenItIsDueAndDropsWhatNobodyTook) {
  std::int64_t now = 7'000'000'000;
  PacedFilm film(std::make_unique<TenFrames>(), [&now] { return now; });
  constexpr std::chrono::nanoseconds none(0);
  Frame frame;
  EXPECT_EQ(film.next(none, frame), FrameStatus::frame) << "the first one at once";
  EXPECT_EQ(frame.time, 7'000'000'000);
  EXPECT_EQ(film.next(none, frame), FrameStatus::none);
  now += 40'000'000;
  EXPECT_EQ(film.next(none, frame), FrameStatus::frame);
  EXPECT_EQ(frame.time, 7'040'000'000);
  now += 39'000'000;
  EXPECT_EQ(film.next(none, frame), FrameStatus::none) << "a millisecond too early";
  now = 7'300'000'000;  // busy elsewhere: frames 2 to 5 went by
  EXPECT_EQ(film.next(none, frame), FrameStatus::frame);
  EXPECT_EQ(frame.time, 7'240'000'000) << "the newest but one, which a driver would still hold";
  EXPECT_EQ(frame.missed, 4U) << "three dropped, one missing in the film";
  EXPECT_EQ(film.next(none, frame), FrameStatus::frame);
  EXPECT_EQ(frame.missed, 0U);
  now = 9'000'000'000;
  EXPECT_EQ(film.next(none, frame), FrameStatus::ended);
}

CameraRequest asked(const std::string& argument) {
  DeviceRequest request;
  request.name = "camera:" + argument;
  request.argument = argument;
  return parseCameraRequest(request);
}

TEST(CameraRequest, FilmsMayBePaced) {
  EXPECT_TRUE(asked("paced,a.mkv,b.mkv").paced);
  EXPECT_EQ(asked("paced,a.mkv,b.mkv").cameras.size(), 2U);
  EXPECT_FALSE(asked("a.mkv").paced);
  EXPECT_THROW(asked("paced,0"), Error);
  EXPECT_THROW(asked("paced"), Error) << "of what?";
}

TEST(CameraRequest, KeysGoWithLiveCamerasOnly) {
  EXPECT_EQ(asked("0,1,keys=/dev/input/event3").keys, "/dev/input/event3");
  EXPECT_THROW(asked("a.mkv,keys=/dev/input/event3"), Error);
}

}  // namespace
}  // namespace calot::recorder
