"""For courses that keep nbgrader's gradebook: what `python -m cdprlab grade` found, written into it.

``python lessons/source/fill_gradebook.py ~/course/grades ~/course/gradebook.db``
"""

from __future__ import annotations

import json
import os
import sys
import warnings
from pathlib import Path

from nbgrader.api import Gradebook


def fill(grades: Path, database: Path) -> int:
    """Write each check's points; returns how many submissions went in.

    grades : the folder that was graded into; penalties are the gradebook's own affair
    database : made if missing
    """
    # It calls alembic by its name, which is beside Python.
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    count = 0
    with warnings.catch_warnings(action="ignore"), Gradebook(f"sqlite:///{database}") as book:
        for path in sorted((grades / "results").glob("[!.]*/*.json")):
            result = json.loads(path.read_text(encoding="utf-8"))
            student, where = result["student"], (result["lesson"], result["lesson"])
            if result["outcomes"]:
                book.update_or_create_assignment(result["lesson"])
                book.update_or_create_notebook(*where)
                book.update_or_create_student(student)
                for outcome in result["outcomes"]:
                    book.update_or_create_grade_cell(outcome["check"], *where, max_score=outcome["max_points"],
                                                     cell_type="code")
                book.update_or_create_submission(result["lesson"], student)
                for outcome in result["outcomes"]:
                    grade = book.find_grade(outcome["check"], *where, student)
                    grade.auto_score, grade.needs_manual_grade = outcome["points"], False
                book.db.commit()
                count += 1
    return count


if __name__ == "__main__":
    print(f"{fill(Path(sys.argv[1]), Path(sys.argv[2]))} submissions")
