// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>
#include <algorithm>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/obj.h"
#include "recorder/formats/ply.h"
#include "recorder/formats/stl.h"

namespace calot::recorder {

double metres(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::centimetre:
      return 0.01;
    case LengthUnit::millimetre:
      return 0.001;
    case LengthUnit::metre:
      break;
  }
  return 1.0;
}

LengthUnit parseLengthUnit(const std::string& word) {
  if (word == "m") return LengthUnit::metre;
  if (word == "cm") return LengthUnit::centimetre;
  if (word == "mm") return LengthUnit::millimetre;
  throw Error(ErrorKind::invalid, fmt::format("unit \"{}\": m, cm or mm is expected", shown(word)));
}

namespace {

enum class Format { none, obj, stl, ply };

Format formatOf(const std::string& name) {
  std::string end = name.size() < 4 ? std::string() : name.substr(name.size() - 4);
  std::transform(end.begin(), end.end(), end.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (end == ".obj") return Format::obj;
  if (end == ".stl") return Format::stl;
  if (end == ".ply") return Format::ply;
  return Format::none;
}

}  // namespace

bool isSurfaceName(const std::string& name) { return formatOf(name) != Format::none; }

TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits) {
  switch (formatOf(name)) {
    case Format::obj:
      return parseObj(bytes, name, unit, limits);
    case Format::stl:
      return parseStl(bytes, name, unit, limits);
    case Format::ply:
      return parsePly(bytes, name, unit, limits);
    case Format::none:
      break;
  }
  throw Error(ErrorKind::damaged, Where{name}, "surfaces are read from .obj, .stl and .ply files");
}

}  // namespace calot::recorder
