#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the rooms one way: who may include whom, and which foreign headers each room may see.

usage: includes_test.py ROOT | --self-test
"""
import pathlib
import sys
import tempfile

import cpp_text

# Room -> rooms whose headers it may include, besides its own. A room is a folder; its longest matching name counts.
SIM = ("sim/math", "sim/geometry", "sim/solid", "sim/vessel", "sim/connective", "sim/carving", "sim/contact", "sim/fat", "sim/haptics", "sim/instruments", "sim/scene", "sim/tissue", "sim/judgement", "sim/step")
MAY_SEE = {
    "sim/math": (),
    "sim/geometry": ("sim/math",),
    "sim/vessel": ("sim/math", "sim/geometry"),
    "sim/solid": ("sim/math", "sim/geometry"),
    "sim/connective": ("sim/math", "sim/geometry", "sim/solid"),
    # These are one library; what the step is made of may not reach up to recorder or beyond.
    "sim/haptics": SIM, "sim/instruments": SIM, "sim/scene": SIM, "sim/tissue": SIM, "sim/step": SIM,
    # Judgement sees results and descriptions, never State: nothing below it may know it.
    "sim/judgement": ("sim/math", "sim/scene", "sim/tissue"),
    "sim/carving": ("sim/math", "sim/geometry"),  # these are libraries of their own below the core
    "sim/contact": ("sim/math", "sim/geometry"),
    "sim/fat": ("sim/math", "sim/geometry", "sim/solid", "sim/carving", "sim/contact"),
    "sim/bullet": SIM,  # a library of its own above the core
    "recorder/base": ("sim",),
    "recorder/formats": ("sim", "recorder/base"),
    "recorder/surfaces": ("sim", "recorder/base", "recorder/formats"),
    "recorder/engine": ("sim", "recorder/base", "recorder/formats"),
    "recorder/recording": ("sim", "recorder/base", "recorder/formats", "recorder/engine"),
    "recorder/kept": ("sim", "recorder/base", "recorder/formats", "recorder/engine", "recorder/recording"),
    "recorder/sources": ("sim", "recorder/base", "recorder/formats", "recorder/engine", "recorder/recording"),
    "recorder/live": ("sim", "recorder/base", "recorder/engine", "recorder/sources"),
    "recorder": ("sim", "recorder"),  # the loop and replay, above their folders
    "analytics": ("sim", "recorder", "analytics"),
    "analytics/assessment": ("sim", "recorder", "analytics"),
    "analytics/design": ("sim", "recorder", "analytics"),
    "analytics/statistics": (),
    "analytics/checkpoints": ("sim", "recorder", "analytics/statistics"),
    "analytics/cohort": ("sim", "recorder", "analytics"),
    "analytics/external": ("sim", "recorder", "analytics"),
    "analytics/intake": ("sim", "recorder", "analytics"),
    "analytics/uncertainty": ("sim", "recorder", "analytics/checkpoints"),
    "analytics/interchange": ("sim", "recorder", "analytics"),
    "analytics/report": ("sim", "recorder", "analytics"),
    "gui/render": ("sim", "recorder/base"),
    "gui/words": ("sim", "recorder/base", "analytics"),
    "gui/moments": ("sim", "recorder", "analytics", "gui/render"),
    "gui/film": ("sim", "recorder", "analytics", "gui/render", "gui/words"),
    "gui/view": ("sim", "recorder/base", "gui/render"),
    "gui/attempt": ("sim", "recorder", "analytics", "gui/moments", "gui/render", "gui/view", "gui/words"),
    "gui/dashboard": ("sim", "recorder", "analytics", "gui/attempt", "gui/moments", "gui/render", "gui/report", "gui/view", "gui/words"),
    "gui/page": ("sim", "recorder", "gui/render", "gui/words"),
    "gui/trainer": ("sim", "recorder", "analytics", "gui/attempt", "gui/render", "gui/view", "gui/words"),
    "gui/report": ("sim", "recorder", "analytics", "gui/render"),
    "apps": ("sim", "recorder", "analytics", "gui", "apps/common"),
    "python": ("sim", "recorder", "analytics", "gui/render"),
    "apps/common": ("recorder/base",),
    "packaging/example": ("sim", "recorder", "analytics"),
    "apps/calot-bench": ("recorder", "apps/common", "tests/bench"),
    "tests/bench": ("sim", "recorder", "analytics", "gui/render"),
}
# Headers of a module that another one, which may see the module, may not: what is judged is StepResult.
NEVER = {"sim/judgement": ("sim/scene/state.h", "sim/scene/model.h", "sim/scene/scene_view.h", "sim/scene/scene_viewer.h")}

# The core sees these and nothing else from outside.
SIM_FOREIGN = set("""algorithm array bit bitset cassert cmath compare concepts cstddef cstdint cstring deque functional
initializer_list iterator limits map memory numbers numeric optional queue set span stdexcept string string_view tuple
type_traits utility variant vector xxhash.h xmmintrin.h""".split())
SIM_FOREIGN_FOLDERS = ("Eigen/",)
BULLET = "BulletCollision/"  # that one folder sees Bullet

# Foreign headers that only some rooms may see: prefix -> rooms.
ONLY = {
    "Q": ("gui/view", "gui/attempt", "gui/dashboard", "gui/trainer", "gui/report", "apps"),
    "CGAL/": ("recorder/surfaces",),
    "hdf5": ("recorder/recording",),
    "H5": ("recorder/recording",),
    "SQLiteCpp/": ("analytics/cohort",),
    "sqlite3.h": ("analytics/cohort",),
    "GL/": ("gui/render",),
    "libav": ("gui/film", "recorder/sources"),
    "libsw": ("gui/film", "recorder/sources"),
    "apriltag/": ("recorder/sources",),
    "ft2build.h": ("gui/film",),
    "CLI/": ("apps",),
    "pybind11/": ("python",),
    "Python.h": ("python",),
    "thread": ("recorder", "analytics/cohort", "gui", "apps"),
}


def room_of(name):
    parts = pathlib.PurePosixPath(name).parts
    for length in (2, 1):
        candidate = "/".join(parts[:length])
        if len(parts) > length and candidate in MAY_SEE:
            return candidate
    return None


def below(name, place):
    return name == place or name.startswith(place + "/")


def faults_of(path, text):
    """(line number, message) for each wrong include of one file."""
    room = room_of(path)
    if room is None:
        yield 0, "belongs to no room: name it in tests/structure/includes_test.py"
        return
    allowed = MAY_SEE[room]
    for number, name, quoted in cpp_text.includes(text):
        target = room_of(name)
        if quoted or target is not None:
            if target is None:
                yield number, f'"{name}": name the header from the repository\'s root'
            elif target != room and not any(below(target, place) for place in allowed):
                yield number, f'"{name}": {room} may not see {target}'
            elif name in NEVER.get(room, ()):
                yield number, f'"{name}": {room} sees results alone'
        elif below(room, "sim"):
            bullets = room == "sim/bullet" and name.startswith(BULLET)
            if name not in SIM_FOREIGN and not name.startswith(SIM_FOREIGN_FOLDERS) and not bullets:
                yield number, f"<{name}>: the core may not see it"
        else:
            for prefix, rooms in ONLY.items():
                hit = name.startswith(prefix) if prefix != "Q" else name[:1] == "Q" and name[1:2].isupper()
                if prefix == "thread":
                    hit = name == prefix
                if hit and not any(below(room, r) for r in rooms):
                    yield number, f"<{name}>: {room} may not see it, only {', '.join(rooms)}"


def check(root, report=print):
    seen = faults = 0
    for path in cpp_text.files(root):
        if path.suffix not in (".h", ".cpp") or path.parts[0] == "tests":
            continue
        seen += 1
        for number, message in faults_of(path.as_posix(), (root / path).read_text(encoding="utf-8")):
            faults += 1
            report(f"{path}:{number}: {message}")
    return seen, faults


def self_test():
    good = (
        ("sim/geometry/a.h", '#include <vector>\n#include <Eigen/Core>\n#include "sim/math/linear.h"'),
        ("recorder/sources/a.cpp", '#include <fstream>\n#include "recorder/engine/observer.h"\n#include "sim/scene/samples.h"'),
        ("recorder/replay.h", '#include "recorder/recording/reader.h"\n#include "recorder/engine/session.h"'),
        ("recorder/loop.cpp", '#include "recorder/recording/writer.h"\n#include "recorder/live/worker_pool.h"'),
        ("analytics/cohort/a.cpp", "#include <SQLiteCpp/SQLiteCpp.h>"),
        ("gui/dashboard/a.cpp", '#include <QWidget>\n#include "analytics/cohort/cohort.h"'),
        ("sim/bullet/a.cpp", '#include <BulletCollision/BroadphaseCollision/btDbvt.h>\n#include "sim/contact/broad_phase.h"'),
        ("sim/math/a.cpp", '// #include <thread>\n/* #include "gui/render/a.h" */'),
    )
    bad = (
        ("sim/math/a.h", '#include "sim/geometry/mesh.h"'), ("sim/geometry/a.h", '#include "sim/solid/body.h"'),
        ("sim/scene/a.cpp", '#include "recorder/base/errors.h"'), ("sim/judgement/a.cpp", '#include "sim/scene/state.h"'), ("sim/scene/a.cpp", "#include <fstream>"),
        ("sim/solid/a.cpp", "#include <chrono>"), ("sim/solid/a.cpp", "#include <thread>"),
        ("sim/solid/a.cpp", "#include <unordered_map>"), ("sim/solid/a.cpp", "#include <fmt/format.h>"),
        ("sim/contact/a.cpp", "#include <BulletCollision/BroadphaseCollision/btDbvt.h>"), ("sim/bullet/a.cpp", "#include <thread>"),
        ("sim/scene/a.cpp", '#include "sim/bullet/bullet_tree.h"'), ("sim/solid/a.cpp", '#include "body.h"'), ("recorder/engine/observer.h", '#include "recorder/recording/writer.h"'),
        ("recorder/recording/a.cpp", '#include "recorder/sources/source.h"'),
        ("recorder/sources/a.cpp", '#include "analytics/cohort/cohort.h"'), ("recorder/sources/a.cpp", "#include <hdf5.h>"),
        ("recorder/live/a.cpp", "#include <QTimer>"), ("analytics/cohort/a.cpp", '#include "gui/render/renderer.h"'),
        ("analytics/report/a.cpp", "#include <QString>"), ("analytics/checkpoints/a.cpp", "#include <thread>"),
        ("gui/render/a.cpp", '#include "analytics/cohort/cohort.h"'), ("gui/render/a.cpp", "#include <QImage>"),
        ("gui/dashboard/a.cpp", '#include "apps/calot/command.h"'), ("gui/dashboard/a.cpp", "#include <sqlite3.h>"),
        ("recorder/sources/a.cpp", '#include "recorder/replay.h"'), ("misc/a.cpp", ""),
    )
    for path, text in good:
        assert not list(faults_of(path, text)), (path, text, list(faults_of(path, text)))
    for path, text in bad:
        assert len(list(faults_of(path, text))) == 1, f"passes: {path}: {text}"
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        (root / "sim/math").mkdir(parents=True)
        (root / "sim/math/a.h").write_text('#include "gui/render/a.h"\n')
        assert check(root, report=lambda line: None) == (1, 1)
    print(f"includes: {len(bad)} wrong includes refused, {len(good)} right files passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return 0
    seen, faults = check(pathlib.Path(sys.argv[1]))
    print(f"includes: {seen} files, {faults} faults")
    return 1 if faults or seen == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
