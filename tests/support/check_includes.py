#!/usr/bin/python3
"""Checks the architecture by the include lines: which folder may know which.

    check_includes.py ROOT        prints one line a violation, exits 1 if there is any
    check_includes.py --self-test shows on a made-up tree that each rule is able to fail
"""

import pathlib
import re
import sys
import tempfile

# The pipeline's stages, first to last, and the headers by which later stages know each result.
RESULT_HEADERS = {
    "surface": {"boundary.h", "inside.h", "patch.h", "polygons.h", "surface.h", "topology.h",
                "turn_round.h", "wall.h", "winding.h"},
    "rasterize": {"rasterize.h"},
    "sweep": {"sweep.h"},
    "march": {"face_room.h", "march.h", "room_at.h", "spacing.h"},
    "blocks": {"bare_stacks.h", "cell_zone.h", "check_crossings.h", "check_sides.h",
               "conditions.h", "connectivity.h", "multi_block.h", "quality.h", "repair.h",
               "zone_mesh.h"},
    "io": set(),
}
STAGES = list(RESULT_HEADERS)

# Library header -> the only places that may include it (path prefixes).
CONFINED = {
    "tbb/": ["src/core/parallel.h", "tools/", "tests/"],
    "oneapi/": ["src/core/parallel.h", "tools/", "tests/"],
    "CLI/": ["tools/"],
    "nlohmann/": ["src/io/", "tools/", "tests/"],
    "doctest/": ["tests/"],
    "iostream": ["tools/", "tests/"],
}

# What a library does not do: write to a terminal or end the program.
FORBIDDEN_IN_LIBRARY = re.compile(
    r"\bstd::(cout|cerr|clog)\b|\bstd(out|err)\b"
    r"|(?<![\w.>:])(?:std::|fmt::|::)?"
    r"(v?f?printf|print|println|puts|fputs|putchar|perror|exit|_exit|_Exit|quick_exit|abort"
    r"|terminate)\s*\("
)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def code_lines(text):
    """Lines without comments and without the contents of strings, include lines as they are."""
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.S)
    for number, line in enumerate(text.split("\n"), 1):
        if not INCLUDE.match(line):
            line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
        yield number, re.sub(r"//.*", "", line)


def owner(path):
    """(public?, stage) of a library file; the stage of src/pipeline.cc is 'pipeline'."""
    parts = path.split("/")
    public = parts[0] == "include"
    inner = parts[2:] if public else parts[1:]
    return public, inner[0] if len(inner) > 1 else inner[0].split(".")[0]


def quoted_violation(path, target):
    """Why a library file may not include the project's header `target`, or None."""
    public, stage = owner(path)
    target_public = target.startswith("vdb_offset/")
    inner = target.split("/")[1:] if target_public else target.split("/")
    if public and not target_public:
        return "a public header includes a private one"
    if len(inner) == 1:
        return None if stage == "pipeline" else "only pipeline.cc knows the pipeline; no bare names"
    other, header = inner[0], "/".join(inner[1:])
    if other in ("core", stage):
        return None
    if other not in STAGES:
        return f"'{other}' is no stage"
    if stage == "pipeline":
        return None if target_public else "the pipeline uses public headers only"
    if stage not in STAGES:
        return f"'{stage}' is not a stage and may know core only"
    if STAGES.index(other) > STAGES.index(stage):
        return f"stage '{stage}' comes before '{other}'"
    if not target_public or header not in RESULT_HEADERS[other]:
        return f"of '{other}', only its results: {', '.join(sorted(RESULT_HEADERS[other]))}"
    return None


def file_violations(path, text):
    library = path.startswith(("src/", "include/"))
    for number, line in code_lines(text):
        match = INCLUDE.match(line)
        if not match:
            if library and (found := FORBIDDEN_IN_LIBRARY.search(line)):
                yield f"{path}:{number}: '{found.group()}': the library neither prints nor exits"
            continue
        quote, target = match.groups()
        for prefix, places in CONFINED.items():
            if target.startswith(prefix) and not path.startswith(tuple(places)):
                yield f"{path}:{number}: <{target}> belongs in {', '.join(places)} only"
        if library and quote == '"' and (reason := quoted_violation(path, target)):
            yield f"{path}:{number}: \"{target}\": {reason}"


def violations(root):
    files = [
        file
        for folder in ("src", "include", "tools", "tests")
        for file in sorted((root / folder).rglob("*"))
        if file.suffix in (".h", ".cc")
    ]
    if not files:
        yield f"{root}: no sources found"
    for file in files:
        yield from file_violations(file.relative_to(root).as_posix(), file.read_text("utf-8"))


SELF_TEST = [  # path, line, whether it is a violation
    ("src/march/a.cc", '#include "vdb_offset/surface/wall.h"', False),
    ("src/march/a.cc", '#include "vdb_offset/surface/example.h"', True),
    ("src/march/a.cc", '#include "surface/bvh.h"', True),
    ("src/march/a.cc", '#include "march/path.h"', False),
    ("src/march/a.cc", '#include "core/parallel.h"', False),
    ("src/march/a.cc", '#include "vdb_offset/blocks/multi_block.h"', True),
    ("src/march/a.cc", '#include "vdb_offset/pipeline.h"', True),
    ("src/march/a.cc", '#include "path.h"', True),
    ("src/core/a.cc", '#include "vdb_offset/surface/patch.h"', True),
    ("src/pipeline.cc", '#include "vdb_offset/io/vtk.h"', False),
    ("src/pipeline.cc", '#include "march/path.h"', True),
    ("include/vdb_offset/pipeline.h", '#include "vdb_offset/march/march.h"', False),
    ("include/vdb_offset/march/m.h", '#include "march/path.h"', True),
    ("src/core/parallel.h", "#include <tbb/parallel_for.h>", False),
    ("src/sweep/a.cc", "#include <tbb/parallel_for.h>", True),
    ("src/io/a.cc", "#include <nlohmann/json.hpp>", False),
    ("include/vdb_offset/io/a.h", "#include <nlohmann/json.hpp>", True),
    ("src/io/a.cc", "#include <CLI/CLI.hpp>", True),
    ("src/io/a.cc", "#include <iostream>", True),
    ("src/io/a.cc", 'void f() { std::cerr << "x"; }', True),
    ("src/io/a.cc", "void f() { printf(nothing); }", True),
    ("src/io/a.cc", "void f() { fmt::print(nothing); }", True),
    ("src/io/a.cc", "void f() { std::exit(1); }", True),
    ("src/io/a.cc", 'void f() { snprintf(b, n, "exit(1)"); queue.abort(); }  // printf()', False),
    ("tools/vdb-offset/a.cc", "void f() { std::exit(1); }", False),
]


def self_test():
    wrong = []
    for path, line, expected in SELF_TEST:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True)
            file.write_text(line + "\n", "utf-8")
            if bool(list(violations(pathlib.Path(folder)))) != expected:
                verb = "should be" if expected else "should not be"
                wrong.append(f"{path}: '{line}' {verb} refused")
    return wrong


if __name__ == "__main__":
    argument = sys.argv[1]
    found = self_test() if argument == "--self-test" else list(violations(pathlib.Path(argument)))
    print("\n".join(found) or "include graph: as designed")
    sys.exit(1 if found else 0)
