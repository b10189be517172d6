"""What a shell may complete."""

import shutil
import subprocess
import sys

import click
import pytest

from fsw.core.laws.table import LAWS
from torquer.cli import completions
from torquer.cli.completion import script
from torquer.cli.main import main


def found(complete, begun, command="sil", parameter=None):
    context = click.Context(main.get_command(click.Context(main), command), info_name=command)
    params = {each.name: each for each in context.command.params}
    completed = params[parameter] if parameter else context.command.params[0]
    return [item.value for item in complete(context, completed, begun)]


def test_scenarios_by_name_else_files():
    assert found(completions.of_scenarios, "cube") == ["cubesat-cells", "cubesat3u", "cubesat6u"]
    assert found(completions.of_scenarios, "my-") == ["my-"]


@pytest.mark.parametrize(
    ("begun", "completed"),
    [
        ("coils.back", ["coils.backoff_s=", "coils.backoff="]),
        ("coils.backoff=", ["coils.backoff=shared", "coils.backoff=per_coil"]),
        ("control.law=slid", [f"control.law={law}" for law in LAWS if law.startswith("slid")]),
        ("sensors.sun.alb", ["sensors.sun.albedo=", "sensors.sun.albedo_spread="]),
        ("disturbance.drag.", ["disturbance.drag.density_scale="]),
        ("time.tick_hz=", []),
        ("zzz", []),
    ],
)
def test_keys_of_settings_and_their_values(begun, completed):
    assert sorted(found(completions.of_settings, begun)) == sorted(completed)


def test_buses():
    assert found(completions.of_buses, "v", parameter="bus") == ["virtual"]
    assert found(completions.of_buses, "v", "plant", "bus") == []
    assert "auto" in found(completions.of_buses, "", parameter="bus")


def test_paces():
    assert found(completions.of_paces, "real", parameter="pace") == ["realtime", "realtime:"]
    for command in ("sil", "plant", "watch"):
        paces = next(
            one for one in main.get_command(click.Context(main), command).params if one.name == "pace"
        )
        assert paces.shell_complete(click.Context(main), "lock")[0].value == "lockstep"


@pytest.mark.parametrize("command", ["calibrate", "phasing", "replay", "watch"])
def test_scenarios_of_a_log(command):
    option = next(
        one for one in main.get_command(click.Context(main), command).params if one.name == "scenario"
    )
    assert option.shell_complete(click.Context(main), "micro")[0].value == "microsat"


def test_a_bus_else_files_where_a_run_may_stand():
    watched = found(completions.of_buses, "lo", "watch"), found(completions.of_buses, "my-r", "watch")
    assert watched == (["loop"], ["my-r"])


def test_laws_after_a_comma_and_rows():
    assert found(completions.of_laws, "my_l") == ["my_l"], "a file"
    assert found(completions.of_laws, "pd,pulse", "compare") == ["pd,pulse_mpc"]
    assert "mag-bias" in {row[:8] for row in found(completions.of_fault_rows, "mag-", "faults")}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell_is_one(shell):
    text = script(shell)
    assert "_TORQUER_COMPLETE" in text
    if shutil.which(shell):
        subprocess.run([shell, "-n"], input=text, text=True, check=True)


def test_the_script_for_zsh_completes_each_time_it_is_called():
    text = script("zsh")
    assert "if [[ $funcstack[1] == _torquer ]]; then" in text
    assert "loadautofunc ]]" not in text


COMPLETE = """
compopt() { :; }
source ./script
for COMP_LINE in "torquer sil reals" "torquer sil --set coils.backoff=pe" "torquer sil --bus "; do
    COMP_POINT=${#COMP_LINE}
    _torquer_completion ./torquer
    echo "${COMPREPLY[*]}"
done
"""


@pytest.mark.long
@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_completes_what_follows_an_equals_sign(tmp_path):
    (tmp_path / "script").write_text(script("bash"))
    (tmp_path / "torquer").write_text(f'#!/bin/sh\nexec {sys.executable} -m torquer "$@"\n')
    (tmp_path / "torquer").chmod(0o755)
    done = subprocess.run(["bash", "-c", COMPLETE], cwd=tmp_path, capture_output=True, text=True, check=True)
    first, second, third = done.stdout.splitlines()
    assert (first, second) == ("realsat", "per_coil")
    assert third.startswith("auto loop slcan: ")
