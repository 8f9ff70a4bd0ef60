"""Numbers and pictures from programs, plans and recordings; pure functions, no motion."""
