# SPDX-License-Identifier: BSD-3-Clause
"""Iteration counts of a plan's loops, by capacities and settings; and functions that are never called in a scene.

Each rule: a pattern for the place of a loop (file, function and text of the line that jumps back, innermost function
first, as many callers as the compiler has inlined), whether its turns are counted each time the loop is entered or in all
in one call, and how many they are. The first rule that fits the innermost place that any fits is taken.
"""
import math
import pathlib
import re
import subprocess

import bound
import flights
import stages
import targets

TOP = pathlib.Path(__file__).resolve().parents[2]


def parameters(candidates, tracks, obstacles, attempts, waypoints=25, points=64, lookahead=8.0, cruise=5.0, climb=3.0, slowest=1.0):
    """Parameters of the rules. The longest candidate: at most 2 D along the leg and twice 1.2801 D across, D being at
    most what is flown within the lookahead, at the speed of the leg (1.6 of cruise speed at most) or of climb where that is less."""
    speed = 1.6 * cruise
    longest = (2.0 + 2.0 * 1.2801) * lookahead * max(1.0, speed / climb) / slowest
    steps = points - min(12, points // 4)
    step = max(0.2, longest / (steps - 1))
    early = math.ceil(3.0 / step) + 1
    parts = early * math.ceil(step / 0.1) + (steps - early) * math.ceil(step / 0.25)
    return {"candidates": candidates, "tracks": tracks, "obstacles": obstacles, "attempts": attempts, "waypoints": waypoints,
            "points": points, "steps": steps, "flight parts": parts,
            # Where the escape rule shrinks a sphere: pieces of 0.05 s (half of 0.05 m at 0.5 m/s), spread over as many
            # segments as any curve is taken to have.
            "escape parts": math.ceil(longest / 0.05 / (points - 1)) + 1,
            # Conflict search computes the separation of one track from a path of two pieces, in 480 parts at most.
            "threats": 3 + tracks + obstacles, "checked tracks": 1, "pieces of a path": 2, "chunks": 1, "paid parts": 480,
            "pieces": math.ceil(lookahead / 0.5)}


RULES = [
    # The images fly along one leg, a route of one segment: at most three pieces of way. Nothing is closed. Weights as they are by default, without that of passing. No solids.
    (r"[cC]ylinder", "each", lambda p: 0),  # no closed areas
    (r"along_reference|plan_along", "each", lambda p: 0),
    (r"core/path/route|route_way\.cpp:.*segment", "each", lambda p: 1),
    (r"route_way\.cpp|RoutePieces|WayPiece", "each", lambda p: 3),
    (r"Run::passing|moving_solids|solid\.shape|clearance_solids\.cpp|geometric/extent\.hpp", "each", lambda p: 0),
    (r"keeps_soft_margins", "each", lambda p: 1),  # no closed areas: one round
    (r"solve_with_retries", "each", lambda p: p["attempts"]),
    (r"in_a_row\.cpp:.*(kFirstParts|look < 2)", "each", lambda p: 2),
    (r"solve_in_a_row.*part", "each", lambda p: 2),
    (r"in_a_row\.cpp:.*first_met.*threats", "each", lambda p: p["tracks"]),
    (r"in_a_row\.cpp:.*obstacle", "each", lambda p: p["obstacles"]),
    (r"in_a_row\.cpp:.*[pP]oint", "each", lambda p: p["points"]),
    (r"nearest\.cpp", "each", lambda p: p["tracks"]),
    (r"conflict(_moving)?\.cpp:.*situation\.threats|conflict_with", "each", lambda p: p["threats"]),
    (r"conflict\.cpp:.*touching", "each", lambda p: 8),
    (r"threat_set\.cpp|of_kind|world::Threat const\*|solve\.cpp:.*p\.threats", "each", lambda p: p["threats"]),
    (r"separation(_parts\.hpp|\.cpp):.*part < parts", "in all", lambda p: p["paid parts"]),
    (r"shape\.vertices|jink::Point3 const\*, std::span|const Point3& p", "each", lambda p: 0),  # no hulls
    (r"map_obstacles", "each", lambda p: 0),  # no map
    (r"next \+ 1 < curve\.points", "in all", lambda p: p["points"]),
    (r"next \+ 1 < path\.points", "in all", lambda p: p["flight parts"] + p["points"]),
    (r"flown\.cpp:.*fly.*flight\.ended|flight\.hpp:.*early", "in all", lambda p: p["steps"] + 1),
    (r"flown\.cpp:.*fly.*i < flight\.parts|flight\.hpp:.*Flight::fly\(int", "in all", lambda p: p["flight parts"]),
    (r"flown\.cpp:.*kTailPoints|flown\.cpp:.*brake", "in all", lambda p: 12),
    (r"flight\.hpp:.*(count < most|Steps::Steps)", "each", lambda p: 3),
    (r"touches_in_parts|Clearance::leaves", "each", lambda p: p["escape parts"]),
    (r"conflict_moving\.cpp:.*i < parts", "each", lambda p: p["pieces"]),
    (r"conflict(_moving)?\.cpp:.*pieces_", "each", lambda p: 3),
    (r"conflict\.cpp:.*i < 8", "each", lambda p: 8),
    (r"separation(_parts\.hpp|\.cpp):.*situation\.threats", "each", lambda p: p["threats"]),
    (r"separation(_parts\.hpp|\.cpp):.*(threats\.size|threats\.first)", "each", lambda p: p["checked tracks"]),
    (r"separation(_parts\.hpp|\.cpp):.*(chunks\(\)|first < count_|first \+= kChunk)", "each", lambda p: p["chunks"]),
    (r"separation(_parts\.hpp|\.cpp):.*(chunk\.last|i < last)", "each", lambda p: min(8, p["pieces of a path"])),
    (r"separation(_parts\.hpp|\.cpp)", "each", lambda p: p["pieces of a path"]),
    (r"kShrinkSteps", "each", lambda p: 6),
    (r"situation\.tracks|problem_\.threats|moving_\.size|per_threat|geometric::Threat", "each", lambda p: p["tracks"]),
    (r"obstacles\.size|obstacles\(\)|problem_\.obstacles|world::Obstacle|obstacle\.shape", "each", lambda p: p["obstacles"]),
    (r"settings\.retries", "each", lambda p: p["attempts"]),
    (r"planner\.cpp:.*path\.points", "each", lambda p: p["waypoints"]),
    (r"generate\.cpp:.*(kWaitShares|share)", "in all", lambda p: 3),
    (r"generate\.cpp:.*(kWaitTimes|times)", "in all", lambda p: 12),
    (r"settings\.cpp:.*kCurves|settings\.cpp:.*family", "each", lambda p: 4),
    (r"clearance\.cpp:.*(check.*i < end|items_)", "each", lambda p: p["tracks"] + p["obstacles"]),
    (r"stl_heap\.h.*__(adjust|push)_heap|stl_heap\.h:(229|140)", "each", lambda p: math.ceil(math.log2(max(2, p["candidates"]))) + 1),
    (r"stl_heap\.h", "each", lambda p: p["candidates"]),
    (r"(solve|choose|generate)\.cpp:.*(result_\.path\.points|unit\.points)|operator=|StaticVector|std::array|static_vector", "each", lambda p: 128),
    (r"(solve\.cpp|choose\.cpp|generate\.cpp|run\.hpp):.*(candidates|order_?\.empty|planes|offset|evaluate\(|units_of_curve\(\)\)|each \* settings_\.waypoints)|offsets\.cpp", "each", lambda p: p["candidates"]),
    (r"(solve|choose|generate)\.cpp:.*Family", "each", lambda p: 4),
    (r"curve\.cpp|^core/cost/|(solve|choose|generate)\.cpp:.*(max_element|closeness_nearest)", "each", lambda p: max(p["waypoints"], p["tracks"])),
    (r"clearance(_airspace|_spheres)?\.cpp", "each", lambda p: p["points"] - 1),
    (r"memcpy|memset|memmove", "each", lambda p: 128),
]
# Handlers of interrupts, as if one came for each byte of a serial line and for each frame of a bus: several in one take less. The
# ports are made before the first interrupt.
INTERRUPT_RULES = [(r"bxcan\.hpp:.*on_(receive|transmit)|us?art\.hpp:", "each", lambda p: 1)]
ENTRY_CYCLES = 29  # Cortex-M4 and M7, with the registers of the FPU
NEVER_INTERRUPTED = [r"^memset$"]
INTERRUPTS = r"^jink_(usart\d|uart_(receive|transmit|overrun)|can\d_(transmit|receive|status))$"
# With time-aware security, one leg, default weights and without solids; the predicted flight instead of the check of accelerations. Angles are below
# 2 pi, far from where newlib's reduction of large ones begins.
NEVER = [r"touches_swept", r"is_flyable", r"Clearance6leaves", r"Clearance7touchesERKNS1_5CurveERKNS1_6ExtentERKNS_8geometry5Shape",
         r"Clearance7touchesERKNS1_4View", r"4cost7passing", r"11time_beyond", r"make_base", r"make_curve_along", r"bend_along", r"seen_at_collision",
         r"reach_along", r"ReferenceAhead", r"move_start_along", r"is_wait_flyable", r"collision_point_along",
         r"4path5Route",
         r"swept_box_(contact|distance)", r"obstacle_margin", r"meets_solid", r"13local_support", r"9WorkSlice4take", r"__kernel_rem_pio2f", r"__assert", r"abort"]

# libgcc's software doubles, which share code between functions: an allowance per call, far above their cost.
LIBRARY = [(r"^__aeabi_", 1000)]


class Turns:
    """The iterations of a loop, for bound.weights."""

    def __init__(self, program, prefix, values, rules=RULES):
        self.rules = rules
        self.program, self.prefix, self.values, self.lines, self.used = program, prefix, values, {}, []

    def places(self, addresses):
        out = subprocess.run([self.prefix + "addr2line", "-i", "-f", "-C", "-e", self.program], check=True, capture_output=True, text=True,
                             input="\n".join(map(hex, sorted(addresses)))).stdout.splitlines()
        for function, where in zip(out[::2], out[1::2]):
            file, line = where.split(" ")[0].rsplit(":", 1)
            ours = stages.PLACE.search(file + ":")
            text = ""
            if ours and line.isdigit():
                if ours[1] not in self.lines:
                    self.lines[ours[1]] = (TOP / ours[1]).read_text(encoding="utf-8").splitlines()
                text = self.lines[ours[1]][int(line) - 1].strip()
            yield f"{ours[1] if ours else pathlib.Path(file).name + ':' + line}:{function}: {text}"

    def __call__(self, function, addresses):
        places = list(self.places(addresses))
        for place in places + [function.name]:
            for pattern, how, turns in self.rules:
                if re.search(pattern, place):
                    self.used.append((pattern, how, turns))
                    return how, turns(self.values)
        raise bound.Refused(f"{function.name}: a loop that no rule knows: {' < '.join(places)[:300]}")


ROOT = "_ZN4jink9geometric7Planner4planERKNS_5world9SituationERNS_10WorkBudgetERNS2_9ManoeuvreE"
IMAGES = ("mps2_an500", "stm32f405")
SCENES = {"plan_16_3": dict(candidates=16, tracks=3, obstacles=0, attempts=1),
          "plan_16_3_retries": dict(candidates=16, tracks=3, obstacles=0, attempts=9, slowest=0.3)}
# The last attempt makes several plans of its own and is made once: counted separately.
IN_A_ROW = "solve_in_a_row"


def of_plan(program, scene):
    """(bound, unbounded items, iteration counts used) of a plan in a Cortex-M image's probe."""
    turns = Turns(str(program), "arm-none-eabi-", parameters(**SCENES[scene]))
    plain = bound.Bound(str(program), "arm-none-eabi-", turns, NEVER + [IN_A_ROW], LIBRARY)
    instructions, problems = plain.of(ROOT), plain.problems
    if SCENES[scene]["attempts"] > 1:
        symbols = subprocess.run(["arm-none-eabi-nm", str(program)], check=True, capture_output=True, text=True).stdout.split()
        last = bound.Bound(str(program), "arm-none-eabi-", turns, NEVER, LIBRARY)
        instructions += last.of(next(name for name in symbols if IN_A_ROW in name))
        problems = problems + last.problems
    return instructions, sorted(set(problems)), turns.used


class _Keys(dict):
    """Parameters that remember which of them were asked for."""

    def __init__(self, values):
        super().__init__(values)
        self.asked = []

    def __getitem__(self, key):
        self.asked += [] if key in self.asked else [key]
        return super().__getitem__(key)


def loops_of_plan(program, scene):
    """The rules that a plan's loops are bounded by: [rule, how its turns count, turns, parameters they come from]."""
    rows = []
    for pattern, how, turns in dict.fromkeys(of_plan(program, scene)[2]):
        keys = _Keys(parameters(**SCENES[scene]))
        count = turns(keys)
        rows.append([pattern, how, count, ", ".join(keys.asked)])
    return sorted(rows, key=lambda r: (-r[2], r[0]))


def interrupts(program):
    """{handler: most instructions of one interrupt, and as many again as entry and return with the registers of the FPU take cycles}"""
    symbols = subprocess.run(["arm-none-eabi-nm", str(program)], check=True, capture_output=True, text=True).stdout.split()
    out = {}
    for name in sorted({s for s in symbols if re.search(INTERRUPTS, s)}):
        of = bound.Bound(str(program), "arm-none-eabi-", Turns(str(program), "arm-none-eabi-", {}, INTERRUPT_RULES), NEVER_INTERRUPTED)
        out[name] = of.of(name) + ENTRY_CYCLES
        if of.problems:
            raise bound.Refused(of.problems[0])
    return out


def all_plans(program_of):
    """{scene: {image: instructions}}, and unbounded items."""
    out, problems = {}, []
    for scene in SCENES:
        out[scene] = {}
        for image in IMAGES:
            out[scene][image], unbounded, _ = of_plan(program_of(image), scene)
            problems += [f"{image}, {scene}: not bounded: {problem}" for problem in unbounded]
    return out, problems
