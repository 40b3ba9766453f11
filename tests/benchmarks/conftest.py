"""Prints each benchmark's ratio beside what the project promises."""

import pytest

_RATIOS: list[tuple[str, float, str]] = []


@pytest.fixture
def report(benchmark):
    """``report(name, ratio, promised, at_least=False)``: kept with the benchmark's data and printed at the end.

    promised : the most (with at_least: the least) the ratio should be; None where nothing is promised
    """
    def add(name: str, ratio: float, promised: float | None, *, at_least: bool = False) -> None:
        benchmark.extra_info["ratio"] = ratio
        word = "at least" if at_least else "at most"
        _RATIOS.append((name, ratio, "" if promised is None else f"   (promised: {word} {promised:g} x)"))

    return add


def pytest_terminal_summary(terminalreporter):
    """One line a ratio, measured against its reference in this same run."""
    for name, ratio, promise in _RATIOS:
        terminalreporter.write_line(f"{name:56} {ratio:7.2f} x{promise}")
