"""The coil board in C, compiled once for each set of limits."""

import pytest
from c_compiler import has_compiler
from firmware_bench import NO_COMPILER, compile_board, compile_program, limits_header


@pytest.fixture(scope="session")
def library_of(tmp_path_factory):
    """Makes the library of a board with these limits; ``limits_header`` says how they are named."""
    if not has_compiler():
        pytest.skip(NO_COMPILER)
    compiled = {}

    def library(**limits):
        key = tuple(sorted(limits.items()))
        if key not in compiled:
            folder = tmp_path_factory.mktemp("coil_board")
            compiled[key] = compile_board(folder, limits_header(**limits))
        return compiled[key]

    return library


@pytest.fixture(scope="session")
def program_of(tmp_path_factory):
    """Makes the program of a board with these limits."""
    if not has_compiler():
        pytest.skip(NO_COMPILER)
    return lambda **limits: compile_program(tmp_path_factory.mktemp("program"), limits_header(**limits))
