# SPDX-License-Identifier: BSD-3-Clause
"""As much MAVLink as believe.py needs: frames, and the five messages of common.xml that a recording must answer."""
import struct

# Name, id, CRC_EXTRA, fields in the order of the wire, extensions at the end.
MESSAGES = {
    "MISSION_CURRENT": (42, 28, "<HHBBIII", "seq total mission_state mission_mode mission_id fence_id rally_points_id"),
    "MISSION_REQUEST_LIST": (43, 132, "<BBB", "target_system target_component mission_type"),
    "MISSION_COUNT": (44, 221, "<HBBBI", "count target_system target_component mission_type opaque_id"),
    "MISSION_REQUEST_INT": (51, 196, "<HBBB", "seq target_system target_component mission_type"),
    "MISSION_ITEM_INT": (73, 38, "<ffffiifHHBBBBBB", "param1 param2 param3 param4 x y z seq command target_system target_component "
                                                     "frame current autocontinue mission_type"),
    "TIMESYNC": (111, 34, "<qqBB", "tc1 ts1 target_system target_component"),
}
BY_ID = {entry[0]: (name, *entry[1:]) for name, entry in MESSAGES.items()}
HEADS = {0xFD: 10, 0xFE: 6}


def crc(data, value=0xFFFF):
    """CRC-16/MCRF4XX."""
    for byte in data:
        byte ^= value & 0xFF
        byte = (byte ^ (byte << 4)) & 0xFF
        value = (value >> 8) ^ (byte << 8) ^ (byte << 3) ^ (byte >> 4)
    return value


def encode(name, fields, system, component):
    """A frame of MAVLink 2, sequence 0."""
    number, extra, form, names = MESSAGES[name]
    payload = struct.pack(form, *(fields.get(n, 0) for n in names.split())).rstrip(b"\0") or b"\0"
    head = struct.pack("<BBBBBBHB", len(payload), 0, 0, 0, system, component, number & 0xFFFF, number >> 16)
    return b"\xfd" + head + payload + struct.pack("<H", crc(bytes([extra]), crc(head + payload)))


class Frames:
    """Messages of a stream of bytes; frames of other messages are passed over unchecked."""

    def __init__(self):
        self.pending = b""

    def feed(self, data):
        """(system, component, name, fields) of each message that ends in these bytes."""
        self.pending += data
        while self.pending:
            start = self.pending[0]
            head = HEADS.get(start)
            if head is None:
                self.pending = self.pending[1:]
                continue
            if len(self.pending) < head:
                return
            signature = 13 if start == 0xFD and self.pending[2] & 1 else 0
            end = head + self.pending[1] + 2 + signature
            if len(self.pending) < end:
                return
            frame, self.pending = self.pending[:end], self.pending[end:]
            if start == 0xFD:
                system, component, number = frame[5], frame[6], int.from_bytes(frame[7:10], "little")
            else:
                system, component, number = frame[3], frame[4], frame[5]
            if number in BY_ID:
                name, extra, form, names = BY_ID[number]
                payload = frame[head : head + frame[1]]
                if crc(bytes([extra]), crc(frame[1 : head + frame[1]])) == int.from_bytes(frame[head + frame[1] :][:2], "little"):
                    whole = payload.ljust(struct.calcsize(form), b"\0")[: struct.calcsize(form)]
                    yield system, component, name, dict(zip(names.split(), struct.unpack(form, whole)))
