# SPDX-License-Identifier: BSD-3-Clause
"""sent_frames.py FILE.steps ...: what a co-processor sent in recorded steps (toolchain/sim/step_record.hpp), a line for each
frame: time of its last byte, message, payload. Sequence numbers and checksums are left out, and so are requests for
parameters of the autopilot: they say nothing about what is flown."""
import pathlib
import struct
import sys

HEAD = struct.Struct("<IIqII")  # StepRecord
MAGIC = 0x4A535201
MAVLINK_2 = 0xFD
AROUND = 12  # bytes of a frame beside its payload
SIGNATURE = 13
PARAM_REQUEST_READ = 20


def frames_of(sent):
    """Whole MAVLink 2 frames at the front of `sent`, and what is left of it."""
    frames, at = [], 0
    while len(sent) - at >= AROUND:
        if sent[at] != MAVLINK_2:
            raise ValueError(f"no frame begins with {sent[at]:#x}")
        length = sent[at + 1]
        whole = AROUND + length + (SIGNATURE if sent[at + 2] & 1 else 0)
        if len(sent) - at < whole:
            break
        frames.append((int.from_bytes(sent[at + 7:at + 10], "little"), sent[at + 10:at + 10 + length]))
        at += whole
    return frames, sent[at:]


def main(paths):
    for path in paths:
        data, at, sent = pathlib.Path(path).read_bytes(), 0, b""
        while at < len(data):
            magic, start, now, bytes_in, bytes_out = HEAD.unpack_from(data, at)
            if magic != MAGIC:
                raise ValueError(f"{path}: no step at byte {at}")
            at += HEAD.size + bytes_in
            frames, sent = frames_of((b"" if start else sent) + data[at:at + bytes_out])
            at += bytes_out
            print(start, now)
            for message, payload in frames:
                if message != PARAM_REQUEST_READ:
                    print(message, payload.hex())


if __name__ == "__main__":
    main(sys.argv[1:])
