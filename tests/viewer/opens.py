#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens a page of `jink report` in a headless Chromium and steps through it: no error on the console, and the time moves.

    opens.py PAGE

Exit status 77: no Chromium.
"""
import pathlib
import sys

import browser


def main(page):
    if browser.find_chromium() is None:
        print("no chromium: the page was not opened")
        return 77
    chromium = browser.Browser()
    try:
        chromium.open(pathlib.Path(page).resolve())
        before = chromium.run("document.querySelector('input[type=range]').value")
        for _ in range(5):
            chromium.press("ArrowRight", shift=True)
        after = chromium.run("document.querySelector('input[type=range]').value")
        if before == after:
            print(f"the cursor stays at {before}")
            return 1
        if chromium.errors:
            print(*chromium.errors, sep="\n")
            return 1
    finally:
        chromium.close()
    print("the page opens without an error, and its cursor moves")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
