#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""toolchain/mutation/mutate on a few lines with known gaps in their tests: usage: self_test.py FOLDER (to build in)."""
import pathlib
import shutil
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
MUTATE = HERE.parent.parent / "toolchain/mutation/mutate"
FOLDER = pathlib.Path()

# Nothing of a constant, a default value, an assertion, a comment, a template argument or a loop's counter.
FOUND = """
is_within | x >= limits.low | >= -> >
is_within | x >= limits.low | >= -> <
is_within | !(x > limits.high) | ! -> negation dropped
is_within | x > limits.high | > -> >=
is_within | x > limits.high | > -> <=
is_within | x >= limits.low /* not x > low */ && !(x > limits.high) | && -> left alone
is_within | x >= limits.low /* not x > low */ && !(x > limits.high) | && -> right alone
limited | std::clamp(x, limits.low, std::max(limits.high, 0.0F)) | min max clamp -> without lower
limited | std::clamp(x, limits.low, std::max(limits.high, 0.0F)) | min max clamp -> without upper
limited | std::max(limits.high, 0.0F) | min max clamp -> first alone
limited | std::max(limits.high, 0.0F) | min max clamp -> second alone
least | std::min(found, of[i]) | min max clamp -> first alone
least | std::min(found, of[i]) | min max clamp -> second alone
steps_to | x > 0.0F | > -> >=
steps_to | x > 0.0F | > -> <=
steps_to | x - step | binary + - -> +
is_far | is_low | condition -> true
is_far | is_low | condition -> false
is_far | std::abs(x) > kStep || -x == kStep || !kIsNear | || -> left alone
is_far | std::abs(x) > kStep || -x == kStep || !kIsNear | || -> right alone
is_far | std::abs(x) > kStep || -x == kStep | || -> left alone
is_far | std::abs(x) > kStep || -x == kStep | || -> right alone
is_far | std::abs(x) > kStep | > -> >=
is_far | std::abs(x) > kStep | > -> <=
is_far | std::abs(x) | abs -> magnitude dropped
is_far | -x == kStep | == -> true
is_far | -x == kStep | == -> false
is_far | -x | unary - -> sign dropped
is_far | !kIsNear | ! -> negation dropped
is_below | x < limits.low | < -> <=
is_below | x < limits.low | < -> >=
"""
# The gaps: at the upper limit; a maximum below 0.
GAPS = """
is_within | x > limits.high | > -> >=
limited | std::max(limits.high, 0.0F) | min max clamp -> first alone
"""
# Mutants that no test can detect: kIsNear is always true, so that its operand may be dropped; values below the lower
# limit are far by their magnitude as well.
NO_DIFFERENCE = """
is_far | is_low | condition -> false
is_below | x < limits.low | < -> <=
is_far | std::abs(x) > kStep || -x == kStep || !kIsNear | || -> left alone
"""


def keys(text):
    """Whole keys of the lines above."""
    return {f"core/bound/bound.{'hpp' if line.startswith('is_below') else 'cpp'} | {line} | 1" for line in text.split("\n") if line}


def mutate(*more):
    return subprocess.run([MUTATE, "--root", FOLDER, "--rooms", "bound", "--above", "", "--jobs", "1", *more],
                          capture_output=True, text=True)


def survivors(printed):
    """{key: what it was called} of a run's output."""
    lines = [line.split(None, 1) if not line.startswith("  NOT") else ["NOT LISTED", line[len("  NOT LISTED"):].strip()]
             for line in printed.splitlines() if line.startswith("  ")]
    return {rest.rsplit("  (line", 1)[0]: called for called, rest in lines}


class SelfTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for part in ("core", "tests"):
            # With new time stamps: files changed by the previous run are rebuilt.
            shutil.copytree(HERE / "fixture" / part, FOLDER / part, dirs_exist_ok=True, copy_function=shutil.copy)
        cls.lists = FOLDER / "tests/mutation"
        cls.lists.mkdir(parents=True, exist_ok=True)
        for path in cls.lists.glob("*.txt"):
            path.unlink()

    def lines_of_list(self):
        return {line.split(None, 1)[1] for line in mutate("--list").stdout.splitlines()}

    def test_1_finds_the_operators_and_nothing_else(self):
        self.assertEqual(self.lines_of_list(), keys(FOUND))
        self.assertEqual(len(mutate("--list").stdout.splitlines()), len(keys(FOUND)))

    def test_2_reports_the_gaps_and_kills_the_rest(self):
        done = mutate("--check")
        found = survivors(done.stdout)
        self.assertTrue(keys(GAPS) <= set(found), done.stdout + done.stderr)
        self.assertEqual(set(found), keys(GAPS) | keys(NO_DIFFERENCE), done.stdout)
        self.assertEqual(set(found.values()), {"NOT LISTED"})
        self.assertEqual(done.returncode, 1)
        self.assertIn("a hang 1", done.stdout)
        self.assertIn("left out: 1 constexpr functions, 1 loop counters", done.stderr)

    def test_3_takes_known_survivors_with_a_reason_or_on_the_list(self):
        self.assertEqual(mutate("--write-survivors").returncode, 0)
        self.assertEqual(mutate("--check").returncode, 0)
        (self.lists / "equivalent.txt").write_text("".join(f"{key}\n" for key in keys(NO_DIFFERENCE)) + "    constant\n")
        mutate("--write-survivors")
        listed = [line for line in (self.lists / "survivors.txt").read_text().splitlines() if not line.startswith("#")]
        self.assertEqual(set(listed), keys(GAPS))
        done = mutate("--check")
        self.assertEqual(done.returncode, 0)
        self.assertEqual({survivors(done.stdout)[key] for key in keys(NO_DIFFERENCE)}, {"equivalent"})

    def test_4_complains_of_a_line_that_is_no_survivor(self):
        killed = sorted(keys(FOUND) - keys(GAPS) - keys(NO_DIFFERENCE))[0]
        (self.lists / "survivors.txt").write_text("\n".join([*keys(GAPS), killed, "core/bound/bound.cpp | gone"]))
        done = mutate("--check")
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"is listed and killed: {killed}", done.stderr)
        self.assertIn("is listed and does not exist: core/bound/bound.cpp | gone", done.stderr)
        # Any sample reports the latter too.
        done = mutate("--check", "--sample", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("is listed and does not exist: core/bound/bound.cpp | gone", done.stderr)

    def test_5_draws_the_same_sample_twice(self):
        one, two, other = (mutate("--list", "--sample", "5", "--seed", seed).stdout for seed in ("7", "7", "8"))
        self.assertEqual(len(one.splitlines()), 5)
        self.assertEqual(one, two)
        self.assertNotEqual(one, other)

    def test_6_refuses_what_it_cannot_do(self):
        (self.lists / "equivalent.txt").write_text("core/bound/bound.cpp | without a reason\n")
        for wrong in (["--sample", "0"], ["--only", "nowhere"], ["--rooms", "nowhere"], ["--unknown"],
                      ["--write-survivors", "--sample", "3"], ["--check"]):
            done = mutate(*wrong)
            self.assertEqual((wrong, done.returncode), (wrong, 2), done.stderr)
            self.assertNotEqual(done.stderr, "")
        (self.lists / "equivalent.txt").unlink()

    def test_7_refuses_tests_that_fail_as_they_are(self):
        test = FOLDER / "tests/unit/core/bound/bound_test.cpp"
        whole = test.read_text()
        test.write_text(whole.replace("EXPECT_EQ(least(rising), 1.0F)", "EXPECT_EQ(least(rising), 2.0F)"))
        try:
            done = mutate()
        finally:
            test.write_text(whole)
        self.assertEqual(done.returncode, 1)
        self.assertIn("tests fail without a mutant:\n  unit_bound.Least.IsFoundAnywhere: failed", done.stderr)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        sys.exit(0 if "--help" in sys.argv or "-h" in sys.argv else 2)
    FOLDER = pathlib.Path(sys.argv.pop()).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(verbosity=2)
