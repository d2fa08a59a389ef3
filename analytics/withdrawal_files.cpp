// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/withdrawal_files.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <set>

#include "recorder/errors.h"
#include "recorder/recording/identify.h"

namespace calot::analytics {
namespace {

namespace fs = std::filesystem;

/// Does the file hold one of the words, somewhere in its bytes? Read in pieces that overlap.
bool fileNames(const fs::path& file, const std::vector<std::string>& words) {
  std::size_t longest = 1;
  for (const std::string& word : words) longest = std::max(longest, word.size());
  const std::size_t overlap = longest + 2;  // a word's neighbours tell whether it is one
  std::ifstream in(file, std::ios::binary);
  std::string window;
  std::string piece(std::size_t{1} << 20U, '\0');
  while (in) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    window.append(piece, 0, static_cast<std::size_t>(in.gcount()));
    for (const std::string& word : words) {
      if (namesWord(window, word)) return true;
    }
    if (window.size() > overlap) window.erase(0, window.size() - overlap);
  }
  return false;
}

bool isPicture(const fs::path& file) {
  static const std::set<std::string> kinds{".png", ".mp4", ".mkv", ".webm"};
  return kinds.count(file.extension().string()) > 0;
}

}  // namespace

WithdrawalFiles findFiles(const Withdrawal& w, const std::string& database, const std::vector<fs::path>& folders,
                          const std::vector<fs::path>& keep) {
  const std::vector<fs::path> files = recorder::filesUnder(folders);
  std::set<std::string> uuids(w.attempts.begin(), w.attempts.end());
  const auto kept = [&](const fs::path& file) {
    return std::any_of(keep.begin(), keep.end(), [&](const fs::path& k) {
      std::error_code ignored;
      return fs::equivalent(file, k, ignored);
    });
  };
  std::vector<std::optional<recorder::RecordingIdentity>> identity(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (kept(files[i]) || !recorder::looksLikeHdf5(files[i])) continue;
    try {
      identity[i] = recorder::identify(files[i]);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::failure) throw;  // damaged, or another kind of file: its bytes are searched
    }
  }
  const auto gone = [&](const recorder::RecordingIdentity& id) {
    if (uuids.count(id.attempt) > 0 || (!id.parent.empty() && uuids.count(id.parent) > 0)) return true;
    if (w.scope == WithdrawalScope::all && id.participant == w.pseudonym) return true;
    return wasWithdrawn(database, id.attempt) || (!id.parent.empty() && wasWithdrawn(database, id.parent));
  };
  WithdrawalFiles result;
  std::set<fs::path> remove;
  // A branch of a branch may stand before it in the list.
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (!identity[i] || remove.count(files[i]) > 0 || !gone(*identity[i])) continue;
      remove.insert(files[i]);
      if (uuids.insert(identity[i]->attempt).second) result.unknown.push_back(identity[i]->attempt);
      more = true;
    }
  }
  std::vector<std::string> words(uuids.begin(), uuids.end());
  const std::vector<std::string> attempts = words;
  if (w.scope == WithdrawalScope::all) words.push_back(w.pseudonym);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (identity[i] || kept(files[i]) || !recorder::looksLikeHdf5(files[i])) continue;
    if (fileNames(files[i], attempts)) remove.insert(files[i]);
  }
  const std::set<fs::path> recordings = remove;
  for (const fs::path& file : files) {
    if (remove.count(file) > 0 || kept(file)) continue;
    const bool beside = isPicture(file) && std::any_of(recordings.begin(), recordings.end(), [&](const fs::path& r) {
                          return r.parent_path() == file.parent_path() && r.stem() == file.stem();
                        });
    if (beside) {
      remove.insert(file);
    } else if (fileNames(file, words)) {
      result.naming.push_back(file);
    }
  }
  result.remove.assign(remove.begin(), remove.end());
  return result;
}

}  // namespace calot::analytics
