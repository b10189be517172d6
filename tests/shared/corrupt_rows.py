"""One row of recorded telemetry as receivers, converters and recorders spoil it."""

from random import Random

FILLS = ("-999999", "65535", "0", "nan", "ERR", "1e30")
KINDS = (
    *FILLS,
    "swapped sign",
    "spike",
    "ten times",
    "zeros",
    "fill row",
    "cut off",
    "late",
    "early",
    "beside",
)


def spoilt(lines, row, kind, random):
    """The lines of a file, one row of which, 1 or more, is spoilt in a column that is read."""
    names, values = lines[0].split(","), lines[row].split(",")
    time = names.index("utc_unix_s")
    read = [place for place, name in enumerate(names) if name != "sat_index"]
    at = random.choice(read)
    if kind in FILLS:
        values[at] = kind
    elif kind == "swapped sign":
        values[at] = str(-float(values[at]))
    elif kind == "spike":
        values[at] = str(float(values[at]) + random.choice((-1.0, 1.0)) * 10.0 ** random.uniform(3.0, 6.0))
    elif kind == "ten times":
        values[at] = str(10.0 * float(values[at]))
    elif kind in ("zeros", "fill row"):
        values = ["0" if kind == "zeros" else "65535"] * len(values)
        values[time] = lines[row].split(",")[time]
    elif kind == "cut off":
        values = values[: len(values) // 2]
    else:
        off_s = {"late": 1.0, "early": -1.0}.get(kind, 0.0) * 10.0 ** random.uniform(1.0, 9.0)
        values[time] = str(float(values[time]) + (off_s or random.choice((-2.0, -1.0, 1.0, 2.0))))
    return [*lines[:row], ",".join(values), *lines[row + 1 :]]


def any_spoilt(lines, random):
    """As ``spoilt``, of any kind in any row, the first and the last more often; with the row and the kind."""
    row = random.choice((1, len(lines) - 1, *(random.randrange(1, len(lines)) for _ in range(4))))
    kind = random.choice(KINDS)
    return spoilt(lines, row, kind, random), row, kind


def seeded(seed):
    """A source of spoilt rows."""
    return Random(seed)
