#!/usr/bin/env python3
"""measure_gpu_test.py SOURCE: script/measure-gpu with fake programs, with a GPU and without one."""
import io
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

SOURCE = pathlib.Path(sys.argv[1])

BENCH = """#!/bin/sh
echo "$@" >>"$CALLS"
while [ $# -gt 0 ]; do
    case $1 in
        --json) printf '{\\n "card": "%s"\\n}\\n' "$CARD" >"$2" ;;
        --markdown) echo "tables" >"$2" ;;
    esac
    shift
done
"""
TESTS = """#!/bin/sh
case "$*" in *filter*) exit 0 ;; esac
exit 3
"""
PROGRAMS = {
    "coppice_gpu_bench": BENCH,
    "coppice_drag_bench": "#!/bin/sh\nexit 124\n",
    "cuda_card_test": TESTS,
    "drag_test": "#!/bin/sh\n",
    "compute-sanitizer": "#!/bin/sh\necho no errors\n",
}


def run(folder, card):
    with tarfile.open(folder / "programs.tar.xz", "w:xz") as tar:
        for name, text in PROGRAMS.items():
            info = tarfile.TarInfo(name)
            info.size, info.mode = len(text), 0o755
            tar.addfile(info, io.BytesIO(text.encode()))
    (folder / "compute-sanitizer").write_text(PROGRAMS["compute-sanitizer"])
    (folder / "compute-sanitizer").chmod(0o755)
    (folder / "measure").write_bytes((SOURCE / "script" / "measure-gpu").read_bytes())
    calls = folder / "calls"
    calls.write_text("")
    environment = {"PATH": f"{folder}:{os.environ['PATH']}", "CALLS": str(calls), "CARD": card}
    done = subprocess.run(["bash", folder / "measure", folder / "out", "--repeat", "7"], env=environment,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
    return done, (folder / "out" / "steps.md").read_text(), calls.read_text()


def expect(condition, *shown):
    if not condition:
        sys.exit("\n".join(map(str, ("wrong:",) + shown)))


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    # A step was killed, as by timeout, and another fails: the following steps are still done.
    done, steps, calls = run(folder, "Some Card")
    expect(done.returncode == 1, done)
    expect("| smoke test | passed |" in steps and "| bench | passed |" in steps, steps)
    expect("| frames | ended after 60 s |" in steps and "| tests | failed with 1 |" in steps, steps)
    expect("| initcheck | passed |" in steps, steps)
    expect(calls.count("--repeat 7") == 2 and calls.count("--small") == 1, calls)
    expect((folder / "out" / "tables.md").read_text() == "tables\n")
    expect(not (folder / "out" / "view.md").exists())
    expect("| bench | passed |" in done.stdout and "== frames" in (folder / "out" / "log").read_text(), done)
    # Without a GPU the trees of the papers are sufficient.
    PROGRAMS["coppice_drag_bench"] = BENCH
    done, steps, calls = run(folder, "no card: none")
    expect(done.returncode == 1 and "| tests | failed with 1 |" in steps, done, steps)
    expect("| frames | passed |" in steps and "memcheck" not in steps, steps)
    expect(calls.count("\n") == 2 and "--small" in calls and "--frames 3" in calls, calls)
    taken = subprocess.run([SOURCE / "script" / "bench-gpu", "--take", folder / "out"], capture_output=True, text=True)
    expect(taken.returncode == 1 and "without a card" in taken.stderr, taken)
    # With a GPU, all steps.
    PROGRAMS["cuda_card_test"] = "#!/bin/sh\n"
    done, steps, calls = run(folder, "Some Card")
    expect(done.returncode == 0 and "| memcheck | passed |" in steps and "| racecheck | passed |" in steps, done, steps)
    expect("no errors" in (folder / "out" / "sanitizer.txt").read_text())
    expect((folder / "out" / "view.md").read_text() == "tables\n")
    expect(len(list((folder / "out").iterdir())) <= 8)
