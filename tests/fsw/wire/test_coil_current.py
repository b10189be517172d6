"""What is said of currents is what the message carries."""

from fsw.wire.coil_current import MOST_MA, STEP_MA


def test_range_and_step_are_those_of_the_signal(dbc):
    signal = dbc.get_message_by_name("COIL_STATUS").get_signal_by_name("current_ma")
    assert (signal.maximum, signal.scale) == (MOST_MA, STEP_MA)
