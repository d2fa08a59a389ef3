// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/engine/session.h"
#include "recorder/recording/reader.h"

namespace calot::recorder::test {

/// Does a session's next step as it was recorded.
inline void rerun(Session& session, const RecordedStep& recorded) {
  LocalEngine engine(session);
  static_cast<void>(engine.step({recorded.samples, recorded.ticks, recorded.lateness}));
}

}  // namespace calot::recorder::test
