#!/usr/bin/python3
"""Checks sizes: lines a file, columns a line, and the folders at the top.

    check_budget.py ROOT        prints one line a violation, exits 1 if there is any
    check_budget.py --self-test shows on a made-up tree that each rule is able to fail

A file that has to be longer says why in a comment line that starts with "Budget:".
"""

import pathlib
import re
import sys
import tempfile

FOLDERS = ("src", "include", "tools", "tests")
COLUMNS = 100
PUBLIC_HEADER_LINES = 150
SOURCE_LINES = 400
REASON = re.compile(r"^\s*(//|#) Budget: \w", re.M)


def source_files(root):
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in (".h", ".cc", ".py") or file.name.endswith(".h.in"):
                yield file


def violations(root):
    ignored = set()
    if (root / ".gitignore").exists():
        ignored = {line.strip("/") for line in (root / ".gitignore").read_text("utf-8").split()}
    for entry in sorted(root.iterdir()):
        known = entry.name in FOLDERS or entry.name in ignored or entry.name.startswith(".")
        if entry.is_dir() and not known:
            yield f"{entry.name}/: folders at the top are {', '.join(FOLDERS)} only"

    files = list(source_files(root))
    if not files:
        yield f"{root}: no sources found"
    for file in files:
        name, text = file.relative_to(root).as_posix(), file.read_text("utf-8")
        lines = text.splitlines()
        budget = PUBLIC_HEADER_LINES if name.startswith("include/") else SOURCE_LINES
        if len(lines) > budget and not REASON.search(text):
            yield f"{name}: {len(lines)} lines, more than {budget}: split it, or give the reason"
        for number, line in enumerate(lines, 1):
            if len(line) > COLUMNS:
                yield f"{name}:{number}: {len(line)} columns, more than {COLUMNS}"


SELF_TEST = [  # path, text, whether it is a violation
    ("src/io/a.cc", "\n" * SOURCE_LINES, False),
    ("src/io/a.cc", "\n" * (SOURCE_LINES + 1), True),
    ("src/io/a.cc", "// Budget: one table.\n" + "\n" * SOURCE_LINES, False),
    ("src/io/a.cc", "// Budget:\n" + "\n" * SOURCE_LINES, True),
    ("include/vdb_offset/io/a.h", "\n" * PUBLIC_HEADER_LINES, False),
    ("include/vdb_offset/io/a.h", "\n" * (PUBLIC_HEADER_LINES + 1), True),
    ("tests/io/a.cc", "x" * COLUMNS, False),
    ("tests/io/a.cc", "x" * (COLUMNS + 1), True),
    ("scripts/a.cc", "", True),
]


def self_test():
    wrong = []
    for path, text, expected in SELF_TEST:
        with tempfile.TemporaryDirectory() as folder:
            for name, content in (("src/b.cc", ""), (path, text)):
                file = pathlib.Path(folder, name)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(content, "utf-8")
            if bool(list(violations(pathlib.Path(folder)))) != expected:
                verb = "should be" if expected else "should not be"
                wrong.append(f"{path}, {len(text)} characters: {verb} refused")
    return wrong


if __name__ == "__main__":
    argument = sys.argv[1]
    found = self_test() if argument == "--self-test" else list(violations(pathlib.Path(argument)))
    print("\n".join(found) or "budgets: kept")
    sys.exit(1 if found else 0)
