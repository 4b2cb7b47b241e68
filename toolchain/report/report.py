#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes one self-contained HTML page of a demo run: `jink report` calls it.

    report.py --run run.json --out report.html

Wants Debian's python3-matplotlib. Exit status 2, and a line that says why, when the run cannot be read or the page not
be written.
"""
import argparse
import multiprocessing
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import run  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description="Makes one self-contained HTML page of a demo run.")
    parser.add_argument("--run", required=True, help="run.json of jink-sim")
    parser.add_argument("--out", required=True, help="the page to write")
    arguments = parser.parse_args()
    try:
        flights = run.read(arguments.run)
        import page  # matplotlib takes its time: a run that cannot be read is refused without it

        with multiprocessing.get_context("fork").Pool(os.cpu_count() or 1) as pool:
            html = page.build(flights, pool.map)
        pathlib.Path(arguments.out).write_text(html, encoding="utf-8")
    except run.BadRun as error:
        print(f"jink report: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"jink report: {arguments.out}: {error.strerror}", file=sys.stderr)
        return 2
    print(f"Written: {arguments.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
