"""The page of equations: what the docstrings cite today, each link a file, each paper's equations in order."""

import importlib.util
import re
import sys
from pathlib import Path

import notebooks
import pytest

import cdprlab as cl

DOCS = notebooks.CHECKOUT / "docs"


@pytest.fixture(scope="module")
def equations():
    sys.path.insert(0, str(DOCS))
    spec = importlib.util.spec_from_file_location("equations", DOCS / "equations.py")
    module = sys.modules["equations"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.path.remove(str(DOCS))
    return module


@pytest.fixture(scope="module")
def tables(equations):
    return equations.tables()


def rows(table):
    return [line.split(" | ") for line in table.splitlines()[2:]]


def test_the_page_is_made_of_todays_docstrings(tables):
    page = (DOCS / "equations.md").read_text(encoding="utf-8")
    for name, table in tables.items():
        assert f"<!-- table {name} -->\n\n{table.strip()}\n\n<!-- end -->" in page, "run python docs/equations.py"


def test_every_link_leads_to_a_file(tables):
    links = re.findall(r"\]\((\.\./[^)]+)\)", "".join(tables.values()))
    assert len(links) > 80
    assert [link for link in links if not (DOCS / link).is_file()] == []


@pytest.mark.parametrize(("paper", "place", "function", "lesson"), [
    ("okoli", "(2.10)", "wrench_matrix", "02"),
    ("okoli", "(2.17)", "gravity_wrench", "04"),
    ("okoli", "(6.25)", "quadratic_program", "04"),
    ("okoli", "(6.6)–(6.14)", "quintic", "05"),
    ("okoli", "section 6.4.5", "improved_closed_form", "04"),
    ("rasheed", "(7)–(9)", "base_jacobian", "07"),
    ("rasheed", "(16)–(17)", "submatrix_twist_set", "08"),
    ("pedemonte", "(21)–(24)", "tipping_moments", "09"),
    ("ramadour", "section IV.A", "classify_configurations", "12"),
])
def test_from_an_equation_to_its_function_and_lesson(tables, paper, place, function, lesson):
    found = [row for row in rows(tables[paper]) if row[0] == f"| {place}" and f"[`{function}`]" in row[1]]
    assert len(found) == 1 and f"[{lesson}](" in found[0][-1]


def test_equations_stand_in_the_papers_order(tables):
    first = [re.match(r"\| \(([\d.]+)\)", row[0]) for row in rows(tables["okoli"])]
    numbers = [tuple(map(int, match[1].split("."))) for match in first if match]
    assert numbers == sorted(numbers) and len(numbers) > 15


def test_every_source_names_a_paper_or_says_that_there_is_none(equations):
    for cited in equations.cited():
        assert equations.references(cited.source), f"{cited.path}: {cited.name} names no paper: {cited.source}"


def test_every_method_is_found_by_its_name(equations):
    assert set(cl.tension_methods()) <= {cited.name for cited in equations.cited()}
    assert all(Path(cited.path).name != "__init__.py" for cited in equations.cited())
