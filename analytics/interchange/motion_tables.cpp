// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/motion_tables.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "analytics/checkpoints/movements.h"
#include "analytics/interchange/folder_output.h"

namespace calot::analytics {
namespace {

double timeOf(std::int64_t point) { return static_cast<double>(point) / motionRate; }

double timeOf(const MotionSegment& segment, std::size_t i) {
  return timeOf(segment.first + static_cast<std::int64_t>(i));
}

std::string pointsTable(const Motion& motion) {
  bool oriented = !motion.segments.empty();
  for (const MotionSegment& segment : motion.segments) oriented = oriented && !segment.orientation.empty();
  std::string text = "time (s),segment,x (m),y (m),z (m),";
  if (oriented) text += "orientation_w,orientation_x,orientation_y,orientation_z,";
  text += "speed (m/s),unfiltered_x (m),unfiltered_y (m),unfiltered_z (m),movement\n";
  const auto out = std::back_inserter(text);
  std::size_t number = 0, movement = 0;
  for (const MotionSegment& segment : motion.segments) {
    ++number;
    const std::vector<Stretch> movements = movementsOf(segment, motion.movementSpeed);
    std::size_t next = 0;
    for (std::size_t i = 0; i < segment.filtered.size(); ++i) {
      while (next < movements.size() && i >= movements[next].end) ++next;
      const Vec3 &p = segment.filtered[i], &raw = segment.raw[i];
      fmt::format_to(out, "{},{},{},{},{},", timeOf(segment, i), number, p.x(), p.y(), p.z());
      if (oriented) {
        const Quat& q = segment.orientation[i];
        fmt::format_to(out, "{},{},{},{},", q.w(), q.x(), q.y(), q.z());
      }
      fmt::format_to(out, "{},{},{},{},", segment.speed[i], raw.x(), raw.y(), raw.z());
      if (next < movements.size() && i >= movements[next].begin) fmt::format_to(out, "{}", movement + next + 1);
      text += '\n';
    }
    movement += movements.size();
  }
  return text;
}

void addSpans(std::string& text, const char* hand, const Motion& motion) {
  const auto out = std::back_inserter(text);
  const auto add = [&](const char* kind, std::size_t number, double begin, double end, const char* afterGap) {
    fmt::format_to(out, "{},{},{},{},{},{}\n", hand, kind, number, begin, end, afterGap);
  };
  std::size_t number = 0;
  for (const TimeSpan& span : motion.coverage.mounted) add("mounted", ++number, span.begin, span.end, "");
  number = 0;
  for (const TimeSpan& span : motion.coverage.lost) add("lost", ++number, span.begin, span.end, "");
  number = 0;
  for (const MotionSegment& s : motion.segments)
    add("segment", ++number, timeOf(s, 0), timeOf(s, s.filtered.size()), s.continues ? "true" : "false");
  number = 0;
  for (const MotionSegment& s : motion.segments) {
    for (const Stretch& m : movementsOf(s, motion.movementSpeed))
      add("movement", ++number, timeOf(s, m.begin), timeOf(s, m.end), "");
  }
}

nlohmann::ordered_json summaryOf(const Motion& motion) {
  nlohmann::ordered_json summary{{"mounted", motion.mounted}};
  const std::optional<double> share = motion.coverage.share();
  summary["coverage"] = share ? nlohmann::ordered_json(*share) : nlohmann::ordered_json(nullptr);
  summary["sample_rate_hz"] = motion.rate;
  summary["sample_interval_s"] = motion.interval;
  summary["movement_threshold_m_s"] = motion.movementSpeed;
  summary["points"] = motion.points();
  return summary;
}

}  // namespace

std::vector<std::filesystem::path> writeMotionTables(const std::array<Motion, handCount>& motion,
                                                     const std::filesystem::path& folder, bool force) {
  FolderOutput output(folder, force);
  std::string spans = "hand,kind,number,begin (s),end (s),after_gap\n";
  nlohmann::ordered_json summary{
      {"rate_hz", motionRate}, {"cutoff_hz", motion[0].cutoff}, {"filter", motionFilterText(motion[0].cutoff)}};
  for (std::size_t h = 0; h < motion.size(); ++h) {
    const char* hand = handNames[h];
    output.add(fmt::format("motion_{}.csv", hand), pointsTable(motion[h]));
    addSpans(spans, hand, motion[h]);
    summary[hand] = summaryOf(motion[h]);
  }
  output.add("spans.csv", spans);
  output.add("motion.json", summary.dump(2) + "\n");
  output.finish();
  std::vector<std::filesystem::path> files;
  for (const WrittenFile& file : output.files()) files.push_back(folder / file.name);
  return files;
}

}  // namespace calot::analytics
