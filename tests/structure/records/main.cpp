// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that are generated from the tables of records and committed: schemas/*.schema.json and pages of keys.
//
// usage: record_texts ROOT (--check | --write)
// Exit code: 0; 1 where a committed text differs (--check); 2 for wrong usage.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analytics/assessment/course.h"
#include "analytics/assessment/protocol.h"
#include "analytics/assessment/rating_form.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/sources/column_map.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/performer_profile.h"
#include "sim/scene/description.h"
#include "tests/structure/records/json_schema.h"
#include "tests/structure/records/key_tables.h"

namespace {

using namespace calot;
using nlohmann::ordered_json;

/// File, relative to the root, and its text.
using Texts = std::vector<std::pair<std::string, std::string>>;

Texts texts() {
  using structure::jsonSchema;
  ordered_json scene = jsonSchema("Calot scene", "docs/reference/scenes.md", recordOf<SceneDescription>(),
                                  {&recordOf<recorder::MeshFile>()});
  // A rule across fields that a schema can state.
  scene["$defs"]["anchor"]["minProperties"] = 1;
  scene["$defs"]["anchor"]["maxProperties"] = 1;
  const std::string scenePage = "scene-keys.md", tissuePage = "scene-tissue-keys.md";
  const auto ofTissue = [](const std::string& definition) {
    return std::set<std::string>{"organ",      "mesh",   "material",  "anchor", "sphere",        "nearOrgan",
                                 "connective", "vessel", "vesselEnd", "fat",    "fatAttachment", "fatTriangle"}
        .contains(definition);
  };
  const auto ofScene = [&](const std::string& definition) { return !ofTissue(definition); };
  const auto file = [](const ordered_json& schema) { return schema.dump(2) + "\n"; };
  return {
      {"schemas/calibration.schema.json",
       file(jsonSchema("Calot calibration", "docs/how-to/devices.md", recordOf<recorder::Calibration>()))},
      {"schemas/columns.schema.json",
       file(jsonSchema("Calot column map", "docs/explanation/sources.md", recordOf<recorder::ColumnMap>()))},
      {"schemas/course.schema.json",
       file(jsonSchema("Calot course", "docs/how-to/course.md", recordOf<analytics::Course>()))},
      {"schemas/form.schema.json",
       file(jsonSchema("Calot form", "docs/how-to/ratings.md", recordOf<analytics::RatingForm>()))},
      {"schemas/performer.schema.json",
       file(jsonSchema("Calot performer", "docs/explanation/sources.md", recordOf<recorder::PerformerProfile>()))},
      {"schemas/protocol.schema.json",
       file(jsonSchema("Calot study protocol", "docs/how-to/protocol.md", recordOf<analytics::Protocol>()))},
      {"schemas/scene.schema.json", file(scene)},
      {"docs/reference/scene-keys.md",
       "# Keys of a scene\n\n"
       "This page lists the keys of a [scene file](scenes.md), with range (a round bracket excludes the bound), unit "
       "and\n"
       "default; [another](scene-tissue-keys.md) those of its tissues. Example: `\"timeLimit\": 600` ends attempts "
       "after\n"
       "ten minutes. Both are generated from the tables that the reader uses (`record_texts . --write`).\n\n" +
           structure::rootTable(scene, ofScene, tissuePage) + structure::keyTables(scene, ofScene, tissuePage)},
      {"docs/reference/scene-tissue-keys.md",
       "# Keys of a scene's tissues\n\n"
       "This page lists the keys of organs, connective tissue, vessels and fat of a [scene file](scenes.md);\n"
       "[another](scene-keys.md) those of the scene. Example: `\"friction\": 0.2` doubles the default of an organ.\n" +
           structure::keyTables(scene, ofTissue, scenePage)},
  };
}

std::string textOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

int main(int argc, char** argv) {
  const bool write = argc == 3 && std::strcmp(argv[2], "--write") == 0;
  if (argc != 3 || (!write && std::strcmp(argv[2], "--check") != 0)) {
    std::fprintf(stderr, "usage: record_texts ROOT (--check | --write)\n");
    return 2;
  }
  int differing = 0;
  for (const auto& [name, text] : texts()) {
    const std::string file = std::string(argv[1]) + "/" + name;
    if (textOf(file) == text) continue;
    ++differing;
    if (write) std::ofstream(file, std::ios::binary) << text;
    std::printf("%s: %s\n", name.c_str(), write ? "written" : "differs from the tables: run record_texts . --write");
  }
  return differing > 0 && !write ? 1 : 0;
}
