"""Plane curves: no machine, no time.  :mod:`nurbs` evaluates them, :mod:`biarc` turns them into tangent arcs."""
