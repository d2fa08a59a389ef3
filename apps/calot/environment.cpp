// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/environment.h"

#include <fmt/format.h>
#include <unistd.h>
#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/scene_file.h"

namespace calot::apps {
namespace {

/// A terminal has one last line.
std::atomic<bool> lineDrawn{false};

}  // namespace

std::vector<std::filesystem::path> assetFolders() { return recorder::ProgramFiles::ofThisProgram().assetRoots(); }

recorder::EnginePlaces enginePlaces() {
  const recorder::ProgramFiles files = recorder::ProgramFiles::ofThisProgram();
  return recorder::userEnginePlaces(files.programs(), files.assetRoots());
}

std::vector<std::filesystem::path> listAssets(const std::string& folder) {
  namespace fs = std::filesystem;
  std::map<std::string, fs::path> byName;
  for (const fs::path& root : assetFolders()) {
    std::error_code fault;
    for (fs::directory_iterator it(root / folder, fault), end; !fault && it != end; it.increment(fault)) {
      if (it->path().extension() == ".json") byName.emplace(it->path().stem().string(), it->path());
    }
  }
  std::vector<fs::path> files;
  files.reserve(byName.size());
  for (const auto& entry : byName) files.push_back(entry.second);
  return files;
}

std::filesystem::path findAsset(const std::string& name, const std::string& folder, const std::string& what) {
  std::error_code ignored;
  if (name.size() > 5 && name.substr(name.size() - 5) == ".json") {
    if (std::filesystem::is_regular_file(name, ignored)) return name;
    throw Error(ErrorKind::damaged, Where{name}, "there is no such file");
  }
  std::string known;
  std::vector<std::string> names;
  for (const std::filesystem::path& file : listAssets(folder)) {
    if (file.stem() == name) return file;
    names.push_back(file.stem().string());
    known += (known.empty() ? "" : ", ") + names.back();
  }
  throw Error(ErrorKind::invalid,
              fmt::format("there is no {} \"{}\"{}; {}", what, recorder::shown(name), recorder::didYouMean(name, names),
                          known.empty() ? "none was found (set CALOT_ASSETS)" : "there are " + known));
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)), terminal_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() { erase(); }

void Progress::erase() {
  if (!lineDrawn.exchange(false)) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

bool Progress::isDue() {
  if (!terminal_) return false;
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count();
  if (now - last_ < 100) return false;
  last_ = now;
  return true;
}

void Progress::draw(const std::string& text) {
  lineDrawn = true;
  std::fputs(("\r\033[K" + text).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::show(std::uint64_t done, std::uint64_t of) {
  if (!isDue()) return;
  draw(of > 0 ? fmt::format("{}: {} of {} ({:.0f} %)", what_, done, of,
                            100.0 * static_cast<double>(done) / static_cast<double>(of))
              : fmt::format("{}: {}", what_, done));
}

void Progress::showShare(double share) {
  if (isDue()) draw(fmt::format("{}: {:.0f} %", what_, 100.0 * share));
}

std::string wholeNumber(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size()
             ? ""
             : fmt::format("'{}' is not a whole number below 2^64", text);
}

double parseTime(const std::string& text) {
  std::string rest = text;
  if (!rest.empty() && rest.back() == 's') rest.pop_back();
  double minutes = 0.0;
  const auto number = [&](const std::string& part, double& out) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), out);
    return error == std::errc() && end == part.data() + part.size() && out >= 0.0 && out < 1e7;
  };
  const std::size_t colon = rest.find(':');
  double seconds = 0.0;
  bool good = true;
  if (colon != std::string::npos) {
    good = number(rest.substr(0, colon), minutes);
    rest = rest.substr(colon + 1);
  }
  good = good && number(rest, seconds);
  if (!good)
    throw Error(ErrorKind::invalid,
                fmt::format("'{}' is not a time: write seconds (12.5) or minutes and seconds (1:02.5)", text));
  return 60.0 * minutes + seconds;
}

namespace {
std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal's handler may do no more
}  // namespace

void stopOnSignals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { requested = true; });
}

std::atomic<bool>& stopRequested() { return requested; }

}  // namespace calot::apps
