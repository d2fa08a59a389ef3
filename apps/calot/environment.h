// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands: location of assets, progress on a terminal, parsing of times.
// Ending a run in good order: what SIGINT, SIGTERM and SIGHUP ask for.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace calot::apps {

/// Folders that may hold scenes, organs and performers (recorder::ProgramFiles of this program).
std::vector<std::filesystem::path> assetFolders();

/// A JSON file of the assets by its name ("goals"), or any file by its path ("mine/goals.json").
/// @param folder of the assets: "forms". @param what messages call it: "form". @throws Error (invalid)
std::filesystem::path findAsset(const std::string& name, const std::string& folder, const std::string& what);
/// All of them, by name, or those of another ending.
std::vector<std::filesystem::path> listAssets(const std::string& folder, const char* ending = ".json");

/// Columns of the terminal behind a file descriptor; 0: there is none, or it does not say.
std::size_t columnsOfTerminal(int stream);

/// A line on a terminal that says what a command is doing, drawn again and again; nothing in a pipe or with --json.
/// Every command that may take a second makes one before its work, so that its first words are there at once.
class Progress {
 public:
  /// Draws the first words: "Replaying ...".
  /// @param doing "Replaying". @param unit of what show() counts: "steps"
  explicit Progress(std::string doing, bool quiet = false, std::string unit = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Goes on with other work, drawn at once.
  void next(std::string doing, std::string unit = {});
  /// "Replaying: 1200 of 4800 steps (25 %)". From any thread. @param of 0: no end is known
  void show(std::uint64_t done, std::uint64_t of);
  /// For work without countable parts: the share done, from 0 to 1. From any thread.
  void showShare(double share);
  /// Takes the line away, whichever Progress drew it: before anything else is printed, so that results never stand
  /// behind it. The next show() draws it again.
  static void erase();

 private:
  /// On a terminal, and not again at once.
  void draw(const std::string& text);

  std::string doing_, unit_;
  bool terminal_;
  std::chrono::steady_clock::time_point last_;
};

/// For CLI::Option::check: digits that fit 64 bits. The parser alone would wrap "-1" and saturate what is too large.
/// @return empty, or the fault
std::string wholeNumber(const std::string& text);

/// For CLI::Option::transform: a pseudonym, in one form of Unicode.
std::string pseudonymForm(std::string& name);

/// "12.5", "12.5s" or "1:02.5" in seconds. @throws Error (invalid)
double parseTime(const std::string& text);

/// From here on these signals ask to stop instead of ending the program.
void stopOnSignals();

/// Was it asked? The program itself may ask, too.
std::atomic<bool>& stopRequested();

/// @throws Error (invalid) naming the option, unless the text is 32 bytes in hexadecimal.
std::array<std::byte, 32> keyOf(const std::string& text, const char* option);

}  // namespace calot::apps
