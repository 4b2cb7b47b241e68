# SPDX-License-Identifier: BSD-3-Clause
"""Reads what a program of CLI11 prints for --help, with all of its subcommands."""
import dataclasses
import os
import re
import subprocess

TYPES = r"(?:TEXT|INT|UINT|FLOAT|BOOLEAN|ENUM)"
NAME = r"(?:-[A-Za-z]|--[A-Za-z][\w-]*(?:\{\w+\})?)"  # --no-x{false} of a flag that can be denied
OPTION = re.compile(rf"  ({NAME}(?:,{NAME})*)(.*)")
NAMED = re.compile(r"  (\S+)(.*)")
COLUMN = 30  # of the texts


@dataclasses.dataclass
class Option:
    names: list  # as "-h", "--help"
    value: str  # type, default and relations, as "TEXT:{y,z}=z"; empty: a flag
    text: str

    @property
    def takes_value(self):
        return re.match(TYPES, self.value) is not None

    @property
    def choices(self):
        found = re.match(TYPES + r":\{([^}]*)\}", self.value)
        return found[1].split(",") if found else []

    @property
    def takes_path(self):
        """Most texts are names of files and devices. Numbers and choices are none."""
        return self.value.startswith("TEXT") and not self.choices


@dataclasses.dataclass
class Command:
    path: tuple  # names from the program on
    text: str
    usage: str  # what follows the name
    options: list
    positionals: list  # Option with one name
    subcommands: list  # Command


def split_entry(rest):
    """What follows the name in an entry: value and the first line of the text."""
    parts = re.split(r"\s{2,}", rest.strip(), maxsplit=1)
    if rest.startswith("   "):  # no value
        return "", rest.strip()
    return parts[0], parts[1] if len(parts) > 1 else ""


def parse(text, path):
    """Command of one help text, and the names of its subcommands."""
    before, _, rest = text.partition("Usage: ")
    usage, _, rest = rest.partition("\n")
    command = Command(tuple(path), " ".join(before.split()), usage.partition(" ")[2] if len(path) == 1 else "", [], [], [])
    if len(path) > 1:
        command.usage = usage.split(" " + path[-1] + " ", 1)[-1]
    names, section, entry = [], "", None
    for line in rest.splitlines():
        if re.fullmatch(r"\S.*:", line):
            section, entry = line[:-1], None
        elif line.startswith(" " * COLUMN) and entry is not None:
            entry.text = f"{entry.text} {line.strip()}".strip()
        elif section == "Options" and (found := OPTION.fullmatch(line)):
            entry = Option(re.sub(r"\{\w+\}", "", found[1]).split(","), *split_entry(found[2]))
            command.options.append(entry)
        elif section == "Positionals" and (found := NAMED.fullmatch(line)):
            entry = Option([found[1]], *split_entry(found[2]))
            command.positionals.append(entry)
        elif section == "Subcommands" and (found := NAMED.fullmatch(line)):
            names.append(found[1])
            entry = None
        elif section == "Subcommands" and names and line.startswith(" " * COLUMN):
            continue  # a text with a line break of its own; its own help has it
        elif line.strip() and not (entry is not None and entry.text):
            raise ValueError(f"{' '.join(path)} --help: not understood: {line!r}")
        elif line.strip() and entry is not None:  # a text with a line break of its own
            entry.text += " " + line.strip()
    return command, names


def read(program, path=None):
    """Command of a program, with all below it."""
    path = path or [os.path.basename(program)]
    text = subprocess.run([program, *path[1:], "--help"], check=True, capture_output=True, text=True).stdout
    command, names = parse(text, path)
    command.subcommands = [read(program, [*path, name]) for name in names]
    return command


def walk(command):
    yield command
    for below in command.subcommands:
        yield from walk(below)
