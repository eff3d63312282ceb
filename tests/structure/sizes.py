#!/usr/bin/env python3
"""How large the tree's files and functions are, and how much of them is comment: sizes.py [TOP]
Comment share: lines with a comment over lines that are not empty. Functions: as the structure test
counts them. Standard library only."""
import os
import re
import sys

import structure_test as structure

TOP = os.path.realpath(sys.argv[1]) if len(sys.argv) > 1 else structure.TOP
SETS = [
    ("lib, headers", "lib", (".h",)),
    ("lib, sources", "lib", (".cpp",)),
    ("program", "apps", (".h", ".cpp")),
    ("tests", "tests", (".h", ".cpp")),
]


def Rank(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def CommentShare(paths):
    comment = full = 0
    for path in paths:
        inside = False
        for line in structure.Lines(path):
            text = re.sub(r'"(\\.|[^"\\])*"', '""', line).strip()
            full += bool(text)
            comment += bool(text) and (inside or "//" in text or "/*" in text)
            if "/*" in text or inside:
                inside = "*/" not in text
    return 100 * comment / full


def main():
    print("| set | files | lines: median | p90 | max | comment % | functions | median | p90 | max | "
          "at most 40 % |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name, folder, endings in SETS:
        paths = list(structure.Sources(os.path.join(TOP, folder), endings))
        sizes = [len(structure.Lines(path)) for path in paths]
        lengths = [n for path in paths for _, n in structure.Functions(path)]
        short = 100 * sum(n <= 40 for n in lengths) / len(lengths)
        print(f"| {name} | {len(paths)} | {Rank(sizes, 0.5)} | {Rank(sizes, 0.9)} | {max(sizes)} | "
              f"{CommentShare(paths):.1f} | {len(lengths)} | {Rank(lengths, 0.5)} | "
              f"{Rank(lengths, 0.9)} | {max(lengths)} | {short:.1f} |")


if __name__ == "__main__":
    main()
