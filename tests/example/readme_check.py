# SPDX-License-Identifier: BSD-3-Clause
"""Pages show examples as they are compiled: every line of the source behind its licence line, in order."""
import pathlib
import sys

SHOWN = {"README.md": "docs/example/main.cpp", "docs/guides/writing_a_method.md": "docs/example/vertical_escape.hpp"}
root = pathlib.Path(sys.argv[1])
for page, source in SHOWN.items():
    example = (root / source).read_text().split("\n", 1)[1].strip()
    if example not in (root / page).read_text():
        sys.exit(f"{page} does not show {source} as it stands")
    print(f"{page} shows {source} ({len(example.splitlines())} lines)")
