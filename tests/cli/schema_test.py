#!/usr/bin/env python3
"""Every option that the help of a command names is in `coppice schema`, and the other way round. Without --help-all the help has
few options, those that are common in the schema, each described by a sentence."""

import json
import re
import subprocess
import sys


MAX_SHOWN = 15  # options in the help of a command
COLUMN = 30  # where the help describes an option


def output(program, *words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def commands_in_help(program):
    listed = output(program, "help").split("Subcommands:")[1]
    return set(re.findall(r"^  (\w+) ", listed, re.MULTILINE)) - {"help"}


def options_in(text):
    """Returns the description of every option: "input" or "--output", without its letter. Texts begin at one column, if needed a line
    below the option."""
    lines, options = text.splitlines(), {}
    for line, after in zip(lines, [*lines[1:], ""]):
        name = re.match(r"  (?:-\w,)?((?:--)?[a-z][\w-]*)", line)
        if name and name[1] not in ("--help", "--help-all"):
            options[name[1]] = after.strip() if after.startswith(" " * COLUMN) else line[COLUMN:]
    return options


def options_in_schema(entries):
    # A switch that is on is shown by the flag that turns it off.
    on = [e["name"] for e in entries if e["type"] == "bool" and e["default"]]
    return {e["name"] for e in entries} - set(on) | {"--no-" + name[2:] for name in on}


def faults_of_short_help(program, command, entries):
    text = output(program, command, "--help")
    shown = options_in(text)
    if set(shown) != options_in_schema([e for e in entries if e["common"]]):
        yield f"shows {sorted(shown)}, which are not the common options of the schema"
    if len(shown) > MAX_SHOWN:
        yield f"shows {len(shown)} options, more than {MAX_SHOWN}"
    if text.splitlines()[-1] != f"coppice {command} --help-all prints all {len(entries)} options.":
        yield "ends without a line that names --help-all"
    for name, explained in shown.items():
        if not re.match(r"[A-Z0-9].*[^.]\.( \[.*\])?$", explained):
            yield f"{name} is not explained by one sentence: {explained}"


def members(fields, path=""):
    for field in fields:
        if field["type"] == "options":
            yield from members(field["fields"], path + field["name"] + ".")
        else:
            yield path + field["name"], field


# Option structs of the commands.
STRUCTS = {"mesh": ("mesh", "restore", "read_skeleton"), "check": ("check", "check_cloud", "read_skeleton"),
           "extract": ("extract_mesh", "extract_cloud", "extract_plot", "write_skeleton", "mesh"), "info": ("read_skeleton",),
           "compare": ("compare", "read_skeleton"), "convert": ("read_skeleton", "write_skeleton"),
           "sketch": ("sketch", "draw_sketch", "read_skeleton", "write_skeleton"), "render": ("render", "read_skeleton"), "view": ("view", "mesh", "read_skeleton"), "scan": ("scan",)}


def main():
    program = sys.argv[1]
    schema = json.loads(output(program, "schema"))
    wrong = []
    if commands_in_help(program) != set(schema["commands"]):
        wrong.append(f"commands: {commands_in_help(program) ^ set(schema['commands'])}")
    for command, described in schema["commands"].items():
        entries = described["options"]
        for words in ((command, "--help-all"), ("help", command, "--all")):
            differing = options_in(output(program, *words)).keys() ^ options_in_schema(entries)
            if differing:
                wrong.append(f"{' '.join(words)}: {sorted(differing)}")
        wrong += [f"{command} --help: {fault}" for fault in faults_of_short_help(program, command, entries)]
        fields = {e["field"] for e in entries if "field" in e} | {e["name"].lstrip("-") for e in entries}
        for struct in STRUCTS.get(command, ()):
            wrong += [f"{command}: no option for {struct}.{path}" for path, _ in members(schema[struct])
                      if path not in fields]
    for struct in sorted(schema.keys() - {"scene", "commands"}):
        wrong += [f"{struct}.{path}: no default" for path, field in members(schema[struct]) if "default" not in field]
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
