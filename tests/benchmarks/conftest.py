"""Prints each benchmark's ratio beside what the project promises."""

import pytest

_RATIOS: list[tuple[str, float, float]] = []


@pytest.fixture
def report(benchmark):
    """``report(name, ratio, promised)``: kept with the benchmark's data and printed at the end."""
    def add(name: str, ratio: float, promised: float) -> None:
        benchmark.extra_info["ratio"] = ratio
        _RATIOS.append((name, ratio, promised))

    return add


def pytest_terminal_summary(terminalreporter):
    """One line a ratio, measured against its reference in this same run."""
    for name, ratio, promised in _RATIOS:
        terminalreporter.write_line(f"{name:48} {ratio:6.2f} x   (promised: at most {promised:g} x)")
