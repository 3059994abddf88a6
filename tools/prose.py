#!/usr/bin/env python3
"""Counts habits of prose that make readers stumble, in comments, docstrings, documents and messages
(quoted texts of four words and more).

prose.py [--places] [PATH ...]   PATH: files or folders of the repository (default: all of it)

Prints one line for each habit: its count, its rate per 1,000 words, and the rate that we aim for.
--places lists the places. The exit code is 0 whatever the counts.
"""

import argparse
import io
import re
import subprocess
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
NOUN = "it|they|this|that|these|the|a|an|is|are|was|were|has|have|each|one|all|no"


class Habit(NamedTuple):
    name: str
    pattern: re.Pattern[str]
    goal: float | None = None  # occurrences per 1,000 words


OPENS = r"(?:^|(?<=[.!?:;] ))"
HABITS = [
    Habit('a sentence opens with "Of"', re.compile(OPENS + r"Of\b"), 0.05),
    Habit('"what it is" as a noun', re.compile(rf"\b[Ww]hat (?:{NOUN})\b(?![^.]*\?)"), 0.2),
    Habit('"that of", "those of"', re.compile(r"\b[Tt]h(?:at|ose) of\b"), 0.1),
    Habit('a sentence opens with "Where"', re.compile(OPENS + r"Where\b(?![^.]*\?)"), 0.1),
    Habit('"all that"', re.compile(r"\b[Aa]ll that\b")),
    Habit('"is no", "are no"', re.compile(r"\b(?:is|are) no\b(?! (?:longer|more than))")),
    Habit('"nobody", "whole number"', re.compile(r"\b[Nn]obody\b|\bwhole number")),
    Habit('"who", "whoever"', re.compile(r"\b[Ww]ho(?:ever)?\b")),
]


class Paragraph(NamedTuple):
    line: int
    text: str


def joined(lines: list[tuple[int, str]]) -> Iterator[Paragraph]:
    """Joins consecutive non-blank lines into paragraphs, so that a sentence is counted whole."""
    start, last = 0, 0
    words: list[str] = []
    for number, text in [*lines, (-1, "")]:
        if start and text.strip() and number == last + 1:
            words.append(text.strip())
        else:
            if start:
                yield Paragraph(start, " ".join(words))
            start, words = (number, [text.strip()]) if text.strip() else (0, [])
        last = number


def after_mark(text: str, mark: str) -> list[tuple[int, str]]:
    """Returns the comments that start with a mark, with their line numbers. A mark inside a string
    or a URL does not count."""
    comments = []
    for number, line in enumerate(text.splitlines(), 1):
        hit = re.search(
            rf"(?:^|\s){mark}+!?(?:\s+|$)(.*)",
            re.sub(r'"(?:\\.|[^"\\])*"', lambda quoted: "_" * len(quoted[0]), line),
        )
        if hit:
            comments.append((number, line[hit.start(1) :]))
    return comments


QUOTED = re.compile(r'"((?:\\.|[^"\\])*)"')


def is_message(text: str) -> bool:
    return len(text.split()) >= 4


def messages_of_cpp(text: str) -> list[tuple[int, str]]:
    """Returns the quoted texts of each line without comments that look like sentences. A text that
    goes on in the next line is one."""
    messages = []
    for number, line in enumerate(text.splitlines(), 1):
        quoted = " ".join(QUOTED.findall(re.sub(r"(?:^|\s)//.*", "", line)))
        if is_message(quoted):
            messages.append((number, quoted))
    return messages


def messages_of_python(text: str) -> list[tuple[int, str]]:
    messages = []
    middle = getattr(tokenize, "FSTRING_MIDDLE", None)  # from Python 3.12
    before = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        docstring = before in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
        if token.type == middle or (token.type == tokenize.STRING and not docstring):
            messages += [
                (token.start[0] + i, line.strip("fr\"' "))
                for i, line in enumerate(token.string.splitlines())
                if is_message(line)
            ]
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            before = token.type
    return messages


def of_python(text: str) -> list[tuple[int, str]]:
    comments = []
    before = tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            comments.append((token.start[0], token.string.lstrip("#! ")))
        elif token.type == tokenize.STRING and before in (
            tokenize.NEWLINE,
            tokenize.INDENT,
            tokenize.DEDENT,
        ):
            comments += [
                (token.start[0] + i, line.strip('" '))
                for i, line in enumerate(token.string.splitlines())
            ]
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            before = token.type
    return comments


def of_document(text: str) -> list[tuple[int, str]]:
    """Returns the prose of a Markdown page, without code."""
    numbered, code = [], False
    for number, line in enumerate(text.splitlines(), 1):
        code ^= line.lstrip().startswith("```")
        numbered.append(
            (number, "" if code or line.lstrip().startswith("```") else line.strip("#|>-* "))
        )
    return numbered


def prose(path: Path) -> list[Paragraph]:
    text = path.read_text(encoding="utf-8")
    tests = "tests" in path.relative_to(ROOT).parts  # their texts are parts of messages, and data
    if path.suffix in (".cpp", ".h"):
        return [*joined(after_mark(text, "/")), *joined([] if tests else messages_of_cpp(text))]
    if path.suffix == ".py":
        return [*joined(of_python(text)), *joined([] if tests else messages_of_python(text))]
    if path.suffix == ".md":
        lines = of_document(text)
    else:
        lines = after_mark(text, "#")
    return list(joined(lines))


def files(paths: list[Path]) -> list[Path]:
    names = subprocess.run(
        ["git", "ls-files", "-z", *map(str, paths)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\0")
    kinds = {".cpp", ".h", ".py", ".md", ".toml", ".cmake", ".in"}
    chosen = [ROOT / name for name in names if name and not name.startswith("results/")]
    return [
        path
        for path in chosen
        if path.suffix in kinds
        or path.name in ("Makefile", "CMakeLists.txt")
        or (not path.suffix and path.parent.name in ("tools", ".ci"))
    ]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--places", action="store_true", help="list every place")
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH")
    arguments = parser.parse_args()
    places: dict[str, list[str]] = {habit.name: [] for habit in HABITS}
    words = 0
    for path in files([path.resolve() for path in arguments.paths] or [ROOT]):
        for paragraph in prose(path):
            words += len(paragraph.text.split())
            for habit in HABITS:
                for hit in habit.pattern.finditer(paragraph.text):
                    around = paragraph.text[max(0, hit.start() - 30) : hit.end() + 50]
                    places[habit.name].append(
                        f"{path.relative_to(ROOT)}:{paragraph.line}: {around}"
                    )
    print(f"{'habit':<34} {'count':>6} {'per 1,000':>10} {'goal':>6}   ({words:,} words)")
    for habit in HABITS:
        goal = "" if habit.goal is None else f"{habit.goal:.2f}"
        print(
            f"{habit.name:<34} {len(places[habit.name]):>6} {1000 * len(places[habit.name]) / max(words, 1):>10.2f} {goal:>6}"
        )
        if arguments.places:
            print(*(f"    {place}" for place in places[habit.name]), sep="\n")


if __name__ == "__main__":
    main()
