#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""words.py finds the refused words that are planted in comments and names, and nothing in strings or where excused."""
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

sys.dont_write_bytecode = True
TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "toolchain/checks"))
import words  # noqa: E402


class Words(unittest.TestCase):
    def lines(self, text, name="one.cpp"):
        return [line for line, _ in words.complaints_of(name, text)]

    def test_comments(self):
        for text, wanted in (("// The last rung.\n", [1]), ("int a;  ///< what is told\n", [1]), ("/* One.\n * A ball. */\n", [2]),
                             ("/// Two in\n/// a row.\n", [1]), ("// Mushrooms, `room`, a-room.\n", []), ("// The method.\n", [])):
            with self.subTest(text=text):
                self.assertEqual(self.lines(text), wanted)

    def test_names(self):
        for text, wanted in (("\nint ball_radius;\n", [2]), ("class LastRung;\n", [1]), ("int kMostBalls;\n", [1, 1]), ("int kMostly, balloon;\n", []),
                             ("int kLeast;\n", [1]), ("int told_;\n", [1])):
            with self.subTest(text=text):
                self.assertEqual(self.lines(text), wanted)

    def test_strings_are_not_checked(self):
        for text in ('f("ball, told");\n', 'f("// ball");\n', 'f("a \\" ball");\n', 'f(R"(ball "told")");\n', "f('\"'); g(\"ball\");\n"):
            with self.subTest(text=text):
                self.assertEqual(self.lines(text), [])
        self.assertEqual(self.lines('f("one");  // ball\n'), [1])
        self.assertEqual(self.lines('f("one", ball);\n'), [1])

    def test_an_excuse_holds_for_its_word_in_its_files(self):
        with mock.patch.object(words, "EXCUSED", {("a/*.cpp", "echo"): "a terminal's"}):
            self.assertEqual(self.lines("// echo\nint echo;\n", "a/one.cpp"), [])
            self.assertEqual(self.lines("// told\n// echoes\n", "a/one.cpp"), [1, 2])
            self.assertEqual(self.lines("// echo\n", "b/one.cpp"), [1])

    def test_excuses_are_needed(self):
        for files, word in words.EXCUSED:
            found = [f for f in TOP.glob(files) if any(word.lower() in what.lower() for _, what in self.unexcused(f))]
            self.assertTrue(found, f"{word} in {files}")

    def unexcused(self, file):
        with mock.patch.object(words, "EXCUSED", {}):
            return list(words.complaints_of(str(file.relative_to(TOP)), file.read_text(encoding="utf-8")))

    def test_the_exit_status_says_whether_there_is_one(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["git", "init", "-q", folder], check=True)
            for text, wanted in (("// A sphere.\n", 0), ("// A ball.\n", 1)):
                (pathlib.Path(folder) / "one.hpp").write_text(text)
                command = [sys.executable, "-B", str(TOP / "toolchain/checks/words.py"), "--top", folder]
                self.assertEqual(subprocess.run(command, capture_output=True, check=False).returncode, wanted)


if __name__ == "__main__":
    unittest.main()
