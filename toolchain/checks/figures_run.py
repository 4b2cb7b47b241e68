# SPDX-License-Identifier: BSD-3-Clause
"""Runs the commands of the registry, as written on the page, and extracts the figures from their output."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import time

PROGRAMS = ("toolchain/sim", "toolchain/host", "toolchain/mpi", "firmware/linux")
LINKED = ("core", "firmware", "hal", "tests", "toolchain", "CMakePresets.json")


class Failed(Exception):
    """A command did not end as it should, or a figure is not in its output."""


def environment(build):
    folders = [str(build / place) for place in PROGRAMS]
    return {**os.environ, "PATH": os.pathsep.join(folders + [os.environ["PATH"]]), "PYTHONDONTWRITEBYTECODE": "1"}


def prepare(folder, top, build):
    """A folder in which a page's command finds the tree's paths; its output stays outside the tree."""
    (folder / "build").mkdir(parents=True, exist_ok=True)
    for name in LINKED:
        link = folder / name
        if not link.is_symlink():
            link.symlink_to(top / name)
    for name, place in (("host", build.resolve()), ("bench", top / "build/bench")):
        link = folder / "build" / name
        if link.is_symlink():
            link.unlink()
        link.symlink_to(place)


def unfit(build, top):
    """Why a build's programs do not match this tree's sources; nothing if they do. Builds what is older than its sources."""
    cache = build / "CMakeCache.txt"
    if not cache.exists():
        return "is no build folder"
    if f"CMAKE_HOME_DIRECTORY:INTERNAL={top}\n" not in cache.read_text(encoding="utf-8"):
        return f"was not built of {top}"
    # Not ninja -n: it stops where it would look for new sources, and names none that is out of date.
    done = subprocess.run(["ninja", "-C", str(build)], capture_output=True, text=True)
    return "does not build" if done.returncode else None


def run(command, top, build, folder):
    """(output, seconds)"""
    where = top
    if not command.in_tree:
        prepare(folder, top, build)
        where = folder
    began = time.monotonic()
    # Each line must succeed; lines are run in sequence.
    done = subprocess.run(["bash", "-c", "set -eo pipefail\n" + command.run], cwd=where, env=environment(build), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    if done.returncode not in command.status:
        raise Failed(f"{command.name}: exit status {done.returncode}: {command.run}\n" + "\n".join(done.stdout.splitlines()[-10:]))
    return done.stdout, time.monotonic() - began


def run_again(command, top, build, folder):
    """As run(); a campaign that was begun by other sources is begun anew, one of the same sources is taken up."""
    others = "belongs to another set-up"
    try:
        output, seconds = run(command, top, build, folder)
        if others not in output:
            return output, seconds
    except Failed as failed:
        if others not in str(failed) or not (folder / "out").is_dir():
            raise
    shutil.rmtree(folder / "out", ignore_errors=True)
    return run(command, top, build, folder)


def at(value, way):
    for key in way.split("/"):
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def values_of(figure, output, lines_on_page):
    """The values of a figure in the output: printed numbers as text, or the lines of a block."""
    if figure.block is not None:
        lines = output.splitlines()
        begin = next((i for i, line in enumerate(lines) if (line + "\n").startswith(figure.block.split("\n")[0])), None)
        if begin is None:
            raise Failed(f"{figure.of}: nothing printed begins with \"{figure.block}\"")
        return lines[begin:begin + lines_on_page]
    found = [m.groups() for m in re.finditer(figure.printed, output, re.M)]
    if not found:
        raise Failed(f"{figure.of}: nothing printed is like {figure.printed} (for \"{figure.text}\")")
    groups = sum(found, ()) if figure.each else found[0]
    return [value or "0" for value in groups]  # a missing count is zero


def values_of_record(figure, top, command):
    record = json.loads((top / command.record).read_text(encoding="utf-8"))
    return [str(at(record, way)) for way in figure.json]


def stamp(top, command, digest):
    """Notes the digest in the record, which the command has written."""
    path = pathlib.Path(top / command.record)
    record = json.loads(path.read_text(encoding="utf-8"))
    way, _, key = (command.stamp or "sources").rpartition("/")
    (at(record, way) if way else record)[key] = digest
    path.write_text(compact(record, top), encoding="utf-8")


def compact(record, top):
    import sys
    sys.path.insert(0, str(top / "toolchain/report"))
    import records
    return records.compact_json(record)
