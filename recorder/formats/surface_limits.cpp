// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_limits.h"

#include <fmt/format.h>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

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
  throw Error(ErrorKind::invalid, fmt::format("unit \"{}\": m, cm or mm is wanted", shown(word)));
}

}  // namespace calot::recorder
