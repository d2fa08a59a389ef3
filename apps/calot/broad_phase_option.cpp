// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/broad_phase_option.h"

#include "recorder/base/errors.h"

#ifdef CALOT_BULLET
#include "sim/bullet/bullet_tree.h"
#endif

namespace calot::apps {

CLI::Option* addBroadPhase(CLI::App& command, std::string& name) {
  return command
      .add_option("--broad-phase", name,
                  "finds pairs that may touch: by the program's own grid, or by Bullet's trees; the result is the same")
      ->check(CLI::IsMember({"grid", "bullet"}))
      ->capture_default_str();
}

MakeBroadPhase broadPhaseOf(const std::string& name) {
  if (name == "grid") return nullptr;
#ifdef CALOT_BULLET
  return &BulletTree::make;
#else
  throw Error(ErrorKind::invalid, "--broad-phase bullet: this program was built without Bullet");
#endif
}

}  // namespace calot::apps
