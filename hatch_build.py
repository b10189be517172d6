"""Builds what is compiled: the filter's kernel, and the flight code by tools/compile_group.py.

The kernel is built whenever the package is installed, the flight code with TORQUER_COMPILED=1; after a change
the kernel is built by ``python hatch_build.py``. Without a C compiler or Python's headers the package is
installed all the same: filterpy computes, and the flight code runs interpreted.
"""

import hashlib
import os
import shlex
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ImportError:  # run by hand, where hatchling need not be installed
    BuildHookInterface = object

SOURCE = "fsw/core/estimation/kalman_kernel.c"
TARGET = "fsw/core/estimation/_kalman_kernel" + (sysconfig.get_config_var("EXT_SUFFIX") or ".so")
FLAGS = ("-O3", "-fPIC", "-ffp-contract=off", "-Wall", "-Wextra", "-Wno-cast-function-type")
"""No contraction: a product and a sum are rounded each by itself, as on every other machine."""
QUIET = ("-Wno-unused-parameter", "-Wno-missing-field-initializers")


class KernelError(Exception):
    """The kernel cannot be built; the message says why."""


def build_kernel(root: Path) -> Path:
    """Compile the kernel below the root of the sources.

    Raises:
        KernelError: there is no compiler, or it refuses the source.
    """
    import numpy as np  # noqa: PLC0415  (of the environment that builds)

    digest = hashlib.sha256((root / SOURCE).read_bytes()).hexdigest()
    folders = {sysconfig.get_path("include"), sysconfig.get_path("platinclude"), np.get_include()}
    words = [
        *shlex.split(sysconfig.get_config_var("LDSHARED") or "cc -shared"),
        *FLAGS,
        *QUIET,
        f'-DSOURCE_SHA256="{digest}"',
        *(f"-I{folder}" for folder in sorted(folders)),
        str(root / SOURCE),
    ]
    target = root / TARGET
    with TemporaryDirectory(
        dir=target.parent
    ) as folder:  # a build that is killed leaves the binary as it was
        part = Path(folder, target.name)
        _compile([*words, "-o", str(part)])
        return part.replace(target)


def _compile(words: Sequence[str]) -> None:
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise KernelError(f"{words[0]}: {error.strerror}") from None
    if done.returncode:
        raise KernelError(done.stderr.strip() or f"{words[0]} ended with exit code {done.returncode}")


class CustomBuildHook(BuildHookInterface):  # type: ignore[misc]  # hatchling is not there where tools run
    """Compiles when a wheel is built or the sources are installed in place."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build, and add the binaries to the wheel of this platform."""
        if self.target_name != "wheel":
            return
        built = [*self._kernel(), *self._flight_code()]
        if built:
            build_data["pure_python"] = False
            build_data["infer_tag"] = True
            build_data["artifacts"] += built

    def _kernel(self) -> list[str]:
        try:
            build_kernel(Path(self.root))
        except KernelError as error:
            self.app.display_warning(f"the filter's kernel is not built, filterpy computes: {error}")
            return []
        return [TARGET]

    def _flight_code(self) -> list[str]:
        if os.environ.get("TORQUER_COMPILED", "0") in ("", "0"):
            return []
        sys.path.insert(0, str(Path(self.root, "tools")))
        from compile_group import FOLDER, CompileError, build  # noqa: PLC0415  (of the sources that are built)

        try:
            build(self.app.display_info, Path(self.root))
        except CompileError as error:
            self.app.display_warning(f"the flight code is not compiled, and runs interpreted: {error}")
            return []
        return [f"{FOLDER}/*"]


def main() -> int:
    """Build by hand; without a compiler the exit code is 0 too, as nothing depends on it."""
    try:
        print(f"built {build_kernel(Path(__file__).resolve().parent).name}")
    except KernelError as error:
        print(f"the filter's kernel is not built, filterpy computes: {error}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
