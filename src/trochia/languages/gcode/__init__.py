"""RS274/NGC, as LinuxCNC 2.9 has it: a text to canonical functions, and those to a program in machine coordinates."""
