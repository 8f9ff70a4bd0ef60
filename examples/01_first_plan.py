"""From a few lines of G-code to a plan and a recording of what the machine did."""

import trochia

machine = trochia.load("reference-mill")
program = trochia.gcode("G21 G90 G17 G64 P0.01\nF6000\nG1 X40\nY40\nX0\nY0\nM2\n")
plan = trochia.plan(program, machine)
print(f"{plan.time_s:.3f} s for {plan.feed_length_mm:.0f} mm")

recording = trochia.simulate(plan)
print(recording["X.actual"].max(), "mm is how far X really went")
