// SPDX-License-Identifier: GPL-3.0-or-later
// calot devices calibrate: guided steps on a terminal, and what they measure of a device.

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "apps/calot/command.h"
#include "apps/calot/source_options.h"
#include "gui/film/overlay.h"
#include "gui/render/image.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/camera/camera_calibration.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/mouse_device.h"

namespace calot::apps {
namespace {

constexpr double arrowScale = 50.0;
constexpr int cellColumns = 8, cellRows = 6;  // as coverage counts them
constexpr gui::Colour seenCell{205, 228, 208}, unseenCell{244, 218, 214}, arrowColour{30, 60, 160},
    wordColour{255, 255, 255};

void paintPoint(gui::Image& image, int x, int y, const gui::Colour& colour) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  std::uint8_t* const pixel =
      image.rgba.data() +
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  std::copy(colour.begin(), colour.end(), pixel);
  pixel[3] = 255;
}

void paintStroke(gui::Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = 1 + static_cast<int>((to - from).cwiseAbs().maxCoeff());
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = from + (to - from) * (static_cast<double>(i) / steps);
    paintPoint(image, static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())), arrowColour);
  }
}

gui::Image pictureOf(const recorder::LensFit& fit, std::size_t number) {
  const recorder::CameraLens& lens = fit.lens;
  gui::Image image{
      lens.width, lens.height,
      std::vector<std::uint8_t>(4 * static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height))};
  std::set<int> seen;
  const auto cellOf = [&](double x, double y) {
    return static_cast<int>(y * cellRows / lens.height) * cellColumns + static_cast<int>(x * cellColumns / lens.width);
  };
  for (const recorder::CornerResidual& c : fit.residuals) seen.insert(cellOf(c.pixel.x(), c.pixel.y()));
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) paintPoint(image, x, y, seen.contains(cellOf(x, y)) ? seenCell : unseenCell);
  }
  for (const recorder::CornerResidual& c : fit.residuals) {
    paintStroke(image, c.pixel, c.pixel + arrowScale * c.error);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx)
        paintPoint(image, static_cast<int>(c.pixel.x()) + dx, static_cast<int>(c.pixel.y()) + dy, arrowColour);
    }
  }
  const gui::Lettering words(std::max(14, lens.height / 32));
  words.write(image,
              fmt::format("camera {}: {} views, {:.0f} % of the picture, residual {:.2f} pixels (arrows x {:.0f})",
                          number, lens.views, 100.0 * lens.coverage, lens.residual, arrowScale),
              10, 6, gui::Anchor::left, wordColour);
  return image;
}

/// Writes DIR/camera-N.png of each camera: where the board was seen, and as arrows, enlarged fifty times, how far each
/// corner was from where the lens has it. @throws Error (failure)
void writeCalibrationPictures(const recorder::RigFit& fit, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < fit.lens.size(); ++i)
    gui::writePng(pictureOf(fit.lens[i], i + 1), folder / fmt::format("camera-{}.png", i + 1));
}

/// Waits until the person is ready for a step. @throws Error (failure) where the person breaks off
void promptStep(const std::string& text) {
  fmt::print("{}\npress Enter to begin: ", text);
  std::fflush(stdout);
  std::string line;
  if (!std::getline(std::cin, line) || stopRequested()) throw Error(ErrorKind::failure, "calibrate: broken off");
}

struct Step {
  std::vector<const char*> phases;
  const char* text;
  double seconds;
};

/// Records the device through the steps that a person is guided through.
class GuidedRecording {
 public:
  explicit GuidedRecording(recorder::Device& device) : device_(device), pump_(device, true) {
    stream_.name = device.info().identity;
    stream_.file = device.info().name;
    stream_.rate = device.info().capabilities.rate;
  }

  void run(const Step& step) {
    promptStep(step.text);
    recorder::DeviceInput skipped;
    pump_.drain(skipped);
    const std::int64_t begin = recorder::monotonicNanoseconds();
    const auto length = static_cast<std::int64_t>(1e9 * step.seconds);
    const std::size_t before = stream_.samples.size();
    Progress progress("Measuring", false, "s");
    while (recorder::monotonicNanoseconds() < begin + length) {
      if (stopRequested()) throw Error(ErrorKind::failure, "calibrate: broken off");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      take(begin);
      progress.show(static_cast<std::uint64_t>((recorder::monotonicNanoseconds() - begin) / 1'000'000'000),
                    static_cast<std::uint64_t>(step.seconds));
    }
    take(begin);
    // The steps follow each other without the time in which nobody measured.
    for (const char* phase : step.phases) stream_.phases.push_back({phase, time_, time_ + length});
    time_ += length;
    if (stream_.samples.size() == before)
      throw Error(ErrorKind::failure, fmt::format("{}: no sample came", device_.info().detail));
  }

  [[nodiscard]] const recorder::DeviceScript& stream() const { return stream_; }

 private:
  void take(std::int64_t begin) {
    recorder::DeviceInput input;
    pump_.drain(input);
    for (recorder::DeviceSample sample : input.samples) {
      sample.hostTime += time_ - begin;
      if (sample.hostTime >= time_) stream_.samples.push_back(sample);
    }
  }

  recorder::Device& device_;
  recorder::DevicePump pump_;
  recorder::DeviceScript stream_;
  std::int64_t time_ = 0;
};

/// @throws Error (invalid) where nobody could be guided
void requireTerminal() {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
    throw Error(ErrorKind::invalid, "calibrate: the guided steps need a terminal; --from FILE takes a recorded stream");
}

/// Measurements of the device while the person did the steps of its kind. @throws Error (failure) where no sample came
recorder::DeviceScript guidedSteps(recorder::Device& device, double strokeMillimetres) {
  requireTerminal();
  stopOnSignals();
  GuidedRecording recording(device);
  recording.run({{"rest"}, "1. Put the tools down and touch nothing (5 s).", 5.0});
  if (device.info().capabilities.absolute && device.info().capabilities.sensedRotations == 3) {
    recording.run(
        {{"pivot"},
         "2. Hold each tool's tip in a dimple and tilt the tool by 30 degrees and more in all directions (20 s).",
         20.0});
  }
  const auto stroke = [&](const char* phase, int number, const char* way) {
    const std::string text =
        fmt::format("{}. Wait a second, move each tip by {:g} mm {}, and hold it there until the 6 seconds are over.",
                    number, strokeMillimetres, way);
    recording.run({{phase}, text.c_str(), 6.0});
  };
  stroke("stroke right", 3, "to the right");
  stroke("stroke down", 4, "down");
  stroke("stroke away", 5, "away from you");
  if (device.info().name == recorder::cameraKind.name) {
    recording.run({{"trocar"},
                   "6. Put the sticks through the trocars and sweep them by 20 degrees in all directions (15 s).",
                   15.0});
  }
  return recording.stream();
}

struct CalibrateOptions {
  DeviceOptions device;
  std::string from, stream, output;
  double strokeMillimetres = 100.0;
  // Options of cameras.
  std::vector<std::string> board;
  std::string phases, pictures;
  double rulerMillimetres = recorder::rulerLength, readoutMilliseconds = 0.0;
  std::optional<double> pixelMillimetres;  ///< of a mouse alone
  std::uint32_t validDays = 30;
  bool force = false, json = false;
};

void printRig(const recorder::CameraRig& rig) {
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const recorder::CameraLens& lens = rig.cameras[i].lens;
    fmt::print("camera {}:\n", i + 1);
    fmt::print("  lens             {} x {}, focal length {:.1f} {:.1f} pixels, known to {:.2f} %\n", lens.width,
               lens.height, lens.focal.x(), lens.focal.y(), 100.0 * lens.focalUncertainty);
    fmt::print("  lens residual    {:.3f} pixels, {} views, {:.0f} % of the picture\n", lens.residual, lens.views,
               100.0 * lens.coverage);
    if (i > 0) {
      fmt::print("  beside camera 1  {:.1f} mm away, residual {:.3f} pixels\n",
                 1e3 * rig.cameras[i].fromDevice.position.norm(), rig.cameras[i].pairResidual);
    }
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    if (rig.trocar[h]) fmt::print("{} trocar: shaft within {:.2f} mm\n", handNames[h], 1e3 * rig.trocar[h]->residual);
  }
  if (rig.printScale != 1.0) fmt::print("sheets printed at {:.4f} of their size\n", rig.printScale);
}

void printCalibration(const recorder::Calibration& c, const std::vector<std::string>& faults) {
  fmt::print("{} ({})\n", c.identity, c.date);
  if (c.declaredPixel) {
    fmt::print("declared, not measured: the hand moves {:g} mm for a pixel\nvalid for {} days\n",
               1e3 * *c.declaredPixel, c.validDays);
    return;
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!c.hand[h]) continue;
    const recorder::HandCalibration& m = *c.hand[h];
    fmt::print("{}:\n", handNames[h]);
    if (m.tipOffset) {
      fmt::print("  tip offset       {:.2f} {:.2f} {:.2f} mm\n", 1e3 * m.tipOffset->x(), 1e3 * m.tipOffset->y(),
                 1e3 * m.tipOffset->z());
      fmt::print("  pivot residual   {:.3f} mm\n", 1e3 * *m.pivotResidual);
    } else {
      fmt::print("  tip offset       not measured\n");
    }
    if (m.scale) {
      fmt::print("  scale            {:.4f}, strokes apart by {:.1f} %\n", *m.scale, 100.0 * *m.scaleSpread);
      fmt::print("  axes             within {:.1f} degrees\n", 57.29577951308232 * *m.axesResidual);
    } else {
      fmt::print("  scale, axes      not measured\n");
    }
    fmt::print("  noise at rest    {:.3f} {:.3f} {:.3f} mm\n", 1e3 * m.noise.x(), 1e3 * m.noise.y(), 1e3 * m.noise.z());
    fmt::print("  rate             {:.1f} a second, intervals {:.2f} ms sd, {:.2f} ms at 99 %\n", m.rate,
               1e3 * m.jitter, 1e3 * m.longInterval);
    fmt::print("  invalid          {:.1f} %\n", 100.0 * m.invalidShare);
  }
  if (c.camera) printRig(*c.camera);
  fmt::print("latency: {}\nforce: {}\n", c.latency, c.force);
  for (const std::string& fault : faults) fmt::print("falls short: {}\n", fault);
  fmt::print("{}\n", faults.empty() ? fmt::format("passed; valid for {} days", c.validDays) : "failed");
}

void finishCalibration(const CalibrateOptions& o, const recorder::DeviceScript& stream,
                       recorder::Calibration calibration) {
  calibration.validDays = o.validDays;
  const std::vector<std::string> faults = recorder::shortcomings(calibration);
  if (!o.stream.empty()) recorder::writeText(o.stream, recorder::deviceScriptText(stream), o.force);
  recorder::writeText(o.output, recorder::calibrationText(calibration, false), o.force);
  if (o.json)
    fmt::print("{}", recorder::calibrationText(calibration, false));
  else
    printCalibration(calibration, faults);
  if (faults.empty()) return;
  throw Error(ErrorKind::refused, fmt::format("{}: the calibration failed: {}", o.output, faults.front()));
}

/// Lenses first; then the handles are a device like others.
void calibrateCamera(const CalibrateOptions& o) {
  const std::size_t colon = o.device.name.find(':');
  const recorder::CameraRequest request = recorder::parseCameraRequest(
      {o.device.name, colon == std::string::npos ? "" : o.device.name.substr(colon + 1), {}, nullptr});
  if (!request.live && o.board.empty())
    throw Error(ErrorKind::invalid,
                "calibrate: films of the handles need --board with films of the board by the same cameras");
  if (request.paced)
    throw Error(ErrorKind::invalid, "calibrate: every frame of a film counts, whatever its pace: leave out \"paced\"");
  if (request.live) requireTerminal();
  const recorder::RigSettings settings{o.rulerMillimetres / recorder::rulerLength, 1e-3 * o.readoutMilliseconds};
  if (!o.pictures.empty() && !std::filesystem::is_directory(o.pictures))
    throw Error(ErrorKind::invalid, Where{o.pictures}, "there is no such folder for the pictures");
  const std::vector<recorder::DeviceScript::Phase> stated =
      o.phases.empty() ? std::vector<recorder::DeviceScript::Phase>{} : recorder::parsePhases(o.phases);
  const recorder::RigFit fit = o.board.empty() ? recorder::measureRigLive(request, settings, promptStep)
                                               : recorder::measureRigFromFilms(o.board, settings);
  if (!o.pictures.empty()) writeCalibrationPictures(fit, o.pictures);
  recorder::Calibration lens;
  lens.identity = fit.identity;
  lens.camera = fit.rig;
  const recorder::OpenedDevice opened = recorder::openDevice(o.device.name, toolsOf(o.device), &lens);
  recorder::DeviceScript stream;
  if (request.live) {
    stream = guidedSteps(*opened.device, o.strokeMillimetres);
  } else {
    stream = recorder::streamOf(*opened.device, *opened.tickClock);
    const double seconds = stream.samples.empty() ? 0.0 : 1e-9 * static_cast<double>(stream.samples.back().hostTime);
    stream.phases = stated.empty() ? recorder::guidedPhases(seconds) : stated;
  }
  recorder::Calibration calibration =
      recorder::measureCalibration(stream, 1e-3 * o.strokeMillimetres, opened.device->info());
  calibration.camera = fit.rig;
  recorder::measureTrocars(stream, calibration);
  recorder::measureLatency(stream, request.live, calibration);
  return finishCalibration(o, stream, std::move(calibration));
}

/// Declares a mouse: the trainer's own, or one that is taken from the system.
void declareCalibration(const CalibrateOptions& o) {
  if (!o.from.empty() || !o.stream.empty())
    throw Error(ErrorKind::invalid, "calibrate: --from and --keep-stream measure; --pixel declares");
  const double pixel = 1e-3 * *o.pixelMillimetres;
  const bool ofWindow = o.device.name == recorder::mouseKind.name;
  const recorder::DeviceInfo device = ofWindow ? recorder::MouseDevice(std::make_shared<recorder::MouseInput>()).info()
                                               : recorder::openDevice(o.device.name, toolsOf(o.device)).device->info();
  return finishCalibration(o, {}, recorder::declaredCalibration(device, pixel));
}

void calibrate(const CalibrateOptions& o) {
  recorder::refuseOutput(o.output, o.force);
  if (!o.stream.empty()) recorder::refuseOutput(o.stream, o.force);
  if (recorder::findDeviceKind(o.device.name) == &recorder::cameraKind) return calibrateCamera(o);
  if (!o.board.empty() || !o.phases.empty() || !o.pictures.empty())
    throw Error(ErrorKind::invalid, "calibrate: --board, --phases and --pictures are for cameras only");
  if (o.pixelMillimetres) return declareCalibration(o);
  const recorder::OpenedDevice opened = recorder::openDevice(o.device.name, toolsOf(o.device));
  if (o.from.empty() && opened.tickClock) {
    throw Error(ErrorKind::invalid,
                fmt::format("calibrate {}: a device without real time is measured with --from FILE", o.device.name));
  }
  const recorder::DeviceScript stream =
      o.from.empty() ? guidedSteps(*opened.device, o.strokeMillimetres) : recorder::readDeviceScript(o.from);
  return finishCalibration(o, stream,
                           recorder::measureCalibration(stream, 1e-3 * o.strokeMillimetres, opened.device->info()));
}

}  // namespace

void addCalibrateDevice(CLI::App& devices, Run& run) {
  const auto [measure, c] = addCommand(devices, run,
                                       {"calibrate", "Measures a device in guided steps and stores the result.",
                                        "calot devices calibrate gamepad -o gamepad.json",
                                        "calot devices calibrate camera:0 -o camera.json --pictures ."},
                                       calibrate);
  measure->add_option("device", c->device.name, "as for record --device")->required();
  addTools(*measure, c->device);
  measure->add_option("--from", c->from, "measure this stream instead, recorded by --keep-stream");
  measure->add_option("--keep-stream", c->stream, "write what was measured from, for --from");
  addNumber(*measure, "--stroke", c->strokeMillimetres, "length of each stroke, mm", 10.0, 1000.0);
  measure->add_option("--board", c->board, "of cameras in films: films of the board by each of them, FILM[,FILM]")
      ->delimiter(',');
  measure->add_option("--phases", c->phases,
                      "of cameras in films: when each step was done, in seconds: rest=0:5,pivot=5:25,...");
  addNumber(*measure, "--ruler", c->rulerMillimetres, "of cameras: how long the sheets' ruler of 100 mm is, mm", 50.0,
            200.0);
  addNumber(*measure, "--readout", c->readoutMilliseconds,
            "of cameras: from the first row's exposure to the last one's, ms", 0.0, 100.0);
  measure->add_option("--pixel", c->pixelMillimetres,
                      "of a mouse, which is declared, not measured: how far the hand moves for a pixel, mm");
  measure->add_option("--pictures", c->pictures, "of cameras: write a PNG of each lens into this folder");
  addNumber(*measure, "--valid-days", c->validDays, "from today on", 1, 3650);
  measure->add_option("-o,--output", c->output, "the calibration, a JSON file")->required();
  measure->add_flag("--force", c->force, "replace the outputs if they are there");
  measure->add_flag("--json", c->json, "print the result as JSON");
}

}  // namespace calot::apps
