"""Workspaces: which poses a robot can serve, by criteria that combine, over grids, swept and certified."""
