# SPDX-License-Identifier: BSD-3-Clause
"""A recorded stream between an autopilot and jinkd, and the autopilot that it stands for.

The recorded autopilot answered the recorded jinkd. Two of its answers have to be given anew, because they repeat what
was asked: the clock (TIMESYNC), and the items of the mission, which are asked for at other times.
"""
import lzma
import pathlib
import struct

import mavlink

FROM_AUTOPILOT, FROM_JINK = 0, 1
AUTOPILOT, OWN = 1, 196  # components
NO_MISSION = 65535
RECORD = struct.Struct("<dBI")  # seconds, direction, bytes that follow


def read(file):
    """(microseconds, direction, bytes) of each record of NAME.wire or NAME.wire.xz."""
    data = pathlib.Path(file).read_bytes()
    if data.startswith(b"\xfd7zXZ\0"):
        try:
            data = lzma.decompress(data)
        except lzma.LZMAError as error:
            raise ValueError(f"{file}: {error}") from error
    records, at = [], 0
    while at < len(data):
        head = data[at : at + RECORD.size]
        if len(head) < RECORD.size:
            raise ValueError(f"{file}: byte {at}: the last record is cut off")
        seconds, direction, length = RECORD.unpack(head)
        at += RECORD.size
        if not 0 <= seconds < 1e9 or direction > 1 or at + length > len(data):
            raise ValueError(f"{file}: byte {at - RECORD.size}: no record of seconds, direction and length")
        records.append((int(seconds * 1e6 + 0.5), direction, data[at : at + length]))
        at += length
    if not records:
        raise ValueError(f"{file}: no record")
    return records


def clock_start(records):
    """The recorded jinkd's clock at the start [us]: the autopilot's answers are true on it alone."""
    frames = mavlink.Frames()
    for time, direction, data in records:
        if direction == FROM_JINK:
            for _, _, name, fields in frames.feed(data):
                if name == "TIMESYNC" and fields["tc1"] == 0 and fields["ts1"] > 0:
                    return fields["ts1"] // 1000 - time
    return 1_000_000


def nearest(answers, now, fits):
    """The newest answer up to `now` that fits, else the first one after it."""
    found = None
    for time, answer in answers:
        if fits(answer) and (found is None or time <= now):
            found = answer
    return found


class Mission:
    """Of the recorded autopilot, put together from its answers."""

    def __init__(self, records):
        self.announced, self.counts, self.items = [], [], []
        frames, mission = mavlink.Frames(), 0
        for time, direction, data in records:
            if direction != FROM_AUTOPILOT:
                continue
            for _, component, name, fields in frames.feed(data):
                if component != AUTOPILOT or fields.get("mission_type", 0) != 0:
                    continue
                if name == "MISSION_COUNT":
                    mission = fields["opaque_id"]
                    self.counts.append((time, fields))
                elif name == "MISSION_ITEM_INT":
                    self.items.append((time, {**fields, "mission": mission}))
                elif name == "MISSION_CURRENT":
                    self.announced.append((time, fields))

    def count(self, now):
        announced = nearest(self.announced, now, lambda _: True)
        total = announced["total"] if announced and announced["total"] != NO_MISSION else 0
        if total and announced["mission_id"]:
            return {"count": total, "opaque_id": announced["mission_id"]}
        return nearest(self.counts, now, lambda c: not total or c["count"] == total) or nearest(self.counts, now, lambda _: True)

    def item(self, sequence, now):
        whole = self.count(now)
        if whole is None or sequence >= whole["count"]:
            return None
        known = nearest(self.items, now, lambda i: i["seq"] == sequence and i["mission"] == whole["opaque_id"])
        return known or {"seq": sequence, "frame": 2}  # an item without a place


class Autopilot:
    """What it sends: the recorded bytes, and the answers that have to be given anew."""

    def __init__(self, records, start):
        self.start, self.mission = start, Mission(records)
        self.heard, self.asked_by_jink = mavlink.Frames(), mavlink.Frames()
        self.clock, self.asked, self.wants_count, self.wanted = None, 0, False, None

    def hear_recorded(self, time, data, system):
        """Bytes that the autopilot `system` (0: any) sent at `time`."""
        for sender, component, name, fields in self.heard.feed(data):
            if component == AUTOPILOT and system in (0, sender) and name == "TIMESYNC" and fields["tc1"] != 0:
                received, sent = self.start + time, fields["ts1"] // 1000
                if sent <= received and received - sent < 1_000_000:
                    self.clock = fields["tc1"] // 1000, sent + (received - sent) // 2

    def hear_jink(self, data):
        for _, _, name, fields in self.asked_by_jink.feed(data):
            if name == "TIMESYNC" and fields["tc1"] == 0:
                self.asked = fields["ts1"]
            elif name == "MISSION_REQUEST_LIST":
                self.wants_count = True
            elif name == "MISSION_REQUEST_INT":
                self.wanted = fields["seq"]

    def answers(self, now, system):
        """Bytes at `now`, between two frames of the recording."""
        out = b""
        if self.heard.pending:
            return out
        if self.clock and self.asked:
            asked = self.asked // 1000
            middle = asked + (self.start + now - asked) // 2
            clock = (self.clock[0] + middle - self.clock[1]) * 1000
            out += mavlink.encode("TIMESYNC", {"tc1": clock, "ts1": self.asked}, system, AUTOPILOT)
            self.clock = None
        if self.wants_count:
            self.wants_count = False
            out += self._answer("MISSION_COUNT", self.mission.count(now), system)
        if self.wanted is not None:
            out += self._answer("MISSION_ITEM_INT", self.mission.item(self.wanted, now), system)
            self.wanted = None
        return out

    @staticmethod
    def _answer(name, fields, system):
        if fields is None:
            return b""
        return mavlink.encode(name, {**fields, "target_system": system, "target_component": OWN}, system, AUTOPILOT)
