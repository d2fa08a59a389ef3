// SPDX-License-Identifier: GPL-3.0-or-later
// What FilmWriter writes, as libav reads it again.
#include "gui/film/film_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace calot::gui {
namespace {

constexpr int width = 96, height = 64;

/// One colour, and a bright bar whose place says which picture it is.
Image numbered(int k) {
  Image image{width, height, std::vector<std::uint8_t>(4UL * width * height)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint8_t* const p = image.rgba.data() + 4 * (y * width + x);
      const bool bar = x >= 8 * k && x < 8 * k + 8;
      p[0] = bar ? 230 : 150;
      p[1] = bar ? 230 : 60;
      p[2] = bar ? 230 : 40;
      p[3] = 255;
    }
  return image;
}

struct Seen {
  double time = 0.0;
  int bar = -1;                              // which eighth column is brightest
  double luma = 0.0, blue = 0.0, red = 0.0;  // means beside the bar, as stored
};

struct Film {
  int width = 0, height = 0;
  std::vector<Seen> pictures;
};

Film read(const std::filesystem::path& file) {
  Film film;
  AVFormatContext* format = nullptr;
  EXPECT_EQ(avformat_open_input(&format, file.c_str(), nullptr, nullptr), 0);
  if (format == nullptr) return film;
  EXPECT_GE(avformat_find_stream_info(format, nullptr), 0);
  const AVCodec* codec = nullptr;
  const int stream = av_find_best_stream(format, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  EXPECT_GE(stream, 0);
  AVCodecContext* decoder = avcodec_alloc_context3(codec);
  avcodec_parameters_to_context(decoder, format->streams[stream]->codecpar);
  EXPECT_EQ(avcodec_open2(decoder, codec, nullptr), 0);
  film.width = decoder->width;
  film.height = decoder->height;
  EXPECT_EQ(decoder->colorspace, AVCOL_SPC_BT709);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  const auto take = [&] {
    while (avcodec_receive_frame(decoder, frame) == 0) {
      Seen seen;
      seen.time = static_cast<double>(frame->pts) * av_q2d(format->streams[stream]->time_base);
      const std::uint8_t* const row = frame->data[0] + 32 * frame->linesize[0];
      for (int c = 0, best = 0; c < width / 8; ++c)
        if (row[8 * c + 4] > best) best = row[8 * c + 4], seen.bar = c;
      const int beside = seen.bar > 5 ? 12 : 76;
      seen.luma = row[beside];
      seen.blue = frame->data[1][16 * frame->linesize[1] + beside / 2];
      seen.red = frame->data[2][16 * frame->linesize[2] + beside / 2];
      film.pictures.push_back(seen);
    }
  };
  while (av_read_frame(format, packet) == 0) {
    if (packet->stream_index == stream && avcodec_send_packet(decoder, packet) == 0) take();
    av_packet_unref(packet);
  }
  avcodec_send_packet(decoder, nullptr);
  take();
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&decoder);
  avformat_close_input(&format);
  return film;
}

class FilmFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("calot_film_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }
  static void write(const std::filesystem::path& file, int fps, int count) {
    const auto writer = openFilm(file, width, height, fps);
    for (int k = 0; k < count; ++k) writer->add(numbered(k));
    writer->finish();
    EXPECT_EQ(writer->pictures(), count);
  }
  std::filesystem::path folder_;
};

TEST_F(FilmFile, EveryPictureIsThereAtItsExactTime) {
  for (const char* name : {"a.mp4", "a.mkv"})
    for (const int fps : {25, 30}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(fps));
      write(folder_ / name, fps, 12);
      const Film film = read(folder_ / name);
      EXPECT_EQ(film.width, width);
      EXPECT_EQ(film.height, height);
      ASSERT_EQ(film.pictures.size(), 12U);
      // Matroska counts in milliseconds.
      const double tolerance = std::strcmp(name, "a.mkv") == 0 ? 0.00051 : 1e-9;
      for (int k = 0; k < 12; ++k) {
        EXPECT_NEAR(film.pictures[static_cast<std::size_t>(k)].time, static_cast<double>(k) / fps, tolerance);
        EXPECT_EQ(film.pictures[static_cast<std::size_t>(k)].bar, k);
      }
    }
}

/// ITU-R BT.709: Y = 0.2126 R + 0.7152 G + 0.0722 B, in 16 to 235; Cb = (B - Y) / 1.8556, Cr = (R - Y) / 1.5748, in 16
/// to 240 around 128.
TEST_F(FilmFile, ColoursAreThoseOfBt709) {
  write(folder_ / "a.mp4", 25, 3);
  const Film film = read(folder_ / "a.mp4");
  ASSERT_EQ(film.pictures.size(), 3U);
  const double r = 150.0 / 255.0, g = 60.0 / 255.0, b = 40.0 / 255.0;
  const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  for (const Seen& seen : film.pictures) {
    EXPECT_NEAR(seen.luma, 16.0 + 219.0 * y, 4.0);
    EXPECT_NEAR(seen.blue, 128.0 + 224.0 * (b - y) / 1.8556, 4.0);
    EXPECT_NEAR(seen.red, 128.0 + 224.0 * (r - y) / 1.5748, 4.0);
  }
}

TEST_F(FilmFile, NothingIsLeftOfAFilmThatIsNotFinished) {
  {
    const auto writer = openFilm(folder_ / "a.mp4", width, height, 25);
    writer->add(numbered(0));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4"));
    EXPECT_EQ(files(), 1) << "under another name";
  }
  EXPECT_EQ(files(), 0);
}

TEST_F(FilmFile, RefusesWhatNoFilmIs) {
  const auto kindOf = [&](const std::filesystem::path& file, int w, int h, int fps) -> std::optional<ErrorKind> {
    try {
      FilmWriter::check(file, w, h, fps);
      static_cast<void>(openFilm(file, w, h, fps));
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.kind();
    }
    return std::nullopt;
  };
  EXPECT_EQ(kindOf(folder_ / "a.avi", width, height, 25), ErrorKind::invalid);
  EXPECT_EQ(kindOf(folder_ / "a.mp4", 97, height, 25), ErrorKind::invalid);
  EXPECT_EQ(kindOf(folder_ / "a.mp4", width, 63, 25), ErrorKind::invalid);
  EXPECT_EQ(kindOf(folder_ / "a.mp4", width, height, 0), ErrorKind::invalid);
  EXPECT_EQ(kindOf(folder_ / "a.mp4", width, height, 121), ErrorKind::invalid);
  EXPECT_EQ(kindOf(folder_ / "missing" / "a.mp4", width, height, 25), ErrorKind::invalid);
  EXPECT_EQ(files(), 0);
}

}  // namespace
}  // namespace calot::gui
