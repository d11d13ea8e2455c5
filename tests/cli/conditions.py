"""Conditions on JSON: key, key.key=value, key<number or key>number, separated by commas."""

import json
import re


def value_at(value, path):
    for part in path.split("."):
        if isinstance(value, list) and int(part) < len(value):
            value = value[int(part)]
            continue
        if not isinstance(value, dict) or part not in value:
            return None
        value = value[part]
    return value


def holds(value, sign, expected):
    if value is None or not sign:
        return value is not None
    if sign == "=":
        return value == expected if isinstance(value, str) else value == json.loads(expected)
    return value < float(expected) if sign == "<" else value > float(expected)


def broken(conditions, value):
    """Returns the conditions that are not satisfied, each with the actual value."""
    for condition in conditions.split(","):
        path, sign, expected = re.fullmatch(r"([^<>=]+)([<>=]?)(.*)", condition.strip()).groups()
        found = value_at(value, path)
        if not holds(found, sign, expected):
            yield f"{condition.strip()} does not hold: it is {json.dumps(found)}"
