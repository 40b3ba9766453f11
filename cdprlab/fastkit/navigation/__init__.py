"""Navigation of the coupled pair of bases: scanners, localization on a known map, planning, following. No engine."""
