"""Basilisk's spacecraft under Torquer's flight software: the plant of docs/icd.md, by another simulator.

    python basilisk_plant.py SCENARIO.toml --out DIR [--orbits N] [--seed N]

SCENARIO.toml is a resolved scenario, as each run directory has one.
"""

import argparse
import shutil
import socket
import subprocess
import time
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from math import radians
from pathlib import Path

import h5py
import numpy as np
from Basilisk.utilities import RigidBodyKinematics
from boards import (
    FSW_BOOT,
    MAG_BOOT,
    MAG_FIELD,
    MAG_HEARTBEAT,
    PLANT_BOOT,
    SUN_BOOT,
    SUN_HEARTBEAT,
    SUN_VECTOR,
    TICK_DONE,
    CoilBoard,
    Frame,
    LoopBus,
    SensorBoard,
    boot,
    intact,
    plant_end,
    sync,
    unsigned,
)
from satellite import Array, Satellite, Scenario, State, epoch_unix_s, orbit_s, orbital_frame

LEAST_LIT = 0.5
"""Part of the Sun's disc below which the Sun sensor has no reading, as in the own plant."""

MODELLED = {
    *(
        "inertia_kgm2",
        "torque_nm",
        "residual_dipole_am2",
        "driver",
        "backoff",
        "backoff_s",
        "pulse_s",
        "levels_am2",
    ),
    *("dipole_per_ampere_am2", "coil_field_nt_per_am2", "noise_nt", "noise_deg"),
    *("on_fraction", "time_constant_s", "quantum_nt", "quantum", "saturation_nt"),  # too small to matter here
}
"""Keys of body, coils, disturbance and sensors; any other must be as if it were not there."""


class Plant:
    """The satellite and its boards.

    Args:
        scenario: the resolved scenario.
        epoch: unix time of tick 0 [s].
        seed: of the noise.
    """

    def __init__(self, scenario: Scenario, epoch: int, seed: int) -> None:
        self._tick_hz: int = scenario["time"]["tick_hz"]
        self._epoch, coils, sensors = epoch, scenario["coils"], scenario["sensors"]
        self._levels_am2 = [0.0, *coils["levels_am2"]]
        self._dipole_per_ma_am2 = 1e-3 * coils["dipole_per_ampere_am2"]
        self._field_t_per_am2 = 1e-9 * np.array(sensors["magnetometer"]["coil_field_nt_per_am2"])
        self._noise_t = 1e-9 * sensors["magnetometer"]["noise_nt"]
        self._noise_rad = radians(sensors["sun"]["noise_deg"])
        self._random = np.random.default_rng(seed)
        self._satellite = Satellite(scenario, epoch)
        self._magnetometer = SensorBoard(MAG_FIELD, MAG_BOOT, MAG_HEARTBEAT, 2e-9, self._tick_hz)
        self._sun = SensorBoard(SUN_VECTOR, SUN_BOOT, SUN_HEARTBEAT, 2.0**-14, self._tick_hz)
        self._board = CoilBoard(self._tick_hz, round(1e3 * coils["pulse_s"]), round(1e3 * coils["backoff_s"]))

    def begin_tick(self, tick: int) -> tuple[State, list[Frame]]:
        """The truth at the instant of this tick, and the frames of the boards and ``SYNC``."""
        state, board, random = self._satellite.state(tick), self._board, self._random
        board.enter(tick)
        coil, level, part = board.drive
        m_body_am2 = self._dipole_am2(coil, level) if part else np.zeros(3)
        b_t = state.b_body_t + self._field_t_per_am2 @ m_body_am2 + self._noise_t * random.standard_normal(3)
        s = state.sun_body + np.cross(self._noise_rad * random.standard_normal(3), state.sun_body)
        frames = [
            *self._magnetometer.begin_tick(tick, tuple(b_t), True),
            *self._sun.begin_tick(tick, tuple(s / np.linalg.norm(s)), state.lit >= LEAST_LIT),
            *board.frames(round(m_body_am2.sum() / self._dipole_per_ma_am2)),
        ]
        return state, [*frames, sync(tick, self._epoch + tick // self._tick_hz)]

    def end_tick(self, tick: int, answer: list[Frame]) -> Array:
        """Hand the answer to the coil board and go on to the next tick; the mean dipole until then."""
        for frame in answer:
            self._board.receive(frame)
        coil, level, part = self._board.drive
        m_body_am2 = part * self._dipole_am2(coil, level)
        self._satellite.advance(tick + 1, m_body_am2)
        return m_body_am2

    def _dipole_am2(self, coil: int, level: int) -> Array:
        m_body_am2 = np.zeros(3)
        m_body_am2[coil] = self._levels_am2[abs(level)] * (1.0 if level > 0 else -1.0)
        return m_body_am2


def answers(bus: LoopBus, tick: int) -> list[Frame]:
    """All frames of the flight software up to the ``TICK_DONE`` that names ``tick``."""
    frames: list[Frame] = []
    while not (frames and frames[-1].can_id == TICK_DONE and unsigned(frames[-1].data, 0, 32) == tick):
        received = bus.receive(20.0)
        if not received:
            raise TimeoutError(f"no answer to tick {tick}")
        frames += received
    return frames


def await_boot(bus: LoopBus) -> Frame:
    """Ask for ``FSW_BOOT`` until it comes: it may have been sent before this end was on the bus."""
    for _ in range(120):
        bus.send([boot(PLANT_BOOT)])
        for frame in bus.receive(0.25):
            if frame.can_id == FSW_BOOT and intact(frame, 7):
                return frame
    raise TimeoutError("the flight software does not boot")


@contextmanager
def flight_software(scenario: Path) -> Iterator[int]:
    """``torquer fsw`` of a scenario as a process; the port of the loop bus that it hosts."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
    process = subprocess.Popen(["torquer", "fsw", str(scenario), "--bus", f"loop:{port}", "--quiet"])
    try:
        yield port
        process.wait(10.0)
    finally:
        process.kill()
        process.wait()


def fly(scenario_path: Path, orbits: float, seed: int, out: Path) -> float:
    """Fly, and write bus.log and truth.h5 into ``out``, as in docs/runs.md; the wall time [s]."""
    scenario = tomllib.loads(scenario_path.read_text(encoding="utf-8"))
    refuse_what_is_not_modelled(scenario)
    out.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(scenario_path, out / "scenario.toml")
    tick_hz, epoch = scenario["time"]["tick_hz"], epoch_unix_s(scenario)
    ticks = round(orbits * orbit_s(scenario) * tick_hz)
    plant, states, dipoles_am2 = Plant(scenario, epoch, seed), [], [np.zeros(3)]
    with (
        flight_software(scenario_path) as port,
        LoopBus(port) as bus,
        (out / "bus.log").open("w", encoding="ascii") as log,
    ):

        def write(tick: int, frames: list[Frame]) -> None:
            stamp = f"({epoch + tick // tick_hz}.{tick % tick_hz * 1_000_000 // tick_hz:06d}) loop "
            log.write("".join(f"{stamp}{one.can_id:03X}#{one.data.hex().upper()}\n" for one in frames))

        write(0, [await_boot(bus)])
        began = time.monotonic()
        for tick in range(ticks):
            state, sent = plant.begin_tick(tick)
            bus.send(sent)
            answer = answers(bus, tick)
            write(tick, sent + answer)
            states.append(state)
            dipoles_am2.append(plant.end_tick(tick, answer))
        bus.send([end := plant_end(ticks)])
        write(ticks, [end])
        wall_s = time.monotonic() - began
    write_truth(out / "truth.h5", states, np.array(dipoles_am2[:ticks]), epoch, tick_hz)
    return wall_s


def refuse_what_is_not_modelled(scenario: Scenario) -> None:
    """Say so rather than fly another satellite than that of the scenario."""
    sensors, coils = scenario["sensors"], scenario["coils"]
    found = {
        "orbit without a TLE": "tle" not in scenario["orbit"],
        "orbit.along_track_km": scenario["orbit"]["along_track_km"] != 0.0,
        "knowledge": scenario["knowledge"] != "filter",
        "field": scenario["field"]["model"] != "igrf14" or scenario["field"]["storm_nt"] != 0.0,
        "coils.driver": coils["driver"] != "pulsed",
        "coils.backoff": coils["backoff"] != "shared",
        **{key: bool(scenario.get(key)) for key in ("wheel", "fault", "telecommand")},
        "sensors.cells": "cells" in sensors,
    }
    sections = {
        "body": scenario["body"],
        "coils": coils,
        "disturbance": scenario["disturbance"],
        "sensors.magnetometer": sensors["magnetometer"],
        "sensors.sun": sensors.get("sun", {}),
    }
    for name, section in sections.items():
        for key, value in section.items():
            nothing = 1.0 if key in ("scale", "dipole_scale") else 0.0
            found[f"{name}.{key}"] = key not in MODELLED and not np.all(np.array(value) == nothing)
    if named := [key for key, is_there in found.items() if is_there]:
        raise SystemExit(f"basilisk_plant: not modelled here: {', '.join(named)}")


def relative_motion(state: State) -> tuple[Array, Array]:
    """q_body_from_orbit, scalar first, and omega_body_orbit_radps."""
    orbit_from_eci, rate_radps = orbital_frame(state.r_eci_m, state.v_eci_mps)
    body_from_orbit = state.body_from_eci @ orbit_from_eci.T
    omega_body_orbit_radps = state.omega_body_radps - rate_radps * body_from_orbit[:, 2]
    return RigidBodyKinematics.C2EP(body_from_orbit), omega_body_orbit_radps


def write_truth(path: Path, states: list[State], m_body_am2: Array, epoch: int, tick_hz: int) -> None:
    """The truth by tick, a dataset each."""
    q, omega_body_orbit_radps = zip(*map(relative_motion, states), strict=True)
    histories = {
        "t_s": np.arange(len(states)) / tick_hz,
        "q_body_from_orbit": np.array(q),
        "omega_body_orbit_radps": np.array(omega_body_orbit_radps),
        "b_body_t": np.array([state.b_body_t for state in states]),
        "sun_body": np.array([state.sun_body for state in states]),
        "lit": np.array([state.lit for state in states]),
        "m_body_am2": m_body_am2,
        "r_eci_m": np.array([state.r_eci_m for state in states]),
    }
    with h5py.File(path, "w") as file:
        file.attrs["epoch_unix_s"] = epoch
        for name, values in histories.items():
            file[name] = values


def main() -> None:
    """Fly by the options of the command line."""
    parser = argparse.ArgumentParser(description="Fly Basilisk's spacecraft under the flight software.")
    parser.add_argument("scenario", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--orbits", type=float, default=4.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    wall_s = fly(options.scenario, options.orbits, options.seed, options.out)
    print(f"{options.out}: flown in {wall_s:.1f} s")


if __name__ == "__main__":
    main()
