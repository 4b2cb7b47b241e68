#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns from the user's view: the programs, interrupted, distributed, refused and replayed.

    campaign_check.py --sim jink-sim --jink jink [--mpi jink-sim-mpi] CASE

Exit status 77 where a case needs Open MPI and there is none. Python 3 standard library only.
"""
import argparse
import fcntl
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
# 0.1 s to a flight: enough for a run to be broken off in its middle.
SMALL = ["--from", "2040", "--count", "30", "--block", "3"]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe"]


class Failure(Exception):
    """An unmet expectation."""


def check(good, what):
    if not good:
        raise Failure(what)


def run(command, status=0):
    """Runs a command and expects its exit status. Returns its output."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    check(done.returncode == status,
          f"{' '.join(str(part) for part in command)}: exit status {done.returncode}, not {status}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def contents(folder):
    """Every file of a folder by name."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


def same(one, other, what):
    a, b = contents(one), contents(other)
    check(a.keys() == b.keys(), f"{what}: files differ: {sorted(a.keys() ^ b.keys())}")
    for name, text in a.items():
        check(text == b[name], f"{what}: {name} differs")
    check(sum(name.startswith("block_") for name in a) == 10, f"{what}: not 10 blocks")
    check("summary.txt" in a and sum(name.startswith("worst/") for name in a) == 10, f"{what}: no summary, or not ten worst")


def blocks(folder):
    return sorted(folder.glob("block_*.txt"))


def kill_in_the_middle(command, folder, victim):
    """Starts a command, and kills the process named by `victim` as soon as a block is finished."""
    with subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        until = time.monotonic() + 300
        while not blocks(folder) and process.poll() is None and time.monotonic() < until:
            time.sleep(0.002)
        check(process.poll() is None, "the run was over before it could be killed")
        os.kill(victim(process), signal.SIGKILL)
        process.wait()
    finished = len(blocks(folder))
    check(0 < finished < 10, f"killed with {finished} of 10 blocks finished: this says nothing")
    print(f"killed with {finished} of 10 blocks finished")


def restart(programs, top):
    whole, broken = top / "whole", top / "broken"
    run([programs.sim, "encounters", *SMALL, "--out", whole, "--threads", 2])
    command = [programs.sim, "encounters", *SMALL, "--out", broken, "--threads", 1]
    kill_in_the_middle(command, broken, lambda process: process.pid)
    first = blocks(broken)[0]
    first.write_bytes(first.read_bytes()[:-7])  # as if the disk had been full
    run(command)
    same(whole, broken, "after kill -9 and a block cut off")
    stamps = [block.stat().st_mtime_ns for block in blocks(broken)]
    run(command)
    check(stamps == [block.stat().st_mtime_ns for block in blocks(broken)], "finished blocks were flown again")
    # A summary alone, from the blocks.
    (broken / "summary.txt").unlink()
    shutil.rmtree(broken / "worst")
    run([programs.sim, "encounters", "--summary", broken])
    same(whole, broken, "summarised anew")


def refusals(programs, top):
    small = ["--from", "1", "--count", "2", "--block", "1"]
    folder = top / "campaign"
    run([programs.sim, "encounters", *small, "--out", folder])
    before = contents(folder)

    def refused(arguments, said):
        text = run([programs.sim, "encounters", *arguments], status=2)
        check(said in text, f"{arguments}: '{said}' is not said:\n{text}")

    refused([*small, "--out", folder, "--planner", "source"], "'planner product' there, 'planner source' asked for")
    refused([*small, "--out", folder, "--set", "GEO_K_T=0.3"], "'set' there, 'set GEO_K_T=0.3' asked for")
    refused([*small, "--out", top / "new", "--set", "GEO_K_T"], "'GEO_K_T' is not NAME=VALUE")
    refused([*small, "--out", top / "new", "--set", "GEO_K_Q=1"], "GEO_K_Q is no parameter")
    refused([*small, "--out", top / "new", "--set", "GEO_K_S=0.95"], "GEO_K_S = 0.95 is refused")
    refused(["--from", "2", "--count", "2", "--block", "1", "--out", folder], "'seeds from 1' there, 'seeds from 2'")
    refused(["--from", "1", "--count", "3", "--block", "1", "--out", folder], "'count 2' there, 'count 3'")
    refused(["--from", "1", "--count", "2", "--block", "2", "--out", folder], "'block 1' there, 'block 2'")
    other_program = (folder / "manifest.txt").read_text().replace("sources ", "sources 0")
    strange = top / "strange"
    shutil.copytree(folder, strange)
    (strange / "manifest.txt").write_text(other_program)
    refused([*small, "--out", strange], "another set-up: 'sources 0")
    foreign = top / "foreign"
    foreign.mkdir()
    (foreign / "letter.txt").write_text("dear")
    refused([*small, "--out", foreign], "is not empty and has no manifest.txt")
    refused([*small, "--out", foreign / "letter.txt"], "is no folder")
    refused(["--summary", foreign], "has no manifest.txt")
    refused([*small], "--out FOLDER or --summary FOLDER is needed")
    refused(["--out", top / "new", "--count", "0"], "--count")
    refused(["--out", top / "new", "--planner", "mine"], "--planner")
    seeds = top / "seeds.txt"
    for text, said in (("1\nx\n", ":2:1: no seed: a whole number"), ("5 6\n", ":1:3: one seed to a line"), ("7\n8\n7\n", ":3:1: this seed comes twice"),
                       ("# none\n", "lists no seeds"), (" -1\n", ":1:2: no seed: a whole number")):
        seeds.write_text(text)
        refused(["--seed-file", seeds, "--out", top / "new"], said)
    check(not (top / "new").exists(), "a folder was made for what was refused")
    holder = os.open(folder, os.O_RDONLY)
    fcntl.flock(holder, fcntl.LOCK_EX)
    refused([*small, "--out", folder], "is being used by another run")
    os.close(holder)
    check(contents(folder) == before, "a refusal changed the folder")
    blocks(folder)[0].unlink()
    refused(["--summary", folder], "1 of 2 blocks are missing")
    # And a list of seeds that is in order flies those.
    seeds.write_text("1 # the first\n\n2\n")
    run([programs.sim, "encounters", "--seed-file", seeds, "--block", "1", "--out", top / "listed"])
    for name in ("block_000000.txt", "block_000001.txt"):
        check(contents(top / "listed")[name] == before[name], f"listed seeds give another {name}")


def replay(programs, top):
    """The ten worst end again as they did: outcome, separation, time, to what run.json prints."""
    for planner in ("product", "source"):
        folder = top / planner
        # Any ending is accepted: this tests replays.
        subprocess.run([programs.sim, "encounters", *SMALL, "--planner", planner, "--out", folder], check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        files = sorted((folder / "worst").glob("*.yaml"))
        check(len(files) == 10, f"{planner}: {len(files)} files")
        print(run([programs.sim, "fly", *files, "--out", top / "flown"]))
        flights = json.loads((top / "flown" / "run.json").read_text())["flights"]
        for file, flight in zip(files, flights):
            names, values = [line[2:].split() for line in file.read_text().splitlines()[:2]]
            kept = dict(zip(names, values))
            check(f"encounter_{kept['seed']}" == flight["name"] == file.stem, f"{file}: names differ")
            check(kept["outcome"] == flight["outcome"], f"{file}: {flight['outcome']}, not {kept['outcome']}")
            for value, key in ((flight["least"]["surface"], "separation"), (flight["least"]["t"], "at"),
                               (flight["least"]["alone"], "alone"), (flight["duration"], "duration")):
                check(abs(value - float(kept[key])) <= 0.000501, f"{file}: {key} is {value}, not {kept[key]}")
            check(flight["takeovers"] == int(kept["takeovers"]), f"{file}: takeovers differ")
    # Scenarios for in-process flights only are refused elsewhere.
    if programs.jinkd:
        text = run([programs.sim, "fly", files[0], "--daemon", programs.jinkd], status=2)
        check("flown in process only" in text, text)


def mpi_identity(programs, top):
    one = top / "one"
    run([programs.sim, "encounters", *SMALL, "--out", one, "--threads", 2])
    for processes in (1, 2, 3):
        folder = top / f"mpi_{processes}"
        text = run([*MPIRUN, "-n", processes, programs.mpi, "encounters", *SMALL, "--out", folder])
        same(one, folder, f"{processes} processes")
        check("encounters in" in text, text)
    # Each may go on where the other was.
    for block in blocks(top / "mpi_3")[::2]:
        block.unlink()
    run([programs.sim, "encounters", *SMALL, "--out", top / "mpi_3"])
    same(one, top / "mpi_3", "begun by three, ended by one")
    text = run([*MPIRUN, "-n", 2, programs.mpi, "encounters", *SMALL, "--planner", "source", "--out", one], status=2)
    check(text.count("belongs to another set-up") == 1, f"not refused once:\n{text}")


def children_of(pid):
    """Processes below a process, by /proc."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found.append(int(stat.parent.name))
    return found


def mpi_killed_rank(programs, top):
    one, broken = top / "one", top / "broken"
    run([programs.sim, "encounters", *SMALL, "--out", one, "--threads", 2])
    command = [*MPIRUN, "-n", 3, programs.mpi, "encounters", *SMALL, "--out", broken]

    def last_rank(process):
        ranks = [pid for pid in children_of(process.pid)
                 if os.readlink(f"/proc/{pid}/exe") == str(pathlib.Path(programs.mpi).resolve())]
        check(len(ranks) == 3, f"{len(ranks)} ranks under mpirun, not 3")
        return max(ranks)

    kill_in_the_middle(command, broken, last_rank)
    run(command)
    same(one, broken, "after the death of a rank")


def mpi_study(programs, top):
    """The distribution study: rows and figures of three processes are those of one."""
    def digest(csv):
        return hashlib.sha256(csv.read_bytes()).hexdigest()

    def study(command, csv):
        done = subprocess.run([*command, "campaign", "--json", "--csv", csv], capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"{command}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
        figures = json.loads(done.stdout)
        del figures["seconds"]
        check(figures["candidates"] > 1_000_000, "hardly a study")
        return figures

    one = study([programs.jink], top / "one.csv")
    for processes in (1, 3):
        figures = study([*MPIRUN, "-n", str(processes), programs.mpi], top / "mpi.csv")
        check(figures == one, f"{processes} processes: {figures} instead of {one}")
        check(digest(top / "mpi.csv") == digest(top / "one.csv"), f"{processes} processes: rows differ")


def thousand(programs, top):
    """The short form of the campaign: no promise is broken that could have been kept."""
    text = run([programs.sim, "encounters", "--from", 1, "--count", 1000, "--block", 50, "--threads", 2, "--out", top / "thousand"])
    print(text)
    broken = text.split("Promises and rules broken", 1)[1].split("The ten worst", 1)[0]
    seeds = {int(line.split()[0]) for line in broken.splitlines() if line.endswith("avoidable")}
    check(not seeds, f"avoidable: {sorted(seeds)}")
    check("0 broken rules" in text, "a rule was broken")


def board(programs, top):
    """With the work and the reach sets of the slowest board, plans going on over several steps: avoided as without; another clock
    is another set-up, and so are other sets."""
    slow = [programs.sim, "encounters", "--from", 1, "--count", 100, "--block", 50, "--out", top / "board", "--reduced-sets", "--clock"]
    text = run([*slow, 168])
    print(text)
    check("work of a step for 168 MHz, reduced reach sets" in text, "the summary does not say the board")
    avoided = int(re.search(r"^ +avoided +(\d+) of", text, re.M)[1])
    check(avoided >= 97, f"{avoided} of 100 avoided")
    check("0 broken rules" in text, "a rule was broken")
    run([*slow, 216], status=2)
    run([word for word in slow if word != "--reduced-sets"] + [168], status=2)
    run([programs.sim, "encounters", "--from", 1, "--count", 1, "--out", top / "stopped", "--clock", 20], status=2)


CASES = {case.__name__: case for case in (board, restart, refusals, replay, mpi_identity, mpi_killed_rank, mpi_study, thousand)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sim", required=True, help="the program jink-sim")
    parser.add_argument("--jink", required=True, help="the program jink")
    parser.add_argument("--mpi", default="", help="the program jink-sim-mpi")
    parser.add_argument("--jinkd", default="", help="the program jinkd")
    parser.add_argument("case", choices=sorted(CASES))
    programs = parser.parse_args()
    if programs.case.startswith("mpi_") and not (programs.mpi and shutil.which("mpirun")):
        print("SKIPPED: there is no Open MPI (libopenmpi-dev when it was built, openmpi-bin now): nothing was shared out, "
              "killed or compared. toolchain/setup/install --for test brings it.")
        return SKIPPED
    # Processes on one machine need no network, and no leave to read each other's memory.
    os.environ.update({"OMPI_MCA_btl": "self,vader", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
                       "OMPI_MCA_rmaps_base_oversubscribe": "1"})
    with tempfile.TemporaryDirectory(prefix="jink-campaign-") as top:
        try:
            CASES[programs.case](programs, pathlib.Path(top))
        except Failure as failure:
            print(f"FAILED: {failure}")
            return 1
    print(f"{programs.case}: as it should be")
    return 0


if __name__ == "__main__":
    sys.exit(main())
