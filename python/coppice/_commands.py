"""Functions for all commands, generated from the option schema of the library."""

from __future__ import annotations

import inspect
import json
import keyword
import math
import os
import textwrap
import threading
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from . import _library as c
from ._errors import UsageError
from ._objects import Image, Object, Points, Skeleton, Surface, wrap
from ._task import Progress, Task

#: Commands that return an object if output= is not given, with the option of that output.
RESULTS: Dict[str, Tuple[str, type]] = {
    "mesh": ("output", Surface),
    "extract": ("output", Skeleton),
    "sketch": ("output", Skeleton),
    "grow": ("output", Skeleton),
    "sprout": ("output", Skeleton),
    "edit": ("output", Skeleton),
    "tree": ("output", Surface),
    "leaves": ("output", Surface),
    "scan": ("output", Points),
    "render": ("output", Image),
    "view": ("output", Image),
}
#: Options that replace --output as the reason for not returning an object.
_OTHER_OUTPUTS = {"tree": "image", "leaves": "image"}


class Result:
    """Result of a command that returns no object."""

    def __init__(self, task: Task, status: int) -> None:
        #: Text that the command printed, such as a table.
        self.text = task.output
        #: Stages with seconds, counts, repairs and warnings.
        self.report: Dict[str, Any] = task.report
        #: Sentences for the user, such as the defects that a check found.
        self.messages: List[str] = task.message.splitlines()
        #: False if a check found a defect, or a result is in doubt.
        self.passed = status == c.OK

    def __repr__(self) -> str:
        return "<coppice.Result: %s>" % ("passed" if self.passed else "not passed: " + " ".join(self.messages))


class Figures(Dict[str, Any]):
    """Figures by name, as a command prints them with --json."""

    def __init__(self, figures: Mapping[str, Any], result: Result) -> None:
        super().__init__(figures)
        #: See Result.
        self.report = result.report
        self.messages = result.messages
        self.passed = result.passed


class Parameter(NamedTuple):
    """A keyword argument of a function."""

    name: str
    option: Mapping[str, Any]  # its entry in the schema

    @property
    def is_positional(self) -> bool:
        return not self.option["name"].startswith("-")


class Command(NamedTuple):
    """A command of the program."""

    name: str
    help: str
    parameters: List[Parameter]

    def find(self, name: str) -> Optional[Parameter]:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        return None


_lock = threading.Lock()
_commands: Dict[str, Command] = {}
_functions: Dict[str, Callable[..., Any]] = {}

# Options for the terminal, which functions replace.
_LEFT_OUT = {"--quiet", "--report", "--json", "--max-memory"}


def _parameter_name(option: str) -> str:
    name = option.lstrip("-").replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def commands() -> Dict[str, Command]:
    """Returns all commands by name; reads the schema of the library at the first call."""
    with _lock:
        if not _commands:
            task = Task()
            task.run(["schema"], progress=False)
            for name, entry in json.loads(task.output)["commands"].items():
                parameters = [Parameter(_parameter_name(o["name"]), o) for o in entry["options"]]
                _commands[name] = Command(name, entry["help"], parameters)
        return _commands


def _has_json(command: Command) -> bool:
    return any(p.option["name"] == "--json" for p in command.parameters)


class _Words:
    """Makes the words of the command line of a call."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._count = 0
        self.words: List[str] = []

    def add(self, parameter: Parameter, value: Any) -> None:
        kind = parameter.option["type"]
        if kind == "bool":
            return self._add_switch(parameter, value)
        if kind in ("files", "texts"):
            values = list(value) if isinstance(value, (list, tuple)) else [value]
        elif kind == "place" and not isinstance(value, str):
            values = [self._place(parameter, value)]
        else:
            values = [value]
        for one in values:
            word = self._file(one, parameter) if kind in ("file", "files") else self._word(one, parameter)
            if not parameter.is_positional:
                self.words.append("%s=%s" % (parameter.option["name"], word))
            else:
                self.words.append("./" + word if word.startswith("-") else word)

    def _add_switch(self, parameter: Parameter, value: Any) -> None:
        if not isinstance(value, (bool, int)) or value not in (0, 1):
            raise UsageError("%s takes True or False, not %r" % (parameter.name, value))
        name = parameter.option["name"]
        if value:
            self.words.append(name)
        elif parameter.option.get("field"):
            self.words.append("--no-" + name[2:])

    def _place(self, parameter: Parameter, value: Any) -> str:
        try:
            return ",".join(repr(float(x)) for x in value)
        except (TypeError, ValueError):
            raise UsageError("%s takes three numbers, not %r" % (parameter.name, value)) from None

    def _word(self, value: Any, parameter: Parameter) -> str:
        if isinstance(value, bool) or value is None:
            raise UsageError("%s takes a %s, not %r" % (parameter.name, parameter.option["type"], value))
        if isinstance(value, (str, int)):
            return str(value)
        try:
            number = float(value)  # numbers of NumPy too
        except (TypeError, ValueError):
            raise UsageError("%s takes a %s, not %r" % (parameter.name, parameter.option["type"], value)) from None
        return repr(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)

    def _file(self, value: Any, parameter: Parameter) -> str:
        if isinstance(value, Object):
            if parameter.option.get("output"):
                raise UsageError("%s takes the name of a file, not an object" % parameter.name)
            self._count += 1
            name = value._name.replace(":", ":%d_" % self._count)
            self._task.put(name, value._handle)
            return name
        try:
            name = os.fsdecode(value)
        except TypeError:
            raise UsageError("%s takes a file or an object of coppice, not %r" % (parameter.name, value)) from None
        if not name:
            raise UsageError("%s takes the name of a file, not an empty text" % parameter.name)
        return name


def _unknown(command: Command, name: str) -> UsageError:
    import difflib

    close = difflib.get_close_matches(name, [p.name for p in command.parameters], 1)
    hint = "; did you mean %s?" % close[0] if close else "; see help(coppice.%s)" % command.name
    return UsageError("%s() has no argument %s%s" % (command.name, name, hint))


def call(name: str, /, *inputs: Any, progress: Progress = None, **options: Any) -> Any:
    """Runs a command: call("mesh", tree, levels=2) is the same as mesh(tree, levels=2)."""
    command = commands().get(name)
    if command is None:
        raise UsageError("there is no command %s; coppice.commands() lists them" % name)
    positional = [p for p in command.parameters if p.is_positional]
    given: Dict[str, Any] = {}
    if len(inputs) > len(positional):
        raise UsageError("%s() takes %d inputs, not %d" % (name, len(positional), len(inputs)))
    for parameter, value in zip(positional, inputs):
        given[parameter.name] = value
    for key, value in options.items():
        if key in given:
            raise UsageError("%s() has two values for %s" % (name, key))
        if command.find(key) is None or "--" + key.replace("_", "-") in _LEFT_OUT:
            raise _unknown(command, key)
        given[key] = value
    return _run(command, given, progress)


def _run(command: Command, given: Dict[str, Any], progress: Progress) -> Any:
    task = Task()
    words = _Words(task)
    result = _result_name(command, given)
    for parameter in command.parameters:
        value = given.get(parameter.name)
        if value is not None:
            words.add(parameter, value)
    has_json = _has_json(command)
    if result is not None:
        words.words.append("--output=" + result)
    elif has_json:
        words.words.append("--json")
    status = task.run([command.name, *words.words], progress)
    held = result or _held_output(given.get("output"))
    handle = task.take(held) if held is not None else None
    if handle is not None:
        return wrap(handle, task.report)
    outcome = Result(task, status)
    return Figures(json.loads(outcome.text), outcome) if has_json and outcome.text else outcome


def _held_output(output: Any) -> Optional[str]:
    """Returns an output that is an object in memory, which the caller named."""
    return output if isinstance(output, str) and output.startswith("memory:") else None


def _result_name(command: Command, given: Mapping[str, Any]) -> Optional[str]:
    """Returns the name in memory of the result; None if files are written, or there is no result."""
    if command.name not in RESULTS or given.get(_OTHER_OUTPUTS.get(command.name, "")) is not None:
        return None
    option, kind = RESULTS[command.name]
    if given.get(option) is not None or not issubclass(kind, Object):
        return None
    return kind._name


def _annotation(parameter: Parameter) -> str:
    option = parameter.option
    kind = option["type"]
    if kind == "choice":
        return "Literal[%s]" % ", ".join(repr(choice) for choice in option["choices"])
    return {
        "bool": "bool",
        "int": "int",
        "float": "float",
        "place": "Sequence[float]",
        "texts": "Union[str, Sequence[str]]",
        "file": "Input" if not option.get("output") else "Path",
        "files": "Union[Input, Sequence[Input]]" if not option.get("output") else "Union[Path, Sequence[Path]]",
    }[kind]


def shown_parameters(command: Command) -> List[Parameter]:
    """Returns the keyword arguments: positional ones first."""
    shown = [p for p in command.parameters if p.option["name"] not in _LEFT_OUT]
    return [p for p in shown if p.is_positional] + [p for p in shown if not p.is_positional]


def _default(parameter: Parameter) -> Any:
    """Returns the default of a keyword argument; angles are degrees."""
    value = parameter.option.get("default")
    if parameter.option.get("unit") == "radian" and isinstance(value, (int, float)):
        return round(math.degrees(value), 4)
    return value


def _make_doc(command: Command) -> str:
    lines = [command.help, ""]
    if command.name in RESULTS:
        lines += ["Returns a %s, or a Result if output is given." % RESULTS[command.name][1].__name__, ""]
    elif _has_json(command):
        lines += ["Returns Figures, a dictionary.", ""]
    else:
        lines += ["Returns a Result.", ""]
    group = ""
    for parameter in shown_parameters(command):
        if parameter.option.get("group", "") != group:
            group = parameter.option.get("group", "")
            lines += ["", group + ":"]
        lines += textwrap.wrap(
            "%s: %s" % (parameter.name, parameter.option["text"]), 110, initial_indent="  ", subsequent_indent="    "
        )
    lines += ["", "progress: function that receives the name of the stage and its progress from 0 to 1, and may return"]
    lines += ["    False to cancel; True shows it by tqdm; by default on a terminal with tqdm."]
    return "\n".join(lines)


def _make_signature(command: Command) -> inspect.Signature:
    empty = inspect.Parameter.empty
    out = []
    for parameter in shown_parameters(command):
        is_positional = parameter.is_positional
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if is_positional else inspect.Parameter.KEYWORD_ONLY
        out.append(inspect.Parameter(parameter.name, kind, default=_default(parameter), annotation=_annotation(parameter)))
    out.append(inspect.Parameter("progress", inspect.Parameter.KEYWORD_ONLY, default=None, annotation="Progress"))
    return inspect.Signature(out, return_annotation=empty)


def function(name: str) -> Callable[..., Any]:
    """Returns the function of a command. Raises KeyError if there is none."""
    command = commands()[name]
    made = _functions.get(name)
    if made is not None:
        return made

    def run(*inputs: Any, progress: Progress = None, **options: Any) -> Any:
        return call(name, *inputs, progress=progress, **options)

    run.__name__ = run.__qualname__ = name
    run.__module__ = "coppice"
    run.__doc__ = _make_doc(command)
    run.__signature__ = _make_signature(command)  # type: ignore[attr-defined]
    return _functions.setdefault(name, run)


def make_stub(names: Sequence[str]) -> str:
    """Returns the declarations of functions for type checkers."""
    out = []
    for name in names:
        command = commands()[name]
        lines = []
        has_star = False
        for parameter in shown_parameters(command):
            if not parameter.is_positional and not has_star:
                lines.append("*")
                has_star = True
            lines.append("%s: Optional[%s] = ..." % (parameter.name, _annotation(parameter)))
        if not has_star:
            lines.append("*")
        lines.append("progress: Progress = ...")
        result = RESULTS[name][1].__name__ if name in RESULTS else "Figures" if _has_json(command) else "Result"
        out.append("def %s(\n    %s,\n) -> %s: ...\n" % (name, ",\n    ".join(lines), result))
    return "\n".join(out)
