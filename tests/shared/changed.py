"""What an action makes of a state that it changes in place; for a test that compares before and after."""


def changed(state, by, *arguments):
    """A copy of the state after the action."""
    after = state.copy()
    by(after, *arguments)
    return after
