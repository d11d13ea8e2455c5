#!/usr/bin/env python3
"""run_cli.py PROGRAM CASES: runs the program once for each case, in a fresh folder with small inputs, and compares exit code, output
and files.

CASES has one JSON object per line, written by cli_test() in CMakeLists.txt. Conditions on JSON (conditions.py) apply to the output if
OUT begins with "json:", to a file by REPORT FILE:conditions, and to the written files by THEN "COMMAND => conditions": the command of
the program (check, info, compare) is run with --json in the same folder; `picture FILE`, `table FILE` and
the other LOOKS inspect a file (looks.py).
"""

import argparse
import collections
import dataclasses
import functools
import json
import os
import pathlib
import re
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import xml.etree.ElementTree as xml

import conditions
import inputs
import looks

CASE_LIMIT = 120  # [s] for all commands of a case
SLOWEST_END = 2  # [s] after a signal; one is promised, but other tests run at the same time
BUSY_TICKS = 0.3 * os.sysconf("SC_CLK_TCK")
LIBRARY = "twigs.branches"  # made by the program itself
MEMORY_FOLDER = "/dev/shm"  # writing the inputs of a case to a disk takes 30 times as long


@dataclasses.dataclass
class Case:
    name: str
    arguments: str
    exit: str
    out: str = None
    err: str = None
    gone: str = ""
    report: str = ""
    limit: str = None
    signal: str = None
    environment: str = ""
    then: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Result:
    case: Case
    seconds: float
    failure: str = ""
    skipped: str = ""


class Runner:
    """Runs the commands of one case, which must end within CASE_LIMIT in total."""

    def __init__(self, program, case):
        self.program = program
        self.environment = os.environ | dict([case.environment.split("=")] if case.environment else [])
        self.end = time.monotonic() + CASE_LIMIT

    def run(self, words, signal_name=None, limit=None):
        """Returns exit code, standard output and error of the program."""
        lines = ""
        if "<" in words:
            lines = pathlib.Path(words[words.index("<") + 1]).read_text(encoding="utf-8")
            words = words[:words.index("<")]
        process = subprocess.Popen([self.program, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=self.environment, preexec_fn=limiter(limit) if limit else None)
        if signal_name:
            wait_until_busy(process.pid)
            process.send_signal(getattr(signal, signal_name))
        sent = time.monotonic()
        try:
            out, err = process.communicate(lines, timeout=self.end - sent)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            err += f"it was ended after {CASE_LIMIT} s\n"
        if signal_name and time.monotonic() - sent > SLOWEST_END:
            err += f"it took {time.monotonic() - sent:.1f} s to end\n"
        return process.returncode, out, err


def wait_until_busy(process):
    """Waits until it has computed for longer than its start takes, or for 0.7 s if it is blocked."""
    stat, end = pathlib.Path(f"/proc/{process}/stat"), time.monotonic() + 0.7
    while time.monotonic() < end and sum(map(int, stat.read_text().rsplit(")", 1)[1].split()[11:13])) < BUSY_TICKS:
        time.sleep(0.02)


def limiter(limit):
    """Returns a function that a process calls before the program starts: NAME=VALUE of setrlimit."""
    name, value = limit.split("=")
    return lambda: resource.setrlimit(getattr(resource, "RLIMIT_" + name), (int(value), resource.RLIM_INFINITY))


def matches(pattern, text):
    if pattern.startswith("json:"):
        return not list(conditions.broken(pattern[5:], json.loads(text)))
    return re.search(pattern, text.rstrip("\n") if pattern.endswith("$") else text, re.DOTALL) is not None


# A check with one of these expectations ends with 1.
FAILURES = ("sound=false", "volume.ratio<0.98", "volume.ratio>1.02")


def judged(runner, command, expected):
    """Returns the faults that another command finds in the written files."""
    words = shlex.split(command)
    if words[0] in looks.LOOKS:
        value = looks.LOOKS[words[0]](words[1])
    else:
        code, out, err = runner.run(words + ["--json"])
        if code != any(c in FAILURES for c in expected.split(",")):
            yield f"{command} ends with {code}: {err or out}"
            return
        value = json.loads(out)
    for complaint in conditions.broken(expected, value):
        yield f"{command}: {complaint}"


def complaints(runner, case, before, code, out, err):
    if code != int(case.exit):
        yield f"exit code {code} instead of {case.exit}"
    for name, pattern, text in (("stdout", case.out, out), ("stderr", case.err, err)):
        if pattern is not None and not matches(pattern, text):
            yield f"{name} does not match {pattern}"
    # If some of many files fail, the exit code is 4 and the others are written: such a case checks them.
    failed = code not in (0, 1) and not (code == 4 and case.then)
    if case.err and failed and len(err.strip().splitlines()) > 1:
        yield "an error is more than one line"
    for name in filter(None, case.gone.split(",")):
        if os.path.exists(name):
            yield f"{name} was left behind"
    if case.report:
        name, keys = case.report.split(":")
        yield from conditions.broken(keys, json.loads(pathlib.Path(name).read_text(encoding="utf-8")))
    for judgement in case.then:
        yield from judged(runner, *judgement.split(" => "))
    if failed and set(os.listdir(".")) != before:
        yield f"files were left behind: {set(os.listdir('.')) - before}"


def find_failure(runner, case):
    """Runs the case in the current folder; returns the failures, if any."""
    found, out, err, before = [], "", "", set(os.listdir("."))
    try:
        code, out, err = runner.run(shlex.split(case.arguments), case.signal, case.limit)
        found.extend(complaints(runner, case, before, code, out, err))
    except Exception:  # a file that is missing or invalid
        found.append(traceback.format_exc())
    return f"coppice {case.arguments}\n" + "\n".join(found) + f"\n--- stdout\n{out}\n--- stderr\n{err}" if found else ""


def folder_of_inputs():
    folder = tempfile.TemporaryDirectory(dir=MEMORY_FOLDER if os.access(MEMORY_FOLDER, os.W_OK) else None)
    inputs.create(folder.name)
    return folder


@functools.cache
def library(program):
    """Returns the content of a library with the branches of twigs.swc."""
    with folder_of_inputs() as folder:
        subprocess.run([program, "library", "add", LIBRARY, "twigs.swc", "--set-tag", "oak"], cwd=folder, check=True, capture_output=True)
        return pathlib.Path(folder, LIBRARY).read_bytes()


def run_case(program, case):
    start, failure, skipped = time.monotonic(), "", ""
    with folder_of_inputs() as folder:
        os.chdir(folder)
        if LIBRARY in case.arguments:
            pathlib.Path(LIBRARY).write_bytes(library(program))
        if inputs.UNREADABLE in case.arguments and os.access(inputs.UNREADABLE, os.R_OK):
            skipped = "root reads everything"
        else:
            failure = find_failure(Runner(program, case), case)
        os.chdir("/")
    return Result(case, time.monotonic() - start, failure, skipped)


def read_cases(file):
    cases = [Case(**json.loads(line)) for line in pathlib.Path(file).read_text(encoding="utf-8").splitlines()]
    repeated = [name for name, times in collections.Counter(case.name for case in cases).items() if times > 1]
    if repeated:
        sys.exit(f"cases of the same name: {', '.join(repeated)}")
    return cases


def write_junit(file, results):
    """Writes results as CTest does, for tests within other tests."""
    suite = xml.Element("testsuite", name=pathlib.Path(file).stem, tests=str(len(results)))
    for result in results:
        status = "fail" if result.failure else "notrun" if result.skipped else "run"
        case = xml.SubElement(suite, "testcase", name=f"cli.{result.case.name}", classname="cli", status=status, time=f"{result.seconds:.3f}")
        if result.failure:
            # XML has no control characters.
            xml.SubElement(case, "failure").text = re.sub("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "?", result.failure)
        if result.skipped:
            xml.SubElement(case, "skipped", message=result.skipped)
    pathlib.Path(file).parent.mkdir(parents=True, exist_ok=True)
    xml.ElementTree(suite).write(file, encoding="utf-8", xml_declaration=True)


def print_summary(results):
    for kind, chosen in (("skipped", [r for r in results if r.skipped]), ("failed", [r for r in results if r.failure])):
        for result in chosen:
            print(f"cli.{result.case.name} {kind}: {result.failure or result.skipped}")
    failed = [f"cli.{r.case.name}" for r in results if r.failure]
    print(f"{len(results)} cases, {len(failed)} failed" + (": " + " ".join(failed) if failed else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("cases")
    parser.add_argument("--filter", metavar="REGEX", default="", help="only cases with a name in which it is found")
    parser.add_argument("--shard", metavar="I/N", default="0/1", help="only the cases I, I + N, I + 2 N ... of these, from 0")
    parser.add_argument("--junit", metavar="FILE", type=os.path.abspath, help="writes the results as XML")
    arguments = parser.parse_args()
    first, step = map(int, arguments.shard.split("/"))
    cases = [case for case in read_cases(arguments.cases) if re.search(arguments.filter, case.name)][first::step]
    if not cases:
        sys.exit(f"no case of {arguments.cases} is chosen")
    results = [run_case(arguments.program, case) for case in cases]
    if arguments.junit:
        write_junit(arguments.junit, results)
    print_summary(results)
    return 1 if any(result.failure for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
