"""``torquer.scenarios``: what the command lists."""

import torquer


def test_it_has_what_the_command_lists(command):
    scenarios = torquer.scenarios()
    listed = [line.split()[0] for line in command("scenarios").stdout.splitlines()]
    assert list(scenarios) == listed
    assert all(scenario.name == name for name, scenario in scenarios.items())
