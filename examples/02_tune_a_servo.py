"""An axis nobody knows: found by experiment on its twin, tuned on what was found, judged on what it is."""

from trochia.analysis.tuning import judge, shape
from trochia.experiments import Bounds, TwinAxis, identify
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant

# the true axis: the experiment is not told any of this but the motor's torque for a volt, and the encoder's counts
truth = ServoPlant(
    amplifier=Amplifier(current=20.0, lag=3e-4), torque_constant=0.1, counts=3000.0, motor_inertia=1e-4,
    load_inertia=2e-4, stiffness=20.0, damping=4e-3, gap=4e-3,
    motor_friction=Friction(coulomb=0.008, viscous=2e-4), load_friction=Friction(coulomb=0.012, viscous=3e-4),
)  # fmt: skip
period = 5e-4
axis = TwinAxis(truth, period)
found = identify(axis, Bounds(low=-250.0, high=250.0, command=20.0), speed=30.0, reach=2.0)
for estimate in found.estimates:
    print(estimate.model)
    for name, number in estimate.numbers.items():
        print(f"  {name:<14} {number}")

tuned = shape(found.plant, period, limit=20.0)
judged = judge(truth, tuned.loop)
print(f"on the true axis: Ms {judged.margins.ms:.2f}, settled in {judged.step.settling * 1e3:.0f} ms, motor off: "
      f"{not axis.enabled}")  # fmt: skip
