#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the house rules that are visible in the sources.

    layering.py includes     who may know whom (docs/architecture.md), over the include lines
    layering.py spdx         every source starts with its licence
    layering.py length       files longer than they should be; an error beyond MOST_LINES, tests excepted
    layering.py states       the state diagram of docs/ against the table of transitions in core/avoid
    layering.py self-test    plants one violation of each kind and fails when it is not found

Python 3 standard library only. `--root FOLDER` checks another tree.
"""
import argparse
import contextlib
import io
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PLACES = ("core", "hal", "firmware", "tests", "toolchain")
PASSED_OVER = {"node_modules", "__pycache__", "build", ".git"}
CPP = {".hpp", ".cpp", ".h", ".c"}

# Modules of core by layer, from the lowest: a module may include itself and every lower layer, never a module of its
# own layer.
FLOORS = (
    ("core/base",),
    ("core/geometry",),
    ("core/vehicle",),
    ("core/path",),
    ("core/world",),
    ("core/cost",),
    ("core/geometric", "core/reach", "core/orca", "core/airspace", "core/tree", "core/fleet", "core/soaring"),
    ("core/avoid",),
)
# Files of a folder itself, outside its modules (core/capacity.hpp), may be included by the whole folder.
CORE = ("core",) + tuple(room for floor in FLOORS for room in floor)
HAL_PLATFORMS = ("hal/linux", "hal/memory", "hal/cmsdk", "hal/stm32f4", "hal/stm32h7")
# Parts that the platforms of one family share.
HAL_FAMILIES = {"hal/stm32f4": "hal/stm32", "hal/stm32h7": "hal/stm32"}
# The processor that several platforms share, and the families.
HAL_SHARED = ("hal/cortex_m", "hal/stm32")
HAL_INTERFACES = ("hal",)
# Common to the images of one processor, or of one family of chips.
IMAGES_SHARED = ("firmware/cortex_m", "firmware/stm32")

# System headers that flashed code may include. None of them uses heap, I/O, clock or threads. <new> is for placement
# only, enforced by the images' lack of an allocator.
STANDARD = set("""algorithm array atomic bit cassert cerrno cfloat charconv climits cmath compare concepts cstddef
    cstdint cstring functional initializer_list iterator limits new numbers numeric optional ranges ratio span string_view
    tuple type_traits utility variant version""".split())
EMBEDDED = ("core", "hal", "firmware/link", "firmware/vehicles", "firmware/app", "firmware/flight_log")
THIRD_PARTY = {"core": ("Eigen/", "ccd/"), "firmware": ("Eigen/",), "hal": ()}

WANTED_LINES = 400
MOST_LINES = 450


def floors_below():
    known = {"core": {"core"}}
    below = {"core"}
    for floor in FLOORS:
        for room in floor:
            known[room] = below | {room}
        below = below | set(floor)
    return known


def rules():
    """module -> modules that it may include; None: any."""
    known = floors_below()
    known["hal"] = {"hal"}
    for platform in HAL_PLATFORMS:
        known[platform] = {"hal", platform, HAL_FAMILIES.get(platform, platform)}
    for shared in HAL_SHARED:
        known[shared] = {"hal", shared}
    known["firmware/link"] = {"core", "core/base", "core/world", "firmware/link"}
    known["firmware/vehicles"] = known["core/cost"] | known["core/reach"] | {"firmware/vehicles"}
    known["firmware/app"] = set(CORE) | {"firmware/link", "firmware/vehicles", "firmware/app"} | set(HAL_INTERFACES)
    known["firmware/flight_log"] = known["firmware/app"] | {"firmware/flight_log"}
    return known


def room_of(path):
    """Module of a file or of an include: core/geometry/sweep.hpp -> core/geometry, hal/clock.hpp -> hal."""
    parts = path.split("/")
    if parts[0] in ("core", "hal", "firmware") and len(parts) > 2:
        return "/".join(parts[:2])
    return parts[0]


def sources(root, suffixes=None):
    for place in PLACES:
        for path in sorted((root / place).rglob("*")):
            relative = path.relative_to(root)
            if PASSED_OVER & set(relative.parts) or not path.is_file():
                continue
            if suffixes is None or path.suffix in suffixes:
                yield path, relative.as_posix()


def include_lines(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*([<"])([^">]+)[">]', line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def quoted_error(room, target, known):
    """The error in a module's #include "target", or None."""
    place = target.split("/")[0]
    if place not in PLACES or "/" not in target or ".." in target:
        return f'"{target}" does not name its room'
    if place == "tests":
        return None if room == "tests" else f"{room} may not know tests"
    if place == "toolchain":
        return None if room in ("tests", "toolchain") else f"{room} may not know toolchain"
    if room in ("tests", "toolchain"):
        return None
    if room in known:
        return None if room_of(target) in known[room] else f"{room} may not know {room_of(target)}"
    if room.startswith("firmware/"):  # an image: firmware/flight_log and what that knows, one platform
        allowed = known["firmware/flight_log"] | {room, *HAL_PLATFORMS, *HAL_SHARED, *IMAGES_SHARED}
        return None if room_of(target) in allowed else f"{room} may not know {room_of(target)}"
    return f"{room} is not in the table of toolchain/checks/layering.py"


def system_error(room, target):
    """The error in a module's #include <target>, or None."""
    place = room.split("/")[0]
    if room not in EMBEDDED and place not in EMBEDDED or room.startswith("hal/"):
        return None  # platforms and host programs: any header of the system
    if target in STANDARD or target.startswith(THIRD_PARTY[place]):
        return None
    return f"<{target}> is not among the headers of flashed code"


def check_includes(root):
    errors = []
    known = rules()
    platforms_of = {}
    for path, name in sources(root, CPP):
        room = room_of(name)
        for number, quoted, target in include_lines(path):
            error = quoted_error(room, target, known) if quoted else system_error(room, target)
            if error:
                errors.append(f"{name}:{number}: {error}")
            if quoted and room.startswith("firmware/") and room_of(target) in HAL_PLATFORMS:
                platforms_of.setdefault(room, set()).add(room_of(target))
    for room, platforms in sorted(platforms_of.items()):
        if len(platforms) > 1:
            errors.append(f"{room}: more than one platform: {', '.join(sorted(platforms))}")
    return errors


def needs_licence(path):
    if path.suffix in CPP | {".py", ".sh", ".cmake", ".js", ".mjs", ".cjs", ".S", ".s", ".ld"}:
        return True
    if path.name == "CMakeLists.txt":
        return True
    if path.suffix:
        return False
    with path.open("rb") as file:
        return file.read(2) == b"#!"


def check_spdx(root):
    errors = []
    files = [(root / name, name) for name in ("CMakeLists.txt", ".ci/run") if (root / name).exists()]
    for path, name in files + list(sources(root)):
        if not needs_licence(path):
            continue
        lines = path.read_text(encoding="utf-8").splitlines()[:2]
        first = 1 if lines and lines[0].startswith("#!") else 0
        if not re.match(r"(//|#|/\*) SPDX-License-Identifier: \S", "".join(lines[first : first + 1])):
            errors.append(f"{name}: no SPDX-License-Identifier in its first line")
    return errors


def check_length(root):
    errors = []
    for path, name in sources(root, CPP | {".py"}):
        lines = path.read_text(encoding="utf-8").splitlines()
        if any("Generated by" in line for line in lines[:5]):
            continue
        # A long list of test cases is still one idea: reported, not refused.
        if len(lines) > MOST_LINES and not name.startswith("tests/"):
            errors.append(f"{name}: {len(lines)} lines, more than {MOST_LINES}: is there a second idea in it?")
        elif len(lines) > WANTED_LINES:
            print(f"{name}: {len(lines)} lines, should be at most {WANTED_LINES}")
    return errors


TRANSITIONS = "core/avoid/phase.hpp"
STATES_PAGE = "docs/guides/state_machine.md"


def check_states(root):
    if not (root / TRANSITIONS).exists():
        return []
    code = re.findall(r"\{Phase::(\w+), Phase::(\w+)\},\s*// (.+)", (root / TRANSITIONS).read_text(encoding="utf-8"))
    page = (root / STATES_PAGE).read_text(encoding="utf-8") if (root / STATES_PAGE).exists() else ""
    drawn = re.findall(r"^ *(\w+) --> (\w+)$", page, re.M)
    table = page.partition("| from | to | when |\n")[2].split("\n\n")[0]
    rows = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in table.splitlines()[1:]]
    expected = [(a.replace("_", " "), b.replace("_", " "), when) for a, b, when in code]
    errors = [] if code else [f"{TRANSITIONS}: no table of transitions"]
    if drawn != [(a, b) for a, b, _ in code]:
        errors.append(f"{STATES_PAGE}: its diagram does not draw the transitions of {TRANSITIONS}")
    if rows != expected:
        differing = sorted(set(rows) ^ set(expected)) or ["the order"]
        errors.append(f"{STATES_PAGE}: its table differs from {TRANSITIONS}: {differing[0]}")
    return errors


CHECKS = {"includes": check_includes, "spdx": check_spdx, "length": check_length, "states": check_states}

# Planted violations: check, file, text, expected error.
LICENCE = "// SPDX-License-Identifier: BSD-3-Clause\n"
PLANTS = [
    ("includes", "core/geometric/a.hpp", '#include "core/reach/b.hpp"\n', "may not know core/reach"),
    ("includes", "core/base/a.hpp", '#include "core/geometry/b.hpp"\n', "may not know core/geometry"),
    ("includes", "core/vehicle/a.hpp", '#include "core/path/b.hpp"\n', "may not know core/path"),
    ("includes", "core/world/a.hpp", '#include "hal/clock.hpp"\n', "may not know hal"),
    ("includes", "core/world/a.hpp", '  #  include "firmware/app/b.hpp"\n', "may not know firmware/app"),
    ("includes", "core/unheard_of/a.hpp", '#include "core/base/b.hpp"\n', "not in the table"),
    ("includes", "core/world/a.hpp", '#include "b.hpp"\n', "does not name its room"),
    ("includes", "core/world/a.hpp", '#include "core/world/../base/b.hpp"\n', "does not name its room"),
    ("includes", "core/world/a.cpp", "#include <vector>\n", "headers of flashed code"),
    ("includes", "core/world/a.cpp", "#include <iostream>\n", "headers of flashed code"),
    ("includes", "core/cost/a.hpp", '#include "firmware/vehicles/a/b.hpp"\n', "may not know firmware/vehicles"),
    ("includes", "firmware/vehicles/a/b.hpp", '#include "core/avoid/b.hpp"\n', "may not know core/avoid"),
    ("includes", "hal/a.hpp", '#include "core/base/time.hpp"\n', "may not know core/base"),
    ("includes", "hal/a.hpp", "#include <termios.h>\n", "headers of flashed code"),
    ("includes", "hal/linux/a.hpp", '#include "hal/memory/b.hpp"\n', "may not know hal/memory"),
    ("includes", "hal/memory/a.hpp", '#include "core/base/random.hpp"\n', "may not know core/base"),
    ("includes", "firmware/link/a.hpp", '#include "core/avoid/b.hpp"\n', "may not know core/avoid"),
    ("includes", "firmware/link/a.hpp", '#include "hal/serial_port.hpp"\n', "may not know hal"),
    ("includes", "firmware/link/a.hpp", "#include <ccd/ccd.h>\n", "headers of flashed code"),
    ("includes", "hal/a.hpp", "#include <Eigen/Core>\n", "headers of flashed code"),
    ("includes", "firmware/app/a.hpp", '#include "hal/linux/b.hpp"\n', "may not know hal/linux"),
    ("includes", "firmware/app/a.hpp", '#include "firmware/linux/b.hpp"\n', "may not know firmware/linux"),
    ("includes", "firmware/linux/a.cpp", '#include "firmware/stm32f405/b.hpp"\n', "may not know firmware/stm32f405"),
    ("includes", "firmware/linux/a.cpp", '#include "hal/linux/b.hpp"\n#include "hal/memory/c.hpp"\n', "more than one"),
    ("includes", "firmware/linux/a.cpp", '#include "toolchain/sim/b.hpp"\n', "may not know toolchain"),
    ("includes", "toolchain/sim/a.cpp", '#include "tests/unit/b.hpp"\n', "may not know tests"),
    ("includes", "firmware/app/a.hpp", '#include "firmware/flight_log/b.hpp"\n', "may not know firmware/flight_log"),
    ("includes", "firmware/flight_log/a.hpp", "#include <string>\n", "headers of flashed code"),
    ("includes", "firmware/flight_log/a.hpp", '#include "firmware/linux/b.hpp"\n', "may not know firmware/linux"),
    ("spdx", "core/world/a.hpp", "#pragma once\n", "no SPDX"),
    ("spdx", "core/world/a.hpp", "\n" + LICENCE, "no SPDX"),
    ("spdx", "toolchain/a", "#!/bin/sh\necho\n", "no SPDX"),
    ("spdx", "tests/CMakeLists.txt", "", "no SPDX"),
    ("length", "core/world/a.cpp", "\n" * (MOST_LINES + 1), "more than"),
    ("states", TRANSITIONS, LICENCE + "{Phase::a, Phase::b},  // at last\n", "does not draw"),
    ("states", TRANSITIONS, LICENCE + "{Phase::a, Phase::b},  // at last\n", "differs"),
    ("states", TRANSITIONS, LICENCE, "no table"),
]
# These must give no error.
CLEAN = [
    ("core/avoid/a.hpp", LICENCE + '#include "core/reach/b.hpp"\n#include "core/capacity.hpp"\n#include <cmath>\n'),
    ("core/reach/a.cpp", LICENCE + '#include "core/cost/b.hpp"\n#include <Eigen/Core>\n// #include "hal/c.hpp"\n'),
    ("hal/linux/a.cpp", LICENCE + '#include "hal/linux/a.hpp"\n#include "hal/clock.hpp"\n#include <termios.h>\n'),
    ("firmware/vehicles/a/b.hpp", LICENCE + '#include "core/reach/c.hpp"\n#include <array>\n'),
    ("firmware/app/a.hpp", LICENCE + '#include "hal/clock.hpp"\n#include "core/avoid/b.hpp"\n'),
    ("firmware/linux/a.cpp", LICENCE + '#include "hal/linux/a.hpp"\n#include "firmware/app/b.hpp"\n#include <vector>\n'),
    ("firmware/stm32f405/a.cpp", LICENCE + '#include "firmware/flight_log/b.hpp"\n#include "hal/stm32f4/c.hpp"\n'),
    ("tests/unit/a.cpp", LICENCE + '#include "tests/unit/b.hpp"\n#include "core/base/c.hpp"\n#include <vector>\n'),
    ("toolchain/sim/a.cpp", LICENCE + '#include "toolchain/sim/b.hpp"\n#include "hal/memory/c.hpp"\n'),
    ("tests/unit/b_test.cpp", LICENCE + "\n" * (MOST_LINES + 1)),
    ("toolchain/run", "#!/bin/sh\n# SPDX-License-Identifier: BSD-3-Clause\n"),
    ("toolchain/mesh/table.hpp", LICENCE + "// Generated by toolchain/mesh.\n" + "\n" * (MOST_LINES + 1)),
]


def self_test(_root):
    errors = []
    for check, name, text, expected in PLANTS + [(check, *clean, None) for clean in CLEAN for check in CHECKS]:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True)
            path.write_text(text, encoding="utf-8")
            with contextlib.redirect_stdout(io.StringIO()):
                found = CHECKS[check](pathlib.Path(folder))
            if expected is None and found:
                errors.append(f"self-test: {check} finds fault with {name}: {found}")
            elif expected is not None and not any(expected in error for error in found):
                errors.append(f'self-test: {check} misses "{expected}" in {name}: {found}')
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("check", choices=[*CHECKS, "self-test"])
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    arguments = parser.parse_args()
    errors = {**CHECKS, "self-test": self_test}[arguments.check](arguments.root.resolve())
    for error in errors:
        print(error)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
