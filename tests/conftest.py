"""What every ring shares: how many cases a law is tried on."""

from __future__ import annotations

from hypothesis import HealthCheck, settings

# the checks run the same seeded sample each time; `make soak` runs a hundred times as many, freshly drawn
settings.register_profile("check", max_examples=60, deadline=None, derandomize=True, print_blob=True,
                          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
settings.register_profile("soak", max_examples=6000, deadline=None, print_blob=True,
                          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
settings.load_profile("check")
