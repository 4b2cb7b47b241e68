#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The installed package for the Cortex-M7 suffices for a third-party image: installs the package, builds the image
outside of the tree, starts it under qemu and waits for HEARTBEATs.

    image_test.py TOP BUILD WORK      BUILD: build folder of the preset mps2_an500
"""
import pathlib
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from mavlink_frames import HEARTBEAT, frames  # noqa: E402

SKIPPED = 77
WANTED = 3  # HEARTBEATs, one a second
LONGEST = 60  # seconds


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"failed ({done.returncode}): {' '.join(map(str, command))}\n{done.stdout}")


def main():
    top, build, work = map(pathlib.Path, sys.argv[1:4])
    if not (build / "firmware/libjink_app.a").exists() or not shutil.which("qemu-system-arm"):
        print("no build of mps2_an500, or no qemu-system-arm: skipped")
        return SKIPPED
    shutil.rmtree(work, ignore_errors=True)
    prefix, out = work / "prefix", work / "build"
    run("cmake", "--install", build, "--prefix", prefix)
    run("cmake", "-S", top / "tests/example/image", "-B", out, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release",
        f"-DCMAKE_TOOLCHAIN_FILE={top}/toolchain/cmake/targets/cortex-m7.cmake", "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -Wall -Wextra -Werror")
    run("cmake", "--build", out)
    serial = work / "serial.bin"
    board = subprocess.Popen(["qemu-system-arm", "-M", "mps2-an500", "-display", "none", "-monitor", "none", "-serial", f"file:{serial}",
                              "-kernel", str(out / "example_image.elf")])
    try:
        begin, heard = time.monotonic(), 0
        while heard < WANTED and time.monotonic() - begin < LONGEST and board.poll() is None:
            time.sleep(0.2)
            heard = sum(message == HEARTBEAT for _, message, _ in frames(serial.read_bytes())[0]) if serial.exists() else 0
    finally:
        board.kill()
        board.wait()
    print(f"{heard} HEARTBEATs of an image made of the installed package")
    return 0 if heard >= WANTED else 1


if __name__ == "__main__":
    sys.exit(main())
