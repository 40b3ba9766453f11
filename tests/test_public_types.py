"""What public functions take and give has public names, which a type checker knows."""

import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import cdprlab as cl

FOREIGN = {"Any", "ArrayLike", "Callable", "Figure", "Iterable", "Mapping", "None", "Path", "Sequence"}


def test_annotations_of_public_functions_name_public_types():
    functions = [getattr(cl, name) for name in cl.__all__ if inspect.isfunction(getattr(cl, name))]
    named = {name for function in functions for kind in inspect.get_annotations(function).values()
             for name in re.findall(r"\b[A-Z]\w+", str(kind))}
    assert {name for name in named - FOREIGN if not hasattr(cl, name)} == set()


@pytest.mark.long   # mypy reads all of the package
def test_a_program_that_checks_every_type_passes(tmp_path: Path):
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), "--config-file", "",
                           Path(__file__).with_name("users_program.py")],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
