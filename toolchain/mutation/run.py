# SPDX-License-Identifier: BSD-3-Clause
"""Builds the mutated tests, determines the tests that can detect each mutant, and runs those against the mutant."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import threading

nice = ["nice", "-n", "19"]  # --nice
# What firmware/ and its tests are compiled with besides; the numbers mean nothing here.
VERSION = ['JINK_VERSION="0.0.0"', 'JINK_TEST_VERSION="0.0.0"', *(f"JINK_VERSION_{part}=0" for part in ("MAJOR", "MINOR", "PATCH"))]
BYTES = 4 << 30  # of address space: a mutant that grows without bound counts as a crash


class Failed(Exception):
    pass


def build(repository, root, folder, mutants, needed, programs, jobs):
    """Configures and builds `folder`/tests from `folder`/source; returns the folder of the programs.

    needed: folders of sources; programs: {name: folder of its tests}
    """
    out = folder / "tests"
    configure = ["cmake", "-G", "Ninja", "-S", repository / "toolchain/mutation", "-B", out, f"-DJINK_REPOSITORY={repository}",
                 f"-DJINK_ROOT={root}", f"-DJINK_SOURCES={folder / 'source'}", f"-DJINK_MUTANTS={mutants}",
                 f"-DJINK_FOLDERS={';'.join(needed)}",
                 f"-DJINK_PROGRAMS={';'.join(programs)}", f"-DJINK_TESTS={';'.join(map(str, programs.values()))}",
                 "-DCMAKE_BUILD_TYPE=Release", f"-DJINK_DEFINITIONS={';'.join(VERSION)}"]
    for command in (configure, ["cmake", "--build", out, "--parallel", str(jobs)]):
        done = subprocess.run([*nice, *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise Failed(f"the mutated sources do not build:\n{done.stdout[-6000:]}")
    return out


class Test:
    def __init__(self, program, rank, name):
        self.program, self.rank, self.name = program, rank, name
        self.seconds, self.differs = 0.0, b""
        self.kills, self.tries = 0, 0

    def full_name(self):
        return f"{self.program.name}.{self.name}"

    def run(self, seconds, **environment):
        """(how it ended, processor seconds): passed, failed, crashed or hung."""
        command = ["prlimit", f"--cpu={int(seconds)}", f"--as={BYTES}", "--core=0", *nice, str(self.program),
                   f"--gtest_filter={self.name}", "--gtest_break_on_failure"]
        variables = {k: v for k, v in os.environ.items() if not k.startswith(("GTEST_", "JINK_"))}
        child = subprocess.Popen(command, env={**variables, **environment}, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode in (-24, -9):  # SIGXCPU, SIGKILL; -5: SIGTRAP, at the first failed assertion
            how = "hung"
        else:
            how = {0: "passed", 1: "failed", -5: "failed"}.get(child.returncode, "crashed")
        return how, used.ru_utime + used.ru_stime


def tests_of(program, rank):
    listing = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    suite, tests = "", []
    for line in listing.splitlines():
        name = line.split("#")[0].rstrip()
        if name and not name.startswith(" "):
            suite = name
        elif name.strip() and not re.search(r"(^|[./])DISABLED_", suite + name.strip()):
            tests.append(Test(program, rank, suite + name.strip()))
    return tests


def record(tests, folder, jobs):
    """Every test without a mutant: it has to pass; what it could tell apart, and how long it takes."""
    folder.mkdir(exist_ok=True)

    def one(test):
        path = folder / hashlib.sha256(test.full_name().encode()).hexdigest()[:16]
        how, test.seconds = test.run(3600, JINK_MUTATION_RECORD=str(path))
        if how == "passed":
            test.differs = path.read_bytes()
            path.unlink()
        return how

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        ended = list(pool.map(one, tests))
    bad = [f"  {test.full_name()}: {how}" for test, how in zip(tests, ended) if how != "passed"]
    if bad:
        raise Failed("\n".join(["tests fail without a mutant:", *bad]))


def digest(paths):
    whole = hashlib.sha256()
    for path in sorted(paths):
        whole.update(str(path).encode() + b"\0" + path.read_bytes())
    return whole.hexdigest()


class Results:
    """What became of each mutant, a line of JSON each, so that a run can be broken off and taken up again."""

    def __init__(self, path, sources, tests, keep_killed, fresh):
        self.path, self.lock, self.by_key = path, threading.Lock(), {}
        head = {"sources": sources, "tests": tests}
        if path.exists() and not fresh:
            lines = [json.loads(line) for line in path.read_text().splitlines() if line.endswith("}")]
            old = lines[0] if lines else {}
            if old == head:
                self.by_key = {line["key"]: line for line in lines[1:]}
            elif keep_killed and old.get("sources") == sources:
                self.by_key = {line["key"]: line for line in lines[1:] if line["how"] != "survived"}
        lines = [head, *self.by_key.values()]
        self.path.write_text("".join(json.dumps(line) + "\n" for line in lines))

    def add(self, key, how, by):
        with self.lock:
            self.by_key[key] = {"key": key, "how": how, "by": by}
            with self.path.open("a") as file:
                file.write(json.dumps(self.by_key[key]) + "\n")


def order(tests, room):
    """The room's own tests first, then those that have killed most per second."""
    def place(test):
        own = test.program.name.split("_", 1)[1] == room
        return (not own, test.rank if not own else 0, -(test.kills + 1) / (test.tries + 2) / (test.seconds + 0.02), test.name)
    return sorted(tests, key=place)


def judge(mutant, tests, results):
    """Runs the tests that could tell the mutant apart until one does."""
    room = pathlib.PurePosixPath(mutant.site.file).parts[1]
    left = [test for test in tests if test.differs[mutant.number]]
    while left:
        test = order(left, room)[0]
        left.remove(test)
        test.tries += 1
        how, _ = test.run(2 + 10 * test.seconds, JINK_MUTANT=str(mutant.number))
        if how != "passed":
            test.kills += 1
            results.add(mutant.key, how, test.full_name())
            return
    results.add(mutant.key, "survived", "")


def judge_all(mutants, tests, results, jobs, say):
    todo = [m for m in mutants if m.key not in results.by_key]
    done = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for _ in concurrent.futures.as_completed([pool.submit(judge, m, tests, results) for m in todo]):
            done += 1
            if done % 50 == 0 or done == len(todo):
                say(f"{done} of {len(todo)} mutants run")
