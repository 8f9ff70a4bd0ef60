"""One file per modal group: its codes as rows of a table, and what each does.

Every function takes the sorted line, the modal state and the sink, and does one thing.
"""
