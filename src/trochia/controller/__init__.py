"""The live machine: one object that owns every decision about motion."""
