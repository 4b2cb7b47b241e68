# SPDX-License-Identifier: BSD-3-Clause
"""Digest of the sources that decide a figure. Comments and white space do not count."""
import functools
import hashlib
import pathlib
import re

CPP = {".cpp", ".hpp", ".c", ".h"}
HASHED = {".py", ".cmake", ".toml", ".yaml", ".sh", ".txt", ""}  # whole lines that begin with # are comments
# A comment, or a literal that may resemble a comment; a number, a word, or a sign.
CPP_TOKEN = re.compile(r"""(?P<comment>//[^\n]*|/\*.*?\*/)
  |(?P<kept>R"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\d[\w.']*(?:(?<=[eEpP])[+-]\w+)?|\w+|[^\s\w])
  |(?P<line>\n)|[^\S\n]+""", re.S | re.X)


def plain_cpp(text):
    """The text without comments, one space between words; only lines of the preprocessor keep their end."""
    out, directive = [], False
    for found in CPP_TOKEN.finditer(text.replace("\\\n", " ")):
        if found["kept"]:
            if found["kept"] == "#" and (not out or out[-1] == "\n"):
                directive = True
            out.append(found["kept"])
        elif found["line"] or (found["comment"] and "\n" in found["comment"]):
            if directive or not out or next_is_directive(text, found):
                out.append("\n")
            directive = False
    return re.sub(r" ?\n[ \n]*", "\n", " ".join(out)).strip()


def next_is_directive(text, found):
    return text[found.end():found.end() + 200].lstrip().startswith("#")


def plain(path, text):
    if path.suffix in CPP:
        return plain_cpp(text)
    lines = (line.rstrip() for line in text.splitlines())
    return "\n".join(line for line in lines if line and not (path.suffix in HASHED and line.lstrip().startswith("#") and not line.startswith("#!")))


def of_file(path):
    status = path.stat()
    return _of_file(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=None)
def _of_file(path, *_):
    data = path.read_bytes()
    try:
        data = plain(path, data.decode("utf-8")).encode()
    except UnicodeDecodeError:
        pass
    return hashlib.sha256(data).hexdigest()


def files(top, globs):
    """Files below `top` that match the globs, in order; globs that begin with ! exclude files."""
    found, refused = set(), set()
    for glob in globs:
        pattern = glob.lstrip("!")
        # A folder's ** matches everything below it.
        matches = {p for p in top.glob(pattern + "/*" if pattern.endswith("**") else pattern) if p.is_file() and "__pycache__" not in p.parts}
        if not matches and not glob.startswith("!"):
            raise ValueError(f"no source is named {glob}")
        (refused if glob.startswith("!") else found).update(matches)
    return sorted(found - refused)


def of_sources(top, globs):
    top = pathlib.Path(top)
    whole = hashlib.sha256()
    for path in files(top, globs):
        whole.update(f"{path.relative_to(top).as_posix()} {of_file(path)}\n".encode())
    return whole.hexdigest()[:24]


def of_evidence(top, name):
    """Digest of the sources that docs/figures.toml names for `name`."""
    import figures_registry
    registry = figures_registry.Registry(pathlib.Path(top))
    return of_sources(top, registry.commands[name].sources)
