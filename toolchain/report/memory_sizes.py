# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of the memory report."""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import cases
import records
import scenes
import stack
import targets

IMAGES = ["mps2_an500", "stm32f405"]
PREFIX = {"mps2_an500": "arm-none-eabi-", "stm32f405": "arm-none-eabi-", "armhf": "arm-linux-gnueabihf-", "aarch64": "aarch64-linux-gnu-"}
# Reach sets and reciprocal avoidance have their own limits, in addition to the rest of the image. Of the rest, 8 KiB of
# the RAM are the threat set and 2 KiB the answer that is compared with the best so far; of the flash, 4 KiB are closed areas
# and their soft margins among the candidates of the geometric method and in the objective, 8 KiB are
# functions that the compiler inlines across the files of a folder (jink_joined: fewer instructions for more flash), 6 KiB
# are plans in slices: snapshot, fiber, and the work units of a slice, 4 KiB are the objective and its comparison, and
# 10 KiB are what keeps well clear of aircraft, 4 KiB the stop of all that avoid each other, 4 KiB the flight log over MAVLink
# with the names and formats of its topics, and 2 KiB answers that end before something static, the bound of a box by its
# own axes, and how deep the vehicle is in one. The M7's 3 KiB more of all flash are scans of two sensors in a step, the
# directions of ranges, and the check of a way back that a bound bends; 2 KiB and 1 KiB of RAM are ranges of several
# components told apart, and stops after none and after half of the time; the rest's 1 KiB is the latency of ranges and
# repeated traffic reports, and the dead end before a closed area; 1 KiB more of all RAM, and of the rest, is how each
# aircraft turns.
LIMITS = {"flash": 700 * 1024, "flash of the rest": 378 * 1024, "tables of the reach sets": 256 * 1024, "code of reciprocal avoidance": 80 * 1024,
          "static RAM with its stack": 114 * 1024, "static RAM of the rest": 85 * 1024, "reach planner": 32 * 1024, "reciprocal planner": 16 * 1024,
          "stack": 12 * 1024, "plan stack": 8 * 1024, "core-coupled": 64 * 1024}
REACH_TABLES = re.compile(r"jink::reach::(setsOf\w+::|k\w+Sets)")
ALLOCATOR = re.compile(r"\b(malloc|calloc|realloc|free|_sbrk|sbrk|_malloc_r|_free_r|operator new|operator delete)\b")
# Entry points whose stack is of interest to somebody who links the core: (name, mangled name).
ENTRIES = [("image: the program", r"^jink_main$"), ("image: deepest interrupt", r"^jink_(uart|usart|can|guard)"),
           ("image: a plan, on its own stack", r"^jink_fiber_main$"),
           ("Coprocessor::step", r"N4jink3app11Coprocessor4stepE"), ("StateMachine::update (of Supervisor)", r"N4jink5avoid12StateMachine6updateE"),
           ("geometric::Planner::plan", r"N4jink9geometric7Planner4planE"), ("reach::Planner::plan", r"N4jink5reach7Planner4planE"),
           ("orca::Planner::plan", r"N4jink4orca7Planner4planE")]
# Capacities of the formula, another value for each, and a set to try the formula on.
BASE = {"JINK_MAX_TRACKS": 32, "JINK_MAX_OBSTACLES": 96, "JINK_MAX_PATH_POINTS": 64, "JINK_MAX_CANDIDATES": 32,
        "JINK_MAX_HULL_VERTICES": 16, "JINK_MAX_REACH_NODES": 2560, "JINK_MAX_REACH_CELLS": 350, "JINK_MAX_CYLINDERS": 2, "JINK_MAX_MISSION_ITEMS": 16}
TRIED = {"JINK_MAX_TRACKS": 64, "JINK_MAX_OBSTACLES": 192, "JINK_MAX_PATH_POINTS": 128, "JINK_MAX_CANDIDATES": 512,
         "JINK_MAX_HULL_VERTICES": 64, "JINK_MAX_REACH_NODES": 4096, "JINK_MAX_REACH_CELLS": 512, "JINK_MAX_CYLINDERS": 32, "JINK_MAX_MISSION_ITEMS": 64}
PROOF = {"JINK_MAX_TRACKS": 16, "JINK_MAX_OBSTACLES": 40, "JINK_MAX_PATH_POINTS": 96, "JINK_MAX_CANDIDATES": 128,
         "JINK_MAX_HULL_VERTICES": 32, "JINK_MAX_REACH_NODES": 3072, "JINK_MAX_REACH_CELLS": 400, "JINK_MAX_CYLINDERS": 8, "JINK_MAX_MISSION_ITEMS": 32}
# Images with fewer methods (toolchain/cmake/JinkImage.cmake), of the board with the least memory: their names, and the
# modules whose code they must not contain.
FEWER_ON = "stm32f405"
FEWER = {"geometric_reach": ("without the reciprocal method", ["orca"]), "geometric_orca": ("without reach sets", ["reach"]),
         "geometric": ("geometric alone", ["orca", "reach"])}
# Of core/reach, and in every image: the closed areas are merged by them (firmware/app/constraints.cpp).
SHARED = re.compile(r"jink::reach::(CylinderTable::|around\(|merged\()")
TOP = pathlib.Path(__file__).resolve().parents[2]


def run(*command, **more):
    return subprocess.run(command, check=True, capture_output=True, text=True, **more).stdout


def image_of(build, target):
    return pathlib.Path(build) / target / "firmware" / target / f"{target}.elf"


KEPT = (".text", ".rodata", ".vectors", ".init_array", ".ARM.exidx", ".data", ".bss", ".noinit", "COMMON", ".ccm", ".plan")


def by_room(build, target):
    """{module: {flash, ram}} from the linker's map. Objects are found by their names in the archives of the build."""
    folder = pathlib.Path(build) / target
    rooms = {}
    for place, prefix in (("core", "core"), ("firmware", "firmware"), ("hal", "hal")):
        for obj in stack.objects(folder):
            made = folder.resolve() / place / "CMakeFiles"
            if not obj.is_relative_to(made):
                continue
            inside = obj.relative_to(made).as_posix().split("/")
            folder_of = re.fullmatch(r"unity_([\w-]+)_cxx\.cxx\.obj", obj.name)  # of sources joined by folder (jink_joined)
            rooms.setdefault(obj.name, set()).add(folder_of[1].replace("-", "/") if folder_of else "/".join([prefix, *inside[1:-1]]))
    text = (folder / "firmware" / target / f"{target}.map").read_text(encoding="utf-8").split("Linker script and memory map")[1]
    out = {}
    pattern = re.compile(r"^ (\.?[\w.$*-]+)?\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) (\S.*)$")
    joined = re.sub(r"^( [\w.$*-]+)\n +(0x)", r"\1 \2", text, flags=re.M)  # long names are on a separate line
    placed = sorted((int(m[2], 16), int(m[3], 16), m[1], m[4]) for m in map(pattern.match, joined.splitlines()) if m and m[1] and int(m[3], 16) and
                    m[1].startswith(KEPT))
    for (address, size, name, file), (following, *_) in zip(placed, placed[1:] + [(1 << 64,)]):
        size = min(size, following - address) if following > address else size  # merged constants are listed twice
        kind = next((k for k, p in (("flash", (".text", ".rodata", ".vectors", ".init_array", ".ARM.exidx")), ("data", (".data",)),
                                    ("ram", (".bss", ".noinit", "COMMON", ".ccm"))) if name.startswith(p)), None)
        if kind is None:
            continue
        member = re.search(r"\(([^)]+)\)$", file)
        leaf = member[1] if member else pathlib.Path(file).name
        if "libccd" in file:
            room = "libccd"
        elif re.search(r"/lib(c|m|gcc|g|stdc\+\+)(_nano)?\.a", file):
            room = "C and C++ library"
        elif "libjink" in file:
            known = {r for r in rooms.get(leaf, ()) if r.startswith("core") == ("libjink_core" in file) and
                     r.startswith("hal") == ("libjink_hal" in file) and ("/link" in r) == ("libjink_link" in file)}
            room = sorted(known)[0] if known else "?"
        else:
            room = f"firmware/{target}"
        entry = out.setdefault(room, {"flash": 0, "ram": 0})
        entry["flash"] += size if kind in ("flash", "data") else 0
        entry["ram"] += size if kind in ("data", "ram") else 0
    return dict(sorted(out.items()))


def sections(elf):
    """(text, data, bss, core-coupled) of an image [bytes]; the last is memory apart from the rest: plans, and CAN.
    What an emulator has in its place does not count."""
    text, data, bss = map(int, run("arm-none-eabi-size", elf).splitlines()[1].split()[:3])
    coupled, emulated = (sum(int(line.split()[1]) for line in run("arm-none-eabi-size", "-A", elf).splitlines() if line.startswith(names))
                         for names in ((".ccm ", ".plan "), ".plan_emulated "))
    return text, data, bss - coupled - emulated, coupled


def with_fewer_methods(build, target, faults):
    """{images with fewer methods: their sizes}. Builds them; a function or table of a method that is left out is a fault."""
    folder = pathlib.Path(build) / target
    run("cmake", "--build", str(folder), "--target", *(f"{target}_{variant}" for variant in FEWER))
    out = {}
    for variant, (name, absent) in FEWER.items():
        elf = str(image_of(build, target).with_name(f"{target}_{variant}.elf"))
        text, data, bss, _ = sections(elf)
        out[name] = {"flash": text + data, "static RAM with its stack": data + bss}
        left = [line for line in run("arm-none-eabi-nm", "-C", elf).splitlines()
                if re.search(rf" [A-Za-z] jink::({'|'.join(absent)})::", line) and not SHARED.search(line)]
        faults += [f"{target}, {name}: still there: {line}" for line in left]
    return out


def of_image(build, target, faults):
    folder = pathlib.Path(build) / target
    elf = str(image_of(build, target))
    text, data, bss, coupled = sections(elf)
    symbols = run("arm-none-eabi-nm", "-C", elf)
    sizes = {line.split()[2]: int(line.split()[0], 16) for line in symbols.splitlines() if len(line.split()) == 3}
    reserved = sizes["_stack_top"] - sizes["_stack_bottom"]
    allocators = [line for line in symbols.splitlines() if ALLOCATOR.search(line)]
    tables = sum(int(line.split()[1], 16) for line in run("arm-none-eabi-nm", "-S", "-C", elf).splitlines() if REACH_TABLES.search(line))
    types = sizeof(capacities_of(folder))
    reach, orca = types["ReachPlanner"], types["ReciprocalPlanner"]
    graph = stack.Graph(folder, skip="tests/")
    stacks = {}
    for name, pattern in ENTRIES:
        found = [f for f in graph.frames if re.search(pattern, f)]
        stacks[name] = max(graph.deepest(f)[0] for f in found) if found else 0
    interrupt = stacks[ENTRIES[1][0]] + 27 * 4  # with its frame, registers of the FPU included
    deepest, of_plan = stacks[ENTRIES[0][0]] + interrupt, stacks[ENTRIES[2][0]] + interrupt
    rooms = by_room(build, target)
    code = {method: rooms.get(f"core/{method}", {"flash": 0})["flash"] for method in ("reach", "orca")}
    result = {"flash": text + data, "flash of the rest": text + data - tables - sum(code.values()), "tables of the reach sets": tables,
              "code of reciprocal avoidance": code["orca"],
              "static RAM with its stack": data + bss, "static RAM of the rest": data + bss - reach - orca, "reach planner": reach,
              "reciprocal planner": orca, "data": data, "bss": bss - reserved, "stack reserved": reserved, "core-coupled": coupled,
              "stack": deepest, "plan stack": of_plan, "stack by call graph": stacks, "painted stack of the probe": painted(build, target),
              "allocators": len(allocators), "rooms": rooms}
    if target == FEWER_ON:
        result["fewer methods"] = with_fewer_methods(build, target, faults)
    for name, most in LIMITS.items():
        if result[name] > most:
            faults.append(f"{target}: {name}: {result[name]} bytes of {most}: TOO MUCH")
    faults += [f"{target}: an allocator: {line}" for line in allocators]
    faults += [f"{target}: stack not bounded: {problem}" for problem in sorted(set(graph.problems))]
    if not negative_link(folder, target):
        faults.append(f"{target}: an image that allocates links: the proof does not hold")
    return result


def capacities_of(folder):
    """{name: value} that a build was configured with."""
    cache = (folder / "CMakeCache.txt").read_text(encoding="utf-8")
    value = re.search(r"^JINK_CAPACITIES:\w+=(.*)$", cache, re.M)[1]
    return dict(pair.split("=") for pair in value.split(";") if pair)


def painted(build, target):
    """Deepest stack that the probe measured, over random problems of every kind and all records [bytes]."""
    probe = targets.open_probe(target, build)
    deepest = 0
    for sample in scenes.SAMPLES.values():
        deepest = max([deepest] + [probe.ask(sample[2](seed)).stack_used for seed in range(60)])
    for path in sorted((TOP / "tests/timing/records").glob("*.*.json")):
        if not path.name.startswith("step_"):
            deepest = max(deepest, probe.ask(records.read_case(path)[1]).stack_used)
    probe.close()
    return deepest


def negative_link(folder, target):
    """The image links as it is, and does not with a function in it that allocates."""
    commands = run("ninja", "-C", str(folder), "-t", "commands", f"firmware/{target}/{target}.elf").splitlines()
    link = next(c for c in commands if f"-o firmware/{target}/{target}.elf" in c)
    command = shlex.split(link.split("&&")[1])
    compiler = command[0]
    with tempfile.TemporaryDirectory() as name:
        source = pathlib.Path(name) / "allocates.cpp"
        verdicts = []
        for body in ("return nullptr;", "return new int[n];"):
            source.write_text(f"int* volatile kept; int* make(unsigned n) {{ static_cast<void>(n); {body} }}\n"
                              "__attribute__((constructor, used)) static void use() { kept = make(3); }\n", encoding="utf-8")
            flags = [f for f in command if f.startswith("-m") and not f.startswith("-mt=")]
            subprocess.run([compiler, *flags, "-O1", "-fno-exceptions", "-c", str(source), "-o", str(source) + ".o"], check=True)
            changed = [str(pathlib.Path(name) / "image.elf") if a == f"firmware/{target}/{target}.elf" else a for a in command]
            changed = [re.sub(r"-Map=\S+", f"-Map={name}/image.map", a) for a in changed]
            linked = subprocess.run([*changed, str(source) + ".o"], cwd=folder, capture_output=True, text=True)
            verdicts.append((linked.returncode == 0, "_sbrk" in linked.stderr))
    return verdicts[0][0] and not verdicts[1][0] and verdicts[1][1]


def of_linux(build, target):
    folder = pathlib.Path(build) / target
    out = {}
    for name, path in (("core", "core/libjink_core.a"), ("link", "firmware/libjink_link.a"), ("application", "firmware/libjink_app.a")):
        if not (folder / path).exists():
            continue
        rows = [line.split() for line in run(PREFIX[target] + "size", str(folder / path)).splitlines()[1:]]
        out[name] = {"flash": sum(int(r[0]) for r in rows), "data": sum(int(r[1]) for r in rows), "bss": sum(int(r[2]) for r in rows)}
    return out


def sizeof(capacities):
    """Bytes of the types that hold the memory, on the Cortex-M7."""
    defines = [f"-D{k}={v}" for k, v in capacities.items()]
    with tempfile.TemporaryDirectory() as name:
        obj = f"{name}/sizes.o"
        run("arm-none-eabi-g++", "-std=c++20", "-Os", "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-mthumb", "-fno-exceptions",
            "-fno-rtti", "-Wno-psabi", "-DEIGEN_MAX_ALIGN_BYTES=8", "-DEIGEN_NO_MALLOC", "-DEIGEN_NO_IO", *defines, "-I", str(TOP), "-isystem",
            "/usr/include/eigen3", "-c", str(TOP / "tests/timing/sizes.cpp"), "-o", obj)
        lines = run("arm-none-eabi-nm", "-S", obj).splitlines()
    return {line.split()[3][len("size_of_"):]: int(line.split()[1], 16) for line in lines if "size_of_" in line}


def bits_of_cells(name, capacities):
    """The part not linear in the capacities: a bit per threat and reach planner cell, in 32-bit words [bytes]."""
    if name not in ("ReachPlanner", "Coprocessor"):
        return 0
    threats = sum(capacities[f"JINK_MAX_{what}"] for what in ("TRACKS", "OBSTACLES", "CYLINDERS"))
    return 4 * ((threats + 31) // 32) * (capacities["JINK_MAX_REACH_CELLS"] + 1)  # and for the root


def formula(faults):
    """{type: {capacity: bytes each, "fixed": bytes}} out of sizes with one capacity changed at a time, tried on a third set."""
    def straight(capacities):
        return {t: size - bits_of_cells(t, capacities) for t, size in sizeof(capacities).items()}
    base = straight(BASE)
    alone = {c: straight({**BASE, c: value}) for c, value in TRIED.items()}
    out = {t: {} for t in base}
    for t, size in base.items():
        for c in TRIED:
            out[t][c] = (alone[c][t] - size) / (TRIED[c] - BASE[c])
        out[t]["fixed"] = 0.0
        out[t]["fixed"] = size - told(out[t], BASE)
    proof = sizeof(PROOF)
    for t, size in proof.items():
        expected = told(out[t], PROOF) + bits_of_cells(t, PROOF)
        if abs(expected - size) > 16:  # alignment
            faults.append(f"the formula for {t} says {expected:.0f} bytes with {PROOF}, it has {size}")
    out = {t: {c: each for c, each in terms.items() if each} for t, terms in out.items()}
    return {"base": sizeof(BASE), "each": out, "tried": {"sizes": proof}}


def told(terms, capacities):
    total = 0.0
    for name, each in terms.items():
        total += each * capacities.get(name, 1)
    return total


def measure(build, faults):
    result = {"compilers": {t: records.compiler(t) for t in records.TARGETS}, "targets": {}}
    for target in IMAGES:
        result["targets"][target] = of_image(build, target, faults)
    for target in ("armhf", "aarch64"):
        result["targets"][target] = of_linux(build, target)
    result["targets"]["formula"] = formula(faults)
    return result
