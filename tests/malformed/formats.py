# SPDX-License-Identifier: BSD-3-Clause
"""The file formats that jink, jinkd and jink-sim read, each with a good file, what reads it, and what can be wrong."""
import dataclasses
import lzma
import pathlib
import struct
import subprocess
import time
from collections.abc import Callable

import mutations

# jink-sim and jink log open what they are given, and wait.
NO_PARAMETER = {"empty": "a file without parameters is one"}
TOP = pathlib.Path(__file__).resolve().parents[2]


@dataclasses.dataclass
class Format:
    name: str
    suffix: str
    good: bytes
    command: Callable  # of the file and of a folder for output
    damages: Callable
    has_lines: bool = True
    statuses: tuple = (2,)
    runs_on: bool = False  # a daemon: it does not end by itself
    patience: float = 60.0
    good_status: int = 0
    checks_good: bool = True
    excused: dict = dataclasses.field(default_factory=dict)  # damage: why it is not refused


def text_of(place):
    return (TOP / place).read_bytes()


def damages_of_yaml(good, number, key, required):
    def damages():
        yield from mutations.of_any_file(good)
        yield from mutations.of_text(good)
        yield from mutations.of_yaml(good, number, key, required)
    return damages


VEHICLE = text_of("firmware/vehicles/default/vehicle.yaml")
PROBLEM = b"""vehicle: default
start: [0, 0, 30]
direction: [1, 0, 0]
distance: 30
threats:
  - {name: main, position: [19, -3.4, 30], velocity: [-4.7, 1.7, 0], radius: 1, main: true}
settings: {preset: source, l: 4, n: 3, kinds: both}
"""
SCENARIO = text_of("tests/scenario/head_on.yaml")
AIRSPACE = b"""frame: local
areas:
  - name: one
    centre: [100, 0]
    radius: 400
    bottom: 100
    top: 3000
"""
PARAMETERS = b"# of a test\nVEH_CRUISE,8\nJNK_LOOKAHEAD 10\nGEO_OFFSETS,4\n"
KEY = b"0123456789abcdef" * 4 + b"\n"
MESH = b"v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
STL = b"solid test\n" + b"".join(
    b"facet normal 0 0 0\nouter loop\n" + b"".join(b"vertex %s\n" % corner for corner in corners) + b"endloop\nendfacet\n"
    for corners in ((b"0 0 0", b"0 4 0", b"4 0 0"), (b"0 0 0", b"4 0 0", b"0 0 4"), (b"0 0 0", b"0 0 4", b"0 4 0"), (b"4 0 0", b"0 4 0", b"0 0 4"))
) + b"endsolid test\n"
DAA = b"""NAME sx sy sz vx vy vz time
[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]
Own 0 0 100 5 0 0 0
Other 100 0 100 -5 0 0 0
Own 5 0 100 5 0 0 1
Other 95 0 100 -5 0 0 1
"""
SEEDS = b"11\n12\n"


def some(damages):
    """A third of them, for one more program that reads a format by the same reader."""
    return lambda: (damage for i, damage in enumerate(damages()) if i % 3 == 0 or i < 10)


def damages_of_scenario():
    yield from damages_of_yaml(SCENARIO, "duration: 25", "duration", "mission:\n  - [0, 0, 30]\n  - [150, 0, 30]\n")()
    last = SCENARIO.count(b"\n") + 1
    for name, parameter in (("a parameter out of range", "JNK_MODE: 5"), ("an odd number", "GEO_OFFSETS: 3"), ("a parameter below its range", "JNK_LOOKAHEAD: 0"),
                            ("a parameter that is no whole number", "JNK_MODE: 0.5"), ("parameters that do not fit together", "{JNK_BOUNDS: 3, JNK_FLOOR: 30, JNK_CEILING: 30}")):
        text = parameter if parameter.startswith("{") else f"{{{parameter}}}"
        yield name, SCENARIO + f"parameters: {text}\n".encode(), last


def with_lines(good, *damages):
    """Damages of a file of lines: (name, line in place of line n, n), or None for a line more."""
    def all_damages():
        yield from mutations.of_any_file(good)
        yield from mutations.of_text(good)
        lines = good.decode().splitlines()
        for name, text, number in damages:
            changed = [*lines[: number - 1], text, *lines[number:]]
            yield name, ("\n".join(changed) + "\n").encode("latin-1"), number
    return all_damages


def parameter_lines():
    values = {"NaN": "nan", "infinity": "inf", "too large for a float": "1e39", "too large for a double": "1e999", "out of range": "101",
              "below the range": "-1", "a text": "fast", "a unit behind": "8m/s", "hexadecimal": "0x8", "two values": "8 9",
              "no value": "", "a decimal comma": "8,5", "an underscore": "1_0", "2000 digits": "9" * 2000, "a byte that is no UTF-8": "8\xff",
              "an empty value": ",", "a sign alone": "-", "two signs": "+-8", "an exponent alone": "e5"}
    return [*((name, f"VEH_CRUISE,{value}", 2) for name, value in values.items()),
            ("an unknown name", "VEH_CRUSE,8", 2), ("a name twice", "VEH_CRUISE,8\nVEH_CRUISE,8", 2), ("a name in small letters", "veh_cruise,8", 2),
            ("no name", ",8", 2), ("a zero byte in a remark", "VEH_CRUISE,8 # a\0b", 2), ("a name alone", "VEH_CRUISE", 2), ("not a whole number", "GEO_OFFSETS,4.5", 4), ("an odd number", "GEO_OFFSETS,3", 4)]


def damages_of_parameters():
    for name, content, line in with_lines(PARAMETERS, *parameter_lines())():
        # Of a name that comes twice the second one is wrong; an odd number only shows with all others.
        yield name, content, {"a name twice": 3, "an odd number": 0}.get(name, line)


def key_damages():
    yield from mutations.of_any_file(KEY)
    for name, text in {"63 digits": KEY[:63], "65 digits": b"0" + KEY, "a letter": b"g" + KEY[1:], "two lines": KEY + KEY, "blanks inside": KEY[:32] + b" " + KEY[32:],
                       "a passphrase without text": b"passphrase\n", "an empty passphrase": b"passphrase \n", "0x in front": b"0x" + KEY,
                       "quotes": b'"' + KEY[:64] + b'"\n', "another word": b"password abc\n", "UTF-16": KEY.decode().encode("utf-16"),
                       "a zero byte": KEY[:10] + b"\0" + KEY[11:]}.items():
        yield name, text, 2 if name == "two lines" else 1


def damages_of_mesh():
    yield from with_lines(MESH,
        ("NaN", "v nan 0 0", 1), ("infinity", "v inf 0 0", 1), ("too large for a float", "v 1e39 0 0", 1), ("a letter in place of a digit", "v O 0 0", 1),
        ("two points", "v 0 4.5.6 0", 3), ("a unit behind", "v 4m 0 0", 2), ("letters behind an exponent", "v 4e2x 0 0", 2), ("hexadecimal", "v 0x10 0 0", 2),
        ("a decimal comma", "v 4,5 0 0", 2), ("a point alone in front", "v .5 0 0", 2), ("a number less", "v 1 2", 2), ("five numbers", "v 1 2 3 4 5", 2), ("texts", "v a b c", 2),
        ("blanks in front", "  v 4 0 0", 2), ("a remark behind", "v 4 0 0 # four", 2), ("a line that goes on", "v 4 0 \\", 2), ("a zero byte", "v 4 0\0 0", 2),
        ("a carriage return inside", "# a\rv 9 9 9", 2), ("an unknown keyword", "vertex 4 0 0", 2), ("a capital keyword", "V 4 0 0", 2), ("a face of two corners", "f 1 3", 5),
        ("a face of a vertex that is missing", "f 2 3 5", 8), ("a face of vertex 0", "f 0 1 2", 5), ("a face too far back", "f -5 -2 -3", 5), ("a fraction in a face", "f 1.5 3 2", 5),
        ("a text in a face", "f a b c", 5), ("three slashes in a face", "f 1/1/1/1 3 2", 5), ("a slash at the end in a face", "f 1/ 3 2", 5))()
    yield "too far", MESH.replace(b"v 4 0 0", b"v 1e9 0 0"), 0
    yield "no faces", MESH[: MESH.index(b"f")], 0
    yield "another format of the same name", b"ply\nformat ascii 1.0\nend_header\n", 1
    yield "one triangle", b"\n".join(MESH.splitlines()[:4]) + b"\nf 1 1 1\n", 0
    yield "points on a line", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", 0


def damages_of_stl():
    text = STL.decode()
    yield from with_lines(STL,
        ("no solid", "a test", 1), ("NaN", "vertex nan 0 0", 4), ("a number less", "vertex 0 0", 4), ("a number more", "vertex 0 0 0 0", 4), ("a text", "vertex x 0 0", 4),
        ("a unit behind", "vertex 0m 0 0", 4), ("two points", "vertex 0.1.2 0 0", 4), ("too large for a float", "vertex 1e39 0 0", 4), ("a keyword in capitals", "FACET NORMAL 0 0 0", 2),
        ("no normal", "facet 0 0 0", 2), ("no loop", "outer", 3), ("two lines in one", "outer loop vertex 0 0 0", 3), ("another keyword", "vortex 0 0 0", 4))()
    yield "a fourth vertex", text.replace("endloop", "vertex 9 9 9\nendloop", 1).encode(), 7
    yield "a vertex less", text.replace("vertex 0 0 0\n", "", 1).encode(), 6
    yield "no end of a facet", text.replace("endfacet\n", "", 1).encode(), 8
    yield "no end of the solid", text.replace("endsolid test\n", "").encode(), text.count("\n") - 1
    yield "cut off in a facet", text[: text.rindex("endloop")].encode(), None


def damages_of_daa():
    yield from with_lines(DAA,
        ("NaN", "Own nan 0 100 5 0 0 0", 3), ("infinity", "Own inf 0 100 5 0 0 0", 3), ("a text", "Own x 0 100 5 0 0 0", 3),
        ("a field less", "Own 0 0 100 5 0 0", 3), ("a field more", "Own 0 0 100 5 0 0 0 0", 3), ("a unit behind", "Own 0m 0 100 5 0 0 0", 3),
        ("too large for a double", "Own 1e999 0 100 5 0 0 0", 3), ("an absurd number", "Own 1e300 0 100 5 0 0 0", 3), ("hexadecimal", "Own 0x10 0 100 5 0 0 0", 3),
        ("a zero byte in a name", "O\0wn 0 0 100 5 0 0 0", 3), ("a zero byte in a number", "Own 0\0x 0 100 5 0 0 0", 3), ("an unknown unit", "[none] [furlong] [m] [m] [m/s] [m/s] [m/s] [s]", 2),
        ("a wrong unit", "[none] [deg] [m] [m] [m/s] [m/s] [m/s] [s]", 2), ("a unit less", "[none] [m] [m] [m/s] [m/s] [m/s] [s]", 2),
        ("a column less", "NAME sx sy vx vy vz time", 1))()


def model_damages(good):
    def damages():
        yield from mutations.of_any_file(good)
        yield from mutations.of_text(good)
        text = good.decode()
        counts = mutations.line_of(text, "30 10 1")
        for name, old, new, line in (
                ("a number less", "30 10 1", "30 10", counts), ("a number more", "30 10 1", "30 10 1 1", counts), ("a text", "30 10 1", "30 x 1", counts),
                ("NaN", "30 10 1", "nan 10 1", counts), ("infinity", "30 10 1", "inf 10 1", counts), ("hexadecimal", "30 10 1", "0x1e 10 1", counts),
                ("a decimal comma", "30 10 1", "30,5 10 1", counts), ("too large for a double", "30 10 1", "1e999 10 1", counts), ("a negative count", "30 10 1", "-30 10 1", counts),
                ("a circle", "0 0 0 0 0\n0 0 0 0 0\n# r_initial", "0 0 0 0 0\n0 0 0 0 1\n# r_initial", mutations.line_of(text, "# G_initial")),
                ("a graph of another size", "0 1 0 0 0", "0 1 0 0", mutations.line_of(text, "# r_initial") - 1), ("a part missing", "# r_initial\n2 2 1 1 1\n", "", 0),
                ("a part twice", "# r_initial", "# G_initial", mutations.line_of(text, "# r_initial")), ("a text in front", "# labels_initial", "labels_initial", 1),
                ("another size", "2 2 1 1 1", "2 2 1 1", mutations.line_of(text, "2 2 1 1 1")), ("a size of nothing", "2 2 1 1 1", "0 2 1 1 1", mutations.line_of(text, "2 2 1 1 1")),
                ("a huge size", "2 2 1 1 1", "999999999 2 1 1 1", mutations.line_of(text, "2 2 1 1 1")), ("a size that is no whole number", "2 2 1 1 1", "1.5 2 1 1 1", mutations.line_of(text, "2 2 1 1 1")),
                ("an unknown variable", '"v"', '"w"', 1), ("edges that go back", "100 200 300", "100 300 200", mutations.line_of(text, "100 200 300")),
                ("an edge less", "100 200 300", "100 200", mutations.line_of(text, "100 200 300")), ("edges missing", "-1 1\n", "*\n", mutations.line_of(text, "-1 1")),
                ("a line of edges less", "-1 1\n", "", mutations.line_of(text, "# boundaries"))):
            if old not in text:
                raise ValueError(f"the good model lacks {old}")
            yield name, text.replace(old, new, 1).encode(), line
    return damages


def wire(records):
    return b"".join(struct.pack("<dBI", *head) + data for head, data in records)


WIRE = wire([((0.1 * i, 0, 17), bytes.fromhex("fd05000000010100000000000000000000")[:17]) for i in range(30)])


def damages_of_wire(good):
    def damages():
        yield from mutations.of_any_file(good)
        for name, head in (("NaN", (float("nan"), 0, 0)), ("infinity", (float("inf"), 0, 0)), ("a time that runs backwards", (0.5, 0, 0)), ("a negative time", (-1.0, 0, 0)),
                           ("a pause of a year", (3e7, 0, 0)), ("direction 2", (3.0, 2, 0)), ("direction 255", (3.0, 255, 0)), ("a huge record", (3.0, 0, 0xFFFFFFFF)),
                           ("a record of 200 kB", (3.0, 0, 200_000)), ("a record cut off", (3.0, 0, 10))):
            yield name, WIRE + struct.pack("<dBI", *head), None
        yield "trailing noise", WIRE + b"\x01\x02\x03", None
        packed = lzma.compress(WIRE)
        yield "packed, cut off", packed[:-20], None
        yield "packed, damaged", packed[:40] + bytes([packed[40] ^ 255]) + packed[41:], None
        yield "packed, noise behind", packed + b"noise", None
        yield "packed twice", lzma.compress(packed), None
        yield "packed nothing", lzma.compress(b""), None
    return damages


def damages_of_map(good):
    def damages():
        yield from mutations.of_any_file(good)
        yield from mutations.of_binary(good, 12)
        yield from mutations.cuts(good, 25)
        yield "trailing noise", good + b"x", None
        for i in range(12 + good[10], len(good), max(1, len(good) // 25)):  # behind the name, which is free text
            yield f"byte {i} another", good[:i] + bytes([good[i] ^ 0x10]) + good[i + 1 :], None
    return damages


def damages_of_ulog(good):
    def damages():
        yield from mutations.of_any_file(good)
        yield from mutations.of_binary(good, 7)
        yield from mutations.cuts(good[:16], 8)
    return damages


def damages_of_run(good):
    def damages():
        yield from mutations.of_any_file(good)
        text = good.decode()
        yield from mutations.of_text(good)
        yield from mutations.cuts(good, 20)
        yield "a list", b"[]", None
        yield "an object without flights", b"{}", None
        yield "a number", b"42", None
        yield "flights of another type", b'{"flights": 5}', None
        yield "a flight of another type", b'{"flights": [5]}', None
        yield "NaN", text.replace(":", ": NaN,", 1).encode(), None
        for name, old, new in (("another format", '"jink-sim run"', '"jink-sim walk"'), ("another version", '"version":2', '"version":3'), ("a version as text", '"version":2', '"version":"2"'),
                               ("no format", '"format":', '"form":'), ("a key twice", '"version":2', '"version":2,"version":2'), ("an absurd number", '"promise":', '"promise":1e300,"x":'),
                               ("a number beyond a double", '"promise":', '"promise":1e999,"x":'), ("a number of 400 digits", '"promise":', f'"promise":{"9" * 400},"x":')):
            if old not in text:
                raise ValueError(f"the good run lacks {old}")
            yield name, text.replace(old, new, 1).encode(), None
        yield "100 000 lists in each other", b"[" * 100_000, None
    return damages


def made(command, file):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return pathlib.Path(file).read_bytes()


def flight_log(jinkd, folder):
    """A log of a second of jinkd, which hears nobody."""
    process = subprocess.Popen([jinkd, "--link", "udpout:127.0.0.1:9", "--log", folder, "--quiet"], stderr=subprocess.DEVNULL)
    time.sleep(1.0)
    process.terminate()
    process.wait()
    return max(folder.glob("*.ulg"), key=lambda file: file.stat().st_size).read_bytes()


def all_formats(build, work):
    jink, jinkd, sim = build / "toolchain/host/jink", build / "firmware/linux/jinkd", build / "toolchain/sim/jink-sim"
    daemon = lambda *options: [jinkd, "--link", "udpout:127.0.0.1:9", "--quiet", *options]  # noqa: E731
    mesh = work / "good.obj"
    mesh.write_bytes(MESH)
    jmap = made([jink, "mesh", "build", mesh, "--out", work / "good.map"], work / "good.map")
    (work / "log").mkdir()
    log = flight_log(jinkd, work / "log")
    run = made([sim, "fly", TOP / "tests/scenario/clear_pass.yaml", "--out", work / "run"], work / "run/run.json")
    model = (TOP / "tests/scenario/manned_test.cpp").read_text(encoding="utf-8").partition('R"MODEL(')[2].partition(')MODEL"')[0].encode()
    vehicle = damages_of_yaml(VEHICLE, "cruise_speed: 5", "cruise_speed", "\nmass: 3")
    problem = damages_of_yaml(PROBLEM, "distance: 30", "distance", "start: [0, 0, 30]\n")
    scenario = damages_of_scenario
    yield Format("vehicle (jink check)", ".yaml", VEHICLE, lambda f, o: [jink, "check", "--as", "vehicle", f], vehicle)
    yield Format("vehicle (jink tables)", ".yaml", VEHICLE, lambda f, o: [jink, "tables", f, "--out", o / "tables.hpp"], some(vehicle), checks_good=False)
    yield Format("vehicle (jinkd)", ".yaml", VEHICLE, lambda f, o: daemon("--vehicle", f, "--log", o), some(vehicle), runs_on=True, patience=0.5)
    yield Format("problem (jink plan)", ".yaml", PROBLEM, lambda f, o: [jink, "plan", f], problem, good_status=1)
    yield Format("scenario (jink check)", ".yaml", SCENARIO, lambda f, o: [jink, "check", "--as", "scenario", f], scenario)
    yield Format("scenario (jink-sim fly)", ".yaml", SCENARIO, lambda f, o: [sim, "fly", f, "--out", o / "run"], some(scenario))
    yield Format("parameters (jink check)", ".param", PARAMETERS, lambda f, o: [jink, "check", "--as", "params", f], damages_of_parameters, excused=NO_PARAMETER)
    yield Format("parameters (jinkd)", ".param", PARAMETERS, lambda f, o: daemon("--params", f), damages_of_parameters, runs_on=True, patience=0.5,
                 excused=NO_PARAMETER)
    yield Format("airspace (jinkd)", ".yaml", AIRSPACE, lambda f, o: daemon("--airspace", f), damages_of_yaml(AIRSPACE, "frame: local", "frame", "    radius: 400\n"),
                 runs_on=True, patience=0.5)
    yield Format("signing key (jinkd)", ".key", KEY, lambda f, o: daemon("--signing-key", f, "--state", o / "state"), key_damages, runs_on=True, patience=0.5)
    yield Format("map (jink mesh show)", ".map", jmap, lambda f, o: [jink, "mesh", "show", f], damages_of_map(jmap), has_lines=False)
    yield Format("map (jinkd)", ".map", jmap, lambda f, o: daemon("--map", f), some(damages_of_map(jmap)), has_lines=False, runs_on=True, patience=0.5)
    yield Format("mesh (jink mesh build)", ".obj", MESH, lambda f, o: [jink, "mesh", "build", f, "--out", o / "map"], damages_of_mesh)
    yield Format("mesh of facets (jink mesh build)", ".stl", STL, lambda f, o: [jink, "mesh", "build", f, "--out", o / "map"], damages_of_stl)
    yield Format("flight log (jink log)", ".ulg", log, lambda f, o: [jink, "log", f, "--csv", o / "csv"], damages_of_ulog(log), has_lines=False)
    yield Format("flight log (replay)", ".ulg", log, lambda f, o: [jink, "log", "--replay", f], damages_of_ulog(log), has_lines=False)
    yield Format("run (jink report)", ".json", run, lambda f, o: [jink, "report", f, "--out", o / "report.html"], damages_of_run(run))
    yield Format("recording (jink-sim replay)", ".wire", WIRE, lambda f, o: [sim, "replay", f], damages_of_wire(WIRE), has_lines=False)
    yield Format("recorded encounter (jink-sim recorded)", ".daa", DAA, lambda f, o: [sim, "recorded", f], damages_of_daa)
    yield Format("encounter model (jink-sim manned)", ".txt", model, lambda f, o: [sim, "manned", f, "--count", "1"], model_damages(model), checks_good=False)  # it has no track that is low enough to be flown beside
    yield Format("seeds (jink-sim encounters)", ".txt", SEEDS, lambda f, o: [sim, "encounters", "--seed-file", f, "--out", o / "blocks"],
                 with_lines(SEEDS, ("a text", "x", 1), ("NaN", "nan", 1), ("a negative number", "-1", 1), ("a fraction", "1.5", 1), ("too large", "9" * 30, 1),
                            ("two numbers", "11 12", 1), ("hexadecimal", "0x11", 1), ("a unit behind", "11s", 1), ("a sign", "+11", 1)))
