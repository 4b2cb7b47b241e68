# SPDX-License-Identifier: BSD-3-Clause
"""Checks of an image: size, absence of an allocator, and a stack that its call graph cannot overflow.

Usage: image_check.py BUILD_FOLDER IMAGE

Exit status 77 (skipped) where the image was not built.
"""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "toolchain" / "report"))
import memory_sizes  # noqa: E402
import stack  # noqa: E402

# With reach sets and reciprocal avoidance; the memory report has their limits and the limit of the rest as well.
MOST_FLASH = memory_sizes.LIMITS["flash"]
STORE_IN_FLASH = {"stm32h743": 8 * 1024}  # parameters, on top of what mps2_an500 has; stm32f405 has smaller reach sets
MOST_STATIC_RAM = memory_sizes.LIMITS["static RAM with its stack"]
MOST_COUPLED = memory_sizes.LIMITS["core-coupled"]
MOST_STACK = memory_sizes.LIMITS["stack"]
PLAN_STACK = memory_sizes.LIMITS["plan stack"]  # app::PlanMemory
ALLOCATORS = re.compile(r"\b(malloc|calloc|realloc|free|_sbrk|sbrk|_malloc_r|_free_r|operator new|operator delete)\b")


def tool(name, *arguments):
    return subprocess.run(["arm-none-eabi-" + name, *arguments], check=True, capture_output=True, text=True).stdout


def interrupt_stack(graph):
    """The deepest handler, and what an interrupt pushes: 26 words with the floating-point registers, one more to align."""
    return max(graph.deepest(name)[0] for name in graph.frames if re.search(r"^jink_(uart|usart|can|guard)", name)) + 27 * 4


def stack_bounds(build):
    """Of the program, and of a plan on its own stack."""
    graph = stack.Graph(build, skip="tests/")
    return [graph.deepest(entry)[0] + interrupt_stack(graph) for entry in ("jink_main", "jink_fiber_main")]


def main(build, image):
    folder = pathlib.Path(build)
    elf = folder / "firmware" / image / f"{image}.elf"
    if not elf.exists():
        print(f"{elf} was not built: skipped")
        return 77
    text, data, bss, coupled = memory_sizes.sections(str(elf))
    symbols = tool("nm", "-C", str(elf))
    allocators = sorted(set(line for line in symbols.splitlines() if ALLOCATORS.search(line)))
    sizes = {line.split()[2]: int(line.split()[0], 16) for line in symbols.splitlines() if len(line.split()) == 3}
    reserved = sizes["_stack_top"] - sizes["_stack_bottom"]
    graph = stack.Graph(build, skip="tests/")
    deepest, chain = graph.deepest("jink_main")
    of_plan = graph.deepest("jink_fiber_main")[0]
    interrupt = interrupt_stack(graph)
    rows = [
        ("flash: code, constants, initial values", text + data, MOST_FLASH + STORE_IN_FLASH.get(image, 0)),
        ("static RAM, stack included", data + bss, MOST_STATIC_RAM),
        ("memory apart: plans, log, CAN", coupled, MOST_COUPLED),
        ("stack by call graph: program", deepest, None),
        ("stack by call graph: an interrupt on top", interrupt, None),
        ("stack in all", deepest + interrupt, min(reserved, MOST_STACK)),
        ("stack of a plan by call graph, in all", of_plan + interrupt, PLAN_STACK),
    ]
    failed = len(allocators)
    for name, value, most in rows:
        bad = most is not None and value > most
        failed += bad
        print(f"{image}: {name:42s} {value:7d} bytes" + (f" of {most}" if most else "") + (" TOO MUCH" if bad else ""))
    print("deepest chain: " + " > ".join(graph.names.get(f, f).split("(")[0].split()[-1] + f" {own}" for f, own in chain))
    for problem in sorted(set(graph.problems)):
        print("not bounded: " + problem)
        failed += 1
    print("allocators in the image: " + (", ".join(allocators) or "none"))
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1], sys.argv[2]))
