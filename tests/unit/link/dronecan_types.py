# SPDX-License-Identifier: BSD-3-Clause
"""DroneCAN data types as their public definitions list them, and the signatures that follow from them.

The signature is a CRC-64/WE over the normalised text of the definition, with the signatures of nested types folded in:
one wrong name, width or order in the lists below, and it comes out another. Python 3 standard library only.
"""


class Prim:
    """kind: u, i, f or v (void); `mode` is that of the definition: saturated or truncated."""

    def __init__(self, kind, bits, mode="saturated"):
        self.kind, self.bits, self.mode = kind, bits, mode

    def text(self):
        if self.kind == "v":
            return f"void{self.bits}"
        name = {"u": "uint", "i": "int", "f": "float", "b": "bool"}[self.kind]
        return f"{self.mode} {name}" + ("" if self.kind == "b" else str(self.bits))

    def signature(self):
        return None

    def least(self):
        return self.bits

    def most(self):
        return self.bits


class Array:
    def __init__(self, element, count, dynamic):
        self.element, self.count, self.dynamic = element, count, dynamic

    def text(self):
        return f"{self.element.text()}[{'<=' if self.dynamic else ''}{self.count}]"

    def signature(self):
        return self.element.signature()

    def length_bits(self):
        return self.count.bit_length() if self.dynamic else 0

    def least(self):
        return self.length_bits() if self.dynamic else self.count * self.element.least()

    def most(self):
        return self.length_bits() + self.count * self.element.most()


CRC64_POLYNOMIAL = 0x42F0E1EBA9EA3693
ALL64 = (1 << 64) - 1


def crc64(data, signature=0):
    """CRC-64/WE; `signature`: the result that is to be continued."""
    crc = signature ^ ALL64
    for byte in data:
        crc ^= byte << 56
        for _ in range(8):
            crc = ((crc << 1) ^ CRC64_POLYNOMIAL) & ALL64 if crc >> 63 else crc << 1
    return crc ^ ALL64


def crc16(data, crc=0xFFFF):
    """CRC-16/CCITT-FALSE."""
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ 0x1021) & 0xFFFF if crc & 0x8000 else crc << 1
    return crc


class Compound:
    """fields: (name, type); response: the same for a service; union: exactly one field is there, behind its number."""

    def __init__(self, name, fields, response=None, union=False):
        self.name, self.fields, self.response, self.union = name, fields, response, union

    def text(self):
        return self.name

    def definition(self):
        lines = [self.name] + (["@union"] if self.union else [])
        for group, name_type in [(0, f) for f in self.fields] + [(1, f) for f in self.response or []]:
            if group and "---" not in lines:
                lines.append("---")
            name, kind = name_type
            lines.append(kind.text() + (f" {name}" if name else ""))
        if self.response is not None and "---" not in lines:
            lines.append("---")
        return "\n".join(lines)

    def signature(self):
        value = crc64(self.definition().encode())
        for _, kind in self.fields + (self.response or []):
            nested = kind.signature()
            if nested is not None:
                value = crc64(nested.to_bytes(8, "little") + value.to_bytes(8, "little"), value)
        return value

    def tag_bits(self):
        return (len(self.fields) - 1).bit_length()

    def least(self):
        sizes = [kind.least() for _, kind in self.fields]
        return self.tag_bits() + min(sizes) if self.union else sum(sizes)

    def most(self):
        sizes = [kind.most() for _, kind in self.fields]
        return self.tag_bits() + max(sizes) if self.union else sum(sizes)


def u(bits):
    return Prim("u", bits)


def i(bits):
    return Prim("i", bits)


def void(bits):
    return ("", Prim("v", bits))


f16, f32, bit = Prim("f", 16), Prim("f", 32), Prim("b", 1)


def fixed(element, count):
    return Array(element, count, False)


def upto(count, element):
    return Array(element, count, True)


stamp = Compound("uavcan.Timestamp", [("usec", Prim("u", 56, "truncated"))])
orientation = Compound(
    "uavcan.CoarseOrientation", [("fixed_axis_roll_pitch_yaw", fixed(i(5), 3)), ("orientation_defined", bit)]
)
node_status = Compound(
    "uavcan.protocol.NodeStatus",
    [
        ("uptime_sec", u(32)),
        ("health", u(2)),
        ("mode", u(3)),
        ("sub_mode", u(3)),
        ("vendor_specific_status_code", u(16)),
    ],
)
software = Compound(
    "uavcan.protocol.SoftwareVersion",
    [("major", u(8)), ("minor", u(8)), ("optional_field_flags", u(8)), ("vcs_commit", u(32)), ("image_crc", u(64))],
)
hardware = Compound(
    "uavcan.protocol.HardwareVersion",
    [
        ("major", u(8)),
        ("minor", u(8)),
        ("unique_id", fixed(u(8), 16)),
        ("certificate_of_authenticity", upto(255, u(8))),
    ],
)
empty = Compound("uavcan.protocol.param.Empty", [])
value = Compound(
    "uavcan.protocol.param.Value",
    [
        ("empty", empty),
        ("integer_value", i(64)),
        ("real_value", f32),
        ("boolean_value", u(8)),
        ("string_value", upto(128, u(8))),
    ],
    union=True,
)
numeric = Compound(
    "uavcan.protocol.param.NumericValue", [("empty", empty), ("integer_value", i(64)), ("real_value", f32)], union=True
)
level = Compound("uavcan.protocol.debug.LogLevel", [("value", u(3))])
protocol = Compound("uavcan.tunnel.Protocol", [("protocol", u(8))])
ecef = Compound(
    "uavcan.equipment.gnss.ECEFPositionVelocity",
    [
        ("velocity_xyz", fixed(f32, 3)),
        ("position_xyz_mm", fixed(i(36), 3)),
        void(6),
        ("covariance", upto(36, f16)),
    ],
)

get_node_info = Compound(
    "uavcan.protocol.GetNodeInfo",
    [],
    [("status", node_status), ("software_version", software), ("hardware_version", hardware), ("name", upto(80, u(8)))],
)
get_set = Compound(
    "uavcan.protocol.param.GetSet",
    [("index", u(13)), ("value", value), ("name", upto(92, u(8)))],
    [
        void(5),
        ("value", value),
        void(5),
        ("default_value", value),
        void(6),
        ("max_value", numeric),
        void(6),
        ("min_value", numeric),
        ("name", upto(92, u(8))),
    ],
)
execute_opcode = Compound(
    "uavcan.protocol.param.ExecuteOpcode",
    [("opcode", u(8)), ("argument", i(48))],
    [("argument", i(48)), ("ok", bit)],
)
time_sync = Compound(
    "uavcan.protocol.GlobalTimeSync", [("previous_transmission_timestamp_usec", Prim("u", 56, "truncated"))]
)
allocation = Compound(
    "uavcan.protocol.dynamic_node_id.Allocation",
    [("node_id", u(7)), ("first_part_of_unique_id", bit), ("unique_id", upto(16, u(8)))],
)
log_message = Compound(
    "uavcan.protocol.debug.LogMessage", [("level", level), ("source", upto(31, u(8))), ("text", upto(90, u(8)))]
)
measurement = Compound(
    "uavcan.equipment.range_sensor.Measurement",
    [
        ("timestamp", stamp),
        ("sensor_id", u(8)),
        ("beam_orientation_in_body_frame", orientation),
        ("field_of_view", f16),
        ("sensor_type", u(5)),
        ("reading_type", u(3)),
        ("range", f16),
    ],
)
proximity = Compound(
    "ardupilot.equipment.proximity_sensor.Proximity",
    [
        ("sensor_id", u(8)),
        ("reading_type", u(3)),
        ("flags", u(5)),
        ("yaw", f16),
        ("pitch", f16),
        ("distance", f16),
    ],
)
traffic = Compound(
    "ardupilot.equipment.trafficmonitor.TrafficReport",
    [
        ("timestamp", stamp),
        ("icao_address", u(32)),
        ("tslc", u(16)),
        ("latitude_deg_1e7", i(32)),
        ("longitude_deg_1e7", i(32)),
        ("alt_m", f32),
        ("heading", f16),
        ("velocity", fixed(f16, 3)),
        ("squawk", u(16)),
        ("callsign", fixed(u(8), 9)),
        ("source", u(3)),
        ("traffic_type", u(5)),
        ("alt_type", u(7)),
        ("lat_lon_valid", bit),
        ("heading_valid", bit),
        ("velocity_valid", bit),
        ("callsign_valid", bit),
        ("ident_valid", bit),
        ("simulated_report", bit),
        ("vertical_velocity_valid", bit),
        ("baro_valid", bit),
    ],
)
fix2 = Compound(
    "uavcan.equipment.gnss.Fix2",
    [
        ("timestamp", stamp),
        ("gnss_timestamp", stamp),
        ("gnss_time_standard", u(3)),
        void(13),
        ("num_leap_seconds", u(8)),
        ("longitude_deg_1e8", i(37)),
        ("latitude_deg_1e8", i(37)),
        ("height_ellipsoid_mm", i(27)),
        ("height_msl_mm", i(27)),
        ("ned_velocity", fixed(f32, 3)),
        ("sats_used", u(6)),
        ("status", u(2)),
        ("mode", u(4)),
        ("sub_mode", u(6)),
        ("covariance", upto(36, f16)),
        ("pdop", f16),
        ("ecef_position_velocity", upto(1, ecef)),
    ],
)
solution = Compound(
    "uavcan.equipment.ahrs.Solution",
    [
        ("timestamp", stamp),
        ("orientation_xyzw", fixed(f16, 4)),
        void(4),
        ("orientation_covariance", upto(9, f16)),
        ("angular_velocity", fixed(f16, 3)),
        void(4),
        ("angular_velocity_covariance", upto(9, f16)),
        ("linear_acceleration", fixed(f16, 3)),
        ("linear_acceleration_covariance", upto(9, f16)),
    ],
)
targetted = Compound(
    "uavcan.tunnel.Targetted",
    [
        ("protocol", protocol),
        ("target_node", u(7)),
        ("serial_id", i(5)),
        ("options", u(4)),
        ("baudrate", u(24)),
        ("buffer", upto(120, u(8))),
    ],
)
broadcast = Compound(
    "uavcan.tunnel.Broadcast", [("protocol", protocol), ("channel_id", u(8)), ("buffer", upto(60, u(8)))]
)

# type, id, published signature, CRC-16 state after its eight bytes, greatest bytes of request or message / response
PUBLISHED = [
    (node_status, 341, 0x0F0868D0C1A7C6F1, 0xBE5F, 7, None),
    (get_node_info, 1, 0xEE468A8121C46A9E, 0xD9A7, 0, 377),
    (allocation, 1, 0x0B2A812620A11D40, 0xF258, 18, None),
    (time_sync, 4, 0x20271116A793C2DB, 0x7908, 7, None),
    (get_set, 11, 0xA7B622F939D1A4D5, 0xFB10, 224, 371),
    (execute_opcode, 10, 0x3B131AC5EB69D2CD, 0xD7D4, 7, 7),
    (log_message, 16383, 0xD654A48E0C049D75, 0x4570, 123, None),
    (measurement, 1050, 0x68FFFE70FC771952, 0x049C, 15, None),
    (proximity, 21910, 0x99DD3985FB3222CE, 0x96AC, 8, None),
    (traffic, 20790, 0x68E45DB60B6981F8, 0x71FB, 47, None),
    (fix2, 1063, 0xCA41E7000F37435F, 0xC798, 222, None),
    (solution, 1000, 0x72A63A3C6F41FA9B, 0x2055, 84, None),
    (targetted, 3001, 0xB138E7EA72A2A2E9, 0x7CA9, 127, None),
    (broadcast, 2010, 0x5AA2D4D9CF4B1E85, 0x1C82, 63, None),
]


def complaints():
    """What of the table above does not follow from the definitions."""
    found = []
    for kind, _, signature, seed, most, most_response in PUBLISHED:
        if kind.signature() != signature:
            found.append(f"{kind.name}: signature {kind.signature():016X}, published {signature:016X}")
        if crc16(signature.to_bytes(8, "little")) != seed:
            found.append(f"{kind.name}: CRC seed {crc16(signature.to_bytes(8, 'little')):04X}, published {seed:04X}")
        sizes = [(kind.fields, most)] + ([(kind.response, most_response)] if kind.response is not None else [])
        for fields, published in sizes:
            size = (sum(t.most() for _, t in fields) + 7) // 8
            if size != published:
                found.append(f"{kind.name}: {size} bytes at most, published {published}")
    return found


if __name__ == "__main__":
    print("\n".join(complaints()) or "all signatures, seeds and sizes as published")
