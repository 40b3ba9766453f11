"""The robot designer: a world edited field by field, judged at once. `history`, `edits`, `fields` and `assessment` know
no widgets; `session` joins them; `picture`, `forms` and `panel` show them."""
