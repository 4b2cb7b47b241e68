#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the files for ground stations that `jink parameters` writes.

    parameters_check.py metadata|running|params|refusals --jink PROGRAM --jinkd PROGRAM

The metadata are held to the rules of MAVLink's parameter.schema.json, to the page of the parameters and to a running
jinkd. Parameter files are loaded as QGroundControl loads them: line by line, each with a PARAM_SET.
"""
import argparse
import json
import math
import os
import pathlib
import re
import select
import struct
import subprocess
import sys
import tempfile
import time
import tty

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOP / "toolchain/report"), str(TOP / "tests")]
import mavlink_frames  # noqa: E402
import parameters_page  # noqa: E402

COMPONENT, REAL32 = 196, 9
VEHICLES = {name: TOP / "firmware/vehicles" / name / "vehicle.yaml" for name in ("default", "uav2")}
# parameter.schema.json of MAVLink, component_metadata: keys with their JSON types; only the name is required. QGroundControl
# requires the type too.
KEYS = {"name": str, "type": str, "shortDesc": str, "longDesc": str, "units": str, "default": float, "decimalPlaces": int, "min": float,
        "max": float, "increment": float, "rebootRequired": bool, "group": str, "category": str, "volatile": bool, "values": list,
        "bitmask": list, "readOnly": bool}
TYPES = ("Uint8", "Int8", "Uint16", "Int16", "Uint32", "Int32", "Float")
UNITS = {"m": "m", "s": "s", "m/s": "m/s", "m/s2": "m/s^2", "kg": "kg", "m2": "m^2", "% of half their travel": "%"}


def single(value):
    """The float that a number becomes on the link."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def next_single(value, up):
    """The neighbour of a float."""
    bits = struct.unpack("<i", struct.pack("<f", value))[0]
    if bits & 0x7FFFFFFF == 0:
        return 1e-45 if up else -1e-45
    return struct.unpack("<f", struct.pack("<i", bits + (1 if (value > 0) == up else -1)))[0]


def ran(*command, status=0):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=100)
    assert done.returncode == status, f"{command}: status {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if status == 0 else done.stderr


def metadata(jink, *options):
    return json.loads(ran(jink, "parameters", *options))


class Station:
    """jinkd on a pseudo-terminal, with the autopilot's HEARTBEAT and a ground station on the other end."""

    def __init__(self, jinkd, *options):
        self.line, self.other = os.openpty()
        tty.setraw(self.other)  # kept open, so that the line does not hang up before jinkd opens it
        self.output = tempfile.TemporaryFile()
        self.jinkd = subprocess.Popen([jinkd, "--serial", os.ttyname(self.other) + ":921600", *map(str, options)], stdout=self.output, stderr=subprocess.STDOUT)
        self.sequence, self.bytes, self.beaten = 0, b"", 0.0

    def __enter__(self):
        for _ in self.values(0.3):  # jink has to hear the autopilot first
            pass
        return self

    def __exit__(self, *_):
        self.jinkd.kill()
        self.jinkd.wait()
        os.close(self.line)
        os.close(self.other)

    def send(self, number, payload, system, component):
        os.write(self.line, mavlink_frames.encode(number, payload, self.sequence, system, component))
        self.sequence = (self.sequence + 1) & 0xFF

    def values(self, seconds):
        """PARAM_VALUE messages of jink that come in this time: (name, value, index, count, type)."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if time.monotonic() - self.beaten > 0.5:
                self.beaten = time.monotonic()
                self.send(0, struct.pack("<IBBBBB", 0, 2, 3, 81, 3, 3), 1, 1)  # a quadrotor under ArduPilot, disarmed
            if select.select([self.line], [], [], min(left, 0.1))[0]:
                self.bytes += os.read(self.line, 4096)
            yield from self.decoded()

    def decoded(self):
        found, self.bytes = mavlink_frames.frames(self.bytes)
        for component, number, payload in found:
            if number == 22 and component == COMPONENT:
                value, count, index, name, kind = struct.unpack("<fHH16sB", payload.ljust(25, b"\0"))
                yield name.rstrip(b"\0").decode(), value, index, count, kind

    def read_all(self):
        """{name: (value, type)} in the order of the indices, until every index has come."""
        for _ in range(10):
            found = {}
            self.send(21, struct.pack("<BB", 1, COMPONENT), 255, 190)
            for name, value, index, count, kind in self.values(2):
                found[index] = (name, value, kind)
                if len(found) == count:
                    return {name: (value, kind) for name, value, kind in (found[i] for i in range(count))}
        raise AssertionError("jinkd does not list its parameters")

    def set_all(self, rows):
        """Sets parameters in this order, no name twice. @return the value in force after each"""
        now = []
        for at in range(0, len(rows), 8):  # jink takes in 16 of a step
            now += self.set_together(rows[at:at + 8])
        return now

    def set_together(self, rows):
        for _ in range(5):
            for name, value in rows:
                self.send(23, struct.pack("<fBB16sB", value, 1, COMPONENT, name.encode(), REAL32), 255, 190)
            answers = {}
            for name, now, *_ in self.values(2):
                answers[name] = now
                if all(row[0] in answers for row in rows):
                    return [answers[row[0]] for row in rows]
        raise AssertionError(f"jinkd does not answer to {rows}")


# --- tests

def check_entry(entry):
    name = entry["name"]
    assert re.fullmatch(r"[.\-a-zA-Z0-9_{}]{1,16}", name) and entry["type"] in TYPES, entry
    for key, value in entry.items():
        assert key in KEYS, f"{name}: {key} is not in the schema"
        right = (int, float) if KEYS[key] is float else KEYS[key]
        assert isinstance(value, right) and (KEYS[key] is bool or not isinstance(value, bool)), f"{name}: {key} is {value!r}"
    assert entry["decimalPlaces"] >= 0 and entry["shortDesc"] and entry["longDesc"] and entry["group"] and entry["category"], entry
    assert entry["min"] <= entry["default"] <= entry["max"] and entry["min"] < entry["max"], entry
    for key in ("min", "default"):
        assert math.isclose(round(entry[key], entry["decimalPlaces"]), entry[key], abs_tol=1e-12), f"{name}: {key} has more decimals than are shown"
    for item in entry.get("values", []):
        assert set(item) == {"value", "description"} and entry["min"] <= item["value"] <= entry["max"] and item["description"], entry
    for item in entry.get("bitmask", []):
        assert set(item) == {"index", "description"} and type(item["index"]) is int and item["description"], entry
    if "bitmask" in entry:
        assert sum(1 << item["index"] for item in entry["bitmask"]) == entry["max"], f"{name}: its bits do not add up to {entry['max']}"
    if "values" in entry:
        assert [item["value"] for item in entry["values"]] == list(range(int(entry["min"]), int(entry["max"]) + 1)), entry


def test_metadata(a):
    """The schema, and the page as a second reader of the same table."""
    data = metadata(a.jink)
    assert set(data) == {"version", "parameters"} and data["version"] == 1, "QGroundControl reads version 1 alone"
    newer = metadata(a.jink, "--metadata-version", "3")
    assert newer.pop("version") == 3 and newer["parameters"] == data["parameters"]
    assert len({entry["name"] for entry in data["parameters"]}) == len(data["parameters"])
    page = parameters_page.parameters(TOP)
    assert len(page) > 50 and [entry["name"] for entry in data["parameters"]] == [row[0] for row in page]
    listed = (TOP / parameters_page.PAGE).read_text(encoding="utf-8")
    for entry, (name, initial, low, high, whole, meaning, _) in zip(data["parameters"], page):
        check_entry(entry)
        assert (entry["default"], entry["min"], entry["max"]) == (initial, low, high), f"{entry}: the page has {initial}, {low} to {high}"
        assert entry["group"] == parameters_page.GROUPS[name.partition("_")[0]], entry
        assert (entry["decimalPlaces"] == 0) == whole, entry
        unit = re.search(r" ?\[([^\]]+)\]", meaning)
        assert entry.get("units") == (UNITS[unit[1]] if unit else None), entry
        assert entry["longDesc"] == (meaning.replace(unit[0], "", 1) if unit else meaning), entry
        assert ("bitmask" in entry) == ("sum of:" in meaning) and f"| `{name}` |" in listed, entry
    mode = next(entry for entry in data["parameters"] if entry["name"] == "JNK_MODE")
    assert [v["description"] for v in mode["values"]] == ["off", "advise only", "take over and avoid"], mode


def test_running(a):
    """Every parameter of a running jinkd, none more, with its default; and each is refused just outside of its range."""
    entries = metadata(a.jink)["parameters"]
    with Station(a.jinkd) as station:
        running = station.read_all()
        assert list(running) == [entry["name"] for entry in entries]
        for entry in entries:
            assert running[entry["name"]] == (single(entry["default"]), REAL32) and entry["type"] == "Float", entry
        for end, up in (("max", True), ("min", False)):
            outside = [(entry["name"], next_single(single(entry[end]), up)) for entry in entries]
            for entry, now in zip(entries, station.set_all(outside)):
                assert now == single(entry["default"]), f"{entry['name']} takes {now}"
    # Over the link a value may also be refused because it does not fit together with others; of a file each line is judged alone.
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "limits.param")
        for end, up in (("max", True), ("min", False)):
            file.write_text("".join(f"{entry['name']},{entry[end]!r}\n" for entry in entries), encoding="utf-8")
            said = subprocess.run([a.jink, "check", file], capture_output=True, text=True).stderr
            assert "range" not in said and "number" not in said, said  # together they may not fit
            for begin in range(0, len(entries), 20):  # no more errors of a file are said
                part = entries[begin : begin + 20]
                file.write_text("".join(f"{entry['name']},{next_single(single(entry[end]), up)!r}\n" for entry in part), encoding="utf-8")
                said = ran(a.jink, "check", file, status=2)
                for line, entry in enumerate(part, 1):
                    assert f"limits.param:{line}:{len(entry['name']) + 2}: {entry['name']}: " in said, f"{entry['name']} goes beyond its {end}: {said}"


def rows_of(text, system=1):
    """Lines as QGroundControl reads them: no comment, five columns between tabs, of this vehicle and component."""
    rows = [line.split("\t") for line in text.splitlines() if not line.startswith("#")]
    assert all(len(row) == 5 and row[:2] == [str(system), str(COMPONENT)] and row[4] == str(REAL32) for row in rows), rows
    return [(row[2], single(float(row[3]))) for row in rows]


def test_params(a):
    """Files of the shipped vehicles and one whose values only fit in an order of their own, over MAVLink and by --params."""
    with tempfile.TemporaryDirectory() as folder:
        odd = pathlib.Path(folder, "odd.param")
        odd.write_text("JNK_BOUNDS,3\nJNK_FLOOR,200\nJNK_CEILING,250\nGEO_K_S,0\nGEO_K_T,0.5\nGEO_T_LOW,20\nGEO_T_HIGH,40\n", encoding="utf-8")
        cases = {name: ("--vehicle", path) for name, path in VEHICLES.items()} | {"odd": ("--params", odd)}
        for name, options in cases.items():
            file = pathlib.Path(folder, name + ".params")
            ran(a.jink, "parameters", *options, "--format", "qgroundcontrol", "--out", file)
            rows = rows_of(file.read_text(encoding="utf-8"))
            wanted = {entry["name"]: single(entry["default"]) for entry in metadata(a.jink, *options)["parameters"]}
            assert dict(rows) == wanted and len(rows) == len(wanted) and rows[-1][0] == "JNK_MODE", name
            with Station(a.jinkd) as station:
                assert station.set_all(rows) == [value for _, value in rows], f"{name}: refused in the order of the file"
                assert {key: value for key, (value, _) in station.read_all().items()} == wanted
            with Station(a.jinkd, "--params", file) as station:
                assert {key: value for key, (value, _) in station.read_all().items()} == wanted
            ran(a.jink, "check", file)
        with Station(a.jinkd) as station:  # the same values in the order of the table
            assert station.set_all(list(wanted.items())) != list(wanted.values()), "the order of the file makes no difference"
        assert rows_of(ran(a.jink, "parameters", "--format", "qgroundcontrol", "--system", 7), 7)
        plain = pathlib.Path(folder, "plain.param")
        plain.write_text(ran(a.jink, "parameters", "--params", odd, "--format", "ardupilot"), encoding="utf-8")
        assert metadata(a.jink, "--params", plain) == metadata(a.jink, "--params", odd)


def test_refusals(a):
    with tempfile.TemporaryDirectory() as folder:
        bad, out = pathlib.Path(folder, "bad.params"), pathlib.Path(folder, "out")
        bad.write_text("# saved\n1\t196\tJNK_MODE\t7\t9\n1\t1\tFRAME_CLASS\t1\t2\n", encoding="utf-8")
        for options, said in ((("--params", bad), f"{bad}:2:16: JNK_MODE: '7' is out of range: 0 to 2"),
                              (("--params", pathlib.Path(folder, "none")), "no such file"),
                              (("--vehicle", bad), "bad.params"),
                              (("--format", "xml"), "--format"), (("--system", "0"), "--system"), (("--metadata-version", "2"), "--metadata-version")):
            wrong = ran(a.jink, "parameters", *options, "--out", out, status=2)
            assert said in wrong, f"{options}: {wrong}"
            assert not out.exists(), f"{options}: something was written"
        wrong = ran(a.jink, "parameters", "--out", pathlib.Path(folder, "none/out"), status=2)
        assert "none/out: cannot be opened" in wrong, wrong
        bad.write_text("1\t1\tFRAME_CLASS\t1\t2\n", encoding="utf-8")
        assert "jink is component 196" in ran(a.jink, "check", bad, status=2)
        out.write_text("before", encoding="utf-8")
        ran(a.jink, "parameters", "--out", out)
        json.loads(out.read_text(encoding="utf-8"))


def main():
    tests = {name.removeprefix("test_"): test for name, test in globals().items() if name.startswith("test_")}
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("test", choices=tests)
    p.add_argument("--jink", type=pathlib.Path, required=True)
    p.add_argument("--jinkd", type=pathlib.Path, required=True)
    a = p.parse_args()
    tests[a.test](a)


if __name__ == "__main__":
    main()
