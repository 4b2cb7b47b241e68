#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether toolchain/checks/figures finds errors: on copies of the tree with one change at a time."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import types
import unittest

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "toolchain/checks"))
sys.dont_write_bytecode = True
import figures_check  # noqa: E402
import figures_digest  # noqa: E402
import figures_pages  # noqa: E402
import figures_registry  # noqa: E402
import figures_run  # noqa: E402

COPIED = ("README.md", "CONTRIBUTING.md", "CMakeLists.txt", "CMakePresets.json", "docs", "core", "firmware", "hal", "tests/checks", "tests/flight_log",
          "tests/timing", "tests/target", "tests/scenario", "tests/replay", "tests/property", "tests/unit", "tests/mutation", "toolchain")
DIGIT = re.compile(r"\d")


def other(token):
    """The token with its last digit of the mantissa changed."""
    mantissa, exponent, rest = token.partition("e")
    place = max(m.start() for m in DIGIT.finditer(mantissa))
    return mantissa[:place] + str((int(mantissa[place]) + 5) % 10) + mantissa[place + 1:] + exponent + rest


def texts(problems):
    return {str(p) for p in problems}


class CampaignOfOtherSources(unittest.TestCase):
    """Results of an earlier run of other sources are restarted; every other failure stays a failure."""

    def run_with(self, script):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "out").mkdir()
            (folder / "out/old").touch()
            command = types.SimpleNamespace(name="campaign", run=script, status=(0,), in_tree=False)
            return figures_run.run_again(command, TOP, folder, folder)[0]

    def test_begun_anew(self):
        script = "if [ -e out/old ]; then echo 'out belongs to another set-up: x'; exit 2; fi; echo fresh"
        self.assertEqual(self.run_with(script), "fresh\n")
        goes_on = "{ [ ! -e out/old ] || { echo 'out belongs to another set-up: x'; false; }; } || true; [ -e out/old ] || echo fresh"
        self.assertEqual(self.run_with(goes_on), "fresh\n")

    def test_other_failures_stay(self):
        with self.assertRaises(figures_run.Failed):
            self.run_with("[ ! -e out/old ] || echo 'disk full'; exit 2")
        with self.assertRaises(figures_run.Failed):
            self.run_with("echo 'out belongs to another set-up: x'; exit 2")


class OnACopy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.top = pathlib.Path(cls.folder.name)
        for name in COPIED:
            source = TOP / name
            (cls.top / name).parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, cls.top / name, dirs_exist_ok=True, ignore=shutil.ignore_patterns("build", "__pycache__", "node_modules"))
            elif source.exists():
                shutil.copy(source, cls.top / name)
        cls.before = texts(figures_check.Book(cls.top).all())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def found_after_all(self, texts):
        """Findings with these files changed (name: text) that were not found before."""
        kept = {name: (self.top / name).read_bytes() for name in texts}
        try:
            for name, text in texts.items():
                (self.top / name).write_text(text, encoding="utf-8")
            return [p for p in figures_check.Book(self.top).all() if str(p) not in self.before]
        finally:
            for name, before in kept.items():
                (self.top / name).write_bytes(before)

    def found_after(self, name, text):
        return self.found_after_all({name: text})

    def wants(self, page, begin, end, what):
        text = page.text[:begin] + other(page.text[begin:end]) + page.text[end:]
        found = self.found_after(page.name, text)
        self.assertTrue(any(p.page == page.name and p.line == page.line(begin) for p in found),
                        f"{page.name}:{page.line(begin)}: a changed {what} was not found: {page.text[begin:end]}: {texts(found)}")

    def test_a_changed_figure_of_each_command_on_each_page_is_found(self):
        book = figures_check.Book(self.top)
        done = set()
        for command in book.registry.commands.values():
            for figure in command.figures:
                places = book.found[command.name, figure.key]
                kind = (figure.page, command.kind, "block" if figure.block is not None else "json" if figure.json else "text")
                if kind in done or not places or (command.kind != "record" and command.name not in book.lock.commands):
                    continue
                done.add(kind)
                page = book.pages[figure.page]
                begin, end = places[-1][-1]
                if figure.block is not None:
                    last = [m for m in re.finditer(r"\d+(\.\d+)?", page.text[begin:end])][-1]
                    begin, end = begin + last.start(), begin + last.end()
                with self.subTest(page=figure.page, command=command.name):
                    self.wants(page, begin, end, f"figure of {command.name}")
        self.assertGreater(len(done), 3)

    def test_a_changed_sealed_number_on_each_page_is_found(self):
        book = figures_check.Book(self.top)
        changed, lines = {}, {}
        for page in book.pages.values():
            left = figures_pages.tokens(page, book.covered(page.name))
            if not left:
                continue
            line = left[len(left) // 2][1]
            begin, end = next(m.span() for m in figures_pages.TOKEN.finditer(page.text) if page.line(m.start()) == line and
                              not any(b <= m.start() < e for b, e in book.covered(page.name)))
            changed[page.name] = page.text[:begin] + other(page.text[begin:end]) + page.text[end:]
            lines[page.name] = line
        self.assertGreater(len(changed), 20)
        found = self.found_after_all(changed)
        for name, line in lines.items():
            with self.subTest(page=name):
                self.assertTrue(any(p.page == name and p.line == line for p in found), f"{name}:{line}: {texts(found)}")

    def test_a_changed_number_of_a_generated_page_is_found(self):
        book = figures_check.Book(self.top)
        for command in book.registry.commands.values():
            if command.render:
                page = book.pages[command.pages[0]]
                part = figures_pages.GENERATED.search(page.text)
                numbers = list(re.finditer(r"\d+", part[0]))
                found = numbers[len(numbers) // 2]
                with self.subTest(page=page.name):
                    self.wants(page, part.start() + found.start(), part.start() + found.end(), "number of the generated part")

    def evidence(self):
        return [c for c in figures_check.Book(self.top).registry.commands.values() if c.kind in ("long", "record") and not c.dated]

    def fresh(self):
        """The lock with every evidence recorded on the sources as they are."""
        book = figures_check.Book(self.top)
        for command in self.evidence():
            if command.kind == "long":
                book.lock.commands.setdefault(command.name, {"values": {}})["digest"] = figures_digest.of_sources(self.top, command.sources)
        return book.lock

    def states(self):
        book = figures_check.Book(self.top)
        return {c.name: book.state(c) for c in self.evidence() if c.kind == "long"}

    def test_evidence_of_changed_sources_is_refused_and_of_changed_comments_is_not(self):
        lock = self.top / figures_check.LOCK
        kept = lock.read_bytes()
        source = self.top / "core/base/work_budget.hpp"
        text = source.read_text(encoding="utf-8")
        try:
            self.fresh().write()
            self.assertEqual(set(self.states().values()), {"fresh"})
            source.write_text("/* another\n comment */\n" + text.replace("\n", "  // and another\n\n", 1).replace("{", "\n  {  ", 1), encoding="utf-8")
            self.assertEqual(set(self.states().values()), {"fresh"}, "a comment is no change")
            source.write_text(text + "\nint changed = 1;\n", encoding="utf-8")
            for name, state in self.states().items():
                with self.subTest(command=name):
                    globs = figures_check.Book(self.top).registry.commands[name].sources
                    self.assertEqual(state, "stale" if source in figures_digest.files(self.top, globs) else "fresh")
            book = figures_check.Book(self.top)
            refused = [p for p in book.evidence() if "recorded on other code" in p.text]
            self.assertTrue(refused, "stale evidence is an error")
        finally:
            lock.write_bytes(kept)
            source.write_text(text, encoding="utf-8")

    def test_what_the_witness_holds_stays_while_it_prints_the_same(self):
        lock, source = self.top / figures_check.LOCK, self.top / "core/base/work_budget.hpp"
        kept, text = lock.read_bytes(), source.read_text(encoding="utf-8")

        def witness(printed):
            book = figures_check.Book(self.top)
            book.lock.witness = {"digest": book.digest(book.registry.witness), "printed": printed}
            book.lock.write()

        try:
            self.fresh().write()
            witness(["flights: 1", "plans: 2"])
            book = figures_check.Book(self.top)
            held = {c.name for c in self.evidence() if c.witnessed}
            self.assertTrue(held)
            for name in held:
                book.lock.commands[name]["witness"] = book.witness_of(book.registry.commands[name])
            book.lock.write()
            self.assertEqual(set(self.states().values()), {"fresh"})

            source.write_text(text + "\nint changed = 1;\n", encoding="utf-8")
            self.assertNotIn("as before", self.states().values(), "the witness has not been run on these sources")
            witness(["flights: 1", "plans: 2"])
            for name, state in self.states().items():
                self.assertIn(state, ("as before",) if name in held else ("stale", "fresh"), name)
            self.assertFalse([p for p in figures_check.Book(self.top).evidence() if any(p.text.startswith(f"{n}: recorded on") for n in held)])
            witness(["flights: 1", "plans: 3"])
            self.assertEqual({self.states()[name] for name in held}, {"stale"}, "the witness prints something else")
        finally:
            lock.write_bytes(kept)
            source.write_text(text, encoding="utf-8")

    def test_a_command_cannot_be_held_by_a_witness_that_is_not_there(self):
        registry = self.top / figures_registry.FILE
        kept = registry.read_text(encoding="utf-8")
        try:
            registry.write_text(re.sub(r"\[witness\]\nrun = .*\nsources = .*\n", "", kept), encoding="utf-8")
            with self.assertRaises(figures_registry.Wrong):
                figures_registry.Registry(self.top)
        finally:
            registry.write_text(kept, encoding="utf-8")

    def test_an_unknown_command_on_each_page_is_found(self):
        pages = figures_check.Book(self.top).pages.values()
        for block in ("```sh\nflies --fast    # a comment\n```\n", "```\njink fly \\\n    faster\n```\n"):
            found = self.found_after_all({page.name: page.text + "\n" + block for page in pages})
            unknown = [p.page for p in found if "does not know the command" in p.text]
            self.assertEqual(sorted(unknown), sorted(page.name for page in pages))

    def test_a_dated_figure_is_refused_where_the_page_does_not_show_its_commit(self):
        book = figures_check.Book(self.top)
        dated = [c for c in book.registry.commands.values() if c.dated]
        self.assertTrue(dated)
        changed = {}
        for command in dated:
            page = command.figures[0].page
            changed[page] = changed.get(page, book.pages[page].text).replace(f"commit {command.commit}", "some commit")
        found = self.found_after_all(changed)
        for command in dated:
            self.assertTrue(any(f"{command.name}: the page does not say that it was recorded on commit" in p.text for p in found), command.name)

    def test_only_numbers_that_belong_to_no_command_can_be_sealed(self):
        book = figures_check.Book(self.top)
        command, figure = next((c, f) for c in book.registry.commands.values() for f in c.figures if f.page == "README.md" and c.kind == "quick")
        page = book.pages["README.md"]
        (begin, end), lock = book.found[command.name, figure.key][0][0], self.top / figures_check.LOCK
        kept = lock.read_bytes()
        seal = [sys.executable, str(TOP / "toolchain/checks/figures"), "--top", str(self.top), "--seal", "README.md"]
        try:
            (self.top / "README.md").write_text(page.text[:begin] + other(page.text[begin:end]) + page.text[end:], encoding="utf-8")
            done = subprocess.run(seal, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("belong to commands", done.stdout)
            (self.top / "README.md").write_text(page.text + "\nA number: 4711\n", encoding="utf-8")
            done = subprocess.run(seal, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIn("nothing was sealed, 4711 stands", done.stdout)
            self.assertFalse([p for p in figures_check.Book(self.top).seals() if p.page == "README.md"])
        finally:
            (self.top / "README.md").write_text(page.text, encoding="utf-8")
            lock.write_bytes(kept)

    def test_a_command_that_no_page_gives_any_more_is_found(self):
        page = figures_check.Book(self.top).pages["docs/evidence/closed_loop.md"]
        found = self.found_after(page.name, page.text.replace("--seed 2000 --quiet", "--seed 2001 --quiet"))
        self.assertTrue(any("does not give the command" in p.text for p in found))
        self.assertTrue(any("does not know the command" in p.text for p in found))


class Parts(unittest.TestCase):
    def test_rounding(self):
        for token, printed, scale, wanted in (("9.1", "9356", "1/1024", True), ("9.2", "9356", "1/1024", False), ("98 172", "98172", 1, True),
                                              ("5,026,471", "5026471", 1, True), ("1.1e-5", "1.10931e-05", 1, True), ("1.2e-5", "1.10931e-05", 1, False),
                                              ("-0.48", "-0.485", 1, True), ("0.48", "-0.485", 1, False), ("196", "195.6", 1, True), ("0", "0.4", 1, True)):
            figure = figures_registry.Figure("test", "page", {"text": "{}", "printed": "(.)", "scale": scale})
            with self.subTest(token=token, printed=printed):
                self.assertEqual(figures_pages.agrees(token, printed, figure.scale_of(0)), wanted)
                put = figures_pages.written(token, printed, figure.scale_of(0))
                self.assertTrue(figures_pages.agrees(put, printed, figure.scale_of(0)), put)

    def test_comments_and_white_space_do_not_count(self):
        plain = figures_digest.plain_cpp
        same = ["int a = f(1, 'x');\n#define B 2\nint c;", "// what\nint a=f( 1,'x' ) ; /* more */\n\n#define B 2 // why\nint\nc;"]
        self.assertEqual(plain(same[0]), plain(same[1]))
        for one, two in (("int a = 1;", "int a = 2;"), ('"// no comment"', '"// another"'), ("a b", "ab"), ("1e-4F", "1e-5F"),
                         ("#define A 1\nB", "#define A 1 B"), ("R\"(/* kept */)\"", "R\"(/* other */)\"")):
            self.assertNotEqual(plain(one), plain(two), (one, two))

    def test_dated_is_for_long_commands_that_name_their_commit(self):
        for entry in ({"minutes": 2, "commit": "abc"}, {"minutes": 50}, {"minutes": 50, "commit": "abc", "kind": "quick"}):
            with self.assertRaises(figures_registry.Wrong):
                figures_registry.Command("name", {"kind": "long", "dated": True, "sources": ["core/**"], **entry}, {})


if __name__ == "__main__":
    unittest.main()
