"""Who shapes the ramp, and who distributes the phases: the two command chains of a stepper, and what neither does."""

import numpy as np

from trochia.backends.stepper_twin import StepperTwin
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import ShaftLoad, motor
from trochia.pulses.chain import CommandChain, DigitalFilter, RingCounter, SoftwareDistributor, phase_table

STEPS, RATE = 400, 600.0  # two turns, at once at 600 steps/s
stepper = motor("SM-42BYG011-25").parameters()
made = fed(stepper, HBridge(supply=12.0, excitation="two-phase"), 1)
load = ShaftLoad(inertia=150e-7, friction=4e-3)


def acceleration(rate: float) -> float:
    """Return what half of the torque there is accelerates at a rate of steps [1/s²]."""
    torque = made.pull_out(np.array(stepper.speed(rate)), load)
    return max(0.5 * float(torque), 1e-4) / (stepper.inertia + load.inertia) / stepper.step_angle


shaper = DigitalFilter(top=RATE, start=100.0, acceleration=acceleration)
chains = {
    "no ramp, ring counter": CommandChain(distributor=RingCounter(4, on=2)),
    "hard-wired: filter and ring counter": CommandChain(distributor=RingCounter(4, on=2), filter=shaper),
    "filter, software distributes": CommandChain(
        distributor=SoftwareDistributor(phase_table("two-phase", 4)), filter=shaper
    ),
}
train = 0.05 + np.arange(STEPS) / RATE  # as a computer sends it, that knows of no ramp
for name, chain in chains.items():
    times, phases = chain.commanded(train, np.ones(STEPS))
    twin = StepperTwin(made, load)
    twin.queue(times)
    run = twin.run(float(times[-1]) + 0.3, every=50)
    on = "".join(map(str, phases[-1].astype(int)))
    print(f"{name}: {times[-1] - times[0]:.3f} s, lost steps {run.lost_steps[-1]}, phases on at the end {on}")
