#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Turns messages.txt and passed_over.txt into the C++ tables of firmware/link/mavlink.

    generate.py            writes messages.hpp and catalogue_table.hpp
    generate.py --check    writes nothing; fails when the files differ from what would be written

CRC_EXTRA, lengths and offsets are computed from the fields and compared with the published values in the table; any
difference is an error. Python 3 standard library only.
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
OUT = HERE.parent.parent / "firmware" / "link" / "mavlink"

# table type -> (size, C++ type, type name that CRC_EXTRA hashes)
TYPES = {
    "u64": (8, "std::uint64_t", "uint64_t"), "i64": (8, "std::int64_t", "int64_t"), "f64": (8, "double", "double"),
    "u32": (4, "std::uint32_t", "uint32_t"), "i32": (4, "std::int32_t", "int32_t"), "f32": (4, "float", "float"),
    "u16": (2, "std::uint16_t", "uint16_t"), "i16": (2, "std::int16_t", "int16_t"),
    "u8": (1, "std::uint8_t", "uint8_t"), "i8": (1, "std::int8_t", "int8_t"), "char": (1, "char", "char"),
}
MAX_PAYLOAD = 255

MESSAGE = re.compile(r"message (?P<name>[A-Z][A-Z0-9_]*) id=(?P<id>\d+) crc_extra=(?P<crc>\d+) "
                     r"length=(?P<min>\d+)/(?P<max>\d+) dialect=(?P<dialect>\w+)(?: state=(?P<state>\w+))?$")
FIELD = re.compile(r"    (?P<type>\w+?)(?:\[(?P<count>\d+)\])? (?P<name>[A-Za-z_]\w*)(?: \[(?P<unit>[^\]]+)\])?"
                   r"(?P<ext> extension)?(?: = (?P<default>\d+))?$")


class TableError(Exception):
    pass


class Field:
    def __init__(self, match, where):
        if match["type"] not in TYPES:
            raise TableError(f"{where}: unknown type {match['type']}")
        self.size, self.cpp, self.hashed = TYPES[match["type"]]
        self.type = match["type"]
        self.name = match["name"]
        self.count = int(match["count"]) if match["count"] else 0  # 0: a scalar
        self.unit = match["unit"]
        self.extension = bool(match["ext"])
        self.default = match["default"] or "0"
        self.offset = 0
        if self.count > MAX_PAYLOAD or (match["count"] and self.count == 0):
            raise TableError(f"{where}: bad array length")

    def bytes(self):
        return self.size * max(1, self.count)


class Message:
    def __init__(self, match):
        self.name = match["name"]
        self.id = int(match["id"])
        self.crc_extra, self.min, self.max = int(match["crc"]), int(match["min"]), int(match["max"])
        self.dialect, self.state = match["dialect"], match["state"]
        self.fields = []

    def struct(self):
        return "".join(part.capitalize() for part in self.name.split("_"))

    def check(self):
        """Computes offsets; raises when order, CRC_EXTRA or lengths differ from the published ones."""
        offset, base, last_size, extended = 0, 0, 8, False
        for field in self.fields:
            if field.extension:
                extended = True
            elif extended:
                raise TableError(f"{self.name}.{field.name}: base field behind an extension")
            elif field.size > last_size:
                raise TableError(f"{self.name}.{field.name}: not in wire order")
            else:
                last_size = field.size
            field.offset = offset
            offset += field.bytes()
            if not field.extension:
                base = offset
        if offset > MAX_PAYLOAD:
            raise TableError(f"{self.name}: {offset} bytes do not fit into a frame")
        if len({f.name for f in self.fields}) != len(self.fields):
            raise TableError(f"{self.name}: two fields of one name")
        if (base, offset) != (self.min, self.max):
            raise TableError(f"{self.name}: length {base}/{offset}, published {self.min}/{self.max}")
        if crc_extra(self) != self.crc_extra:
            raise TableError(f"{self.name}: CRC_EXTRA {crc_extra(self)}, published {self.crc_extra}")


def crc16(data, crc=0xFFFF):
    """CRC-16/MCRF4XX, bit by bit (the C++ side uses another form of it)."""
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
    return crc


def crc_extra(message):
    crc = crc16(f"{message.name} ".encode())
    for field in message.fields:
        if field.extension:
            continue
        crc = crc16(f"{field.hashed} {field.name} ".encode(), crc)
        if field.count:
            crc = crc16(bytes([field.count]), crc)
    return (crc & 0xFF) ^ (crc >> 8)


def read_messages(path):
    messages = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        where = f"{path.name}:{number}"
        if not line.strip() or line.startswith("#"):
            continue
        if match := MESSAGE.match(line):
            messages.append(Message(match))
        elif (match := FIELD.match(line)) and messages:
            messages[-1].fields.append(Field(match, where))
        else:
            raise TableError(f"{where}: cannot read '{line}'")
    for message in messages:
        message.check()
    if [m.id for m in messages] != sorted({m.id for m in messages}):
        raise TableError(f"{path.name}: ids must be unique and rising")
    if len({m.struct() for m in messages}) != len(messages):
        raise TableError(f"{path.name}: two messages of one C++ name")
    return messages


def read_passed_over(path):
    rows = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        match = re.match(r"(\d+) (\d+) (\d+) ([A-Z0-9_]+)$", line)
        if not match:
            raise TableError(f"{path.name}:{number}: cannot read '{line}'")
        rows.append((int(match[1]), int(match[2]), int(match[3]), match[4]))
    return rows


BANNER = ("// SPDX-License-Identifier: BSD-3-Clause\n"
          "// Generated by toolchain/mavlink/generate.py from {source}; edit that, not this.\n#pragma once\n\n")


def struct_text(message):
    state = f", {message.state}" if message.state else ""
    lines = [f"/// {message.name} ({message.id}), {message.dialect}{state}.", f"struct {message.struct()} {{"]
    for field in message.fields:
        notes = [f"[{field.unit}]"] if field.unit else []
        notes += ["extension"] if field.extension else []
        note = f"  ///< {' '.join(notes)}" if notes else ""
        if field.count:
            lines.append(f"    std::array<{field.cpp}, {field.count}> {field.name}{{}};{note}")
        else:
            default = "0.0F" if field.cpp == "float" else "0.0" if field.cpp == "double" else field.default
            lines.append(f"    {field.cpp} {field.name} = {'{}' if field.cpp == 'char' else default};{note}")
    name = message.struct()
    lines += ["",
              f"    static constexpr MessageInfo kInfo{{{message.id}, {message.crc_extra}, {message.min}, {message.max}}};",
              f"    static const std::array<Field, {len(message.fields)}> kFields;", "};",
              f"inline constexpr std::array<Field, {len(message.fields)}> {name}::kFields{{{{"]
    for field in message.fields:
        lines.append(f"    {{offsetof({name}, {field.name}), {field.offset}, {max(1, field.count)}, "
                     f"FieldType::{'character' if field.type == 'char' else field.type}}},")
    return "\n".join(lines + ["}};", ""])


def messages_text(messages):
    out = [BANNER.format(source="messages.txt"),
           "#include <array>\n#include <cstddef>\n#include <cstdint>\n\n#include \"firmware/link/mavlink/field.hpp\"\n\n"
           "namespace jink::link::mavlink {\n\n"]
    out += [struct_text(message) + "\n" for message in messages]
    out.append("template <class... Messages>\nstruct MessageList {};\n"
               "/// Every message above, for code that treats them all alike.\nusing AllMessages = MessageList<\n    ")
    out.append(",\n    ".join(message.struct() for message in messages))
    out.append(">;\n\n}  // namespace jink::link::mavlink\n")
    return "".join(out)


def catalogue_text(messages, passed_over):
    rows = [(m.id, m.crc_extra, m.min, m.max, m.name) for m in messages]
    # A message that is not decoded may be as long as a frame allows, including later extensions.
    rows += [(i, crc, base, MAX_PAYLOAD, f"{name}, passed over") for i, crc, base, name in passed_over]
    rows.sort()
    if len({row[0] for row in rows}) != len(rows):
        raise TableError("passed_over.txt: an id stands twice or is decoded")
    lines = [f"    {{{i}, {crc}, {low}, {high}}},  // {name}" for i, crc, low, high, name in rows]
    return (BANNER.format(source="messages.txt and passed_over.txt") +
            "#include <array>\n\n#include \"firmware/link/mavlink/field.hpp\"\n\nnamespace jink::link::mavlink {\n\n"
            f"inline constexpr std::array<MessageInfo, {len(rows)}> kCatalogue{{{{\n" + "\n".join(lines) +
            "\n}};\n\n}  // namespace jink::link::mavlink\n")


def main(arguments):
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    try:
        messages = read_messages(HERE / "messages.txt")
        texts = {OUT / "messages.hpp": messages_text(messages),
                 OUT / "catalogue_table.hpp": catalogue_text(messages, read_passed_over(HERE / "passed_over.txt"))}
    except TableError as error:
        sys.exit(f"generate.py: {error}")
    stale = [p for p, text in texts.items() if not p.exists() or p.read_text(encoding="utf-8") != text]
    if arguments:
        if stale:
            sys.exit("generate.py: not what the table says: " + ", ".join(p.name for p in stale))
        print(f"{len(messages)} messages: order, CRC_EXTRA and lengths as published; generated files are current")
    else:
        for path in stale:
            path.write_text(texts[path], encoding="utf-8")
            print(f"wrote {path.name}")


if __name__ == "__main__":
    main(sys.argv[1:])
