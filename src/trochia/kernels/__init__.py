"""Typed faces of the C core, one file per header; the only importers of the compiled module.

Bad sizes and ranges are refused here, before C sees them.  Calls release the GIL.
"""
