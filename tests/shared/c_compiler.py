"""The C compiler of this machine, with the warnings that the firmware in C is free of."""

import ctypes
import shutil
import subprocess

COMPILER = "gcc"
STRICT = (
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wundef",
)


def has_compiler():
    return shutil.which(COMPILER) is not None


def compile_c(product, words, what, strict=True):
    """Compile ``what`` with these words of the command line, to ``product``."""
    flags = STRICT if strict else ("-std=c99", "-w")
    command = [COMPILER, *flags, "-O2", *map(str, words), "-o", str(product), "-lm"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise AssertionError(f"{COMPILER} does not compile {what}:\n{done.stderr}")
    return product


def harness_of(library, reply_most):
    """``harness_step`` of a library, from request to the buffer of its reply and its length."""
    step = ctypes.CDLL(str(library)).harness_step
    step.argtypes = (ctypes.c_char_p, ctypes.c_char_p)
    step.restype = ctypes.c_uint32
    reply = ctypes.create_string_buffer(reply_most)

    def answer(request):
        return reply, step(request, reply)

    return answer
