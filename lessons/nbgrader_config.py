"""nbgrader's settings for this course: copy this file and source/ into a course folder; docs/instructors.md."""

c = get_config()  # noqa: F821 (nbgrader provides it)
c.CourseDirectory.course_id = "cdprlab"

c.ClearSolutions.code_stub = {"python": 'raise NotImplementedError("Your turn: replace this line.")'}
c.ClearSolutions.text_stub = "*Your answer here.*"

c.ExecutePreprocessor.timeout = 60  # [s] a cell; a whole solved lesson needs less
c.OverwriteCells.add_missing_cells = True  # a deleted check is put back and counts
# nbgrader takes all points from a check that writes to stderr, where Bullet greets when first imported.
c.IgnorePattern.enabled = True
c.IgnorePattern.pattern = "pybullet build time"
