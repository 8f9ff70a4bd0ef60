"""The firmware as a live backend: a board on a serial port, or its image on the simulated chip."""
