# SPDX-License-Identifier: BSD-3-Clause
"""Assigns each instruction of a program to a stage of a plan, an update and a step, from its line tables (-g1)."""
import re
import subprocess

# The innermost listed function among an instruction's inlined functions sets its stage. Instructions without a listed
# function, inlined callers included, count for the calling stage: geometry, vehicle model, mathematics.
STAGES = [
    ("link and messages", r"^(firmware/link|hal)/"),
    ("application", r"^firmware/app/"),
    ("tracks and obstacles", r"^core/world/(track|obstacle)_table"),
    ("supervisor", r"^core/avoid/(state_machine|phase|tick|avoiding|braking|rejoin|nominal_choice|method_order|supervisor)"),
    ("conflict search", r"^core/world/conflict"),
    ("set-up of a plan", r"^core/geometric/(planner\.cpp|solve\.cpp:(solve|is_valid|has_valid|jink::geometric::solve)|settings)"),
    ("candidates", r"^core/geometric/(solve\.cpp:generate|offsets)|make_unit_curve"),
    ("curves", r"^core/geometric/(solve\.cpp:build|curve\.cpp:.*(make_curve|to_timed_path))"),
    ("what is in reach", r"^core/geometric/solve\.cpp:(prepare|list_moving)"),
    ("contact tests of curves", r"^core/geometric/solve\.cpp:(evaluate|verdict_of)|is_flyable"),
    ("costs", r"^core/(cost/|geometric/solve\.cpp:(assess|closeness|smoothness_of|units_of_costs))"),
    ("predicted flights", r"^core/geometric/flown\.cpp:.*(fly|start|add|stops|Flown::Flown|append)"),
    ("contact tests of flights", r"^core/geometric/flown\.cpp:.*judge"),
    ("choice", r"^core/geometric/solve\.cpp:(choose|next_cheapest|take|operator\(\))"),
    ("reach sets", r"^core/reach/"),
    ("reciprocal method", r"^core/orca/"),
    ("objective", r"^core/avoid/objective"),
    ("picture of a plan", r"^core/(world/snapshot|avoid/sliced_plan)"),
    ("final check", r"^core/avoid/final_check\.cpp"),
    ("common stop", r"^core/avoid/common_stop\.cpp"),
    ("fallback", r"^core/avoid/fallback"),
]
PLACE = re.compile(r"/((?:core|firmware|hal)/[^:]*)")
NAMES = ["other"] + [name for name, _ in STAGES]
PATTERNS = [(i + 1, re.compile(pattern)) for i, (_, pattern) in enumerate(STAGES)]


def _tools(target):
    prefix = {"mps2_an500": "arm-none-eabi-", "stm32f405": "arm-none-eabi-", "armhf": "arm-linux-gnueabihf-",
              "aarch64": "aarch64-linux-gnu-"}.get(target, "")
    return prefix


def _code(program, prefix):
    """(first, last) of each candidate function of the project, by address."""
    text = subprocess.run([prefix + "nm", "-C", "-S", program], check=True, capture_output=True, text=True).stdout
    found = set()
    for line in text.splitlines():
        parts = line.split(None, 3)
        if len(parts) == 4 and parts[2] in "tTwWV" and "jink::" in parts[3]:
            first = int(parts[0], 16) & ~1
            found.add((first, first + int(parts[1], 16)))
    return sorted(found)


def _chains(program, prefix, addresses):
    """(address, "file:function" of the inlined functions there, innermost first)."""
    process = subprocess.run([prefix + "addr2line", "-a", "-i", "-f", "-C", "-e", program], check=True, text=True,
                             input="\n".join(hex(a) for a in addresses), capture_output=True)
    chain, address, function = [], None, None
    for line in process.stdout.splitlines():
        if line.startswith("0x"):
            if address is not None:
                yield address, chain
            address, chain, function = int(line, 16), [], None
        elif function is None:
            function = line
        else:
            file = PLACE.search(line)
            chain.append((file[1] if file else "") + ":" + function)
            function = None
    yield address, chain


def stage_of(chain):
    for place in chain:
        for stage, pattern in PATTERNS:
            if pattern.search(place):
                return stage
    return 0


def write_functions(program, target, name):
    """Every function of the program that is the project's own as a stage of its own: their names, with an empty one for the code
    before any. What it calls of the C library counts for it."""
    text = subprocess.run([_tools(target) + "nm", "-C", "-S", "-n", str(program)], check=True, capture_output=True, text=True).stdout
    names, last = [""], 0
    with open(name, "w", encoding="ascii") as file:
        for line in text.splitlines():
            parts = line.split(None, 3)
            if len(parts) < 4 or parts[2] not in "tTwW" or "jink" not in parts[3] or int(parts[0], 16) & ~1 < last:
                continue
            first = int(parts[0], 16) & ~1
            last = first + int(parts[1], 16)
            names.append(parts[3])
            file.write(f"{first:x} {last:x} {len(names) - 1}\n")
    return names


def write(program, target, name):
    """Ranges of addresses by stage, as the plugin window_count reads them."""
    prefix = _tools(target)
    step = 4 if target in ("armhf", "aarch64") else 2
    if target == "armhf":
        step = 2  # Thumb-2, as Debian's compiler does by default
    addresses = [a for first, last in _code(str(program), prefix) for a in range(first, last, step)]
    ranges = []
    for address, chain in _chains(str(program), prefix, addresses):
        stage = stage_of(chain)
        if stage == 0:
            continue
        if ranges and ranges[-1][2] == stage and ranges[-1][1] == address:
            ranges[-1][1] = address + step
        else:
            ranges.append([address, address + step, stage])
    with open(name, "w", encoding="ascii") as file:
        file.writelines(f"{first:x} {last:x} {stage}\n" for first, last, stage in ranges)
    return len(ranges)
