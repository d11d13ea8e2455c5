#!/usr/bin/env python3
"""Every option that the help of a command names is in `coppice schema`, and the other way round."""

import json
import re
import subprocess
import sys


def output(program, *words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def commands_in_help(program):
    listed = output(program, "help").split("Subcommands:")[1]
    return set(re.findall(r"^  (\w+) ", listed, re.MULTILINE)) - {"help"}


def options_in_help(program, command):
    """The first word of each line of the list, without the letter before it: "input" or "--output"."""
    names = re.findall(r"^  (?:-\w,)?((?:--)?[a-z][\w-]*)", output(program, "help", command), re.MULTILINE)
    return set(names) - {"--help"}


def options_in_schema(entries):
    # A switch that is on is shown by what turns it off.
    on = [e["name"] for e in entries if e["type"] == "bool" and e["default"]]
    return {e["name"] for e in entries} - set(on) | {"--no-" + name[2:] for name in on}


def members(fields, path=""):
    for field in fields:
        if field["type"] == "options":
            yield from members(field["fields"], path + field["name"] + ".")
        else:
            yield path + field["name"], field


# Which structs the commands take their options from.
STRUCTS = {"mesh": ("mesh", "restore", "read_skeleton"), "check": ("check", "check_cloud", "read_skeleton"),
           "extract": ("extract_mesh", "extract_cloud", "extract_plot", "write_skeleton", "mesh"), "info": ("read_skeleton",),
           "compare": ("compare", "read_skeleton"), "convert": ("read_skeleton", "write_skeleton"),
           "sketch": ("sketch", "draw_sketch", "read_skeleton", "write_skeleton"), "render": ("render", "read_skeleton"), "view": ("view", "edit_demo", "mesh", "read_skeleton"), "scan": ("scan",)}


def main():
    program = sys.argv[1]
    schema = json.loads(output(program, "schema"))
    wrong = []
    if commands_in_help(program) != set(schema["commands"]):
        wrong.append(f"commands: {commands_in_help(program) ^ set(schema['commands'])}")
    for command, entries in schema["commands"].items():
        differing = options_in_help(program, command) ^ options_in_schema(entries)
        if differing:
            wrong.append(f"{command}: {sorted(differing)}")
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
