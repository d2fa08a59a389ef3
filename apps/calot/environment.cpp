// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/environment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <system_error>
#include <utility>

#include "analytics/report/report_document.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/names.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/scene_file.h"

namespace calot::apps {
namespace {

/// A terminal has one last line.
std::mutex drawing;
bool lineDrawn = false;

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal's handler may do no more

}  // namespace

std::vector<std::filesystem::path> assetFolders() { return recorder::ProgramFiles::ofThisProgram().assetRoots(); }

std::vector<std::filesystem::path> listAssets(const std::string& folder, const char* ending) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, file] : recorder::filesIn(assetFolders(), folder, ending)) files.push_back(file);
  return files;
}

std::filesystem::path findAsset(const std::string& name, const std::string& folder, const std::string& what) {
  std::error_code ignored;
  if (name.size() > 5 && name.ends_with(".json")) {
    if (std::filesystem::is_regular_file(name, ignored)) return name;
    throw Error(ErrorKind::damaged, Where{name}, "there is no such file");
  }
  std::vector<std::string> names;
  for (const std::filesystem::path& file : listAssets(folder)) {
    if (file.stem() == name) return file;
    names.push_back(file.stem().string());
  }
  throw Error(ErrorKind::invalid,
              fmt::format("there is no {} \"{}\"{}; {}", what, recorder::shown(name), recorder::didYouMean(name, names),
                          names.empty() ? "none was found (set CALOT_ASSETS)"
                                        : fmt::format("there are {}", fmt::join(names, ", "))));
}

std::size_t columnsOfTerminal(int stream) {
  winsize size{};
  return isatty(stream) != 0 && ioctl(stream, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

Progress::Progress(std::string doing, bool quiet, std::string unit) : terminal_(!quiet && isatty(STDERR_FILENO) != 0) {
  next(std::move(doing), std::move(unit));
}

void Progress::next(std::string doing, std::string unit) {
  doing_ = std::move(doing);
  unit_ = unit.empty() ? std::move(unit) : " " + unit;
  last_ = {};
  draw(doing_ + " ...");
}

Progress::~Progress() { erase(); }

void Progress::erase() {
  const std::lock_guard lock(drawing);
  if (!std::exchange(lineDrawn, false)) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

void Progress::draw(const std::string& text) {
  if (!terminal_) return;
  const std::lock_guard lock(drawing);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  lineDrawn = true;
  // A line that is wrapped could not be taken away.
  const std::size_t columns = columnsOfTerminal(STDERR_FILENO);
  std::fputs(("\r\033[K" + (columns > 4 ? analytics::cutTo(text, columns - 1) : text)).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::show(std::uint64_t done, std::uint64_t of) {
  draw(of > 0 ? fmt::format("{}: {} of {}{} ({:.0f} %)", doing_, done, of, unit_,
                            100.0 * static_cast<double>(done) / static_cast<double>(of))
              : fmt::format("{}: {}{}", doing_, done, unit_));
}

void Progress::showShare(double share) { draw(fmt::format("{}: {:.0f} %", doing_, 100.0 * share)); }

std::string wholeNumber(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size()
             ? ""
             : fmt::format("'{}' is not a whole number below 2^64", text);
}

std::string pseudonymForm(std::string& name) {
  name = recorder::composedName(name);
  return name.size() > 64 ? "longer than 64 characters" : "";
}

double parseTime(const std::string& text) {
  bool good = true;
  const auto number = [&](std::string_view part) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    good = good && error == std::errc() && end == part.data() + part.size() && value >= 0.0 && value < 1e7;
    return value;
  };
  std::string_view seconds = text;
  if (seconds.ends_with('s')) seconds.remove_suffix(1);
  double minutes = 0.0;
  if (const std::size_t colon = seconds.find(':'); colon != std::string_view::npos) {
    minutes = number(seconds.substr(0, colon));
    seconds.remove_prefix(colon + 1);
  }
  const double time = 60.0 * minutes + number(seconds);
  if (good) return time;
  throw Error(ErrorKind::invalid,
              fmt::format("'{}' is not a time: write seconds (12.5) or minutes and seconds (1:02.5)", text));
}

void stopOnSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const auto before = std::signal(signal, [](int) { requested = true; });
    if (signal == SIGHUP && before == SIG_IGN) std::signal(signal, SIG_IGN);  // nohup
  }
}

std::atomic<bool>& stopRequested() { return requested; }

std::array<std::byte, 32> keyOf(const std::string& text, const char* option) {
  std::array<std::byte, 32> bytes{};
  if (!recorder::readHex(text, bytes))
    throw Error(ErrorKind::invalid, fmt::format("{}: 64 hexadecimal digits are expected", option));
  return bytes;
}

}  // namespace calot::apps
