#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A second implementation of DroneCAN's encoding against ours.

    dronecan_check.py PROGRAM [--seed N] [--count N]

Checks that the published signatures follow from the fields in dronecan_types.py; then encodes random transfers by
joining strings of bits, cuts them into frames, gives the frames to PROGRAM (dronecan_exchange), and compares the fields
that it read and the frames that it makes of them. Python 3 standard library only; nothing is shared with the C++ code.
"""
import argparse
import pathlib
import random
import struct
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import dronecan_types as types  # noqa: E402


def bits_of(number, width):
    """Least significant byte first, each byte most significant bit first, the last one only as long as needed."""
    number &= (1 << width) - 1
    out = ""
    while width > 0:
        n = min(8, width)
        out += format(number & ((1 << n) - 1), f"0{n}b")
        number >>= n
        width -= n
    return out


def float_bits(number):
    return struct.unpack("<I", struct.pack("<f", number))[0]


class Maker:
    """Random values of a type: the bits that go on the wire, and the words that the C++ program should print."""

    def __init__(self, rng):
        self.rng = rng
        self.bits = ""
        self.words = []

    def number(self, width):
        return self.rng.choice([0, (1 << width) - 1, self.rng.getrandbits(width), self.rng.getrandbits(width)])

    def primitive(self, kind):
        if kind.kind == "v":
            self.bits += "0" * kind.bits
        elif kind.kind in "ub":
            number = self.number(kind.bits)
            self.bits += bits_of(number, kind.bits)
            self.words.append(str(number))
        elif kind.kind == "i":
            number = self.number(kind.bits)
            self.bits += bits_of(number, kind.bits)
            self.words.append(str(number - (1 << kind.bits) if number >> (kind.bits - 1) else number))
        elif kind.bits == 16:
            half = self.rng.getrandbits(16)
            while half & 0x7C00 == 0x7C00 and half & 0x3FF:  # which NaN comes back is nobody's promise
                half = self.rng.getrandbits(16)
            number = struct.unpack("<e", struct.pack("<H", half))[0]
            self.bits += bits_of(half, 16)
            self.words.append(f"f{float_bits(number)}")
        else:
            word = self.rng.getrandbits(32)
            self.bits += bits_of(word, 32)
            self.words.append(f"f{word}")

    def array(self, kind, last):
        count = kind.count
        if kind.dynamic:
            count = self.rng.choice([0, kind.count, self.rng.randint(0, kind.count)])
            if not (last and kind.element.least() >= 8):  # tail array optimisation
                self.bits += bits_of(count, kind.length_bits())
            self.words.append(f"[{count}]")
        for _ in range(count):
            self.value(kind.element, False)

    def value(self, kind, last):
        if isinstance(kind, types.Prim):
            self.primitive(kind)
        elif isinstance(kind, types.Array):
            self.array(kind, last)
        elif kind.union:
            tag = self.rng.randrange(len(kind.fields))
            self.bits += bits_of(tag, kind.tag_bits())
            self.words.append(f"t{tag}")
            self.value(kind.fields[tag][1], last)
        else:
            self.fields(kind.fields, last)

    def fields(self, fields, last=True):
        for number, (_, kind) in enumerate(fields):
            self.value(kind, last and number == len(fields) - 1)

    def payload(self):
        padded = self.bits + "0" * (-len(self.bits) % 8)
        return bytes(int(padded[i : i + 8], 2) for i in range(0, len(padded), 8))


def frames_of(identifier, seed, transfer, payload):
    if len(payload) <= 7:
        return [(identifier, payload + bytes([0xC0 | transfer]))]
    stream = struct.pack("<H", types.crc16(payload, seed)) + payload
    parts = [stream[i : i + 7] for i in range(0, len(stream), 7)]
    frames = []
    for number, part in enumerate(parts):
        tail = transfer | (0x80 if number == 0 else 0) | (0x40 if part is parts[-1] else 0) | (number % 2) << 5
        frames.append((identifier, part + bytes([tail])))
    return frames


def one_transfer(rng, kind, number, seed):
    """node that listens, frames, fields, frames expected back, type id."""
    is_service = kind.response is not None
    response = is_service and rng.random() < 0.5
    maker = Maker(rng)
    fields = kind.response if response else kind.fields
    without = None
    if kind is types.fix2:  # its last field is passed over by ours, and empty when ours writes
        maker.fields(fields[:-1], False)
        without = maker.payload()
        extra = Maker(rng)
        if rng.random() < 0.5:
            extra.fields(types.ecef.fields, True)
        maker.bits += extra.bits
    else:
        maker.fields(fields)
    priority, source, destination, transfer = rng.randrange(32), rng.randint(1, 127), rng.randint(1, 127), rng.randrange(32)
    if is_service:
        identifier = priority << 24 | number << 16 | (0 if response else 1) << 15 | destination << 8 | 0x80 | source
    else:
        identifier = priority << 24 | number << 8 | source
    frames = frames_of(identifier, seed, transfer, maker.payload())
    back = frames if without is None else frames_of(identifier, seed, transfer, without)
    return destination, frames, maker.words, back


def text(frames):
    return " ".join(f"{identifier:08X}#{data.hex().upper()}" for identifier, data in frames)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=20260101)
    parser.add_argument("--count", type=int, default=5000)
    arguments = parser.parse_args()
    for complaint in types.complaints():
        print(complaint)
    if types.complaints():
        return 1

    rng = random.Random(arguments.seed)
    lines, wanted = [], []
    for n in range(arguments.count):
        kind, number, _, seed, _, _ = types.PUBLISHED[n % len(types.PUBLISHED)]
        node, frames, words, back = one_transfer(rng, kind, number, seed)
        lines.append(f"{node} {text(frames)}")
        wanted.append(f"{number}|{' '.join(words)}| {text(back)}")
    result = subprocess.run([arguments.program], input="\n".join(lines) + "\n", capture_output=True, text=True, check=True)
    got = result.stdout.splitlines()
    if len(got) != len(wanted):
        print(f"{len(got)} answers to {len(wanted)} transfers")
        return 1
    bad = [n for n in range(len(got)) if got[n] != wanted[n]]
    for n in bad[:3]:
        print(f"seed {arguments.seed}, transfer {n}: {lines[n]}\n  wanted {wanted[n]}\n  got    {got[n]}")
    print(f"{len(got) - len(bad)} of {len(got)} transfers equal both ways, seed {arguments.seed}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
