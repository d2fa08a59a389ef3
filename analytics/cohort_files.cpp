// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort_files.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "analytics/cohort/cohort_database.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/recording_facts.h"

namespace calot::analytics {

RecordingsFound::RecordingsFound(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool) {
  const std::vector<std::filesystem::path> files = recorder::filesUnder(places);
  std::vector<std::optional<recorder::RecordingIdentity>> identity(files.size());
  std::vector<std::optional<Error>> fault(files.size());
  const auto look = [&](std::size_t i) {
    const bool named = std::find(places.begin(), places.end(), files[i]) != places.end();
    if (!named && !recorder::looksLikeHdf5(files[i])) return;
    try {
      identity[i] = recorder::identify(files[i]);
    } catch (const Error& e) {
      fault[i] = e;
    } catch (const std::exception& e) {
      fault[i] = Error(ErrorKind::failure, Where{files[i].string()}, e.what());
    }
  };
  pool.run(files.size(), look);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (identity[i]) byUuid_[identity[i]->attempt].push_back({files[i], *identity[i]});
    if (fault[i]) notRead_.push_back(*fault[i]);
  }
}

std::optional<std::filesystem::path> RecordingsFound::of(const AttemptRow& a) const {
  const auto at = byUuid_.find(a.uuid);
  if (at == byUuid_.end()) return std::nullopt;
  const auto better = [&](const Entry& x, const Entry& y) {
    const bool mine = x.identity.chainHead == a.chainHead, yours = y.identity.chainHead == a.chainHead;
    if (mine != yours) return mine;
    const bool mineNamed = x.file.filename() == a.fileName, yoursNamed = y.file.filename() == a.fileName;
    if (mine && mineNamed != yoursNamed) return mineNamed;
    if (x.identity.steps != y.identity.steps) return x.identity.steps > y.identity.steps;
    return x.file < y.file;
  };
  return std::min_element(at->second.begin(), at->second.end(), better)->file;
}

std::vector<std::filesystem::path> recordingsUnder(const std::vector<std::filesystem::path>& places) {
  std::vector<std::filesystem::path> files = recorder::filesUnder(places);
  std::erase_if(files, [&](const std::filesystem::path& file) {
    const bool named = std::find(places.begin(), places.end(), file) != places.end();
    return !named && !recorder::looksLikeHdf5(file);
  });
  if (files.empty())
    throw Error(ErrorKind::damaged, Where{places.empty() ? "" : places.front().string()},
                "there are no recordings in it");
  return files;
}

namespace {

namespace fs = std::filesystem;

/// Characters that delimit a pseudonym as a separate value: of a cell, a string, a word of a sentence.
bool separates(char c) {
  return static_cast<unsigned char>(c) <= ' ' || std::string_view(",;|\"'`<>()[]{}=").find(c) != std::string_view::npos;
}

/// Is this occurrence in a text a value of its own, and no part of a longer name, a number or a time?
bool standsAlone(std::string_view text, std::size_t at, std::size_t size) {
  if (at > 0 && !separates(text[at - 1])) return false;
  const std::size_t end = at + size;
  if (end == text.size() || separates(text[end])) return true;
  const bool closes = std::string_view(".:!?").find(text[end]) != std::string_view::npos;
  return closes && (end + 1 == text.size() || separates(text[end + 1]));
}

/// Search terms for a file's bytes.
struct Wanted {
  const std::vector<std::string>& uuids;  ///< anywhere: none of them is there by chance
  std::string pseudonym;                  ///< in text, as a value; empty: not searched for
};

/// Text has no zero byte among its first ones.
bool isText(std::string_view bytes) { return bytes.substr(0, 4096).find('\0') == std::string_view::npos; }

/// Does the file hold what is wanted? Read in pieces that overlap.
bool fileHolds(const fs::path& file, const Wanted& wanted) {
  std::size_t overlap = wanted.pseudonym.size() + 2;
  for (const std::string& uuid : wanted.uuids) overlap = std::max(overlap, uuid.size());
  std::ifstream in(file, std::ios::binary);
  std::string window;
  std::string piece(std::size_t{1} << 20U, '\0');
  bool first = true, text = false;
  while (in) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    window.append(piece, 0, static_cast<std::size_t>(in.gcount()));
    if (first) text = isText(window);
    for (const std::string& uuid : wanted.uuids) {
      if (window.find(uuid) != std::string::npos) return true;
    }
    const std::string& name = wanted.pseudonym;
    for (std::size_t at = text && !name.empty() ? window.find(name) : std::string::npos; at != std::string::npos;
         at = window.find(name, at + 1)) {
      // At an edge, the neighbouring character is in the next piece or was in the previous one.
      const bool whole = (at > 0 || first) && (at + name.size() + 1 < window.size() || !in);
      if (whole && standsAlone(window, at, name.size())) return true;
    }
    first = false;
    if (window.size() > overlap) window.erase(0, window.size() - overlap);
  }
  return false;
}

/// Another cohort that has the participant. What is no cohort has none.
bool hasParticipant(const fs::path& file, const std::string& pseudonym) {
  std::array<char, 16> begin{};
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), begin.size());
  if (!in || std::memcmp(begin.data(), "SQLite format 3", begin.size()) != 0) return false;
  try {
    const auto known = CohortDatabase(file.string(), CohortDatabase::Access::read).participants();
    return std::any_of(known.begin(), known.end(), [&](const Participant& p) { return p.pseudonym == pseudonym; });
  } catch (const Error&) {
    return false;
  }
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
  const std::vector<std::string> attempts(uuids.begin(), uuids.end());
  const std::string pseudonym = w.scope == WithdrawalScope::all ? w.pseudonym : "";
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (identity[i] || kept(files[i]) || !recorder::looksLikeHdf5(files[i])) continue;
    if (fileHolds(files[i], {attempts, ""})) remove.insert(files[i]);
  }
  const std::set<fs::path> recordings = remove;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const fs::path& file = files[i];
    if (identity[i] || remove.count(file) > 0 || kept(file)) continue;
    const bool beside = isPicture(file) && std::any_of(recordings.begin(), recordings.end(), [&](const fs::path& r) {
                          return r.parent_path() == file.parent_path() && r.stem() == file.stem();
                        });
    if (beside) {
      remove.insert(file);
    } else if ((!pseudonym.empty() && (file.stem() == pseudonym || hasParticipant(file, pseudonym))) ||
               fileHolds(file, {attempts, pseudonym})) {
      result.naming.push_back(file);
    }
  }
  result.remove.assign(remove.begin(), remove.end());
  return result;
}

Share shareNamed(const std::string& text) {
  Share share;
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](std::uint32_t& out) {
    const auto [next, error] = std::from_chars(at, end, out);
    at = next;
    return error == std::errc();
  };
  const bool read = number(share.number) && at != end && *at++ == '/' && number(share.of) && at == end;
  if (!read || share.of < 1 || share.of > maxShares || share.number < 1 || share.number > share.of) {
    throw Error(ErrorKind::invalid, fmt::format("'{}' is not a share: write 3/8 for the third of eight (at most {})",
                                                recorder::shown(text), maxShares));
  }
  return share;
}

std::vector<std::size_t> indicesOf(const Share& share,
                                   const std::vector<std::pair<std::uint64_t, std::string>>& files) {
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(files[b].first, files[a].second) < std::tie(files[a].first, files[b].second);
  });
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t round = i / share.of, place = i % share.of;
    if ((round % 2 == 0 ? place : share.of - 1 - place) + 1 == share.number) own.push_back(order[i]);
  }
  std::sort(own.begin(), own.end());
  return own;
}

std::vector<std::filesystem::path> filesOf(const Share& share, const std::vector<std::filesystem::path>& files) {
  std::vector<std::pair<std::uint64_t, std::string>> sized;
  for (const std::filesystem::path& file : files) {
    std::error_code gone;
    const std::uintmax_t bytes = std::filesystem::file_size(file, gone);
    sized.emplace_back(gone ? 0 : bytes, file.string());
  }
  std::vector<std::filesystem::path> own;
  for (const std::size_t i : indicesOf(share, sized)) own.push_back(files[i]);
  return own;
}

}  // namespace calot::analytics
