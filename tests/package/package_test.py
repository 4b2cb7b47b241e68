#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of what the Debian packages are made of.

    package_test.py unit|service|upgrade|examples|completion|man_pages|sbom|changelog --build FOLDER --version VERSION
"""
import argparse
import json
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
PACKAGING = TOP / "toolchain/packaging"
UNIT = PACKAGING / "debian/jink.jinkd.service"
DEFAULTS = PACKAGING / "debian/jink.jinkd.default"
PARAMS = PACKAGING / "debian/jinkd.param"  # /etc/jink/jinkd.param
PROGRAMS = {"jinkd": "firmware/linux/jinkd", "jink": "toolchain/host/jink", "jink-sim": "toolchain/sim/jink-sim"}
SKIPPED = 77
# Greatest exposure by `systemd-analyze security`; docs/guides/packages.md states the figure.
MOST_EXPOSURE = 1.9


def skip(reason):
    print("skipped: " + reason)
    sys.exit(SKIPPED)


def run(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)


def verified(text, jinkd):
    """What systemd-analyze verify says of a unit's text, with the program of the build."""
    with tempfile.TemporaryDirectory() as folder:
        unit = pathlib.Path(folder, "jinkd.service")
        unit.write_text(text.replace("/usr/bin/jinkd", str(jinkd)), encoding="utf-8")
        done = run("systemd-analyze", "verify", "--man=no", unit)
        return done.stdout + done.stderr


def test_unit(build, _):
    if not shutil.which("systemd-analyze"):
        skip("systemd-analyze is missing (package systemd)")
    text = UNIT.read_text(encoding="utf-8")
    jinkd = build / PROGRAMS["jinkd"]
    said = verified(text, jinkd)
    assert said == "", said
    assert verified(text.replace("WatchdogSec=2", "WatchdogSec=soon"), jinkd), "a wrong value is not found"
    # Names are looked up when the service starts; the majors of ttyACM and ttyUSB count before their drivers are loaded.
    devices = re.findall(r"^DeviceAllow=(.*)$", text, re.M)
    assert set(devices) >= {"char-tty* rw", "char-166 rw", "char-188 rw"}, devices
    assert re.search(r"^LogsDirectory=jink$", text, re.M), "no folder for flight logs"
    said = run("systemd-analyze", "security", "--offline=true", UNIT).stdout
    exposure = re.search(r"Overall exposure level for \S+: ([\d.]+)", said)
    assert exposure, said
    print(exposure[0])
    assert float(exposure[1]) <= MOST_EXPOSURE, f"more than {MOST_EXPOSURE}"
    page = (TOP / "docs/guides/packages.md").read_text(encoding="utf-8")
    assert f"exposure of {exposure[1]} " in page, f"docs/guides/packages.md does not state {exposure[1]}"


def test_service(build, _):
    unit, defaults = UNIT.read_text(encoding="utf-8"), DEFAULTS.read_text(encoding="utf-8")
    priority = int(re.search(r"--realtime (\d+)", defaults)[1])
    assert priority <= int(re.search(r"^LimitRTPRIO=(\d+)", unit, re.M)[1]), "--realtime of the defaults is beyond LimitRTPRIO"
    assert re.search(r'^JINKD_OPTIONS=".*--params /etc/jink/jinkd\.param ', defaults, re.M), "the defaults do not name the parameter file"
    assert re.search(r'^JINKD_OPTIONS=".* --log /var/log/jink"$', defaults, re.M), "the service keeps no flight log"
    filtered = ["/usr/bin/python3", "-B", TOP / "tests/package/system_call_filter.py", UNIT]
    if shutil.which("systemd-analyze"):
        assert run(*filtered, "chrt", "--fifo", "1", "true").returncode == run("chrt", "--fifo", "1", "true").returncode
        mapped = "import mmap; mmap.mmap(-1, 4096, prot={})"
        assert run(*filtered, sys.executable, "-c", mapped.format(3)).returncode == 0, "memory that is written"
        assert run(*filtered, sys.executable, "-c", mapped.format(7)).returncode != 0, "memory that is written and executed"
    with tempfile.TemporaryDirectory() as state:
        pathlib.Path(state).chmod(0o777)
        done = run(sys.executable, "-B", TOP / "tests/package/service_line.py", "--unit", UNIT, "--defaults", DEFAULTS,
                   "--params", PARAMS, "--program", build / PROGRAMS["jinkd"], "--state", state)
    print(done.stdout + done.stderr)
    assert done.returncode == 0, "the line of the unit does not start jinkd"


def maintainer_scripts(folder):
    """What debhelper puts into the package's maintainer scripts for the unit, by script."""
    shutil.copytree(PACKAGING / "debian", folder / "debian")
    (folder / "debian/changelog").write_text("jink (0) bookworm; urgency=medium\n\n  * .\n\n"
                                             " -- J <j@jink.invalid>  Thu, 01 Jan 2026 00:00:00 +0000\n", encoding="ascii")
    line = re.search(r"^\t(dh_installsystemd .*)$", (PACKAGING / "debian/rules").read_text(encoding="utf-8"), re.M)[1]
    done = run(*line.split(), "--package=jink", cwd=folder)
    assert done.returncode == 0, done.stderr
    scripts = {}
    for name in ("preinst", "postinst", "prerm", "postrm"):
        parts = [folder / f"debian/.debhelper/generated/jink/{name}.service", folder / f"debian/jink.{name}.debhelper"]
        scripts[name] = "set -e\n" + "".join(part.read_text(encoding="utf-8") for part in parts if part.exists())
    return scripts


def test_upgrade(_, __):
    """An upgrade restarts the service, removal stops it, a first installation does not enable it."""
    if not shutil.which("dh_installsystemd"):
        skip("debhelper is missing (toolchain/setup/install --for package)")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scripts = maintainer_scripts(folder)
        for program in ("deb-systemd-invoke", "deb-systemd-helper", "systemctl"):
            file = folder / program
            # `was-enabled` and `debian-installed` fail: the unit was never enabled.
            file.write_text(f'#!/bin/sh\necho "{program} $*" >>{folder}/called\n[ {program} != deb-systemd-helper ]\n', encoding="ascii")
            file.chmod(0o755)
        (folder / "booted").mkdir()

        def calls(*steps):
            """What the scripts call in these steps, on a machine that systemd has booted."""
            (folder / "called").write_text("", encoding="ascii")
            for script, *arguments in steps:
                done = run("sh", "-c", scripts[script].replace("/run/systemd/system", f"{folder}/booted"), script, *arguments,
                           env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})
                assert done.returncode == 0, done.stderr
            called = (folder / "called").read_text(encoding="ascii")
            print(steps, called, sep="\n")
            assert "deb-systemd-helper enable" not in called, "enabled"
            return re.findall(r"^deb-systemd-invoke (\S+) jinkd\.service$", called, re.M)

        # deb-systemd-invoke starts no unit that is disabled; chroot_test tries that.
        assert calls(("preinst", "install"), ("postinst", "configure", "")) in ([], ["start"])
        # prerm is the old version's, the others are the new one's.
        assert calls(("prerm", "upgrade", "2"), ("preinst", "upgrade", "1", "2"), ("postrm", "upgrade", "2"),
                     ("postinst", "configure", "1")) == ["restart"], "an upgrade leaves the old program running, or none"
        assert calls(("prerm", "remove"), ("postrm", "remove")) == ["stop"], "removal leaves the program running"


def test_examples(build, _):
    """Airspace files of the package close areas in a running jinkd."""
    listed = (PACKAGING / "debian/jink.examples").read_text(encoding="utf-8").split()
    airspaces = [TOP / name for name in listed if name.startswith("firmware/airspace/")]
    assert {file.name for file in airspaces} == {"example.yaml", "virtual.yaml"}, airspaces
    for file in airspaces:
        port, terminal = pty.openpty()
        with tempfile.TemporaryDirectory() as folder:
            summary = pathlib.Path(folder, "summary.json")
            jinkd = subprocess.Popen([build / PROGRAMS["jinkd"], "--serial", os.ttyname(terminal), "--airspace", file, "--summary", summary],
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            select.select([port], [], [], 20)  # its first HEARTBEAT
            jinkd.send_signal(signal.SIGTERM)
            said = jinkd.communicate(timeout=30)[0]
            assert jinkd.returncode == 0, f"{file.name}: {said}"
            counted = json.loads(summary.read_text(encoding="utf-8"))
        assert counted["areas_reported"] > 0 and counted["areas_refused"] == 0, f"{file.name}: {counted}"


def helps(program, path=()):
    """Each command and its long options, found without the parser under test."""
    text = run(program, *path, "--help").stdout
    entries = re.findall(r"^ {2}(-\S+)", text, re.M)
    yield path, {word for entry in entries for word in re.findall(r"--[a-z][a-z-]*", entry)}
    for name in re.findall(r"^ {2}([a-z]\S*)", text.partition("\nSubcommands:")[2], re.M):
        yield from helps(program, (*path, name))


def completed(script, words):
    """What bash offers for the last of the words."""
    code = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
            'set -- $(complete -p "$1"); "$3"; printf "%s\\n" "${COMPREPLY[@]}"')
    done = run("bash", "-c", code, "bash", script, *words)
    assert done.stderr == "", done.stderr
    return set(done.stdout.split())


def test_completion(build, _):
    with tempfile.TemporaryDirectory() as folder:
        done = run(PACKAGING / "command_pages", "--no-man", "--out", folder, *(build / p for p in PROGRAMS.values()))
        assert done.returncode == 0, done.stderr
        number = 0
        for name, place in PROGRAMS.items():
            script = pathlib.Path(folder, "completions", name)
            commands = dict(helps(build / place))
            for path, options in commands.items():
                offered = completed(script, [name, *path, "--"])
                assert offered == options, f"{name} {' '.join(path)}: {offered ^ options}"
                number += len(options)
            below = {path[0] for path in commands if path}
            assert completed(script, [name, ""]) >= below, name
        assert number > 100, number
        jink, jinkd = pathlib.Path(folder, "completions/jink"), pathlib.Path(folder, "completions/jinkd")
        assert completed(jink, ["jink", "mesh", "build", "--method", ""]) == {"hull", "decompose", "soup"}
        assert completed(jinkd, ["jinkd", "--node-id", ""]) == set()
        assert completed(jinkd, ["jinkd", "--serial", "/dev/nul"]) == {"/dev/null"}
        print(f"{number} options")


def test_man_pages(build, _):
    if not shutil.which("help2man"):
        skip("help2man is missing (toolchain/setup/install --for package)")
    with tempfile.TemporaryDirectory() as folder:
        done = run(PACKAGING / "command_pages", "--out", folder, *(build / p for p in PROGRAMS.values()))
        assert done.returncode == 0, done.stderr
        for name, place in PROGRAMS.items():
            page = pathlib.Path(folder, "man", f"{name}.{8 if name == 'jinkd' else 1}").read_text(encoding="utf-8")
            plain = page.replace("\\", "")
            for path, options in helps(build / place):
                for option in options:
                    assert option in plain, f"{name} {' '.join(path)} {option}"
                assert not path or path[-1] in plain, path
            assert str(build) not in page, "a path of the build folder"


def owners(files):
    """Packages of Debian that have files."""
    spellings = {spelling: str(file) for file in files for spelling in (str(file), f"/usr{file}", str(pathlib.Path(file).resolve()))}
    said = run("dpkg", "-S", *spellings).stdout  # status 1: not every spelling is known
    return {spellings[path]: name.split(":")[0] for name, path in re.findall(r"^(\S+): (/.*)$", said, re.M)}


def included_libraries():
    """Headers of libraries that jink's sources name, found in /usr/include."""
    names = set()
    for place in ("core", "hal/linux", "firmware/app", "firmware/link", "firmware/linux", "toolchain/host", "toolchain/sim",
                  "toolchain/mesh", "toolchain/reach"):
        for source in (TOP / place).rglob("*.[ch]pp"):
            names |= set(re.findall(r"#\s*include <([^>]+)>", source.read_text(encoding="utf-8")))
    for name in sorted(names):
        for folder in ("/usr/include", "/usr/include/eigen3"):
            if pathlib.Path(folder, name).exists():
                yield pathlib.Path(folder, name)


def test_sbom(build, version):
    if not shutil.which("dpkg-query") or not shutil.which("ninja"):
        skip("dpkg or ninja is missing")
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "sbom.json")
        done = run(sys.executable, "-B", PACKAGING / "sbom.py", "--build", build, "--version", version, "--out", file)
        assert done.returncode == 0, done.stderr
        sbom = json.loads(file.read_text(encoding="utf-8"))
    assert sbom["spdxVersion"] == "SPDX-2.3"
    packages = {p["SPDXID"]: p for p in sbom["packages"]}
    for relation in sbom["relationships"]:
        assert relation["relatedSpdxElement"] in packages, relation
    listed = {name: {packages[r["relatedSpdxElement"]]["name"] for r in sbom["relationships"]
                     if r["spdxElementId"] == f"SPDXRef-{name}"} for name in (*PROGRAMS, "libjink-dev")}
    # The first place of each name is that of the machine's own architecture.
    cache = dict(reversed(re.findall(r"^\s*(\S+) \(.*\) => (\S+)$", run("/sbin/ldconfig", "-p").stdout, re.M)))
    for name, place in PROGRAMS.items():
        needed = re.findall(r"\(NEEDED\).*\[(.+)\]", run("readelf", "-d", build / place).stdout)
        assert len(needed) >= 5, needed
        found = owners(cache[library] for library in needed)
        for library in needed:
            assert found[cache[library]] in listed[name], f"{name}: {library} is not listed"
    assert "three" in listed["jink"] and "esbuild" not in listed["jink"], "what is bundled into the page of jink report"
    everything = set().union(*listed.values())
    headers = [str(header) for header in included_libraries()]
    found = owners(headers)
    for header in headers:
        assert found[header] in everything, f"{header} is not listed"
    for package in packages.values():
        assert package["versionInfo"] and package["licenseDeclared"] != "NOASSERTION", package
    assert "libeigen3-dev" in listed["libjink-dev"] and "libassimp5" not in listed["jinkd"], listed
    print(f"{len(everything)} packages")


def test_changelog(_, version):
    text = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## \[{re.escape(version)}\] - (unreleased|\d{{4}}-\d\d-\d\d)$", text, re.M), f"no entry of {version}"


def main():
    tests = {name.removeprefix("test_"): test for name, test in globals().items() if name.startswith("test_")}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("test", choices=tests)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--version", required=True)
    arguments = parser.parse_args()
    tests[arguments.test](arguments.build.resolve(), arguments.version)


if __name__ == "__main__":
    main()
