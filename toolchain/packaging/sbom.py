# SPDX-License-Identifier: BSD-3-Clause
"""Writes which packages of Debian are linked or compiled into jink's programs and libraries, as SPDX 2.3 (JSON).

    sbom.py --build FOLDER --out FILE [--version VERSION]

Shared libraries are those that ldd names, headers those that ninja recorded for every object of a program. Names,
versions and licences come from dpkg and the copyright files of the packages. What is bundled into the page of
`jink report` (three) is in toolchain/viewer/package-lock.json.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import subprocess
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
# What the Debian packages hold, by its place in a build folder.
PROGRAMS = {"jinkd": "firmware/linux/jinkd", "jink": "toolchain/host/jink", "jink-sim": "toolchain/sim/jink-sim"}
LIBRARIES = ["core/libjink_core.a", "hal/libjink_hal.a", "firmware/libjink_link.a", "firmware/libjink_app.a"]
# Short names of Debian's copyright files whose SPDX name differs by more than a suffix.
SPDX_NAMES = {"Expat": "MIT", "BSD-3-clause": "BSD-3-Clause", "BSD-3": "BSD-3-Clause", "BSD-2-clause": "BSD-2-Clause", "zlib/libpng": "Zlib",
              "MPL2": "MPL-2.0", "MPL-2": "MPL-2.0", "PD": "LicenseRef-public-domain", "public-domain": "LicenseRef-public-domain",
              "Apache-2": "Apache-2.0", "zlib": "Zlib", "BSL-1": "BSL-1.0"}
# Packages whose copyright file is prose: by source package, the licence that the file states for the libraries.
PROSE = {"gcc": "GPL-3.0-or-later WITH GCC-exception-3.1", "glibc": "LGPL-2.1-or-later"}


def output(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def linked(program):
    """Files of all shared libraries that a program loads."""
    found = re.findall(r"=> (/\S+)|^\s*(/\S+) \(", output("ldd", program), re.M)
    return {named or loader for named, loader in found}


def recorded_headers(build):
    """Of each object of the build, the files outside of both trees that it includes."""
    headers, current = {}, None
    for line in output("ninja", "-C", build, "-t", "deps").splitlines():
        if line and not line.startswith((" ", "ninja:")):
            current = headers.setdefault(line.split(":")[0], set())
        elif line.startswith("    /") and current is not None:
            current.add(line.strip())
    return headers


def compiled_in(build, target, headers):
    """Files outside of both trees from which a target's objects were made."""
    own = (os.path.realpath(build) + "/", os.path.realpath(TOP) + "/", os.path.abspath(build) + "/")
    found = set()
    for name in output("ninja", "-C", build, "-t", "inputs", target).split():
        found |= {h for h in headers.get(name, ()) if not os.path.realpath(h).startswith(own)}
    return found


def owners(files):
    """Debian packages of files: file -> package. A file of /usr may be known by its place before the merger of / and /usr."""
    spellings = {}
    for file in files:
        for path in {file, os.path.realpath(file)}:
            for spelling in (path, path.removeprefix("/usr"), "/usr" + path):
                spellings.setdefault(spelling, file)
    found, paths = {}, sorted(spellings)
    for start in range(0, len(paths), 500):
        # dpkg's status is 1 where it does not know one of the files.
        text = subprocess.run(["dpkg", "-S", *paths[start : start + 500]], capture_output=True, text=True).stdout
        for line in text.splitlines():
            names, _, path = line.rpartition(": ")
            if path in spellings and not line.startswith("diversion "):
                found[spellings[path]] = names.split(", ")[0]
    return found


def declared_licence(package, source):
    """SPDX expression from the package's copyright file; NOASSERTION where the file has no form that can be read."""
    for name, licence in PROSE.items():
        if re.fullmatch(name + r"(-[\d.]+)?", source):
            return licence
    file = pathlib.Path("/usr/share/doc", package.split(":")[0], "copyright")
    if not file.exists():
        return "NOASSERTION"
    text = file.read_text(encoding="utf-8", errors="replace")
    if not text.lstrip().startswith("Format"):
        return "NOASSERTION"
    paragraphs = re.split(r"\n\s*\n", text)
    chosen = [p for p in paragraphs if re.search(r"^Files:\s*\*\s*$", p, re.M)] or paragraphs[:1]
    short = re.search(r"^License:[ \t]*(\S[^\n]*)", chosen[0], re.M)
    return spdx_expression(short[1]) if short else "NOASSERTION"


def spdx_expression(short):
    """Debian's expression in SPDX's words; a name that SPDX may not know becomes a LicenseRef."""
    words = re.split(r"\s*,?\s+(and|or)\s+", short.strip())
    return " ".join(w.upper() if w in ("and", "or") else spdx_name(w) for w in words)


def spdx_name(name):
    name = name.strip()
    if name in SPDX_NAMES:
        return SPDX_NAMES[name]
    gnu = re.fullmatch(r"(A?L?GPL|GFDL)-(\d)(\.\d)?(\+?)", name)
    if gnu:
        return f"{gnu[1]}-{gnu[2]}{gnu[3] or '.0'}-{'or-later' if gnu[4] else 'only'}"
    if re.fullmatch(r"(BSD-\d-Clause|MPL-\d\.\d|MIT|Apache-2\.0|BSL-1\.0|Zlib|0BSD|ISC|CC0-1\.0|X11|Qhull)", name):
        return name
    return "LicenseRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", name).strip("-")


def package_entry(package):
    name, version, architecture, source = output(
        "dpkg-query", "-W", "-f=${Package}\n${Version}\n${Architecture}\n${source:Package}", package).split("\n")
    licence = declared_licence(package, source)
    return {
        "SPDXID": "SPDXRef-debian-" + re.sub(r"[^A-Za-z0-9.-]", "-", name), "name": name, "versionInfo": version,
        "supplier": "Organization: Debian", "sourceInfo": f"Debian source package {source}",
        "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "NOASSERTION",
        "licenseDeclared": licence, "licenseComments": f"from /usr/share/doc/{name}/copyright", "copyrightText": "NOASSERTION",
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                          "referenceLocator": f"pkg:deb/debian/{name}@{version}?arch={architecture}"}],
    }


def bundled_entries():
    """npm packages that are bundled into viewer.html: the viewer's dependencies but those of its development."""
    packages = json.loads((TOP / "toolchain/viewer/package-lock.json").read_text(encoding="utf-8"))["packages"]
    for name in sorted(packages[""]["dependencies"]):
        entry = packages[f"node_modules/{name}"]
        yield {"SPDXID": f"SPDXRef-npm-{name}", "name": name, "versionInfo": entry["version"], "downloadLocation": entry.get("resolved", "NOASSERTION"),
               "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": entry["license"], "copyrightText": "NOASSERTION",
               "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                 "referenceLocator": f"pkg:npm/{name}@{entry['version']}"}]}


def own_entry(name, version):
    return {"SPDXID": f"SPDXRef-{name}", "name": name, "versionInfo": version, "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False, "licenseConcluded": "BSD-3-Clause", "licenseDeclared": "BSD-3-Clause",
            "copyrightText": "Copyright (c) 2026, the jink developers"}


def document(build, version):
    headers = recorded_headers(build)
    targets = {name: ([path], linked(os.path.join(build, path))) for name, path in PROGRAMS.items()}
    targets["libjink-dev"] = (LIBRARIES, set())
    entries, relations = {}, []
    for name, (paths, libraries) in targets.items():
        included = set().union(*(compiled_in(build, path, headers) for path in paths))
        owner = owners(libraries | included)
        unknown = sorted((libraries | included) - set(owner))
        if unknown:
            raise SystemExit(f"sbom: no Debian package has {', '.join(unknown[:5])}, of which {name} is made")
        for files, relation, comment in ((libraries, "DYNAMIC_LINK", "shared library"),
                                         (included, "STATIC_LINK", "headers compiled in")):
            for package in sorted({owner[file] for file in files}):
                if package not in entries:
                    entries[package] = package_entry(package)
                relations.append({"spdxElementId": f"SPDXRef-{name}", "relationshipType": relation,
                                  "relatedSpdxElement": entries[package]["SPDXID"], "comment": comment})
    bundled = list(bundled_entries())
    relations += [{"spdxElementId": "SPDXRef-jink", "relationshipType": "CONTAINS", "relatedSpdxElement": entry["SPDXID"],
                   "comment": "bundled into viewer.html"} for entry in bundled]
    packages = [own_entry(name, version) for name in targets] + [entries[name] for name in sorted(entries)] + bundled
    refs = sorted({ref for p in packages for ref in re.findall(r"LicenseRef-[A-Za-z0-9.-]+", p["licenseDeclared"])})
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    when = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc)
    return {
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"jink-{version}",
        "documentNamespace": f"https://jink.invalid/spdx/jink-{version}",
        "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: toolchain/packaging/sbom.py"]},
        "packages": packages,
        "hasExtractedLicensingInfos": [{"licenseId": ref, "name": ref.removeprefix("LicenseRef-"),
                                        "extractedText": "named so in the copyright file of the Debian package"} for ref in refs],
        "relationships": [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                           "relatedSpdxElement": f"SPDXRef-{name}"} for name in targets] + relations,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", required=True, help="folder of a finished build by Ninja")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--version", default="unknown")
    arguments = parser.parse_args()
    text = json.dumps(document(arguments.build, arguments.version), indent=1)
    arguments.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
