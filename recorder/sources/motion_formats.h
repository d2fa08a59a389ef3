// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of motion as programs write them: one row a source. docs/how-to/motion-files.md names where each is described.
#pragma once

#include <string_view>
#include <utility>

namespace calot::recorder::motion_formats {

using Text = std::string_view;

/// A source: what its header looks like, and what its description fixes beyond the header. Small letters; '|' stands
/// between alternatives, '&' between what is there together.
struct Format {
  Text source;
  Text first = {};       ///< first cell of the file
  Text names = {};       ///< parts of names; blanks around whole ones
  Text device = {};      ///< class of tracker
  Text frame = "world";  ///< with '^' at its end: then the cell above the position
  Text length = {};      ///< unit, or "@" and the key before it in the first line; empty: beside the names
  Text rate = {};        ///< Hz, or "@" as above, or "#": the second line; empty: unknown
  Text bodies = {};      ///< parts of what is above and in the names of a hand
  Text others = {};      ///< parts of those of others
  Text clock = {};       ///< unit of the times; empty: as the name says
  Text valid = {};       ///< states of a measured pose
  Text rotation = {};    ///< nine columns behind a position, a "matrix" row by row, or angles (degrees) in this order
  Text jaw = {};         ///< ends of names of a jaw's angle (rad), which begin as the position's to the first '_'
};

inline constexpr Format formats[] = {
    {.source = "CSV file of OptiTrack Motive",
     .first = "format version",
     .device = "optical-tracker",
     .frame = "motive-global",
     .length = "@length units",
     .rate = "@export frame rate",
     .bodies = "rigid body ",
     .others = "marker"},
    {.source = "CSV file of Vicon",
     .first = "trajectories|objects",
     .device = "optical-tracker",
     .frame = "vicon-global",
     .rate = "#",
     .clock = "frame"},
    {.source = "sequence of PLUS or Slicer",
     .first = "sequence",
     .names = "_status &_r33 ",
     .frame = "plus-^",
     .length = "mm",
     .clock = "s",
     .valid = "OK"},
    {.source = "file of a Polhemus tracker",
     .first = "polhemus",
     .device = "polhemus-tracker",
     .frame = "polhemus-source",
     .clock = "ms",
     .rotation = "zyx"},
    {.source = "demonstration of robomimic",
     .first = "robomimic",
     .device = "robot-simulation",
     .frame = "robot-world",
     .rate = "@control_freq"},
    {.source = "CSV file of JIGSAWS",
     .names = "psml_rotation_0 &psmr_rotation_8 ",
     .device = "da-vinci",
     .frame = "jigsaws",
     .length = "m",
     .rate = "30",
     .bodies = "psml_|psmr_",
     .rotation = "matrix",
     .jaw = "gripper_angle"},
    {.source = "CSV file of the da Vinci research kit",
     .names = "psm1_pose.position.x|psm1_position_x|psml_position_x",
     .device = "da-vinci",
     .frame = "dvrk-base",
     .length = "m",
     .bodies = "psm",
     .others = "suj|rcm|_sp.|setpoint",
     .jaw = "jaw|gripper_angle"},
    {.source = "CSV file of an NDI tracker",
     .names = " q0 & tx ",
     .device = "ndi-tracker",
     .frame = "ndi-tracker",
     .length = "mm",
     .valid = "OK|Enabled"},
    {.source = "CSV file of a ROS topic", .names = "%time|field.|position.x", .length = "m"},
    {.source = "table"},
};

inline constexpr std::pair<Text, Text> lengthUnits[] = {
    {"mm", "mm"},    {"millimeters", "mm"}, {"cm", "cm"},   {"centimeters", "cm"}, {"m", "m"},
    {"meters", "m"}, {"inch", "inch"},      {"in", "inch"}, {"inches", "inch"}};

/// By the end of the column's name.
inline constexpr std::pair<Text, Text> timeUnits[] = {
    {"(seconds)", "s"}, {"[s]", "s"},   {"(s)", "s"},    {"_s", "s"},
    {"sec", "s"},       {"(ms)", "ms"}, {"[ms]", "ms"},  {"_ms", "ms"},
    {"[us]", "us"},     {"(us)", "us"}, {"_us", "us"},   {"[ns]", "ns"},
    {"(ns)", "ns"},     {"_ns", "ns"},  {"%time", "ns"}, {"field.header.stamp", "ns"}};

// Names of columns, the first that is there.
inline constexpr Text seconds = "timespec_s|sec|secs|header.stamp.sec|header.stamp.secs|stamp_sec",
                      nanoseconds = "timespec_ns|nanosec|nsec|nsecs|header.stamp.nanosec|header.stamp.nsecs|stamp_nsec",
                      clocks = "field.header.stamp|%time|time (seconds)|t|time|timestamp",
                      frames = "frame|frame#|frame number";

/// Parts of names of other quantities.
inline constexpr Text notPositions = "rot|quat|orient|angle|euler|vel|acc|twist|angular|force|torque|gyro|covariance";

}  // namespace calot::recorder::motion_formats
