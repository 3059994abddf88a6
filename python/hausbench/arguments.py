"""Checks of single arguments: numbers, flags, counts and choices."""

from __future__ import annotations

import operator
from collections.abc import Mapping

from hausbench.errors import InputError
from hausbench.interval import exact


def number(value: object, name: str) -> float:
    if type(value) is float:
        return value
    if isinstance(value, (str, bytes, bool)):
        raise InputError(f"{name}: {value!r} is not a number")
    try:
        rounded = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: {value!r} is not a number") from None
    if exact(value) != rounded and rounded == rounded:
        raise InputError(f"{name}: no double is {value!r}: round it with float(), if you mean that")
    return rounded


def flag(value: object, name: str) -> bool:
    chosen = exact(value)
    if not isinstance(chosen, bool):
        raise InputError(f"{name}: {value!r} is neither True nor False")
    return chosen


def count(value: object, name: str) -> int:
    try:
        chosen = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        chosen = 0
    if not 1 <= chosen < 2**31 or isinstance(value, bool):
        raise InputError(f"{name}: {value!r} is not a number of threads: give an integer from 1")
    return chosen


def choice(value: str, name: str, choices: Mapping[str, int]) -> int:
    try:
        return choices[value]
    except (KeyError, TypeError):
        raise InputError(f"{name}: {value!r} is not one of {', '.join(choices)}") from None
