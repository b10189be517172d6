"""Settings of all tests.

Property tests take the same examples each time (profile ``ci``), so that a failure is there again on the next
run and on the next machine. With ``HYPOTHESIS_PROFILE=dev`` they look for new ones.
"""

import os

from hypothesis import settings

settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))
