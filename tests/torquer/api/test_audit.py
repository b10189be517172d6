"""``torquer.check``: the command's verdict, as a value."""

import pytest

import torquer


@pytest.mark.long
def test_it_says_what_the_command_prints(flown, command):
    audit = torquer.check(flown.path)
    done = command("check", flown.path)
    assert (done.exit_code, done.stdout) == (0, f"{audit}\n")
    assert audit.ok
    assert audit.violations == ()


def test_a_log_that_was_cut_is_not_ok_though_its_limits_are_kept(copy, command):
    lines = copy.log.read_text().splitlines(keepends=True)
    copy.log.write_text("".join(lines[:-20]))
    audit = copy.check()
    assert audit.report.ok
    assert not audit.ok
    assert command("check", copy.path).exit_code == 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nowhere",), "nowhere"),
        ((3,), "run_or_log = 3"),
    ],
)
def test_wrong_input_is_one_sentence(arguments, says):
    with pytest.raises(torquer.InputError, match=says):
        torquer.check(*arguments)


def test_a_back_off_that_is_none_is_named(flown):
    with pytest.raises(torquer.InputError, match="backoff = 'none'"):
        torquer.check(flown.path, backoff="none")
