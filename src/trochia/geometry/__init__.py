"""Plane curves: no machine, no time.  :mod:`nurbs` evaluates them, :mod:`cubics` turns them into cubics."""
