#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The MAVLink table: generated files are current, and the generator refuses every kind of wrong table."""
import importlib.util
import pathlib
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
SPEC = importlib.util.spec_from_file_location("generate", ROOT / "toolchain" / "mavlink" / "generate.py")
generate = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(generate)

HEARTBEAT = """message HEARTBEAT id=0 crc_extra=50 length=9/9 dialect=minimal
    u32 custom_mode
    u8 type
    u8 autopilot
    u8 base_mode
    u8 system_status
    u8 mavlink_version = 3
"""


def read(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "table.txt"
        path.write_text(text, encoding="utf-8")
        return generate.read_messages(path)


class Table(unittest.TestCase):
    def test_generated_files_are_current(self):
        generate.main(["--check"])

    def test_checksum_has_its_known_answer(self):
        self.assertEqual(generate.crc16(b"123456789"), 0x6F91)

    def test_good_table_is_read(self):
        self.assertEqual(read(HEARTBEAT)[0].crc_extra, 50)

    def refused(self, text, reason):
        with self.assertRaisesRegex(generate.TableError, reason):
            read(text)

    def test_wrong_tables_are_refused(self):
        self.refused(HEARTBEAT.replace("crc_extra=50", "crc_extra=51"), "CRC_EXTRA 50, published 51")
        self.refused(HEARTBEAT.replace("u8 type", "u8 typo"), "CRC_EXTRA")
        self.refused(HEARTBEAT.replace("u8 type", "i8 type"), "CRC_EXTRA")
        self.refused(HEARTBEAT.replace("length=9/9", "length=9/10"), "length 9/9")
        self.refused(HEARTBEAT.replace("    u8 base_mode\n", ""), "length 8/8")
        self.refused(HEARTBEAT.replace("u8 type", "u8[2] type"), "length 10/10")
        self.refused(HEARTBEAT.replace("    u32 custom_mode\n", "") + "    u32 custom_mode\n", "wire order")
        self.refused(HEARTBEAT.replace("u8 type", "u8 type extension"), "behind an extension")
        self.refused(HEARTBEAT.replace("u8 autopilot", "u8 type"), "two fields")
        self.refused(HEARTBEAT.replace("u8 type", "u9 type"), "unknown type")
        self.refused(HEARTBEAT.replace("u8 type", "u8[0] type"), "array length")
        self.refused(HEARTBEAT.replace("u8 type", "u8 type what"), "cannot read")
        self.refused(HEARTBEAT.replace("    u8 type", "    u8[250] type"), "do not fit")
        self.refused(HEARTBEAT + HEARTBEAT, "unique")
        self.refused("    u8 lost\n" + HEARTBEAT, "cannot read")


if __name__ == "__main__":
    unittest.main()
