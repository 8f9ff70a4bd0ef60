"""Only what pyproject.toml cannot say: the C core is built by cffi, once for every Python (abi3)."""

from setuptools import setup

setup(
    cffi_modules=["core/build.py:builder"],
    options={"bdist_wheel": {"py_limited_api": "cp311"}},
)
