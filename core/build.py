"""Build the C core as ``trochia._core`` through cffi's API mode.

In: every header of ``core/shared`` and ``core/host``, which are also the schema cffi reads (so they hold plain
declarations; preprocessor lines and ``static inline`` bodies, from a line starting so to the ``}`` in the first
column, are left out for cffi).  Out: one extension module for the stable ABI.
"""

import hashlib
import os
import re
from pathlib import Path

from cffi import FFI

CORE = Path(__file__).resolve().parent
ROOT = CORE.parent
# A struct is declared before it is used: shared first, then by the data's way through the house.
HEADERS = [
    "host/move.h",
    "host/spline.h",
    "host/path.h",
    "host/plan.h",
    "host/plan_torque.h",
    "host/scurve.h",
    "host/steps.h",
    "shared/interpolate.h",
    "host/interpolate.h",
    "shared/ramp.h",
    "shared/speed.h",
    "shared/segment.h",
    "host/ticks.h",
    "host/fit.h",
    "host/cubic_steps.h",
    "shared/protocol.h",
    "shared/frame.h",
    "shared/pulses.h",
    "shared/slots.h",
    "shared/timeline.h",
    "host/link.h",
    "host/timeline.h",
    "host/gcode.h",
    "host/placement.h",
    "host/twin.h",
    "host/stepper.h",
    "host/reluctance.h",
    "host/encoder.h",
    "host/servo.h",
    "shared/pid.h",
    "host/integer_pid.h",
    "host/servo_law.h",
    "host/follower.h",
    "host/contour.h",
]
FLAGS = ["-std=c11", "-O3", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-ffp-contract=off", "-fno-math-errno"]


def declarations(text: str) -> str:
    """Return what cffi may read of a header: declarations without preprocessor lines and inline bodies."""
    text = re.sub(r"^static inline .*?^}\n", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"^#.*(?:\\\n.*)*$", "", text, flags=re.MULTILINE)


def schema() -> str:
    """Return the hash of the link's schema, which the firmware is compiled with as well, as a C number."""
    return f"0x{hashlib.sha256((CORE / 'shared/protocol.h').read_bytes()).hexdigest()[:8]}u"


def make_builder() -> FFI:
    """Return the cffi builder of the core; TROCHIA_CFLAGS adds flags (the sanitiser build uses it)."""
    ffi = FFI()
    for header in HEADERS:
        ffi.cdef(declarations((CORE / header).read_text()))
    sources = sorted(str(path.relative_to(ROOT)) for path in CORE.glob("host/*.c"))
    ffi.set_source(
        "trochia._core",
        "\n".join(f'#include "{header}"' for header in HEADERS),
        sources=sources,
        depends=sorted(str(path.relative_to(ROOT)) for path in CORE.glob("*/*.h")),
        include_dirs=[str(CORE)],
        # cffi's own glue is not ours to warn about
        extra_compile_args=[*FLAGS, "-Wno-conversion", *os.environ.get("TROCHIA_CFLAGS", "").split()],
        define_macros=[("TROCHIA_SCHEMA", schema())],  # a chip with another one is refused
        extra_link_args=os.environ.get("TROCHIA_CFLAGS", "").split(),
        libraries=["m"],
        py_limited_api=True,
    )
    return ffi


builder = make_builder()
