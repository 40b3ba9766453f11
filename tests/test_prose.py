"""Numbers in the prose of lessons and pages are what the lesson's cells, and the page's tables, come to."""

from __future__ import annotations

from pathlib import Path

import notebooks
import prose_numbers
import pytest

QUICK = ["02_wrench_matrix", "04_tension_distribution"]
WITH_RESULTS = [name for name in notebooks.names() if prose_numbers.results(name)]


@pytest.fixture(autouse=True)
def _undrawn_in_a_folder_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    yield
    notebooks.round_to_nearest()


@pytest.mark.parametrize("name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.long)
                                  for name in WITH_RESULTS])
def test_results_in_a_lessons_prose_are_what_its_cells_compute(name: str):
    assert prose_numbers.differences(name, prose_numbers.computed(name)) == []


@pytest.mark.parametrize("name", notebooks.names())
def test_every_number_in_a_lessons_prose_is_computed_or_given(name: str):
    assert prose_numbers.unaccounted(name) == [], f"name them in tests/prose/{name}.py"


@pytest.mark.parametrize("name", notebooks.names())
def test_what_is_named_stands_in_the_prose(name: str):
    """So that no word outlives what it is about."""
    text, spoken = " ".join(prose_numbers.prose(name).split()), prose_numbers.spoken(name)
    assert [result.words for result in prose_numbers.results(name) if result.words not in text] == []
    assert [words for words in prose_numbers.covering(name) if words not in spoken] == []


@pytest.mark.parametrize("page", sorted(prose_numbers.PAGES))
def test_numbers_in_a_pages_prose_are_in_its_tables_computed_or_given(page: str):
    assert prose_numbers.page_differences(page) == []
    assert prose_numbers.page_unaccounted(page) == [], f"name them in tests/prose/pages.py, under {page}"
