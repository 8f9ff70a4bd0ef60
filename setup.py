"""Only what pyproject.toml cannot say.

The C core is built by cffi, once for every Python (abi3); the boards' images go into the package's data where there is
an avr-gcc.
"""

import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

FIRMWARE = Path(__file__).parent / "firmware" / "avr"


class BuildWithImages(build_py):
    """Compiles the images before the package's data are collected."""

    def run(self) -> None:
        """Build; without a compiler for the chip, or the sources, `trochia flash` will ask for an image."""
        if shutil.which("avr-gcc") and shutil.which("make") and FIRMWARE.is_dir():
            subprocess.run(["make", "-s", "-C", FIRMWARE, "images"], check=True)  # noqa: S603, S607 - our own make
        super().run()


setup(
    cffi_modules=["core/build.py:builder"],
    cmdclass={"build_py": BuildWithImages},
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
