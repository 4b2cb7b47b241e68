#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Wrong command lines and lost output of jink and jink-sim, from the user's view.

    command_lines_test.py --build FOLDER

A refusal has exit status 2, a message, and leaves earlier files as they are.
"""
import argparse
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import formats  # noqa: E402

VEHICLE = formats.TOP / "firmware/vehicles/default/vehicle.yaml"
SCENARIO = formats.TOP / "tests/scenario/clear_pass.yaml"


class Tools:
    def __init__(self, build, folder):
        self.jink, self.sim = build / "toolchain/host/jink", build / "toolchain/sim/jink-sim"
        self.folder, self.errors, self.cases = folder, [], 0

    def run(self, command, most_bytes=None, stdout=subprocess.PIPE, **more):
        """With `most_bytes`: as on a disk that has no more for a file."""
        def limit():
            if most_bytes is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
        # Python ignores SIGXFSZ; so does the program then, and sees an error in place of the signal.
        return subprocess.run([str(c) for c in command], cwd=self.folder, stdout=stdout, stderr=subprocess.PIPE, timeout=120, check=False,
                              preexec_fn=limit, restore_signals=False, **more)

    def expect(self, good, what):
        self.cases += 1
        if not good:
            self.errors.append(what)

    def refused(self, command, said="", **more):
        ran = self.run(command, **more)
        err = ran.stderr.decode(errors="replace")
        shown = " ".join(str(c) for c in command[0:])
        self.expect(ran.returncode == 2 and said in err and err.strip(), f"{shown}: status {ran.returncode}: {err[:300]}")
        self.expect(len(err) < 1000, f"{shown}: a message of {len(err)} characters")
        return err


def numbers(t):
    swarm = [t.sim, "swarm", "--vehicles", "2", "--duration", "1"]
    for option in ("--circle", "--tilt", "--sector", "--slow", "--cruise", "--spread", "--body", "--level", "--vertical", "--rate", "--loss", "--delay", "--duration"):
        for value in ("nan", "inf", "-nan", "1e999"):
            t.refused([*swarm, f"{option}={value}"], option)
    t.refused([t.sim, "phases", SCENARIO, "--count", "1", "--held-up", "nan"], "--held-up")
    mesh = [t.jink, "mesh", "build", "good.obj"]
    for option in ("--concavity=nan", "--concavity=inf", "--concavity=-1", "--concavity=1e999", "--scale=nan", "--scale=inf", "--origin=47,nan,0"):
        t.refused([*mesh, option])
    t.refused([t.jink, "reach", "build", VEHICLE, "--period", "nan"])
    for command in ([t.sim, "random", "--count", "1", "--seed"], [*swarm, "--seed"], [t.sim, "phases", SCENARIO, "--count", "1", "--seed"],
                    [t.sim, "matrix", "--count", "1", "--from"], [t.jink, "tune", "--out", "tuned", "--count", "2", "--from"],
                    [t.jink, "reach", "build", VEHICLE, "--most-bytes"], [t.jink, "plan", "good.yaml", "--budget"], [t.sim, "random", "--count"]):
        for value in ("-1", "-5", "-18446744073709551615", "18446744073709551616", "010", "0x10", "1.5", ""):
            t.refused([*command[:-1], f"{command[-1]}={value}"])
    t.refused([t.jink, "reach", "build", VEHICLE, "--most-bytes=0"], "--most-bytes")


def words(t):
    for program in (t.jink, t.sim):
        t.refused([program, "nope"], "'nope'")
        t.refused([program], "subcommand")
    t.refused([t.jink, "mesh", "nope"], "'nope'")


def programs(t):
    """--daemon takes executable files and programs in PATH; --image takes ELF files."""
    fly = [t.sim, "fly", SCENARIO]
    for option in ("--daemon", "--program"):
        command = [*(fly if option == "--daemon" else [t.sim, "swarm", "--daemon"]), option]
        for value in ("good.obj", "./good.obj", ".", "none", "./none"):
            t.refused([*command, value], option)
    for value in ("good.obj", ".", "none"):
        t.refused([*fly, "--machine", "mps2-an500", "--image", value], "--image")
    # A file in the current folder, and one in PATH: both are started, and are no co-processor.
    program = t.folder / "in_path/silent_program"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nexit 7\n", encoding="utf-8")
    program.chmod(0o755)
    (t.folder / "here").write_text("#!/bin/sh\nexit 7\n", encoding="utf-8")
    (t.folder / "here").chmod(0o755)
    for value in ("silent_program", "here", "./here"):
        ran = t.run([*fly, "--daemon", value], env={**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"})
        out = ran.stdout.decode() + ran.stderr.decode()
        t.expect(ran.returncode == 1 and "exit status 7" in out, f"--daemon {value}: {ran.returncode}: {out[:300]}")


def same_files(t):
    for command, file in (([t.jink, "mesh", "build", "good.obj", "-o"], "good.obj"), ([t.jink, "mesh", "build", "good.obj", "-o", "link.obj"], None),
                          ([t.jink, "mesh", "build", "good.obj", "--header"], "./good.obj"), ([t.jink, "tables", "vehicle.yaml", "--out"], "vehicle.yaml"),
                          ([t.jink, "reach", "build", "vehicle.yaml", "--out"], "vehicle.yaml"), ([t.jink, "report", "run/run.json", "--out"], "run/run.json"),
                          ([t.jink, "report", "run", "--out"], "run/../run/run.json"), ([t.jink, "parameters", "--vehicle", "vehicle.yaml", "--out"], "vehicle.yaml"),
                          ([t.jink, "parameters", "--params", "good.param", "--out"], "good.param")):
        target = t.folder / (file or "link.obj")
        before = target.read_bytes()
        t.refused([*command, *([file] if file else [])], "same file")
        t.expect(target.read_bytes() == before, f"{command[1:]}: the input was changed")
    t.refused([t.jink, "mesh", "build", "good.obj", "-o", "same", "--header", "./same"], "same file")
    t.refused([t.jink, "mesh", "build", "good.obj", "-o", "y.map", "--header", "nodir/h.hpp"], "nodir/h.hpp")
    t.expect(not (t.folder / "y.map").exists() and not (t.folder / "same").exists(), "half of the output was written")


def full_disk(t):
    """An earlier file stays, and nothing is left beside it."""
    outputs = {"kept.map": [t.jink, "mesh", "build", "good.obj", "-o", "kept.map"],
               "kept.hpp": [t.jink, "tables", "vehicle.yaml", "--waypoints", "8", "--out", "kept.hpp"],
               "sets.hpp": [t.jink, "reach", "build", "vehicle.yaml", "--profile", "reduced", "--out", "sets.hpp"],
               "flown/run.json": [t.sim, "fly", SCENARIO, "--out", "flown"],
               "steps/clear_pass.steps": [t.sim, "fly", SCENARIO, "--record-steps", "steps"],
               "tables/texts.csv": [t.jink, "log", "flight.ulg", "--csv", "tables"],
               "kept.html": [t.jink, "report", "run", "--out", "kept.html"],
               "kept.json": [t.jink, "parameters", "--out", "kept.json"]}
    for name, command in outputs.items():
        file = t.folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(b"an earlier file")
        t.refused(command, most_bytes=64)
        t.expect(file.read_bytes() == b"an earlier file", f"{name}: the earlier file is lost")
        left = [p.name for p in file.parent.iterdir() if p.name.startswith(file.name) and p != file]
        t.expect(not left, f"{name}: {left} is left")


def lost_output(t):
    for command in ([t.jink, "plan", "good.yaml", "--format", "json"], [t.jink, "check", "vehicle.yaml"], [t.jink, "log", "flight.ulg"], [t.jink, "log", "--replay", "flight.ulg"],
                    [t.jink, "mesh", "show", "good.map"], [t.jink, "tables", "vehicle.yaml", "--waypoints", "8"], [t.jink, "parameters"], [t.jink, "--help"],
                    [t.sim, "fly", SCENARIO], [t.sim, "recorded", "good.daa"], [t.sim, "rates", "400"], [t.sim, "--version"]):
        with open("/dev/full", "wb") as full:
            t.refused(command, "standard output", stdout=full)


def replays(t):
    """A replay that cannot begin: no step in the log, or a map of another flight."""
    log = (t.folder / "flight.ulg").read_bytes()
    kept, at = log[:16], 16
    while at + 3 <= len(log):
        size = int.from_bytes(log[at : at + 2], "little") + 3
        kept += log[at : at + size] if log[at + 2 : at + 3] != b"D" else b""
        at += size
    (t.folder / "no_steps.ulg").write_bytes(kept)
    t.refused([t.jink, "log", "--replay", "no_steps.ulg"], "nothing to replay")
    t.refused([t.jink, "log", "--replay", "--map", "good.map", "flight.ulg"], "had no map")
    t.expect(t.run([t.jink, "log", "--replay", "flight.ulg"]).returncode == 0, "the good log is no longer replayed")


def foreign_names(t):
    """A scenario's name that is no UTF-8 is flown; what is written stays readable."""
    name = b"caf\xe9.yaml"
    with open(os.fsencode(t.folder) + b"/" + name, "wb") as file:
        file.write(SCENARIO.read_bytes())
    ran = t.run([t.sim, "fly", os.fsdecode(name), "--out", "cafe"])
    t.expect(ran.returncode == 0, f"fly {name}: {ran.returncode}: {ran.stderr[:300]}")
    ran = t.run([t.jink, "report", "cafe", "--out", "cafe.html"])
    t.expect(ran.returncode == 0 and (t.folder / "cafe.html").exists(), f"report of {name}: {ran.returncode}: {ran.stderr[:300]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    build = parser.parse_args().build.resolve()
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work)
        t = Tools(build, folder)
        for name, content in (("good.obj", formats.MESH), ("good.yaml", formats.PROBLEM), ("good.daa", formats.DAA), ("good.param", formats.PARAMETERS), ("vehicle.yaml", VEHICLE.read_bytes())):
            (folder / name).write_bytes(content)
        (folder / "link.obj").symlink_to("good.obj")
        formats.made([t.jink, "mesh", "build", folder / "good.obj", "-o", folder / "good.map"], folder / "good.map")
        formats.made([t.sim, "fly", SCENARIO, "--out", folder / "run"], folder / "run/run.json")
        (folder / "log").mkdir()
        (folder / "flight.ulg").write_bytes(formats.flight_log(build / "firmware/linux/jinkd", folder / "log"))
        for part in (numbers, words, programs, same_files, full_disk, lost_output, replays, foreign_names):
            before = len(t.errors)
            part(t)
            print(f"{part.__name__}: {len(t.errors) - before} errors", flush=True)
        print(*(re.sub(r"\s+", " ", error) for error in t.errors), f"{t.cases} expectations, {len(t.errors)} errors", sep="\n")
    return 1 if t.errors else 0


if __name__ == "__main__":
    sys.exit(main())
