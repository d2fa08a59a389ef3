// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>
#include <thread>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/drivers/grey_decoder.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t reopenPeriod = 500'000'000;  // ns
constexpr std::uint32_t buffersWanted = 4;
constexpr int usualWidth = 1280, usualHeight = 720;
constexpr double usualRate = 30.0;  // 1/s

int call(int handle, unsigned long request, void* argument) {
  int result = 0;
  do {
    result = ioctl(handle, request, argument);
  } while (result < 0 && errno == EINTR);
  return result;
}

v4l2_buffer captureBuffer() {
  v4l2_buffer out{};
  out.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  out.memory = V4L2_MEMORY_MMAP;
  return out;
}

std::string textOf(const std::uint8_t* bytes, std::size_t size) {
  const auto* const text = reinterpret_cast<const char*>(bytes);
  return {text, strnlen(text, size)};
}

/// @returns what the driver says of a device that captures pictures, or an empty text
std::string cardOf(int handle) {
  v4l2_capability can{};
  if (call(handle, VIDIOC_QUERYCAP, &can) < 0) return {};
  const std::uint32_t caps = (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
  if ((caps & V4L2_CAP_VIDEO_CAPTURE) == 0 || (caps & V4L2_CAP_STREAMING) == 0) return {};
  return textOf(can.card, sizeof can.card) + " " + textOf(can.bus_info, sizeof can.bus_info);
}

Descriptor openVideo(const std::string& file) {
  return Descriptor(::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
}

class LiveCamera final : public FrameSource {
 public:
  LiveCamera(std::string file, int width, int height)
      : FrameSource(std::move(file), width > 0 ? width : usualWidth, height > 0 ? height : usualHeight, usualRate) {
    const std::string fault = start();
    if (fault.empty()) return;
    stop();
    throw Error(ErrorKind::failure, Where{name_}, fault);
  }
  ~LiveCamera() override { stop(); }

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override {
    if (!handle_.valid()) {
      const std::int64_t now = monotonicNanoseconds();
      if (now < nextAttempt_) {
        std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
        return FrameStatus::lost;
      }
      nextAttempt_ = now + reopenPeriod;
      if (!start().empty()) {
        stop();
        return FrameStatus::lost;
      }
    }
    pollfd ready{handle_.get(), POLLIN, 0};
    const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(wait).count();
    if (::poll(&ready, 1, static_cast<int>(milliseconds)) <= 0) return FrameStatus::none;
    v4l2_buffer buffer = captureBuffer();
    if (call(handle_.get(), VIDIOC_DQBUF, &buffer) < 0) {
      if (errno == EAGAIN) return FrameStatus::none;
      reason_ = fmt::format("{}: {}", name_, std::strerror(errno));
      stop();
      return FrameStatus::lost;
    }
    const auto* const bytes = static_cast<const std::uint8_t*>(buffer_[buffer.index].address);
    const bool whole = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && convert({bytes, buffer.bytesused}, out.image);
    const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    out.time = monotonic ? std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 + buffer.timestamp.tv_usec * 1000
                         : monotonicNanoseconds();
    const auto number = static_cast<std::int64_t>(buffer.sequence);
    call(handle_.get(), VIDIOC_QBUF, &buffer);
    if (!whole) return FrameStatus::none;  // the gap of its number reports it
    out.missed = lastNumber_ >= 0 && number > lastNumber_ ? static_cast<std::uint64_t>(number - lastNumber_ - 1) : 0;
    lastNumber_ = number;
    return FrameStatus::frame;
  }

 private:
  /// @returns what is wrong, or an empty text
  std::string start() {
    handle_ = openVideo(name_);
    if (!handle_.valid()) return fmt::format("the camera cannot be opened: {}", std::strerror(errno));
    card_ = cardOf(handle_.get());
    if (card_.empty()) return "is not a camera";
    v4l2_format format{};
    for (const std::uint32_t pixels : {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_YUYV}) {
      format = {};
      format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      format.fmt.pix.width = static_cast<std::uint32_t>(width_);
      format.fmt.pix.height = static_cast<std::uint32_t>(height_);
      format.fmt.pix.pixelformat = pixels;
      format.fmt.pix.field = V4L2_FIELD_NONE;
      if (call(handle_.get(), VIDIOC_S_FMT, &format) == 0 && format.fmt.pix.pixelformat == pixels) break;
      format.fmt.pix.pixelformat = 0;
    }
    if (format.fmt.pix.pixelformat == 0) return "gives neither motion JPEG nor YUYV";
    if (format.fmt.pix.width != static_cast<std::uint32_t>(width_) ||
        format.fmt.pix.height != static_cast<std::uint32_t>(height_))
      return fmt::format("gives no pictures of {} x {} pixels", width_, height_);
    compressed_ = format.fmt.pix.pixelformat == V4L2_PIX_FMT_MJPEG;
    stride_ = std::max<std::size_t>(format.fmt.pix.bytesperline, 2 * static_cast<std::size_t>(width_));
    if (compressed_ && !decoder_.open(AV_CODEC_ID_MJPEG, nullptr)) return "this libav decodes no motion JPEG";
    v4l2_streamparm pace{};
    pace.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    pace.parm.capture.timeperframe = {1, 60};  // the driver takes what is nearest
    const v4l2_fract& period = pace.parm.capture.timeperframe;
    if (call(handle_.get(), VIDIOC_S_PARM, &pace) == 0 && period.numerator > 0 && period.denominator > 0)
      rate_ = static_cast<double>(period.denominator) / period.numerator;
    v4l2_requestbuffers wanted{};
    wanted.count = buffersWanted;
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    if (call(handle_.get(), VIDIOC_REQBUFS, &wanted) < 0 || wanted.count < 2) return "gives no buffers";
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      v4l2_buffer buffer = captureBuffer();
      buffer.index = i;
      if (call(handle_.get(), VIDIOC_QUERYBUF, &buffer) < 0) return "gives no buffers";
      void* const address = mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, handle_.get(), buffer.m.offset);
      if (address == MAP_FAILED) return fmt::format("its buffers cannot be mapped: {}", std::strerror(errno));
      buffer_.push_back({address, buffer.length});
      if (call(handle_.get(), VIDIOC_QBUF, &buffer) < 0) return "takes no buffers";
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (call(handle_.get(), VIDIOC_STREAMON, &type) < 0)
      return fmt::format("does not start: {}", errno == EBUSY ? "another program uses it" : std::strerror(errno));
    lastNumber_ = -1;
    return {};
  }

  void stop() {
    for (const Mapped& mapped : buffer_) munmap(mapped.address, mapped.length);
    buffer_.clear();
    handle_.close();
  }

  bool convert(std::span<const std::uint8_t> bytes, GreyImage& out) {
    const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
    if (!compressed_) {
      if (bytes.size() < stride_ * (height - 1) + 2 * width) return false;
      out.width = width_;
      out.height = height_;
      out.pixels.resize(width * height);
      for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) out.pixels[y * width + x] = bytes[y * stride_ + 2 * x];
      }
      return true;
    }
    const HeldAv<AVPacket> packet(av_packet_alloc());
    const HeldAv<AVFrame> frame(av_frame_alloc());
    if (!packet || !frame || av_new_packet(packet.get(), static_cast<int>(bytes.size())) < 0) return false;
    std::copy(bytes.begin(), bytes.end(), packet->data);
    return avcodec_send_packet(decoder_.context(), packet.get()) >= 0 &&
           avcodec_receive_frame(decoder_.context(), frame.get()) >= 0 &&
           decoder_.convert(*frame, width_, height_, out);
  }

  struct Mapped {
    void* address = nullptr;
    std::size_t length = 0;
  };
  Descriptor handle_;
  bool compressed_ = false;
  std::size_t stride_ = 0;
  std::vector<Mapped> buffer_;
  GreyDecoder decoder_;
  std::int64_t lastNumber_ = -1, nextAttempt_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> openLiveCamera(const std::string& file, int width, int height) {
  return std::make_unique<LiveCamera>(file, width, height);
}

std::vector<std::array<std::string, 2>> listLiveCameras() {
  std::vector<std::array<std::string, 2>> out;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string file = entry.path().string();
    if (!file.starts_with("/dev/video")) continue;
    const std::string card = cardOf(openVideo(file).get());
    if (!card.empty()) out.push_back({file, card});
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace calot::recorder
