# SPDX-License-Identifier: BSD-3-Clause
"""README.md must show the example as it is compiled: every line of docs/example/main.cpp behind the licence line, in order."""
import pathlib
import sys

root = pathlib.Path(sys.argv[1])
example = (root / "docs/example/main.cpp").read_text().split("\n", 1)[1].strip()
readme = (root / "README.md").read_text()
if example not in readme:
    sys.exit("README.md does not show docs/example/main.cpp as it stands")
print(f"README.md shows the example ({len(example.splitlines())} lines)")
