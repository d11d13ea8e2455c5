#!/usr/bin/env python3
"""run_cli_test.py PROGRAM: the driver of the cases reports every expectation that fails, and invalid lists of cases."""

import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

DRIVER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "run_cli.py")
GOOD = {"name": "good", "arguments": "info tree.swc --report r.json", "exit": "0", "out": "nodes +4", "err": "^$", "report": "r.json:counts.nodes=4",
        "then": ["info tree.swc => nodes=4,tips>1,kind=skeleton", "text tree.swc => lines=4"]}
# Changes that make a case fail, and the message of the driver.
WRONG = [({"exit": "1"}, "exit code 0 instead of 1"), ({"out": "nodes +5"}, "stdout does not match"), ({"out": "json:nodes"}, "JSONDecodeError"),
         ({"err": "nodes"}, "stderr does not match"), ({"gone": "r.json"}, "r.json was left behind"),
         ({"report": "r.json:counts.nodes=5"}, "counts.nodes=5 does not hold: it is 4"), ({"report": "none.json:counts"}, "FileNotFoundError"),
         ({"then": ["info tree.swc => nodes=4,tips>2"]}, "tips>2 does not hold: it is 2"), ({"then": ["info none.swc => nodes"]}, "ends with 4"),
         ({"limit": "FSIZE=50"}, "exit code 4 instead of 0"), ({"arguments": "shell < none.txt"}, "FileNotFoundError")]


def driver(program, folder, cases, *options):
    """Returns exit code, output, and the test cases of the XML with results of each kind."""
    file, junit = os.path.join(folder, "cases.jsonl"), os.path.join(folder, "results.xml")
    with open(file, "w", encoding="utf-8") as lines:
        lines.writelines(json.dumps(case) + "\n" for case in cases)
    done = subprocess.run([sys.executable, DRIVER, program, file, "--junit", junit, *options], capture_output=True, text=True)
    found = xml.parse(junit).getroot() if os.path.exists(junit) else []
    return done.returncode, done.stdout + done.stderr, {case.get("name"): case for case in found}


def faults(program, folder):
    cases = [GOOD] + [GOOD | change | {"name": f"wrong_{i}"} for i, (change, _) in enumerate(WRONG)]
    for options in (["--filter", "none"], ["--shard", f"{len(cases)}/99"]):
        code, text, _ = driver(program, folder, cases, *options)
        if code != 1 or "no case" not in text:
            yield f"{options}: exit code {code}: {text}"
    for odd, said in ([], "no case"), ([GOOD, GOOD], "cases of the same name: good"):
        code, text, _ = driver(program, folder, odd)
        if code != 1 or said not in text:
            yield f"{odd}: exit code {code}: {text}"
    code, text, found = driver(program, folder, cases)
    if code != 1 or f"{len(cases)} cases, {len(WRONG)} failed: cli.wrong_0 cli.wrong_1" not in text or len(found) != len(cases):
        yield text
    if found["cli.good"].get("status") != "run" or len(found["cli.good"]):
        yield xml.tostring(found["cli.good"])
    for i, (change, said) in enumerate(WRONG):
        case = found[f"cli.wrong_{i}"]
        if case.get("status") != "fail" or said not in (case.findtext("failure") or ""):
            yield f"{change}: {xml.tostring(case)}"


def main():
    with tempfile.TemporaryDirectory() as folder:
        found = list(faults(os.path.abspath(sys.argv[1]), folder))
    print(*found, sep="\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
