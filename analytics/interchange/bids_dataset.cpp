// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/bids_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "analytics/interchange/folder_output.h"
#include "recorder/attempt.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* missing = "n/a";

/// Letters and digits of a name. @throws Error (refused) where none is left, or another name has the same
std::string labelOf(const std::string& name, const std::string& file, const char* what,
                    std::map<std::string, std::string>& taken) {
  std::string label;
  for (const char c : name) {
    if ((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z')) label += c;
  }
  if (label.empty()) throw Error(ErrorKind::refused, Where{file}, fmt::format("names no {}", what));
  const auto [at, added] = taken.emplace(label, name);
  if (!added && at->second != name)
    throw Error(ErrorKind::refused, Where{file},
                fmt::format("{} \"{}\" and \"{}\" have the same label \"{}\": BIDS allows letters and digits alone",
                            what, at->second, name, label));
  return label;
}

struct Channel {
  std::string name, component, type, point, units;
};

std::vector<Channel> channelsOf(const BidsAttempt& attempt, const std::array<bool, handCount>& oriented) {
  std::vector<Channel> channels;
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    if (attempt.motion[hand].segments.empty()) continue;
    const std::string point = fmt::format("{}_tip", handNames[hand]);
    for (const char* axis : {"x", "y", "z"})
      channels.push_back({fmt::format("{}_{}", handNames[hand], axis), axis, "POS", point, "m"});
    if (!oriented[hand]) continue;
    for (const char* part : {"quat_w", "quat_x", "quat_y", "quat_z"})
      channels.push_back({fmt::format("{}_{}", handNames[hand], part), part, "ORNT", point, missing});
  }
  return channels;
}

/// Whether each segment of a hand's motion has orientations.
bool isOriented(const Motion& motion) {
  return !motion.segments.empty() && std::all_of(motion.segments.begin(), motion.segments.end(),
                                                 [](const MotionSegment& s) { return !s.orientation.empty(); });
}

/// Walks through a hand's segments point by point.
class MotionCells {
 public:
  MotionCells(const Motion& motion, bool oriented) : motion_(motion), oriented_(oriented) {}

  /// Cells of the point k of the grid. @pre called with ascending k
  void addCells(std::int64_t k, std::vector<std::string>& cells) {
    const std::vector<MotionSegment>& segments = motion_.segments;
    while (segment_ < segments.size() &&
           k >= segments[segment_].first + static_cast<std::int64_t>(segments[segment_].raw.size()))
      ++segment_;
    const std::size_t count = oriented_ ? 7 : 3;
    if (segment_ == segments.size() || k < segments[segment_].first) {
      cells.insert(cells.end(), count, missing);
      return;
    }
    const MotionSegment& segment = segments[segment_];
    const auto i = static_cast<std::size_t>(k - segment.first);
    const Vec3& p = segment.raw[i];
    for (const double v : {p.x(), p.y(), p.z()}) cells.push_back(fmt::format("{}", v));
    if (!oriented_) return;
    const Quat& q = segment.orientation[i];
    for (const double v : {q.w(), q.x(), q.y(), q.z()}) cells.push_back(fmt::format("{}", v));
  }

 private:
  const Motion& motion_;
  bool oriented_;
  std::size_t segment_ = 0;
};

std::string motionTable(const BidsAttempt& attempt, const std::array<bool, handCount>& oriented, std::int64_t points) {
  std::vector<MotionCells> readers;
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    if (!attempt.motion[hand].segments.empty()) readers.emplace_back(attempt.motion[hand], oriented[hand]);
  }
  std::string text;
  std::vector<std::string> cells;
  for (std::int64_t k = 0; k < points; ++k) {
    cells.clear();
    for (MotionCells& reader : readers) reader.addCells(k, cells);
    fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(cells, "\t"));
  }
  return text;
}

Json motionJson(const BidsAttempt& attempt, const std::vector<Channel>& channels, std::int64_t points) {
  const auto ofType = [&](const char* type) {
    return std::count_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.type == type; });
  };
  std::string note = "Tips of the instruments in the frame of the scene's world.";
  if (attempt.synthetic) note += " Synthetic: made by a performer, not by a person.";
  return {{"TaskName", attempt.task},
          {"TaskDescription", note},
          {"SamplingFrequency", motionRate},
          {"RecordingDuration", static_cast<double>(points) / motionRate},
          {"RecordingType", "continuous"},
          {"MissingValues", missing},
          {"MotionChannelCount", channels.size()},
          {"POSChannelCount", ofType("POS")},
          {"ORNTChannelCount", ofType("ORNT")},
          {"TrackedPointsCount", ofType("POS") / 3},
          {"TrackingSystemName", attempt.device},
          {"SoftwareVersions", recorder::softwareName()},
          {"SoftwareFilters", {{"resampling", {{"rate (Hz)", motionRate}}}}}};
}

std::string channelTable(const std::vector<Channel>& channels) {
  std::string text = "name\tcomponent\ttype\ttracked_point\tunits\treference_frame\n";
  for (const Channel& c : channels)
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\tworld\n", c.name, c.component, c.type, c.point,
                   c.units);
  return text;
}

/// What the column reference_frame of a channel table means.
Json frameJson() {
  return {{"reference_frame",
           {{"Description", "frame that positions and orientations are given in"},
            {"Levels", {{"world", {{"RotationRule", "right-hand"}}}}}}}};
}

std::string textOf(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

const char* readme() {
  return "Motion of laparoscopic instruments in simulated or tracked tasks, written by Calot.\n\n"
         "Each motion is of the instruments' tips in the frame of the world (x to the patient's right, y anterior, z "
         "cranial), in metres, at 100 Hz from the "
         "begin "
         "of the attempt; the orientation of an instrument is a unit quaternion of the rotation from the instrument to "
         "the world. Motion is resampled from the recorded samples; positions are not filtered. Where nothing was "
         "measured there is n/a. Dates are left out. `synthetic` in participants.tsv says whose motion was made by a "
         "program.\n";
}

}  // namespace

std::vector<fs::path> writeBidsDataset(std::vector<BidsAttempt> attempts, const fs::path& folder, bool force) {
  if (attempts.empty()) throw Error(ErrorKind::invalid, "a data set wants at least one attempt");
  std::stable_sort(attempts.begin(), attempts.end(), [](const BidsAttempt& a, const BidsAttempt& b) {
    return a.participant != b.participant ? a.participant < b.participant : a.startUtc < b.startUtc;
  });
  FolderOutput out(folder, force);
  std::map<std::string, std::string> subjects, tasks, systems;
  std::map<std::string, int> runs;
  std::map<std::string, bool> people;
  for (const BidsAttempt& a : attempts) {
    const std::string subject = labelOf(a.participant, a.file, "participant", subjects);
    const std::string prefix =
        fmt::format("sub-{}_task-{}_tracksys-{}", subject, labelOf(a.task, a.file, "task", tasks),
                    labelOf(a.device, a.file, "tracking system", systems));
    const std::array<bool, handCount> oriented{isOriented(a.motion[0]), isOriented(a.motion[1])};
    const std::vector<Channel> channels = channelsOf(a, oriented);
    if (channels.empty()) throw Error(ErrorKind::refused, Where{a.file}, "holds no motion of an instrument");
    bool& synthetic = people[subject];
    synthetic = synthetic || a.synthetic;
    const auto points = static_cast<std::int64_t>(std::floor(a.seconds * motionRate)) + 1;
    const std::string name = fmt::format("sub-{}/motion/{}_run-{}", subject, prefix, ++runs[prefix]);
    std::error_code ignored;  // add() says what is wrong
    fs::create_directories(out.folder() / fmt::format("sub-{}", subject) / "motion", ignored);
    out.add(name + "_motion.tsv", motionTable(a, oriented, points));
    out.add(name + "_motion.json", textOf(motionJson(a, channels, points)));
    out.add(name + "_channels.tsv", channelTable(channels));
    out.add(name + "_channels.json", textOf(frameJson()));
  }
  std::string table = "participant_id\tsynthetic\n";
  for (const auto& [subject, synthetic] : people)
    fmt::format_to(std::back_inserter(table), "sub-{}\t{}\n", subject, synthetic ? "yes" : "no");
  out.add("participants.tsv", table);
  out.add("participants.json",
          textOf({{"participant_id", {{"Description", "pseudonym of the participant"}}},
                  {"synthetic",
                   {{"Description", "whether motion of this participant was made by a performer, not by a person"},
                    {"Levels", {{"yes", "made by a program"}, {"no", "made by a person"}}}}}}));
  const std::string software = recorder::softwareName();  // "calot 0.1.0"
  out.add("dataset_description.json",
          textOf({{"Name", "Instrument motion of laparoscopic tasks"},
                  {"BIDSVersion", "1.9.0"},
                  {"DatasetType", "raw"},
                  {"GeneratedBy",
                   Json::array({{{"Name", "calot"}, {"Version", software.substr(software.find(' ') + 1)}}})}}));
  out.add("README", readme());
  out.finish();
  std::vector<fs::path> files;
  for (const WrittenFile& file : out.files()) files.push_back(folder / file.name);
  return files;
}

}  // namespace calot::analytics
