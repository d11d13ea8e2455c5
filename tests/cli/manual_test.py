#!/usr/bin/env python3
"""manual_test.py SCRIPT PROGRAM: script/manual writes a man page for every command, with all of its options, and bash completes."""

import json
import pathlib
import subprocess
import sys
import tempfile

# Words of a command line, the last of them unfinished, and its completions.
COMPLETED = {("ext",): ["extract"], ("mesh", "--lev"): ["--levels"], ("mesh", "--method", "cyl"): ["cylinders"],
             ("help", "comp"): ["compose", "compare"], ("mesh", "oak"): []}


def incomplete_pages(folder, commands):
    for name, command in commands.items():
        page = folder / f"man/man1/coppice-{name}.1"
        text = page.read_text().replace("\\-", "-") if page.exists() else ""
        missing = [option["name"] for option in command["options"]
                   if option["name"].startswith("--") and f"\\fB{option['name']}\\fR" not in text]
        if not text or missing:
            yield f"{page.name} lacks {missing or 'all'}"


def wrong_completions(folder):
    file = folder / "bash-completion/completions/coppice"
    for words, expected in COMPLETED.items():
        script = f'. "$0"; COMP_WORDS=(coppice "$@") COMP_CWORD={len(words)}; _coppice; printf "%s\\n" "${{COMPREPLY[@]}}"'
        found = subprocess.run(["bash", "-c", script, file, *words], capture_output=True, text=True, check=True).stdout.split()
        if found != expected:
            yield f"bash completes {' '.join(words)} to {found}, not {expected}"


def main():
    script, program = sys.argv[1:]
    commands = json.loads(subprocess.run([program, "schema"], check=True, capture_output=True).stdout)["commands"]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([script, program, folder], check=True)
        faults = [*incomplete_pages(pathlib.Path(folder), commands), *wrong_completions(pathlib.Path(folder))]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
