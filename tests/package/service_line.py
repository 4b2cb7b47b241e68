#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Starts the line of jinkd.service on a pseudo-terminal and waits for READY, the watchdog's feed, a HEARTBEAT, and
JNK_MODE 1: as installed, jink only advises.

    service_line.py --unit FILE --defaults FILE [--params FILE] [--program FILE] [--root FOLDER] [--state FOLDER]

As root, jinkd gets what the unit gives it: another user, no capability, and the limits of LimitRTPRIO and LimitMEMLOCK
where the machine permits to raise them. Then --realtime of the defaults has to succeed. Outside of --root the unit's filter of system calls is in force. What
systemd alone can do is not tried: its view of files and devices, restarts.
"""
import argparse
import os
import pathlib
import pty
import re
import select
import shlex
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import tty

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from mavlink_frames import AVOIDANCE, HEARTBEAT, encode, frames  # noqa: E402

FILTER = pathlib.Path(__file__).resolve().with_name("system_call_filter.py")
PARAM_REQUEST_LIST, PARAM_VALUE = 21, 22
# An autopilot's HEARTBEAT, and a ground station that asks for all parameters.
ASKING = encode(HEARTBEAT, bytes([0, 0, 0, 0, 2, 3, 81, 4, 3]), 0, 1, 1) + encode(PARAM_REQUEST_LIST, bytes([1, AVOIDANCE]), 0, 255, 190)


def mode_in(stream):
    """JNK_MODE of the PARAM_VALUEs in a stream; None: it has not come."""
    for component, message, payload in frames(stream)[0]:
        if (component, message) == (AVOIDANCE, PARAM_VALUE):
            value, name = struct.unpack("<f4x16s", payload.ljust(25, b"\0")[:24])
            if name.rstrip(b"\0") == b"JNK_MODE":
                return value
    return None


def setting(text, name):
    """Last value of a setting of a unit, or of a variable of a file for the shell."""
    return re.findall(rf"^{name}=(.*)$", text, re.M)[-1]


def limits(unit):
    """Command that sets the unit's two limits; empty where the machine does not let root raise limits (a container)."""
    memory = setting(unit, "LimitMEMLOCK").replace("infinity", "unlimited")
    command = ["prlimit", f"--rtprio={setting(unit, 'LimitRTPRIO')}", f"--memlock={memory}"]
    return command if subprocess.run([*command, "true"], capture_output=True).returncode == 0 else []


def without_rights(user, *files):
    """Command that becomes the user and gives up all capabilities, as the unit does. Root stays where the user does not
    reach the files, as in a build folder below /root."""
    none = ["setpriv", "--no-new-privs", "--bounding-set=-all", "--inh-caps=-all"]
    other = none + [f"--reuid={user}", f"--regid={user}", "--clear-groups"]
    if all(subprocess.run([*other, "test", "-r", file]).returncode == 0 for file in files):
        return other
    print("the user does not reach the files: started as root without capabilities")
    return none


def line(unit, defaults, arguments, device, state):
    """ExecStart with the variables replaced as systemd does, with the serial port `device`."""
    words = []
    for word in setting(unit, "ExecStart").split():
        if word.startswith("$") and not word.startswith("${"):
            values = {"JINKD_LINE": f"--serial {device}:921600", "JINKD_OPTIONS": shlex.split(setting(defaults, "JINKD_OPTIONS"))[0]}
            words += values[word[1:]].split()
        else:
            words.append(word.replace("${STATE_DIRECTORY}", state))
    if arguments.program:
        words[0] = arguments.program
    if arguments.params:
        words[words.index("--params") + 1] = arguments.params
    return words


def wait_for(process, notify, port):
    """Which of READY, WATCHDOG, HEARTBEAT and JNK_MODE 1 did not come within ten seconds."""
    missing, stream, end, asked = {"READY=1", "WATCHDOG=1", "HEARTBEAT", "JNK_MODE 1"}, b"", time.monotonic() + 10, 0.0
    while missing and time.monotonic() < end and process.poll() is None:
        if time.monotonic() - asked > 0.5:
            asked = time.monotonic()
            os.write(port, ASKING)
        for ready in select.select([notify, port], [], [], 0.2)[0]:
            if ready is notify:
                missing -= set(notify.recv(4096).decode().split("\n"))
            else:
                stream += os.read(port, 4096)
        if (AVOIDANCE, HEARTBEAT) in (frame[:2] for frame in frames(stream)[0]):
            missing.discard("HEARTBEAT")
        if mode_in(stream) == 1.0:
            missing.discard("JNK_MODE 1")
    return missing


def check(arguments):
    """Errors, one text each."""
    unit, defaults = (pathlib.Path(f).read_text(encoding="utf-8") for f in (arguments.unit, arguments.defaults))
    port, terminal = pty.openpty()
    tty.setraw(terminal)
    device = os.ttyname(terminal)
    os.chmod(device, 0o666)
    notify = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    name = f"jinkd-test-{os.getpid()}"
    notify.bind("\0" + name)
    root = os.geteuid() == 0
    raised = limits(unit) if root else []
    command = line(unit, defaults, arguments, device, arguments.state)
    files = []
    if not arguments.root:
        files = [command[0], arguments.unit, str(FILTER), *([arguments.params] if arguments.params else [])]
        if shutil.which("systemd-analyze"):
            command = ["/usr/bin/python3", "-B", str(FILTER), arguments.unit, *command]
    if root:
        inside = ["chroot", arguments.root] if arguments.root else []
        command = raised + inside + without_rights(arguments.user, *files) + command
    if not raised:
        print("the limits of the unit cannot be set here: real-time priority is not tried")
    print(shlex.join(command))
    environment = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "NOTIFY_SOCKET": "@" + name}
    errors = []
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=subprocess.STDOUT)
        try:
            errors += [f"no {what} within 10 s" for what in sorted(wait_for(process, notify, port))]
            wanted = re.search(r"--realtime (\d+)", " ".join(command))
            if raised and wanted and process.poll() is None:
                given = os.sched_getparam(process.pid).sched_priority if os.sched_getscheduler(process.pid) == os.SCHED_FIFO else 0
                if given != int(wanted[1]):
                    errors.append(f"real-time priority {given} instead of {wanted[1]}")
        finally:
            process.terminate()
            try:
                status = process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                status = "none within 5 s"
        if status != 0:
            errors.append(f"exit status after SIGTERM: {status}")
        log.seek(0)
        said = log.read().decode(errors="replace")
    for refused in ("no real-time priority", "memory is not locked"):
        if raised and refused in said:
            errors.append(f"{refused} with the unit's limits")
    if errors:
        print(said)
    return errors


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--unit", required=True)
    parser.add_argument("--defaults", required=True)
    parser.add_argument("--params", help="parameter file in place of that of the defaults")
    parser.add_argument("--program", help="in place of the unit's")
    parser.add_argument("--root", help="folder of another system, entered by chroot")
    parser.add_argument("--state", default="/var/lib/jink", help="the unit's StateDirectory, writable for the user")
    parser.add_argument("--user", default="65534", help="number of the user, default nobody's")
    return parser.parse_args(words)


if __name__ == "__main__":
    found = check(parse(sys.argv[1:]))
    print("\n".join(found) or "READY, watchdog, HEARTBEAT and JNK_MODE 1 came")
    sys.exit(1 if found else 0)
