"""Skips tests whose optional tool is missing. With `--insist`, used by targets that promise the tool, such a skip is a failure."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--insist", action="store_true", help="a test that is skipped has failed")


def fail_skipped(item: pytest.Item) -> Generator[None, Any, None]:
    report = (yield).get_result()
    if item.config.getoption("insist") and report.skipped:
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid}: {report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr}"


# Not a decorator, because decorators of pytest 7 have no types.
pytest_runtest_makereport = pytest.hookimpl(hookwrapper=True)(fail_skipped)
