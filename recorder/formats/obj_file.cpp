// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/obj_file.h"

#include "recorder/base/file_bytes.h"
#include "recorder/base/text_output.h"

namespace calot::recorder {

TriangleMesh readObj(const std::filesystem::path& path, LengthUnit unit, const ObjLimits& limits) {
  return parseObj(readFileBytes(path, path.string(), limits.bytes), path.string(), unit, limits);
}

void writeObj(const std::filesystem::path& path, const TriangleMesh& mesh, const std::string& comment, bool force) {
  writeText(path, formatObj(mesh, comment), force);
}

}  // namespace calot::recorder
