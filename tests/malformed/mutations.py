# SPDX-License-Identifier: BSD-3-Clause
"""What can be wrong with a file, for files of any format.

A damage is (name, content, line): content is bytes, or a function that makes whatever lies at a path; line is the one
that a complaint has to name, 0 where it is about the whole file, None where any place will do.
"""
import os
import random

LARGE = 8 << 20  # more than any reader of ours takes at once


def directory(path):
    os.mkdir(path)


def fifo(path):
    os.mkfifo(path)


def device(path):
    os.symlink("/dev/null", path)


def loop(path):
    os.symlink(path, path)


def sparse(path):
    with open(path, "wb") as file:
        file.truncate(LARGE)


def nothing(_):
    """No file at all."""


def of_any_file(good):
    """Damages that need no knowledge of the format."""
    noise = random.Random(1)
    yield "missing", nothing, 0
    yield "a directory", directory, 0
    yield "a FIFO without a writer", fifo, 0
    yield "a device", device, 0
    yield "a loop of links", loop, 0
    yield "empty", b"", None
    yield "8 MiB of zeros", sparse, None
    yield "noise", bytes(noise.randrange(256) for _ in range(4096)), None
    yield "zero bytes", bytes(4096), None
    yield "text of another kind", b"<html><body>404</body></html>\n", None


def line_of(text, part):
    return text[: text.index(part)].count("\n") + 1


def of_text(good):
    """Damages of a text."""
    text = good.decode()
    yield "UTF-16", text.encode("utf-16"), None
    yield "UTF-16 without a mark", text.encode("utf-16-le"), None
    yield "a zero byte inside", good[: len(good) // 2] + b"\0" + good[len(good) // 2 :], None
    yield "a line of 100 kB", good + b"x" * 100_000 + b"\n", text.count("\n") + 1
    yield "trailing noise", good + b"\x01\x02 ]] }} \xff\xfe\n", text.count("\n") + 1
    yield "another text behind", good + b"<html>\n", text.count("\n") + 1


def of_yaml(good, number, key, required):
    """Damages of a YAML file.

    number    a line `key: value` at the top whose value has to be a number in some range
    key       its key
    required  a line that must not be missing
    """
    text = good.decode()
    place = line_of(text, number)

    def with_value(value):
        return text.replace(number, f"{key}: {value}").encode(), place

    for name, value in {
        "a text in place of a number": "fast", "NaN": ".nan", "nan": "nan", "infinity": ".inf", "minus infinity": "-.inf",
        "too large for a float": "1e39", "too large for a double": "1e999", "out of range": "1e30", "below the range": "-1e30",
        "a unit behind": "5 m/s", "two numbers": "5 6", "a list": "[5]", "a mapping": "{a: 5}", "nothing": "", "null": "~",
        "hexadecimal": "0x10", "underscores": "1_000", "a decimal comma": "5,5", "a boolean": "true", "a quoted text": "'5 '",
        "2000 digits": "9" * 2000, "a tag": "!!binary 5", "a thousandfold list": "[" + "5, " * 1000 + "5]",
    }.items():
        yield name, *with_value(value)
    yield "a key twice", good + f"{number}\n".encode(), text.count("\n") + 1
    yield "an unknown key", good + b"no_such_key: 1\n", text.count("\n") + 1
    yield "a misspelt key", text.replace(number, number.replace(key, key[:-1] + "_")).encode(), None
    yield "a number as a key", good + b"5: 1\n", text.count("\n") + 1
    yield "a list as a key", good + b"? [a, b]\n: 1\n", text.count("\n") + 1
    yield "a missing key", text.replace(required, "").encode(), None
    yield "a remark that is no UTF-8", good + b"# \xff\n", text.count("\n") + 1
    yield "only remarks", b"# nothing\n# at all\n", None
    yield "a list in place of keys", b"- 1\n- 2\n", None
    yield "a scalar", b"42\n", None
    yield "null", b"~\n", None
    yield "two documents", good + b"---\n" + good, None
    yield "a tab in place of blanks", good + b"\tfoo: 1\n", None
    yield "an open quote", good + b"x: \"abc\n", None
    yield "an open list", good + b"x: [1, 2\n", None
    yield "an unknown alias", good + b"x: *nobody\n", None
    yield "a list in itself", good + b"x: &x [*x]\n", None
    yield "10 000 lists in each other", good + b"x: " + b"[" * 10_000 + b"]" * 10_000 + b"\n", None
    yield "10 000 open lists", good + b"x: " + b"[" * 10_000 + b"\n", None
    yield "10 000 mappings in each other", b"{a: " * 10_000 + b"1" + b"}" * 10_000 + b"\n", None
    doubling = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9) if i else 'lol'}]\n" for i in range(10))
    yield "a list doubled again and again", good + doubling.encode(), None
    yield "50 000 unknown keys", good + "".join(f"k{i}: 1\n" for i in range(50_000)).encode(), None
    yield "a byte that is no UTF-8", text.replace(number, number + " \xff").encode("latin-1"), None
    yield "a control character", text.replace(number, number + " \x07").encode(), None


def of_binary(good, magic):
    """Damages of a binary file whose first `magic` bytes tell what it is."""
    for i in range(magic):
        yield f"byte {i} of the first ones another", good[:i] + bytes([good[i] ^ 0x20]) + good[i + 1 :], None
    yield "the first byte missing", good[1:], None
    yield "a byte more in front", b"\0" + good, None


def cuts(good, count):
    """The file, cut off at `count` places."""
    last = len(good.rstrip()) - 1
    for i in range(count):
        at = 1 + i * (last - 1) // max(count - 1, 1)
        yield f"cut off at byte {at}", good[:at], None
