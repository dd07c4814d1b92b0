#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures whether tests notice mistakes: makes one small mistake at a time in the
sources of a module, compiles, and runs the module's own tests.

    test/mutants.py BUILD MODULE... [--count N] [--seed S] [--log FILE] [--again LOG]

BUILD is a folder for a copy of the sources and what is compiled of it. Mistakes are
drawn at random, the same ones for a seed: comparisons and their ends, signs and
constants, conditions, and statements that are left out. FILE gets a line for each:
verdict, module, place, what stood there and what was put in its place. With --again
those are made that survived in an earlier LOG: tests may have been added.
"""

import argparse
import collections
import filecmp
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent

SWAPS = {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ",
         " != ": " == ", " && ": " || ", " || ": " && ", " + ": " - ", " - ": " + ",
         " * ": " / ", " / ": " * ", " += ": " -= ", " -= ": " += ", "++": "--",
         "std::min(": "std::max(", "std::max(": "std::min(",
         "return true;": "return false;", "return false;": "return true;"}
NUMBER = re.compile(r"(?<![\w.])(\d+)(\.\d+f?)?(?![\w.])")
CONDITION = re.compile(r"\b(if|while) \((.*)\)( \{)?$")
# A call or an assignment in one line; declarations and jumps are none.
STATEMENT = re.compile(r"^\s+(?!return\b|throw\b|using\b|static_assert|const\b|case\b|"
                       r"break|continue|else|fail|bad[A-Z])[\w.\->\[\]():*]+"
                       r"(\(.*\)| [-+*/|&^]?= .*);$")


def mistakes_in(line):
    """Every mistake that can be made in a line, as the line with it."""
    code = line.split("//")[0].rstrip()
    stripped = code.strip()
    if not stripped or stripped.startswith(("#", "/*", "*", "template", "static_assert")):
        return []
    made = []
    if '"' not in code:
        for old, new in SWAPS.items():
            for found in re.finditer(re.escape(old), code):
                made.append(code[:found.start()] + new + code[found.end():])
        for found in NUMBER.finditer(code):
            number = str(int(found.group(1)) + 1) + (found.group(2) or "")
            made.append(code[:found.start()] + number + code[found.end():])
    condition = CONDITION.search(code)
    if condition and condition.group(2).count("(") == condition.group(2).count(")"):
        made.append(f"{code[:condition.start(2)]}!({condition.group(2)})"
                    f"{code[condition.end(2):]}")
    if STATEMENT.match(code):
        made.append(code[:len(code) - len(code.lstrip())] + ";")
    return made


def candidates(tree, module):
    folder = tree / "src" / module
    for path in sorted([*folder.rglob("*.cpp"), *folder.rglob("*.h")]):
        lines = path.read_text().splitlines()
        for number, line in enumerate(lines):
            for mistake in mistakes_in(line):
                yield path.relative_to(tree), number, line, mistake


def entry(module, path, number, line, mistake):
    """What a log says of a mistake, behind the verdict."""
    return module, f"{path}:{number + 1}", line.strip(), mistake.strip()


def bound_memory():
    """A mistake may let something grow for ever."""
    resource.setrlimit(resource.RLIMIT_DATA, (8 << 30, 8 << 30))


class Workshop:
    """A copy of the sources in which mistakes are made."""

    def __init__(self, folder):
        self.tree, self.build = folder / "tree", folder / "build"
        files = subprocess.run(["git", "ls-files"], cwd=SOURCE, check=True, text=True,
                               stdout=subprocess.PIPE).stdout.split()
        for left in self.tree.rglob("*"):
            if left.is_file() and str(left.relative_to(self.tree)) not in files:
                left.unlink()
        # What an interrupted run has left changed is new again, for the compiler.
        for name in files:
            copy = self.tree / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            if not copy.is_file() or not filecmp.cmp(SOURCE / name, copy, shallow=False):
                shutil.copyfile(SOURCE / name, copy)
        data = folder / "data"  # where programs look for it, beside their build
        if not data.is_symlink():
            data.symlink_to(self.tree / "data")
        synthesizer = SOURCE / "build/bin/pcl_semantic_synthesize"
        subprocess.run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja",
                        "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1",
                        "-DPCL_SEMANTIC_BUILD_APPS=OFF", "-DPCL_SEMANTIC_BUILD_EXAMPLES=OFF",
                        f"-DPCL_SEMANTIC_SYNTHESIZER={synthesizer}"],
                       check=True, stdout=subprocess.DEVNULL)

    def compile(self, module):
        return subprocess.run(["ninja", "-C", self.build, f"test_{module}"],
                              stdout=subprocess.DEVNULL).returncode == 0

    def test(self, module, patience=600):
        """Whether the tests pass; what hangs does not."""
        try:
            return subprocess.run([self.build / "test" / f"test_{module}",
                                   "--gtest_brief=1", "--gtest_fail_fast"],
                                  cwd=self.build / "test", timeout=patience,
                                  preexec_fn=bound_memory,
                                  stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL).returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def verdict(self, module, path, number, mistake):
        file = self.tree / path
        text = file.read_text()
        lines = text.splitlines()
        lines[number] = mistake
        file.write_text("\n".join(lines) + "\n")
        try:
            if not self.compile(module):
                return "not compiled"
            return "survived" if self.test(module, patience=120) else "killed"
        finally:
            file.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("modules", nargs="+")
    parser.add_argument("--count", type=int, default=60, help="mistakes a module")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", type=pathlib.Path, help="earlier log")
    parser.add_argument("--log", type=pathlib.Path, default="/dev/stdout")
    arguments = parser.parse_args()
    survivors = set()
    if arguments.again:
        for line in arguments.again.read_text().splitlines():
            verdict, *mistake = line.split("\t")
            if verdict == "survived":
                survivors.add(tuple(mistake))
    workshop = Workshop(arguments.build.resolve())
    with open(arguments.log, "a", buffering=1) as log:
        for module in arguments.modules:
            if not workshop.compile(module) or not workshop.test(module):
                sys.exit(f"{module}: its tests fail before any mistake is made")
            drawn = list(candidates(workshop.tree, module))
            random.Random(arguments.seed).shuffle(drawn)
            if arguments.again:
                drawn = [each for each in drawn if entry(module, *each) in survivors]
            verdicts = collections.Counter()
            for path, number, line, mistake in drawn:
                if verdicts["killed"] + verdicts["survived"] >= arguments.count:
                    break
                verdict = workshop.verdict(module, path, number, mistake)
                verdicts[verdict] += 1
                log.write("\t".join((verdict, *entry(module, path, number, line, mistake)))
                          + "\n")
            tried = verdicts["killed"] + verdicts["survived"]
            print(f"{module}: {verdicts['killed']} of {tried} killed "
                  f"({100 * verdicts['killed'] / max(tried, 1):.0f} %)", flush=True)


if __name__ == "__main__":
    main()
