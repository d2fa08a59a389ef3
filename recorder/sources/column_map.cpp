// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/column_map.h"

#include <utility>

#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"
#include "recorder/base/record_json.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxMapBytes = 1U << 20U;
constexpr double root = 0.70710678118654752440;  // of 1/2

constexpr TextRule columnName{200}, word{60, "^[!-~]+$", "a word without blanks is expected"}, note{500};

const FieldWords lengths{{"m", 0}, {"cm", 1}, {"mm", 2}, {"inch", 3}},
    times{{"s", 0}, {"ms", 1}, {"us", 2}, {"ns", 3}, {"frame", 4}, {"iso", 5}, {"time-of-day", 6}},
    axes{{"z", 0}, {"-z", 1}, {"x", 2}, {"-x", 3}, {"y", 4}, {"-y", 5}}, sides{{"right", 0}, {"left", 1}},
    orders{{"xyz", 0}, {"xzy", 1}, {"yxz", 2}, {"yzx", 3}, {"zxy", 4}, {"zyx", 5}},
    disorders{{"refuse", 0}, {"drop", 1}};

std::vector<Field> timeFields() {
  using S = ColumnMap;
  return {
      object("time", "Column of times, read to the picosecond; each is after the one before"),
      {"column", at<S, &S::time>, columnName, "Name of the column"},
      {"unit", at<S, &S::clock, &ClockFormat::unit>, times,
       "Unit of the times; frame: numbers of frames, with rate; iso: 2026-01-31T13:05:09.250Z; time-of-day: "
       "13:05:09.250 or 13:05:09:250"},
      optional("nanoseconds", at<S, &S::nanoseconds>, columnName, "Column of nanoseconds beside the one of seconds"),
      optional("zone", at<S, &S::clock, &ClockFormat::zone>,
               TextRule{6, "^(Z|[+-][0-9]{2}:[0-9]{2})$", "Z or +02:00 is expected"}, "Zone of dates that state none"),
      optional("wraps", at<S, &S::clock, &ClockFormat::wraps>, "", within(0, 1e15),
               "Number of units after which the counter begins again, as 65536; 0: never"),
  };
}

}  // namespace

std::vector<Field> HandColumns::fields() {
  using S = HandColumns;
  return {
      object("hand", "Columns of one hand's instrument"),
      Field("position", at<S, &S::position>, columnName, "x, y, z of the tip").items(3, 3),
      optional("quaternion", at<S, &S::orientation>, columnName,
               "w, x, y, z of the orientation of the instrument in the frame")
          .items(4, 4),
      optional("matrix", at<S, &S::orientation>, columnName,
               "The same as a rotation matrix, row by row; one of quaternion, matrix and angles, or none")
          .items(9, 9),
      optional("angles", at<S, &S::orientation>, columnName,
               "The same as three angles, in the order in which they rotate the instrument about its own axes")
          .items(3, 3),
      optional("order", unstored<bool>, orders, "Axes of the angles; zyx if absent (azimuth, elevation, roll)"),
      optional("radians", at<S, &S::radians>, "Angles are in radians, not in degrees"),
      optional("axis", unstored<bool>, axes, "The instrument's axis towards its tip, in its own frame; z if absent"),
      optional("status", at<S, &S::status>, columnName, "Column of the tracker's state, with valid"),
      optional("valid", at<S, &S::valid>, columnName, "States in which the pose was measured; others are missing")
          .items(1, 20),
      optional("jaw", at<S, &S::jaw>, columnName, "Column of the jaw's opening angle (rad)"),
      optional("pedal", at<S, &S::pedal>, columnName, "Column of a pedal or button of this hand: 0 is released"),
  };
}

std::vector<Field> ColumnMap::fields() {
  using S = ColumnMap;
  return {
      object("",
             "Columns of a CSV file of instrument motion, their units and their frame. "
             "One of the file's first lines names its columns; \"left/Position/X\" is the column X below the cells "
             "left and Position"),
      fileFormat("calot-columns"),
      fileFormatVersion(),
      optional("device", at<S, &S::device>, word,
               "Class of tracker, a word without blanks: attempts of different classes are not compared"),
      {"frame", at<S, &S::frame>, word,
       "Frame of positions and orientations, a word without blanks: world, robot-base, camera; attempts of different "
       "frames are not compared"},
      optional("handed", unstored<bool>, sides, "Handedness of the frame; a left-handed one has its z reversed"),
      {"length", unstored<bool>, lengths, "Unit of the positions"},
      optional("delimiter", at<S, &S::style, &TableStyle::delimiter>,
               FieldWords{{"auto", 0}, {",", ','}, {";", ';'}, {"tab", '\t'}},
               "Character between cells; auto: comma, semicolon or tab, whichever the names stand between"),
      optional("decimal", at<S, &S::style, &TableStyle::decimal>, FieldWords{{"auto", 0}, {".", '.'}, {",", ','}},
               "Decimal mark; auto: a point, or a comma where cells are separated otherwise"),
      optional(
          "missing", at<S, &S::style, &TableStyle::missing>, columnName,
          "Cells that mark what was not measured, beside empty ones, NaN, NA, null, none, missing, lost and the like")
          .items(1, 20),
      optional("skip", at<S, &S::style, &TableStyle::skip>, "", within(0, 40),
               "Lines below the names that are no rows; a line of units is found"),
      optional("demonstration", at<S, &S::style, &TableStyle::demonstration>, columnName,
               "Demonstration of a robomimic file that has several: demo_0"),
      optional("rate", at<S, &S::rate>, "Hz", within(1, 100000),
               "Rate of rows, where there is no column of times, or of frames. Either this or time"),
      optional("time", keyGroup<S, timeFields>, "Column of times"),
      optional("disorder", at<S, &S::dropsDisorder>, disorders,
               "Rows whose time is not after the row before: refuse the file, or drop them, which is counted"),
      optional("verified", at<S, &S::verified>,
               "Units and samples were checked: none is refused or left out for a speed, a rate or a jump"),
      optional("left", at<S, &S::hand, 0>, "Left hand"),
      optional("right", at<S, &S::hand, 1>, "Right hand; at least one hand is expected"),
      optional("notes", at<S, &S::notes>, note, "Remarks, for people").items(0, 50),
  };
}

namespace {

void checkHand(const JsonPlace& place, HandColumns& hand, bool leftHanded) {
  const int forms = (place.has("quaternion") ? 1 : 0) + (place.has("matrix") ? 1 : 0) + (place.has("angles") ? 1 : 0);
  if (forms > 1) place.fail("has several of quaternion, matrix and angles; one of them is expected");
  if (place.has("status") != place.has("valid")) place.fail("\"status\" and \"valid\" are expected together");
  for (const char* key : {"order", "radians"}) {
    if (place.has(key) && !place.has("angles")) place.at(key).fail("of angles that are not there");
  }
  if (place.has("order")) {
    constexpr std::array<int, 3> sequences[] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    hand.sequence = sequences[place.at("order").word(orders)];
  }
  std::uint32_t axis = 0;
  if (place.has("axis")) {
    if (hand.orientation.empty()) place.at("axis").fail("an axis without an orientation");
    axis = place.at("axis").word(axes);
  }
  if (leftHanded && axis < 2) axis ^= 1U;  // z is reversed
  const Quat rotations[] = {Quat::Identity(),
                            Quat(0.0, 1.0, 0.0, 0.0),
                            Quat(root, 0.0, root, 0.0),
                            Quat(root, 0.0, -root, 0.0),
                            Quat(root, -root, 0.0, 0.0),
                            Quat(root, root, 0.0, 0.0)};
  hand.axis = rotations[axis];
}

}  // namespace

ColumnMap readColumnMap(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseColumnMap(readFileBytes(file, name, maxMapBytes), name);
}

ColumnMap parseColumnMap(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = parseStrictJson(bytes, file);
  const JsonPlace place(json, file);
  constexpr double metres[] = {1.0, 0.01, 0.001, 0.0254};
  ColumnMap map;
  readRecord(place, map);
  map.metres = metres[place.at("length").word(lengths)];
  map.leftHanded = place.has("handed") && place.at("handed").word(sides) == 1;
  const bool frames = place.has("time") && map.clock.unit == ClockUnit::frame;
  if (!frames && place.has("rate") == place.has("time"))
    place.fail("either \"rate\" (rows a second) or \"time\" (a column) is expected");
  if (frames && !place.has("rate")) place.fail("numbers of frames need \"rate\" (frames a second)");
  if (!map.nanoseconds.empty() && map.clock.unit != ClockUnit::s)
    place.at("time").at("nanoseconds").fail("beside seconds alone");
  map.clock.rate = map.rate;
  if (place.has("time")) map.rate = 0.0;
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (map.hand[h]) checkHand(place.at(handNames[h]), *map.hand[h], map.leftHanded);
  }
  if (!map.hand[0] && !map.hand[1]) place.fail("neither \"left\" nor \"right\": a hand is expected");
  return map;
}

}  // namespace calot::recorder
