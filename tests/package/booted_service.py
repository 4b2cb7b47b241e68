#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Boots a Debian 12 with the package jink in a container, with systemd as its first process, and tries jinkd.service there.

    booted_service.py ROOT PACKAGE

ROOT: a folder with the packages jink, systemd-sysv and dbus installed. PACKAGE: jink_*.deb. A peer sends an autopilot's HEARTBEAT by UDP
within the container's network. Tried: refusal of an empty line, start, end by SIGKILL, end by a hang (the watchdog's
time), reload, what the service may see and write, that it only advises, stop, upgrade, removal, start at boot. Exit status 77: systemd-nspawn is missing or
cannot boot here. Needs root. Python 3 standard library only.
"""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from mavlink_frames import AVOIDANCE, HEARTBEAT, frames  # noqa: E402
from service_line import ASKING, mode_in  # noqa: E402

PORT = 14540
# Sends frames to jinkd again and again for some seconds and writes what comes back.
PEER = """
import socket, sys, time
asking, port, seconds = bytes.fromhex(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", 14550))  # jinkd keeps to the peer that it has
s.settimeout(0.05)
end, sent = time.monotonic() + seconds, 0.0
while time.monotonic() < end:
    if time.monotonic() - sent > 0.2:
        sent = time.monotonic()
        s.sendto(asking, ("127.0.0.1", port))
    try:
        sys.stdout.buffer.write(s.recv(65536))
    except OSError:
        pass
"""


class Container:
    """A booted container; ended with the object's context."""

    def __init__(self, root):
        self.root = root

    def __enter__(self):
        command = ["systemd-nspawn", "--quiet", f"--directory={self.root}", "--boot", "--register=no", "--keep-unit", "--private-network",
                   "--rlimit=RTPRIO=50", "--console=pipe"]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)
        self.first = wait_for(lambda: self.process.poll() is not None or self.child(), 20) and self.child()
        if not self.first or not wait_for(lambda: self.run("systemctl", "is-system-running").stdout.strip() in ("running", "degraded"), 60):
            self.__exit__()
            print("systemd does not boot in a container here: skipped\n" + self.process.stderr.read().decode(errors="replace"))
            sys.exit(77)
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            if self.first:
                self.run("systemctl", "--no-block", "poweroff")
            if not wait_for(lambda: self.process.poll() is not None, 15):
                os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def child(self):
        """The container's first process, once systemd runs in it."""
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                fields = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)
                if int(fields[1].split()[1]) == self.process.pid and os.readlink(f"/proc/{pid}/exe").endswith("/systemd"):
                    return pid
            except OSError:
                pass
        return None

    def run(self, *command, data=None):
        return subprocess.run(["nsenter", "--target", self.first, "--all", *command], input=data, capture_output=True, text=data is None, check=False)

    def show(self, name):
        return self.run("systemctl", "show", "--property", name, "--value", "jinkd").stdout.strip()

    def journal(self):
        return self.run("journalctl", "-u", "jinkd", "--no-pager").stdout

    def pid(self):
        """Of jinkd outside of the container; None while there is none."""
        inside = self.show("MainPID")
        if inside in ("", "0"):
            return None
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                status = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii")
            except OSError:
                continue
            if status.startswith("Name:\tjinkd\n") and re.search(rf"^NSpid:\t\d+\t{inside}$", status, re.M):
                return int(pid)
        return None

    def answer(self, seconds=2.5):
        """What jinkd sends to an autopilot and a ground station that asks for its parameters."""
        # The container has no interpreter: the peer is this machine's, in the container's network.
        return subprocess.run(["nsenter", "--target", self.first, "--net", sys.executable, "-c", PEER, ASKING.hex(), str(PORT), str(seconds)],
                              capture_output=True, check=True).stdout

    def hears(self):
        """Whether a HEARTBEAT of jinkd answers the autopilot's."""
        return (AVOIDANCE, HEARTBEAT) in (frame[:2] for frame in frames(self.answer())[0])


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not (result := condition()) and time.monotonic() < end:
        time.sleep(0.05)
    return result


def check(what, good):
    print(f"{what}: {'yes' if good else 'NO'}", flush=True)
    if not good:
        sys.exit(1)


def runs(c):
    return c.show("ActiveState") == "active" and c.pid()


def restarts(c):
    """The service comes back after its process was killed, and after it has stopped feeding the watchdog."""
    counted = int(c.show("NRestarts"))
    for number, after, most in ((signal.SIGKILL, "killed", 5.0), (signal.SIGSTOP, "hanging", 10.0)):
        before = c.pid()
        began = time.monotonic()
        os.kill(before, number)
        check(f"a new jinkd {after} within {most:g} s", wait_for(lambda: c.pid() not in (None, before) and runs(c), most))
        print(f"  after {time.monotonic() - began:.1f} s")
        check("which is heard", c.hears())
    check("result of the hang is the watchdog", wait_for(lambda: "Failed with result 'watchdog'" in c.journal(), 5))
    check("two restarts are counted", int(c.show("NRestarts")) == counted + 2)


def confined(c):
    """What the service's process may see and do."""
    pid = c.pid()
    status = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    user = c.run("id", "-u", "jink").stdout.strip()
    check("user jink", re.search(r"^Uid:\t.*", status, re.M)[0].split()[1:] == [user] * 4)
    check("no capability", all(re.search(rf"^Cap{kind}:\t0+$", status, re.M) for kind in ("Inh", "Prm", "Eff", "Bnd", "Amb")))
    check("no new privileges, system calls filtered", "\nNoNewPrivs:\t1\n" in status and "\nSeccomp:\t2\n" in status)

    def inside(*command, rights=()):
        return subprocess.run(["nsenter", "--target", str(pid), "--mount", *rights, *command], capture_output=True, text=True, check=False)

    own = (f"--setuid={user}", f"--setgid={user}")
    for place in ("/var/lib/jink", "/var/log/jink"):
        check(f"{place} can be written", inside("/bin/touch", f"{place}/tried", rights=own).returncode == 0)
        inside("/bin/rm", f"{place}/tried")
    # As root, so that only the service's view of files can refuse.
    for place in ("/etc", "/usr", "/var", "/home", "/root"):
        check(f"nothing can be made in {place}", "Read-only" in inside("/bin/touch", f"{place}/tried").stderr)
    check("/tmp is its own", inside("/bin/touch", "/tmp/tried").returncode == 0 and not (pathlib.Path(c.root) / "tmp/tried").exists()
          and c.run("test", "-e", "/tmp/tried").returncode != 0)
    allowed = re.search(r"^Max realtime priority +(\d+)", pathlib.Path(f"/proc/{pid}/limits").read_text(encoding="ascii"), re.M)[1]
    if int(allowed) < 50 or os.sched_getscheduler(pid) != os.SCHED_FIFO:
        print(f"real-time priority is not given here (limit {allowed}, or this kernel groups real-time processes): not tried")
    else:
        check("real-time priority 50", os.sched_getparam(pid).sched_priority == 50)


def upgraded(c, package):
    """PACKAGE over itself restarts a service that runs and starts none that is stopped; removal stops it."""
    barred = pathlib.Path(c.root) / "usr/sbin/policy-rc.d"  # would keep packages from starting anything
    policy = barred.read_bytes() if barred.exists() else None
    barred.unlink(missing_ok=True)
    c.run("sh", "-c", "cat >/run/jink.deb", data=package.read_bytes())

    def dpkg(what, *arguments):
        done = c.run("dpkg", *arguments)
        check(what, done.returncode == 0)

    before = c.pid()
    dpkg("upgrade of a service that runs", "-i", "/run/jink.deb")
    check("a new jinkd within 5 s", wait_for(lambda: c.pid() not in (None, before) and runs(c), 5))
    check("which is heard", c.hears())
    c.run("systemctl", "stop", "jinkd")
    dpkg("upgrade of a service that is stopped", "-i", "/run/jink.deb")
    check("it stays stopped", c.show("ActiveState") == "inactive")
    c.run("systemctl", "start", "jinkd")
    check("started again", runs(c))
    dpkg("removal", "-r", "jink")
    check("no jinkd runs", c.run("pidof", "jinkd").returncode != 0 and c.show("ActiveState") == "inactive")
    dpkg("new installation", "-i", "/run/jink.deb")
    check("neither started nor enabled", c.show("ActiveState") == "inactive" and c.show("UnitFileState") == "disabled")
    if policy is not None:
        barred.write_bytes(policy)
        barred.chmod(0o755)


def main():
    if len(sys.argv) != 3 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stdout if sys.argv[1:] in (["-h"], ["--help"]) else sys.stderr)
        return 0 if sys.argv[1:] in (["-h"], ["--help"]) else 2
    if not shutil.which("systemd-nspawn"):
        print("systemd-nspawn is not installed: skipped")
        return 77
    root, package = map(pathlib.Path, sys.argv[1:])
    defaults = root / "etc/default/jinkd"
    with Container(root) as c:
        check("not started by the installation", c.show("ActiveState") == "inactive")
        c.run("systemctl", "start", "jinkd")
        check("an empty line is refused, again and again", wait_for(lambda: c.show("NRestarts") not in ("0", "1"), 10) and c.show("ActiveState") != "active")
        check("with the reason", wait_for(lambda: "jinkd: --serial, --link or --can is needed" in c.journal(), 10))
        c.run("systemctl", "stop", "jinkd")
        text = defaults.read_text(encoding="utf-8")
        defaults.write_text(re.sub(r"^JINKD_LINE=.*$", f'JINKD_LINE="--link udp:{PORT}"', text, flags=re.M), encoding="utf-8")
        c.run("systemctl", "reset-failed", "jinkd")
        c.run("systemctl", "start", "jinkd")
        check("started", runs(c))
        check("it answers an autopilot's HEARTBEAT", c.hears())
        check("it keeps a flight log", any((root / "var/log/jink").glob("jink_*.ulg")))
        check("it only advises: JNK_MODE is 1", mode_in(c.answer()) == 1.0)
        restarts(c)
        confined(c)
        before = c.pid()
        check("reload, without a program of another package", c.run("systemctl", "reload", "jinkd").returncode == 0)
        check("which jinkd takes", wait_for(lambda: "jinkd: SIGHUP" in c.journal(), 5))
        check("and goes on", c.pid() == before and c.hears())
        began = time.monotonic()
        c.run("systemctl", "stop", "jinkd")
        check("stop ends well within 5 s", c.show("ActiveState") == "inactive" and c.show("Result") == "success" and time.monotonic() - began < 5.0)
        c.run("systemctl", "start", "jinkd")
        check("started for an upgrade", runs(c))
        upgraded(c, package)
        c.run("systemctl", "enable", "jinkd")
    with Container(root) as c:
        check("started at boot", wait_for(lambda: runs(c), 10))
        check("and heard", c.hears())
        c.run("systemctl", "disable", "jinkd")
    defaults.write_text(text, encoding="utf-8")
    print("passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
