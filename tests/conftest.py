"""What every test shares: reproducible Hypothesis, no windows, and engines that may be missing."""

import importlib.util
import os

import pytest
from hypothesis import HealthCheck, settings

os.environ["MPLBACKEND"] = "Agg"
settings.register_profile("laws", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("laws")


@pytest.fixture(autouse=True)
def numbers_round_to_nearest():
    """Interval libraries change how the processor rounds; none may leave it so."""
    yield
    one, little = float("1"), float("1e-17")
    assert one + little == one and -one - little == -one, "the processor was left rounding upward or downward"


class MissingEngines:
    """Skips, with the reason, what asks for an engine that has no wheel on this machine.

    Where the engine is installed the same error is a failure.
    """

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]):
        report = yield
        reason = _missing_engine(call.excinfo.value) if call.excinfo else None
        if reason and report.failed:
            path, line, _ = item.location
            report.outcome, report.longrepr = "skipped", (path, line or 0, f"Skipped: {reason}")
        return report


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(MissingEngines())


def _missing_engine(error: BaseException) -> str | None:
    """The error's message if it is about pybullet and pybullet is not there; doctests wrap theirs."""
    if _installed("pybullet"):
        return None
    failures = getattr(error, "failures", [error])  # a doctest has one failure an example
    for cause in (failure.exc_info[1] for failure in failures if hasattr(failure, "exc_info")):
        return _missing_engine(cause)
    if isinstance(error, ImportError) and "pybullet" in str(error).lower():
        return str(error).splitlines()[0]
    return None


def _installed(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except ValueError:  # sys.modules[module] is None: blocked on purpose
        return False
