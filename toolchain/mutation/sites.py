# SPDX-License-Identifier: BSD-3-Clause
"""Finds what to mutate: operators in clang's syntax tree (-ast-dump=json), so that a comment, a template bracket or a
macro is never taken for one.

A site is one operator in a function's body, with the text ranges of its operands and its mutants.
"""
import json
import pathlib
import pickle
import re
import shlex
import subprocess

CLANG = "clang++-14"
TREES = ("core", "firmware", "hal")  # all that is flashed, below root

# operator: (kind, function of mutation.hpp, mutants in its order)
RELATIONS = {
    "<": ("<", "less", ("<=", ">=")),
    "<=": ("<=", "less_equal", ("<", ">")),
    ">": (">", "greater", (">=", "<=")),
    ">=": (">=", "greater_equal", (">", "<")),
    "==": ("==", "equal", ("true", "false")),
    "!=": ("!=", "not_equal", ("true", "false")),
}
CONNECTIVES = {"&&": ("both", "both_of"), "||": ("either", "either_of")}
MEMBERS = {
    "cwiseMin": ("cwise_min", "without the bound"), "cwiseMax": ("cwise_max", "without the bound"),
    "minCoeff": ("min_coefficient", "maxCoeff"), "maxCoeff": ("max_coefficient", "minCoeff"),
    "min": ("array_min", "without the bound"), "max": ("array_max", "without the bound"),
}
CASTS = {"ImplicitCastExpr", "ParenExpr", "ExprWithCleanups", "MaterializeTemporaryExpr", "CXXBindTemporaryExpr"}
FUNCTIONS = {"FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXDestructorDecl", "CXXConversionDecl"}
NOT_RUN = {"StaticAssertDecl", "ConstantExpr", "CXXNoexceptExpr", "UnaryExprOrTypeTraitExpr", "CXXDefaultArgExpr",
           "CXXDefaultInitExpr", "TypeTraitExpr"}
REAL = {"float", "double"}
# What does something besides answering: spends a budget, writes a variable.
ACTS = re.compile(rb"\bbudget|\bspend\b|\+\+|--|(?<![=!<>])=(?!=)")
COMMENT = re.compile(rb"/\*.*?\*/|//[^\n]*", re.DOTALL)


class Site:
    """begin, end and operands are offsets in the file's bytes; `lazy`: the operands are passed as functions."""

    def __init__(self, file, function, begin, end, kind, call, operands, mutants, lazy=False, braces=False):
        self.file, self.function, self.begin, self.end = file, function, begin, end
        self.kind, self.call, self.operands, self.mutants = kind, call, operands, mutants
        self.lazy, self.braces = lazy, braces


class Finder:
    """Walks the tree of one translation unit. Locations leave out the file where it is that of the one before."""

    def __init__(self, wanted, texts):
        self.wanted, self.texts = wanted, texts  # {path as clang prints it: name}, {name: bytes}
        self.file = None
        self.sites, self.left_out, self.seen, self.passed_over = {}, {}, set(), set()

    def _place(self, location):
        """(file, offset, length), or None inside of a macro."""
        if not location:
            return None
        if "expansionLoc" in location or "spellingLoc" in location:
            for key, part in location.items():  # in printed order, for the file's sake
                if isinstance(part, dict) and "file" in part:
                    self.file = part["file"]
            return None
        self.file = location.get("file", self.file)
        self.seen.add(self.wanted.get(self.file))
        return (self.file, location["offset"], location["tokLen"]) if "offset" in location else None

    def annotate(self, node):
        """Resolves all locations, in printed order."""
        stack = [node]
        while stack:
            node = stack.pop()
            if not isinstance(node, dict):
                continue
            for key, part in list(node.items()):
                if key == "loc":
                    self._place(part)
                elif key == "range":
                    begin, end = self._place(part.get("begin")), self._place(part.get("end"))
                    whole = begin and end and begin[0] == end[0]
                    node["span"] = (begin[0], begin[1], end[1] + end[2]) if whole else None
            stack.extend(reversed(node.get("inner", [])))

    # Trees

    def walk(self, node, function=None, constant=False):
        kind = node.get("kind")
        if not kind or kind in NOT_RUN:
            return
        if kind in FUNCTIONS:
            if function is None or kind != "CXXMethodDecl" or node.get("name") != "operator()":
                function = node.get("name")
            constant = bool(node.get("constexpr"))
            for part in node.get("inner", []):
                if part.get("kind") in ("CompoundStmt", "CXXCtorInitializer", "CXXTryStmt"):
                    self.walk(part, function, constant)
            return
        if kind == "VarDecl" and node.get("constexpr"):
            return
        if function is not None:
            self.look(node, function, constant)
        parts = node.get("inner", [])
        if kind == "CXXForRangeStmt":  # the rest is made up by the compiler
            parts = [parts[1], parts[-1]]
        elif kind == "ForStmt":
            counter = {part.get("id") for part in parts[0].get("inner", [])} if parts[0] else set()
            self.pass_over_counters(parts[2], counter)
        elif kind == "IfStmt" and node.get("isConstexpr"):
            parts = parts[1:]
        for part in parts:
            self.walk(part, function, constant)

    @staticmethod
    def stripped(node):
        while node.get("kind") in CASTS and len(node.get("inner", [])) == 1:
            node = node["inner"][0]
        return node

    def pass_over_counters(self, condition, counter):
        """Passes over what compares a variable of the for loop itself, or one step beside it, in its condition."""
        condition = self.stripped(condition)
        if condition.get("opcode") in CONNECTIVES:
            for part in condition["inner"]:
                self.pass_over_counters(part, counter)
        elif condition.get("kind") in ("BinaryOperator", "CXXOperatorCallExpr"):
            if any(self.is_counter(operand, counter) for operand in condition["inner"]):
                self.count("loop counters", condition)
                self.passed_over.add(condition.get("id"))

    def is_counter(self, node, counter):
        node = self.stripped(node)
        if node.get("kind") == "BinaryOperator" and node.get("opcode") in ("+", "-"):
            return any(self.is_counter(operand, counter) for operand in node["inner"])
        return node.get("kind") == "DeclRefExpr" and node.get("referencedDecl", {}).get("id") in counter

    def count(self, why, node):
        if node.get("span") and node["span"][0] in self.wanted:
            self.left_out.setdefault(why, set()).add((self.wanted[node["span"][0]], node["span"][1]))

    # Sites

    def look(self, node, function, constant):
        kind = node["kind"]
        inner = node.get("inner", [])
        if node.get("id") in self.passed_over:
            return
        if kind in ("BinaryOperator", "CXXOperatorCallExpr"):
            self.look_at_operator(node, function, constant)
        elif kind == "UnaryOperator" and node.get("opcode") == "!":
            self.add(node, function, constant, "!", "negation", inner, ("negation dropped",))
        elif kind == "UnaryOperator" and node.get("opcode") == "-" and self.type_of(node) in REAL:
            self.add(node, function, constant, "unary -", "minus", inner, ("sign dropped",))
        elif kind in ("IfStmt", "WhileStmt", "ConditionalOperator"):
            place = bool(node.get("hasInit"))
            if node.get("hasVar"):
                self.count("conditions that declare", node)
            elif not node.get("isConstexpr") and place < len(inner):
                self.look_at_condition(inner[place], function, constant)
        elif kind == "CallExpr":
            self.look_at_call(node, function, constant)
        elif kind == "CXXMemberCallExpr":
            self.look_at_member(node, function, constant)

    @staticmethod
    def type_of(node):
        kind = node.get("type", {})
        return kind.get("desugaredQualType", kind.get("qualType", "")).replace("const ", "")

    def look_at_operator(self, node, function, constant):
        operands, operator = node["inner"], node.get("opcode")
        built_in = node["kind"] == "BinaryOperator"
        if not built_in:
            callee = self.stripped(operands[0])
            operator = callee.get("referencedDecl", {}).get("name", "").removeprefix("operator")
            operands = operands[1:]
        if operator in RELATIONS and len(operands) == 2:
            kind, call, mutants = RELATIONS[operator]
            self.add(node, function, constant, kind, call, operands, mutants, operator)
        elif operator in CONNECTIVES and len(operands) == 2:
            call = CONNECTIVES[operator][0 if built_in else 1]
            if built_in and self.acts(node):
                call += "_acting"
            self.add(node, function, constant, operator, call, operands, ("left alone", "right alone"), operator, built_in)
        elif operator == "-" and len(operands) == 1:
            self.add(node, function, constant, "unary -", "minus", operands, ("sign dropped",))
        elif built_in and operator in "+-" and self.type_of(node) in REAL:
            call = "sum" if operator == "+" else "difference"
            self.add(node, function, constant, "binary + -", call, operands, ("-" if operator == "+" else "+",), operator)

    def acts(self, node):
        span = node.get("span")
        return bool(span and span[0] in self.wanted and ACTS.search(self.texts[self.wanted[span[0]]], span[1], span[2]))

    def look_at_condition(self, node, function, constant):
        plain = self.stripped(node)
        if plain.get("kind") in ("CallExpr", "CXXMemberCallExpr", "DeclRefExpr", "MemberExpr"):
            if self.type_of(node) in ("bool", "_Bool"):
                self.add(plain, function, constant, "condition", "condition", [plain], ("true", "false"))

    def look_at_call(self, node, function, constant):
        callee, arguments = self.stripped(node["inner"][0]), node["inner"][1:]
        span = callee.get("span")
        if not span or span[0] not in self.wanted:
            return
        name = self.texts[self.wanted[span[0]]][span[1]:span[2]].decode()
        if name in ("std::min", "std::max") and len(arguments) == 2:
            self.add(node, function, constant, "min max clamp", name[5:], arguments, ("first alone", "second alone"))
        elif name in ("std::min", "std::max") and len(arguments) == 1:
            elements = self.elements_of(arguments[0])
            self.add(node, function, constant, "min max clamp", name[5:], elements,
                     tuple(f"without element {i + 1}" for i in range(len(elements))), braces=True)
        elif name == "std::clamp" and len(arguments) == 3:
            self.add(node, function, constant, "min max clamp", "clamp", arguments, ("without lower", "without upper"))
        elif name == "std::abs" and len(arguments) == 1 and self.type_of(node) in REAL:
            self.add(node, function, constant, "abs", "magnitude", arguments, ("magnitude dropped",))

    def elements_of(self, node):
        while node.get("kind") != "InitListExpr":
            node = node["inner"][0]
        return node["inner"]

    def look_at_member(self, node, function, constant):
        callee, arguments = node["inner"][0], node["inner"][1:]
        name = callee.get("name", "")
        if callee.get("kind") != "MemberExpr" or name not in MEMBERS or not callee.get("inner"):
            return
        call, mutant = MEMBERS[name]
        if len(arguments) == (0 if "Coeff" in name else 1):
            self.add(node, function, constant, "min max clamp", call, [callee["inner"][0], *arguments], (mutant,))

    def add(self, node, function, constant, kind, call, operands, mutants, operator=None, lazy=False, braces=False):
        span, spans = node.get("span"), [part.get("span") for part in operands]
        if not span or span[0] not in self.wanted:
            return
        if constant:
            self.count("constexpr functions", node)
            return
        file = self.wanted[span[0]]
        text = self.texts[file]
        if not all(s and s[0] == span[0] and span[1] <= s[1] < s[2] <= span[2] for s in spans):
            self.count("not to be rewritten (macro)", node)
            return
        ranges = [s[1:] for s in spans]
        if operator is not None and COMMENT.sub(b"", text[ranges[0][1]:ranges[1][0]]).strip().decode() != operator:
            self.count("not to be rewritten (written otherwise)", node)
            return
        self.sites.setdefault((file, span[1], span[2]),
                              Site(file, function, span[1], span[2], kind, call, ranges, mutants, lazy, braces))


def documents(text):
    decoder, at = json.JSONDecoder(), 0
    while at < len(text):
        document, at = decoder.raw_decode(text, at)
        yield document
        while at < len(text) and text[at].isspace():
            at += 1


def find(root, files, flags, namespace):
    """Sites of `files` (names below root), by name and place, and what was left out: {why: count}."""
    texts = {name: (root / name).read_bytes() for name in files}
    wanted = {str(root / name): name for name in files}
    sites, left_out, seen = {}, {}, set()
    for unit in sorted(files, key=lambda name: (not name.endswith(".cpp"), name)):
        if unit in seen:  # a header, by way of a source
            continue
        command = [CLANG, *flags, "-fsyntax-only", "-Xclang", "-ast-dump=json", "-Xclang",
                   f"-ast-dump-filter={namespace}", str(root / unit)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"mutate: {shlex.join(command)}\n{done.stderr}")
        finder = Finder(wanted, texts)
        trees = list(documents(done.stdout))
        for tree in trees:
            finder.annotate(tree)
        seen.update(finder.seen)
        for tree in trees:
            finder.walk(tree)
        for key, site in finder.sites.items():
            sites.setdefault(key, site)
        for why, places in finder.left_out.items():
            left_out.setdefault(why, set()).update(places)
    ordered = [sites[key] for key in sorted(sites, key=lambda k: (k[0], k[1], -k[2]))]
    return ordered, {why: len(places) for why, places in sorted(left_out.items())}


def folder_of(root, room):
    """The folder of a room, below root; None where there is none."""
    return next((name for name in (f"core/{room}", f"firmware/{room}", room) if room and (root / name).is_dir()), None)


def folders_needed(root, folders):
    """Folders, below root, of what the sources in `folders` and in those folders themselves include."""
    needed, todo = set(), list(folders)
    include = re.compile(rf'^#include "((?:{"|".join(TREES)})(?:/\w+)*)/\w+\.hpp"', re.MULTILINE)
    while todo:
        for path in sorted(todo.pop().glob("*.?pp")):
            for folder in include.findall(path.read_text()):
                if folder not in needed:
                    needed.add(folder)
                    todo.append(root / folder)
    return sorted(needed)


def cached(path, key, compute):
    """What `compute` gives, from the file where it is of the same `key`: clang takes half a minute for all of it."""
    if path.exists():
        with path.open("rb") as file:
            old, value = pickle.load(file)
        if old == key:
            return value
    value = compute()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps((key, value)))
    return value


def sources(root, folders):
    """Names of the sources of `folders`, below root."""
    names = [p.relative_to(root) for folder in folders for p in sorted((root / folder).iterdir())]
    return [str(pathlib.PurePosixPath(n)) for n in names if n.suffix in (".cpp", ".hpp")]
