# SPDX-License-Identifier: BSD-3-Clause
"""Starts a command under SystemCallFilter and MemoryDenyWriteExecute of a unit, as systemd would; needs libseccomp.

    system_call_filter.py UNIT COMMAND [ARGUMENT ...]
"""
import ctypes
import os
import pathlib
import re
import subprocess
import sys

ALLOW, REFUSE = 0x7FFF0000, 0x00050000 | 1  # SCMP_ACT_ALLOW, SCMP_ACT_ERRNO(EPERM)
WRITE_AND_EXECUTE = 2 | 4  # PROT_WRITE | PROT_EXEC
MASKED_EQUAL = 7  # SCMP_CMP_MASKED_EQ


class Comparison(ctypes.Structure):
    _fields_ = [("argument", ctypes.c_uint), ("operation", ctypes.c_int), ("a", ctypes.c_uint64), ("b", ctypes.c_uint64)]


def names(entry):
    """System calls of a group such as @system-service, or the one of that name."""
    if not entry.startswith("@"):
        return {entry}
    text = subprocess.run(["systemd-analyze", "syscall-filter", entry], check=True, capture_output=True, text=True).stdout
    words = [line.strip() for line in text.splitlines()[1:] if line.startswith("    ") and not line.strip().startswith("#")]
    return set().union(*(names(word) for word in words))


def permitted(unit):
    """What the lines of SystemCallFilter leave: the first permits, lines with ~ refuse."""
    left = set()
    for line in re.findall(r"^SystemCallFilter=(.*)$", unit, re.M):
        listed = set().union(*(names(entry) for entry in line.lstrip("~").split()))
        left = left - listed if line.startswith("~") else left | listed
    return left


def load(unit):
    library = ctypes.CDLL("libseccomp.so.2")
    library.seccomp_init.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.seccomp_init(REFUSE))
    deny = re.search(r"^MemoryDenyWriteExecute=yes", unit, re.M) is not None
    for name in permitted(unit):
        number = library.seccomp_syscall_resolve_name(name.encode())
        if number < 0:
            continue  # of another processor
        if deny and name in ("mmap", "mprotect", "pkey_mprotect"):
            # A page may be mapped as code, but never be writable as well, and none becomes code later.
            for protection in (0, 2, 4) if name == "mmap" else (0, 2):
                rule = Comparison(2, MASKED_EQUAL, WRITE_AND_EXECUTE, protection)
                library.seccomp_rule_add_array(context, ALLOW, number, 1, ctypes.byref(rule))
            continue
        if library.seccomp_rule_add_array(context, ALLOW, number, 0, None) != 0:
            raise SystemExit(f"no rule for {name}")
    if library.seccomp_load(context) != 0:
        raise SystemExit("the filter cannot be loaded")


def main():
    load(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    os.execvp(sys.argv[2], sys.argv[2:])


if __name__ == "__main__":
    main()
