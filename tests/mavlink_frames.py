# SPDX-License-Identifier: BSD-3-Clause
"""MAVLink frames as tests need them, from its page "Packet Serialization" (mavlink.io), independent of the firmware.

Versions 1 and 2, without signatures. Python 3 standard library only.
"""
import struct

EXTRA = {0: 50, 21: 159, 22: 220, 23: 168}  # CRC_EXTRA of HEARTBEAT, PARAM_REQUEST_LIST, PARAM_VALUE, PARAM_SET
HEARTBEAT = 0
AVOIDANCE = 196  # MAV_COMP_ID_OBSTACLE_AVOIDANCE: jink


def checksum(data):
    """CRC-16/MCRF4XX."""
    crc = 0xFFFF
    for byte in data:
        byte ^= crc & 0xFF
        byte = (byte ^ (byte << 4)) & 0xFF
        crc = (crc >> 8) ^ (byte << 8) ^ (byte << 3) ^ (byte >> 4)
    return crc


def encode(number, payload, sequence, system, component):
    """A frame of version 2."""
    payload = payload.rstrip(b"\0") or b"\0"
    head = struct.pack("<BBBBBBHB", len(payload), 0, 0, sequence, system, component, number & 0xFFFF, number >> 16)
    return b"\xfd" + head + payload + struct.pack("<H", checksum(head + payload + bytes([EXTRA[number]])))


def frames(stream):
    """([(component, message, payload)], rest): the whole frames of the messages in EXTRA, and the bytes from the first frame on that is not whole."""
    found, at = [], 0
    while at < len(stream):
        header = {0xFD: 10, 0xFE: 6}.get(stream[at])
        if header is None:
            at += 1
            continue
        end = at + header + (stream[at + 1] if at + 1 < len(stream) else 255)
        if len(stream) < end + 2:
            break
        message = int.from_bytes(stream[at + 7:at + 10], "little") if header == 10 else stream[at + 5]
        if message in EXTRA and checksum(stream[at + 1:end] + bytes([EXTRA[message]])) != int.from_bytes(stream[end:end + 2], "little"):
            at += 1  # a start byte inside of another frame
            continue
        if message in EXTRA:
            found.append((stream[at + (6 if header == 10 else 4)], message, stream[at + header:end]))
        at = end + 2
    return found, stream[at:]
