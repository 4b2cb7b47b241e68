#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Malformed input files: every file format of jink, jinkd and jink-sim against everything that mutations.py can do.

    malformed_test.py --build FOLDER [--format NAME] [--list]

Each file has to be refused: the exit status of the format, at least one and at most 25 lines on stderr, the file's
name in them, the damaged line and a column where the format has lines, no output written. The good file is accepted,
and a byte-order mark and CR LF change nothing or are refused. What a format excuses has to be wrong still.
"""
import argparse
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import formats  # noqa: E402
import mutations  # noqa: E402

SECONDS = 60  # that any answer may take, on a busy machine too
MOST_LINES = 25


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(command, seconds=SECONDS):
    """(status, stdout, stderr); status None: it ran on and was stopped."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        out, err = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate()
        return None, out.decode(errors="replace"), err.decode(errors="replace")
    return process.returncode, out.decode(errors="replace"), err.decode(errors="replace")


def put(path, content):
    if callable(content):
        content(str(path))
    else:
        path.write_bytes(content)


def remove(path):
    if path.is_dir() and not path.is_symlink():
        path.rmdir()
    elif path.is_symlink() or path.exists():
        path.unlink()


def error_of(form, path, line, answer, out):
    """What is wrong with an answer to a damaged file, or None."""
    status, _, err = answer
    said = [text for text in err.splitlines() if text.strip()]
    if status is None:
        return f"accepted, or no answer within {SECONDS} s"
    if status < 0:
        return f"ended by signal {-status}"
    if status not in form.statuses:
        return f"exit status {status}: {err[:200]}"
    if not said:
        return "no message"
    if len(said) > MOST_LINES:
        return f"{len(said)} lines of messages"
    if not any(path.name in text for text in said):
        return f"the file's name is missing: {err[:200]}"
    if form.has_lines and line and not any(re.search(rf"{re.escape(path.name)}:{line}:[1-9]", text) for text in said):
        return f"line {line} and a column are missing: {err[:200]}"
    if max(len(text) for text in said) > 1000:
        return "a message of more than 1000 characters"
    if re.search(r"terminate called|Traceback|runtime error", err):
        return f"an error of the program: {err[:200]}"
    if out.exists() and any(p.is_file() for p in out.rglob("*")):
        return "a file was written"
    return None


def test(form, folder):
    """Errors and the number of malformed files."""
    errors, kinds = [], 0
    path, out = folder / f"input{form.suffix}", folder / "out"

    def answer(content, seconds=SECONDS):
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        put(path, content)
        try:
            return run([str(part) for part in form.command(path, out)], seconds)
        finally:
            remove(path)

    good = answer(form.good, form.patience) if form.checks_good else None
    if good and good[0] != (None if form.runs_on else form.good_status):
        errors.append(f"the good file: {good}")
    slow = 0.0
    for name, content, line in form.damages():
        kinds += 1
        excuse = form.excused.get(name)
        began = time.monotonic()
        wrong = error_of(form, path, line, answer(content, 1 if excuse else SECONDS), out)
        slow = max(slow, time.monotonic() - began)
        if excuse and not wrong:
            errors.append(f"{name}: excused, but refused as it should: remove the excuse")
        elif wrong and not excuse:
            errors.append(f"{name}: {wrong}")
    if good and form.has_lines:
        for name, content in (("CR LF", form.good.replace(b"\n", b"\r\n")), ("byte-order mark", b"\xef\xbb\xbf" + form.good)):
            kinds += 1
            other = answer(content, form.patience)
            if other[:1] != good[:1] and error_of(form, path, 0, other, out):
                errors.append(f"{name}: neither as without it nor refused: {other[0]} {other[2][:200]}")
    return errors, kinds, slow


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--format")
    parser.add_argument("--list", action="store_true", help="every damage, too")
    arguments = parser.parse_args()
    failed, slowest = 0, 0.0
    with tempfile.TemporaryDirectory() as work:
        for form in formats.all_formats(arguments.build.resolve(), pathlib.Path(work)):
            if arguments.format not in (None, form.name):
                continue
            if arguments.list:
                print(*(f"  {name}" for name, _, _ in form.damages()), sep="\n")
            folder = pathlib.Path(work, form.name.replace(" ", "_"))
            folder.mkdir()
            began = processor_time()
            errors, kinds, slow = test(form, folder)
            excused = "".join(f"; {name}: {why}" for name, why in form.excused.items())
            print(f"{form.name}: {kinds} malformed files, {len(errors)} not refused as they should, {len(form.excused)} excused{excused};"
                  f" {processor_time() - began:.1f} s", flush=True)
            slowest = max(slowest, slow)
            print(*(f"  {error}" for error in errors), sep="\n", end="\n" if errors else "")
            failed += len(errors)
            if kinds < 20:
                print(f"  only {kinds} kinds")
                failed += 1
    print(f"the slowest answer {slowest:.1f} s; {processor_time():.1f} s of processor time")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
